//! The load of the pressure on walls, from averages over the particles around.

use crate::pressure_field::PressureField;
use crate::walls::{FIXED, PanelMotion, Segment};
use kinematics::{BodySet, SurfacePoint};
use nalgebra::{DVector, Vector2};
use rayon::prelude::*;

/// Half-spacing pieces of a segment: the fraction of each middle, and the length of each.
fn pieces(segment: &Segment, spacing: f64) -> (usize, f64) {
    let count = (segment.length / (0.5 * spacing)).ceil().max(1.0);
    (count as usize, segment.length / count)
}

/// Force of the water on the fixed walls \[N/m\].
pub fn fixed_wall_force(field: &PressureField) -> Vector2<f64> {
    let still = Vector2::zeros();
    let forces: Vec<Vector2<f64>> = field
        .walls
        .segments
        .par_iter()
        .map(|segment| {
            if segment.panel != FIXED {
                return Vector2::zeros();
            }
            let (count, length) = pieces(segment, field.spacing);
            let mut force = Vector2::zeros();
            for k in 0..count {
                let point = segment.start + segment.tangent * ((k as f64 + 0.5) * length);
                force += segment.normal * (field.at_wall(&point, &segment.normal, &still) * length);
            }
            force
        })
        .collect();
    forces.iter().sum()
}

/// Adds the load of the pressure on the moving panels to `load`, times `share`, by virtual work on the walls as they
/// stand in `coordinates`.
pub fn add_body_load(
    field: &PressureField,
    bodies: &BodySet,
    panels: &[[SurfacePoint; 2]],
    motion: &PanelMotion,
    coordinates: &DVector<f64>,
    share: f64,
    load: &mut [f64],
) {
    let moving: Vec<&Segment> = field.walls.segments.iter().filter(|segment| segment.panel != FIXED).collect();
    let pressures: Vec<Vec<f64>> = moving
        .par_iter()
        .map(|segment| {
            let (count, length) = pieces(segment, field.spacing);
            (0..count)
                .map(|k| {
                    let along = (k as f64 + 0.5) * length;
                    let acceleration = motion.acceleration(segment.panel, along / segment.length);
                    field.at_wall(&(segment.start + segment.tangent * along), &segment.normal, &acceleration)
                })
                .collect()
        })
        .collect();
    for (segment, values) in moving.iter().zip(&pressures) {
        let ends = panels[segment.panel as usize];
        let (count, length) = pieces(segment, field.spacing);
        for (k, pressure) in values.iter().enumerate() {
            let fraction = (k as f64 + 0.5) / count as f64;
            if let Some(point) = SurfacePoint::between(ends[0], ends[1], fraction) {
                bodies.add_force(point, coordinates, segment.normal * (pressure * length * share), load);
            }
        }
    }
}
