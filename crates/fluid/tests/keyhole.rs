//! Water around an obstacle as one polygon with a slit, at rest.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{Geometry, Scheme, Solver};
use nalgebra::Vector2;
use samples::{mps, parameters, points, rectangle, tank, voronoi};

/// A tank with an obstacle from (`low`, `low`) to (`high`, `high`) under water.
fn geometry(side: f64, low: f64, high: f64) -> Geometry {
    let middle = 0.5 * side;
    let slit = [(middle, side), (middle, high), (high, high), (high, low), (low, low), (low, high), (middle, high)];
    let outside = [(0.0, 0.0), (side, 0.0), (side, side)];
    let water: Vec<_> = outside.into_iter().chain(slit).chain([(middle, side), (0.0, side)]).collect();
    let mut obstacle = rectangle(low, low, high, high);
    obstacle.push(obstacle[0]);
    obstacle.reverse();
    Geometry { water: vec![points(&water)], fixed_walls: vec![tank(side, 1.5 * side), obstacle], ..Geometry::default() }
}

fn settled(scheme: Scheme, spacing: f64, geometry: Geometry) -> (Vector2<f64>, f64, usize) {
    let solver = Solver::new(parameters(scheme, spacing, 1e-8, 2), geometry).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    for _ in 0..40 {
        solver.step(&mut state, &solver.at_rest(), 0.005, &mut workspace).unwrap();
    }
    let figures = solver.observe(&state);
    (figures.wall_force, figures.maximum_speed, figures.lost)
}

/// The walls carry the weight of the water: 0.96 m2 and 0.15 m2.
#[test]
fn water_with_a_slit_is_at_rest() {
    for (spacing, side, low, high) in [(0.05, 1.0, 0.4, 0.6), (0.025, 0.4, 0.15, 0.25)] {
        let (force, speed, lost) = settled(voronoi(), spacing, geometry(side, low, high));
        let weight = 9810.0 * (side * side - (high - low).powi(2));
        assert!((force.y / weight + 1.0).abs() < 0.01, "force {force:?} for a weight of {weight}");
        assert!(force.x.abs() < 0.002 * weight && lost == 0, "{force:?}, {lost} particles lost");
        assert!(speed < 0.01, "the water moves at {speed} m/s");
    }
}

/// The scheme `mps` takes the same polygon.
#[test]
fn the_classical_scheme_fills_it_too() {
    let solver = Solver::new(parameters(mps(), 0.05, 1e-8, 1), geometry(1.0, 0.4, 0.6)).unwrap();
    assert_eq!(solver.initial_state().positions.len(), 384);
}

#[test]
fn walls_on_the_wrong_side_are_refused_with_place_and_remedy() {
    let base = |walls: &[&[(f64, f64)]]| {
        let fixed_walls = walls.iter().map(|wall| points(wall)).collect();
        let geometry = Geometry { water: vec![rectangle(0.0, 0.0, 0.3, 0.25)], fixed_walls, ..Geometry::default() };
        Solver::new(parameters(voronoi(), 0.02, 1e-8, 1), geometry).map(|_| ()).map_err(|error| error.to_string())
    };
    let tank: &[(f64, f64)] = &[(0.0, 0.8), (0.0, 0.0), (1.0, 0.0), (1.0, 0.8)];
    let refused = |walls: &[&[(f64, f64)]], words: &[&str]| {
        let message = base(walls).unwrap_err();
        assert!(words.iter().all(|word| message.contains(word)), "{message}: expected {words:?}");
    };
    // A wall at the right that is walked downwards, apart from the floor.
    refused(
        &[&[(0.0, 0.8), (0.0, 0.0), (1.1, 0.0)], &[(1.0, 0.8), (1.0, 0.01)]],
        &["a fixed wall from (1, 0.8) to (1, 0.01)", "sees its solid side at (1, ", "reverse the order of its points"],
    );
    refused(&[tank, &[(0.7, 0.0), (0.7, 0.08), (0.45, 0.0)]], &["from (0.7, 0.08) to (0.45, 0)", "reverse"]);
    refused(
        &[tank, &[(0.8, 0.3), (0.9, 0.3), (0.9, 0.4), (0.8, 0.4), (0.8, 0.3)]],
        &["sees its solid side", "reverse"],
    );
    base(&[tank, &[(0.45, 0.0), (0.7, 0.08), (0.7, 0.0)]]).unwrap();
    base(&[tank, &[(0.5, 0.1), (0.5, 0.2), (0.6, 0.2), (0.6, 0.1), (0.5, 0.1)]]).unwrap();
    // A spike of 5 degrees in the floor.
    base(&[&[(0.0, 0.8), (0.0, 0.0), (0.5, 0.0), (0.515, 0.3), (0.541, 0.0), (1.0, 0.0), (1.0, 0.8)]]).unwrap();
}

/// A particle within a block whose bottom lies under the floor: the floor is nearer to it than any side of the block.
#[test]
fn water_within_a_block_that_stands_in_the_floor_is_refused() {
    let mut block = rectangle(0.35, -0.02, 0.65, 0.2);
    block.push(block[0]);
    block.reverse();
    let water = vec![rectangle(0.45, 0.0, 0.55, 0.1)];
    let geometry = Geometry { water, fixed_walls: vec![tank(1.0, 0.8), block], ..Geometry::default() };
    let message = Solver::new(parameters(voronoi(), 0.05, 1e-8, 1), geometry).unwrap_err().to_string();
    assert!(message.contains("inside a solid"), "{message}");
}
