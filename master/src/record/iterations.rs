//! iterations.csv: one row per coupling iteration, with residual and tolerance of every iterated quantity.

use super::Error;
use coupling::{IterationRow, Residual, StepReport};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::path::{Path, PathBuf};

/// Counts over a run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct IterationCounts {
    /// Accepted steps.
    pub steps: u64,
    /// Passes of accepted steps.
    pub iterations: u64,
    /// Most passes of one accepted step.
    pub maximum: usize,
    /// Steps given up and repeated smaller.
    pub rollbacks: u64,
    /// Time at the end of each accepted step \[s\], and its passes.
    pub history: Vec<(f64, f64)>,
}

impl IterationCounts {
    /// Takes an accepted step.
    pub fn add(&mut self, report: &StepReport) {
        self.steps += 1;
        self.iterations += report.iterations as u64;
        self.maximum = self.maximum.max(report.iterations);
        self.rollbacks += report.rollbacks as u64;
        self.history.push((report.time + report.duration, report.iterations as f64));
    }

    /// Mean passes per accepted step; 0 without steps.
    pub fn mean(&self) -> f64 {
        if self.steps == 0 { 0.0 } else { self.iterations as f64 / self.steps as f64 }
    }
}

/// Writes the table.
pub struct IterationWriter {
    path: PathBuf,
    file: File,
    failure: Option<Error>,
}

impl IterationWriter {
    /// Opens the table for iterated quantities with these names.
    pub fn create(path: &Path, names: &[String]) -> Result<Self, Error> {
        let file = File::create(path).map_err(|error| Error::new(path, error))?;
        let mut writer = Self { path: path.to_path_buf(), file, failure: None };
        let columns = names.iter().map(|name| format!(",{name} residual,{name} tolerance")).collect::<String>();
        writer.line(&format!("time [s],duration [s],iteration,converged{columns}"));
        writer.check()?;
        Ok(writer)
    }

    /// Goes on with a table after its first `mark` bytes.
    pub fn resume(path: &Path, mark: u64) -> Result<Self, Error> {
        let file = super::reopen(path, mark)?;
        Ok(Self { path: path.to_path_buf(), file, failure: None })
    }

    /// Bytes of the table, all of them on the disk.
    pub fn mark(&self) -> Result<u64, Error> {
        super::settled(&self.file, &self.path)
    }

    /// Writes one row; a failure is kept for [`IterationWriter::check`].
    pub fn write(&mut self, row: &IterationRow) {
        let pair = |residual: &Residual| format!(",{:e},{:e}", residual.residual, residual.tolerance);
        let columns = row.residuals.iter().map(pair).collect::<String>();
        let converged = u8::from(row.converged);
        self.line(&format!("{},{},{},{converged}{columns}", row.time, row.duration, row.iteration));
    }

    fn line(&mut self, line: &str) {
        if let Err(error) = super::write_row(&mut self.file, line) {
            self.failure = Some(Error::new(&self.path, error));
        }
    }

    /// Reports the last failure.
    pub fn check(&mut self) -> Result<(), Error> {
        self.failure.take().map_or(Ok(()), Err)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_rows() {
        let mut counts = IterationCounts::default();
        for (iterations, rollbacks) in [(3, 0), (5, 2)] {
            counts.add(&StepReport { time: 0.0, duration: 0.1, iterations, rollbacks });
        }
        assert_eq!((counts.mean(), counts.maximum, counts.rollbacks), (4.0, 5, 2));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("iterations.csv");
        let mut writer = IterationWriter::create(&path, &["f.q".to_string()]).unwrap();
        let residual = Residual { name: "f.q".into(), value: 2.0, residual: -0.5, tolerance: 1e-6 };
        let row = IterationRow { time: 0.1, duration: 0.05, iteration: 2, converged: false, residuals: vec![residual] };
        writer.write(&row);
        writer.check().unwrap();
        let text = std::fs::read_to_string(path).unwrap();
        let expected =
            "time [s],duration [s],iteration,converged,f.q residual,f.q tolerance\n0.1,0.05,2,0,-5e-1,1e-6\n";
        assert_eq!(text, expected);
    }
}
