//! A step is a function of state, motion and duration: same bits for threads, repeats and fresh scratch.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{Solver, State, Workspace};
use kinematics::Motion;
use samples::{dam_break_plate, mps, parameters, voronoi};

/// A motion that makes the plate swing, so that walls, images and loads take part.
fn motion(time: f64) -> Motion {
    let mut motion = Motion::at_rest(2);
    let rate = 30.0;
    motion.position[3] = 1e-3 * (1.0 - (rate * time).cos());
    motion.velocity[3] = 1e-3 * rate * (rate * time).sin();
    motion.acceleration[3] = 1e-3 * rate * rate * (rate * time).cos();
    motion
}

fn advance(solver: &Solver, state: &mut State, workspace: &mut Workspace, steps: usize) {
    for _ in 0..steps {
        let end = motion(state.time + 1e-3);
        solver.step(state, &end, 1e-3, workspace).unwrap();
    }
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    for scheme in [mps(), voronoi()] {
        let run = |threads| {
            let solver = Solver::new(parameters(scheme.clone(), 0.006, 1e-6, threads), dam_break_plate()).unwrap();
            let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
            advance(&solver, &mut state, &mut workspace, 180);
            state
        };
        let (one, two) = (run(1), run(2));
        assert!(one.load.iter().any(|value| *value != 0.0), "the wave must have reached the plate");
        assert!(one == two, "{scheme:?}: states differ at t = {}", one.time);
    }
}

#[test]
fn a_repeat_from_a_saved_state_gives_the_same_bits_and_reuses_the_preparation() {
    for scheme in [mps(), voronoi()] {
        let solver = Solver::new(parameters(scheme.clone(), 0.006, 1e-6, 2), dam_break_plate()).unwrap();
        let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
        advance(&solver, &mut state, &mut workspace, 150);
        let saved = state.clone();
        let duration = 0.5 * saved.time_step;
        let end = motion(saved.time + duration);
        let first = solver.step(&mut state, &end, duration, &mut workspace).unwrap();
        let expected = state.clone();
        let mut other = saved.clone();
        solver.step(&mut other, &motion(0.3), duration, &mut workspace).unwrap();
        assert!(other != expected, "{scheme:?}: another motion must give another state");
        let mut again = saved.clone();
        let repeat = solver.step(&mut again, &end, duration, &mut workspace).unwrap();
        assert!(again == expected, "{scheme:?}: a repeat differs");
        assert_eq!((first.substeps, first.reused, repeat.reused), (1, 0, 1), "{scheme:?}");
        let mut fresh = saved.clone();
        solver.step(&mut fresh, &end, duration, &mut solver.workspace()).unwrap();
        assert!(fresh == expected, "{scheme:?}: a fresh workspace differs");
    }
}

#[test]
fn a_refused_step_leaves_the_state_alone() {
    let solver = Solver::new(parameters(mps(), 0.006, 1e-6, 1), dam_break_plate()).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    let before = state.clone();
    let mut bad = Motion::at_rest(2);
    bad.velocity[4] = f64::NAN;
    let message = solver.step(&mut state, &bad, 1e-3, &mut workspace).unwrap_err().to_string();
    assert!(message.contains("motion.velocity[4]"), "{message}");
    assert!(solver.step(&mut state, &Motion::at_rest(2), -1.0, &mut workspace).is_err());
    assert!(solver.step(&mut state, &Motion::at_rest(1), 1e-3, &mut workspace).is_err());
    let mut wild = Motion::at_rest(2);
    wild.velocity[3] = 1e12;
    assert!(solver.step(&mut state, &wild, 1.0, &mut workspace).is_err(), "a wall at 1e12 must be refused");
    assert!(state == before);
}
