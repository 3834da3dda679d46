//! Verification: gas that walls, bodies and water close off.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{AffineVelocity, Chamber, Gain, GasParameters, Geometry, Parameters, Solver, State, Vent};
use kinematics::{Body, Motion};
use nalgebra::Vector2;
use samples::{parameters, plate, points, rectangle, tank, voronoi};

fn with_gas(spacing: f64, ambient: f64, threads: usize) -> Parameters {
    let gas = GasParameters { ambient, ..GasParameters::default() };
    Parameters { gas: Some(gas), ..parameters(voronoi(), spacing, 1e-8, threads) }
}

/// A column of water of a height on a pocket of gas, in a tube open above.
fn column(parameters: Parameters, height: f64, pocket: f64, speed: f64) -> Solver {
    let width = 10.0 * parameters.spacing;
    let geometry = Geometry {
        water: vec![rectangle(0.0, pocket, width, pocket + height)],
        fixed_walls: vec![tank(width, 3.0 * (pocket + height))],
        start: AffineVelocity { constant: Vector2::new(0.0, speed), ..AffineVelocity::default() },
        ..Geometry::default()
    };
    Solver::new(parameters, geometry).unwrap()
}

/// States after every step.
fn history(solver: &Solver, steps: usize, duration: f64, mut see: impl FnMut(&State)) {
    let (mut state, mut workspace, rest) = (solver.initial_state(), solver.workspace(), solver.at_rest());
    for _ in 0..steps {
        solver.step(&mut state, &rest, duration, &mut workspace).unwrap();
        see(&state);
    }
}

/// Case B of the exact solution (rho h a'' = p_0 (a_0/a)^gamma - p_0 - rho g h, reference/L1_air_pocket_column.csv): the column
/// falls onto its gas and comes back to where it was.
#[test]
fn a_column_swings_on_its_pocket() {
    let solver = column(with_gas(0.02, 5e3, 2), 0.5, 0.2, 0.0);
    let (mut largest, mut highest, mut end) = (0.0_f64, 0.0_f64, 0.0);
    history(&solver, 428, 1e-3, |state| {
        let pocket = &state.gas.pockets[0];
        largest = largest.max(pocket.pressure);
        if state.time > 0.3 && pocket.volume > highest {
            (highest, end) = (pocket.volume, state.time);
        }
    });
    assert!((largest / 21_115.594 - 1.0).abs() < 1e-4, "{largest}");
    assert!((highest / 0.04 - 1.0).abs() < 1e-4 && (end - 0.4279).abs() < 1.5e-3, "{highest} at {end}");
}

/// A slab that hits a cushion at S = rho h v^2 / (p_0 a_0) = 1: the exact largest pressure (reference/L1_bagnold_curve.csv).
#[test]
fn a_slab_hits_a_cushion() {
    let parameters = Parameters { gravity: Vector2::zeros(), ..with_gas(0.02, 1e5, 2) };
    let solver = column(parameters, 0.2, 0.5, -(1e5_f64 * 0.5 / 200.0).sqrt());
    let mut largest = 0.0_f64;
    history(&solver, 160, 2e-4, |state| largest = largest.max(state.gas.pockets[0].pressure));
    assert!((largest / 357_411.2 - 1.0).abs() < 2e-3, "{largest}");
}

/// A column that collapses against a plate in a tank with a lid.
fn closed_splash(threads: usize) -> Solver {
    let mut walls = tank(0.4, 0.5);
    walls.push(walls[0]);
    let geometry = Geometry {
        water: vec![rectangle(0.0, 0.0, 0.1, 0.2)],
        fixed_walls: vec![walls],
        bodies: plate(0.2, 0.08, 0.012, 1).into(),
        active: vec![3],
        ..Geometry::default()
    };
    Solver::new(with_gas(0.01, 1e4, threads), geometry).unwrap()
}

