//! What survives a step, what does not, and what a step reports.

use kinematics::Motion;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Everything that the next step starts from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Time, s. A step adds its duration; who owns a grid of times may set the exact one afterwards.
    pub time: f64,
    /// Coordinates, rates and accelerations, in equilibrium with the load of the last step.
    pub motion: Motion,
    /// Acceleration memory of generalised-alpha; None before its first step, and always for Newmark, which has no
    /// memory.
    pub algorithmic_acceleration: Option<DVector<f64>>,
}

/// Scratch of a step; holds nothing that a later step needs. Made by [`crate::Solver::workspace`].
#[derive(Debug, Clone)]
pub struct Workspace {
    /// M, at the point last evaluated.
    pub(crate) mass: DMatrix<f64>,
    /// d force / d position, at the point last evaluated.
    pub(crate) stiffness: DMatrix<f64>,
    /// d force / d velocity, at the point last evaluated.
    pub(crate) velocity_tangent: DMatrix<f64>,
    /// h + grad V + C xd, at the point last evaluated.
    pub(crate) restoring: DVector<f64>,
    /// Residual M a + f - Q, at the point last evaluated.
    pub(crate) residual: DVector<f64>,
    /// Sizes of the forces at the start of the step, and there and at the end.
    pub(crate) sizes: [DVector<f64>; 2],
    /// Motion at the end of the step, as far as the iteration has it.
    pub(crate) end: Motion,
    /// Motion at which equilibrium is asked for: the end, or a point before it with generalised-alpha.
    pub(crate) point: Motion,
}

impl Workspace {
    pub(crate) fn new(size: usize) -> Self {
        let motion = Motion::zeros(size);
        let matrix = DMatrix::zeros(size, size);
        Self {
            mass: matrix.clone(),
            stiffness: matrix.clone(),
            velocity_tangent: matrix,
            restoring: DVector::zeros(size),
            residual: DVector::zeros(size),
            sizes: [DVector::zeros(size), DVector::zeros(size)],
            end: motion.clone(),
            point: motion,
        }
    }
}

/// How a step went.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Coordinates solved for: the free ones of the rigid part, and the modes.
    pub unknowns: usize,
    /// Newton-Raphson iterations (linear systems solved).
    pub iterations: usize,
    /// Last relative residual: residual force over the sizes of all forces, both weighted by the diagonal of the mass
    /// matrix.
    pub residual: f64,
}

/// Derivatives of the motion at the end of a step by the load held over it, each (3+N) x (3+N): entry (i, j) is by load
/// component j. Rows and columns of locked coordinates are zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// d position / d load.
    pub position: DMatrix<f64>,
    /// d velocity / d load.
    pub velocity: DMatrix<f64>,
    /// d acceleration / d load.
    pub acceleration: DMatrix<f64>,
}
