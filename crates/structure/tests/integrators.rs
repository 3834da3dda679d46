//! Order, damping and the held load of the integrators; sensitivities of a step.
#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case has failed")]

mod common;
use common::{AVERAGE, Parameters, cabin, clamped, run, tumbling};
use kinematics::Support;
use structure::{Integrator, Solver, State};

const ALPHA: Integrator = Integrator::GeneralisedAlpha { rho_infinity: 0.6 };

/// Position and velocity after 0.2 s of the tumbling cabin under a load that varies smoothly, as its mean over every
/// step.
fn end(integrator: Integrator, steps: usize) -> Vec<f64> {
    let solver = common::built(Parameters { integrator, ..cabin(3, 40.0, 9.81) }).unwrap();
    let (mut state, mut workspace) = (tumbling(&solver), solver.workspace());
    let duration = 0.2 / steps as f64;
    for step in 0..steps {
        let (t0, t1) = (step as f64 * duration, (step + 1) as f64 * duration);
        // Mean of A sin(30 t) over the step.
        let mean = ((30.0 * t0).cos() - (30.0 * t1).cos()) / (30.0 * duration);
        let load = [300.0, -200.0, 50.0, 20.0, 10.0, -15.0].map(|amplitude| amplitude * mean);
        solver.step(&mut state, &load, duration, &mut workspace).unwrap();
    }
    state.motion.position.iter().chain(state.motion.velocity.iter()).copied().collect()
}

#[test]
fn both_integrators_are_of_second_order() {
    let reference = end(AVERAGE, 51_200);
    for integrator in [AVERAGE, ALPHA] {
        let error = |steps: usize| {
            let differences = end(integrator, steps).into_iter().zip(&reference).map(|(a, b)| (a - b).powi(2));
            differences.sum::<f64>().sqrt()
        };
        let errors = [800, 1600, 3200].map(error);
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((1.97..2.03).contains(&order), "{integrator:?}: order {order}, errors {errors:?}");
        }
    }
}

/// Growth per step of a vibration with omega H = `ratio`, measured over steps 50 to 250.
fn growth(integrator: Integrator, ratio: f64) -> f64 {
    let solver = common::built(Parameters { integrator, ..clamped(Support::FixedFixed, 1, 100.0) }).unwrap();
    let mut state = solver.initial_state(&[1.0]).unwrap();
    let size = |state: &State| solver.kinetic_energy(state) + solver.potential_energy(state);
    run(&solver, &mut state, &[0.0; 4], ratio / 100.0, 50);
    let before = size(&state);
    run(&solver, &mut state, &[0.0; 4], ratio / 100.0, 200);
    (size(&state) / before).powf(0.5 / 200.0)
}

#[test]
fn generalised_alpha_damps_high_frequencies_only() {
    for rho_infinity in [0.9, 0.8] {
        let integrator = Integrator::GeneralisedAlpha { rho_infinity };
        // The spectral radius at high frequency is rho; its double root adds a factor n^(1/n) near 1.
        let high = growth(integrator, 1e4);
        assert!((high / rho_infinity - 1.0).abs() < 0.02, "{rho_infinity}: {high}");
        // Forty steps a period, so that the measured interval holds five whole periods.
        let low = growth(integrator, 2.0 * std::f64::consts::PI / 40.0);
        assert!((0.9999..1.0).contains(&low), "{rho_infinity}: {low}");
    }
    assert!((growth(AVERAGE, 1e4) - 1.0).abs() < 1e-9, "average acceleration damps nothing");
    // rho = 0 leaves nothing after a few steps.
    let solver = common::built(Parameters {
        integrator: Integrator::GeneralisedAlpha { rho_infinity: 0.0 },
        ..clamped(Support::FixedFixed, 1, 100.0)
    })
    .unwrap();
    let mut state = solver.initial_state(&[1.0]).unwrap();
    run(&solver, &mut state, &[0.0; 4], 1e4, 5);
    assert!(state.motion.position[3].abs() < 1e-6, "{}", state.motion.position[3]);
}

#[test]
fn a_jumping_load_starts_no_oscillation_of_the_acceleration() {
    // A free rigid body: the acceleration of every step is that of its own load, whatever the load was before.
    for integrator in [AVERAGE, ALPHA] {
        let parameters = Parameters { beam: None, integrator, ..cabin(0, 50.0, 0.0) };
        let solver = common::built(parameters).unwrap();
        let (mut state, mut workspace) = (solver.initial_state(&[]).unwrap(), solver.workspace());
        for force in [222.6, -445.2, 890.4, 0.0, 111.3] {
            let before = state.motion.velocity[0];
            solver.step(&mut state, &[force, 0.0, 0.0], 0.01, &mut workspace).unwrap();
            assert!((state.motion.acceleration[0] - force / 222.6).abs() < 1e-12);
            if integrator == AVERAGE {
                let mean = (state.motion.velocity[0] - before) / 0.01;
                assert!((mean - force / 222.6).abs() < 1e-12, "{mean} {force}");
            }
        }
    }
}

#[test]
fn sensitivities_agree_with_differences() {
    let load = [500.0, 1500.0, 60.0, 30.0, -20.0, 10.0];
    for integrator in [AVERAGE, ALPHA, Integrator::Newmark { beta: 0.4, gamma: 0.7 }] {
        for free in [[true; 3], [false, true, true], [true, false, false], [false; 3]] {
            for warm_up in [0, 3] {
                let solver = common::built(Parameters { integrator, free, ..cabin(3, 40.0, 9.81) }).unwrap();
                let mut before = tumbling(&solver);
                for (k, free) in free.into_iter().enumerate() {
                    before.motion.velocity[k] *= f64::from(u8::from(free));
                }
                run(&solver, &mut before, &load, 0.01, warm_up);
                compare(&solver, &before, &load);
            }
        }
    }
}

/// Central differences of the step, entry by entry.
fn compare(solver: &Solver, before: &State, load: &[f64; 6]) {
    let step = |load: &[f64]| {
        let mut state = before.clone();
        run(solver, &mut state, load, 0.01, 1);
        state
    };
    let sensitivity = solver.sensitivity(before, &step(load), load, 0.01).unwrap();
    for column in 0..6 {
        let (mut minus, mut plus) = (*load, *load);
        minus[column] -= 1.0;
        plus[column] += 1.0;
        let (minus, plus) = (step(&minus).motion, step(&plus).motion);
        let parts = [
            (&sensitivity.position, &plus.position - &minus.position),
            (&sensitivity.velocity, &plus.velocity - &minus.velocity),
            (&sensitivity.acceleration, &plus.acceleration - &minus.acceleration),
        ];
        for (exact, difference) in parts {
            let difference = 0.5 * difference;
            let error = (exact.column(column) - &difference).norm();
            assert!(error < 1e-6 * exact.norm(), "column {column}: {} {difference}", exact.column(column));
            if column < 3 && !solver.parameters().bodies[0].free[column] {
                assert!(exact.column(column).norm() == 0.0 && exact.row(column).norm() == 0.0);
            }
        }
    }
}
