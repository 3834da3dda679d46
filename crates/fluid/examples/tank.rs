//! The library by itself, without a file:
//! `cargo run --release -p fluid --example tank -- rest|dam [SPACING [END [THREADS]]]`.
//!
//! Prints a line of figures per hundredth of the run, water at rest in a tank or a collapsing column, and at the end
//! where the time went, in nanoseconds per particle and internal step.

use fluid::{Geometry, Solver, StageTimes};
use nalgebra::Vector2;
use samples::{Column, parameters, voronoi};

fn geometry(case: &str) -> Geometry {
    let still = Column { width: 1.0, height: 0.5, tank: 1.0 };
    let column = if case == "dam" { Column::KOSHIZUKA } else { still };
    let probes = vec![Vector2::new(0.5 * column.tank, 0.0).into()];
    Geometry { probes, ..column.geometry(3.0 * column.height) }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let case = arguments.next().unwrap_or_else(|| "rest".to_string());
    let spacing: f64 = arguments.next().map_or(Ok(0.01), |text| text.parse())?;
    let end: f64 = arguments.next().map_or(Ok(1.0), |text| text.parse())?;
    let threads: usize = arguments.next().map_or(Ok(0), |text| text.parse())?;
    let solver = Solver::new(parameters(voronoi(), spacing, 1e-3, threads), geometry(&case))?;
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    let still = solver.at_rest();
    println!("time [s], internal steps, front [m], floor pressure [Pa], kinetic energy [J/m], potential energy [J/m]");
    let (mut stages, mut iterations) = (StageTimes::default(), 0);
    for _ in 0..100 {
        let report = solver.step(&mut state, &still, 0.01 * end, &mut workspace)?;
        stages += report.stages;
        iterations += report.iterations;
        let seen = solver.observe(&state);
        let (front, floor) = (seen.front, seen.probes[0]);
        let (time, steps) = (state.time, state.steps);
        println!(
            "{time:.4}, {steps}, {front:.4}, {floor:.1}, {:.4}, {:.4}",
            seen.kinetic_energy, seen.potential_energy
        );
    }
    let particle_steps = state.positions.len() as f64 * state.steps as f64;
    let StageTimes { neighbours, assembly, solve, gradient, other } = stages;
    let times = [neighbours, assembly, solve, gradient, other];
    for (name, time) in ["neighbours", "assembly", "solve", "gradient", "other"].iter().zip(times) {
        println!("{name}: {:.0} ns", 1e9 * time / particle_steps);
    }
    println!("iterations per internal step: {:.2}", iterations as f64 / state.steps as f64);
    Ok(())
}
