//! Verification: a splash throws nothing out that the water has no energy for.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::Solver;
use nalgebra::Vector2;
use samples::{Column, parameters, voronoi};

/// A column breaks into a wall, where its front becomes a jet one or two particles wide. Two particles that nearly
/// touch there have a velocity gradient far above that of the flow, and were once thrown out at 50 times sqrt(2 g H).
/// The jet itself reaches 2.2 to 2.8 times that with any time step.
#[test]
fn a_dam_break_throws_nothing_out() {
    for jitter in [0.1, 0.15, 0.2] {
        let column = Column::KOSHIZUKA;
        let spacing = column.height / 50.0;
        let solver = Solver::new(parameters(voronoi(), spacing, 1e-5, 2), column.geometry(0.8)).unwrap();
        let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
        let noise = |k: usize| ((k * 7919 + 31) % 1009) as f64 / 504.5 - 1.0;
        for (k, position) in state.positions.iter_mut().enumerate() {
            *position += Vector2::new(noise(2 * k), noise(2 * k + 1)) * (jitter * spacing);
        }
        let (mut lowest, mut rise, mut fastest) = (f64::MAX, 0.0_f64, 0.0_f64);
        for _ in 0..200 {
            solver.step(&mut state, &solver.at_rest(), 0.002, &mut workspace).unwrap();
            let seen = solver.observe(&state);
            let energy = seen.kinetic_energy + seen.potential_energy;
            lowest = lowest.min(energy);
            rise = rise.max((energy - lowest) / column.potential_energy());
            fastest = fastest.max(seen.maximum_speed / column.falling_speed());
        }
        assert_eq!(state.lost, 0, "jitter {jitter}");
        assert!(state.jumps > 0, "jitter {jitter}: no cell jumped, though the front breaks");
        assert!(fastest < 3.5, "jitter {jitter}: a particle reached {fastest} sqrt(2 g H)");
        assert!(rise < 0.015, "jitter {jitter}: the energy rose by {rise} of that of the column");
    }
}
