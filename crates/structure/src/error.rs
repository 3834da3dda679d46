//! What can go wrong, with the numbers that show it.

use digits::six;
use kinematics::{Coordinate, CoordinateLayout, Part};

/// An input that is refused or a step that could not be made. The state is unchanged in every case.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter outside its range.
    #[error("{what} is {}, but has to be {range}", six(*value))]
    Parameter {
        /// The parameter, with its unit.
        what: String,
        /// What was given.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// A list of another length than the number of modes or coordinates asks for.
    #[error("{what} has {got} entries, but the structure needs {expected}")]
    Length {
        /// The list.
        what: &'static str,
        /// Entries needed.
        expected: usize,
        /// Entries given.
        got: usize,
    },
    /// A generalised load that is not a finite number.
    #[error("load component {component} is {value} at t = {} s; every component has to be finite", six(*time))]
    LoadNotFinite {
        /// Name of the component: fx, fy, mz, q\[1\] ...
        component: String,
        /// What was given.
        value: f64,
        /// Start of the step, s.
        time: f64,
    },
    /// A state whose motion is not finite.
    #[error(
        "{rate} of coordinate {coordinate} is {value} at t = {} s; every entry of a state has to be finite",
        six(*time)
    )]
    StateNotFinite {
        /// Name of the coordinate: x, y, theta, q\[1\] ...
        coordinate: String,
        /// Which of position, velocity and acceleration.
        rate: &'static str,
        /// What was found.
        value: f64,
        /// Time of the state, s.
        time: f64,
    },
    /// A state in which a locked coordinate moves.
    #[error(
        "coordinate {coordinate} is locked but has the velocity {} at t = {} s; set it to 0 or free the coordinate",
        six(*velocity), six(*time)
    )]
    LockedMoves {
        /// Name of the coordinate.
        coordinate: String,
        /// Its velocity.
        velocity: f64,
        /// Time of the state, s.
        time: f64,
    },
    /// A step that is not positive and finite.
    #[error("the step is {} s at t = {} s, but has to be positive and finite", six(*duration), six(*time))]
    Duration {
        /// What was given, s.
        duration: f64,
        /// Start of the step, s.
        time: f64,
    },
    /// Newton-Raphson ran out of iterations or met a number that is not finite.
    #[error(
        "step of {} s at t = {} s did not converge: relative residual {} after {iterations} iterations, tolerance {}; use a \
         smaller step",
        six(*duration), six(*time), six(*residual), six(*tolerance)
    )]
    NotConverged {
        /// Start of the step, s.
        time: f64,
        /// Its length, s.
        duration: f64,
        /// Iterations made.
        iterations: usize,
        /// Residual force over the sizes of all forces, both weighted by the diagonal of the mass matrix.
        residual: f64,
        /// What it should have come down to.
        tolerance: f64,
    },
    /// A deflection beyond which the beam is no longer linear.
    #[error(
        "the beam deflects by {} m along +x of the body at {} m along it at t = {} s, beyond {} m, up to which it counts as \
         linear; use a stiffer beam, or raise its `deflection_limit` knowing that stretching and rotation are left out",
        six(*deflection), six(*station), six(*time), six(limit.copysign(*deflection))
    )]
    Deflection {
        /// What the step gave, m, positive along +x of the body as the outputs of the structure have it.
        deflection: f64,
        /// Where along the beam, m.
        station: f64,
        /// End of the step, s.
        time: f64,
        /// Limit, m.
        limit: f64,
    },
    /// A system matrix that could not be factorised.
    #[error(
        "the {matrix} of {size} free coordinates is singular at t = {} s; use a smaller step or check the masses",
        six(*time)
    )]
    Singular {
        /// Mass matrix or tangent.
        matrix: &'static str,
        /// Number of free coordinates.
        size: usize,
        /// Start of the step, s.
        time: f64,
    },
}

/// Name of a coordinate, as the variables of the interface have it; with its body where there are several.
pub(crate) fn coordinate_name(layout: &CoordinateLayout, index: usize) -> String {
    name(layout, index, ["x", "y", "theta"])
}

/// Name of a component of the generalised load.
pub(crate) fn load_name(layout: &CoordinateLayout, index: usize) -> String {
    name(layout, index, ["fx", "fy", "mz"])
}

fn name(layout: &CoordinateLayout, index: usize, [x, y, theta]: [&str; 3]) -> String {
    let Some(Coordinate { body, part }) = layout.coordinates().nth(index) else { return format!("coordinate {index}") };
    let own = match part {
        Part::X => x.to_string(),
        Part::Y => y.to_string(),
        Part::Theta => theta.to_string(),
        Part::Mode { .. } => format!("q[{}]", index + 1 - layout.rigid(body).end),
    };
    if layout.bodies() == 1 { own } else { format!("{own} of body {}", body + 1) }
}
