//! The stages of a step one by one, for timing them by themselves.

use crate::parameters::{AccurateParameters, Scheme};
use crate::prepare::Pace;
use crate::pressure::Outcome;
use crate::solver::{Solver, Workspace};
use crate::state::State;
use crate::voronoi;

/// A state of the scheme `accurate` and the stages of the step that begins there.
pub struct Stages<'a> {
    solver: &'a Solver,
    accurate: &'a AccurateParameters,
    state: State,
    workspace: Workspace,
    pace: Pace,
}

impl<'a> Stages<'a> {
    /// Ready for a step of a given length \[s\]; none with the scheme `paper`.
    pub fn new(solver: &'a Solver, state: State, time_step: f64) -> Option<Self> {
        let Scheme::Accurate(accurate) = &solver.setting.parameters.scheme else { return None };
        let pace = Pace { time_step, ordinary_step: time_step, share: 1.0 };
        let mut stages = Self { solver, accurate, state, workspace: solver.workspace(), pace };
        stages.cells();
        stages.assembly();
        Some(stages)
    }

    /// Neighbours and cells.
    pub fn cells(&mut self) {
        let Self { solver, state, workspace, pace, .. } = self;
        solver.pool.install(|| workspace.accurate.make_cells(&solver.setting, state, *pace));
    }

    /// Predicted velocities, right side, matrix and preconditioner.
    pub fn assembly(&mut self) {
        let Self { solver, accurate, state, workspace, pace } = self;
        solver.pool.install(|| workspace.accurate.assemble(&solver.setting, accurate, state, *pace));
    }

    /// The pressure from zero; iterations of the solver.
    pub fn solve(&mut self) -> usize {
        let Self { solver, workspace, .. } = self;
        let Workspace { accurate: prepared, solve, solution, .. } = workspace;
        solution.clear();
        solution.resize(prepared.source.len(), 0.0);
        let parameters = &solver.setting.parameters.solve;
        let Outcome { iterations, .. } = solver
            .pool
            .install(|| solve.solve_one(&prepared.matrix, &prepared.multigrid, &prepared.source, solution, parameters));
        iterations
    }

    /// Pressure gradient, motion and shifting of the particles.
    pub fn gradient(&mut self) {
        let Self { solver, accurate, state, workspace, pace } = self;
        let Workspace { accurate: prepared, vectors, .. } = workspace;
        let mut moved = state.clone();
        solver.pool.install(|| {
            voronoi::step::kick(&mut moved, prepared, &solver.setting, pace.time_step);
            voronoi::step::shift(&mut moved, prepared, &solver.setting, accurate, pace.time_step, vectors);
            voronoi::step::drift(&mut moved.positions, &moved.velocities, 0.5 * pace.time_step);
        });
    }
}
