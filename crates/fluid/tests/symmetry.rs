//! What is symmetric stays so: loads across the axis are rounding.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{Geometry, Scheme, Solver};
use kinematics::{Body, Motion};
use nalgebra::Vector2;
use samples::{mps, parameters, points, rectangle, voronoi};

/// Largest load across the axis and moment about it of a wedge of 30 degrees that is pressed into water, over the load
/// along the axis and that times the wedge's half width.
fn asymmetry(scheme: Scheme, steps: usize) -> f64 {
    let (half, spacing, speed) = (0.3, 0.05, 1.0);
    let wedge = points(&[(0.0, 0.0), (-half, 0.5 * half), (half, 0.5 * half), (0.0, 0.0)]);
    let body =
        Body { origin: Vector2::new(0.0, 0.5 + 0.5 * spacing), angle: 0.0, walls: vec![wedge], members: Vec::new() };
    let geometry = Geometry {
        water: vec![rectangle(-1.0, 0.0, 1.0, 0.5)],
        fixed_walls: vec![points(&[(-1.0, 1.0), (-1.0, 0.0), (1.0, 0.0), (1.0, 1.0)])],
        bodies: body.into(),
        ..Geometry::default()
    };
    let solver = Solver::new(parameters(scheme, spacing, 1e-12, 2), geometry).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    state.motion.velocity[1] = -speed;
    let (mut across, mut along) = (0.0_f64, 0.0_f64);
    for k in 1..=steps {
        let mut end = Motion::at_rest(0);
        end.position[1] = -speed * 1e-3 * k as f64;
        end.velocity[1] = -speed;
        solver.step(&mut state, &end, 1e-3, &mut workspace).unwrap();
        across = across.max(state.load[0].abs()).max(state.load[2].abs() / half);
        along = along.max(state.load[1].abs());
    }
    assert!(along > 100.0, "{along} N/m");
    across / along
}

/// Through the impact: the tip touches the water at step 25, on the line between two particles.
#[test]
fn a_symmetric_wedge_has_no_load_across_its_axis() {
    for scheme in [voronoi(), mps()] {
        let found = asymmetry(scheme.clone(), 60);
        assert!(found < 1e-10, "{scheme:?}: {found:e} of the load");
    }
}
