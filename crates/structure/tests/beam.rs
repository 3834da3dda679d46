//! The beam against its textbook: frequencies, damping, static deflections; and the pendulum that checks the angle.
#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case has failed")]

mod common;
use common::{LENGTH, LINE_DENSITY, Parameters, cabin, clamped, run};
use kinematics::Support::{ClampedFree, FixedFixed};
use structure::Integrator;

/// Mean circular frequency over whole periods of the sign changes of `value`, sampled every `duration`.
fn frequency_of(samples: &[f64], duration: f64) -> f64 {
    let crossings: Vec<f64> = samples
        .windows(2)
        .enumerate()
        .filter(|(_, pair)| pair[0] > 0.0 && pair[1] <= 0.0)
        .map(|(index, pair)| (index as f64 + pair[0] / (pair[0] - pair[1])) * duration)
        .collect();
    let periods = (crossings.len() - 1) as f64;
    2.0 * std::f64::consts::PI * periods / (crossings[crossings.len() - 1] - crossings[0])
}

#[test]
fn free_decay_has_the_natural_frequencies() {
    for support in [FixedFixed, ClampedFree] {
        let solver = common::built(clamped(support, 3, 508.4265)).unwrap();
        for mode in 0..3 {
            let exact = solver.dynamics().frequency(0, mode);
            let duration = 0.02 / exact;
            let mut initial = [0.0; 3];
            initial[mode] = 0.01;
            let mut state = solver.initial_state(&initial).unwrap();
            let mut samples = vec![0.01];
            for _ in 0..6000 {
                run(&solver, &mut state, &[0.0; 6], duration, 1);
                samples.push(state.motion.position[3 + mode]);
            }
            let measured = frequency_of(&samples, duration);
            // Average acceleration lengthens the period by (omega H)^2/12: omega_H = 2/H atan(omega H/2) (Hughes 1987).
            let discrete = 2.0 / duration * (0.5 * exact * duration).atan();
            assert!((measured / discrete - 1.0).abs() < 1e-9, "{support:?} {mode}: {measured} {discrete}");
            assert!((measured / exact - 1.0).abs() < 4e-5, "{support:?} {mode}: {measured} {exact}");
        }
    }
}

