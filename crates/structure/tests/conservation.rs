//! Free flight: energy and both momenta are those of the start, to the second order of the integrator.
#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case has failed")]

mod common;
use common::{cabin, run, tumbling};
use nalgebra::Vector2;
use structure::{Integrator, Solver, State};

/// Energy, linear and angular momentum.
fn invariants(solver: &Solver, state: &State) -> (f64, Vector2<f64>, f64) {
    let energy = solver.kinetic_energy(state) + solver.potential_energy(state);
    (energy, solver.linear_momentum(state), solver.angular_momentum(state))
}

/// Largest relative drifts of energy, linear and angular momentum over `end` s, against the laws of free fall.
fn drifts(gravity: f64, integrator: Integrator, duration: f64, end: f64) -> [f64; 3] {
    let parameters = common::Parameters { integrator, ..cabin(3, 40.0, gravity) };
    let solver = common::built(parameters).unwrap();
    let mut state = tumbling(&solver);
    let (energy, linear, angular) = invariants(&solver, &state);
    let mass = 222.6 + common::LINE_DENSITY * common::LENGTH;
    let first_moment = mass * state.motion.position[0] + first_moment(&solver, &state);
    let mut largest = [0.0_f64; 3];
    for step in 1..=(end / duration).round() as usize {
        run(&solver, &mut state, &[0.0; 6], duration, 1);
        let t = step as f64 * duration;
        // The weight acts at the centre of mass, which moves at constant speed along X.
        let fallen = linear - Vector2::new(0.0, mass * gravity * t);
        let turned = angular - gravity * (first_moment * t + 0.5 * linear.x * t * t);
        let now = invariants(&solver, &state);
        let drift =
            [(now.0 / energy - 1.0).abs(), (now.1 - fallen).norm() / linear.norm(), ((now.2 - turned) / angular).abs()];
        for (most, value) in largest.iter_mut().zip(drift) {
            *most = most.max(value);
        }
    }
    largest
}

/// First moment of the beam about o_R along X, kg m/m: (Rot m_b).x.
fn first_moment(solver: &Solver, state: &State) -> f64 {
    let beam = &solver.parameters().bodies[0].members[0];
    let q = &state.motion.position.as_slice()[3..];
    let psi: f64 = beam.modes.psi0().iter().zip(q).map(|(a, b)| a * b).sum();
    let (sin, cos) = (solver.parameters().bodies[0].angle + state.motion.position[2]).sin_cos();
    (beam.modes.mass() * beam.middle.x - psi) * cos - beam.modes.mass() * beam.middle.y * sin
}

#[test]
fn free_flight_conserves_energy_and_momenta() {
    for gravity in [0.0, 9.81] {
        let fine = drifts(gravity, common::AVERAGE, 1e-4, 1.0);
        assert!(fine.iter().all(|drift| *drift < 1e-6), "g = {gravity}: {fine:?}");
        let finer = drifts(gravity, common::AVERAGE, 5e-5, 1.0);
        for (a, b) in fine.iter().zip(finer) {
            assert!(*a < 1e-10 || (3.6..4.4).contains(&(a / b)), "g = {gravity}: {fine:?} {finer:?}");
        }
    }
}

#[test]
fn generalised_alpha_keeps_what_it_resolves() {
    let fine = drifts(9.81, Integrator::GeneralisedAlpha { rho_infinity: 1.0 }, 1e-4, 1.0);
    assert!(fine.iter().all(|drift| *drift < 3e-6), "{fine:?}");
}

#[test]
fn a_rigid_body_flies_as_newton_says() {
    // Without a beam: parabola and constant spin, which the average acceleration integrates exactly.
    let parameters = common::Parameters { beam: None, ..cabin(0, 40.0, 9.81) };
    let solver = common::built(parameters).unwrap();
    let mut state = common::state(&solver, &[0.0; 3], &[1.0, 2.0, 3.0]);
    run(&solver, &mut state, &[0.0; 3], 0.01, 100);
    let expected = [1.0, 2.0 - 0.5 * 9.81, 3.0];
    for (value, exact) in state.motion.position.iter().zip(expected) {
        assert!((value - exact).abs() < 1e-12, "{value} {exact}");
    }
}
