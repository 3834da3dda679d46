//! The case file: which FMUs run, with which parameters, how they are connected and coupled, what is recorded.

use crate::watch::Reference;
use scene::{Check, Coupling, Output, Run};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A case, from a file or made from a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// One line that names the case.
    #[serde(default)]
    pub title: String,
    /// Duration and communication step.
    pub run: Run,
    /// Start of the run \[s\].
    #[serde(default)]
    pub start: f64,
    /// What is written and how often.
    #[serde(default)]
    pub output: Output,
    /// The FMUs, in the order in which they step.
    pub fmu: Vec<Fmu>,
    /// Connections from outputs to inputs.
    #[serde(default)]
    pub connection: Vec<Connection>,
    /// How the FMUs are coupled.
    #[serde(default)]
    pub coupling: Coupling,
    /// A real output, `fmu.variable`, that tells the longest useful next step \[s\]: steps are halved to stay below it.
    #[serde(default)]
    pub step_limit: Option<String>,
    /// Outputs left out of the results, `fmu.variable`.
    #[serde(default)]
    pub exclude: Vec<String>,
    /// Outputs of which results have the mean since the last row, `fmu.variable`: each value stands for its step.
    #[serde(default)]
    pub means: Vec<String>,
    /// Outputs of which results have the largest value since the last row, `fmu.variable`.
    #[serde(default)]
    pub maxima: Vec<String>,
    /// Names for plots, by `fmu.variable`.
    #[serde(default)]
    pub labels: BTreeMap<String, String>,
    /// What the run is watched for.
    #[serde(default)]
    pub watch: scene::Watch,
    /// What it is measured by; known of a scene alone.
    #[serde(skip)]
    pub reference: Option<Reference>,
    /// Figures computed of the result.
    #[serde(default)]
    pub check: Vec<Check>,
    /// What the FMUs may take at most.
    #[serde(default)]
    pub limits: Limits,
}

/// What an FMU may take at most: it comes from anywhere.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// Wall-clock time of a step, or of any other call of an FMU, after which the run is ended \[s\]; 0 waits for ever.
    pub step_limit_seconds: f64,
    /// Size of an FMU when it is unpacked \[bytes\].
    pub unpacked_bytes: u64,
    /// Size of an FMU when it is unpacked over its size as a file.
    pub unpacked_ratio: f64,
    /// Files and folders in an FMU.
    pub entries: u64,
}

impl Limits {
    fn validate(&self, name: &str) -> Result<(), Error> {
        let numbers =
            [("step_limit_seconds", self.step_limit_seconds), ("unpacked_ratio", self.unpacked_ratio)].into_iter();
        let mut outside = numbers.filter(|(_, value)| !(0.0..=1e9).contains(value));
        outside.next().map_or(Ok(()), |(key, value)| {
            let (key, expected) = (format!("limits.{key}"), "a number from 0 to 1e9".to_string());
            Err(Error::Range { name: name.to_string(), key, got: value.to_string(), expected })
        })
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self { step_limit_seconds: 3600.0, unpacked_bytes: 1 << 30, unpacked_ratio: 200.0, entries: 10_000 }
    }
}

/// One FMU of a case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fmu {
    /// Name in connections and results.
    pub name: String,
    /// Path of the .fmu, relative to the case file.
    pub path: PathBuf,
    /// Start values by name of the variable.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, serde_json::Value>")]
    pub parameters: BTreeMap<String, toml::Value>,
}

/// A connection, both ends as `fmu.variable`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Connection {
    /// Output.
    pub from: String,
    /// Input.
    pub to: String,
    /// Absolute tolerance of this quantity in its own unit, when it is iterated.
    #[serde(default)]
    pub tolerance_absolute: Option<f64>,
}

/// A case file that cannot be used: as with a scene, for both are made of the same tables.
pub use scene::Error;

