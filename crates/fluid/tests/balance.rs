//! What changes momentum, angular momentum and energy of the water has names, and they add up to the last digits; with the
//! scheme `voronoi` no momentum comes from anything but forces, walls and bodies.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{DampingZone, Gain, Gains, Geometry, Observables, Parameters, Solver};
use kinematics::Motion;
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

fn content(seen: &Observables) -> Gain {
    let energy = seen.kinetic_energy + seen.potential_energy;
    Gain { impulse: seen.momentum, angular: seen.angular_momentum, energy }
}

/// Runs steps of 1 ms with the body moving as given; what the water got, the gains at the end, and the worst unpaid momentum of
/// a step over all that was exchanged until then.
fn run_with(
    parameters: Parameters,
    geometry: Geometry,
    steps: usize,
    end: impl Fn(usize, &mut Motion),
) -> (Gain, Gains, f64) {
    let solver = Solver::new(parameters, geometry).unwrap();
    let (mut state, mut workspace, mut motion) = (solver.initial_state(), solver.workspace(), solver.at_rest());
    solver.begin(&mut state, &mut workspace).unwrap();
    let before = content(&solver.observe(&state));
    let (mut exchanged, mut worst) = (0.0, 0.0_f64);
    let mut last = Gains::default();
    for step in 0..steps {
        end(step, &mut motion);
        solver.step(&mut state, &motion, 1e-3, &mut workspace).unwrap();
        let now = state.gains;
        exchanged +=
            (now.walls.impulse - last.walls.impulse).norm() + (now.bodies.impulse - last.bodies.impulse).norm();
        let unpaid = |gains: &Gains| (gains.projection + gains.smoothing + gains.shifting).impulse;
        worst = worst.max((unpaid(&now) - unpaid(&last)).norm() / exchanged);
        last = now;
    }
    (content(&solver.observe(&state)) - before, state.gains, worst)
}

fn run(parameters: Parameters, geometry: Geometry, steps: usize) -> (Gain, Gains, f64) {
    run_with(parameters, geometry, steps, |_, _| {})
}

fn size(gains: &Gains, of: impl Fn(&Gain) -> f64) -> f64 {
    gains.terms().iter().map(of).sum()
}

#[test]
fn the_terms_are_all_of_the_change() {
    for scheme in [voronoi(), mps()] {
        let zone = DampingZone { from: 0.1, to: 0.3, rate: 5.0 };
        let parameters = Parameters { damping: vec![zone], ..parameters(scheme, 0.01, 1e-8, 1) };
        let (change, gains, _) = run(parameters, splash(), 250);
        let rest = change - gains.sum();
        assert!(rest.impulse.norm() < 1e-11 * size(&gains, |gain| gain.impulse.norm()), "{rest:?} of {gains:?}");
        assert!(rest.angular.abs() < 1e-11 * size(&gains, |gain| gain.angular.abs()), "{rest:?} of {gains:?}");
        assert!(rest.energy.abs() < 1e-10 * size(&gains, |gain| gain.energy.abs()), "{rest:?} of {gains:?}");
        assert!(gains.bodies.impulse.x < -0.1 && gains.damping.impulse.norm() > 0.01, "{gains:?}");
        // Gravity alone is a force: rho g A t, of water that keeps its area, and its work is in the potential energy.
        let weight = -1000.0 * 9.81 * 0.02 * 0.25;
        assert!((gains.forces.impulse - Vector2::new(0.0, weight)).norm() < 1e-9 * weight.abs(), "{gains:?}");
        assert!(gains.damping.energy < 0.0 && gains.forces.energy.abs() < 1e-9 * change.energy.abs(), "{gains:?}");
    }
}

/// The paddle moves and the tank is shaken: bodies and forces do work.
#[test]
fn the_terms_are_all_of_the_change_where_work_is_done() {
    let shaking = fluid::Shaking { amplitude: Vector2::new(0.01, 0.0), period: 0.8 };
    let parameters = Parameters { shaking, attraction: 0.5, ..parameters(voronoi(), 0.01, 1e-8, 1) };
    let geometry = Geometry { active: Vec::new(), ..splash() };
    let paddle = |step: usize, motion: &mut Motion| {
        let time = (step + 1) as f64 * 1e-3;
        motion.position[0] = 0.02 * (1.0 - (10.0 * time).cos());
        motion.velocity[0] = 0.2 * (10.0 * time).sin();
        motion.acceleration[0] = 2.0 * (10.0 * time).cos();
    };
    let (change, gains, worst) = run_with(parameters, geometry, 250, paddle);
    let rest = change - gains.sum();
    assert!(rest.impulse.norm() < 1e-11 * size(&gains, |gain| gain.impulse.norm()), "{rest:?} of {gains:?}");
    assert!(rest.angular.abs() < 1e-11 * size(&gains, |gain| gain.angular.abs()), "{rest:?} of {gains:?}");
    assert!(rest.energy.abs() < 1e-10 * size(&gains, |gain| gain.energy.abs()), "{rest:?} of {gains:?}");
    assert!(gains.bodies.energy.abs() > 1e-3 && gains.forces.energy.abs() > 1e-3, "{gains:?}");
    assert!(worst < 1e-12, "{worst}");
}

#[test]
fn water_at_rest_is_carried_by_its_walls() {
    let geometry = Geometry {
        water: vec![rectangle(0.0, 0.0, 0.4, 0.2)],
        fixed_walls: vec![tank(0.4, 0.5)],
        ..Geometry::default()
    };
    let (change, gains, _) = run(parameters(voronoi(), 0.01, 1e-8, 1), geometry, 50);
    let weight = 1000.0 * 9.81 * 0.08 * 0.05;
    assert!(change.impulse.norm() < 1e-3 * weight);
    assert!((gains.walls.impulse.y / weight - 1.0).abs() < 1e-3, "{gains:?}");
    assert!((gains.walls.angular / (0.2 * weight) - 1.0).abs() < 1e-3, "{gains:?}");
    let errors = [gains.projection, gains.contacts, gains.smoothing, gains.shifting];
    assert!(errors.iter().all(|error| error.angular.abs() < 1e-4 * 0.2 * weight), "{errors:?}");
}

/// In every step, in a splash on a plate that swings.
#[test]
fn walls_bodies_and_forces_are_all_that_gives_momentum() {
    let (_, gains, worst) = run(parameters(voronoi(), 0.01, 1e-8, 1), splash(), 400);
    assert!(worst < 1e-12, "{worst} of {gains:?}");
    assert!(gains.smoothing.impulse.norm() < 1e-12 * size(&gains, |gain| gain.impulse.norm()), "{gains:?}");
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
        assert!(contacts > 5 && load.norm() > 1.0, "{contacts} contacts, {load}");
        let rest = (load + state.gains.bodies.impulse).norm();
        assert!(rest < 1e-10 * size(&state.gains, |gain| gain.impulse.norm()), "{rest} of {load}");
    }
}
