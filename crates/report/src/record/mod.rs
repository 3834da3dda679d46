//! What a run leaves behind: its series, its summary, and what it was made of.

mod parquet;
mod recipe;
mod series;
mod summary;
mod whole;

pub use parquet::write_parquet;
pub use recipe::{RECIPE, Recipe};
pub use series::{Column, Series};
pub use summary::{CheckResult, CouplingSummary, Status, Summary};
pub use whole::write_whole;

use std::path::Path;
use thiserror::Error;

/// A file that cannot be written or read.
#[derive(Debug, Error)]
#[error("{path}: {reason}")]
pub struct Error {
    /// Path of the file.
    pub path: String,
    /// What failed.
    pub reason: String,
}

impl Error {
    /// An error about `path`.
    pub fn new(path: &Path, reason: impl ToString) -> Self {
        Self { path: path.display().to_string(), reason: reason.to_string() }
    }
}
