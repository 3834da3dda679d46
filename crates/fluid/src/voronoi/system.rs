//! What an internal step needs that depends on the state alone.

use super::cells::{Cells, Setup};
use super::closed_components::ClosedComponents;
use super::facet::Facet;
use super::gas::GasCells;
use super::source::Asked;
use super::unit_pressures::{MovingFacet, UnitPressures};
use super::{correct, operators};
use crate::linear::{Entry, Matrix, Multigrid};
use crate::motion::extrapolate;
use crate::parallel::{self, Lists};
use crate::parameters::VoronoiParameters;
use crate::problem::Problem;
use crate::report::{StageTimes, Watch};
use crate::state::State;
use crate::time_step::TimeStep;
use crate::walls::PanelMotion;
use crate::walls::stop::{self, Contact, Stop};
use crate::walls::{WallProximity, Walls};
use kinematics::{Motion, SurfacePoint};
use nalgebra::{DVector, Matrix2, Vector2};

/// Everything prepared for one internal step.
#[derive(Debug, Clone)]
pub struct PressureSystem {
    key: Option<(u64, u64)>,
    partial: Vec<u64>,
    /// Time in the middle of the step \[s\].
    pub time: f64,
    /// Extrapolated motion of the body in the middle of the step, where its walls stand during it, as the particles do: the
    /// load on the walls is then that of the middle of the step over which it is held. A load of the start would feed
    /// every oscillation of frequency w with a negative damping of w^2 dt / 4.
    pub middle: Motion,
    /// Walls at those coordinates.
    pub walls: Walls,
    walls_placed: bool,
    panels: PanelMotion,
    /// Particles stopped at walls on the way to the middle of the step.
    pub contacts: usize,
    stops: Vec<Stop>,
    /// Generalised impulse on the coordinates of the bodies of the particles that they stopped \[N s/m, N s, modal\].
    pub stopped: Vec<f64>,
    /// Positions in the middle of the step \[m\].
    pub positions: Vec<Vector2<f64>>,
    /// Velocities at the start of the step, of particles that the walls let pass \[m/s\].
    pub before: Vec<Vector2<f64>>,
    /// Rates of the body's coordinates at the start of the step.
    pub rates: DVector<f64>,
    /// Mean accelerations of the body's coordinates over the step.
    pub accelerations: DVector<f64>,
    /// The same as expected before the step.
    pub expected: DVector<f64>,
    /// What the step puts on the bodies' coordinates whatever their accelerations \[N/m, N m/m, modal\].
    pub steady_load: Vec<f64>,
    /// What it puts on them all in all, and of that what the water does.
    pub body_load: Vec<f64>,
    /// See `body_load`.
    pub water_load: Vec<f64>,
    /// Walls near each particle.
    pub proximities: Lists<WallProximity>,
    /// Cells in the middle of the step.
    pub cells: Cells,
    /// Body force of each particle \[m/s2\].
    pub forces: Vec<Vector2<f64>>,
    /// Predicted velocities u* \[m/s\].
    pub velocities: Vec<Vector2<f64>>,
    /// Predicted velocities before they were smoothed, where they are \[m/s\].
    pub smoothed: Vec<Vector2<f64>>,
    /// Gradients of the predicted velocity \[1/s\].
    pub gradients: Vec<Matrix2<f64>>,
    /// What the areas of cells ask for in this step.
    pub(super) asked: Vec<Asked>,
    /// Cells that changed faster than the step can follow.
    pub jumps: u64,
    /// Right side without the accelerations of moving walls \[Pa\].
    pub source: Vec<f64>,
    /// Matrix of the pressure.
    pub matrix: Matrix,
    /// Preconditioner.
    pub multigrid: Multigrid,
    components: ClosedComponents,
    /// Whether some of the components touch no free surface.
    closed: bool,
    /// Facets on moving walls, and what the water answers to their acceleration.
    pub unit_pressures: UnitPressures,
    /// Pressure with the body accelerating as at the end of the last step \[Pa\].
    pub base: Vec<f64>,
    /// Pockets of gas.
    pub gas: GasCells,
}

