//! Pressure on walls, and the load that it puts on the generalised coordinates.

use crate::grid::Grid;
use crate::panel_motion::PanelMotion;
use crate::parameters::Parameters;
use crate::walls::{FIXED, Segment, Walls};
use kinematics::{Body, MaterialPoint};
use nalgebra::{DVector, Matrix3, Vector2, Vector3};
use rayon::prelude::*;

/// Radius of the averages at walls and probes, in particle spacings.
const REACH: f64 = 2.1;

/// Fewest particles that a plane is fitted to.
const FEWEST: usize = 5;
/// Determinant of the fit's moments over the cube of the weights' sum, below which the particles lie on a line.
const FLATTEST: f64 = 1e-3;

/// The water as pressures at points.
#[derive(Clone, Copy)]
pub struct PressureField<'a> {
    /// Cells of the particles, at least `REACH` spacings wide.
    pub grid: &'a Grid,
    /// Positions \[m\].
    pub positions: &'a [Vector2<f64>],
    /// Pressures \[Pa\].
    pub pressures: &'a [f64],
    /// Density and body force.
    pub parameters: &'a Parameters,
    /// Time of the body force \[s\].
    pub time: f64,
    /// Particle spacing \[m\].
    pub spacing: f64,
    /// Walls that hide particles.
    pub walls: &'a Walls,
}

impl PressureField<'_> {
    /// Pressure at a wall point with normal `normal` into the solid and acceleration `acceleration`:
    /// sum w (p_j + rho ((g - a).n) d_j) / sum w over the particles in front, d_j their distance from the wall.
    pub fn at_wall(&self, point: &Vector2<f64>, normal: &Vector2<f64>, acceleration: &Vector2<f64>) -> f64 {
        let slope = self.parameters.density * (self.parameters.body_force(point, self.time) - acceleration).dot(normal);
        let front = point - normal * (0.01 * self.spacing);
        self.average(&front, |j| {
            let distance = -normal.dot(&(self.positions[j] - point));
            (distance > 0.0).then(|| self.pressures[j] + slope * distance)
        })
    }

    /// Pressure at a point in the water: a plane fitted to the particles around by weighted least squares, or the mean
    /// sum w (p_j + rho g.(x - r_j)) / sum w where these are too few or lie on a line.
    pub fn at_point(&self, point: &Vector2<f64>) -> f64 {
        let (mut moments, mut right) = (Matrix3::zeros(), Vector3::zeros());
        let mut count = 0;
        let squared_reach = (REACH * self.spacing).powi(2);
        let near_wall = !self.walls.candidates(point).is_empty();
        self.grid.for_each_near(point, |j| {
            let away = self.positions[j] - point;
            let squared = away.norm_squared();
            if squared >= squared_reach || (near_wall && self.walls.separates(point, &self.positions[j])) {
                return;
            }
            let row = Vector3::new(1.0, away.x / self.spacing, away.y / self.spacing);
            let weight = (1.0 - squared / squared_reach).powi(2);
            moments += row * row.transpose() * weight;
            right += row * (weight * self.pressures[j]);
            count += 1;
        });
        let even = moments.determinant() > FLATTEST * moments[(0, 0)].powi(3);
        if count < FEWEST || !even {
            return self.mean_at(point);
        }
        moments.cholesky().map_or_else(|| self.mean_at(point), |factor| factor.solve(&right)[0])
    }

    fn mean_at(&self, point: &Vector2<f64>) -> f64 {
        let force = self.parameters.body_force(point, self.time) * self.parameters.density;
        self.average(point, |j| Some(self.pressures[j] + force.dot(&(point - self.positions[j]))))
    }

    fn average(&self, point: &Vector2<f64>, value: impl Fn(usize) -> Option<f64>) -> f64 {
        let squared_reach = (REACH * self.spacing).powi(2);
        let near_wall = !self.walls.candidates(point).is_empty();
        let (mut weights, mut sum) = (0.0, 0.0);
        self.grid.for_each_near(point, |j| {
            let position = &self.positions[j];
            let squared = (position - point).norm_squared();
            if squared >= squared_reach || (near_wall && self.walls.separates(point, position)) {
                return;
            }
            if let Some(pressure) = value(j) {
                let weight = (1.0 - squared / squared_reach).powi(2);
                weights += weight;
                sum += weight * pressure;
            }
        });
        if weights > 0.0 { sum / weights } else { 0.0 }
    }
}

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
    body: &Body,
    panels: &[[MaterialPoint; 2]],
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
            if let Some(point) = MaterialPoint::between(ends[0], ends[1], fraction) {
                body.add_force(point, coordinates, segment.normal * (pressure * length * share), load);
            }
        }
    }
}
