//! The case file: which FMUs run, with which parameters, how they are connected and coupled, what is recorded.

use scene::{Check, Coupling, Output, Run};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A case, from a file or made from a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// Names for plots, by `fmu.variable`.
    #[serde(default)]
    pub labels: BTreeMap<String, String>,
    /// Figures computed of the result.
    #[serde(default)]
    pub check: Vec<Check>,
}

/// One FMU of a case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fmu {
    /// Name in connections and results.
    pub name: String,
    /// Path of the .fmu, relative to the case file.
    pub path: PathBuf,
    /// Start values by name of the variable.
    #[serde(default)]
    pub parameters: BTreeMap<String, toml::Value>,
}

/// A connection, both ends as `fmu.variable`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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

/// A case file that cannot be used, with the place and the remedy.
#[derive(Debug, Error)]
pub enum Error {
    /// The file cannot be read.
    #[error("cannot read {path}: {reason}")]
    Read {
        /// Path as given.
        path: String,
        /// What the operating system said.
        reason: String,
    },
    /// The text is not a case.
    #[error("{name}, line {line}: {message}{hint}")]
    Parse {
        /// File name.
        name: String,
        /// Line counted from one.
        line: usize,
        /// What the parser said.
        message: String,
        /// The nearest known key, if there is one.
        hint: String,
    },
    /// An override that does not fit the file.
    #[error("override '{text}': {reason}")]
    Override {
        /// The override as given.
        text: String,
        /// Why it cannot be applied.
        reason: String,
    },
    /// A value that is not allowed.
    #[error("{name}: {key} = {got}: expected {expected}")]
    Range {
        /// File name.
        name: String,
        /// Key path of the value.
        key: String,
        /// Value found.
        got: String,
        /// What would be right.
        expected: String,
    },
}

