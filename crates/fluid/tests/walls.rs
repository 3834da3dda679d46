//! Verification of walls: what particles see at them, what they feel, and that nothing passes.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{Geometry, Probe, Scheme, Solver, VoronoiParameters};
use kinematics::{Body, Motion};
use nalgebra::Vector2;
use samples::{Column, mps, parameters, plate, rectangle, tank, voronoi};

fn lattice_density(radius: f64) -> f64 {
    fluid::Kernel::new(radius, Vector2::new(1.0, 1.0)).reference_density
}

/// On the starting lattice the images behind floor, side walls and corners complete the lattice exactly.
#[test]
fn images_complete_the_lattice_at_walls_and_corners() {
    let geometry = Geometry {
        water: vec![rectangle(0.0, 0.0, 0.5, 0.5)],
        fixed_walls: vec![tank(0.5, 0.9)],
        ..Geometry::default()
    };
    let mut parameters = parameters(mps(), 0.02, 1e-8, 1);
    parameters.gravity = Vector2::zeros();
    let solver = Solver::new(parameters, geometry).unwrap();
    let mut state = solver.initial_state();
    solver.step(&mut state, &solver.at_rest(), 1e-4, &mut solver.workspace()).unwrap();
    let reference = lattice_density(3.1);
    for (position, density) in state.positions.iter().zip(&state.number_densities) {
        if position.y < 0.5 - 3.1 * 0.02 {
            assert!((density / reference - 1.0).abs() < 1e-9, "n = {density} at {position:?}, lattice {reference}");
        }
    }
}

/// The first step from rest finds the hydrostatic pressure: its slope exactly, its level to 0.3 spacings of head. The
/// level is of first order because p = 0 stands at the surface particles and the layers below see no water above.
/// Without the density term, since the fall predicted for the step, g dt^2, enters the number density at the floor.
#[test]
fn hydrostatic_slope_is_exact_and_level_of_first_order() {
    let geometry = Geometry {
        water: vec![rectangle(0.0, 0.0, 1.0, 0.5)],
        fixed_walls: vec![tank(1.0, 0.8)],
        probes: vec![Vector2::new(0.5, 0.0).into()],
        ..Geometry::default()
    };
    let mut parameters = parameters(mps(), 0.02, 1e-10, 1);
    parameters.scheme = fluid::Scheme::Mps(fluid::MpsParameters { alpha: 0.0, ..fluid::MpsParameters::default() });
    let solver = Solver::new(parameters, geometry).unwrap();
    let mut state = solver.initial_state();
    solver.step(&mut state, &solver.at_rest(), 1e-4, &mut solver.workspace()).unwrap();
    let floor = solver.observe(&state).probes[0];
    assert!((floor - 4905.0).abs() < 0.3 * 0.02 * 9810.0, "floor pressure {floor}");
    for (position, pressure) in state.positions.iter().zip(&state.pressures) {
        if position.y < 0.4 {
            let exact = floor - 9810.0 * position.y;
            assert!((pressure - exact).abs() < 1e-5 * 4905.0, "p = {pressure} at {position:?}, exact {exact}");
        }
    }
    let force = solver.observe(&state).wall_force;
    assert!((force.y / floor + 1.0).abs() < 1e-5 && force.x.abs() < 1e-3, "{force:?}");
}

/// A wall that is pushed into water 1 m deep: force per acceleration 0.5427 rho H^2 (Westergaard 1933).
#[test]
fn added_mass_of_a_wall_is_westergaards() {
    for (scheme, tolerance) in [(mps(), 0.005), (voronoi(), 0.003)] {
        let wall = vec![Vector2::new(0.0, 1.2), Vector2::new(0.0, -0.2)];
        let body = Body { origin: Vector2::zeros(), angle: 0.0, walls: vec![wall], members: Vec::new() };
        let geometry = Geometry {
            water: vec![rectangle(0.0, 0.0, 4.0, 1.0)],
            fixed_walls: vec![samples::points(&[(-0.2, 0.0), (4.0, 0.0), (4.0, 1.2)])],
            bodies: body.into(),
            ..Geometry::default()
        };
        let mut parameters = parameters(scheme.clone(), 0.025, 1e-10, 2);
        parameters.gravity = Vector2::zeros();
        let solver = Solver::new(parameters, geometry).unwrap();
        let mut state = solver.initial_state();
        let step = 1e-5;
        let mut end = solver.at_rest();
        end.velocity[0] = step;
        solver.step(&mut state, &end, step, &mut solver.workspace()).unwrap();
        let added_mass = -state.load[0];
        let error = added_mass / 542.7 - 1.0;
        assert!(error.abs() < tolerance, "{scheme:?}: added mass {added_mass}, error {error}");
        assert!(state.load[1].abs() < 1e-9 * added_mass, "no vertical force on a vertical wall: {}", state.load[1]);
    }
}

