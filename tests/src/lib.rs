//! A small importer for tests: loads an FMU's library and calls its functions, one by one and in any order.
//!
//! It shares no code with the bundled master, so that a mistake in one does not hide a mistake in the other.

pub mod library;
mod packed;
mod slave;

pub use library::Library;
pub use packed::Packed;
pub use slave::{Slave, State};

use std::path::{Path, PathBuf};

/// The folder with `scenes/`, as resource location: that of an FMU that was packed for no scene.
pub fn resources() -> String {
    format!("file://{}", root().display())
}

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap_or_default()
}

/// Everything in a description: references by variable name, per type.
pub fn references<C: fmi::Component>(model: &fmi::Model<C>, wanted: impl Fn(&fmi::Variable<C>) -> bool) -> Vec<u32> {
    model.variables.iter().filter(|variable| wanted(variable)).map(|variable| variable.reference).collect()
}

/// Real outputs whose value must not differ between two runs; wall-clock times do.
pub fn real_outputs<C: fmi::Component>(model: &fmi::Model<C>) -> Vec<u32> {
    references(model, |variable| {
        variable.causality == fmi::Causality::Output
            && matches!(variable.access, fmi::Access::Real { .. })
            && !variable.name.starts_with("stage.")
    })
}