/// Momentum, angular momentum and energy add up with gas, and no momentum comes from anywhere else; no gas is lost.
#[test]
fn what_gas_gives_has_its_name() {
    let solver = closed_splash(1);
    let (mut state, mut workspace, rest) = (solver.initial_state(), solver.workspace(), solver.at_rest());
    solver.begin(&mut state, &mut workspace).unwrap();
    let content = |state: &State| {
        let seen = solver.observe(state);
        let energy = seen.kinetic_energy + seen.potential_energy;
        Gain { impulse: seen.momentum, angular: seen.angular_momentum, energy }
    };
    let before = content(&state);
    let (mut unpaid, mut exchanged, mut load) = (0.0_f64, 0.0, Vector2::zeros());
    for _ in 0..400 {
        let last = state.gains;
        solver.step(&mut state, &rest, 1e-3, &mut workspace).unwrap();
        let now = state.gains;
        exchanged += (now.walls.impulse - last.walls.impulse).norm();
        let rest = |gains: &fluid::Gains| (gains.projection + gains.smoothing + gains.shifting).impulse;
        unpaid = unpaid.max((rest(&now) - rest(&last)).norm() / exchanged);
        load += Vector2::new(state.load[0], state.load[1]) * 1e-3;
        let account = &state.gas.account;
        let held = account.enclosed - account.released - account.vented - account.lost;
        assert!((state.gas.mass() - held).abs() < 1e-12 * held, "{account:?}");
    }
    let left = content(&state) - before - state.gains.sum();
    let size = |of: fn(&Gain) -> f64| state.gains.terms().iter().map(of).sum::<f64>();
    assert!(left.impulse.norm() < 1e-11 * size(|gain| gain.impulse.norm()), "{left:?}");
    assert!(left.angular.abs() < 1e-11 * size(|gain| gain.angular.abs()), "{left:?}");
    assert!(left.energy.abs() < 1e-10 * size(|gain| gain.energy.abs()), "{left:?}");
    assert!(unpaid < 1e-12, "{unpaid}");
    assert!(!state.gas.pockets.is_empty() && load.norm() > 0.1, "{load}");
}

/// A box with water in it, all round closed, and pressed upwards at the end.
fn closed_box(pressure: f64) -> (State, Motion) {
    let mut outline = points(&[(-0.2, -0.1), (0.2, -0.1), (0.2, 0.1), (-0.2, 0.1)]);
    outline.push(outline[0]);
    let angle: f64 = 0.3;
    let (sine, cosine) = angle.sin_cos();
    // The water fills the tilted box up to Y = 0: the polygon that the level cuts off.
    let turned = |x: f64, y: f64| (cosine * x - sine * y, sine * x + cosine * y);
    let cut = |x: f64| turned(x, -x * sine / cosine);
    let water = points(&[turned(-0.2, -0.1), turned(0.2, -0.1), cut(0.2), cut(-0.2)]);
    let body = Body { origin: Vector2::zeros(), angle, walls: vec![outline], members: Vec::new() };
    let geometry = Geometry {
        water: vec![water],
        bodies: body.into(),
        active: vec![0, 1, 2],
        chambers: vec![Chamber { place: Vector2::new(0.0, 0.06), on_body: Some(0), pressure: Some(pressure) }],
        ..Geometry::default()
    };
    let solver = Solver::new(with_gas(0.01, 1e5, 1), geometry).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    let motion = solver.at_rest();
    for _ in 0..20 {
        solver.step(&mut state, &motion, 1e-3, &mut workspace).unwrap();
    }
    (state, motion)
}

/// The pressure of a closed compartment puts no force on its body, whatever it is.
#[test]
fn gas_in_a_closed_body_pushes_it_nowhere() {
    let [low, high] = [1e5, 2e5].map(|pressure| closed_box(pressure).0);
    assert!(low.gas.pockets.len() == 1 && (high.gas.pockets[0].push / 1e5 - 1.0).abs() < 1e-3);
    for k in 0..3 {
        let change = high.load[k] - low.load[k];
        // 1e5 Pa on 0.4 m of wall.
        assert!(change.abs() < 1e-8 * 4e4, "coordinate {k}: {change} N/m of {}", low.load[k]);
    }
}

