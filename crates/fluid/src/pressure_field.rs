//! The water as pressures at points: averages over the particles around.

use crate::grid::Grid;
use crate::parameters::Parameters;
use crate::problem::Problem;
use crate::state::State;
use crate::walls::Walls;
use nalgebra::{Matrix3, Vector2, Vector3};

/// Radius of the averages at walls and probes, in particle spacings.
pub const REACH: f64 = 2.1;

/// Fewest particles that a plane is fitted to.
const FEWEST: usize = 5;
/// Determinant of the fit's moments over the cube of the weights' sum, below which the particles lie on a line.
const FLATTEST: f64 = 1e-3;

/// The water as pressures at points.
#[derive(Clone, Copy)]
pub struct PressureField<'a> {
    /// Cells of the particles, of which `rings` around one are at least `REACH` spacings wide.
    pub grid: &'a Grid,
    /// See `grid`.
    pub rings: i64,
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

impl<'a> PressureField<'a> {
    /// The pressures of a state between `walls`.
    pub fn of(problem: &'a Problem, state: &'a State, grid: &'a Grid, walls: &'a Walls) -> Self {
        Self {
            grid,
            rings: 1,
            positions: &state.positions,
            pressures: &state.pressures,
            parameters: &problem.parameters,
            time: state.time,
            spacing: problem.spacing,
            walls,
        }
    }
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
        self.grid.for_each_within(point, self.rings, |j| {
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
        self.grid.for_each_within(point, self.rings, |j| {
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
