//! Several bodies, and several members on one.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod common;

use common::{LENGTH, LINE_DENSITY, Parameters, cabin};
use kinematics::{Beam, Body, MaterialPoint, Motion, Support};
use nalgebra::{DVector, Vector2};
use structure::{BodyParameters, Solver, State};

fn bodies(all: Vec<BodyParameters>) -> Solver {
    let one: structure::Parameters = cabin(0, 40.0, 9.81).into();
    Solver::new(structure::Parameters { bodies: all, ..one }).unwrap()
}

fn body(parameters: Parameters) -> BodyParameters {
    structure::Parameters::from(parameters).bodies.remove(0)
}

fn moving(solver: &Solver, seed: f64) -> State {
    let mut state = solver.initial_state(&[]).unwrap();
    for k in 0..state.motion.size() {
        state.motion.position[k] = 0.05 * (seed + k as f64).sin();
        state.motion.velocity[k] = 0.4 * (seed + 1.7 * k as f64).cos();
    }
    state
}

/// Bodies meet through the water alone: together they move as each by itself.
#[test]
fn two_bodies_move_as_each_alone() {
    let (first, second) = (body(cabin(3, 40.0, 9.81)), body(Parameters { rigid_mass: 50.0, ..cabin(1, 90.0, 9.81) }));
    let (a, b, both) = (bodies(vec![first.clone()]), bodies(vec![second.clone()]), bodies(vec![first, second]));
    let (mut state_a, mut state_b, mut state) = (moving(&a, 0.3), moving(&b, 1.1), both.initial_state(&[]).unwrap());
    let join = |x: &DVector<f64>, y: &DVector<f64>| DVector::from_iterator(10, x.iter().chain(y.iter()).copied());
    state.motion.position = join(&state_a.motion.position, &state_b.motion.position);
    state.motion.velocity = join(&state_a.motion.velocity, &state_b.motion.velocity);
    let load: Vec<f64> = (0..10).map(|k| 3.0 * f64::from(k).sin()).collect();
    let (mut scratch_a, mut scratch_b, mut scratch) = (a.workspace(), b.workspace(), both.workspace());
    for _ in 0..20 {
        a.step(&mut state_a, &load[..6], 1e-3, &mut scratch_a).unwrap();
        b.step(&mut state_b, &load[6..], 1e-3, &mut scratch_b).unwrap();
        both.step(&mut state, &load, 1e-3, &mut scratch).unwrap();
    }
    // The iteration ends where the residual of all is small, at most one correction apart.
    let apart = join(&state_a.motion.position, &state_b.motion.position) - &state.motion.position;
    assert!(apart.amax() < 1e-12, "{}", apart.amax());
    let energy = a.kinetic_energy(&state_a) + b.kinetic_energy(&state_b);
    assert!((both.kinetic_energy(&state) / energy - 1.0).abs() < 1e-10);
}

fn two_members() -> (Solver, Body) {
    let mut one = body(cabin(2, 40.0, 9.81));
    let mut other = common::beam(Support::ClampedFree, 3, 70.0);
    other.middle = Vector2::new(-0.2, 0.1);
    one.members.push(other);
    let beams = one.members.iter();
    let members = beams.map(|beam| Beam { middle: beam.middle, thickness: 0.02, modes: beam.modes.clone() }).collect();
    let shape = Body { origin: Vector2::zeros(), angle: one.angle, walls: Vec::new(), members };
    (bodies(vec![one]), shape)
}

/// T and the height part of V of the rigid part, summed up over the points of both beams.
fn energies_of_points(solver: &Solver, shape: &Body, motion: &Motion) -> (f64, f64) {
    let rigid = &solver.parameters().bodies[0];
    let centre = MaterialPoint::Rigid(Vector2::zeros());
    let spin = motion.velocity[2];
    let mut kinetic = 0.5 * rigid.rigid_mass * shape.velocity(centre, motion).norm_squared()
        + 0.5 * rigid.rigid_inertia * spin * spin;
    let mut weight = rigid.rigid_mass * 9.81 * shape.position(centre, motion).y;
    for member in 0..2 {
        for node in 0..=800 {
            // Simpson's rule along the beam.
            let weight_of = if node == 0 || node == 800 { 1.0 } else { 2.0 + 2.0 * f64::from(node % 2) };
            let mass = LINE_DENSITY * LENGTH / 2400.0 * weight_of;
            let point = MaterialPoint::Beam { member, station: LENGTH * f64::from(node) / 800.0, offset: 0.0 };
            kinetic += 0.5 * mass * shape.velocity(point, motion).norm_squared();
            weight += 9.81 * mass * shape.position(point, motion).y;
        }
    }
    (kinetic, weight)
}

#[test]
fn the_lagrangian_of_two_members_is_that_of_their_points() {
    let (solver, shape) = two_members();
    let dynamics = solver.dynamics();
    for seed in [0.2, 1.3, 2.9] {
        let motion = moving(&solver, seed).motion;
        let (kinetic, weight) = energies_of_points(&solver, &shape, &motion);
        let found = dynamics.kinetic_energy(&motion.position, &motion.velocity);
        assert!((found / kinetic - 1.0).abs() < 1e-8, "T {found} against {kinetic}");
        let bending: f64 = (0..5).map(|i| 0.5 * (dynamics.frequency(0, i) * motion.position[3 + i]).powi(2)).sum();
        let potential = dynamics.potential_energy(&motion.position);
        assert!(
            (potential - bending - weight).abs() < 1e-8 * weight.abs().max(1.0),
            "V {potential}, {bending}, {weight}"
        );
    }
}

/// The forces are those of the Lagrangian: without a load the energy stays, to the order of the average acceleration.
#[test]
fn two_members_keep_the_energy() {
    let (solver, _) = two_members();
    let drift = |duration: f64| {
        let (mut state, mut workspace) = (moving(&solver, 0.7), solver.workspace());
        let energy = |state: &State| solver.kinetic_energy(state) + solver.potential_energy(state);
        let start = energy(&state);
        let load = vec![0.0; 8];
        let mut worst = 0.0_f64;
        for _ in 0..(0.2 / duration).round() as usize {
            solver.step(&mut state, &load, duration, &mut workspace).unwrap();
            worst = worst.max((energy(&state) - start).abs());
        }
        worst / solver.kinetic_energy(&state)
    };
    let (coarse, fine) = (drift(1e-4), drift(5e-5));
    assert!(coarse < 1e-5 && fine < 0.35 * coarse, "{coarse}, {fine}");
}

#[test]
fn a_coordinate_of_one_of_several_bodies_is_named_with_it() {
    let solver = bodies(vec![body(cabin(1, 40.0, 9.81)), body(cabin(2, 40.0, 9.81))]);
    let mut load = vec![0.0; 9];
    load[8] = f64::NAN;
    let mut state = solver.initial_state(&[]).unwrap();
    let message = solver.step(&mut state, &load, 1e-3, &mut solver.workspace()).unwrap_err().to_string();
    assert!(message.contains("q[2] of body 2"), "{message}");
}
