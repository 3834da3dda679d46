//! Pressure of water at rest.

use super::Context;
use crate::{FrameEntry, frames};
use frames::read_frame;
use scene::Check;

pub(super) const NEEDS_DEPTH: &str = "needs `depth`, the height of the water above y = 0";

/// L2 error of the pressure against rho g (depth - y), over rho g depth; the floor lies at y = 0. Of the last frame, or
/// over all frames in the window when `from` is given.
pub(super) fn error(check: &Check, context: &Context) -> Result<f64, String> {
    let depth = check.depth.ok_or(NEEDS_DEPTH)?;
    let (density, gravity) = context.water.ok_or("the scene has no water")?;
    let all = frames(context.frames, "particles")?;
    let wanted = match check.from {
        None => &all[all.len().saturating_sub(1)..],
        Some(from) => &all[all.partition_point(|entry| entry.time < from * (1.0 - 1e-9))..],
    };
    let wanted = wanted.iter().filter(|entry| check.to.is_none_or(|to| entry.time <= to * (1.0 + 1e-9)));
    let squares = wanted.map(|entry| mean_square(entry, density * gravity, depth)).collect::<Result<Vec<_>, _>>()?;
    if squares.is_empty() {
        return Err("there is no frame in the window; set output.interval".to_string());
    }
    Ok((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// Mean over the particles of a frame of the squared error over `weight` depth; `weight` is rho g \[N/m3\].
fn mean_square(entry: &FrameEntry, weight: f64, depth: f64) -> Result<f64, String> {
    let frame = read_frame(&entry.path).map_err(|error| error.to_string())?;
    let at = entry.time;
    let pressure = frame.scalar("pressure").ok_or_else(|| format!("the frame at {at} s has no field 'pressure'"))?;
    if pressure.is_empty() {
        return Err(format!("the frame at {at} s has no particles"));
    }
    let gap = |(point, pressure): (&[f32; 2], &f32)| {
        let exact = weight * (depth - f64::from(point[1]));
        ((f64::from(*pressure) - exact) / (weight * depth)).powi(2)
    };
    Ok(frame.points.iter().zip(pressure).map(gap).sum::<f64>() / pressure.len() as f64)
}
