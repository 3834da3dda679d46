//! Solids with acute corners far from the water, and near it, are accepted at every spacing.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{Geometry, Solver};
use kinematics::Body;
use nalgebra::Vector2;
use samples::{parameters, points, rectangle, tank, voronoi};

const SPACINGS: [f64; 6] = [0.1, 0.07, 0.05, 0.034, 0.025, 0.02];

fn closed(corners: &[(f64, f64)]) -> Vec<Vector2<f64>> {
    let corners = points(corners);
    corners.iter().chain(&corners[..1]).copied().collect()
}

fn accepted(spacing: f64, geometry: Geometry) {
    let solver = Solver::new(parameters(voronoi(), spacing, 1e-6, 1), geometry);
    solver.map(|_| ()).unwrap_or_else(|error| panic!("spacing {spacing}: {error}"));
}

fn body(x: f64, y: f64, corners: &[(f64, f64)]) -> Option<Body> {
    Some(Body { origin: Vector2::new(x, y), angle: 0.0, walls: vec![closed(corners)], members: Vec::new() })
}

/// A keel and a wedge over still water: a particle far below sees their lower corner, and both faces equally near.
#[test]
fn bodies_over_water() {
    for spacing in SPACINGS {
        let keel = body(1.5, 0.8, &[(-0.07, 0.3), (0.07, 0.3), (0.013, -0.23)]);
        let (water, fixed_walls) = (vec![rectangle(0.0, 0.0, 3.0, 0.5)], vec![tank(3.0, 1.2)]);
        accepted(spacing, Geometry { water, fixed_walls, bodies: keel.into(), ..Geometry::default() });
        let wedge = body(3.0, 2.01, &[(0.0, 0.0), (-1.2, 0.692820323), (1.2, 0.692820323)]);
        let (water, fixed_walls) = (vec![rectangle(0.0, 0.0, 6.0, 2.0)], vec![tank(6.0, 4.0)]);
        accepted(spacing, Geometry { water, fixed_walls, bodies: wedge.into(), ..Geometry::default() });
    }
}

/// Walls of another size than the water, and far from it.
#[test]
fn fixed_corners_far_away() {
    for spacing in SPACINGS {
        for distance in [0.1, 1.0, 7.3, 55.0, 1300.0] {
            let triangle = closed(&[(0.0, 2.01), (-1.2, 2.702820323), (1.2, 2.702820323)]);
            let water = vec![rectangle(-distance - 2.2, 0.0, -distance - 1.2, 0.5)];
            accepted(spacing, Geometry { water, fixed_walls: vec![triangle], ..Geometry::default() });
        }
    }
}
