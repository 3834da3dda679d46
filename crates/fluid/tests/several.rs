//! Several bodies, and several members on one, in one water.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{Geometry, Probe, Solver, State, Workspace};
use kinematics::{Body, BodySet, Motion};
use nalgebra::Vector2;
use samples::{parameters, plate, points, rectangle, tank, voronoi};

/// Two boxes, 0.2 m wide, 0.1 m deep in water of 0.5 m, side by side.
fn two_boxes() -> Geometry {
    let water = points(&[
        (0.0, 0.0),
        (2.0, 0.0),
        (2.0, 0.5),
        (1.4, 0.5),
        (1.4, 0.4),
        (1.2, 0.4),
        (1.2, 0.5),
        (0.8, 0.5),
        (0.8, 0.4),
        (0.6, 0.4),
        (0.6, 0.5),
        (0.0, 0.5),
    ]);
    let square = points(&[(-0.1, -0.1), (-0.1, 0.1), (0.1, 0.1), (0.1, -0.1), (-0.1, -0.1)]);
    let afloat =
        |x: f64| Body { origin: Vector2::new(x, 0.5), angle: 0.0, walls: vec![square.clone()], members: Vec::new() };
    Geometry {
        water: vec![water],
        fixed_walls: vec![tank(2.0, 1.0)],
        bodies: BodySet::new(vec![afloat(0.7), afloat(1.3)]),
        active: (0..6).collect(),
        probes: vec![Probe { on_body: Some(1), ..Vector2::new(1.3, 0.4).into() }],
        ..Geometry::default()
    }
}

/// Two plates on one floor, with water before, between and behind them.
fn two_plates() -> Geometry {
    let (mut body, other) = (plate(0.2, 0.12, 0.01, 2), plate(0.3, 0.12, 0.01, 1));
    // Both stand on the rigid part of the first.
    let beam = other.members[0].clone();
    let middle = beam.middle + other.origin - body.origin;
    body.members.push(kinematics::Beam { middle, ..beam });
    let pools = [(0.0, 0.195), (0.205, 0.295), (0.305, 0.4)];
    Geometry {
        water: pools.map(|(from, to)| rectangle(from, 0.0, to, 0.1)).to_vec(),
        fixed_walls: vec![tank(0.4, 0.3)],
        bodies: body.into(),
        active: (3..6).collect(),
        ..Geometry::default()
    }
}

fn stepped(solver: &Solver, start: &State, workspace: &mut Workspace, acceleration: &[f64]) -> State {
    let duration = 2e-4;
    let mut end = Motion::zeros(acceleration.len());
    end.acceleration.copy_from_slice(acceleration);
    end.velocity = &end.acceleration * duration;
    end.position = &end.acceleration * (0.5 * duration * duration);
    let mut state = start.clone();
    assert_eq!(solver.step(&mut state, &end, duration, workspace).unwrap().substeps, 1);
    state
}

/// Loads of all coordinates change with the acceleration of any as the added mass says, which is symmetric.
fn is_affine(geometry: Geometry, spacing: f64, active: std::ops::Range<usize>, scale: f64) -> Vec<f64> {
    let solver = Solver::new(parameters(voronoi(), spacing, 1e-12, 2), geometry).unwrap();
    let (start, mut workspace) = (solver.initial_state(), solver.workspace());
    let size = start.load.len();
    let reference = stepped(&solver, &start, &mut workspace, &vec![0.0; size]);
    let mass = &reference.added_mass;
    for k in active.clone() {
        let mut acceleration = vec![0.0; size];
        acceleration[k] = scale;
        let state = stepped(&solver, &start, &mut workspace, &acceleration);
        let own = mass[k * size + k] * scale;
        assert!(own > 0.0, "coordinate {k}: {own}");
        for row in active.clone() {
            let (change, predicted) = (state.load[row] - reference.load[row], -mass[row * size + k] * scale);
            assert!((change - predicted).abs() < 1e-5 * own, "{row}, {k}: {change} in place of {predicted}");
            assert!((mass[k * size + row] - mass[row * size + k]).abs() < 1e-10 * own / scale, "{row}, {k}");
        }
    }
    mass.clone()
}