/// The load of one step is affine in the acceleration asked for, as every accelerated coupling assumes.
#[test]
fn load_is_affine_in_the_acceleration() {
    for scheme in [mps(), voronoi()] {
        let solver = Solver::new(parameters(scheme.clone(), 0.004, 1e-12, 2), with_water_at_the_plate(0.012)).unwrap();
        let start = solver.initial_state();
        let load = |acceleration: [f64; 2]| {
            let mut state = start.clone();
            let mut end = Motion::at_rest(2);
            for (k, value) in acceleration.iter().enumerate() {
                end.velocity[3 + k] = value * 1e-4;
            }
            solver.step(&mut state, &end, 1e-4, &mut solver.workspace()).unwrap();
            state.load
        };
        let (zero, one, two) = (load([0.0, 0.0]), load([1.0, 0.0]), load([-2.0, 3.0]));
        let both = load([-1.0, 3.0]);
        let scale = zero[3].abs().max(zero[4].abs());
        for k in 3..5 {
            let mismatch = both[k] - one[k] - two[k] + zero[k];
            assert!(mismatch.abs() < 1e-8 * scale, "{scheme:?}, {k}: {mismatch} against {scale}");
            assert!((one[k] - zero[k]).abs() > 1e-6 * scale, "the acceleration must matter");
        }
        let symmetry = (load([0.0, 1.0])[3] - zero[3], one[4] - zero[4]);
        assert!((symmetry.0 - symmetry.1).abs() < 0.1 * (one[3] - zero[3]).abs(), "A nearly symmetric: {symmetry:?}");
    }
}

/// What gravity gives the water and its tank takes is what the water's momentum changes by: the tank is a body, whose
/// load is the mean force over each step. Without shifting, which takes velocities from the field where particles go.
/// What is left comes from the free surface, whose pull on a cell is exact for linear pressures and not for momentum.
#[test]
fn momentum_of_a_dam_break_is_that_of_gravity_and_walls() {
    let scheme = Scheme::Voronoi(VoronoiParameters {
        shifting: 0.0,
        repulsion: 0.0,
        spreading: 0.0,
        ..VoronoiParameters::default()
    });
    // The tank itself is the body that the water loads.
    let column = Column::KOSHIZUKA;
    let standing = column.geometry(0.8);
    let tank = Body { origin: Vector2::zeros(), angle: 0.0, walls: standing.fixed_walls.clone(), members: Vec::new() };
    let geometry = Geometry { fixed_walls: Vec::new(), bodies: tank.into(), ..standing };
    let solver = Solver::new(parameters(scheme, 0.006, 1e-9, 2), geometry).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    let weight = column.weight();
    let mut impulse = Vector2::zeros();
    for _ in 0..200 {
        solver.step(&mut state, &solver.at_rest(), 1e-3, &mut workspace).unwrap();
        impulse += Vector2::new(-state.load[0], -state.load[1] - weight) * 1e-3;
        let momentum = solver.observe(&state).momentum;
        let lost = (momentum - impulse).norm() / (weight * state.time);
        assert!(lost < 0.005, "{lost} of the impulse of gravity is lost at t = {}", state.time);
    }
}

fn with_water_at_the_plate(thickness: f64) -> Geometry {
    Geometry {
        water: vec![rectangle(0.0, 0.0, 0.2 - 0.5 * thickness, 0.06)],
        fixed_walls: vec![tank(0.4, 0.3)],
        bodies: (plate(0.2, 0.12, thickness, 2)).into(),
        ..Geometry::default()
    }
}

