//! One timed series of internal steps.

use components::conversion;
use fluid::{Solver, StageTimes, State, Workspace};
use scene::Scene;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

/// Share of sqrt(l0 / g) that the first step takes; the solver suggests the next ones.
const FIRST: f64 = 0.05;
/// Steps before the timed ones, so that all memory is there.
const WARM_UP: usize = 10;

/// What a series of steps took.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Timing {
    /// Particles at the end.
    pub particles: usize,
    /// Internal steps.
    pub steps: usize,
    /// Iterations of the pressure solver.
    pub iterations: usize,
    /// Wall-clock time by stage \[s\].
    pub stages: StageTimes,
    /// Wall-clock time of all steps \[s\].
    pub wall: f64,
    /// Growth of the resident memory since before the solver was made \[bytes\], where the system tells it.
    pub memory: Option<f64>,
}

impl Timing {
    /// A time per particle and internal step \[ns\].
    pub fn per_particle_step(&self, seconds: f64) -> f64 {
        1e9 * seconds / (self.particles as f64 * self.steps as f64)
    }

    /// Of two series of the same steps the faster one.
    pub fn faster(self, other: Self) -> Self {
        if other.wall < self.wall { other } else { self }
    }
}

/// A scene that steps without a structure: its body, if it has one, is held.
pub struct Run {
    solver: Solver,
    state: State,
    workspace: Workspace,
    next: f64,
    memory_before: Option<f64>,
}

impl Run {
    /// A scene of the folder `scenes` with changes, ready to step.
    pub fn new(scenes: &Path, name: &str, changes: &[(&str, &str)], threads: usize) -> Result<Self, Box<dyn Error>> {
        let changes: Vec<_> = changes.iter().map(|(key, value)| (key.to_string(), value.to_string())).collect();
        let scene = Scene::from_file_with(&scenes.join(format!("{name}.toml")), &changes)?;
        let memory_before = resident_memory();
        let (mut parameters, geometry) = conversion::fluid(&scene)?;
        parameters.threads = threads;
        let gravity = parameters.gravity.norm().max(1.0);
        let solver = Solver::new(parameters, geometry)?;
        let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
        solver.begin(&mut state, &mut workspace)?;
        let next = FIRST * (solver.effective_spacing() / gravity).sqrt();
        Ok(Self { solver, state, workspace, next, memory_before })
    }

    /// Goes on until a time without timing.
    pub fn flow_to(&mut self, time: f64) -> Result<(), Box<dyn Error>> {
        while self.state.time < time {
            self.step(&mut Timing::default())?;
        }
        Ok(())
    }

    fn step(&mut self, timing: &mut Timing) -> Result<(), Box<dyn Error>> {
        let still = self.solver.at_rest();
        let report = self.solver.step(&mut self.state, &still, self.next, &mut self.workspace)?;
        self.next = report.suggested_step;
        timing.steps += report.substeps;
        timing.iterations += report.iterations;
        timing.stages += report.stages;
        Ok(())
    }

    /// Times steps.
    pub fn time(&mut self, steps: usize) -> Result<Timing, Box<dyn Error>> {
        (0..WARM_UP).try_for_each(|_| self.step(&mut Timing::default()))?;
        let mut timing = Timing::default();
        let start = Instant::now();
        while timing.steps < steps {
            self.step(&mut timing)?;
        }
        timing.wall = start.elapsed().as_secs_f64();
        timing.particles = self.state.positions.len();
        timing.memory = resident_memory().zip(self.memory_before).map(|(now, before)| now - before);
        Ok(timing)
    }

    /// Times the first pass of a communication step, and a second one from the same state to another motion \[s\].
    pub fn time_passes(&mut self, steps: usize) -> Result<[f64; 2], Box<dyn Error>> {
        let mut times = [0.0; 2];
        for _ in 0..steps {
            let mut end = self.solver.at_rest();
            for (pass, time) in times.iter_mut().enumerate() {
                let mut state = self.state.clone();
                end.velocity.iter_mut().skip(kinematics::RIGID).for_each(|rate| *rate = 1e-4 * (1.0 + pass as f64));
                let start = Instant::now();
                self.solver.step(&mut state, &end, self.next, &mut self.workspace)?;
                *time += start.elapsed().as_secs_f64();
            }
            self.step(&mut Timing::default())?;
        }
        Ok(times)
    }
}

/// Memory that the process holds \[bytes\].
fn resident_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    Some(1024.0 * line.split_whitespace().nth(1)?.parse::<f64>().ok()?)
}
