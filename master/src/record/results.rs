//! results.csv: one row per recorded time, one column per output, units in the header.

use super::interval::{Interval, Memory};
use super::{Column, Error, Series};
use coupling::System;
use coupling::participant::{Causality, Description, Kind, Variable};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::path::{Path, PathBuf};

/// Prefix of variables that hold wall-clock times: they go to the summary, since they differ from run to run.
pub const STAGE: &str = "stage.";

/// How far a table of results was written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResultMark {
    bytes: u64,
    /// Number of the next row that is due.
    next: u64,
    /// What was gathered for it.
    gathered: Memory,
}

/// The times at which rows are due: `start` + n `interval` \[s\]; with an interval of 0, every communication point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Start of the run \[s\].
    pub start: f64,
    /// Distance of two rows \[s\].
    pub interval: f64,
}

impl Grid {
    /// Number of the last row that is due at `time`, the first being 0.
    fn passed(&self, time: f64) -> u64 {
        let rounding = 4.0 * f64::EPSILON * time.abs().max(self.start.abs());
        ((time - self.start + rounding) / self.interval * (1.0 + 1e-9)).floor().max(0.0) as u64
    }

    /// Whether row `number` is due at `time`.
    fn due(&self, number: u64, time: f64) -> bool {
        self.interval <= 0.0 || self.passed(time) >= number
    }
}

/// Reads the outputs of a system, writes them and keeps them.
pub struct ResultWriter {
    path: PathBuf,
    file: File,
    /// Recorded variables of each participant.
    variables: Vec<Vec<Variable>>,
    /// Start of the run and distance of the rows \[s\].
    grid: Grid,
    next: u64,
    interval: Interval,
    series: Series,
}

/// What of the outputs is recorded, and how.
#[derive(Debug, Clone, Copy)]
pub struct Choice<'a> {
    /// Outputs that are left out.
    pub exclude: &'a [String],
    /// Those of which the mean since the last row is recorded.
    pub means: &'a [String],
    /// Those of which the largest value since the last row is recorded.
    pub maxima: &'a [String],
}

impl ResultWriter {
    /// Opens the table for all numeric outputs of the system but those left out and stage times.
    pub fn create(path: &Path, system: &System, choice: Choice, grid: Grid) -> Result<Self, Error> {
        let file = File::create(path).map_err(|error| Error::new(path, error))?;
        let mut writer = Self::over(file, path, system, choice, grid);
        writer.header()?;
        Ok(writer)
    }

    /// Goes on with a table after its first `mark` bytes, which must be whole rows.
    pub fn resume(path: &Path, system: &System, choice: Choice, grid: Grid, mark: ResultMark) -> Result<Self, Error> {
        let file = super::reopen(path, mark.bytes)?;
        let mut writer = Self::over(file, path, system, choice, grid);
        let written = Series::read(path)?;
        for (row, &time) in written.times.iter().enumerate() {
            let values: Vec<f64> = written.columns.iter().map(|column| column.values[row]).collect();
            writer.series.push(time, &values);
        }
        writer.next = mark.next;
        writer.interval.memory = mark.gathered;
        Ok(writer)
    }

    /// Where the table stands; all rows are on the disk.
    pub fn mark(&self) -> Result<ResultMark, Error> {
        let bytes = super::settled(&self.file, &self.path)?;
        Ok(ResultMark { bytes, next: self.next, gathered: self.interval.memory.clone() })
    }

    fn over(file: File, path: &Path, system: &System, choice: Choice, grid: Grid) -> Self {
        let recorded = recorded(system, choice.exclude);
        let interval = Interval::new(&recorded, choice.means, choice.maxima, grid.start);
        let column = |(name, variable): &(String, Variable)| Column {
            name: name.clone(),
            unit: variable.unit.clone(),
            values: Vec::new(),
        };
        let columns = recorded.iter().flatten().map(column).collect();
        let variables =
            recorded.into_iter().map(|part| part.into_iter().map(|(_, variable)| variable).collect()).collect();
        let series = Series { times: Vec::new(), columns };
        Self { path: path.to_path_buf(), file, variables, grid, next: 0, interval, series }
    }

    fn header(&mut self) -> Result<(), Error> {
        let names: Vec<String> = self.series.columns.iter().map(|column| quoted(&column.header())).collect();
        let line = std::iter::once("time [s]".to_string()).chain(names).collect::<Vec<_>>().join(",");
        self.line(&line)
    }

