//! The variables through which fluid and structure meet. Names, references, units and order are the same at both ends;
//! an input of one is an output of the other. References do not depend on the number of modes.

use fmi2::{Failure, Reference, Variable};
use kinematics::{MAXIMUM_MODES, Motion, RIGID};
use serde::{Deserialize, Serialize};

/// Reference of `motion.x`; y, theta and the modal coordinates follow.
pub const POSITION: Reference = 100;
/// Reference of `motion.vx`; the other rates follow.
pub const VELOCITY: Reference = 120;
/// Reference of `motion.ax`; the other second derivatives follow.
pub const ACCELERATION: Reference = 140;
/// Reference of `load.fx`; fy, mz and the modal loads follow.
pub const LOAD: Reference = 200;

/// Reference of `load.ax`; the other accelerations that the load belongs to follow.
pub const LOAD_ACCELERATION: Reference = 220;
/// Reference of `added_mass[1,1]`; entries of a row follow, rows are `COORDINATES` apart.
pub const ADDED_MASS: Reference = 500;

/// Coordinates of the largest interface.
pub const COORDINATES: usize = RIGID + MAXIMUM_MODES;

/// Motion as it stands in the variables: room for every mode, whatever the scene uses.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct MotionValues {
    /// Coordinates.
    pub position: [f64; COORDINATES],
    /// Rates.
    pub velocity: [f64; COORDINATES],
    /// Second derivatives.
    pub acceleration: [f64; COORDINATES],
}

impl MotionValues {
    /// The first coordinates, as many as `motion` has, into it.
    pub fn write(&self, motion: &mut Motion) {
        let size = motion.size();
        motion.position.copy_from_slice(&self.position[..size]);
        motion.velocity.copy_from_slice(&self.velocity[..size]);
        motion.acceleration.copy_from_slice(&self.acceleration[..size]);
    }

    /// Refuses values of which one is no finite number; `name` is used in messages.
    pub fn check(&self, name: &str) -> Result<(), Failure> {
        finite(&format!("{name}.position"), &self.position)?;
        finite(&format!("{name}.velocity"), &self.velocity)?;
        finite(&format!("{name}.acceleration"), &self.acceleration)
    }

    /// A motion with any number of coordinates; the rest is zero.
    pub fn from_motion(motion: &Motion) -> Self {
        let mut values = Self::default();
        let size = motion.position.len();
        values.position[..size].copy_from_slice(motion.position.as_slice());
        values.velocity[..size].copy_from_slice(motion.velocity.as_slice());
        values.acceleration[..size].copy_from_slice(motion.acceleration.as_slice());
        values
    }
}

/// Refuses numbers of a state of which one is not finite; `name` is used in messages.
pub fn finite(name: &str, values: &[f64]) -> Result<(), Failure> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(Failure::refused(format!("{name}[{index}] = {}: expected a finite number", values[index]))),
        None => Ok(()),
    }
}

/// Kind of the added mass between two coordinates.
fn mass_type(row: usize, column: usize) -> &'static str {
    let class = |index: usize| if index < 2 { 0 } else { (index - 1).min(2) };
    match (class(row).min(class(column)), class(row).max(class(column))) {
        (0, 0) => "Mass",
        (0, 1) => "MassMoment",
        (1, 1) => "Inertia",
        (0, _) => "ModalMassRatio",
        (1, _) => "ModalMassMoment",
        _ => "ModalMass",
    }
}

/// Index of an entry of the added mass in a matrix of the largest interface.
pub fn mass_index(row: usize, column: usize) -> usize {
    row * COORDINATES + column
}

