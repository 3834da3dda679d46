//! Structures that the tests share.
#![allow(dead_code, reason = "every test file uses some of these")]

use kinematics::{BeamModes, Support};
use nalgebra::{DVector, Vector2};
use structure::{BeamParameters, BodyParameters, ContactParameters, Integrator, Solver, State};

pub const LENGTH: f64 = 0.44;
pub const LINE_DENSITY: f64 = 44.9;
pub const AVERAGE: Integrator = Integrator::Newmark { beta: 0.25, gamma: 0.5 };

/// A beam of the paper's cabin (l 0.44 m, 2500 kg/m3, 17.96 mm) with the lowest frequency asked for, rad/s.
pub fn beam(support: Support, count: usize, frequency: f64) -> BeamParameters {
    let modes = BeamModes::new(support, LENGTH, LINE_DENSITY, count).unwrap();
    let unit = BeamModes::new(support, LENGTH, LINE_DENSITY, 1).unwrap().frequency(0, 1.0);
    let bending_stiffness = (frequency / unit).powi(2);
    BeamParameters {
        modes,
        middle: Vector2::new(0.05, 0.03),
        bending_stiffness,
        deflection_limit: f64::MAX,
        damping_ratios: Vec::new(),
    }
}

/// One body with one beam or none.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    pub rigid_mass: f64,
    pub rigid_inertia: f64,
    pub gravity: f64,
    pub angle: f64,
    pub beam: Option<BeamParameters>,
    pub free: [bool; 3],
    pub springs: [f64; 3],
    pub contact: Option<ContactParameters>,
    pub integrator: Integrator,
    pub tolerance: f64,
    pub maximum_iterations: usize,
}

impl From<Parameters> for structure::Parameters {
    fn from(one: Parameters) -> Self {
        let Parameters { rigid_mass, rigid_inertia, gravity, angle, beam, free, springs, contact, .. } = one;
        let members = beam.into_iter().collect();
        let body = BodyParameters { rigid_mass, rigid_inertia, angle, members, free, springs, contact };
        let Parameters { integrator, tolerance, maximum_iterations, .. } = one;
        Self { bodies: vec![body], gravity, integrator, tolerance, maximum_iterations }
    }
}

/// The solver of one body.
pub fn built(parameters: Parameters) -> Result<Solver, structure::Error> {
    Solver::new(parameters.into())
}

/// A cabin of the paper's mass with a beam that stands off its centre of gravity, nothing locked.
pub fn cabin(count: usize, frequency: f64, gravity: f64) -> Parameters {
    Parameters {
        rigid_mass: 222.6,
        rigid_inertia: 15.0,
        gravity,
        angle: 0.3,
        beam: Some(beam(Support::FixedFixed, count, frequency)),
        free: [true; 3],
        springs: [0.0; 3],
        contact: None,
        integrator: AVERAGE,
        tolerance: 1e-12,
        maximum_iterations: 20,
    }
}

/// A beam between immovable supports.
pub fn clamped(support: Support, count: usize, frequency: f64) -> Parameters {
    Parameters {
        rigid_mass: 0.0,
        rigid_inertia: 0.0,
        angle: 0.0,
        beam: Some(beam(support, count, frequency)),
        free: [false; 3],
        springs: [0.0; 3],
        contact: None,
        ..cabin(0, 1.0, 0.0)
    }
}

/// A state with this position and velocity.
pub fn state(solver: &Solver, position: &[f64], velocity: &[f64]) -> State {
    let mut state = solver.initial_state(&[]).unwrap();
    state.motion.position = DVector::from_column_slice(position);
    state.motion.velocity = DVector::from_column_slice(velocity);
    state
}

/// Steps without change of the load.
pub fn run(solver: &Solver, state: &mut State, load: &[f64], duration: f64, steps: usize) {
    let mut workspace = solver.workspace();
    for _ in 0..steps {
        solver.step(state, load, duration, &mut workspace).unwrap();
    }
}

/// A tumbling, vibrating start for a cabin with three modes: deflections of about a centimetre.
pub fn tumbling(solver: &Solver) -> State {
    state(solver, &[0.1, -0.2, 0.4, 0.03, -0.02, 0.01], &[0.4, -0.3, 1.5, 0.2, 0.3, -0.1])
}
