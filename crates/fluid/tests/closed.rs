//! Closed tanks filled to the lid.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{Geometry, Observables, Parameters, Scheme, Solver, VoronoiParameters};
use nalgebra::Vector2;
use samples::{parameters, rectangle};

/// A closed tank of 1 m by 0.5 m from (`x`, 0), walked with the water on the left.
fn closed_tank(x: f64) -> Vec<Vector2<f64>> {
    let mut wall = rectangle(x, 0.0, x + 1.0, 0.5);
    wall.push(wall[0]);
    wall
}

fn rested(spacing: f64, tanks: &[f64], enclosed_pressure: f64, gravity: Vector2<f64>) -> Observables {
    let scheme = Scheme::Voronoi(VoronoiParameters { enclosed_pressure, ..VoronoiParameters::default() });
    let geometry = Geometry {
        water: tanks.iter().map(|&x| rectangle(x, 0.0, x + 1.0, 0.5)).collect(),
        fixed_walls: tanks.iter().map(|&x| closed_tank(x)).collect(),
        probes: tanks.iter().flat_map(|x| [0.0, 0.5].map(|y| Vector2::new(x + 0.5, y).into())).collect(),
        ..Geometry::default()
    };
    let solver = Solver::new(Parameters { gravity, ..parameters(scheme, spacing, 1e-8, 2) }, geometry).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    for _ in 0..40 {
        solver.step(&mut state, &solver.at_rest(), 0.005, &mut workspace).unwrap();
    }
    solver.observe(&state)
}

/// Whatever the number of particles: 32, or 200.
#[test]
fn water_that_fills_a_tank_is_at_rest_with_the_zero_at_its_lid() {
    for (spacing, zero) in [(0.125, 0.0), (0.05, 0.0), (0.125, 5000.0)] {
        let figures = rested(spacing, &[0.0, 1.5], zero, Vector2::new(0.0, -9.81));
        assert!((figures.wall_force.y / -9810.0 - 1.0).abs() < 1e-4, "{:?} N/m", figures.wall_force);
        assert!(figures.maximum_speed < 1e-4, "{} m/s", figures.maximum_speed);
        for (k, pressure) in figures.probes.iter().enumerate() {
            let expected = zero + 9810.0 * if k % 2 == 0 { 0.5 } else { 0.0 };
            assert!((pressure - expected).abs() < 1.0, "spacing {spacing}, probe {k}: {pressure} Pa for {expected}");
        }
    }
}

/// Gravity along a slope of three in four: the zero is in the upper corner, at (1, 0.5) of the tank.
#[test]
fn the_highest_point_is_against_gravity() {
    let figures = rested(0.1, &[0.0], 0.0, Vector2::new(-6.0, -8.0));
    for (pressure, y) in figures.probes.iter().zip([0.0, 0.5]) {
        let expected = 1000.0 * (6.0 * 0.5 + 8.0 * (0.5 - y));
        assert!((pressure - expected).abs() < 2.0, "{pressure} Pa for {expected}");
    }
}