#[test]
fn the_paper_s_bulkhead_has_the_printed_frequencies() {
    // Table 1: 508.4265, 1401.4972, 2747.4948 rad/s.
    let solver = common::built(clamped(FixedFixed, 3, 508.4265)).unwrap();
    for (mode, printed) in [508.4265, 1401.4972, 2747.4948].into_iter().enumerate() {
        assert!((solver.dynamics().frequency(0, mode) / printed - 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_cart_that_rolls_freely_raises_the_frequency() {
    // X and q alone: (1 - psi0^2/M) qdd + omega^2 q = 0, by elimination of X.
    let parameters = Parameters { free: [true, false, false], angle: 0.0, ..cabin(1, 50.0, 0.0) };
    let solver = common::built(Parameters { rigid_mass: 5.0, ..parameters }).unwrap();
    let psi0 = solver.parameters().bodies[0].members[0].modes.psi0()[0];
    let exact = 50.0 / (1.0 - psi0 * psi0 / (5.0 + LINE_DENSITY * LENGTH)).sqrt();
    let duration = 0.005 / exact;
    let mut state = solver.initial_state(&[0.01]).unwrap();
    let mut samples = vec![0.01];
    for _ in 0..8000 {
        run(&solver, &mut state, &[0.0; 4], duration, 1);
        samples.push(state.motion.position[3]);
    }
    let measured = frequency_of(&samples, duration);
    assert!(exact > 60.0 && (measured / exact - 1.0).abs() < 5e-6, "{measured} {exact}");
}

#[test]
fn modal_damping_decays_as_said() {
    let mut parameters = clamped(ClampedFree, 2, 30.0);
    parameters.beam.as_mut().unwrap().damping_ratios = vec![0.02, 0.05];
    let solver = common::built(parameters).unwrap();
    for (mode, ratio) in [(0, 0.02_f64), (1, 0.05)] {
        let frequency = solver.dynamics().frequency(0, mode);
        let mut initial = [0.0; 2];
        initial[mode] = 1.0;
        let mut state = solver.initial_state(&initial).unwrap();
        let damped = frequency * (1.0 - ratio * ratio).sqrt();
        let period = 2.0 * std::f64::consts::PI / damped;
        run(&solver, &mut state, &[0.0; 5], period / 1000.0, 5000);
        // Five damped periods after a start from rest: q = exp(-zeta omega t).
        let expected = (-ratio * frequency * 5.0 * period).exp();
        assert!((state.motion.position[3 + mode] / expected - 1.0).abs() < 1e-4);
    }
}

/// Static deflection under a uniform pressure p: steps that are long against every period, by the
/// generalised-alpha method that annihilates what it does not resolve.
fn static_deflection(support: kinematics::Support, count: usize, pressure: f64, station: f64) -> f64 {
    let integrator = Integrator::GeneralisedAlpha { rho_infinity: 0.0 };
    let solver = common::built(Parameters { integrator, ..clamped(support, count, 100.0) }).unwrap();
    let psi0 = solver.parameters().bodies[0].members[0].modes.psi0();
    let mut load = vec![0.0; 3];
    load.extend(psi0.iter().map(|psi0| pressure * psi0 / LINE_DENSITY));
    let mut state = solver.initial_state(&[]).unwrap();
    run(&solver, &mut state, &load, 10.0, 12);
    solver.deflection(&state, 0, 0, station)
}

#[test]
fn static_deflections_agree_with_beam_theory() {
    // p l^4/(384 EJ) at the middle of a fixed-fixed beam, p l^4/(8 EJ) at the tip of a cantilever.
    for (support, station, divisor) in [(FixedFixed, 0.5 * LENGTH, 384.0), (ClampedFree, LENGTH, 8.0)] {
        let stiffness = common::beam(support, 1, 100.0).bending_stiffness;
        let exact = 1000.0 * LENGTH.powi(4) / (divisor * stiffness);
        // The series converges as the fifth power of the mode number.
        for (count, tolerance) in [(1, 2e-2), (3, 5e-3), (10, 3e-5), (40, 5e-8)] {
            let value = static_deflection(support, count, 1000.0, station);
            assert!((value / exact - 1.0).abs() < tolerance, "{support:?} {count}: {value} {exact}");
        }
    }
}

#[test]
fn gravity_bends_a_leaning_plate_towards_the_ground() {
    // A cantilever that leans by -90 degrees lies along +X with +eta (body -x) pointing up: it sags by
    // rho_l g l^4/(8 EJ).
    let integrator = Integrator::GeneralisedAlpha { rho_infinity: 0.0 };
    let angle = -std::f64::consts::FRAC_PI_2;
    let parameters = Parameters { integrator, angle, gravity: 9.81, ..clamped(ClampedFree, 30, 100.0) };
    let stiffness = parameters.beam.as_ref().unwrap().bending_stiffness;
    let solver = common::built(parameters).unwrap();
    let mut state = solver.initial_state(&[]).unwrap();
    run(&solver, &mut state, &[0.0; 33], 10.0, 12);
    let exact = -LINE_DENSITY * 9.81 * LENGTH.powi(4) / (8.0 * stiffness);
    let value = solver.deflection(&state, 0, 0, LENGTH);
    assert!((value / exact - 1.0).abs() < 1e-6, "{value} {exact}");
}

#[test]
fn a_hanging_bulkhead_swings_as_a_physical_pendulum() {
    // Zero modes: a rigid bulkhead. It hangs d below o_R, about which alone the body turns; the start angle is the
    // scene's.
    let amplitude = 2.0_f64;
    let mut parameters = Parameters { free: [false, false, true], ..cabin(0, 50.0, 9.81) };
    parameters.angle = amplitude;
    parameters.beam.as_mut().unwrap().middle = nalgebra::Vector2::new(0.0, -0.5);
    let solver = common::built(parameters).unwrap();
    let mass = LINE_DENSITY * LENGTH;
    let inertia = 15.0 + mass * (0.25 + LENGTH * LENGTH / 12.0);
    let small = (mass * 9.81 * 0.5 / inertia).sqrt();
    // Period 2 pi/(omega agm(1, cos(A/2))) (Gauss).
    let (mut a, mut b) = (1.0, (0.5 * amplitude).cos());
    for _ in 0..6 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    let period = 2.0 * std::f64::consts::PI / (small * a);
    let mut state = solver.initial_state(&[]).unwrap();
    run(&solver, &mut state, &[0.0; 3], period / 8000.0, 2000);
    assert!((state.motion.position[2] + amplitude).abs() < 1e-5, "bottom: {}", state.motion.position[2]);
    run(&solver, &mut state, &[0.0; 3], period / 8000.0, 6000);
    assert!(state.motion.position[2].abs() < 1e-5, "back: {}", state.motion.position[2]);
    assert_eq!((state.motion.position[0], state.motion.position[1]), (0.0, 0.0));
}