impl Default for PressureSystem {
    fn default() -> Self {
        Self {
            key: None,
            partial: Vec::new(),
            time: 0.0,
            middle: Motion::at_rest(0),
            walls: Walls::default(),
            walls_placed: false,
            panels: PanelMotion::default(),
            contacts: 0,
            stops: Vec::new(),
            stopped: Vec::new(),
            positions: Vec::new(),
            before: Vec::new(),
            rates: DVector::zeros(0),
            accelerations: DVector::zeros(0),
            expected: DVector::zeros(0),
            steady_load: Vec::new(),
            body_load: Vec::new(),
            water_load: Vec::new(),
            proximities: Lists::default(),
            cells: Cells::default(),
            forces: Vec::new(),
            velocities: Vec::new(),
            smoothed: Vec::new(),
            gradients: Vec::new(),
            asked: Vec::new(),
            jumps: 0,
            source: Vec::new(),
            matrix: Matrix::default(),
            multigrid: Multigrid::default(),
            components: ClosedComponents::default(),
            closed: false,
            unit_pressures: UnitPressures::default(),
            base: Vec::new(),
            gas: GasCells::default(),
        }
    }
}

impl PressureSystem {
    /// Prepares the step from `state`; returns false when the workspace held it already.
    pub fn update(
        &mut self,
        problem: &Problem,
        voronoi: &VoronoiParameters,
        state: &State,
        step: TimeStep,
        stages: &mut StageTimes,
    ) -> bool {
        let mut watch = Watch::start();
        let fingerprint = state.fingerprint(&mut self.partial);
        let key = Some((fingerprint, step.length.to_bits()));
        if self.key == key {
            return false;
        }
        self.key = None;
        self.find_geometry(problem, state, step);
        watch.lap(&mut stages.neighbours);
        self.assemble(problem, voronoi, state, step);
        self.key = key;
        watch.lap(&mut stages.assembly);
        true
    }

    /// Particles, walls, cells and facets on moving walls in the middle of the step.
    fn find_geometry(&mut self, problem: &Problem, state: &State, step: TimeStep) {
        let half = 0.5 * step.length;
        self.time = state.time + half;
        extrapolate(&state.motion, half, &mut self.middle);
        kinematics::copy(&state.motion.velocity, &mut self.rates);
        self.drift(problem, state, half);
        self.build_cells(problem, state);
        let bodies = &problem.geometry.bodies;
        if !bodies.is_empty() {
            self.unit_pressures.collect(&self.cells, &problem.layout, bodies, &self.middle.position);
        }
        self.find_gas(problem, state, half);
        let gas = (0..self.gas.count()).map(|k| self.gas.work(k));
        self.unit_pressures.collect_gas(self.positions.len(), gas);
    }

    /// The same, whatever is there already.
    pub fn make_cells(&mut self, problem: &Problem, state: &State, step: TimeStep) {
        self.key = None;
        self.find_geometry(problem, state, step);
    }

    /// Predicted velocities, right side, matrix and preconditioner.
    pub fn assemble(&mut self, problem: &Problem, voronoi: &VoronoiParameters, state: &State, step: TimeStep) {
        self.predict(problem, step.length);
        self.smooth(voronoi, &state.areas, step.length);
        self.ask(voronoi, state, step);
        self.build_source(problem, step.length);
        self.tie_gas(problem, step.length);
        self.closed = fill_matrix(&mut self.matrix, &self.cells, &state.areas, &mut self.components, &self.gas);
        let kappa = problem.spacing * problem.spacing;
        let held = self.held_by_gas();
        let row_sums = held.as_ref().unwrap_or(&self.matrix.row_sums);
        self.multigrid.set_up(row_sums, &self.positions, problem.spacing, kappa);
    }

    /// Components of the water, where there is some that touches no free surface.
    pub fn compartments(&self) -> Option<&ClosedComponents> {
        self.closed.then_some(&self.components)
    }

