//! Units and types of the variables; both components share them, so that connected variables have equal units.

use fmi::{SimpleType, Unit};

/// Name, exponents of kg, m, s, rad. Units of modal quantities have square roots and thus no exponents.
const UNITS: [(&str, Option<[i8; 4]>); 25] = [
    ("m", Some([0, 1, 0, 0])),
    ("m/s", Some([0, 1, -1, 0])),
    ("m/s2", Some([0, 1, -2, 0])),
    ("rad", Some([0, 0, 0, 1])),
    ("rad/s", Some([0, 0, -1, 1])),
    ("rad/s2", Some([0, 0, -2, 1])),
    ("m.sqrt(kg/m)", None),
    ("m.sqrt(kg/m)/s", None),
    ("m.sqrt(kg/m)/s2", None),
    ("N/m", Some([1, 0, -2, 0])),
    ("N.m/m", Some([1, 1, -2, 0])),
    ("N/(m.sqrt(kg/m))", None),
    ("Pa", Some([1, -1, -2, 0])),
    ("Pa.s", Some([1, -1, -1, 0])),
    ("kg/m", Some([1, -1, 0, 0])),
    ("kg/(m.s)", Some([1, -1, -1, 0])),
    ("J/m", Some([1, 1, -2, 0])),
    ("N.s/m", Some([1, 0, -1, 0])),
    ("s", Some([0, 0, 1, 0])),
    ("m2", Some([0, 2, 0, 0])),
    ("N.m.s/m", Some([1, 1, -1, 0])),
    ("kg.m/m", Some([1, 0, 0, 0])),
    ("kg.m2/m", Some([1, 1, 0, 0])),
    ("sqrt(kg/m)", None),
    ("1", Some([0, 0, 0, 0])),
];

/// Name, quantity, unit, meaning. Mechanical quantities are per metre of width.
const TYPES: [(&str, &str, &str, &str); 27] = [
    ("Displacement", "Length", "m", "displacement from the pose in the scene"),
    ("Velocity", "Velocity", "m/s", "velocity"),
    ("Acceleration", "Acceleration", "m/s2", "acceleration"),
    ("Rotation", "Angle", "rad", "rotation from the pose in the scene, counter-clockwise"),
    ("AngularVelocity", "AngularVelocity", "rad/s", "angular velocity, counter-clockwise"),
    ("AngularAcceleration", "AngularAcceleration", "rad/s2", "angular acceleration, counter-clockwise"),
    ("ModalCoordinate", "ModalCoordinate", "m.sqrt(kg/m)", "coordinate of a mass-normalised mode"),
    ("ModalVelocity", "ModalVelocity", "m.sqrt(kg/m)/s", "rate of a modal coordinate"),
    ("ModalAcceleration", "ModalAcceleration", "m.sqrt(kg/m)/s2", "second derivative of a modal coordinate"),
    ("Force", "ForcePerWidth", "N/m", "force per metre of width"),
    ("Moment", "MomentPerWidth", "N.m/m", "moment per metre of width about the centre of gravity of the rigid part"),
    ("ModalLoad", "ModalLoad", "N/(m.sqrt(kg/m))", "load on a modal coordinate per metre of width"),
    ("Pressure", "Pressure", "Pa", "pressure or modulus"),
    ("PressureImpulse", "PressureImpulse", "Pa.s", "impulse of a pressure per area"),
    ("Mass", "MassPerWidth", "kg/m", "mass per metre of width"),
    ("MassFlow", "MassFlowPerWidth", "kg/(m.s)", "mass per time and metre of width"),
    ("Energy", "EnergyPerWidth", "J/m", "energy per metre of width"),
    ("Momentum", "MomentumPerWidth", "N.s/m", "momentum per metre of width"),
    ("Duration", "Time", "s", "duration"),
    ("Length", "Length", "m", "length or coordinate"),
    ("Area", "Area", "m2", "area in the plane"),
    ("AngularMomentum", "AngularMomentumPerWidth", "N.m.s/m", "angular momentum per metre of width"),
    ("MassMoment", "MassMomentPerWidth", "kg.m/m", "mass times lever per metre of width"),
    ("Inertia", "InertiaPerWidth", "kg.m2/m", "moment of inertia per metre of width"),
    ("ModalMass", "ModalMass", "1", "mass between two mass-normalised modes"),
    ("ModalMassRatio", "ModalMassRatio", "sqrt(kg/m)", "mass between a translation and a mass-normalised mode"),
    ("ModalMassMoment", "ModalMassMoment", "m.sqrt(kg/m)", "mass between a rotation and a mass-normalised mode"),
];

/// All units.
pub fn units() -> Vec<Unit> {
    UNITS.iter().map(|&(name, exponents)| Unit { name, exponents }).collect()
}

/// All types.
pub fn types() -> Vec<SimpleType> {
    let row = |&(name, quantity, unit, description)| SimpleType { name, quantity, unit, description };
    TYPES.iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_has_a_defined_unit() {
        for simple in types() {
            assert!(units().iter().any(|unit| unit.name == simple.unit), "{}", simple.name);
        }
    }
}
