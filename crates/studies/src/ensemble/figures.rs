//! The figures of every run of an ensemble, and the file that keeps them.

use report::record::{Column, Error, Series, Status, Summary, write_whole};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Name of the file in the folder of an ensemble.
pub const FILE: &str = "ensemble.json";
/// Name of the table of figures beside it.
const TABLE: &str = "figures.csv";

/// An ensemble: its runs, and their figures.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Ensemble {
    /// Name of the scene.
    pub scene: String,
    /// Its title.
    pub title: String,
    /// Values changed in all runs, `key.path=value`.
    pub set: Vec<String>,
    /// The runs.
    pub members: Vec<Member>,
    /// Figures by name.
    pub figures: BTreeMap<String, Figure>,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Member {
    /// Name of its folder.
    pub name: String,
    /// Seed of its start.
    pub seed: u64,
    /// Why it has no figures; none where it reached its end.
    pub error: Option<String>,
}

/// A figure of every run that has it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// Unit.
    pub unit: String,
    /// Values by the names of the runs.
    pub values: BTreeMap<String, f64>,
}

/// Whether the history of a variable tells of impacts: pressures, loads, deflections.
fn tells_of_impacts(column: &Column) -> bool {
    let name = &column.name;
    let pressure = name.contains(".probe.") && name.ends_with(".pressure");
    let of_body = [".load.f", ".load.mz", ".load.q", ".deflection."].iter().any(|part| name.contains(part));
    (pressure || of_body) && column.values.iter().any(|value| *value != 0.0)
}

/// The columns that are wanted; those that tell of impacts where none are named.
pub fn wanted<'a>(series: &'a Series, variables: &'a [String]) -> impl Iterator<Item = &'a Column> {
    series.columns.iter().filter(|column| match variables.is_empty() {
        true => tells_of_impacts(column),
        false => variables.contains(&column.name),
    })
}

/// The value farthest from 0, with its sign.
fn peak(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, |most: f64, value| if value.abs() > most.abs() { value } else { most })
}

/// Integral over time, by the trapezoid between rows.
fn impulse(series: &Series, column: &Column) -> f64 {
    let points: Vec<(f64, f64)> = series.points(column).collect();
    points.windows(2).map(|pair| 0.5 * (pair[1].0 - pair[0].0) * (pair[0].1 + pair[1].1)).sum()
}

impl Ensemble {
    /// Adds a run with its checks, and with peaks and impulses of the wanted variables.
    pub fn add(&mut self, name: &str, seed: u64, summary: &Summary, series: &Series, variables: &[String]) {
        if summary.status != Status::Complete {
            let why = summary.error.clone().unwrap_or_else(|| "it was interrupted".to_string());
            self.add_failure(name, seed, &why);
            return;
        }
        self.title.clone_from(&summary.title);
        self.members.push(Member { name: name.to_string(), seed, error: None });
        for (figure, check) in &summary.checks {
            if let Some(value) = check.value {
                self.figure(figure, &check.unit).insert(name.to_string(), value);
            }
        }
        for column in wanted(series, variables) {
            let (variable, unit) = (&column.name, &column.unit);
            self.figure(&format!("peak of {variable}"), unit).insert(name.to_string(), peak(&column.values));
            if !variable.contains(".deflection.") {
                let value = impulse(series, column);
                self.figure(&format!("impulse of {variable}"), &format!("{unit} s")).insert(name.to_string(), value);
            }
        }
    }

    /// Adds a run that has no figures.
    pub fn add_failure(&mut self, name: &str, seed: u64, error: &str) {
        self.members.push(Member { name: name.to_string(), seed, error: Some(error.to_string()) });
    }

    fn figure(&mut self, name: &str, unit: &str) -> &mut BTreeMap<String, f64> {
        let figure = self.figures.entry(name.to_string()).or_default();
        figure.unit = unit.to_string();
        &mut figure.values
    }

    /// Writes the figures as JSON and as a table.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), Error> {
        let path = folder.join(FILE);
        let text = serde_json::to_string_pretty(self).map_err(|error| Error::new(&path, error))?;
        write_whole(&path, text + "\n")?;
        let path = folder.join(TABLE);
        write_whole(&path, self.table().map_err(|error| Error::new(&path, error))?)
    }

    /// One row for each run, one column for each figure.
    fn table(&self) -> Result<Vec<u8>, csv::Error> {
        let mut table = csv::Writer::from_writer(Vec::new());
        let head = self.figures.iter().map(|(name, figure)| format!("{name} [{}]", figure.unit));
        table.write_record(["member".to_string(), "seed".to_string()].into_iter().chain(head))?;
        for member in &self.members {
            let value = |figure: &Figure| figure.values.get(&member.name).map_or_else(String::new, f64::to_string);
            let values = self.figures.values().map(value);
            table.write_record([member.name.clone(), member.seed.to_string()].into_iter().chain(values))?;
        }
        table.into_inner().map_err(|error| error.into_error().into())
    }

    /// The ensemble in a folder; none where there is none.
    ///
    /// # Errors
    /// A file that is none of an ensemble.
    pub fn read(folder: &Path) -> Result<Option<Self>, Error> {
        let path = folder.join(FILE);
        if !path.is_file() {
            return Ok(None);
        }
        let text = std::fs::read_to_string(&path).map_err(|error| Error::new(&path, error))?;
        serde_json::from_str(&text).map(Some).map_err(|error| Error::new(&path, error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_keep_their_sign_and_impulses_are_integrals() {
        assert_eq!((peak(&[1.0, -3.0, 2.0]), peak(&[])), (-3.0, 0.0));
        let column = Column { name: "fluid.probe.p.pressure".into(), unit: "Pa".into(), values: vec![0.0, 4.0, 2.0] };
        let series = Series { times: vec![0.0, 0.5, 1.5], columns: vec![column.clone()] };
        assert_eq!(impulse(&series, &column), 1.0 + 3.0);
        assert!(tells_of_impacts(&column) && !tells_of_impacts(&Column { values: vec![0.0; 3], ..column }));
    }

    #[test]
    fn an_ensemble_is_read_as_written() {
        let folder = tempfile::tempdir().unwrap();
        let mut ensemble = Ensemble { scene: "s".into(), ..Ensemble::default() };
        ensemble.figure("peak, first", "Pa").insert("member-001".into(), 0.1 + 0.2);
        ensemble.members.push(Member { name: "member-001".into(), seed: 7, error: None });
        ensemble.add_failure("member-002", 8, "no convergence");
        ensemble.write(folder.path()).unwrap();
        assert_eq!(Ensemble::read(folder.path()).unwrap().unwrap(), ensemble);
        let table = std::fs::read_to_string(folder.path().join(TABLE)).unwrap();
        assert_eq!(table, "member,seed,\"peak, first [Pa]\"\nmember-001,7,0.30000000000000004\nmember-002,8,\n");
        assert_eq!(Ensemble::read(&folder.path().join("none")).unwrap(), None);
    }
}
