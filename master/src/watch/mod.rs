//! A watch over a run: energy that nothing supplied, lost particles, speeds that the energy does not allow.
//!
//! The energy is that of water and bodies together, above the lowest point of the scene, less the work of what acts on
//! them from outside (the shaking of a tank, a constant load, gas). Nothing else supplies any, so it can only fall. Its rise
//! above its least value so far is measured by the energy of the run: the largest kinetic energy so far, the water's
//! potential energy at the start, and the range of that of the bodies. Particles that are lost take a positive energy with
//! them. A case of FMUs says neither what supplies energy nor how far things can fall: there, lost particles are counted.

mod memory;
mod reference;

use crate::scene_case::{FLUID, STRUCTURE};
use coupling::participant::Variable;
use coupling::{Error, System};
pub use memory::Memory;
use memory::Seen;
pub use reference::Reference;

/// An output that is looked at.
struct Sensor {
    participant: usize,
    variable: Variable,
}

impl Sensor {
    fn find(system: &System, participant: Option<&str>, name: &str) -> Option<Self> {
        let mut all = system.descriptions().enumerate();
        all.find_map(|(index, (known, description))| {
            let variable = description.variables.iter().find(|variable| variable.name == name)?;
            let here = participant.is_none_or(|participant| participant == known);
            here.then(|| Self { participant: index, variable: variable.clone() })
        })
    }
}

/// The value of an output; 0 where nobody gives it.
fn read(system: &mut System, sensor: Option<&Sensor>) -> Result<f64, Error> {
    let Some(sensor) = sensor else { return Ok(0.0) };
    let Some(participant) = system.participants().nth(sensor.participant) else { return Ok(0.0) };
    Ok(participant.get(&sensor.variable)?.number().unwrap_or(0.0))
}

/// Kinetic and potential energy.
type Energies = [Option<Sensor>; 2];

/// Looks at a system at communication points.
pub struct Watch {
    limits: scene::Watch,
    reference: Option<Reference>,
    water: Energies,
    body: Energies,
    /// Work of closed-off gas.
    gas: Option<Sensor>,
    speed: Option<Sensor>,
    momentum: [Option<Sensor>; 2],
    /// Particles in the domain, and those that were lost.
    particles: [Option<Sensor>; 2],
    /// Coordinates that a constant load acts on, with the load.
    loaded: Vec<(f64, Sensor)>,
    memory: Memory,
}

impl Watch {
    /// A watch over an initialised system; `reference` is that of the scene that it was made from.
    pub fn new(limits: &scene::Watch, reference: Option<&Reference>, system: &System, memory: Memory) -> Self {
        let energies = |participant| {
            ["energy.kinetic", "energy.potential"].map(|name| Sensor::find(system, Some(participant), name))
        };
        let loads = reference.iter().flat_map(|reference| &reference.constant_loads);
        let loaded = loads.filter_map(|(name, load)| Some((*load, Sensor::find(system, Some(STRUCTURE), name)?)));
        Self {
            limits: limits.clone(),
            reference: reference.cloned(),
            water: energies(FLUID),
            body: energies(STRUCTURE),
            gas: Sensor::find(system, Some(FLUID), "gas.work"),
            speed: Sensor::find(system, Some(FLUID), "maximum_speed"),
            momentum: ["momentum.x", "momentum.y"].map(|name| Sensor::find(system, Some(FLUID), name)),
            particles: ["particles.count", "particles.lost"].map(|name| Sensor::find(system, None, name)),
            loaded: loaded.collect(),
            memory,
        }
    }

    /// What it carries from point to point.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Looks at the system at a communication point; gives what was not found before.
    ///
    /// # Errors
    /// An output that cannot be read.
    pub fn look(&mut self, system: &mut System, time: f64) -> Result<Vec<String>, Error> {
        let seen = self.read(system, time)?;
        Ok(self.memory.take(&seen, &self.limits, self.reference.as_ref()))
    }

    fn read(&self, system: &mut System, time: f64) -> Result<Seen, Error> {
        let mut pair = |sensors: &[Option<Sensor>; 2]| -> Result<[f64; 2], Error> {
            Ok([read(system, sensors[0].as_ref())?, read(system, sensors[1].as_ref())?])
        };
        let [count, lost] = pair(&self.particles)?;
        let (mut water, mut body, momentum) = (pair(&self.water)?, pair(&self.body)?, pair(&self.momentum)?);
        water[1] -= read(system, self.gas.as_ref())?;
        for (load, sensor) in &self.loaded {
            body[1] -= load * read(system, Some(sensor))?;
        }
        Ok(Seen { time, count, lost, water, body, momentum, speed: read(system, self.speed.as_ref())? })
    }

    /// Largest rise of the energy over the energy of the run; none where it is not known.
    pub fn gain(&self) -> Option<f64> {
        self.reference.as_ref().map(|_| self.memory.gain())
    }
}
