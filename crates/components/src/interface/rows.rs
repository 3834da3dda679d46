//! The rows of both tables for the coordinates of the bodies.

use super::{ACCELERATION, ADDED_MASS, Interface, LOAD, LOAD_ACCELERATION, POSITION, ROW, VELOCITY};
use fmi::{Reference, Variable};
use kinematics::{Coordinate, Part};

/// One family of variables, a member for each coordinate.
pub struct Family {
    first: Reference,
    name: fn(&Interface, Coordinate) -> String,
    /// Types for x and y, theta, modes.
    types: [&'static str; 3],
    /// What stands before and after the coordinate in descriptions.
    description: [&'static str; 2],
}

/// The motion of the bodies: coordinates, rates, second derivatives.
pub const MOTIONS: [Family; 3] = [
    Family {
        first: POSITION,
        name: |interface, coordinate| interface.motion(coordinate)[0].clone(),
        types: ["Displacement", "Rotation", "ModalCoordinate"],
        description: ["coordinate", ""],
    },
    Family {
        first: VELOCITY,
        name: |interface, coordinate| interface.motion(coordinate)[1].clone(),
        types: ["Velocity", "AngularVelocity", "ModalVelocity"],
        description: ["rate of the coordinate", ""],
    },
    Family {
        first: ACCELERATION,
        name: |interface, coordinate| interface.motion(coordinate)[2].clone(),
        types: ["Acceleration", "AngularAcceleration", "ModalAcceleration"],
        description: ["second derivative of the coordinate", ""],
    },
];

/// The load of the water.
pub const LOADS: Family = Family {
    first: LOAD,
    name: Interface::load,
    types: ["Force", "Moment", "ModalLoad"],
    description: ["load of the fluid on the coordinate", ", mean over the communication step"],
};

/// The accelerations that the load belongs to.
pub const ANSWER: Family = Family {
    first: LOAD_ACCELERATION,
    name: Interface::load_acceleration,
    types: MOTIONS[2].types,
    description: ["second derivative of the coordinate", " that load.* belongs to, mean over the communication step"],
};

/// The variables of one family as outputs; the caller turns some of them into inputs.
pub fn family<C>(interface: &Interface, family: &Family, get: fn(&C, usize) -> f64) -> Vec<Variable<C>> {
    let [before, after] = family.description;
    let row = |(index, coordinate): (usize, Coordinate)| {
        let kind = family.types[size_of(coordinate.part)];
        let description = format!("{before} {}{after}", what(interface, coordinate));
        let reference = family.first + index as Reference;
        Variable::real(reference, (family.name)(interface, coordinate), description, kind, get).at(index)
    };
    interface.layout().coordinates().enumerate().map(row).collect()
}

/// The added mass as outputs, the half of the symmetric matrix on and above its diagonal. The index of an entry is that of
/// its row times the number of coordinates, and its column.
pub fn added_masses<C>(interface: &Interface, get: fn(&C, usize) -> f64) -> Vec<Variable<C>> {
    let all: Vec<Coordinate> = interface.layout().coordinates().collect();
    let entry = |(row, column): (usize, usize)| {
        let reference = ADDED_MASS + row as Reference * ROW + column as Reference;
        let meaning = "added mass: load.* falls by it for a unit of mean acceleration beyond load.a*";
        let kind = mass_type(all[row].part, all[column].part);
        Variable::real(reference, interface.added_mass(all[row], all[column]), meaning, kind, get)
            .at(row * all.len() + column)
    };
    let pairs = (0..all.len()).flat_map(|row| (row..all.len()).map(move |column| (row, column)));
    pairs.map(entry).collect()
}

/// A coordinate in descriptions.
fn what(interface: &Interface, coordinate: Coordinate) -> String {
    let body = &interface.bodies[coordinate.body];
    match coordinate.part {
        Part::X => format!("X of {}", body.name),
        Part::Y => format!("Y of {}", body.name),
        Part::Theta => format!("theta of {}", body.name),
        Part::Mode { member, mode } => format!("q{} of {} of {}", mode + 1, body.members[member].name, body.name),
    }
}

/// 0 for a translation, 1 for the rotation, 2 for a mode.
fn size_of(part: Part) -> usize {
    match part {
        Part::X | Part::Y => 0,
        Part::Theta => 1,
        Part::Mode { .. } => 2,
    }
}

/// Type of an entry of the added mass.
fn mass_type(row: Part, column: Part) -> &'static str {
    match (size_of(row).min(size_of(column)), size_of(row).max(size_of(column))) {
        (0, 0) => "Mass",
        (0, 1) => "MassMoment",
        (1, 1) => "Inertia",
        (0, _) => "ModalMassRatio",
        (1, _) => "ModalMassMoment",
        _ => "ModalMass",
    }
}
