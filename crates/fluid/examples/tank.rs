//! The library by itself, without a file:
//! `cargo run --release -p fluid --example tank -- rest|dam [SPACING [END [THREADS]]]`.
//!
//! Prints a line of figures per hundredth of the run, water at rest in a tank or a collapsing column, and at the end
//! where the time went, in nanoseconds per particle and internal step.

use fluid::{Geometry, Parameters, SolveParameters, Solver, StageTimes};
use nalgebra::Vector2;

fn points(list: &[(f64, f64)]) -> Vec<Vector2<f64>> {
    list.iter().map(|&(x, y)| Vector2::new(x, y)).collect()
}

fn geometry(case: &str) -> Geometry {
    let (width, height, tank) = if case == "dam" { (0.146, 0.292, 0.584) } else { (1.0, 0.5, 1.0) };
    Geometry {
        water: vec![points(&[(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)])],
        fixed_walls: vec![points(&[(0.0, 3.0 * height), (0.0, 0.0), (tank, 0.0), (tank, 3.0 * height)])],
        probes: vec![Vector2::new(0.5 * tank, 0.0).into()],
        ..Geometry::default()
    }
}

fn parameters(spacing: f64, threads: usize) -> Parameters {
    Parameters {
        spacing,
        solve: SolveParameters { tolerance: 1e-3, maximum_iterations: 500 },
        threads,
        ..Parameters::default()
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let case = arguments.next().unwrap_or_else(|| "rest".to_string());
    let spacing: f64 = arguments.next().map_or(Ok(0.01), |text| text.parse())?;
    let end: f64 = arguments.next().map_or(Ok(1.0), |text| text.parse())?;
    let threads: usize = arguments.next().map_or(Ok(0), |text| text.parse())?;
    let solver = Solver::new(parameters(spacing, threads), geometry(&case))?;
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
