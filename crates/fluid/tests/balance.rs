//! What changes the momentum of the water has names, and they add up to the last digits; where water is at rest or flies the
//! errors of the discretisation have no part in it.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{DampingZone, Geometry, Impulses, Parameters, Solver};
use nalgebra::Vector2;
use samples::{mps, parameters, plate, rectangle, tank, voronoi};

/// A column that collapses against a plate, between walls, with a damping zone.
fn splash() -> Geometry {
    Geometry {
        water: vec![rectangle(0.0, 0.0, 0.1, 0.2)],
        fixed_walls: vec![tank(0.4, 0.5)],
        bodies: plate(0.2, 0.08, 0.012, 1).into(),
        active: vec![3],
        ..Geometry::default()
    }
}

/// Momentum at the end less that at the start, and the impulses, of steps of 1 ms.
fn run(parameters: Parameters, geometry: Geometry, steps: usize) -> (Vector2<f64>, Impulses) {
    let solver = Solver::new(parameters, geometry).unwrap();
    let (mut state, mut workspace, end) = (solver.initial_state(), solver.workspace(), solver.at_rest());
    solver.begin(&mut state, &mut workspace).unwrap();
    let before = solver.observe(&state).momentum;
    for _ in 0..steps {
        solver.step(&mut state, &end, 1e-3, &mut workspace).unwrap();
    }
    (solver.observe(&state).momentum - before, state.impulses)
}

fn size(impulses: &Impulses) -> f64 {
    impulses.terms().iter().map(|term| term.norm()).sum()
}

#[test]
fn the_terms_are_all_of_the_change() {
    for scheme in [voronoi(), mps()] {
        let zone = DampingZone { from: 0.1, to: 0.3, rate: 5.0 };
        let parameters = Parameters { damping: vec![zone], ..parameters(scheme, 0.01, 1e-8, 1) };
        let (change, impulses) = run(parameters, splash(), 250);
        let rest = (change - impulses.sum()).norm();
        assert!(rest < 1e-11 * size(&impulses), "{rest} of {impulses:?}");
        assert!(impulses.bodies.x < -0.1 && impulses.damping.norm() > 0.01, "{impulses:?}");
        // Gravity alone is a force: rho g A t, of water that keeps its area.
        let weight = -1000.0 * 9.81 * 0.02 * 0.25;
        assert!((impulses.forces - Vector2::new(0.0, weight)).norm() < 1e-9 * weight.abs(), "{impulses:?}");
    }
}

#[test]
fn water_at_rest_is_carried_by_its_walls() {
    let geometry = Geometry {
        water: vec![rectangle(0.0, 0.0, 0.4, 0.2)],
        fixed_walls: vec![tank(0.4, 0.5)],
        ..Geometry::default()
    };
    let (change, impulses) = run(parameters(voronoi(), 0.01, 1e-8, 1), geometry, 50);
    let weight = 1000.0 * 9.81 * 0.08 * 0.05;
    assert!(change.norm() < 1e-3 * weight);
    assert!((impulses.walls.y / weight - 1.0).abs() < 1e-3, "{impulses:?}");
    let errors = [impulses.projection, impulses.contacts, impulses.smoothing, impulses.shifting];
    assert!(errors.iter().all(|error| error.norm() < 1e-4 * weight), "{errors:?}");
}

#[test]
fn smoothing_gives_no_momentum() {
    let (_, impulses) = run(parameters(voronoi(), 0.01, 1e-8, 1), splash(), 250);
    assert!(impulses.smoothing.norm() < 1e-9 * size(&impulses), "{impulses:?}");
}

/// What bodies give to the water is what the water gives to them as its load, particles that they stop included.
#[test]
fn the_load_is_what_the_water_loses() {
    for scheme in [voronoi(), mps()] {
        let solver = Solver::new(parameters(scheme, 0.01, 1e-8, 1), splash()).unwrap();
        let (mut state, mut workspace, end) = (solver.initial_state(), solver.workspace(), solver.at_rest());
        let (mut load, mut contacts) = (Vector2::zeros(), 0);
        for _ in 0..300 {
            contacts += solver.step(&mut state, &end, 1e-3, &mut workspace).unwrap().contacts;
            load += Vector2::new(state.load[0], state.load[1]) * 1e-3;
        }
        assert!(contacts > 10 && load.norm() > 1.0, "{contacts} contacts, {load}");
        let rest = (load + state.impulses.bodies).norm();
        assert!(rest < 1e-10 * size(&state.impulses), "{rest} of {load}");
    }
}
