//! Exact cases run against the library alone: `cargo run --release -p fluid --example compare -- CASE [KEY=VALUE ...]`.

use fluid::*;
use kinematics::Motion;
use nalgebra::{Matrix2, Vector2};
use std::collections::HashMap;
use std::time::Instant;

fn points(list: &[(f64, f64)]) -> Vec<Vector2<f64>> {
    list.iter().map(|&(x, y)| Vector2::new(x, y)).collect()
}

fn csv(path: &str) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{path}: {e}"));
    text.lines().filter_map(|line| line.split(',').map(|x| x.parse().ok()).collect::<Option<Vec<f64>>>()).collect()
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let case = arguments[0].as_str();
    let keys: HashMap<&str, &str> = arguments[1..].iter().filter_map(|a| a.split_once('=')).collect();
    let number = |key: &str, default: f64| keys.get(key).map_or(default, |v| v.parse().unwrap());
    let flat = |w: f64, h: f64| points(&[(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)]);
    let tank = |w: f64, h: f64| points(&[(0.0, h), (0.0, 0.0), (w, 0.0), (w, h)]);
    let mut geometry = Geometry::default();
    let (mut gravity, mut attraction, mut spacing, mut end) = (Vector2::new(0.0, -9.81), 0.0, 0.01, 1.0);
    match case {
        "rest" => {
            geometry.water = vec![flat(1.0, 0.5)];
            geometry.fixed_walls = vec![tank(1.0, 1.0)];
            geometry.probes = points(&[(0.5, 0.0), (0.0, 0.25)]);
            end = 3.0;
        }
        "wave" => {
            let a = number("a", 0.05);
            let name = if a == 0.05 { "0p05" } else { "0p005" };
            let rows = csv(&format!("/work/shared/reference/B_standing_wave_L1_h0p5_A{name}_initial_surface.csv"));
            let mut polygon = points(&[(0.0, 0.0), (1.0, 0.0)]);
            polygon.extend(rows.iter().rev().map(|row| Vector2::new(row[0], 0.5 + row[1])));
            geometry.water = vec![polygon];
            geometry.fixed_walls = vec![tank(1.0, 1.0)];
            geometry.gauges = vec![0.0];
            end = 5.66;
        }
        "square" => {
            geometry.water = vec![points(&[(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])];
            geometry.start.gradient = Matrix2::new(0.0, -1.0, 1.0, 0.0);
            geometry.probes = points(&[(0.0, 0.0)]);
            gravity = Vector2::zeros();
            end = 2.0;
        }
        "drop" | "stretch" => {
            let angle = |k: usize| std::f64::consts::TAU * k as f64 / 400.0;
            geometry.water = vec![(0..400).map(|k| Vector2::new(angle(k).cos(), angle(k).sin())).collect()];
            geometry.probes = points(&[(0.0, 0.0)]);
            gravity = Vector2::zeros();
            spacing = 0.02;
            if case == "drop" {
                attraction = 1.0;
                geometry.start.gradient = Matrix2::new(0.5, 0.0, 0.0, -0.5);
                end = 4.567374;
            } else {
                geometry.start.gradient = Matrix2::new(-100.0, 0.0, 0.0, 100.0);
                end = 0.0076;
            }
        }
        "dam" => {
            geometry.water = vec![flat(0.146, 0.292)];
            geometry.fixed_walls = vec![tank(0.584, 0.8)];
            geometry.probes = points(&[(0.584, 0.01), (0.0, 0.0), (0.07, 0.0), (0.2, 0.0), (0.4, 0.0)]);
            spacing = 0.004;
            end = 0.5;
        }
        _ => panic!("unknown case"),
    }
    spacing = number("l", spacing);
    end = number("end", end);
    let accurate = AccurateParameters {
        alpha: number("alpha", 0.01),
        courant: number("courant", 0.4),
        shifting: number("shifting", 1.0),
        repulsion: number("repulsion", 20.0),
        spreading: number("spreading", 30.0),
        smoothing: number("smoothing", 1.0),
    };
    let scheme =
        if keys.contains_key("paper") { Scheme::Paper(PaperParameters::default()) } else { Scheme::Accurate(accurate) };
    let parameters = Parameters {
        density: 1000.0,
        gravity,
        attraction,
        shaking: Shaking::default(),
        spacing,
        scheme,
        solve: SolveParameters { tolerance: number("tol", 1e-5), maximum_iterations: 500 },
        threads: number("threads", 0.0) as usize,
    };
    let jitter = number("jitter", 0.0);
    let solver = Solver::new(parameters, geometry).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    let mut seed = 12345u64;
    for position in &mut state.positions {
        for k in 0..2 {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            position[k] += jitter * spacing * ((seed >> 33) as f64 / (1u64 << 31) as f64 - 0.5) * 2.0;
        }
    }
    let n0 = state.number_densities[0];
    let first = solver.observe(&state);
    let rows = number("rows", 20.0) as usize;
    let samples = number("samples", 400.0) as usize;
    let begin = Instant::now();
    let (mut iterations, mut stages) = (0, StageTimes::default());
    let mut series = Vec::new();
    let still = Motion::at_rest(0);
    let e0 = first.kinetic_energy + first.potential_energy;
    println!(
        "particles {} E0 {e0:.6} kinetic {:.6} centre {:.6?}",
        state.positions.len(),
        first.kinetic_energy,
        first.centre
    );
    println!("time steps  E/E0-1  kinetic  maxspeed  centre.y  extent  farthest front  probe level area lost");
    let mut saved = 0;
    for k in 0..samples {
        match solver.step(&mut state, &still, end / samples as f64, &mut workspace) {
            Ok(report) => {
                iterations += report.iterations;
                let s = &report.stages;
                stages.neighbours += s.neighbours;
                stages.assembly += s.assembly;
                stages.solve += s.solve;
                stages.gradient += s.gradient;
                stages.other += s.other;
            }
            Err(error) => {
                println!("{error}");
                break;
            }
        }
        let seen = solver.observe(&state);
        let energy = seen.kinetic_energy + seen.potential_energy;
        if (k + 1) % (samples / rows).max(1) == 0 {
            println!(
                "{:.4} {} {:+.5} {:.5} {:.4} {:.6} [{:.4} {:.4}] {:.5} {:.4} {:.2} {:.5?} {:.6} {}",
                state.time,
                state.steps,
                energy / e0 - 1.0,
                seen.kinetic_energy,
                seen.maximum_speed,
                seen.centre.y,
                seen.extent[1].x,
                seen.extent[1].y,
                seen.farthest,
                seen.front,
                seen.probes.first().unwrap_or(&0.0),
                seen.levels,
                seen.area,
                seen.lost
            );
            if let Some(out) = keys.get("out") {
                let mut text = String::from("x,y,u,v,p,s,n\n");
                for i in 0..state.positions.len() {
                    let (r, u) = (state.positions[i], state.velocities[i]);
                    text += &format!(
                        "{},{},{},{},{},{},{}\n",
                        r.x,
                        r.y,
                        u.x,
                        u.y,
                        state.pressures[i],
                        u8::from(state.surface[i]),
                        state.number_densities[i] / n0
                    );
                }
                std::fs::write(format!("{out}_{saved:03}.csv"), text).unwrap();
                saved += 1;
            }
        }
        series.push((state.time, energy, seen));
    }
    let wall = begin.elapsed().as_secs_f64();
    println!(
        "wall {wall:.2} s, {} steps, {:.1} iterations a step, {:.3} M particle-steps/s  {stages:?}",
        state.steps,
        iterations as f64 / state.steps as f64,
        1e-6 * state.steps as f64 * state.positions.len() as f64 / wall
    );
    let half = series.len() / 2;
    if let Some(out) = keys.get("series") {
        let mut text = String::new();
        for (time, energy, seen) in &series {
            text += &format!("{time},{energy},{},{}", seen.kinetic_energy, seen.front);
            for p in &seen.probes {
                text += &format!(",{p}");
            }
            for p in &seen.levels {
                text += &format!(",{p}");
            }
            text += "\n";
        }
        std::fs::write(out, text).unwrap();
    }
    if case == "rest" {
        for p in 0..2 {
            let values: Vec<f64> = series[series.len() / 6..].iter().map(|s| s.2.probes[p]).collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let rms = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
            println!("probe {p}: mean {mean:.2} rms {:.5} of rho g H", rms / 4905.0);
        }
        let l2 = (state
            .positions
            .iter()
            .zip(&state.pressures)
            .map(|(r, p)| (p - 9810.0 * (0.5 - r.y)).powi(2))
            .sum::<f64>()
            / state.positions.len() as f64)
            .sqrt();
        let speed =
            series[half..].iter().map(|s| 2.0 * s.2.kinetic_energy / 500.0).sum::<f64>() / (series.len() - half) as f64;
        println!(
            "L2 p {:.5}, rms velocity {:.5}, fall {:.5} of H, force {:.2}",
            l2 / 4905.0,
            speed.sqrt(),
            (first.centre.y - state.positions.iter().map(|r| r.y).sum::<f64>() / state.positions.len() as f64) / 0.5,
            series.last().unwrap().2.wall_force.y
        );
    }
    if case == "wave" {
        let signal: Vec<(f64, f64)> = series.iter().map(|s| (s.0, s.2.potential_energy)).collect();
        let _ = signal;
        let mean = 0.5;
        let mut crossings = Vec::new();
        for pair in series.windows(2) {
            let (a, b) = (pair[0].2.levels[0] - mean, pair[1].2.levels[0] - mean);
            if a > 0.0 && b <= 0.0 {
                crossings.push(pair[0].0 + (pair[1].0 - pair[0].0) * a / (a - b));
            }
        }
        let period = (crossings.last().unwrap() - crossings[0]) / (crossings.len() - 1) as f64;
        let rest = 500.0 * 9.81 * 0.25;
        println!(
            "period {period:.5} over {} ; wave energy left {:.4}",
            crossings.len() - 1,
            (series.last().unwrap().1 - rest) / (e0 - rest)
        );
    }
}
