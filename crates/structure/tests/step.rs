//! What a step promises: locked coordinates, refusals that leave the state alone, states that can be stored.
#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case has failed")]

mod common;
use common::{AVERAGE, LENGTH, LINE_DENSITY, Parameters, cabin, clamped, run, tumbling};
use kinematics::Support;
use nalgebra::{DMatrix, DVector, Vector2};
use structure::{Error, Integrator, Solver, State};

const ALPHA: Integrator = Integrator::GeneralisedAlpha { rho_infinity: 0.8 };
const LOAD: [f64; 6] = [500.0, 1500.0, 60.0, 30.0, -20.0, 10.0];

/// Average-acceleration steps of `mass a + stiffness x = load` from rest, written out for a small linear system.
fn linear(
    mass: &DMatrix<f64>,
    stiffness: &DMatrix<f64>,
    load: &DVector<f64>,
    duration: f64,
    steps: usize,
) -> DVector<f64> {
    let (mut x, mut v) = (DVector::zeros(load.len()), DVector::zeros(load.len()));
    let solve = |matrix: &DMatrix<f64>, right: DVector<f64>| matrix.clone().lu().solve(&right).unwrap();
    for _ in 0..steps {
        let a0 = solve(mass, load - stiffness * &x);
        let predictor = &x + duration * &v + 0.25 * duration * duration * &a0;
        let a1 = solve(&(mass + 0.25 * duration * duration * stiffness), load - stiffness * &predictor);
        x = predictor + 0.25 * duration * duration * &a1;
        v += 0.5 * duration * (a0 + a1);
    }
    x
}

#[test]
fn locked_coordinates_are_a_smaller_system() {
    // Heave and modes alone, theta locked at the scene's angle: a linear system of four rows.
    let solver = common::built(Parameters { free: [false, true, false], ..cabin(3, 40.0, 0.0) }).unwrap();
    let mut state = solver.initial_state(&[]).unwrap();
    run(&solver, &mut state, &LOAD, 0.005, 200);

    let psi0 = solver.parameters().bodies[0].members[0].modes.psi0();
    let mut mass = DMatrix::identity(4, 4);
    mass[(0, 0)] = 222.6 + LINE_DENSITY * LENGTH;
    let mut stiffness = DMatrix::zeros(4, 4);
    for i in 0..3 {
        mass[(0, i + 1)] = -psi0[i] * 0.3_f64.sin();
        mass[(i + 1, 0)] = mass[(0, i + 1)];
        stiffness[(i + 1, i + 1)] = solver.dynamics().frequency(0, i).powi(2);
    }
    let load = DVector::from_column_slice(&[LOAD[1], LOAD[3], LOAD[4], LOAD[5]]);
    let expected = linear(&mass, &stiffness, &load, 0.005, 200);
    let x = &state.motion.position;
    let got = DVector::from_column_slice(&[x[1], x[3], x[4], x[5]]);
    assert!((&got - &expected).norm() < 1e-11 * expected.norm(), "{got} {expected}");
    for k in [0, 2] {
        assert_eq!((x[k], state.motion.velocity[k], state.motion.acceleration[k]), (0.0, 0.0, 0.0));
    }
}

#[test]
fn what_is_locked_has_no_influence() {
    // Between immovable supports neither the mass of the cabin nor loads on it matter: same bits.
    let solver = common::built(clamped(Support::ClampedFree, 3, 40.0)).unwrap();
    let heavy = Parameters { rigid_mass: 1e12, rigid_inertia: 1e9, ..clamped(Support::ClampedFree, 3, 40.0) };
    let heavy = common::built(heavy).unwrap();
    let (mut first, mut second) =
        (solver.initial_state(&[0.1, 0.0, 0.0]).unwrap(), heavy.initial_state(&[0.1, 0.0, 0.0]).unwrap());
    run(&solver, &mut first, &[0.0, 0.0, 0.0, 30.0, -20.0, 10.0], 0.002, 300);
    run(&heavy, &mut second, &[1e6, -1e6, 1e6, 30.0, -20.0, 10.0], 0.002, 300);
    assert_eq!(first, second);
}