    /// The right side with the accelerations of the walls as set.
    pub fn fill_right_side(&self, problem: &Problem, out: &mut Vec<f64>) {
        out.resize(self.matrix.size(), 0.0);
        let (water, gas) = out.split_at_mut(self.source.len());
        parallel::fill(water, |i| self.source[i] + self.wall_source(problem, i));
        let density = problem.parameters.density;
        gas.iter_mut().enumerate().for_each(|(k, out)| *out = self.gas.right_side(density, k, &self.accelerations));
    }

    /// Brings the particles to the middle of the step, in front of the walls as they stand there.
    fn drift(&mut self, problem: &Problem, state: &State, half: f64) {
        self.place_walls(problem);
        self.positions.clone_from(&state.positions);
        self.before.clone_from(&state.velocities);
        correct::drift(&mut self.positions, &self.before, half);
        self.attach();
        let bodies = &problem.geometry.bodies;
        if !bodies.is_empty() {
            self.panels.set_start(&problem.layout.panels, bodies, &self.middle);
        }
        let panels = &self.panels;
        let moved = (&mut self.positions[..], &mut self.before[..]);
        let contact = Contact::inelastic(problem.spacing);
        let velocity_of = |panel, fraction| panels.velocity(panel, fraction);
        self.contacts =
            stop::stop_at_walls(moved, &self.proximities, &self.walls, &contact, velocity_of, &mut self.stops);
        if self.contacts > 0 {
            self.attach();
        }
        self.give_to_bodies(problem, state);
    }

    /// What stopped particles lose to moving panels is the bodies', by virtual work.
    fn give_to_bodies(&mut self, problem: &Problem, state: &State) {
        self.stopped.resize(problem.coordinates(), 0.0);
        self.stopped.fill(0.0);
        if self.contacts == 0 || self.stopped.is_empty() {
            return;
        }
        let touched = self.stops.iter().enumerate().filter(|(_, stop)| stop.change != Vector2::zeros());
        for (i, stop) in touched {
            let [start, end] = problem.layout.panels[stop.panel as usize];
            let Some(at) = SurfacePoint::between(start, end, stop.fraction) else { continue };
            let impulse = stop.change * (-problem.parameters.density * state.areas[i]);
            problem.geometry.bodies.add_force(at, &self.middle.position, impulse, &mut self.stopped);
        }
    }

    fn attach(&mut self) {
        let (walls, positions) = (&self.walls, &self.positions);
        self.proximities.build(positions.len(), |i, out| walls.attach(&positions[i], out));
    }

    fn build_cells(&mut self, problem: &Problem, state: &State) {
        self.cells.build(&Setup {
            positions: &self.positions,
            areas: &state.areas,
            proximities: &self.proximities,
            walls: &self.walls,
            spacing: problem.spacing,
        });
    }

    /// Cells of a state, for looking at them; what was prepared for a step is lost.
    pub fn cells_of(&mut self, problem: &Problem, state: &State) -> &Cells {
        self.key = None;
        self.middle.clone_from(&state.motion);
        self.place_walls(problem);
        self.positions.clone_from(&state.positions);
        self.attach();
        self.build_cells(problem, state);
        &self.cells
    }

    /// Walls with the body as in the middle of the step.
    fn place_walls(&mut self, problem: &Problem) {
        let bodies = &problem.geometry.bodies;
        if !bodies.is_empty() || !self.walls_placed {
            let at = (!bodies.is_empty()).then_some((bodies, &self.middle.position));
            self.walls.place(&problem.layout, at, 2.0 * Cells::reach(problem.spacing), problem.spacing);
            self.walls_placed = true;
        }
    }

    /// u* = u + f dt, and its gradient.
    fn predict(&mut self, problem: &Problem, time_step: f64) {
        let count = self.positions.len();
        self.forces.resize(count, Vector2::zeros());
        self.velocities.resize(count, Vector2::zeros());
        self.gradients.resize(count, Matrix2::zeros());
        let (positions, before) = (&self.positions, &self.before);
        parallel::fill(&mut self.forces, |i| problem.parameters.body_force(&positions[i], self.time));
        let forces = &self.forces;
        parallel::fill(&mut self.velocities, |i| before[i] + forces[i] * time_step);
        let (cells, velocities) = (&self.cells, &self.velocities);
        parallel::fill(&mut self.gradients, |i| {
            let gradient = operators::velocity_gradient(cells, i, positions, velocities);
            gradient * (STEEPEST / (gradient.norm() * time_step).max(STEEPEST))
        });
    }