#[test]
fn each_of_two_boxes_is_carried_by_the_water_that_it_displaces() {
    let solver = Solver::new(parameters(voronoi(), 0.02, 1e-10, 2), two_boxes()).unwrap();
    let (start, mut workspace) = (solver.initial_state(), solver.workspace());
    let state = stepped(&solver, &start, &mut workspace, &[0.0; 6]);
    // rho g times 0.2 m by 0.1 m.
    let weight = 196.2;
    for body in [0, 3] {
        let [x, y, moment] = [state.load[body], state.load[body + 1], state.load[body + 2]];
        assert!((y / weight - 1.0).abs() < 1e-4, "{y} N/m");
        assert!(x.abs() < 1e-3 * weight && moment.abs() < 1e-4 * weight, "{x} N/m, {moment} N");
    }
    let pressure = solver.observe(&state).probes[0];
    assert!((pressure / 981.0 - 1.0).abs() < 1e-3, "{pressure} Pa under the second box");
}

/// The set-up is its own mirror image, and so are the loads.
#[test]
fn the_loads_of_two_boxes_are_mirror_images() {
    let solver = Solver::new(parameters(voronoi(), 0.02, 1e-12, 2), two_boxes()).unwrap();
    let (start, mut workspace) = (solver.initial_state(), solver.workspace());
    let load = stepped(&solver, &start, &mut workspace, &[0.0; 6]).load;
    for (left, right) in [(load[0], -load[3]), (load[1], load[4]), (load[2], -load[5])] {
        assert!((left - right).abs() < 1e-7 * load[1].abs(), "{left} and {right}");
    }
}

/// A box that is pressed down drives the water up under the other.
#[test]
fn two_boxes_feel_each_other_through_the_water() {
    let mass = is_affine(two_boxes(), 0.02, 0..6, 0.5);
    let (own, other) = (mass[7], mass[6 + 4]);
    assert!(other > 0.01 * own && other < own, "heave {own}, from one to the other {other}");
}

#[test]
fn two_members_of_one_body_feel_each_other_through_the_water() {
    let mass = is_affine(two_plates(), 0.005, 3..6, 0.3);
    let (own, other) = (mass[3 * 6 + 3], mass[3 * 6 + 5]);
    assert!(other.abs() > 0.01 * own, "first modes: {own}, from one to the other {other}");
}

#[test]
fn a_probe_on_a_body_that_is_not_there_is_refused() {
    let mut geometry = two_boxes();
    geometry.probes[0].on_body = Some(2);
    let message = Solver::new(parameters(voronoi(), 0.02, 1e-8, 1), geometry).unwrap_err().to_string();
    assert!(message.contains("a probe on body 2") && message.contains("2 bodies"), "{message}");
}

/// Bodies that stand in one another are refused, at the start and on their way.
#[test]
fn bodies_stay_apart() {
    let shifted = |way: f64| {
        let mut geometry = two_boxes();
        let mut bodies = geometry.bodies.bodies().to_vec();
        bodies[1].origin.x += way;
        geometry.bodies = BodySet::new(bodies);
        geometry
    };
    let made =
        |way: f64| Solver::new(parameters(voronoi(), 0.04, 1e-6, 1), shifted(way)).map_err(|error| error.to_string());
    for way in [-0.5, -0.6] {
        let message = made(way).unwrap_err();
        assert!(message.contains("two bodies stand in one another"), "{way}: {message}");
    }
    let solver = made(0.0).unwrap();
    let (state, mut end) = (solver.initial_state(), solver.at_rest());
    // The left box reaches to 0.8 m, the right one begins at 1.2 m.
    for (way, fits) in [(0.39, true), (0.45, false)] {
        end.position[0] = way;
        end.velocity[0] = 1.0;
        let stepped = solver.step(&mut state.clone(), &end, 1e-3, &mut solver.workspace());
        let told =
            stepped.as_ref().err().is_some_and(|error| error.to_string().contains("two bodies stand in one another"));
        assert_eq!(told, !fits, "{way} m: {stepped:?}");
    }
}