#[test]
fn a_bulkhead_without_modes_is_part_of_the_rigid_body() {
    // Its middle in the centre of gravity: only the masses and the moments of inertia add up.
    let mut parameters = cabin(0, 40.0, 9.81);
    parameters.beam.as_mut().unwrap().middle = Vector2::zeros();
    let mass = LINE_DENSITY * LENGTH;
    let lumped = Parameters {
        rigid_mass: 222.6 + mass,
        rigid_inertia: 15.0 + mass * LENGTH * LENGTH / 12.0,
        beam: None,
        ..cabin(0, 40.0, 9.81)
    };
    let (with, without) = (common::built(parameters).unwrap(), common::built(lumped).unwrap());
    let (mut first, mut second) = (with.initial_state(&[]).unwrap(), without.initial_state(&[]).unwrap());
    run(&with, &mut first, &LOAD[..3], 0.01, 100);
    run(&without, &mut second, &LOAD[..3], 0.01, 100);
    assert!((first.motion.position - second.motion.position).norm() < 1e-12);
    assert_eq!(with.deflection(&with.initial_state(&[]).unwrap(), 0, 0, 0.5 * LENGTH), 0.0);
}

#[test]
fn a_body_without_freedom_only_grows_older() {
    let solver = common::built(Parameters { free: [false; 3], beam: None, ..cabin(0, 40.0, 9.81) }).unwrap();
    let mut state = solver.initial_state(&[]).unwrap();
    run(&solver, &mut state, &LOAD[..3], 0.25, 2);
    assert_eq!(state, State { time: 0.5, ..solver.initial_state(&[]).unwrap() });
    let sensitivity = solver.sensitivity(&state, &state, &LOAD[..3], 0.25).unwrap();
    assert_eq!(sensitivity.acceleration, DMatrix::zeros(3, 3));
}

/// Asserts that a step fails with this message and leaves the state as it was.
fn refuses(solver: &Solver, state: &State, load: &[f64], duration: f64, message: &str) {
    let mut after = state.clone();
    let error = solver.step(&mut after, load, duration, &mut solver.workspace()).unwrap_err();
    assert_eq!(error.to_string(), message);
    assert_eq!(format!("{after:?}"), format!("{state:?}"));
}

#[test]
fn bad_inputs_are_refused_by_name_and_leave_the_state_alone() {
    let solver = common::built(cabin(3, 40.0, 9.81)).unwrap();
    let state = tumbling(&solver);
    let every = "every component has to be finite";
    for (index, name) in [(0, "fx"), (1, "fy"), (2, "mz"), (3, "q[1]"), (5, "q[3]")] {
        let mut load = LOAD;
        load[index] = f64::NAN;
        refuses(&solver, &state, &load, 0.01, &format!("load component {name} is NaN at t = 0 s; {every}"));
    }
    refuses(&solver, &state, &LOAD[..4], 0.01, "the load has 4 entries, but the structure needs 6");
    refuses(&solver, &state, &LOAD, -0.01, "the step is -0.01 s at t = 0 s, but has to be positive and finite");
    let mut broken = state.clone();
    broken.motion.velocity[4] = f64::INFINITY;
    let message = "velocity of coordinate q[2] is inf at t = 0 s; every entry of a state has to be finite";
    refuses(&solver, &broken, &LOAD, 0.01, message);
    let locked = common::built(Parameters { free: [true, true, false], ..cabin(3, 40.0, 9.81) }).unwrap();
    let message = "coordinate theta is locked but has the velocity 1.5 at t = 0 s; set it to 0 or free the coordinate";
    refuses(&locked, &state, &LOAD, 0.01, message);
    assert!(matches!(solver.initial_state(&[1.0]), Err(Error::Length { expected: 3, got: 1, .. })));
    assert!(matches!(solver.initial_state(&[1.0, f64::NAN, 0.0]), Err(Error::StateNotFinite { .. })));
}

