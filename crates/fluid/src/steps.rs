//! One internal step of either scheme, as named stages.

use crate::Error;
use crate::check;
use crate::load::{self, PressureField};
use crate::matrix::NO_ROW;
use crate::order;
use crate::panel_motion::PanelMotion;
use crate::parallel;
use crate::parameters::{AccurateParameters, Scheme};
use crate::particles::{self, Contact};
use crate::prepare::Pace;
use crate::pressure::Outcome;
use crate::report::{Report, Watch};
use crate::solver::{Solver, Workspace};
use crate::state::State;
use crate::voronoi;
use kinematics::Motion;
use nalgebra::{DVector, Vector2};

impl Solver {
    /// One internal step.
    pub(crate) fn internal_step(
        &self,
        state: &mut State,
        pace: Pace,
        workspace: &mut Workspace,
        report: &mut Report,
    ) -> Result<(), Error> {
        match &self.setting.parameters.scheme {
            Scheme::Paper(_) => self.paper_step(state, pace, workspace, report)?,
            Scheme::Accurate(accurate) => self.accurate_step(accurate, state, pace, workspace, report)?,
        }
        particles::slow(state, &self.setting.parameters, pace.time_step);
        report.substeps += 1;
        Ok(())
    }

    /// One internal step: prepare, solve, correct, keep in front of the walls, load.
    fn paper_step(
        &self,
        state: &mut State,
        pace: Pace,
        workspace: &mut Workspace,
        report: &mut Report,
    ) -> Result<(), Error> {
        let setting = &self.setting;
        let time_step = pace.time_step;
        let fresh = workspace.prepared.update(setting, state, pace, &mut report.stages);
        report.reused += usize::from(!fresh);
        let Workspace { prepared, frozen_end, target, .. } = &mut *workspace;
        self.set_wall_acceleration(&mut prepared.panels, &prepared.foretold.position, target, frozen_end, time_step);
        self.solve_pressure(state, workspace, report)?;
        let mut watch = Watch::start();
        particles::correct(state, &workspace.prepared, setting, time_step, &mut workspace.vectors);
        particles::shift(state, &workspace.prepared, setting, time_step, &mut workspace.vectors);
        particles::collide(state, &workspace.prepared, setting, &mut workspace.vectors);
        particles::separate(state, &workspace.prepared, setting, &mut workspace.vectors);
        report.contacts += self.keep_in_front(state, workspace);
        watch.lap(&mut report.stages.gradient);
        self.add_load(state, pace.share, workspace);
        for (value, density) in state.number_densities.iter_mut().zip(&workspace.prepared.densities) {
            *value = density.number_density;
        }
        state.surface.copy_from_slice(&workspace.prepared.surface);
        workspace.before.clone_from(&workspace.prepared.positions);
        self.finish(state, time_step, workspace)?;
        watch.lap(&mut report.stages.other);
        Ok(())
    }

    /// One internal step on Voronoi cells, symmetric in time: drift over half of it, cells, walls and pressure in the
    /// middle, kick over all of it, drift over the other half. Positions and velocities stand at its ends.
    fn accurate_step(
        &self,
        accurate: &AccurateParameters,
        state: &mut State,
        pace: Pace,
        workspace: &mut Workspace,
        report: &mut Report,
    ) -> Result<(), Error> {
        let setting = &self.setting;
        self.solve_on_cells(accurate, state, pace, workspace, report)?;
        let mut watch = Watch::start();
        voronoi::step::add_body_load(state, &workspace.accurate, setting, pace.share);
        let responses = &workspace.accurate.responses;
        for (sum, value) in state.added_mass.iter_mut().zip(&responses.added_mass) {
            *sum += value * pace.share;
        }
        workspace.before.clone_from(&state.positions);
        voronoi::step::kick(state, &workspace.accurate, setting, pace.time_step);
        workspace.accurate.record_rates(&mut state.area_rates, &state.velocities, &workspace.target.velocity);
        voronoi::step::shift(state, &workspace.accurate, setting, accurate, pace.time_step, &mut workspace.vectors);
        voronoi::step::drift(&mut state.positions, &state.velocities, 0.5 * pace.time_step);
        report.contacts += workspace.accurate.contacts + self.keep_in_front(state, workspace);
        watch.lap(&mut report.stages.gradient);
        voronoi::step::record(state, &workspace.accurate, setting.kernel.reference_density);
        self.finish(state, pace.time_step, workspace)?;
        watch.lap(&mut report.stages.other);
        Ok(())
    }

