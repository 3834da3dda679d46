//! Couples FMI 2.0 co-simulation FMUs with implicit iterations, records what they do and reports on it.

pub mod coupling;
pub mod fmu;
pub mod log;
pub mod participant;
