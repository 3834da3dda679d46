//! One step: equilibrium at the start, Newton-Raphson, then commit.

use crate::error::{coordinate_name, load_name};
use crate::scheme::Scheme;
use crate::system::FreeCoordinates;
use crate::{Dynamics, Error, Parameters, Report, State, Workspace};
use kinematics::{Coordinate, Motion, Part};
use nalgebra::{Cholesky, DVector, Dyn, Vector2};

/// Integrates bodies with their members under generalised loads.
///
/// A step from t to t + H solves the equations of [`Dynamics`] for the acceleration a1 of the free coordinates, with
/// the load Q held over the step (Newmark 1959 or Chung and Hulbert 1993, see [`crate::Integrator`]):
///
/// ```text
/// r(a1) = M(xp) ap + f(xp, vp) - Q = 0,                          f = h + grad V + C xd,
/// dr/da1 = (1 - alpha_m) M + (1 - alpha_f) (gamma H df/dv + beta H^2 d(M a + f)/dx),
/// ```
///
/// until `|r| <= tolerance (sum of the sizes of all forces at both ends of the step)`, each entry weighted with
/// 1/sqrt(M_kk). Locked coordinates keep their place and have no row.
#[derive(Debug, Clone)]
pub struct Solver {
    parameters: Parameters,
    dynamics: Dynamics,
    pub(crate) scheme: Scheme,
    pub(crate) free: FreeCoordinates,
}

impl Solver {
    /// Checks the parameters and prepares the constants.
    ///
    /// # Errors
    /// A parameter outside its range, with the range.
    pub fn new(parameters: Parameters) -> Result<Self, Error> {
        parameters.validate()?;
        let dynamics = Dynamics::new(&parameters);
        let free: Vec<_> = parameters.bodies.iter().map(|body| body.free).collect();
        let free = FreeCoordinates::new(&free, dynamics.layout());
        Ok(Self { dynamics, scheme: Scheme::new(parameters.integrator), free, parameters })
    }

    /// The parameters as validated.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The equations of motion: mass matrix, forces, tangents, energies.
    pub fn dynamics(&self) -> &Dynamics {
        &self.dynamics
    }

    /// Scratch for [`Solver::step`]; one per thread of use.
    pub fn workspace(&self) -> Workspace {
        Workspace::new(self.dynamics.size())
    }

    /// At rest at t = 0 in the scene's pose, with the members bent by `initial_modes` (q, m sqrt(kg/m); empty for
    /// straight, or all of them).
    ///
    /// The acceleration is zero: it belongs to a load, and there is none before the first step.
    ///
    /// # Errors
    /// Another number of entries, or one that is not finite.
    pub fn initial_state(&self, initial_modes: &[f64]) -> Result<State, Error> {
        let layout = self.dynamics.layout();
        let is_mode = |coordinate: &Coordinate| matches!(coordinate.part, Part::Mode { .. });
        let (expected, got) = (layout.coordinates().filter(is_mode).count(), initial_modes.len());
        if got != 0 && got != expected {
            return Err(Error::Length { what: "the list of initial modes", expected, got });
        }
        let mut motion = Motion::zeros(layout.size());
        let modes = layout.coordinates().enumerate().filter(|(_, coordinate)| is_mode(coordinate));
        for ((index, _), &value) in modes.zip(initial_modes) {
            motion.position[index] = value;
        }
        let state = State { time: 0.0, motion, algorithmic_acceleration: None };
        self.check_state(&state)?;
        Ok(state)
    }

    /// Advances `state` by `duration` s under the mean `load` of the step: fx, fy in N, mz in N m about o_R, q_i in
    /// N/sqrt(kg/m), each per metre of width, 3 + N entries. Loads on locked coordinates are checked and have no
    /// effect.
    ///
    /// # Errors
    /// A load or state that is not finite or of the wrong length, a step that is not positive, a system that is
    /// singular or does not converge. `state` is then as it was.
    pub fn step(
        &self,
        state: &mut State,
        load: &[f64],
        duration: f64,
        workspace: &mut Workspace,
    ) -> Result<Report, Error> {
        self.check(state, load, duration)?;
        if self.free.count() == 0 {
            state.time += duration;
            return Ok(Report { unknowns: 0, iterations: 0, residual: 0.0 });
        }
        let held = DVector::from_column_slice(load);
        let mass = self.mass_at(&state.motion.position, state.time, workspace)?;
        let start = self.start_acceleration(state, &held, &mass, workspace);
        let report = self.iterate(state, &start, &held, duration, workspace)?;
        self.check_deflection(workspace.end.position.as_slice(), state.time + duration)?;
        let acceleration = self.end_acceleration(state.time, &held, workspace)?;
        // From here on nothing can fail.
        state.algorithmic_acceleration = self.scheme.remembers.then(|| workspace.end.acceleration.clone());
        state.motion.position.copy_from(&workspace.end.position);
        state.motion.velocity.copy_from(&workspace.end.velocity);
        state.motion.acceleration.copy_from(&acceleration);
        state.time += duration;
        Ok(report)
    }

    /// Kinetic energy, J per metre of width.
    pub fn kinetic_energy(&self, state: &State) -> f64 {
        self.dynamics.kinetic_energy(&state.motion.position, &state.motion.velocity)
    }

    /// Weight and bending energy, J per metre of width; zero of the weight as in [`Dynamics::potential_energy`].
    pub fn potential_energy(&self, state: &State) -> f64 {
        self.dynamics.potential_energy(&state.motion.position)
    }