#[test]
fn a_step_that_does_not_converge_says_by_how_much() {
    // One iteration is not enough for a tumbling cabin; the same step with twenty is.
    let impatient = common::built(Parameters { maximum_iterations: 1, ..cabin(3, 40.0, 9.81) }).unwrap();
    let state = tumbling(&impatient);
    let mut after = state.clone();
    let error = impatient.step(&mut after, &LOAD, 0.02, &mut impatient.workspace()).unwrap_err();
    assert_eq!(after, state);
    let Error::NotConverged { iterations, residual, tolerance, duration, .. } = error else { panic!("{error}") };
    assert_eq!((iterations, tolerance, duration), (1, 1e-12, 0.02));
    assert!((1e-12..1e-1).contains(&residual), "{residual}");
    let patient = common::built(cabin(3, 40.0, 9.81)).unwrap();
    let report = patient.step(&mut after, &LOAD, 0.02, &mut patient.workspace()).unwrap();
    assert!((2..=6).contains(&report.iterations) && report.residual <= 1e-12, "{report:?}");
    // Numbers that overflow end in the same error, not in a state of infinities.
    let mut after = state.clone();
    let error = patient.step(&mut after, &[1e300; 6], 1e10, &mut patient.workspace()).unwrap_err();
    assert!(matches!(error, Error::NotConverged { .. } | Error::Singular { .. }), "{error}");
    assert_eq!(after, state);
}

#[test]
fn small_steps_need_one_or_two_iterations() {
    let solver = common::built(cabin(3, 508.4, 9.81)).unwrap();
    let (mut state, mut workspace) = (tumbling(&solver), solver.workspace());
    let mut iterations = 0;
    for _ in 0..1000 {
        iterations += solver.step(&mut state, &LOAD, 1e-4, &mut workspace).unwrap().iterations;
    }
    assert!(iterations <= 3000, "{iterations} iterations in 1000 steps");
}

#[test]
fn a_body_at_rest_in_balance_stays_there_to_the_last_bit() {
    for integrator in [AVERAGE, ALPHA] {
        let solver = common::built(Parameters { integrator, beam: None, ..cabin(0, 40.0, 9.81) }).unwrap();
        let mut state = solver.initial_state(&[]).unwrap();
        run(&solver, &mut state, &[0.0, 222.6 * 9.81, 0.0], 0.01, 1000);
        assert_eq!(state.motion, kinematics::Motion::at_rest(0));
    }
}

#[test]
fn a_stored_state_continues_with_the_same_bits() {
    for integrator in [AVERAGE, ALPHA] {
        let solver = common::built(Parameters { integrator, ..cabin(3, 40.0, 9.81) }).unwrap();
        let mut state = tumbling(&solver);
        run(&solver, &mut state, &LOAD, 0.01, 5);
        let stored = serde_json::to_string(&state).unwrap();
        run(&solver, &mut state, &LOAD, 0.01, 5);
        let mut again: State = serde_json::from_str(&stored).unwrap();
        run(&solver, &mut again, &LOAD, 0.01, 5);
        assert_eq!(state, again);
    }
}

#[test]
fn a_used_workspace_gives_the_same_bits_as_a_new_one() {
    let solver = common::built(cabin(3, 40.0, 9.81)).unwrap();
    let mut workspace = solver.workspace();
    let (mut first, mut second) = (tumbling(&solver), tumbling(&solver));
    let mut elsewhere = solver.initial_state(&[0.3, 0.2, 0.1]).unwrap();
    solver.step(&mut elsewhere, &LOAD, 0.02, &mut workspace).unwrap();
    solver.step(&mut first, &LOAD, 0.01, &mut workspace).unwrap();
    solver.step(&mut second, &LOAD, 0.01, &mut solver.workspace()).unwrap();
    assert_eq!(first, second);
}

