//! The equations of motion of all bodies, `M(x) xdd + h(x, xd) + grad V(x) + C xd = Q`, and their exact derivatives: those of
//! each body in its own rows and columns. Bodies meet through the water alone.

use crate::Parameters;
use crate::body_dynamics::BodyDynamics;
use kinematics::{CoordinateLayout, Motion};
use nalgebra::{DMatrix, DMatrixViewMut, DVector, DVectorViewMut, Vector2};
use std::ops::Range;

/// The Lagrangian of bodies with their members, free of any time integration. Every vector and matrix is of the full size,
/// locked coordinates included.
#[derive(Debug, Clone, PartialEq)]
pub struct Dynamics {
    bodies: Vec<(BodyDynamics, Range<usize>)>,
    layout: CoordinateLayout,
}

impl Dynamics {
    /// Constants of the equations; the parameters are taken as validated.
    pub(crate) fn new(parameters: &Parameters) -> Self {
        let layout = parameters.layout();
        let body = |(index, body)| (BodyDynamics::new(body, parameters.gravity), layout.body(index));
        Self { bodies: parameters.bodies.iter().enumerate().map(body).collect(), layout }
    }

    /// Which coordinate is what.
    pub fn layout(&self) -> &CoordinateLayout {
        &self.layout
    }

    /// Number n of coordinates.
    pub fn size(&self) -> usize {
        self.layout.size()
    }

    /// Natural circular frequency of a mode (from 0) of the members of a body, one after the other, between fixed
    /// supports, in vacuo, rad/s.
    pub fn frequency(&self, body: usize, mode: usize) -> f64 {
        self.bodies[body].0.frequency(mode)
    }

    /// M(x) into `out`, n x n: symmetric, positive definite.
    pub fn mass_matrix(&self, position: &DVector<f64>, out: &mut DMatrix<f64>) {
        self.blocks(out, |body, own, block| body.mass_matrix(part(position, own), block));
    }

    /// `h(x, xd) + grad V(x) + C xd` into `out`, n.
    pub fn restoring_force(&self, position: &DVector<f64>, velocity: &DVector<f64>, out: &mut DVector<f64>) {
        for (body, own) in &self.bodies {
            body.restoring_force(part(position, own), part(velocity, own), &mut rows(out, own));
        }
    }

    /// Adds to `out`, n, the size of every force that `M xdd` and [`Dynamics::restoring_force`] are summed up from.
    ///
    /// The sums themselves vanish in equilibrium; these do not, and so tell how much of a residual is more than
    /// rounding. `mass` is M at this position.
    pub(crate) fn add_force_sizes(&self, motion: &Motion, mass: &DMatrix<f64>, out: &mut DVector<f64>) {
        for (body, own) in &self.bodies {
            let block = mass.view((own.start, own.start), (own.len(), own.len()));
            body.add_force_sizes(&motion.view(own.clone()), &block, &mut rows(out, own));
        }
    }

    /// d(M(x) xdd + h + grad V + C xd)/dx into `out`, n x n; not symmetric.
    pub fn stiffness(
        &self,
        position: &DVector<f64>,
        velocity: &DVector<f64>,
        acceleration: &DVector<f64>,
        out: &mut DMatrix<f64>,
    ) {
        self.blocks(out, |body, own, block| {
            body.stiffness(part(position, own), part(velocity, own), part(acceleration, own), block);
        });
    }

    /// d(h + C xd)/d(xd) into `out`, n x n; not symmetric.
    pub fn velocity_tangent(&self, position: &DVector<f64>, velocity: &DVector<f64>, out: &mut DMatrix<f64>) {
        self.blocks(out, |body, own, block| body.velocity_tangent(part(position, own), part(velocity, own), block));
    }

    /// T = 1/2 xd.M(x) xd, J per metre of width.
    pub fn kinetic_energy(&self, position: &DVector<f64>, velocity: &DVector<f64>) -> f64 {
        0.5 * velocity.dot(&self.momenta(position, velocity))
    }

    /// V, J per metre of width: weight (zero with each o_R at its place in the scene and everything at its height), springs,
    /// contact and bending.
    pub fn potential_energy(&self, position: &DVector<f64>) -> f64 {
        self.bodies.iter().map(|(body, own)| body.potential_energy(part(position, own))).sum()
    }

    /// Linear momentum of all bodies in the global frame, kg m/s per metre of width.
    pub fn linear_momentum(&self, position: &DVector<f64>, velocity: &DVector<f64>) -> Vector2<f64> {
        let momenta = self.momenta(position, velocity);
        self.bodies.iter().map(|(_, own)| Vector2::new(momenta[own.start], momenta[own.start + 1])).sum()
    }

    /// Angular momentum, each body about the place of its o_R in the scene (a fixed point), kg m2/s per metre of width.
    pub fn angular_momentum(&self, position: &DVector<f64>, velocity: &DVector<f64>) -> f64 {
        // dT/d(theta-dot) is the momentum about o_R where it is now; the rest carries it to the fixed point.
        let momenta = self.momenta(position, velocity);
        let of = |own: &Range<usize>| {
            let (x, momenta) = (part(position, own), part(&momenta, own));
            momenta[2] + x[0] * momenta[1] - x[1] * momenta[0]
        };
        self.bodies.iter().map(|(_, own)| of(own)).sum()
    }

    /// dT/d(xd) = M(x) xd.
    fn momenta(&self, position: &DVector<f64>, velocity: &DVector<f64>) -> DVector<f64> {
        let mut mass = DMatrix::zeros(self.size(), self.size());
        self.mass_matrix(position, &mut mass);
        mass * velocity
    }

    /// Fills in a matrix body by body.
    fn blocks(&self, out: &mut DMatrix<f64>, fill: impl Fn(&BodyDynamics, &Range<usize>, &mut DMatrixViewMut<f64>)) {
        out.fill(0.0);
        for (body, own) in &self.bodies {
            let mut block = out.view_mut((own.start, own.start), (own.len(), own.len()));
            fill(body, own, &mut block);
        }
    }
}

fn part<'a>(vector: &'a DVector<f64>, own: &Range<usize>) -> &'a [f64] {
    &vector.as_slice()[own.clone()]
}

fn rows<'a>(vector: &'a mut DVector<f64>, own: &Range<usize>) -> DVectorViewMut<'a, f64> {
    vector.rows_range_mut(own.clone())
}
