//! Runs in this process, without FMUs: the same bits, for what is timed, tried or looked at before a run.

use crate::case::Case;
use crate::direct::DirectParticipant;
use crate::log::Log;
use crate::scene_case::STRUCTURE;
use components::{FluidComponent, Interface, StructureComponent};
use coupling::participant::{Error, Participant};

/// The components of a case that was made from a scene with this interface.
pub fn participants(case: &Case, interface: &Interface, log: &Log) -> Result<Vec<Box<dyn Participant>>, Error> {
    let make = |name: &str| -> Result<Box<dyn Participant>, Error> {
        Ok(if name == STRUCTURE {
            Box::new(DirectParticipant::<StructureComponent>::new(name, interface, log)?)
        } else {
            Box::new(DirectParticipant::<FluidComponent>::new(name, interface, log)?)
        })
    };
    case.fmu.iter().map(|fmu| make(&fmu.name)).collect()
}
