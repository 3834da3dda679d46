//! Gaps narrower than a particle, beside blocks and bodies in water at rest.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{Error, Geometry, Observables, Solver, State};
use kinematics::Body;
use nalgebra::Vector2;
use samples::{parameters, points, rectangle, tank, voronoi};

const SPACING: f64 = 0.02;
/// Weight of a cubic metre of water \[N\].
const WEIGHT: f64 = 9810.0;

fn rested(geometry: Geometry) -> (State, Observables) {
    let solver = Solver::new(parameters(voronoi(), SPACING, 1e-8, 2), geometry).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    for _ in 0..40 {
        solver.step(&mut state, &solver.at_rest(), 0.005, &mut workspace).unwrap();
    }
    let figures = solver.observe(&state);
    (state, figures)
}

/// A block in the water that ends `gap` over the floor: the probes at its foot read the depth.
#[test]
fn water_beside_a_block_over_a_narrow_gap_is_at_rest() {
    for gap in [0.0, 0.001, 0.005, 0.01] {
        let water =
            points(&[(0.0, 0.0), (0.4, 0.0), (0.4, 0.1), (0.5, 0.1), (0.5, 0.0), (0.9, 0.0), (0.9, 0.3), (0.0, 0.3)]);
        let block = points(&[(0.4, gap), (0.4, 0.1), (0.5, 0.1), (0.5, gap), (0.4, gap)]);
        let (_, figures) = rested(Geometry {
            water: vec![water],
            fixed_walls: vec![tank(0.9, 0.6), block],
            probes: vec![Vector2::new(0.398, 0.02).into(), Vector2::new(0.502, 0.02).into()],
            ..Geometry::default()
        });
        let (weight, depth) = (WEIGHT * (0.9 * 0.3 - 0.01), WEIGHT * 0.28);
        assert!((figures.wall_force.y / weight + 1.0).abs() < 0.01, "gap {gap}: {:?} N/m", figures.wall_force);
        assert!(figures.wall_force.x.abs() < 0.002 * weight, "gap {gap}: {:?} N/m", figures.wall_force);
        for pressure in &figures.probes {
            assert!((pressure / depth - 1.0).abs() < 0.01, "gap {gap}: {pressure} Pa for {depth}");
        }
        assert!(figures.maximum_speed < 0.01 && figures.lost == 0, "gap {gap}: {} m/s", figures.maximum_speed);
    }
}

/// A held gate that ends `gap` over the floor carries rho g H2 / 2, and nothing leaks.
#[test]
fn a_gate_over_a_narrow_gap_is_tight() {
    for gap in [0.001, 0.005] {
        let gate = rectangle(0.3, gap, 0.31, 0.5);
        let gate: Vec<_> = gate.iter().chain(&gate[..1]).rev().copied().collect();
        let body = Body { origin: Vector2::zeros(), angle: 0.0, walls: vec![gate], members: Vec::new() };
        let (state, figures) = rested(Geometry {
            water: vec![rectangle(0.0, 0.0, 0.3, 0.3)],
            fixed_walls: vec![tank(1.2, 0.6)],
            bodies: body.into(),
            ..Geometry::default()
        });
        let expected = 0.5 * WEIGHT * 0.09;
        assert!((state.load[0] / expected - 1.0).abs() < 0.01, "gap {gap}: {} N/m for {expected}", state.load[0]);
        assert!(state.positions.iter().all(|place| place.x < 0.3), "gap {gap}: the water leaks");
        assert!(figures.maximum_speed < 0.01, "gap {gap}: {} m/s", figures.maximum_speed);
    }
}

/// The same gate is stopped before it sinks into the floor, although it stood on it from the start.
#[test]
fn a_body_that_stands_on_the_floor_does_not_sink_into_it() {
    for gap in [0.0, 0.001] {
        let block = rectangle(0.5, gap, 0.6, 0.5);
        let block: Vec<_> = block.iter().chain(&block[..1]).rev().copied().collect();
        let body = Body { origin: Vector2::zeros(), angle: 0.0, walls: vec![block], members: Vec::new() };
        let geometry = Geometry {
            water: vec![rectangle(0.0, 0.0, 0.3, 0.3)],
            fixed_walls: vec![tank(1.2, 0.6)],
            bodies: body.into(),
            ..Geometry::default()
        };
        let solver = Solver::new(parameters(voronoi(), SPACING, 1e-8, 2), geometry).unwrap();
        let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
        let mut sink = |depth: f64| {
            let mut end = solver.at_rest();
            end.position[1] = -depth;
            solver.step(&mut state, &end, 0.01, &mut workspace)
        };
        sink(gap + 0.2 * SPACING).unwrap();
        match sink(gap + 0.3 * SPACING) {
            Err(Error::Contact { y, .. }) => assert!((y + 0.3 * SPACING).abs() < 1e-9, "at {y} m"),
            other => panic!("{other:?}"),
        }
    }
}
