//! Where the scheme `voronoi` is stable: `cargo run --release -p fluid --example stability -- [SWEEP ...]`.
//!
//! Changes one parameter at a time around the defaults, runs three cases with each value, judges every run by figures
//! and prints Markdown tables. Sweeps: courant, spacing, start, alpha, shifting, repulsion, spreading,
//! smoothing, tolerance.

use fluid::{Geometry, Parameters, Scheme, SolveParameters, Solver, State, VoronoiParameters};
use nalgebra::Vector2;
use rayon::prelude::*;
use samples::Column;
use std::f64::consts::TAU;

const DENSITY: f64 = 1000.0;
const GRAVITY: f64 = 9.81;
/// Samples of a run.
const SAMPLES: usize = 240;
/// Samples on either side in the running mean that pressure noise is measured against.
const WINDOW: usize = 5;
/// Rise of the energy above any earlier value, over E0, from which on a run counts as unstable.
const RISE: f64 = 0.005;
/// Change of the water's area, over its area, from which on a run counts as losing volume.
const AREA: f64 = 0.005;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Case {
    /// Water 0.5 m wide and deep in a tank.
    Rest,
    /// A standing wave of amplitude 50 mm in water 1 m wide and 0.5 m deep, from its flat instant, two periods.
    Wave,
    /// A column of 0.146 x 0.292 m that breaks into a wall at 0.584 m.
    Dam,
}

/// What a case is besides its geometry.
struct Outline {
    name: &'static str,
    width: f64,
    depth: f64,
    tank: f64,
    duration: f64,
    probe: Vector2<f64>,
    /// Largest speed that is no sign of failure, over sqrt(2 g H).
    fastest: f64,
    /// Largest noise of the pressure, over rho g H.
    noise: f64,
    /// Samples that the energy is averaged over: half a period of the wave.
    swing: usize,
}

/// Depth in spacings unless it is the one that is swept.
const DEPTH: f64 = 50.0;
const AMPLITUDE: f64 = 0.05;

fn frequency() -> f64 {
    (GRAVITY * TAU * (TAU * 0.5).tanh()).sqrt()
}

impl Case {
    fn outline(self) -> Outline {
        let probe = Vector2::new(0.25, 0.1);
        match self {
            Case::Rest => Outline {
                name: "rest",
                width: 0.5,
                depth: 0.5,
                tank: 0.5,
                duration: 0.5,
                probe,
                fastest: 0.1,
                noise: 0.01,
                swing: 1,
            },
            Case::Wave => Outline {
                name: "wave",
                width: 1.0,
                depth: 0.5,
                tank: 1.0,
                duration: 2.0 * TAU / frequency(),
                probe,
                fastest: 0.3,
                noise: 0.01,
                swing: SAMPLES / 4,
            },
            Case::Dam => Outline {
                name: "dam",
                width: Column::KOSHIZUKA.width,
                depth: Column::KOSHIZUKA.height,
                tank: Column::KOSHIZUKA.tank,
                duration: 0.5,
                probe: Vector2::new(0.05, 0.02),
                fastest: 3.0,
                noise: 0.03,
                swing: 1,
            },
        }
    }
}

/// Where particles stand at the start.
#[derive(Debug, Clone, Copy)]
enum Start {
    Square,
    /// A square lattice with every coordinate changed by up to this share of a spacing.
    Jittered(f64),
    Hexagonal,
}

/// One run.
#[derive(Debug, Clone)]
struct Run {
    label: String,
    case: Case,
    scheme: VoronoiParameters,
    /// Depth in spacings.
    resolution: f64,
    start: Start,
    tolerance: f64,
    /// Share of the case's duration.
    share: f64,
}

impl Run {
    fn new(label: String, case: Case) -> Self {
        let scheme = VoronoiParameters::default();
        Self { label, case, scheme, resolution: DEPTH, start: Start::Square, tolerance: 1e-5, share: 1.0 }
    }