    fn line(&mut self, line: &str) -> Result<(), Error> {
        super::write_row(&mut self.file, line).map_err(|error| Error::new(&self.path, error))
    }

    /// Takes what stands for the time since the last call into means and largest values.
    pub fn gather(&mut self, system: &mut System, time: f64) -> Result<(), coupling::Error> {
        self.interval.gather(system, time)
    }

    /// Records the outputs at `time` \[s\] when a row is due or `force` is set.
    pub fn record(&mut self, system: &mut System, time: f64, force: bool) -> Result<(), crate::run::Error> {
        if !(self.grid.due(self.next, time) || force) || self.series.times.last() == Some(&time) {
            return Ok(());
        }
        if self.grid.interval > 0.0 {
            self.next = self.grid.passed(time) + 1;
        }
        let mut values = read(system, &self.variables, time)?;
        self.interval.close(&mut values);
        self.series.push(time, &values);
        let line = std::iter::once(&time).chain(&values).map(|value| number(*value)).collect::<Vec<_>>().join(",");
        Ok(self.line(&line)?)
    }

    /// What was recorded so far.
    pub fn series(&self) -> &Series {
        &self.series
    }
}

/// The variables of each participant that a run records, with their names in results.csv: all numeric outputs but stage
/// times and those in `exclude`.
pub fn recorded(system: &System, exclude: &[String]) -> Vec<Vec<(String, Variable)>> {
    let of_one = |(participant, description): (&str, &Description)| {
        let named = description.variables.iter().map(|variable| (format!("{participant}.{}", variable.name), variable));
        let wanted = named.filter(|(name, variable)| {
            variable.causality == Causality::Output
                && variable.kind != Kind::String
                && !variable.name.starts_with(STAGE)
                && !exclude.contains(name)
        });
        wanted.map(|(name, variable)| (name, variable.clone())).collect()
    };
    system.descriptions().map(of_one).collect()
}

/// Shortest text that reads back as the same number.
fn number(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-4..1e9).contains(&size) { format!("{value:e}") } else { format!("{value}") }
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
}

fn read(system: &mut System, variables: &[Vec<Variable>], time: f64) -> Result<Vec<f64>, coupling::Error> {
    let mut values = Vec::new();
    for (participant, chosen) in system.participants().zip(variables) {
        for variable in chosen {
            let value = participant.get(variable)?.number().unwrap_or(f64::NAN);
            values.push(finite(participant.name(), &variable.name, value, time)?);
        }
    }
    Ok(values)
}

/// Refuses a value that no other participant may have taken, but that is no number for a table.
fn finite(participant: &str, variable: &str, value: f64, time: f64) -> Result<f64, coupling::Error> {
    if value.is_finite() {
        return Ok(value);
    }
    let (participant, variable) = (participant.to_string(), variable.to_string());
    Err(coupling::Error::NotFinite { participant, variable, value, time })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn infinity_is_no_number_of_a_table() {
        assert_eq!(finite("gas", "p", 1e300, 0.01).unwrap(), 1e300);
        for (value, word) in [(f64::INFINITY, "inf"), (f64::NAN, "NaN")] {
            let message = finite("gas", "p", value, 0.01).unwrap_err().to_string();
            assert_eq!(message, format!("gas: variable 'p' is {word} at t = 0.01 s"));
        }
    }

    #[test]
    fn rows_are_due_from_the_start_on_wherever_it_lies() {
        for start in [-0.5, 0.0, 0.35, 1e6] {
            let grid = Grid { start, interval: 0.1 };
            let (mut next, mut rows) = (0, Vec::new());
            for step in 0..=20 {
                let time = start + 0.05 * f64::from(step);
                if grid.due(next, time) {
                    next = grid.passed(time) + 1;
                    rows.push(step);
                }
            }
            assert_eq!(rows, [0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20], "from {start}");
        }
    }

    #[test]
    fn numbers_read_back_exactly() {
        for value in [0.0, 0.1 + 0.2, -1.25e-17, 6.02e23, 1234.5, -0.0001, f64::MIN_POSITIVE] {
            assert_eq!(number(value).parse::<f64>().unwrap(), value);
        }
        assert_eq!((number(1e-7).as_str(), number(0.25).as_str()), ("1e-7", "0.25"));
        assert_eq!(quoted("a \"b\", c"), "\"a \"\"b\"\", c\"");
    }
}
