//! The stages of a step one by one, for timing them by themselves.

use super::shifting::Shift;
use super::system::PressureSystem;
use super::unpaid::Unpaid;
use super::{Voronoi, correct};
use crate::linear::ConjugateGradient;
use crate::parameters::VoronoiParameters;
use crate::solver::Solver;
use crate::state::State;
use crate::time_step::TimeStep;

/// A state of the scheme `voronoi` and the stages of the step that begins there.
pub struct Stages<'a> {
    solver: &'a Solver,
    parameters: &'a VoronoiParameters,
    state: State,
    step: TimeStep,
    system: PressureSystem,
    conjugate_gradient: ConjugateGradient<1>,
    solution: Vec<f64>,
    shift: Shift,
    unpaid: Unpaid,
}

impl<'a> Stages<'a> {
    /// Ready for a step of a given length \[s\]; none with another scheme.
    pub fn new(solver: &'a Solver, state: State, length: f64) -> Option<Self> {
        let Voronoi { parameters, .. } = solver.discretisation.as_any().downcast_ref()?;
        let step = TimeStep { length, ordinary: length, share: 1.0 };
        let mut stages = Self {
            solver,
            parameters,
            state,
            step,
            system: PressureSystem::default(),
            conjugate_gradient: ConjugateGradient::default(),
            solution: Vec::new(),
            shift: Shift::default(),
            unpaid: Unpaid::default(),
        };
        stages.cells();
        stages.assembly();
        Some(stages)
    }

    /// Neighbours and cells.
    pub fn cells(&mut self) {
        let Self { solver, state, system, step, .. } = self;
        solver.pool.install(|| system.make_cells(&solver.problem, state, *step));
    }

    /// Predicted velocities, right side, matrix and preconditioner.
    pub fn assembly(&mut self) {
        let Self { solver, parameters, state, system, step, .. } = self;
        solver.pool.install(|| system.assemble(&solver.problem, parameters, state, *step));
    }

    /// The pressure from zero; iterations of the solver.
    pub fn solve(&mut self) -> usize {
        let Self { solver, system, conjugate_gradient, solution, .. } = self;
        solution.clear();
        solution.resize(system.source.len(), 0.0);
        let parameters = &solver.problem.parameters.solve;
        let solve =
            || conjugate_gradient.solve_one(&system.matrix, &system.multigrid, &system.source, solution, parameters);
        solver.pool.install(solve).iterations
    }

    /// Pressure gradient, motion and shifting of the particles.
    pub fn gradient(&mut self) {
        let Self { solver, parameters, state, system, step, shift, unpaid, .. } = self;
        let mut moved = state.clone();
        let problem = &solver.problem;
        solver.pool.install(|| {
            correct::kick(&mut moved, system, problem, step.length);
            shift.plan(&moved.areas, system, problem, parameters, step.length);
            unpaid.take_back(&mut moved, system, problem, &shift.changes, step.length);
            shift.apply(&mut moved, system, problem.spacing, unpaid.taken(), step.length);
            correct::drift(&mut moved.positions, &moved.velocities, 0.5 * step.length);
        });
    }
}