/// Water on one side of a plate that swings: nothing passes, the dry side feels nothing in any step while the wet one
/// does, at any thickness.
#[test]
fn nothing_passes_a_swinging_plate_of_any_thickness() {
    for scheme in [mps(), voronoi()] {
        for thickness in [0.0005, 0.002, 0.004, 0.013] {
            swing_a_plate(&scheme, thickness);
        }
    }
}

fn swing_a_plate(scheme: &Scheme, thickness: f64) {
    let on_face =
        |side: f64, y: f64| Probe { on_body: Some(0), ..Vector2::new(0.2 + side * 0.5 * thickness, y).into() };
    let probes = [1.0, -1.0].iter().flat_map(|&side| [0.01, 0.02, 0.03].map(|y| on_face(side, y))).collect();
    let geometry = Geometry { probes, ..with_water_at_the_plate(thickness) };
    let solver = Solver::new(parameters(scheme.clone(), 0.004, 1e-6, 2), geometry).unwrap();
    let mut wet = [0.0; 3];
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    let count = state.positions.len();
    let body = plate(0.2, 0.12, thickness, 2);
    let amplitude = 0.01 / body.members[0].modes.shape(0, 0.12).abs();
    let rate = 2.0 * std::f64::consts::PI / 0.3;
    for k in 1..=200 {
        let time = f64::from(k) * 1.5e-3;
        let mut end = Motion::at_rest(2);
        end.position[3] = amplitude * (1.0 - (rate * time).cos());
        end.velocity[3] = amplitude * rate * (rate * time).sin();
        end.acceleration[3] = amplitude * rate * rate * (rate * time).cos();
        solver.step(&mut state, &end, 1.5e-3, &mut workspace).unwrap();
        let seen = solver.observe_with(&state, &mut workspace).probes;
        assert_eq!(seen[..3], [0.0; 3], "{scheme:?}, thickness {thickness}: the dry side at {time} s");
        wet.iter_mut().zip(&seen[3..]).for_each(|(sum, pressure)| *sum += pressure / 200.0);
    }
    assert!(
        wet.iter().all(|mean| (10.0..1000.0).contains(mean)),
        "{scheme:?}, {thickness}: {wet:?} Pa on the wet side"
    );
    assert_eq!((state.positions.len(), state.lost), (count, 0), "{scheme:?}, thickness {thickness}");
    let surface = |station: f64, offset: f64| {
        body.position(kinematics::MaterialPoint::Beam { member: 0, station, offset }, &state.motion).x
    };
    for position in &state.positions {
        assert!(position.y > 0.0 && position.x > 0.0, "{scheme:?}, {thickness}: particle at {position:?}");
        if position.y < 0.12 {
            let wet = surface(position.y, -0.5 * thickness);
            let passed = position.x >= wet;
            assert!(!passed, "{scheme:?}, thickness {thickness}: particle at {position:?} passed the face at {wet}");
        }
    }
}

/// Still water beside a plate: the load on the modes is the virtual work of rho g (h - y) on the wet face alone. With
/// the paper's scheme p = 0 stands about a quarter of a spacing above the water: its level is of first order.
#[test]
fn still_water_loads_only_the_wet_face() {
    for (scheme, tolerance) in [(mps(), 0.04), (voronoi(), 1e-3)] {
        for thickness in [0.001, 0.004, 0.013] {
            let solver =
                Solver::new(parameters(scheme.clone(), 0.002, 1e-10, 2), with_water_at_the_plate(thickness)).unwrap();
            let mut state = solver.initial_state();
            solver.step(&mut state, &Motion::at_rest(2), 1e-4, &mut solver.workspace()).unwrap();
            let body = plate(0.2, 0.12, thickness, 2);
            let modes = &body.members[0].modes;
            for mode in 0..2 {
                let exact = hydrostatic_work(0.06, |y| modes.shape(mode, y));
                let got = state.load[3 + mode];
                let error = got / exact - 1.0;
                assert!(error.abs() < tolerance, "{scheme:?}, {thickness}, mode {mode}: {error}, {got} for {exact}");
            }
        }
    }
}

/// Minus the integral of rho g (`depth` - y) `shape`(y) over the depth.
fn hydrostatic_work(depth: f64, shape: impl Fn(f64) -> f64) -> f64 {
    let step = depth / 2000.0;
    (0..2000).map(|k| (f64::from(k) + 0.5) * step).map(|y| -9810.0 * (depth - y) * shape(y) * step).sum()
}
