//! The fluid as an FMI 2.0 co-simulation FMU. Equations and variables are in README.md.

fmi2::export!(components::FluidComponent);