    /// Cells, matrix and pressure of one internal step. What does not depend on the motion asked for is kept for
    /// repeats of the step; where coordinates answer to the load this includes the pressure itself, but for its small
    /// change with the acceleration beyond the expected one.
    fn solve_on_cells(
        &self,
        accurate: &AccurateParameters,
        state: &mut State,
        pace: Pace,
        workspace: &mut Workspace,
        report: &mut Report,
    ) -> Result<(), Error> {
        let setting = &self.setting;
        let fresh = workspace.accurate.update(setting, accurate, state, pace, &mut report.stages);
        report.reused += usize::from(!fresh);
        let mut watch = Watch::start();
        workspace.solution.clone_from(&state.pressures);
        report.responses = setting.geometry.active.len();
        if report.responses > 0 {
            if fresh {
                self.prepare_responses(state, workspace, report)?;
            }
            let Workspace { accurate: prepared, surplus, solution, target, .. } = &mut *workspace;
            mean_acceleration(target, &state.motion, pace.time_step, surplus);
            *surplus -= &state.motion.acceleration;
            solution.clone_from(&prepared.base);
            prepared.responses.add(surplus, solution);
        }
        let accelerations = &mut workspace.accurate.accelerations;
        mean_acceleration(&workspace.target, &state.motion, pace.time_step, accelerations);
        self.solve_for_walls(state.time, workspace, report)?;
        self.level_compartments(accurate, workspace);
        state.pressures.copy_from_slice(&workspace.solution);
        watch.lap(&mut report.stages.solve);
        Ok(())
    }

    /// Unit responses, and the pressure with the body accelerating as at the end of the last step: both depend on the
    /// state alone. `workspace.solution` holds the first guess.
    fn prepare_responses(&self, state: &State, workspace: &mut Workspace, report: &mut Report) -> Result<(), Error> {
        let prepared = &mut workspace.accurate;
        let voronoi::prepare::Prepared { matrix, multigrid, responses, .. } = prepared;
        responses.solve(&self.setting, matrix, multigrid);
        report.iterations += responses.iterations;
        kinematics::copy(&state.motion.acceleration, &mut prepared.accelerations);
        self.solve_for_walls(state.time, workspace, report)?;
        workspace.accurate.base.clone_from(&workspace.solution);
        Ok(())
    }

    /// Gives the pressure of water that touches no free surface its zero.
    fn level_compartments(&self, accurate: &AccurateParameters, workspace: &mut Workspace) {
        let Workspace { accurate: prepared, solution, .. } = workspace;
        if let Some(groups) = prepared.matrix.compartments() {
            let up = -self.setting.parameters.gravity * self.setting.parameters.density;
            groups.level(&prepared.cells, &prepared.positions, &up, accurate.enclosed_pressure, solution);
        }
    }

    /// Solves for the pressure with the accelerations of the walls as set, from the guess in `workspace.solution`.
    fn solve_for_walls(&self, time: f64, workspace: &mut Workspace, report: &mut Report) -> Result<(), Error> {
        let Workspace { accurate: prepared, solve, right_side, solution, .. } = workspace;
        let size = prepared.matrix.size();
        right_side.resize(size, 0.0);
        {
            let prepared = &*prepared;
            parallel::fill(right_side, |i| prepared.source[i] + prepared.wall_source(&self.setting, i));
        }
        let parameters = &self.setting.parameters.solve;
        let outcome = solve.solve_one(&prepared.matrix, &prepared.multigrid, right_side, solution, parameters);
        self.account(&outcome, size, time, report)
    }

    /// Pressure, load and added mass of a state, with the body accelerating as at the end of the last step. Where nothing
    /// answers to the load, a pressure that is not found is left to the first step, which says why.
    pub(crate) fn find_load(
        &self,
        state: &mut State,
        pace: Pace,
        workspace: &mut Workspace,
        report: &mut Report,
    ) -> Result<(), Error> {
        let Scheme::Accurate(accurate) = &self.setting.parameters.scheme else { return Ok(()) };
        let free = !self.setting.geometry.active.is_empty();
        let mut scratch = state.clone();
        scratch.load.fill(0.0);
        let change = &scratch.motion.acceleration * pace.time_step;
        workspace.target.velocity += change;
        match self.solve_on_cells(accurate, &mut scratch, pace, workspace, report) {
            Err(Error::Pressure { .. }) if !free => return Ok(()),
            solved => solved?,
        }
        voronoi::step::add_body_load(&mut scratch, &workspace.accurate, &self.setting, 1.0);
        state.load = scratch.load;
        state.pressures = scratch.pressures;
        state.acceleration.copy_from_slice(state.motion.acceleration.as_slice());
        if free {
            state.added_mass.clone_from(&workspace.accurate.responses.added_mass);
        }
        Ok(())
    }

    /// Enters a solve into the report; an error if it did not reach its tolerance.
    fn account(&self, outcome: &Outcome, unknowns: usize, time: f64, report: &mut Report) -> Result<(), Error> {
        let tolerance = self.setting.parameters.solve.tolerance;
        report.unknowns = unknowns;
        report.iterations += outcome.iterations;
        report.residual = report.residual.max(outcome.residual);
        if outcome.residual > tolerance || !outcome.residual.is_finite() {
            let Outcome { iterations, residual } = *outcome;
            return Err(Error::Pressure { time, iterations, residual, tolerance, unknowns });
        }
        Ok(())
    }