/// The same bits with one thread and two, and from a copy of the state in a fresh workspace.
#[test]
fn gas_is_reproducible() {
    let [one, two] = [1, 2].map(closed_splash);
    let (mut states, rest) = ([one.initial_state(), two.initial_state()], one.at_rest());
    let (mut first, mut second) = (one.workspace(), two.workspace());
    for step in 0..250 {
        one.step(&mut states[0], &rest, 1e-3, &mut first).unwrap();
        if step == 200 {
            second = two.workspace();
        }
        two.step(&mut states[1], &rest, 1e-3, &mut second).unwrap();
    }
    assert!(!states[0].gas.pockets.is_empty());
    assert_eq!(states[0], states[1]);
}

/// With gas, too, the added mass says what the load becomes with another acceleration of the body.
#[test]
fn the_load_is_affine_with_gas() {
    let solver = closed_splash(1);
    let (mut state, mut workspace, rest) = (solver.initial_state(), solver.workspace(), solver.at_rest());
    for _ in 0..150 {
        solver.step(&mut state, &rest, 1e-3, &mut workspace).unwrap();
    }
    let loads = [0.0, 2.0, 5.0].map(|acceleration| {
        let (mut trial, mut end) = (state.clone(), rest.clone());
        end.velocity[3] += acceleration * 5e-4;
        end.position[3] += acceleration * 5e-4 * 5e-4 / 2.0;
        solver.step(&mut trial, &end, 5e-4, &mut workspace).unwrap();
        (trial.load[3], trial.added_mass[15])
    });
    for (load, acceleration) in [(loads[1].0, 2.0), (loads[2].0, 5.0)] {
        let expected = loads[0].0 - loads[0].1 * acceleration;
        assert!((load - expected).abs() < 1e-5 * (loads[0].1 * acceleration).abs(), "{load} for {expected}, {loads:?}");
    }
}

/// Water that falls onto a pocket with a vent: it goes down at the speed at which the gas flows out, C A sqrt(2 p / rho_g) =
/// v width with p = rho g h, once it does not speed up any more (a quasi-steady orifice). Later the gas breaks through.
#[test]
fn a_vent_lets_the_water_down() {
    let (spacing, height, pocket) = (0.02, 0.5, 1.0);
    let width = 10.0 * spacing;
    let vent = Vent { place: Vector2::new(0.1, 0.04), to: None, on_body: None, area: 2e-4, discharge: 0.6 };
    let density = 1.2 * (1.0_f64 + 9810.0 * height / 1e5).powf(1.0 / 1.4);
    let expected = 0.6 * 2e-4 / width * (2.0 * 9810.0 * height / density).sqrt();
    let geometry = Geometry {
        water: vec![rectangle(0.0, pocket, width, pocket + height)],
        fixed_walls: vec![tank(width, 2.0)],
        start: AffineVelocity { constant: Vector2::new(0.0, -expected), ..AffineVelocity::default() },
        chambers: vec![Chamber { place: vent.place, on_body: None, pressure: Some(1e5 + 9810.0 * height) }],
        vents: vec![vent],
        ..Geometry::default()
    };
    let solver = Solver::new(with_gas(spacing, 1e5, 2), geometry).unwrap();
    let (mut places, mut flows) = (Vec::new(), Vec::new());
    history(&solver, 800, 1e-3, |state| {
        places.push((state.time, state.gas.chambers[0].volume / width));
        flows.push(state.gas.vents[0]);
        let account = &state.gas.account;
        let held = account.enclosed - account.released - account.vented - account.lost;
        assert!((state.gas.mass() - held).abs() < 1e-12 * held, "{account:?}");
    });
    let fit = |list: &[(f64, f64)]| (list[list.len() - 1].1 - list[0].1) / (list[list.len() - 1].0 - list[0].0);
    let speed = -fit(&places[400..]);
    assert!((speed / expected - 1.0).abs() < 0.01, "{speed} for {expected}");
    let flow = flows[400..].iter().sum::<f64>() / 400.0;
    assert!((flow / (expected * width * density) - 1.0).abs() < 0.01, "{flow}");
}
