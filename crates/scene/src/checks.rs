//! The figures that a scene asks of its own result. Field names are the keys of the file.

use crate::{Point, QuickCheck};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A figure that the program computes of its own result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// Name in the summary.
    pub name: String,
    /// What is computed.
    pub kind: CheckKind,
    /// Variable as in results.csv, for example `fluid.probe.P1.pressure`.
    #[serde(default)]
    pub variable: String,
    /// Start of the window \[s\]; absent: the start of the run.
    #[serde(default)]
    pub from: Option<f64>,
    /// End of the window \[s\]; absent: the end of the run.
    #[serde(default)]
    pub to: Option<f64>,
    /// The value is (series + offset) * scale.
    #[serde(default = "one")]
    pub scale: f64,
    /// See `scale`.
    #[serde(default)]
    pub offset: f64,
    /// Factor on time: before a series is compared with `points` or `file`, and on a value that is itself a time.
    #[serde(default = "one")]
    pub time_scale: f64,
    /// Expected value.
    #[serde(default)]
    pub reference: Option<f64>,
    /// Largest error that counts as passed; absent: reported only.
    #[serde(default)]
    pub limit: Option<f64>,
    /// Unit of the value.
    #[serde(default)]
    pub unit: String,
    /// Reference curve as points (time, value).
    #[serde(default)]
    pub points: Vec<Point>,
    /// Reference file, in the folder of the scene or below it.
    #[serde(default)]
    pub file: String,
    /// Whether the reference file may lie outside the folder of the scene.
    #[serde(default)]
    pub file_outside: bool,
    /// Columns of that file: time, then value (for a band: mean, minimum, maximum).
    #[serde(default)]
    pub columns: Vec<String>,
    /// For curves: whether one free shift in time is allowed.
    #[serde(default)]
    pub free_shift: bool,
    /// For curves: whether the distance is divided by the mean magnitude of the reference.
    #[serde(default)]
    pub relative: bool,
    /// Length of a running mean, of the means at both ends of the window, or of the means of the series that are compared
    /// with the points of a curve \[s\].
    #[serde(default)]
    pub window: Option<f64>,
    /// Level whose first crossing is looked for, after offset and scale.
    #[serde(default)]
    pub level: Option<f64>,
    /// Value at rest, from which a change counts, after offset and scale.
    #[serde(default)]
    pub rest: f64,
    /// Depth of the water, for hydrostatic checks \[m\].
    #[serde(default)]
    pub depth: Option<f64>,
    /// Where the reference comes from.
    #[serde(default)]
    pub source: String,
    /// What is otherwise in the quick variant of the scene, which makes no check without it.
    #[serde(default)]
    pub quick: Option<QuickCheck>,
}

/// What a check computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CheckKind {
    /// L2 error of the pressure against rho g (depth - y), over rho g depth: of the last frame, or over all frames in
    /// the window when `from` is given.
    HydrostaticPressure,
    /// Root mean square about the mean.
    SeriesRms,
    /// Largest value.
    SeriesMaximum,
    /// Smallest value.
    SeriesMinimum,
    /// Last minus first value.
    SeriesChange,
    /// Mean value.
    SeriesMean,
    /// Square root of the mean value; of kinetic energy times 2 / mass it is the rms velocity.
    SeriesRootMean,
    /// Standard deviation from the running mean of length `window`: what a filter would have to take away.
    SeriesNoise,
    /// Frequency in hertz from the crossings of the mean.
    SeriesFrequency,
    /// Frequency in hertz of the largest peak of the spectrum within 15 % of `level` Hz.
    SpectralPeak,
    /// Mean period, times `time_scale`, from the crossings of the mean.
    SeriesPeriod,
    /// (last - first) / |first - rest|; with `window`, means of that length stand for first and last value.
    RelativeChange,
    /// Mean slope against time.
    SeriesSlope,
    /// Value at the time `from`.
    ValueAt,
    /// Time of the largest value, times `time_scale`.
    TimeOfMaximum,
    /// Time when the value first exceeds `level`, times `time_scale`.
    ArrivalTime,
    /// Root mean square distance to a reference curve, at its points inside the window; with `window`, of means of that
    /// length about each point.
    CurveRms,
    /// Largest distance to a reference curve, at its points inside the window; with `window`, of means of that length
    /// about each point.
    CurveMaximum,
    /// Largest excess over a band between two curves.
    Band,
}

fn one() -> f64 {
    1.0
}