    fn solver(&self) -> Result<Solver, fluid::Error> {
        let Outline { width, depth, tank, probe, .. } = self.case.outline();
        let high = 3.0 * depth;
        let points = |list: [(f64, f64); 4]| list.map(|(x, y)| Vector2::new(x, y)).to_vec();
        let geometry = Geometry {
            water: vec![points([(0.0, 0.0), (width, 0.0), (width, depth), (0.0, depth)])],
            fixed_walls: vec![points([(0.0, high), (0.0, 0.0), (tank, 0.0), (tank, high)])],
            probes: vec![probe.into()],
            ..Geometry::default()
        };
        let parameters = Parameters {
            density: DENSITY,
            gravity: Vector2::new(0.0, -GRAVITY),
            spacing: depth / self.resolution,
            scheme: Scheme::Voronoi(self.scheme.clone()),
            solve: SolveParameters { tolerance: self.tolerance, maximum_iterations: 500 },
            threads: 1,
            ..Parameters::default()
        };
        Solver::new(parameters, geometry)
    }

    fn initial_state(&self, solver: &Solver) -> State {
        let Outline { width, depth, .. } = self.case.outline();
        let mut state = solver.initial_state();
        let spacing = solver.effective_spacing();
        match self.start {
            Start::Square => {}
            Start::Jittered(amount) => jitter(&mut state.positions, amount * spacing),
            Start::Hexagonal => replace(&mut state, hexagonal(width, depth, spacing), width * depth),
        }
        if self.case == Case::Wave {
            let (wave, speed) = (TAU, AMPLITUDE * frequency() / (TAU * depth).sinh());
            for (velocity, place) in state.velocities.iter_mut().zip(&state.positions) {
                let (across, up) = (wave * place.x, wave * place.y);
                *velocity = Vector2::new(-across.sin() * up.cosh(), across.cos() * up.sinh()) * speed;
            }
        }
        state
    }
}

/// Moves every coordinate by up to `amount`, the same in every run.
fn jitter(positions: &mut [Vector2<f64>], amount: f64) {
    let mut seed = 12345_u64;
    for coordinate in positions.iter_mut().flat_map(|position| position.iter_mut()) {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        *coordinate += amount * ((seed >> 33) as f64 / f64::from(1_u32 << 30) - 1.0);
    }
}

/// A hexagonal lattice in a box with one particle per square of the spacing.
fn hexagonal(width: f64, height: f64, spacing: f64) -> Vec<Vector2<f64>> {
    let side = spacing * (2.0 / 3.0_f64.sqrt()).sqrt();
    let (columns, rows) = ((width / side).round(), (height / (0.75_f64.sqrt() * side)).round());
    let place = |row: usize, column: usize| {
        let shift = if row.is_multiple_of(2) { 0.25 } else { 0.75 };
        Vector2::new((column as f64 + shift) * width / columns, (row as f64 + 0.5) * height / rows)
    };
    (0..rows as usize).flat_map(|row| (0..columns as usize).map(move |column| place(row, column))).collect()
}

/// Puts other particles into a state, at rest, that share the area evenly.
fn replace(state: &mut State, positions: Vec<Vector2<f64>>, area: f64) {
    let count = positions.len();
    let density = state.number_densities[0];
    state.positions = positions;
    state.velocities = vec![Vector2::zeros(); count];
    state.pressures = vec![0.0; count];
    state.areas = vec![area / count as f64; count];
    state.number_densities = vec![density; count];
    state.surface = vec![false; count];
}

/// What came of a run.
#[derive(Debug, Default)]
struct Figures {
    failure: Option<String>,
    time: f64,
    steps: u64,
    iterations: usize,
    /// Change of the energy over E0 at the end.
    energy: f64,
    /// Largest rise of the energy above an earlier value, over E0.
    rise: f64,
    /// Largest speed over sqrt(2 g H).
    speed: f64,
    /// Noise of the pressure over rho g H.
    noise: f64,
    /// Largest change of area over the area.
    area: f64,
    lost: usize,
}