impl Case {
    /// What of the outputs is recorded, and how.
    pub fn recorded(&self) -> crate::record::Choice<'_> {
        crate::record::Choice { exclude: &self.exclude, means: &self.means, maxima: &self.maxima }
    }

    /// Reads a case file, applies overrides (key path, TOML value) and validates. Paths of FMUs become relative to
    /// the working directory.
    pub fn from_file(path: &Path, overrides: &[(String, String)]) -> Result<Self, Error> {
        let mut case = Self::from_text(&scene::read_text(path)?, &scene::file_name(path), overrides)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        case.fmu.iter_mut().for_each(|fmu| fmu.path = folder.join(&fmu.path));
        Ok(case)
    }

    /// Parses and validates the text of a case called `name`, with overrides (key path, TOML value).
    pub fn from_text(text: &str, name: &str, overrides: &[(String, String)]) -> Result<Self, Error> {
        let case: Self = scene::from_toml(text, name, overrides)?;
        case.validate(name).map_err(|error| error.located(text, overrides))?;
        Ok(case)
    }

    fn validate(&self, name: &str) -> Result<(), Error> {
        let refuse = |key: &str, got: String, expected: &str| {
            Err(Error::Range { name: name.to_string(), key: key.to_string(), got, expected: expected.to_string() })
        };
        if !self.start.is_finite() {
            return refuse("start", self.start.to_string(), "a finite number of seconds");
        }
        self.run.validate(name, self.start)?;
        self.output.validate(name)?;
        self.coupling.validate(name, self.run.communication_step)?;
        self.watch.validate(name)?;
        scene::validate_checks(&self.check, name)?;
        self.limits.validate(name)?;
        if self.fmu.is_empty() {
            return refuse("fmu", "[]".to_string(), "at least one [[fmu]]");
        }
        for (index, fmu) in self.fmu.iter().enumerate() {
            if fmu.name.is_empty() || fmu.name.contains('.') {
                return refuse(&format!("fmu.{index}.name"), format!("'{}'", fmu.name), "a name without a dot");
            }
            if self.fmu[..index].iter().any(|other| other.name == fmu.name) {
                return refuse(&format!("fmu.{index}.name"), format!("'{}'", fmu.name), "a name that is used once");
            }
        }
        if let Some(limit) = self.step_limit.as_ref().filter(|limit| !limit.contains('.')) {
            return refuse("step_limit", format!("'{limit}'"), "fmu.variable");
        }
        for (index, link) in self.connection.iter().enumerate() {
            let tolerance = link.tolerance_absolute.unwrap_or(0.0);
            if !(tolerance.is_finite() && tolerance >= 0.0) {
                let key = format!("connection.{index}.tolerance_absolute");
                return refuse(&key, tolerance.to_string(), "a finite number of at least 0");
            }
        }
        self.ends().map(|_| ()).map_err(|(key, got)| Error::Range {
            name: name.to_string(),
            key,
            got,
            expected: "fmu.variable".to_string(),
        })
    }

    /// The same without what does not change the numbers up to a given time: a run that goes on may have another one.
    pub fn for_resuming(&self) -> Self {
        let (run, output) = (self.run.for_resuming(), self.output.for_resuming());
        let (title, labels, check, limits) = Default::default();
        Self { run, output, title, labels, check, limits, ..self.clone() }
    }

    /// FMU and variable of the step limit.
    pub fn step_limit(&self) -> Option<(String, String)> {
        let (fmu, variable) = self.step_limit.as_ref()?.split_once('.')?;
        Some((fmu.to_string(), variable.to_string()))
    }

    /// The connections split into FMU and variable; the error holds key and value of one without a dot.
    #[allow(clippy::type_complexity, reason = "a pair of pairs, used once")]
    pub fn ends(&self) -> Result<Vec<((String, String), (String, String))>, (String, String)> {
        let split = |index: usize, key: &str, text: &str| {
            let pair = text.split_once('.').map(|(fmu, variable)| (fmu.to_string(), variable.to_string()));
            pair.ok_or_else(|| (format!("connection.{index}.{key}"), format!("'{text}'")))
        };
        let connections = self.connection.iter().enumerate();
        connections.map(|(i, link)| Ok((split(i, "from", &link.from)?, split(i, "to", &link.to)?))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CASE: &str = "\
[run]
end = 1.0
communication_step = 0.01
[[fmu]]
name = 'a'
path = 'a.fmu'
parameters = { 'load[1]' = 2.0 }
[[fmu]]
name = 'b'
path = 'b.fmu'
[[connection]]
from = 'a.x[1]'
to = 'b.u.v'
[coupling]
method = 'aitken'
";

    #[test]
    fn reads_and_splits_names_at_the_first_dot() {
        let case = Case::from_text(CASE, "c.toml", &[]).unwrap();
        let ends = case.ends().unwrap();
        assert_eq!(ends, [(("a".into(), "x[1]".into()), ("b".into(), "u.v".into()))]);
        assert_eq!(case.fmu[0].parameters["load[1]"], toml::Value::Float(2.0));
    }

    #[test]
    fn unknown_keys_give_line_and_nearest_key() {
        let text = CASE.replace("method = 'aitken'", "method = 'aitken'\ntolerance_relativ = 1e-6");
        let message = Case::from_text(&text, "c.toml", &[]).unwrap_err().to_string();
        assert!(
            message.contains("c.toml, line 16") && message.contains("did you mean `tolerance_relative`"),
            "{message}"
        );
        let method = Case::from_text(&CASE.replace("aitken", "aitkin"), "c.toml", &[]).unwrap_err().to_string();
        assert!(method.contains("line 15") && method.contains("did you mean `aitken`"), "{method}");
    }

    #[test]
    fn values_out_of_range_say_what_is_expected() {
        let refused =
            |from: &str, to: &str| Case::from_text(&CASE.replace(from, to), "c.toml", &[]).unwrap_err().to_string();
        assert!(
            refused("end = 1.0", "end = -1.0").contains("run.end = -1: expected a finite number above the start, 0 s")
        );
        assert!(refused("= 0.01", "= 0.0").contains("run.communication_step = 0"));
        assert!(refused("name = 'b'", "name = 'a'").contains("a name that is used once"));
        let limits = "[limits]\nstep_limit_seconds = -1.0\n[coupling]";
        assert!(refused("[coupling]", limits).contains("limits.step_limit_seconds = -1: expected a number from 0"));
        assert!(refused("to = 'b.u.v'", "to = 'b'").contains("connection.0.to = 'b': expected fmu.variable"));
        let twice = "[[check]]\nname = 'x'\nkind = 'series_maximum'\n[[check]]\nname = 'x'\nkind = 'series_minimum'\n";
        let message = refused("[coupling]", &format!("{twice}[coupling]"));
        assert!(message.contains("check[1].name = 'x'") && message.contains("check[0] has it too"), "{message}");
        let points = "[[check]]\nname = 'x'\nkind = 'curve_rms'\npoints = [[0.0, 1.0], [1.0, 2.0, 3.0]]\n[coupling]";
        let message = refused("[coupling]", points);
        assert!(message.contains("c.toml, line 17: check[0].points[1] has 3 entries, expected 2"), "{message}");
    }

    #[test]
    fn overrides_reach_arrays_and_parameters_with_dots() {
        let set = |key: &str, value: &str| Case::from_text(CASE, "c.toml", &[(key.into(), value.into())]);
        assert_eq!(set("run.end", "0.5").unwrap().run.end, 0.5);
        let case = set("fmu.1.parameters.body.cabin.youngs_modulus", "3").unwrap();
        assert_eq!(case.fmu[1].parameters["body.cabin.youngs_modulus"], toml::Value::Integer(3));
        let unknown = set("run.ende", "0.5").unwrap_err().to_string();
        assert!(unknown.contains("run.ende=0.5") && unknown.contains("`end`"), "{unknown}");
        assert!(set("fmu.7.name", "x").unwrap_err().to_string().contains("index below 2"));
    }
}
