//! fmi2