impl Figures {
    fn verdict(&self, outline: &Outline) -> String {
        let mut faults = Vec::new();
        if let Some(failure) = &self.failure {
            faults.push(format!("failed: {failure}"));
        }
        for (is_fault, name) in [
            (self.rise > RISE, "gains energy"),
            (self.speed > outline.fastest, "too fast"),
            (self.lost > 0, "loses particles"),
            (self.area > AREA, "changes volume"),
            (self.noise > outline.noise, "noisy"),
        ] {
            if is_fault {
                faults.push(name.to_string());
            }
        }
        if faults.is_empty() { "stable".to_string() } else { faults.join(", ") }
    }
}

/// Energy that figures are relative to: what the water has above the floor, and for the wave that of the wave alone.
fn reference_energy(case: Case) -> f64 {
    let Outline { width, depth, .. } = case.outline();
    match case {
        Case::Wave => 0.25 * DENSITY * GRAVITY * AMPLITUDE * AMPLITUDE * width,
        _ => 0.5 * DENSITY * GRAVITY * depth * depth * width,
    }
}

fn execute(run: &Run) -> Result<Figures, fluid::Error> {
    let outline = run.case.outline();
    let solver = run.solver()?;
    let (mut state, mut workspace) = (run.initial_state(&solver), solver.workspace());
    let first = solver.observe(&state);
    let energy_of = |seen: &fluid::Observables| seen.kinetic_energy + seen.potential_energy;
    let (reference, start) = (reference_energy(run.case), energy_of(&first));
    let top_speed = (2.0 * GRAVITY * outline.depth).sqrt();
    let mut figures = Figures::default();
    let (mut energies, mut pressures) = (vec![start], Vec::with_capacity(SAMPLES));
    let samples = (run.share * SAMPLES as f64) as usize;
    let duration = run.share * outline.duration / samples as f64;
    for _ in 0..samples {
        match solver.step(&mut state, &solver.at_rest(), duration, &mut workspace) {
            Ok(report) => figures.iterations += report.iterations,
            Err(error) => {
                figures.failure = Some(error.to_string());
                break;
            }
        }
        let seen = solver.observe(&state);
        energies.push(energy_of(&seen));
        figures.speed = figures.speed.max(seen.maximum_speed / top_speed);
        figures.area = figures.area.max((seen.area / (outline.width * outline.depth) - 1.0).abs());
        pressures.push(seen.probes[0]);
    }
    (figures.energy, figures.rise) = energy_changes(&energies, outline.swing.min(samples), reference);
    (figures.time, figures.steps, figures.lost) = (state.time, state.steps, state.lost);
    figures.noise = noise(&pressures) / (DENSITY * GRAVITY * outline.depth);
    Ok(figures)
}

/// Change of the energy from start to end and its largest rise above an earlier value, both of means over `swing`
/// samples and over `reference`.
fn energy_changes(energies: &[f64], swing: usize, reference: f64) -> (f64, f64) {
    let means = energies.windows(swing).map(|window| window.iter().sum::<f64>() / (swing as f64 * reference));
    let means: Vec<f64> = means.collect();
    let (mut lowest, mut rise) = (f64::MAX, 0.0_f64);
    for &mean in &means {
        lowest = lowest.min(mean);
        rise = rise.max(mean - lowest);
    }
    (means.last().unwrap_or(&f64::NAN) - means.first().unwrap_or(&f64::NAN), rise)
}

