//! How the moving walls move during one internal step.

use crate::walls::FIXED;
use kinematics::{BodySet, Motion, SurfacePoint};
use nalgebra::Vector2;

/// Velocity of both ends of every moving panel at the start of an internal step, and its mean acceleration over it.
#[derive(Debug, Clone, Default)]
pub struct PanelMotion {
    velocity: Vec<[Vector2<f64>; 2]>,
    acceleration: Vec<[Vector2<f64>; 2]>,
}

impl PanelMotion {
    /// Velocities at the start of the step, from the body's motion there.
    pub fn set_start(&mut self, panels: &[[SurfacePoint; 2]], bodies: &BodySet, start: &Motion) {
        self.velocity.clear();
        self.velocity.extend(panels.iter().map(|ends| ends.map(|point| bodies.velocity(point, start))));
    }

    /// Mean accelerations over the step: `end` carries the frozen coordinates and the velocities at the end. They are
    /// affine in those velocities, which is what makes the load affine in the acceleration.
    pub fn set_end(&mut self, panels: &[[SurfacePoint; 2]], bodies: &BodySet, end: &Motion, time_step: f64) {
        self.acceleration.clear();
        for (ends, velocity) in panels.iter().zip(&self.velocity) {
            let at = |k: usize| (bodies.velocity(ends[k], end) - velocity[k]) / time_step;
            self.acceleration.push([at(0), at(1)]);
        }
    }

    /// Velocity of a wall point at the start of the step \[m/s\].
    #[inline]
    pub fn velocity(&self, panel: u32, fraction: f64) -> Vector2<f64> {
        interpolate(&self.velocity, panel, fraction)
    }

    /// Mean acceleration of a wall point over the step \[m/s2\].
    #[inline]
    pub fn acceleration(&self, panel: u32, fraction: f64) -> Vector2<f64> {
        interpolate(&self.acceleration, panel, fraction)
    }
}

#[inline]
fn interpolate(values: &[[Vector2<f64>; 2]], panel: u32, fraction: f64) -> Vector2<f64> {
    if panel == FIXED {
        return Vector2::zeros();
    }
    let ends = &values[panel as usize];
    ends[0] + (ends[1] - ends[0]) * fraction
}
