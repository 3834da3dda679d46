//! Pressure of water at rest.

use super::Context;
use crate::report::last_frame;
use scene::Check;

/// L2 error of the last frame's pressure against rho g (depth - y), over rho g depth; the floor lies at y = 0.
pub(super) fn error(check: &Check, context: &Context) -> Result<f64, String> {
    let depth = check.depth.ok_or("needs `depth`, the height of the water above y = 0")?;
    let (density, gravity) = context.water.ok_or("the scene has no water")?;
    let (_, frame) = last_frame(context.frames, "particles")?.ok_or("there is no frame; set output.interval")?;
    let pressure = frame.scalar("pressure").ok_or("the last frame has no field 'pressure'")?;
    if pressure.is_empty() {
        return Err("the last frame has no particles".to_string());
    }
    let head = density * gravity * depth;
    let gap = |(point, pressure): (&[f32; 2], &f32)| {
        let exact = density * gravity * (depth - f64::from(point[1]));
        ((f64::from(*pressure) - exact) / head).powi(2)
    };
    let square: f64 = frame.points.iter().zip(pressure).map(gap).sum();
    Ok((square / pressure.len() as f64).sqrt())
}