    /// Takes out of u* what its neighbours' linear fields do not explain: noise of the wave length of a cell. A linear
    /// field stays as it is, a potential flow nearly, and the momentum exactly.
    fn smooth(&mut self, voronoi: &VoronoiParameters, areas: &[f64], time_step: f64) {
        if voronoi.smoothing == 0.0 {
            return;
        }
        let (cells, velocities, gradients, positions) =
            (&self.cells, &self.velocities, &self.gradients, &self.positions);
        let strength = 0.25 * voronoi.smoothing * time_step;
        let mut smoothed = std::mem::take(&mut self.smoothed);
        smoothed.resize(velocities.len(), Vector2::zeros());
        parallel::fill(&mut smoothed, |i| {
            let mut change = Vector2::zeros();
            for facet in cells.facets.of(i) {
                let j = facet.neighbour as usize;
                let mean = (gradients[i] + gradients[j]) * 0.5;
                let away = positions[j] - positions[i];
                let unexplained = velocities[j] - velocities[i] - mean * away;
                let rate = (strength * mean.norm()).min(0.05);
                // Of two particles the lighter changes more: what one gives the other gets.
                let share = 2.0 * areas[j] / (areas[i] + areas[j]);
                change += unexplained * (facet.weight().min(2.0) * rate * share);
            }
            velocities[i] + change
        });
        std::mem::swap(&mut self.velocities, &mut smoothed);
        self.smoothed = smoothed;
    }

    /// The part of the right side that the accelerations of walls add for particle i \[Pa\].
    pub fn wall_source(&self, problem: &Problem, i: usize) -> f64 {
        let of = |(moving, work): (&MovingFacet, &[f64])| {
            let acceleration = UnitPressures::normal_rate(work, &self.accelerations);
            -problem.parameters.density * moving.wall.facet.length() * acceleration
        };
        self.unit_pressures.of(i).map(of).sum()
    }
}

/// The matrix of the pressure, in which every particle is an unknown and free surfaces are row sums; whether some
/// components of the water touch no free surface.
pub(super) fn fill_matrix(
    matrix: &mut Matrix,
    cells: &Cells,
    areas: &[f64],
    components: &mut ClosedComponents,
    gas: &GasCells,
) -> bool {
    let count = cells.cells.len();
    matrix.set_rows(count + gas.count(), |i, out| {
        if i >= count {
            let tie = |&(column, weight): &(u32, f64)| Entry { column, weight: weight as f32 };
            return out.extend(gas.ties(i - count).iter().map(tie));
        }
        let stiffening = |i: usize| cells.cells[i].stiffening;
        let stiff = |facet: &Facet| 1.0 + stiffening(i).max(stiffening(facet.neighbour as usize));
        let entry = |facet: &Facet| Entry { column: facet.neighbour, weight: (facet.weight() * stiff(facet)) as f32 };
        out.extend(cells.facets.of(i).iter().map(entry));
        let to_gas =
            |(k, share)| Entry { column: (count + k) as u32, weight: (share * cells.cells[i].air_tie()) as f32 };
        out.extend(gas.border(i).map(to_gas));
    });
    matrix.row_sums.resize(count, 0.0);
    parallel::fill(&mut matrix.row_sums, |i| cells.cells[i].air_tie());
    let closed = components.settle(cells, areas, &mut matrix.row_sums);
    if gas.count() > 0 {
        parallel::update(&mut matrix.row_sums, |i, sum| sum - gas.tied(i) * cells.cells[i].air_tie());
        matrix.row_sums.extend(&gas.compliance);
    }
    matrix.close(closed);
    closed
}

/// Largest norm of a velocity gradient times the step. The Courant number keeps flows below; a pair of particles that
/// nearly touch in a splash exceeds it many times, and would throw them out.
const STEEPEST: f64 = 0.3;