impl Case {
    /// Reads a case file, applies overrides (key path, TOML value) and validates. Paths of FMUs become relative to
    /// the working directory.
    pub fn from_file(path: &Path, overrides: &[(String, String)]) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| Error::Read { path: path.display().to_string(), reason: error.to_string() })?;
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let mut case = Self::from_text(&text, &name, overrides)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        case.fmu.iter_mut().for_each(|fmu| fmu.path = folder.join(&fmu.path));
        Ok(case)
    }

    /// Parses and validates the text of a case called `name`, with overrides (key path, TOML value).
    pub fn from_text(text: &str, name: &str, overrides: &[(String, String)]) -> Result<Self, Error> {
        let mut case: Self = toml::from_str(text).map_err(|error| parse_error(name, text, &error))?;
        if !overrides.is_empty() {
            case = with_overrides(text, name, overrides)?;
        }
        case.validate(name)?;
        Ok(case)
    }

    fn validate(&self, name: &str) -> Result<(), Error> {
        let refuse = |key: &str, got: String, expected: &str| {
            Err(Error::Range { name: name.to_string(), key: key.to_string(), got, expected: expected.to_string() })
        };
        let (step, end) = (self.run.communication_step, self.run.end);
        if !(step.is_finite() && step > 0.0) {
            return refuse("run.communication_step", step.to_string(), "a positive number of seconds");
        }
        if !(end.is_finite() && end > self.start) {
            return refuse("run.end", end.to_string(), &format!("more than the start, {} s", self.start));
        }
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
        let coupling = &self.coupling;
        if !(coupling.relaxation > 0.0 && coupling.relaxation <= 1.0) {
            return refuse("coupling.relaxation", coupling.relaxation.to_string(), "more than 0, at most 1");
        }
        if !(coupling.tolerance_relative >= 0.0 && coupling.tolerance_absolute >= 0.0) {
            let got = format!("{}, {}", coupling.tolerance_relative, coupling.tolerance_absolute);
            return refuse("coupling.tolerance_relative, tolerance_absolute", got, "numbers of at least 0");
        }
        if coupling.predictor_order > 2 {
            return refuse("coupling.predictor_order", coupling.predictor_order.to_string(), "0, 1 or 2");
        }
        self.ends().map(|_| ()).map_err(|(key, got)| Error::Range {
            name: name.to_string(),
            key,
            got,
            expected: "fmu.variable".to_string(),
        })
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

fn parse_error(name: &str, text: &str, error: &toml::de::Error) -> Error {
    let line = error.span().map_or(0, |span| text[..span.start].matches('\n').count() + 1);
    let message = error.message().to_string();
    let hint = hint(&message);
    Error::Parse { name: name.to_string(), line, message, hint }
}

fn hint(message: &str) -> String {
    let known = scene::nearest_key(message).filter(|_| message.contains("unknown"));
    known.map_or_else(String::new, |key| format!("; did you mean `{key}`?"))
}

fn with_overrides(text: &str, name: &str, overrides: &[(String, String)]) -> Result<Case, Error> {
    let table: toml::Table = text.parse().map_err(|error| parse_error(name, text, &error))?;
    let mut root = toml::Value::Table(table);
    for (key, value) in overrides {
        let refuse = |reason: String| Error::Override { text: format!("{key}={value}"), reason };
        let wrapper = format!("value = {value}").parse::<toml::Table>().ok();
        let parsed = wrapper.and_then(|mut wrapper| wrapper.remove("value"));
        let parsed = parsed.unwrap_or_else(|| toml::Value::String(value.clone()));
        place(&mut root, key).map(|slot| *slot = parsed).map_err(refuse)?;
    }
    let all = overrides.iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join("; ");
    root.try_into().map_err(|error: toml::de::Error| {
        let message = error.message();
        Error::Override { text: all, reason: format!("{message}{}", hint(message)) }
    })
}

/// The value at a dotted path; numbers index arrays, missing tables are made. Below `parameters` the rest of the
/// path is one name.
fn place<'a>(value: &'a mut toml::Value, path: &str) -> Result<&'a mut toml::Value, String> {
    let (head, rest) = path.split_once('.').map_or((path, None), |(head, rest)| (head, Some(rest)));
    let next = match value {
        toml::Value::Table(table) => {
            let next = table.entry(head).or_insert_with(|| toml::Value::Table(toml::Table::new()));
            match rest {
                Some(name) if head == "parameters" && next.is_table() => return parameter(next, name),
                _ => next,
            }
        }
        toml::Value::Array(items) => {
            let count = items.len();
            let item = head.parse::<usize>().ok().and_then(|index| items.get_mut(index));
            item.ok_or_else(|| format!("`{head}`: expected an index below {count}"))?
        }
        _ => return Err(format!("`{head}` lies below a value that is no table")),
    };
    match rest {
        Some(rest) => place(next, rest),
        None => Ok(next),
    }
}

fn parameter<'a>(parameters: &'a mut toml::Value, name: &str) -> Result<&'a mut toml::Value, String> {
    let table = parameters.as_table_mut().ok_or("`parameters` is no table")?;
    Ok(table.entry(name).or_insert(toml::Value::Boolean(false)))
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
        assert!(refused("end = 1.0", "end = -1.0").contains("run.end = -1: expected more than the start, 0 s"));
        assert!(refused("= 0.01", "= 0.0").contains("run.communication_step = 0"));
        assert!(refused("name = 'b'", "name = 'a'").contains("a name that is used once"));
        assert!(refused("to = 'b.u.v'", "to = 'b'").contains("connection.0.to = 'b': expected fmu.variable"));
    }

    #[test]
    fn overrides_reach_arrays_and_parameters_with_dots() {
        let set = |key: &str, value: &str| Case::from_text(CASE, "c.toml", &[(key.into(), value.into())]);
        assert_eq!(set("run.end", "0.5").unwrap().run.end, 0.5);
        let case = set("fmu.1.parameters.probe.pressure[2]", "3").unwrap();
        assert_eq!(case.fmu[1].parameters["probe.pressure[2]"], toml::Value::Integer(3));
        let unknown = set("run.ende", "0.5").unwrap_err().to_string();
        assert!(unknown.contains("run.ende=0.5") && unknown.contains("`end`"), "{unknown}");
        assert!(set("fmu.7.name", "x").unwrap_err().to_string().contains("index below 2"));
    }
}
