//! Contact of the cabin's corners with fixed walls.
//!
//! A corner that stands delta behind a wall is pushed out along the wall's normal n by
//!
//! ```text
//! F = k delta (1 + a delta') >= 0,
//! ```
//!
//! without friction (Hunt and Crossley 1975, exponent 1): continuous at the first touch, and an impact of speed v loses
//! about the share a v of its speed. With r = Rot c the corner seen from o_R and J = (n, n.U r) the row of
//! d(-delta)/dx, the force enters the equations as -F J.

use crate::Error;
use crate::parameters::{ContactParameters, check};
use kinematics::MotionView;
use nalgebra::{DMatrixViewMut, DVectorViewMut, Matrix3, Vector2, Vector3};

/// A straight fixed wall seen from the place of o_R in the scene.
#[derive(Debug, Clone, PartialEq)]
struct Wall {
    start: Vector2<f64>,
    tangent: Vector2<f64>,
    length: f64,
}

/// Corners and walls that may meet.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Contact {
    stiffness: f64,
    damping: f64,
    reach: f64,
    angle: f64,
    corners: Vec<Vector2<f64>>,
    walls: Vec<Wall>,
}

/// A corner behind a wall.
struct Touch {
    /// J.
    row: Vector3<f64>,
    /// n.r
    arm: f64,
    /// delta, m.
    depth: f64,
    /// 1 + a delta'
    factor: f64,
}

impl ContactParameters {
    pub(crate) fn validate(&self) -> Result<(), Error> {
        let positive = "positive and finite";
        check("the stiffness of contact [N/m2]", self.stiffness, self.stiffness > 0.0, positive)?;
        check("the damping of contact [s/m]", self.damping, self.damping >= 0.0, "at least 0 and finite")?;
        check("the reach of contact [m]", self.reach, self.reach > 0.0, positive)?;
        let walls = self.walls.iter().flatten();
        for place in self.corners.iter().chain(walls) {
            check("x of a corner or wall in contact [m]", place.x, true, "finite")?;
            check("y of a corner or wall in contact [m]", place.y, true, "finite")?;
        }
        let shortest = self.walls.iter().map(|[start, end]| (end - start).norm()).fold(f64::MAX, f64::min);
        check("the length of a wall in contact [m]", shortest, shortest > 0.0, positive)
    }
}

impl Contact {
    pub(crate) fn new(parameters: &ContactParameters, angle: f64) -> Self {
        let wall = |[start, end]: &[Vector2<f64>; 2]| {
            let along = end - start;
            Wall { start: *start, tangent: along / along.norm(), length: along.norm() }
        };
        Self {
            stiffness: parameters.stiffness,
            damping: parameters.damping,
            reach: parameters.reach,
            angle,
            corners: parameters.corners.clone(),
            walls: parameters.walls.iter().map(wall).collect(),
        }
    }

    /// Every corner behind a wall, with a force that pushes.
    fn touches(&self, position: &[f64], velocity: &[f64]) -> impl Iterator<Item = Touch> {
        let (sin, cos) = (self.angle + position[2]).sin_cos();
        let centre = Vector2::new(position[0], position[1]);
        let rate = Vector3::new(velocity[0], velocity[1], velocity[2]);
        self.corners.iter().flat_map(move |corner| {
            let seen = Vector2::new(cos * corner.x - sin * corner.y, sin * corner.x + cos * corner.y);
            self.walls.iter().filter_map(move |wall| {
                let normal = Vector2::new(-wall.tangent.y, wall.tangent.x);
                let relative = centre + seen - wall.start;
                let depth = -normal.dot(&relative);
                let beside = (0.0..=wall.length).contains(&wall.tangent.dot(&relative));
                let row = Vector3::new(normal.x, normal.y, normal.y * seen.x - normal.x * seen.y);
                let factor = 1.0 - self.damping * row.dot(&rate);
                let pushes = depth > 0.0 && depth < self.reach && factor > 0.0;
                (beside && pushes).then(|| Touch { row, arm: normal.dot(&seen), depth, factor })
            })
        })
    }

    fn force(&self, touch: &Touch) -> f64 {
        self.stiffness * touch.depth * touch.factor
    }

    /// Adds -F J of every touch.
    pub(crate) fn add_force(&self, position: &[f64], velocity: &[f64], out: &mut DVectorViewMut<f64>) {
        for touch in self.touches(position, velocity) {
            let mut rigid = out.fixed_rows_mut::<3>(0);
            rigid -= touch.row * self.force(&touch);
        }
    }

    /// Adds the sizes of the same.
    pub(crate) fn add_force_size(&self, motion: &MotionView, out: &mut DVectorViewMut<f64>) {
        for touch in self.touches(motion.position, motion.velocity) {
            let mut rigid = out.fixed_rows_mut::<3>(0);
            rigid += touch.row.abs() * self.force(&touch);
        }
    }

    /// Adds the derivative of -F J by the position.
    pub(crate) fn add_stiffness(&self, position: &[f64], velocity: &[f64], out: &mut DMatrixViewMut<f64>) {
        for touch in self.touches(position, velocity) {
            let Touch { row, arm, depth, factor } = touch;
            let mut change: Matrix3<f64> = row * row.transpose() * (self.stiffness * factor);
            // delta' = -J.v changes with theta by n.r theta', and J itself by -n.r.
            let by_turn = row * (self.stiffness * depth * self.damping * arm * velocity[2]);
            change.column_mut(2).axpy(-1.0, &by_turn, 1.0);
            change[(2, 2)] += self.force(&touch) * arm;
            let mut rigid = out.fixed_view_mut::<3, 3>(0, 0);
            rigid += change;
        }
    }

    /// Adds the derivative of -F J by the velocity.
    pub(crate) fn add_velocity_tangent(&self, position: &[f64], velocity: &[f64], out: &mut DMatrixViewMut<f64>) {
        for touch in self.touches(position, velocity) {
            let mut rigid = out.fixed_view_mut::<3, 3>(0, 0);
            rigid += touch.row * touch.row.transpose() * (self.stiffness * touch.depth * self.damping);
        }
    }

    /// Energy stored, J per metre of width.
    pub(crate) fn energy(&self, position: &[f64]) -> f64 {
        let still = vec![0.0; position.len()];
        self.touches(position, &still).map(|touch| 0.5 * self.stiffness * touch.depth * touch.depth).sum()
    }
}
