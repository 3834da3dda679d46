//! Whether a state that came from outside can be one of this scene. The steps rely on it: lengths that differ or a
//! particle far outside would be found by a panic or by a search grid that fills the memory.

use crate::Error;
use crate::solver::Solver;
use crate::state::State;
use nalgebra::Vector2;

/// Largest number that a state may hold: its square is still a number.
const LARGEST: f64 = 1e100;
/// Internal steps that no run comes to.
const MOST_STEPS: u64 = 1 << 53;

fn refuse<T>(what: impl Into<String>, got: impl ToString, expected: impl Into<String>) -> Result<T, Error> {
    Err(Error::State { what: what.into(), got: got.to_string(), expected: expected.into() })
}

fn length(what: &str, got: usize, expected: usize) -> Result<(), Error> {
    if got == expected { Ok(()) } else { refuse(format!("length of {what}"), got, format!("{expected}")) }
}

fn is_usable(value: &f64) -> bool {
    value.abs() <= LARGEST
}

/// Refuses a list with a number that is none, or beyond all use.
fn usable<'a>(what: &str, mut values: impl Iterator<Item = &'a f64>) -> Result<(), Error> {
    match values.by_ref().enumerate().find(|(_, value)| !is_usable(value)) {
        Some((index, value)) => {
            refuse(format!("{what}[{index}]"), value, format!("a number between -{LARGEST:e} and {LARGEST:e}"))
        }
        None => Ok(()),
    }
}

impl Solver {
    /// Refuses a state that no run of this scene can have come to: lists of other lengths, numbers that are none,
    /// particles outside the domain. States from another process pass here once; those that this solver made need not.
    ///
    /// # Errors
    /// What is wrong, with what was found and what was expected.
    pub fn check_state(&self, state: &State) -> Result<(), Error> {
        self.check_coordinates(state)?;
        self.check_lengths(state)?;
        self.check_particles(state)?;
        self.check_body_inside(&state.motion, state.time)
    }

    fn check_coordinates(&self, state: &State) -> Result<(), Error> {
        let size = self.problem.coordinates();
        let motion = &state.motion;
        for (name, list, expected) in [
            ("motion.position", motion.position.as_slice(), size),
            ("motion.velocity", motion.velocity.as_slice(), size),
            ("motion.acceleration", motion.acceleration.as_slice(), size),
            ("load", &state.load, size),
            ("acceleration", &state.acceleration, size),
            ("added_mass", &state.added_mass, size * size),
        ] {
            length(name, list.len(), expected)?;
            usable(name, list.iter())?;
        }
        usable("wall_force", state.wall_force.iter())?;
        usable("time, time_step", [state.time, state.time_step].iter())?;
        length("sensors", state.sensors.len(), self.problem.geometry.probes.len())?;
        let readings = state.sensors.iter().flat_map(|sensor| [sensor.mean, sensor.largest, sensor.impulse]);
        usable("sensors", readings.collect::<Vec<_>>().iter())?;
        usable("gains", state.gains.terms().iter().flat_map(|gain| gain.numbers()).collect::<Vec<_>>().iter())?;
        self.check_gas(state)?;
        if state.time_step < 0.0 {
            return refuse("time_step", state.time_step, "at least 0 s");
        }
        if state.steps > MOST_STEPS {
            return refuse("steps", state.steps, format!("at most {MOST_STEPS}"));
        }
        Ok(())
    }

    fn check_gas(&self, state: &State) -> Result<(), Error> {
        let pockets = &state.gas.pockets;
        if self.problem.parameters.gas.is_none() {
            length("gas.pockets", pockets.len(), 0)?;
        }
        let numbers = pockets.iter().flat_map(|pocket| [pocket.rate, pocket.push, pocket.centre.x, pocket.centre.y]);
        usable("gas.pockets", numbers.collect::<Vec<_>>().iter())?;
        length("gas.chambers", state.gas.chambers.len(), self.problem.geometry.chambers.len())?;
        length("gas.vents", state.gas.vents.len(), self.problem.geometry.vents.len())?;
        let positive = pockets.iter().flat_map(|pocket| [pocket.volume, pocket.pressure]);
        if let Some(number) = positive.into_iter().find(|number| !(number.is_finite() && *number > 0.0)) {
            return refuse("volume or pressure of a pocket of gas", number, "a number above 0");
        }
        if state.gas.labels.are_sound(pockets.len()) {
            return Ok(());
        }
        refuse("labels of gas", "others than those of its pockets", format!("0 to {}", pockets.len()))
    }

    fn check_lengths(&self, state: &State) -> Result<(), Error> {
        let count = state.positions.len();
        if state.lost.checked_add(count) != Some(self.start.len()) {
            let expected = format!("{} together, as at the start of the scene", self.start.len());
            return refuse("particles and lost particles", format!("{count} and {}", state.lost), expected);
        }
        length("velocities", state.velocities.len(), count)?;
        length("pressures", state.pressures.len(), count)?;
        length("areas", state.areas.len(), count)?;
        length("area_rates", state.area_rates.len(), count)?;
        length("number_densities", state.number_densities.len(), count)?;
        length("surface", state.surface.len(), count)
    }

    fn check_particles(&self, state: &State) -> Result<(), Error> {
        let (low, high) = self.domain;
        let inside = |place: &Vector2<f64>| (low.x..=high.x).contains(&place.x) && (low.y..=high.y).contains(&place.y);
        if let Some(i) = state.positions.iter().position(|place| !inside(place)) {
            let place = state.positions[i];
            let expected = format!("within ({}, {}) to ({}, {}) m", low.x, low.y, high.x, high.y);
            return refuse(format!("place of particle {i}"), format!("({}, {})", place.x, place.y), expected);
        }
        let all: f64 = self.areas.iter().sum();
        if let Some(i) = state.areas.iter().position(|volume| !(*volume > 0.0 && *volume <= all)) {
            return refuse(format!("area of particle {i}"), state.areas[i], format!("above 0, at most {all} m2"));
        }
        usable("velocities, X and Y in turn", state.velocities.iter().flat_map(|velocity| velocity.iter()))?;
        usable("pressures", state.pressures.iter())?;
        let rates = state.area_rates.iter().flat_map(|rate| [&rate.left, &rate.asked, &rate.due]);
        usable("area_rates, left, asked and due in turn", rates)?;
        usable("number_densities", state.number_densities.iter())
    }
}
