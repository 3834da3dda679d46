//! Contact of the cabin with walls, and the limit of the linear beam.
#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case has failed")]

mod common;
use common::{Parameters, cabin};
use kinematics::Support;
use nalgebra::{DMatrix, DVector, Vector2};
use structure::{ContactParameters, Error, Solver};

const MASS: f64 = 40.0;
const GRAVITY: f64 = 9.81;
/// Depth to which one corner sinks under the weight \[m\].
const DEPTH: f64 = 1e-3;

/// A box 0.4 m wide and 0.2 m high over a floor 0.15 m below its centre.
fn box_over_a_floor(damping: f64) -> Solver {
    let contact = ContactParameters {
        stiffness: MASS * GRAVITY / DEPTH,
        damping,
        reach: 50.0 * DEPTH,
        corners: [(-0.2, -0.1), (0.2, -0.1), (0.2, 0.1), (-0.2, 0.1)].map(|(x, y)| Vector2::new(x, y)).to_vec(),
        walls: vec![[Vector2::new(-5.0, -0.15), Vector2::new(5.0, -0.15)]],
    };
    common::built(Parameters {
        rigid_mass: MASS,
        angle: 0.0,
        rigid_inertia: 0.7,
        beam: None,
        contact: Some(contact),
        ..cabin(0, 1.0, GRAVITY)
    })
    .unwrap()
}

#[test]
fn tangents_of_a_touch_are_derivatives() {
    let solver = box_over_a_floor(3.0);
    let dynamics = solver.dynamics();
    // Turned so that one corner is 9 mm behind the floor, going down while it turns.
    let x = DVector::from_vec(vec![0.3, -0.02, 0.2]);
    let v = DVector::from_vec(vec![0.4, -0.3, 0.5]);
    let force = |x: &DVector<f64>, v: &DVector<f64>| {
        let mut out = DVector::zeros(3);
        dynamics.restoring_force(x, v, &mut out);
        out
    };
    let (mut stiffness, mut rate) = (DMatrix::zeros(3, 3), DMatrix::zeros(3, 3));
    dynamics.stiffness(&x, &v, &DVector::zeros(3), &mut stiffness);
    dynamics.velocity_tangent(&x, &v, &mut rate);
    assert!(stiffness[(1, 1)] > 0.5 * MASS * GRAVITY / DEPTH, "no corner touches: {stiffness}");
    for k in 0..3 {
        let mut step = DVector::zeros(3);
        step[k] = 1e-7;
        let by_x = (force(&(&x + &step), &v) - force(&(&x - &step), &v)) / 2e-7;
        let by_v = (force(&x, &(&v + &step)) - force(&x, &(&v - &step))) / 2e-7;
        let scale = stiffness.amax();
        assert!((stiffness.column(k) - by_x).amax() < 1e-6 * scale, "by coordinate {k}");
        assert!((rate.column(k) - by_v).amax() < 1e-6 * scale, "by rate {k}");
    }
}

/// Dropped from 50 mm at a slant it comes to rest on two corners, each half as deep as one would be; its energy only
/// falls.
#[test]
fn a_dropped_box_comes_to_rest_on_the_floor() {
    let solver = box_over_a_floor(5.0);
    let mut state = solver.initial_state(&[]).unwrap();
    state.motion.position[2] = 0.1;
    let mut workspace = solver.workspace();
    let energy = |state: &structure::State| solver.kinetic_energy(state) + solver.potential_energy(state);
    let start = energy(&state);
    let mut highest = f64::NEG_INFINITY;
    for _ in 0..8000 {
        let before = energy(&state);
        solver.step(&mut state, &[0.0; 3], 5e-4, &mut workspace).unwrap();
        highest = highest.max(energy(&state) - before);
    }
    let rest = -0.05 - 0.5 * DEPTH;
    let place = &state.motion.position;
    assert!((place[1] - rest).abs() < 0.05 * DEPTH && place[2].abs() < 1e-3, "rests at {place}, expected y = {rest}");
    assert!(state.motion.velocity.amax() < 1e-2, "still moves: {}", state.motion.velocity);
    assert!(highest < 1e-3 * start.abs().max(1.0), "the energy grows by {highest} J in a step");
}

#[test]
fn contact_without_sense_is_refused() {
    let mut parameters = box_over_a_floor(0.0).parameters().clone();
    if let Some(contact) = &mut parameters.bodies[0].contact {
        contact.walls[0][1] = contact.walls[0][0];
    }
    let text = structure::Solver::new(parameters).unwrap_err().to_string();
    assert!(text.contains("the length of a wall in contact"), "{text}");
}

#[test]
fn a_beam_bent_too_far_is_refused_with_place_and_limit() {
    let mut parameters = cabin(3, 40.0, 0.0);
    let mut beam = common::beam(Support::FixedFixed, 3, 40.0);
    beam.deflection_limit = 0.01;
    parameters.free = [false; 3];
    parameters.beam = Some(beam);
    let solver = common::built(parameters).unwrap();
    let mut state = solver.initial_state(&[]).unwrap();
    let before = state.clone();
    let mut load = [0.0; 6];
    load[3] = 100.0;
    assert_eq!(solver.step(&mut state, &load, 1e-4, &mut solver.workspace()).unwrap().unknowns, 3);
    state = before.clone();
    load[3] = 1e6;
    match solver.step(&mut state, &load, 1e-2, &mut solver.workspace()) {
        Err(error @ Error::Deflection { deflection, limit, time, .. }) => {
            assert!(error.to_string().contains("beyond -0.01 m"), "the limit on the side of the deflection: {error}");
            assert!(deflection.abs() > 0.01 && limit == 0.01 && time == 1e-2, "{deflection} {limit} {time}");
            // A load on the first mode above 0 bends the beam along eta, -x of the body.
            assert!(deflection < 0.0, "as the outputs have it: {deflection}");
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(state, before);
}
