//! A load that answers to the acceleration, and springs.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod common;

use common::{Parameters, cabin, run, state};
use nalgebra::{DMatrix, DVector};
use structure::{AddedMass, Solver};

fn heave(mass: f64, spring: f64) -> Solver {
    let free = [false, true, false];
    common::built(Parameters { rigid_mass: mass, free, springs: [0.0, spring, 0.0], beam: None, ..cabin(0, 1.0, 0.0) })
        .unwrap()
}

/// A body of 2 kg with 200 kg of added mass moves like one of 202 kg, whatever acceleration the load belongs to.
#[test]
fn added_mass_is_mass() {
    let (light, heavy) = (heave(2.0, 8000.0), heave(202.0, 8000.0));
    let duration = 0.01;
    let mut expected = state(&heavy, &[0.0, 0.1, 0.0], &[0.0; 3]);
    let mut got = state(&light, &[0.0, 0.1, 0.0], &[0.0; 3]);
    let mut workspace = light.workspace();
    let mut matrix = DMatrix::zeros(3, 3);
    matrix[(1, 1)] = 200.0;
    for step in 0..150 {
        run(&heavy, &mut expected, &[0.0, 30.0, 0.0], duration, 1);
        // The load as it would be at the acceleration a_r: 30 N without any, 200 kg a_r less with it.
        let reference = f64::from(step % 7) - 3.0;
        let added = AddedMass { matrix: matrix.clone(), acceleration: DVector::from_vec(vec![0.0, reference, 0.0]) };
        let load = [0.0, 30.0 - 200.0 * reference, 0.0];
        let (report, _) = light.step_with_added_mass(&mut got, &load, &added, duration, &mut workspace).unwrap();
        assert!(report.iterations <= 3, "{} iterations of a linear problem", report.iterations);
    }
    // The load is held over a step: the light body's force is too, so the two differ by the order of the step squared.
    let size = 0.1;
    let difference = got.motion.position[1] - expected.motion.position[1];
    assert!(difference.abs() < 0.01 * size, "{difference} m apart after 1.5 s");
    assert!((expected.motion.position[1] - 0.1).abs() > 0.05, "after one and a half periods it is below");
}

/// The sensitivity of a step with added mass against finite differences.
#[test]
fn the_sensitivity_knows_the_added_mass() {
    let solver = common::built(cabin(2, 40.0, 9.81)).unwrap();
    let size = 5;
    let root = DMatrix::from_fn(size, size, |row, column| ((row * 5 + column * 3) % 7) as f64 - 2.0);
    let matrix = &root * root.transpose() * 20.0;
    let added = AddedMass { matrix, acceleration: DVector::from_fn(size, |k, _| 0.3 * k as f64 - 0.5) };
    let before = state(&solver, &[0.0, 0.0, 0.1, 0.01, -0.02], &[0.2, -0.1, 0.3, 0.1, 0.0]);
    let mut workspace = solver.workspace();
    let duration = 0.003;
    let mut end = |load: &[f64]| {
        let mut after = before.clone();
        let (_, acted) = solver.step_with_added_mass(&mut after, load, &added, duration, &mut workspace).unwrap();
        (after, acted)
    };
    let load = [10.0, 2000.0, 30.0, 4.0, -5.0];
    let (after, acted) = end(&load);
    let exact =
        solver.sensitivity(&before, &after, &acted, duration).unwrap().with_added_mass(&added, duration).unwrap();
    for k in 0..size {
        let change = 1.0;
        let (mut more, mut less) = (load, load);
        more[k] += change;
        less[k] -= change;
        let difference = (end(&more).0.motion.velocity - end(&less).0.motion.velocity) / (2.0 * change);
        let column = exact.velocity.column(k);
        assert!((&difference - column).norm() < 1e-5 * column.norm(), "column {k}: {difference} {column}");
    }
}

/// A mass on a spring: its period, and energy that stays.
#[test]
fn springs_swing() {
    let solver = heave(4.0, 400.0);
    let mut oscillation = state(&solver, &[0.0, 0.1, 0.0], &[0.0; 3]);
    let energy = |state: &structure::State| solver.kinetic_energy(state) + solver.potential_energy(state);
    let start = energy(&oscillation);
    assert!((start - 2.0).abs() < 1e-12, "k x^2 / 2");
    let period = std::f64::consts::TAU / 10.0;
    run(&solver, &mut oscillation, &[0.0; 3], period / 1000.0, 10_000);
    assert!((oscillation.motion.position[1] - 0.1).abs() < 1e-4, "{}", oscillation.motion.position[1]);
    assert!((energy(&oscillation) / start - 1.0).abs() < 1e-9);
}
