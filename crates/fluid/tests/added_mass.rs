//! Added mass: the load that it predicts, its symmetry, and its value for a square deep under the surface.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{Geometry, Solver, State, Workspace};
use kinematics::{Body, Motion};
use nalgebra::Vector2;
use samples::{parameters, plate, rectangle, tank, voronoi};

fn geometry(body: Body, active: Vec<usize>) -> Geometry {
    Geometry {
        water: vec![rectangle(0.0, 0.0, 0.195, 0.1)],
        fixed_walls: vec![tank(0.4, 0.3)],
        bodies: body.into(),
        active,
        ..Geometry::default()
    }
}

fn solver(geometry: Geometry, spacing: f64) -> Solver {
    Solver::new(parameters(voronoi(), spacing, 1e-11, 2), geometry).unwrap()
}

/// One step under a motion with this acceleration from rest; returns the state afterwards.
fn stepped(solver: &Solver, start: &State, workspace: &mut Workspace, acceleration: &[f64], duration: f64) -> State {
    let mut end = Motion::at_rest(acceleration.len() - 3);
    end.acceleration.copy_from_slice(acceleration);
    end.velocity = &end.acceleration * duration;
    end.position = &end.acceleration * (0.5 * duration * duration);
    let mut state = start.clone();
    let report = solver.step(&mut state, &end, duration, workspace).unwrap();
    assert_eq!(report.substeps, 1);
    state
}

/// The load changes with the acceleration exactly as the added mass says, and the added mass is symmetric.
#[test]
fn the_load_is_affine_in_the_acceleration() {
    let solver = solver(geometry(plate(0.2, 0.12, 0.01, 2), vec![0, 1, 2, 3, 4]), 0.005);
    let (start, mut workspace) = (solver.initial_state(), solver.workspace());
    let duration = 5e-4;
    let reference = stepped(&solver, &start, &mut workspace, &[0.0; 5], duration);
    let mass = &reference.added_mass;
    let largest = mass.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    for (k, scale) in [(0, 3.0), (2, 20.0), (3, 0.5), (4, -0.7)] {
        let mut acceleration = [0.0; 5];
        acceleration[k] = scale;
        let state = stepped(&solver, &start, &mut workspace, &acceleration, duration);
        assert!((state.acceleration[k] / scale - 1.0).abs() < 1e-12);
        let size = (0..5).map(|row| (mass[row * 5 + k] * scale).abs()).fold(0.0, f64::max);
        for row in 0..5 {
            let change = state.load[row] - reference.load[row];
            let extrapolated = -mass[row * 5 + k] * scale;
            assert!((change - extrapolated).abs() < 1e-6 * size, "{row}, {k}: {change} in place of {extrapolated}");
            let mirrored = mass[k * 5 + row] - mass[row * 5 + k];
            assert!(mirrored.abs() <= 1e-12 * largest, "{row}, {k}: not symmetric by {mirrored}");
        }
        assert!(mass[k * 5 + k] > 0.0);
    }
}

/// Coordinates that do not answer to the load have no added mass, and cost nothing.
#[test]
fn only_active_coordinates_have_an_added_mass() {
    let solver = solver(geometry(plate(0.2, 0.12, 0.01, 2), vec![4]), 0.01);
    let (start, mut workspace) = (solver.initial_state(), solver.workspace());
    let state = stepped(&solver, &start, &mut workspace, &[0.0; 5], 5e-4);
    for (entry, value) in state.added_mass.iter().enumerate() {
        assert_eq!(*value != 0.0, entry == 24, "entry {entry} is {value}");
    }
}

/// Load and added mass at the start, before any step, are those of the first step with the body held.
#[test]
fn a_start_has_its_load() {
    let solver = solver(geometry(plate(0.2, 0.12, 0.01, 2), vec![3, 4]), 0.005);
    let (mut begun, mut workspace) = (solver.initial_state(), solver.workspace());
    solver.begin(&mut begun, &mut workspace).unwrap();
    let state = stepped(&solver, &solver.initial_state(), &mut solver.workspace(), &[0.0; 5], 5e-4);
    for (a, b) in begun.load.iter().zip(&state.load).chain(begun.added_mass.iter().zip(&state.added_mass)) {
        assert!((a - b).abs() <= 1e-6 * b.abs().max(1e-3), "{a} and {b}");
    }
    assert_eq!(begun.positions, solver.initial_state().positions);
}

/// A square cylinder of side 2 s, far from walls and surface: 4.754 rho s^2 along its sides (Wendel 1956; Newman 1977,
/// table 4.3). With 10, 20 and 40 particles along a side it is 4.956, 4.848 and 4.802, mean of both directions.
#[test]
fn a_submerged_square_has_the_published_added_mass() {
    let half = 0.05;
    let corners = [(-half, -half), (-half, half), (half, half), (half, -half), (-half, -half)];
    let walls = vec![corners.map(|(x, y)| Vector2::new(x, y)).to_vec()];
    let body = Body { origin: Vector2::new(1.0, 1.0), angle: 0.0, walls, members: Vec::new() };
    let water = around(&Vector2::new(1.0, 1.0), half, 2.0);
    let geometry = Geometry {
        water,
        fixed_walls: vec![tank(2.0, 2.5)],
        bodies: body.into(),
        active: vec![0, 1],
        ..Geometry::default()
    };
    let solver = solver(geometry, 0.005);
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    solver.begin(&mut state, &mut workspace).unwrap();
    let scale = 1000.0 * half * half;
    for k in 0..2 {
        let value = state.added_mass[k * 4] / scale;
        assert!((value / 4.754 - 1.0).abs() < 0.03, "coordinate {k}: {value}");
    }
}

/// A square of water with sides `size` around a square hole.
fn around(middle: &Vector2<f64>, half: f64, size: f64) -> Vec<Vec<Vector2<f64>>> {
    let (left, right) = (middle.x - half, middle.x + half);
    let (low, high) = (middle.y - half, middle.y + half);
    vec![
        rectangle(0.0, 0.0, left, size),
        rectangle(right, 0.0, size, size),
        rectangle(left, 0.0, right, low),
        rectangle(left, high, right, size),
    ]
}
