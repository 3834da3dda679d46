//! What is read from the water: probes, gauges, regions.

use crate::types::Point;
use keys::keys;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A pressure probe: one point, or `count` points on a line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Probe {
    /// Name, in reports and in the variables of the FMUs.
    pub name: String,
    /// Place of a point probe.
    #[serde(default)]
    pub point: Option<Point>,
    /// First point of a line probe.
    #[serde(default)]
    pub from: Option<Point>,
    /// Last point of a line probe.
    #[serde(default)]
    pub to: Option<Point>,
    /// Number of points of a line probe.
    #[serde(default)]
    pub count: usize,
    /// Name of the body that it moves with, from its place at the start on; missing: it stays where it is.
    #[serde(default)]
    pub on_body: Option<String>,
    /// Length of the patch on a wall over which the pressure is averaged \[m\]; 0 for one spacing. Readings are means over the
    /// interval of records.
    #[serde(default)]
    pub size: f64,
    /// Whether the largest pressure within the interval is recorded beside the mean.
    #[serde(default)]
    pub largest: bool,
    /// Pressure beyond which the impulse since the start is recorded \[Pa\].
    #[serde(default)]
    pub threshold: Option<f64>,
}

impl Probe {
    /// The places of this probe \[m\].
    pub fn points(&self) -> Vec<Point> {
        match (self.point, self.from, self.to) {
            (Some(point), _, _) => vec![point],
            (None, Some(from), Some(to)) => (0..self.count)
                .map(|i| {
                    let share = i as f64 / (self.count.max(2) - 1) as f64;
                    [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])]
                })
                .collect(),
            _ => Vec::new(),
        }
    }

    /// What reports call the places of this probe.
    pub fn labels(&self) -> Vec<String> {
        match self.points().len() {
            1 => vec![self.name.clone()],
            count => (1..=count).map(|i| format!("{}, {i}", self.name)).collect(),
        }
    }
}

keys! {
    /// A vertical line where the water level is reported.
    pub struct Gauge {
        /// Name, in reports and in the variables of the FMUs.
        name: String;
        /// Place \[m\].
        x: f64, in -1e9 to 1e9;
    }
}

/// A region whose water mass is reported.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// Name, in reports and in the variables of the FMUs.
    pub name: String,
    /// Corners in order.
    pub polygon: Vec<Point>,
    /// Name of the body that it moves with, from its place at the start on; missing: it stays where it is.
    #[serde(default)]
    pub on_body: Option<String>,
}
