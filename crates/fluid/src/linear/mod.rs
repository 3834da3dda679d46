//! Symmetric positive systems of equations: a sparse matrix, conjugate gradients, and their preconditioner. Nothing here
//! knows what the unknowns stand for, but that each has a place in the plane.

mod conjugate_gradient;
mod level;
mod multigrid;
mod sliced_matrix;

pub use conjugate_gradient::{ConjugateGradient, Guess, Outcome, SolveParameters};
pub use multigrid::Multigrid;
pub use sliced_matrix::{Entry, Matrix};