/// Root of the mean square difference from the running mean, without the first tenth, where the start settles.
fn noise(values: &[f64]) -> f64 {
    let first = (values.len() / 10).max(WINDOW);
    let last = values.len().saturating_sub(WINDOW);
    let mean = |k: usize| values[k - WINDOW..=k + WINDOW].iter().sum::<f64>() / (2 * WINDOW + 1) as f64;
    let squares: Vec<f64> = (first..last).map(|k| (values[k] - mean(k)).powi(2)).collect();
    if squares.is_empty() { f64::NAN } else { (squares.iter().sum::<f64>() / squares.len() as f64).sqrt() }
}

const SWEEPS: [(&str, &[f64]); 9] = [
    ("courant", &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]),
    ("spacing", &[25.0, 50.0, 100.0, 200.0, 400.0]),
    ("start", &[0.0, 0.1, 0.2, 0.3, 1.0]),
    ("alpha", &[0.0, 0.001, 0.01, 0.03, 0.1, 0.3, 1.0]),
    ("shifting", &[0.0, 0.3, 1.0, 3.0, 10.0]),
    ("repulsion", &[0.0, 5.0, 20.0, 50.0, 100.0]),
    ("spreading", &[0.0, 10.0, 30.0, 100.0, 200.0]),
    ("smoothing", &[0.0, 0.3, 1.0, 3.0, 10.0]),
    ("tolerance", &[1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8]),
];

/// The run of a sweep with one value.
fn member(sweep: &str, value: f64, case: Case) -> Run {
    let mut run = Run::new(format!("{value}"), case);
    match sweep {
        "courant" => run.scheme.courant = value,
        "alpha" => run.scheme.alpha = value,
        "shifting" => run.scheme.shifting = value,
        "repulsion" => run.scheme.repulsion = value,
        "spreading" => run.scheme.spreading = value,
        "smoothing" => run.scheme.smoothing = value,
        "tolerance" => (run.tolerance, run.label) = (value, format!("{value:e}")),
        "start" => {
            (run.start, run.label) = match value {
                0.0 => (Start::Square, "square".to_string()),
                1.0 => (Start::Hexagonal, "hexagonal".to_string()),
                _ => (Start::Jittered(value), format!("jittered {value}")),
            };
        }
        _ => {
            (run.resolution, run.label) = (value, format!("1/{value}"));
            run.share = if value > 200.0 { 0.1 } else { 1.0 };
        }
    }
    run
}

fn row(run: &Run) -> String {
    let outline = run.case.outline();
    let name = outline.name;
    let figures = match execute(run) {
        Ok(figures) => figures,
        Err(error) => return format!("| {} | {name} | refused: {error} | | | | | | | | |", run.label),
    };
    let Figures { time, steps, energy, rise, speed, noise, area, lost, .. } = figures;
    let iterations = figures.iterations as f64 / steps.max(1) as f64;
    eprintln!("{} {name}: {}", run.label, figures.verdict(&outline));
    format!(
        "| {} | {name} | {} | {time:.3} | {steps} | {iterations:.1} | {:+.3} | {:.3} | {speed:.3} | {:.3} | {:.3} | {lost} |",
        run.label,
        figures.verdict(&outline),
        100.0 * energy,
        100.0 * rise,
        100.0 * noise,
        100.0 * area,
    )
}

fn main() {
    let chosen: Vec<String> = std::env::args().skip(1).collect();
    for (sweep, values) in SWEEPS {
        if !chosen.is_empty() && !chosen.iter().any(|name| name == sweep) {
            continue;
        }
        println!("### {sweep}\n");
        println!(
            "| {sweep} | case | verdict | to \\[s\\] | steps | iterations | energy \\[%\\] | rise \\[%\\] | speed | noise \\[%\\] | area \\[%\\] | lost |"
        );
        println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
        let cases = [Case::Rest, Case::Wave, Case::Dam];
        let runs: Vec<Run> = values.iter().flat_map(|&value| cases.map(|case| member(sweep, value, case))).collect();
        let rows: Vec<String> = runs.par_iter().with_max_len(1).map(row).collect();
        println!("{}\n", rows.join("\n"));
    }
}
