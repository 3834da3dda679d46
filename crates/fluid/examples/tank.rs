//! Water in a tank without any file format: `cargo run --release -p fluid --example tank -- rest|dam SPACING END`.
//!
//! Prints time, step, iterations and energies, and writes the particles of the end to standard error as CSV.

use fluid::{Geometry, PaperParameters, Parameters, Scheme, SolveParameters, Solver, Source};
use kinematics::Motion;
use nalgebra::Vector2;

fn option(name: &str, default: f64) -> f64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let case = arguments.first().map_or("rest", String::as_str);
    let number = |k: usize, default: f64| arguments.get(k).and_then(|text| text.parse().ok()).unwrap_or(default);
    let (spacing, end) = (number(1, 0.02), number(2, 1.0));
    let (width, height, tank) = if case == "dam" { (0.146, 0.292, 0.584) } else { (1.0, 0.5, 1.0) };
    let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)];
    let wall = [(0.0, 3.0 * height), (0.0, 0.0), (tank, 0.0), (tank, 3.0 * height)];
    let points = |list: &[(f64, f64)]| list.iter().map(|&(x, y)| Vector2::new(x, y)).collect::<Vec<_>>();
    let paper = PaperParameters {
        influence_radius: option("RADIUS", 3.1),
        alpha: option("ALPHA", 0.01),
        source: if option("ADAPTIVE", 0.0) > 0.0 { Source::Adaptive } else { Source::Mixed },
        courant: option("COURANT", 0.2),
        shifting: option("SHIFT", 0.03),
        tension: option("TENSION", 0.0) > 0.0,
        collision_distance: option("COLLISION", 0.85),
        restitution: 0.2,
        surface_deviation: 0.2,
    };
    let parameters = Parameters {
        density: 1000.0,
        gravity: Vector2::new(0.0, -9.81),
        spacing,
        scheme: Scheme::Paper(paper),
        solve: SolveParameters { tolerance: option("TOLERANCE", 1e-3), maximum_iterations: 500 },
        threads: option("THREADS", 2.0) as usize,
    };
    let geometry = Geometry {
        water: vec![points(&corners)],
        fixed_walls: vec![points(&wall)],
        probes: vec![Vector2::new(0.5 * tank, 0.0), Vector2::new(0.0, 0.5 * height)],
        ..Geometry::default()
    };
    let solver = Solver::new(parameters, geometry)?;
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    let rest = Motion::at_rest(0);
    let count = option("COUNT", 100.0) as i32;
    let mut stages = fluid::StageTimes::default();
    let mut floor = Vec::new();
    println!("t, steps, dt, iterations/step, kinetic, potential, floor p, centre y, max u, front, wall force y, lost");
    for k in 1..=count {
        let report = solver.step(&mut state, &rest, end / f64::from(count), &mut workspace)?;
        stages.neighbours += report.stages.neighbours;
        stages.assembly += report.stages.assembly;
        stages.solve += report.stages.solve;
        stages.gradient += report.stages.gradient;
        stages.other += report.stages.other;
        if state.time > 0.5 {
            floor.push(solver.observe(&state).probes[0]);
        }
        if k % option("EVERY", 10.0) as i32 == 0 {
            let seen = solver.observe(&state);
            println!(
                "{:.3} {} {:.2e} {:.2} {:.4e} {:.5} {:.1} {:.6} {:.4} {:.4} {:.1} {}",
                state.time,
                state.steps,
                state.time_step,
                report.iterations as f64 / report.substeps as f64,
                seen.kinetic_energy,
                seen.potential_energy,
                seen.probes[0],
                seen.centre.y,
                seen.maximum_speed,
                seen.front,
                seen.wall_force.y,
                seen.lost
            );
        }
    }
    let mean = floor.iter().sum::<f64>() / floor.len().max(1) as f64;
    let variance = floor.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / floor.len().max(1) as f64;
    println!("floor pressure: mean {mean:.1} Pa, temporal rms {:.4} of rho g H", variance.sqrt() / (9810.0 * height));
    println!("particles {} stages {stages:?}", state.positions.len());
    for i in 0..state.positions.len() {
        let (r, u) = (state.positions[i], state.velocities[i]);
        eprintln!(
            "{},{},{},{},{},{},{}",
            r.x,
            r.y,
            u.x,
            u.y,
            state.pressures[i],
            state.number_densities[i],
            u8::from(state.surface[i])
        );
    }
    Ok(())
}
