//! summary.json: what ran, how long it took, and the figures of its checks. Scripts rely on these keys.

use super::{Error, write_whole};
use crate::Short;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// It reached its end.
    Complete,
    /// The user ended it.
    Interrupted,
    /// An error ended it.
    Failed,
}

/// Iterations over the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CouplingSummary {
    /// Method as in the case file.
    pub method: String,
    /// Mean passes per accepted step.
    pub mean_iterations: f64,
    /// Most passes of one accepted step.
    pub maximum_iterations: usize,
    /// Steps given up and repeated smaller.
    pub rollbacks: u64,
}

/// One figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CheckResult {
    /// Value found; none when it could not be computed.
    pub value: Option<f64>,
    /// Value expected, if there is one.
    pub reference: Option<f64>,
    /// Value minus reference.
    pub error: Option<f64>,
    /// Unit of the three.
    pub unit: String,
    /// Largest size of the error, or of the value where nothing is expected.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub limit: Option<f64>,
    /// Whether the error is within the limit; none without a limit.
    pub passed: Option<bool>,
    /// Further figures by name, for example the share of a curve inside a band.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub details: BTreeMap<String, f64>,
    /// Where the reference comes from.
    #[serde(skip_serializing_if = "String::is_empty", default)]
    pub source: String,
    /// Why there is no value.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub problem: Option<String>,
}

/// The whole summary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Name of the scene or case.
    pub scene: String,
    /// Its title.
    pub title: String,
    /// How the run ended.
    pub status: Status,
    /// The error of a failed run.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub error: Option<String>,
    /// Discretisation of the fluid, if a scene names one.
    pub scheme: Option<String>,
    /// Particle spacing \[m\], if a scene names one.
    pub spacing: Option<f64>,
    /// Particles at the end, if a participant counts them.
    pub particles: Option<f64>,
    /// Accepted steps.
    pub steps: u64,
    /// Cells of the fluid that changed faster than a step can follow, per accepted step, if a participant counts them.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub jumps_per_step: Option<f64>,
    /// Simulated time \[s\].
    pub simulated_seconds: f64,
    /// Wall-clock time of the run \[s\].
    pub wall_seconds: f64,
    /// Wall-clock time by stage \[s\].
    pub stages: BTreeMap<String, f64>,
    /// Iterations.
    pub coupling: CouplingSummary,
    /// Largest gain of energy that nothing supplied, over the energy of the run; none where it is not known.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub energy_gain: Option<f64>,
    /// Warnings of the run.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// Limits that were missed: what the watch found, and the figures outside their limits.
    #[serde(default)]
    pub missed: Vec<String>,
    /// Figures by name.
    pub checks: BTreeMap<String, CheckResult>,
    /// Version of the program.
    pub version: String,
}

impl CheckResult {
    /// Why a figure called `name` is outside its limit; none where it is within, or has none.
    pub fn missed(&self, name: &str) -> Option<String> {
        if self.passed != Some(false) {
            return None;
        }
        let (unit, size) = (&self.unit, self.error.or(self.value));
        let limit = self.limit.map_or_else(String::new, |limit| format!(", expected at most {} {unit}", Short(limit)));
        Some(match (size, self.reference) {
            (Some(size), Some(reference)) => {
                format!("check '{name}': {} {unit} off {} {unit}{limit}", Short(size), Short(reference))
            }
            (Some(size), None) => format!("check '{name}': {} {unit}{limit}", Short(size)),
            (None, _) => format!("check '{name}': {}", self.problem.as_deref().unwrap_or("there is no value")),
        })
    }
}

impl Summary {
    /// Reads a summary that was written.
    ///
    /// # Errors
    /// A file that cannot be read or is no summary.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(|error| Error::new(path, error))?;
        serde_json::from_str(&text).map_err(|error| Error::new(path, error))
    }

    /// Writes the summary as JSON.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let text = serde_json::to_string_pretty(self).map_err(|error| Error::new(path, error))?;
        write_whole(path, text + "\n")
    }
}
