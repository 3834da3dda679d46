//! Runs in this process, without FMUs: the same bits, for what is timed, tried or looked at before a run.

use crate::case::Case;
use crate::direct::DirectParticipant;
use crate::log::Log;
use crate::participant::{Error, Participant};
use crate::run::Outcome;
use crate::scene_case::STRUCTURE;
use components::{FluidComponent, StructureComponent};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// How often a waiting run looks whether it has to end.
const TICK: Duration = Duration::from_millis(50);

/// The components of a case that was made from a scene, for an interface with this number of modes.
pub fn participants(case: &Case, modes: usize, log: &Log) -> Result<Vec<Box<dyn Participant>>, Error> {
    let make = |name: &str| -> Result<Box<dyn Participant>, Error> {
        Ok(if name == STRUCTURE {
            Box::new(DirectParticipant::<StructureComponent>::new(name, modes, log)?)
        } else {
            Box::new(DirectParticipant::<FluidComponent>::new(name, modes, log)?)
        })
    };
    case.fmu.iter().map(|fmu| make(&fmu.name)).collect()
}

/// Runs in a thread of its own, so that a panic is a failed run, and ends it after `cap` seconds or when `interrupted`
/// is raised; says whether the cap ended it.
pub fn watched(
    run: impl FnOnce(&AtomicBool) -> Result<Outcome, String> + Send,
    cap: f64,
    interrupted: &AtomicBool,
) -> (Result<Outcome, String>, bool) {
    let (stop, begin) = (AtomicBool::new(false), Instant::now());
    let (done, waiting) = channel::<()>();
    let mut capped = false;
    let result = std::thread::scope(|scope| {
        let stop = &stop;
        let worker = scope.spawn(move || {
            let _ended = done;
            run(stop)
        });
        while waiting.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
            capped = begin.elapsed().as_secs_f64() > cap;
            if capped || interrupted.load(Ordering::Relaxed) {
                stop.store(true, Ordering::Relaxed);
                break;
            }
        }
        worker.join().unwrap_or_else(|_| Err("the fluid panicked".to_string()))
    });
    (result, capped)
}
