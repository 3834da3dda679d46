//! Couples FMI 2.0 co-simulation FMUs with implicit iterations, records what they do and reports on it.

pub mod case;
pub mod checkpoint;
pub mod command;
pub mod direct;
pub mod estimate;
pub mod fmu;
pub mod folder;
pub mod in_process;
pub mod job;
pub mod log;
pub mod pack;
mod program;
pub mod progress;
pub mod record;
pub mod run;
pub mod say;
pub mod scene_case;
pub mod stages;

pub mod target;
pub mod warnings;
pub mod watch;