#[test]
fn parameters_out_of_range_are_refused_with_the_range() {
    let message = |parameters: Parameters| common::built(parameters).unwrap_err().to_string();
    let good = || cabin(3, 40.0, 9.81);
    assert_eq!(
        message(Parameters { rigid_mass: 0.0, ..good() }),
        "the rigid mass [kg/m] is 0, but has to be positive and finite when x or y is free"
    );
    assert_eq!(
        message(Parameters { rigid_inertia: 0.0, ..good() }),
        "the rigid moment of inertia [kg m2/m] is 0, but has to be positive and finite when theta is free"
    );
    assert!(
        message(Parameters { rigid_inertia: -1.0, ..good() })
            .starts_with("the rigid moment of inertia [kg m2/m] is -1")
    );
    assert!(message(Parameters { gravity: -9.81, ..good() }).contains("at least 0"));
    assert!(message(Parameters { angle: f64::NAN, ..good() }).contains("the angle [rad] is NaN"));
    assert!(message(Parameters { tolerance: 1e-20, ..good() }).contains("from 1e-13 to 1e-2"));
    assert!(message(Parameters { maximum_iterations: 0, ..good() }).contains("at least 1"));
    let newmark = |beta, gamma| Parameters { integrator: Integrator::Newmark { beta, gamma }, ..good() };
    assert_eq!(
        message(newmark(0.1, 0.5)),
        "beta of Newmark is 0.1, but has to be from gamma/2 (unconditional stability) to 1"
    );
    assert!(message(newmark(0.25, 0.4)).contains("gamma of Newmark is 0.4"));
    let alpha = Integrator::GeneralisedAlpha { rho_infinity: 1.1 };
    assert!(message(Parameters { integrator: alpha, ..good() }).contains("rho_infinity of generalised-alpha is 1.1"));
    let mut soft = good();
    soft.beam.as_mut().unwrap().bending_stiffness = 0.0;
    assert!(message(soft).contains("the bending stiffness [N m2/m] is 0"));
    let mut damped = good();
    damped.beam.as_mut().unwrap().damping_ratios = vec![0.1];
    assert_eq!(message(damped), "the list of damping ratios has 1 entries, but the structure needs 3");
}

/// Nothing is asked of a coordinate that is locked: a mass without inertia falls, an inertia without mass swings on its
/// spring.
#[test]
fn only_free_coordinates_need_inertia() {
    let parameters = |free, rigid_mass, rigid_inertia, springs| Parameters {
        free,
        rigid_mass,
        rigid_inertia,
        springs,
        beam: None,
        ..cabin(0, 40.0, 9.81)
    };
    let solver = common::built(parameters([false, true, false], 2.0, 0.0, [0.0; 3])).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(&[]).unwrap(), solver.workspace());
    for _ in 0..10 {
        solver.step(&mut state, &[0.0; 3], 0.01, &mut workspace).unwrap();
    }
    // y = -g t^2 / 2 is exact for the average acceleration.
    assert!((state.motion.position[1] + 0.5 * 9.81 * 0.01).abs() < 1e-12, "{:?}", state.motion.position);
    let solver = common::built(parameters([false, false, true], 0.0, 3.0, [0.0, 0.0, 12.0])).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(&[]).unwrap(), solver.workspace());
    solver.step(&mut state, &[0.0, 0.0, 6.0], 0.1, &mut workspace).unwrap();
    // The average acceleration makes no energy: what there is, is the work of the load.
    let energy = solver.kinetic_energy(&state) + 0.5 * 12.0 * state.motion.position[2].powi(2);
    assert!((energy - 6.0 * state.motion.position[2]).abs() < 1e-9, "{energy}");
}