    /// Linear momentum in the global frame, kg m/s per metre of width.
    pub fn linear_momentum(&self, state: &State) -> Vector2<f64> {
        self.dynamics.linear_momentum(&state.motion.position, &state.motion.velocity)
    }

    /// Angular momentum about the place of o_R in the scene, kg m2/s per metre of width.
    pub fn angular_momentum(&self, state: &State) -> f64 {
        self.dynamics.angular_momentum(&state.motion.position, &state.motion.velocity)
    }

    /// Deflection eta, m, along -x of its body, at `station` in [0, l] m of a member; 0 where there is none.
    pub fn deflection(&self, state: &State, body: usize, member: usize, station: f64) -> f64 {
        let Some(beam) = self.parameters.bodies.get(body).and_then(|body| body.members.get(member)) else { return 0.0 };
        let own = self.dynamics.layout().member(body, member);
        beam.modes.deflection(station, &state.motion.position.as_slice()[own])
    }

    /// Factor of the mass matrix of the free coordinates.
    pub(crate) fn mass_at(
        &self,
        position: &DVector<f64>,
        time: f64,
        workspace: &mut Workspace,
    ) -> Result<Cholesky<f64, Dyn>, Error> {
        self.dynamics.mass_matrix(position, &mut workspace.mass);
        let size = self.free.count();
        Cholesky::new(self.free.gather_matrix(&workspace.mass)).ok_or(Error::Singular {
            matrix: "mass matrix",
            size,
            time,
        })
    }

    /// M^-1 (Q - f) on the free coordinates, 0 on the locked ones.
    fn equilibrium(
        &self,
        motion: &Motion,
        load: &DVector<f64>,
        mass: &Cholesky<f64, Dyn>,
        restoring: &mut DVector<f64>,
    ) -> DVector<f64> {
        self.dynamics.restoring_force(&motion.position, &motion.velocity, restoring);
        let mut reduced = self.free.gather(load) - self.free.gather(restoring);
        mass.solve_mut(&mut reduced);
        let mut full = DVector::zeros(load.len());
        self.free.scatter(&reduced, &mut full);
        full
    }

    /// The a0 of the step.
    pub(crate) fn start_acceleration(
        &self,
        state: &State,
        load: &DVector<f64>,
        mass: &Cholesky<f64, Dyn>,
        workspace: &mut Workspace,
    ) -> DVector<f64> {
        match &state.algorithmic_acceleration {
            Some(remembered) if self.scheme.remembers => remembered.clone(),
            _ => self.equilibrium(&state.motion, load, mass, &mut workspace.restoring),
        }
    }

    /// The acceleration that goes out: Newmark's own, or for generalised-alpha (whose own belongs to an earlier time)
    /// that of equilibrium.
    fn end_acceleration(
        &self,
        time: f64,
        load: &DVector<f64>,
        workspace: &mut Workspace,
    ) -> Result<DVector<f64>, Error> {
        if !self.scheme.remembers {
            return Ok(workspace.end.acceleration.clone());
        }
        let position = workspace.end.position.clone();
        let mass = self.mass_at(&position, time, workspace)?;
        Ok(self.equilibrium(&workspace.end, load, &mass, &mut workspace.restoring))
    }

    /// Refuses a beam bent beyond what a linear one bears.
    fn check_deflection(&self, position: &[f64], time: f64) -> Result<(), Error> {
        for (index, body) in self.parameters.bodies.iter().enumerate() {
            for (member, beam) in body.members.iter().enumerate().filter(|(_, beam)| beam.modes.count() > 0) {
                let amplitudes = &position[self.dynamics.layout().member(index, member)];
                beam.check_deflection(amplitudes, time)?;
            }
        }
        Ok(())
    }

    pub(crate) fn check(&self, state: &State, load: &[f64], duration: f64) -> Result<(), Error> {
        let time = state.time;
        let expected = self.dynamics.size();
        if load.len() != expected {
            return Err(Error::Length { what: "the load", expected, got: load.len() });
        }
        if let Some((index, &value)) = load.iter().enumerate().find(|(_, value)| !value.is_finite()) {
            return Err(Error::LoadNotFinite { component: load_name(self.dynamics.layout(), index), value, time });
        }
        if !(duration.is_finite() && duration > 0.0) {
            return Err(Error::Duration { duration, time });
        }
        self.check_state(state)
    }

    /// Refuses a state that is not one of this structure: lists of other lengths, numbers that are none, a locked
    /// coordinate that moves.
    ///
    /// # Errors
    /// What is wrong, with the numbers.
    pub fn check_state(&self, state: &State) -> Result<(), Error> {
        let (motion, time, expected) = (&state.motion, state.time, self.dynamics.size());
        let parts =
            [("position", &motion.position), ("velocity", &motion.velocity), ("acceleration", &motion.acceleration)];
        let memory = state.algorithmic_acceleration.iter().map(|memory| ("algorithmic acceleration", memory));
        for (rate, part) in parts.into_iter().chain(memory) {
            if part.len() != expected {
                return Err(Error::Length { what: "the motion of the state", expected, got: part.len() });
            }
            if let Some((index, &value)) = part.iter().enumerate().find(|(_, value)| !value.is_finite()) {
                return Err(Error::StateNotFinite {
                    coordinate: coordinate_name(self.dynamics.layout(), index),
                    rate,
                    value,
                    time,
                });
            }
        }
        let moving = |&index: &usize| !self.free.contains(index) && motion.velocity[index] != 0.0;
        match (0..expected).find(moving) {
            Some(index) => Err(Error::LockedMoves {
                coordinate: coordinate_name(self.dynamics.layout(), index),
                velocity: motion.velocity[index],
                time,
            }),
            None => Ok(()),
        }
    }
}
