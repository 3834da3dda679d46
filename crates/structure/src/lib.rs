//! Dynamics of rigid bodies with Euler-Bernoulli beams in modal form, in two dimensions, per metre of width.
//!
//! ```text
//! M(x) xdd + h(x, xd) + grad V(x) + C xd = Q,      x = [X, Y, theta, q_1 .. q_N] of each body
//! ```
//!
//! with the exact Lagrangian mass matrix and forces of [`Dynamics`], integrated by [`Solver`]. See README.md for the
//! equations.
//!
//! - [`Parameters`]: masses, members, supports of the bodies, method; validated once;
//! - [`State`]: all that survives a step; [`Workspace`]: scratch; [`Report`]: how a step went;
//! - [`Solver::step`]: computes, then commits: the state is unchanged on any error;
//! - [`Solver::sensitivity`]: derivatives of a step by its load.

mod added_mass;
mod body_dynamics;
mod contact;
mod dynamics;
mod error;
mod newton;
mod parameters;
mod scheme;
mod sensitivity;
mod solver;
mod state;
mod system;

pub use added_mass::AddedMass;
pub use dynamics::Dynamics;
pub use error::Error;
pub use parameters::{BeamParameters, BodyParameters, ContactParameters, Integrator, Parameters};
pub use solver::Solver;
pub use state::{Report, Sensitivity, State, Workspace};
