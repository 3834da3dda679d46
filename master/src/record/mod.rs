//! What a run leaves behind: tables of results and iterations, and a summary.

mod iterations;
mod parquet;
mod recipe;
mod results;
mod series;
mod summary;
mod whole;

pub use iterations::{IterationCounts, IterationWriter};
pub use parquet::write_parquet;
pub use recipe::{RECIPE, Recipe};
pub use results::{Grid, ResultMark, ResultWriter, STAGE};
pub use series::{Column, Series};
pub use summary::{CheckResult, CouplingSummary, Status, Summary};
pub use whole::write_whole;

use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom};
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

/// Opens a table for what follows its first `bytes`; the rest is cut off.
fn reopen(path: &Path, bytes: u64) -> Result<File, Error> {
    let wrong = |error: std::io::Error| Error::new(path, error);
    let mut file = OpenOptions::new().read(true).write(true).open(path).map_err(wrong)?;
    let got = length(&file, path)?;
    if got < bytes {
        return Err(Error::new(path, format!("{got} bytes, expected at least the {bytes} of the checkpoint")));
    }
    file.set_len(bytes).and_then(|()| file.seek(SeekFrom::Start(bytes))).map_err(wrong)?;
    Ok(file)
}

fn length(file: &File, path: &Path) -> Result<u64, Error> {
    file.metadata().map(|data| data.len()).map_err(|error| Error::new(path, error))
}