/// The accelerations that the load belongs to and the added mass, as outputs.
pub fn answer_variables<C>(
    modes: usize,
    acceleration: fn(&C, usize) -> f64,
    mass: fn(&C, usize) -> f64,
) -> [Vec<Variable<C>>; 2] {
    let size = RIGID + modes;
    let masses = (0..size * size).map(|entry| {
        let (row, column) = (entry / size, entry % size);
        let index = mass_index(row, column);
        let name = format!("added_mass[{},{}]", row + 1, column + 1);
        let meaning = "added mass: load.* falls by it for a unit of mean acceleration beyond load.a*";
        Variable::real(ADDED_MASS + index as Reference, name, meaning, mass_type(row, column), mass).at(index)
    });
    [family(&ANSWER, modes, acceleration), masses.collect()]
}

/// One family of the interface: first reference, names of the rigid coordinates, name of the modal ones, types and
/// descriptions of x and y, theta, q.
struct Family {
    first: Reference,
    rigid: [&'static str; RIGID],
    modal: &'static str,
    types: [&'static str; 3],
    description: [&'static str; 2],
}

const FAMILIES: [Family; 4] = [
    Family {
        first: POSITION,
        rigid: ["motion.x", "motion.y", "motion.theta"],
        modal: "motion.q",
        types: ["Displacement", "Rotation", "ModalCoordinate"],
        description: ["coordinate", "of the body"],
    },
    Family {
        first: VELOCITY,
        rigid: ["motion.vx", "motion.vy", "motion.vtheta"],
        modal: "motion.vq",
        types: ["Velocity", "AngularVelocity", "ModalVelocity"],
        description: ["rate of the coordinate", "of the body"],
    },
    Family {
        first: ACCELERATION,
        rigid: ["motion.ax", "motion.ay", "motion.atheta"],
        modal: "motion.aq",
        types: ["Acceleration", "AngularAcceleration", "ModalAcceleration"],
        description: ["second derivative of the coordinate", "of the body"],
    },
    Family {
        first: LOAD,
        rigid: ["load.fx", "load.fy", "load.mz"],
        modal: "load.q",
        types: ["Force", "Moment", "ModalLoad"],
        description: ["load of the fluid on the coordinate", "of the body, mean over the communication step"],
    },
];

/// The accelerations that the load belongs to: the fluid alone has them.
const ANSWER: Family = Family {
    first: LOAD_ACCELERATION,
    rigid: ["load.ax", "load.ay", "load.atheta"],
    modal: "load.aq",
    types: FAMILIES[2].types,
    description: ["second derivative of the coordinate", "that load.* belongs to, mean over the communication step"],
};

/// Access functions of the four families, in the order position, velocity, acceleration, load.
type Getters<C> = [fn(&C, usize) -> f64; 4];

/// The variables of the interface as outputs; the caller turns some of them into inputs.
pub fn variables<C>(modes: usize, get: Getters<C>) -> Vec<(Reference, Variable<C>)> {
    let all = FAMILIES.iter().zip(get);
    all.flat_map(|(of, get)| family(of, modes, get).into_iter().map(|variable| (of.first, variable))).collect()
}

/// The variables of one family as outputs.
fn family<C>(family: &Family, modes: usize, get: fn(&C, usize) -> f64) -> Vec<Variable<C>> {
    let variable = |index: usize| {
        let (name, kind, coordinate) = match index.checked_sub(RIGID) {
            None => (family.rigid[index].to_string(), family.types[index / 2], ["X", "Y", "theta"][index].to_string()),
            Some(mode) => (format!("{}[{}]", family.modal, mode + 1), family.types[2], format!("q[{}]", mode + 1)),
        };
        let description = format!("{} {coordinate} {}", family.description[0], family.description[1]);
        Variable::real(family.first + index as Reference, name, description, kind, get).at(index)
    };
    (0..RIGID + modes).map(variable).collect()
}

/// Which family a reference belongs to and which coordinate it is.
pub fn coordinate(reference: Reference) -> Option<(Reference, usize)> {
    FAMILIES.iter().chain([&ANSWER]).find_map(|family| {
        let index = reference.checked_sub(family.first)? as usize;
        (index < COORDINATES).then_some((family.first, index))
    })
}
