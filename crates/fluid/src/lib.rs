//! Free-surface flow in two dimensions by the moving particle semi-implicit method.
//!
//! Two schemes: `accurate`, with Voronoi cells of the particles as weights, and `paper`, the classical weights.
//!
//! Governing equations: div u = 0 and Du/Dt = -grad p / rho + g, without viscosity. A step predicts velocities and
//! positions from gravity, solves a Poisson equation for the pressure that stops the compression, and corrects.
//! Walls are polylines; they clip cells, or fluid near a wall sees its own mirror image behind it (see [`images`]).
//!
//! `Solver::step` is a function of (state, motion of the walls, duration) only and gives the same bits for any
//! number of threads. All quantities are SI, per metre of width.

mod candidates;
mod check;
mod contact;
mod error;
mod fill;
mod free_surface;
mod gaps;
mod grid;
mod grid_level;
pub mod images;
mod kernel;
mod load;
mod matrix;
mod motion;
mod multigrid;
mod neighbours;
mod observe;
pub mod operators;
mod order;
mod outline;
mod panel_motion;
mod parallel;
mod parameters;
mod particles;
mod places;
mod prepare;
mod pressure;
mod report;
mod schedule;
mod sides;
mod solver;
mod stages;
mod state;
mod state_check;
mod steps;
mod voronoi;
mod wall_check;
mod walls;

pub use error::Error;
pub use images::{Image, Mirror};
pub use kernel::Kernel;
pub use neighbours::Neighbourhood;
pub use observe::Observables;
pub use parameters::{
    AccurateParameters, AffineVelocity, DampingZone, Geometry, Jitter, PaperParameters, Parameters, Probe, Region,
    Scheme, Shaking, SolveParameters, Source,
};
pub use places::{Instrument, Misplaced};
pub use report::{Report, StageTimes};
pub use solver::{SUGGESTED_SHARE, Solver, Workspace};
pub use stages::Stages;
pub use state::{AreaRate, State};
