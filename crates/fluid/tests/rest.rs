//! Verification: water at rest stays at rest as far as the scheme allows, and stays in.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{Geometry, Solver};
use nalgebra::Vector2;
use samples::{mps, parameters, rectangle, tank, voronoi};

/// Four seconds of still water, 25 spacings deep. The one-sided gradient jostles particles all the time; fluid speeds
/// of 0.2 m/s and a pressure noise of about one per cent are what this scheme gives at r_e = 3.1. A pair of surface
/// particles that merges shows as a particle thrown out at metres per second.
#[test]
fn still_water_stays_in_and_throws_nothing_out() {
    let geometry = Geometry {
        water: vec![rectangle(0.0, 0.0, 1.0, 0.5)],
        fixed_walls: vec![tank(1.0, 0.8)],
        probes: vec![Vector2::new(0.5, 0.0).into()],
        ..Geometry::default()
    };
    let solver = Solver::new(parameters(mps(), 0.02, 1e-3, 2), geometry).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    let count = state.positions.len();
    let (mut pressures, mut fastest) = (Vec::new(), 0.0_f64);
    for _ in 0..400 {
        solver.step(&mut state, &solver.at_rest(), 0.01, &mut workspace).unwrap();
        let seen = solver.observe(&state);
        fastest = fastest.max(seen.maximum_speed);
        if state.time > 0.5 {
            pressures.push(seen.probes[0]);
        }
    }
    let inside = |r: &Vector2<f64>| r.x > 0.0 && r.x < 1.0 && r.y > 0.0 && r.y < 0.55;
    assert!(state.positions.len() == count && state.positions.iter().all(inside));
    assert!(fastest < 0.8, "a particle reached {fastest} m/s");
    let mean = pressures.iter().sum::<f64>() / pressures.len() as f64;
    let variance = pressures.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / pressures.len() as f64;
    assert!((mean / 4905.0 - 1.0).abs() < 0.03, "mean floor pressure {mean}");
    assert!(variance.sqrt() < 0.02 * 4905.0, "floor pressure rms {}", variance.sqrt());
    let level = solver.observe(&state).centre.y / 0.25 - 1.0;
    assert!(level.abs() < 0.02, "centre of mass moved by {level} of its height");
}

/// Before the first step the water weighs on its tank and on a body in it as it does afterwards.
#[test]
fn the_pressure_is_there_before_the_first_step() {
    let at_the_floor = [Vector2::new(0.5, 0.0).into(), Vector2::new(0.0, 0.25).into()];
    let body = kinematics::Body {
        origin: Vector2::new(1.0, 0.25),
        angle: 0.0,
        walls: vec![vec![Vector2::new(0.0, -0.25), Vector2::new(0.0, 0.55)]],
        members: Vec::new(),
    };
    let mut floor = tank(1.0, 0.8);
    floor.pop();
    let geometry = Geometry {
        water: vec![rectangle(0.0, 0.0, 1.0, 0.5)],
        fixed_walls: vec![floor],
        bodies: body.into(),
        probes: at_the_floor.to_vec(),
        ..Geometry::default()
    };
    let solver = Solver::new(parameters(voronoi(), 0.02, 1e-5, 2), geometry).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    solver.begin(&mut state, &mut workspace).unwrap();
    let seen = solver.observe(&state);
    // rho g h per metre of floor; rho g h^2 / 2 on each side, the right one of which is the body.
    let near = |value: f64, exact: f64| assert!((value / exact - 1.0).abs() < 0.01, "{value}, expected {exact}");
    near(seen.wall_force.y, -4905.0);
    near(seen.wall_force.x, -1226.25);
    near(state.load[0], 1226.25);
    near(seen.probes[0], 4905.0);
    near(seen.probes[1], 2452.5);
    assert_eq!((state.time, state.steps, seen.maximum_speed), (0.0, 0, 0.0));
}

/// The worst seen while water is at rest with the scheme `voronoi`, over what it should be.
#[derive(Debug, Default)]
struct Worst {
    pressure: f64,
    force: f64,
    level: f64,
    fall: f64,
    speed: f64,
}

/// Three seconds of water 25 spacings deep from p = 0, its particles moved by up to `jitter` spacings; the figures are
/// those after `settled` seconds.
fn rest(jitter: f64, settled: f64) -> Worst {
    let geometry = Geometry {
        water: vec![rectangle(0.0, 0.0, 1.0, 0.5)],
        fixed_walls: vec![tank(1.0, 0.8)],
        probes: vec![Vector2::new(0.5, 0.0).into()],
        gauges: vec![0.3],
        ..Geometry::default()
    };
    let solver = Solver::new(parameters(voronoi(), 0.02, 1e-5, 2), geometry).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    let noise = |k: usize| ((k * 7919 + 31) % 1009) as f64 / 504.5 - 1.0;
    for (k, position) in state.positions.iter_mut().enumerate() {
        *position += Vector2::new(noise(2 * k), noise(2 * k + 1)) * (jitter * 0.02);
    }
    let centre = solver.observe(&state).centre.y;
    let mut worst = Worst::default();
    for _ in 0..300 {
        solver.step(&mut state, &solver.at_rest(), 0.01, &mut workspace).unwrap();
        if state.time <= settled {
            continue;
        }
        let seen = solver.observe(&state);
        worst.pressure = worst.pressure.max((seen.probes[0] / 4905.0 - 1.0).abs());
        worst.force = worst.force.max((seen.wall_force.y / 4905.0 + 1.0).abs());
        worst.level = worst.level.max((seen.levels[0] / 0.5 - 1.0).abs());
        worst.fall = worst.fall.max((seen.centre.y - centre).abs() / 0.5);
        worst.speed = worst.speed.max((2.0 * seen.kinetic_energy / 500.0).sqrt());
    }
    worst
}

/// From the lattice everything is exact but for the tolerance of the solver, 1e-5.
#[test]
fn water_on_a_lattice_is_still_with_voronoi_cells() {
    let worst = rest(0.0, 0.0);
    let small = worst.pressure < 1e-4 && worst.force < 1e-4 && worst.level < 1e-6 && worst.fall < 1e-6;
    assert!(small && worst.speed < 1e-4, "{worst:?}");
}

/// From disorder the water settles within a second.
#[test]
fn jittered_water_comes_to_rest_with_voronoi_cells() {
    let worst = rest(0.2, 1.0);
    let small = worst.pressure < 2e-3 && worst.force < 2e-3 && worst.level < 5e-3 && worst.fall < 5e-4;
    assert!(small && worst.speed < 0.01, "{worst:?}");
}

#[test]
fn overlapping_water_is_refused_with_the_place() {
    let geometry = Geometry {
        water: vec![rectangle(0.0, 0.0, 0.5, 0.5), rectangle(0.4, 0.0, 1.0, 0.5)],
        fixed_walls: vec![tank(1.0, 0.8)],
        ..Geometry::default()
    };
    let error = Solver::new(parameters(mps(), 0.02, 1e-3, 1), geometry).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("two particles near") && error.contains("overlap"), "{error}");
}
