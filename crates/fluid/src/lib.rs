//! Free-surface flow in two dimensions by the moving particle semi-implicit method.
//!
//! Two discretisations: `voronoi`, with Voronoi cells of the particles as weights, and `mps`, the classical weights.
//!
//! Governing equations: div u = 0 and Du/Dt = -grad p / rho + g, without viscosity. A step predicts velocities and
//! positions from gravity, solves a Poisson equation for the pressure that stops the compression, and corrects.
//! Walls are polylines; they clip cells, or fluid near a wall sees its own mirror image behind it (see [`Image`]).
//!
//! `Solver::step` is a function of (state, motion of the walls, duration) only and gives the same bits for any
//! number of threads. All quantities are SI, per metre of width.
//!
//! How the parts rest on each other, from below: `parallel`, `grid`, `linear` know nothing of water; `walls` and `setup`
//! nothing of steps; `problem` and `state` are what a step is of; `discretisation` says what a step must do, `voronoi` and
//! `mps` do it; `solver` makes communication steps of it.

mod balance;
mod diagnostics;
mod discretisation;
mod error;
mod gas;
mod grid;
mod linear;
mod motion;
mod mps;
mod order;
mod parallel;
mod parameters;
mod particles;
mod pressure_field;
mod problem;
mod report;
mod sensors;
mod setup;
mod solver;
mod state;
mod time_step;
mod voronoi;
mod walls;

pub use balance::{Gain, Gains};
pub use diagnostics::Observables;
pub use error::Error;
pub use gas::{Account, Gas, GasParameters, Pocket, Reading};
pub use linear::SolveParameters;
pub use mps::images::{Image, Mirror};
pub use mps::kernel::Kernel;
pub use parameters::{
    AffineVelocity, Chamber, DampingZone, Geometry, Jitter, MpsParameters, Parameters, Probe, Region, Scheme, Shaking,
    Source, Vent, VoronoiParameters,
};
pub use report::{Report, StageTimes};
pub use sensors::Sensor;
pub use setup::places::{Instrument, Misplaced};
pub use solver::{SUGGESTED_SHARE, Solver, Workspace};
pub use state::{AreaRate, State};
pub use voronoi::Stages;