    /// Mean acceleration of every panel over the step with the coordinates at which the walls stand in it: affine in
    /// the velocity asked for.
    fn set_wall_acceleration(
        &self,
        panels: &mut PanelMotion,
        frozen: &DVector<f64>,
        target: &Motion,
        end: &mut Motion,
        time_step: f64,
    ) {
        let Some(body) = &self.setting.geometry.body else { return };
        end.clone_from(target);
        end.position.copy_from(frozen);
        panels.set_end(&self.setting.layout.panels, body, end, time_step);
    }

    fn solve_pressure(&self, state: &mut State, workspace: &mut Workspace, report: &mut Report) -> Result<(), Error> {
        let mut watch = Watch::start();
        let Workspace { prepared, solve, right_side, solution, .. } = workspace;
        let size = prepared.matrix.size();
        right_side.resize(size, 0.0);
        solution.resize(size, 0.0);
        {
            let (setting, prepared) = (&self.setting, &*prepared);
            parallel::fill(right_side, |row| {
                let i = prepared.matrix.particles[row] as usize;
                let images = prepared.around.images.of(i);
                let walls: f64 = images.iter().map(|image| image.weight * prepared.rise(setting, image)).sum();
                prepared.source[row] + walls
            });
            parallel::fill(solution, |row| state.pressures[prepared.matrix.particles[row] as usize]);
        }
        let parameters = &self.setting.parameters.solve;
        let outcome = solve.solve_one(&prepared.matrix, &prepared.multigrid, right_side, solution, parameters);
        self.account(&outcome, size, state.time, report)?;
        let rows = &prepared.matrix.rows;
        parallel::fill(&mut state.pressures, |i| if rows[i] == NO_ROW { 0.0 } else { solution[rows[i] as usize] });
        watch.lap(&mut report.stages.solve);
        Ok(())
    }

    /// Keeps particles in front of the walls where these stand at the end of the step.
    fn keep_in_front(&self, state: &mut State, workspace: &mut Workspace) -> usize {
        let setting = &self.setting;
        let spacing = setting.spacing;
        let (attachments, walls, contact) = match &setting.parameters.scheme {
            Scheme::Paper(paper) => {
                let reach = 0.5 * paper.collision_distance * spacing;
                let contact = Contact { reach, restitution: paper.restitution, ..Contact::inelastic(spacing) };
                (&workspace.prepared.attachments, &workspace.prepared.walls, contact)
            }
            Scheme::Accurate(_) => {
                (&workspace.accurate.attachments, &workspace.accurate.walls, Contact::inelastic(spacing))
            }
        };
        let Some(body) = &setting.geometry.body else {
            let particles = (&mut state.positions[..], &mut state.velocities[..]);
            return particles::stop_at_walls(particles, attachments, walls, &contact, |_, _| Vector2::zeros());
        };
        let at = Some((body, &workspace.target.position));
        workspace.end_walls.place(&setting.layout, at, setting.kernel.radius, spacing);
        workspace.end_panels.set_start(&setting.layout.panels, body, &workspace.target);
        let panels = &workspace.end_panels;
        let particles = (&mut state.positions[..], &mut state.velocities[..]);
        particles::stop_at_walls(particles, attachments, &workspace.end_walls, &contact, |panel, fraction| {
            panels.velocity(panel, fraction)
        })
    }

    /// Adds this internal step's share of the mean load.
    fn add_load(&self, state: &mut State, share: f64, workspace: &Workspace) {
        let Some(body) = &self.setting.geometry.body else { return };
        let prepared = &workspace.prepared;
        let field = PressureField {
            grid: &prepared.around.grid,
            positions: &prepared.positions,
            pressures: &state.pressures,
            parameters: &self.setting.parameters,
            time: prepared.time,
            spacing: self.setting.spacing,
            walls: &prepared.walls,
        };
        let coordinates = &prepared.foretold.position;
        let panels = &self.setting.layout.panels;
        load::add_body_load(&field, body, panels, &prepared.panels, coordinates, share, &mut state.load);
    }

    /// Removes lost particles, stops anything that is not finite, and keeps neighbours near each other in memory.
    fn finish(&self, state: &mut State, time_step: f64, workspace: &mut Workspace) -> Result<(), Error> {
        check::all_finite(state, &workspace.before)?;
        state.lost += particles::remove_lost(state, &self.domain.0, &self.domain.1);
        state.motion.clone_from(&workspace.target);
        state.time_step = time_step;
        state.steps += 1;
        if order::is_due(state.steps) {
            workspace.order.sort(state, self.setting.spacing);
        }
        Ok(())
    }
}

/// Mean accelerations of the coordinates from `start` to `end`.
fn mean_acceleration(end: &Motion, start: &Motion, duration: f64, out: &mut DVector<f64>) {
    kinematics::copy(&end.velocity, out);
    *out -= &start.velocity;
    *out /= duration;
}
