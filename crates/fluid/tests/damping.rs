//! Verification: damping zones, random displacement at the start, and a body that meets a wall.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{AffineVelocity, DampingZone, Error, Geometry, Jitter, Solver};
use kinematics::Body;
use nalgebra::Vector2;
use samples::{mps, parameters, points, rectangle, tank, voronoi};

/// A square of water in flight without gravity loses its speed as exp(-rate t) where the damping is full.
#[test]
fn water_in_a_damping_zone_slows_down_exponentially() {
    for scheme in [voronoi(), mps()] {
        let mut parameters = parameters(scheme, 0.05, 1e-8, 1);
        parameters.gravity = Vector2::zeros();
        parameters.damping = vec![DampingZone { from: -2.0, to: -1.0, rate: 5.0 }];
        let start = AffineVelocity { constant: Vector2::new(0.3, 0.1), ..AffineVelocity::default() };
        let geometry = Geometry { water: vec![rectangle(0.0, 0.0, 0.5, 0.5)], start, ..Geometry::default() };
        let solver = Solver::new(parameters, geometry).unwrap();
        let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
        for _ in 0..20 {
            solver.step(&mut state, &solver.at_rest(), 0.01, &mut workspace).unwrap();
        }
        let kept = (-5.0_f64 * 0.2).exp();
        for velocity in &state.velocities {
            assert!((velocity - Vector2::new(0.3, 0.1) * kept).norm() < 1e-9, "{velocity}");
        }
    }
}

#[test]
fn the_rate_grows_with_the_square_of_the_way() {
    let zone = DampingZone { from: 0.8, to: 0.0, rate: 20.0 };
    let rates = [1.0, 0.8, 0.4, 0.0, -1.0].map(|x| zone.rate_at(x));
    assert!(rates.iter().zip([0.0, 0.0, 5.0, 20.0, 20.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{rates:?}");
    let mut parameters = parameters(voronoi(), 0.05, 1e-8, 1);
    parameters.damping = vec![DampingZone { from: 0.8, to: 0.8, rate: 20.0 }];
    assert!(parameters.validate().unwrap_err().to_string().contains("damping.to = 0.8"));
}

/// The end of a tank that damps sends back less than a tenth of a wave's energy: a hump that splits into two waves
/// leaves the tank, while without damping its energy stays.
#[test]
fn a_damped_end_does_not_echo() {
    let energy = |damping: Vec<DampingZone>| {
        let hump = points(&[(0.0, 0.0), (2.0, 0.0), (2.0, 0.2), (1.2, 0.2), (1.0, 0.25), (0.8, 0.2), (0.0, 0.2)]);
        let geometry = Geometry { water: vec![hump], fixed_walls: vec![tank(2.0, 0.6)], ..Geometry::default() };
        let parameters = fluid::Parameters { damping, ..parameters(voronoi(), 0.02, 1e-5, 2) };
        let solver = Solver::new(parameters, geometry).unwrap();
        let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
        for _ in 0..150 {
            solver.step(&mut state, &solver.at_rest(), 0.01, &mut workspace).unwrap();
        }
        let rest = 0.5 * 1000.0 * 9.81 * (0.41_f64 / 2.0).powi(2) * 2.0;
        let seen = solver.observe(&state);
        seen.kinetic_energy + seen.potential_energy - rest
    };
    let zones = vec![DampingZone { from: 0.7, to: 0.0, rate: 15.0 }, DampingZone { from: 1.3, to: 2.0, rate: 15.0 }];
    let (free, damped) = (energy(Vec::new()), energy(zones));
    assert!(damped < 0.1 * free, "energy of the waves after 1.5 s: {free} J/m without, {damped} J/m with damping");
}

#[test]
fn a_seed_decides_the_displacements() {
    let places = |amplitude: f64, seed: u64| {
        let jitter = Jitter { amplitude, seed };
        let geometry = Geometry { water: vec![rectangle(0.0, 0.0, 0.5, 0.5)], jitter, ..Geometry::default() };
        Solver::new(parameters(voronoi(), 0.05, 1e-5, 1), geometry).map(|solver| solver.initial_state().positions)
    };
    let (none, one, again, other) = (places(0.0, 1), places(0.1, 1), places(0.1, 1), places(0.1, 2));
    assert_eq!(one, again);
    assert_ne!(one, other);
    // Particles are sorted by place: the one that was displaced is the nearest.
    let none = none.unwrap();
    let nearest = |place: &Vector2<f64>| none.iter().map(|a| (a - place).amax()).fold(f64::INFINITY, f64::min);
    let most = one.unwrap().iter().map(nearest).fold(0.0, f64::max);
    assert!(most > 0.08 * 0.05 && most <= 0.1 * 0.05, "largest displacement {most} m");
    assert!(places(0.3, 1).unwrap_err().to_string().contains("start.jitter = 0.3"));
}

/// A box in front of the floor may come down to it and a little beyond, as one that is held there by a spring does.
#[test]
fn a_body_that_passes_through_a_wall_is_refused() {
    let square = points(&[(-0.1, -0.1), (-0.1, 0.1), (0.1, 0.1), (0.1, -0.1), (-0.1, -0.1)]);
    let body = Body { origin: Vector2::new(0.7, 0.3), angle: 0.0, walls: vec![square], members: Vec::new() };
    let geometry = Geometry {
        water: vec![rectangle(0.0, 0.0, 0.4, 0.3)],
        fixed_walls: vec![tank(1.0, 0.6)],
        bodies: body.into(),
        ..Geometry::default()
    };
    let solver = Solver::new(parameters(voronoi(), 0.05, 1e-5, 1), geometry).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    let mut fall = |depth: f64| {
        let mut end = solver.at_rest();
        end.position[1] = -depth;
        end.velocity[1] = (-depth - state.motion.position[1]) / 0.01;
        solver.step(&mut state, &end, 0.01, &mut workspace)
    };
    fall(0.1).unwrap();
    fall(0.2).unwrap();
    fall(0.21).unwrap();
    match fall(0.22) {
        Err(Error::Contact { y, time, .. }) => assert!((y + 0.02).abs() < 1e-9 && time > 0.0, "{y} {time}"),
        other => panic!("{other:?}"),
    }
}
