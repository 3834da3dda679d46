//! The figures that a scene asks of its own result: computed from the recorded series and the last frame.

mod curves;
mod hydrostatic;
mod series;

use crate::record::{CheckResult, Series};
use scene::{Check, CheckKind};
use std::collections::BTreeMap;
use std::path::Path;

pub use curves::{Reference, file, reference};
pub use series::interpolate;

/// What checks are computed from.
pub struct Context<'a> {
    /// Recorded variables.
    pub series: &'a Series,
    /// Folder of field frames.
    pub frames: &'a Path,
    /// Folder that reference files are relative to.
    pub folder: &'a Path,
    /// Density \[kg/m3\] and magnitude of gravity \[m/s2\] of the water, if there is any.
    pub water: Option<(f64, f64)>,
}

/// Density \[kg/m3\] and magnitude of gravity \[m/s2\] of a scene's water, if there is any.
pub fn water(scene: &scene::Scene) -> Option<(f64, f64)> {
    let gravity = scene.gravity[0].hypot(scene.gravity[1]);
    scene.fluid.as_ref().map(|fluid| (fluid.density, gravity))
}

/// Points (time, value) of a check: its variable in its window, offset and scaled; time unscaled.
pub type Points = Vec<(f64, f64)>;

/// A figure before it is compared.
#[derive(Debug, Clone, PartialEq, Default)]
struct Figure {
    value: f64,
    /// Expected value where the check itself brings none.
    reference: Option<f64>,
    details: BTreeMap<String, f64>,
}

impl From<f64> for Figure {
    fn from(value: f64) -> Self {
        Self { value, ..Self::default() }
    }
}

/// Refuses checks whose reference files lie outside the scene's folder, before anything runs; one that is missing or cannot
/// be read costs its own figure only.
///
/// # Errors
/// The first such check.
pub fn refuse_outside(checks: &[Check], folder: &Path) -> Result<(), String> {
    let named = checks.iter().filter(|check| !check.file.is_empty());
    for check in named.filter(|check| std::fs::exists(folder.join(&check.file)).unwrap_or(false)) {
        file(check, folder).map_err(|reason| format!("check '{}': file = '{}': {reason}", check.name, check.file))?;
    }
    Ok(())
}

/// Computes all checks, by name. One that cannot be computed says why.
pub fn evaluate(checks: &[Check], context: &Context) -> BTreeMap<String, CheckResult> {
    checks.iter().map(|check| (check.name.clone(), result(check, figure(check, context)))).collect()
}

/// What cannot be computed whatever a run gives: keys that a kind needs, reference files and their columns.
pub fn warnings(checks: &[Check], folder: &Path) -> Vec<String> {
    let problem = |check: &Check| needs(check).err().or_else(|| curves::needs(check, folder).err());
    let problems = checks.iter().filter_map(|check| Some((check, problem(check)?)));
    problems.map(|(check, problem)| format!("check '{}': {problem}", check.name)).collect()
}

const NEEDS_FROM: &str = "needs `from`, the time of the value";
const NEEDS_WINDOW: &str = "needs `window`, the length of the running mean";
const NEEDS_LEVEL: &str = "needs `level`, the value whose first crossing counts";

/// Refuses a check without a key that its kind needs.
fn needs(check: &Check) -> Result<(), String> {
    let lacks = match check.kind {
        CheckKind::ValueAt if check.from.is_none() => NEEDS_FROM,
        CheckKind::SeriesNoise if check.window.is_none() => NEEDS_WINDOW,
        CheckKind::SpectralPeak if check.level.is_none() => "needs `level`, the expected frequency",
        CheckKind::ArrivalTime if check.level.is_none() => NEEDS_LEVEL,
        CheckKind::HydrostaticPressure if check.depth.is_none() => hydrostatic::NEEDS_DEPTH,
        kind if kind != CheckKind::HydrostaticPressure && check.variable.is_empty() => {
            "needs `variable`, for example 'fluid.front.x'"
        }
        _ => return Ok(()),
    };
    Err(lacks.to_string())
}

fn result(check: &Check, figure: Result<Figure, String>) -> CheckResult {
    let (figure, problem) = match figure {
        Ok(figure) if figure.value.is_finite() => (Some(figure), None),
        Ok(figure) => (None, Some(format!("the value is {}", figure.value))),
        Err(problem) => (None, Some(problem)),
    };
    let value = figure.as_ref().map(|figure| figure.value);
    let reference = check.reference.or(figure.as_ref().and_then(|figure| figure.reference));
    let error = value.zip(reference).map(|(value, reference)| value - reference);
    // A limit without a value is not kept; one without a reference bounds the value itself.
    let deviation = error.or(value);
    let passed = check.limit.map(|limit| deviation.is_some_and(|deviation| deviation.abs() <= limit));
    let details = figure.map(|figure| figure.details).unwrap_or_default();
    let (unit, source) = (check.unit.clone(), check.source.clone());
    CheckResult { value, reference, error, unit, limit: check.limit, passed, details, source, problem }
}

fn figure(check: &Check, context: &Context) -> Result<Figure, String> {
    needs(check)?;
    if check.kind == CheckKind::HydrostaticPressure {
        return hydrostatic::error(check, context).map(Figure::from);
    }
    if check.kind == CheckKind::ValueAt {
        let time = check.from.ok_or(NEEDS_FROM)?;
        let all = Check { from: None, to: None, ..check.clone() };
        return series::value_at(&points(&all, context.series)?, time).map(Figure::from);
    }
    let points = points(check, context.series)?;
    match check.kind {
        CheckKind::HydrostaticPressure | CheckKind::ValueAt => Err("is no figure of a window".to_string()),
        CheckKind::SeriesRms => series::rms(&points).map(Figure::from),
        CheckKind::SeriesMaximum => series::maximum(&points).map(|(_, value)| value.into()),
        CheckKind::SeriesMinimum => series::minimum(&points).map(Figure::from),
        CheckKind::SeriesChange => series::change(&points).map(Figure::from),
        CheckKind::SeriesMean => series::mean(&points).map(Figure::from),
        CheckKind::SeriesRootMean => series::root_mean(&points).map(Figure::from),
        CheckKind::SeriesNoise => {
            let window = check.window.ok_or(NEEDS_WINDOW)?;
            series::noise(&points, window).map(Figure::from)
        }
        CheckKind::SeriesFrequency => series::period(&points).map(|period| period.recip().into()),
        CheckKind::SpectralPeak => series::spectral_peak(&points, check.level.unwrap_or(0.0)).map(Figure::from),
        CheckKind::SeriesPeriod => series::period(&points).map(|period| (period * check.time_scale).into()),
        CheckKind::RelativeChange => {
            series::relative_change(&points, check.rest, check.window, check.to).map(Figure::from)
        }
        CheckKind::SeriesSlope => series::slope(&points, check.time_scale).map(Figure::from),
        CheckKind::TimeOfMaximum => series::maximum(&points).map(|(time, _)| (time * check.time_scale).into()),
        CheckKind::ArrivalTime => {
            let level = check.level.ok_or(NEEDS_LEVEL)?;
            series::arrival(&points, level).map(|time| (time * check.time_scale).into())
        }
        CheckKind::CurveRms => curves::distance_to(check, &points, context.folder, curves::root_mean_square),
        CheckKind::CurveMaximum => curves::distance_to(check, &points, context.folder, curves::largest),
        CheckKind::Band => curves::band(check, &points, context.folder),
    }
}

/// The variable of a check in its window, offset and scaled.
pub fn points(check: &Check, series: &Series) -> Result<Points, String> {
    let column = series.column(&check.variable).ok_or_else(|| {
        let known = series.columns.iter().map(|column| column.name.as_str());
        let hint = scene::nearest(&check.variable, known);
        let hint = hint.map_or_else(String::new, |known| format!("; did you mean '{known}'?"));
        format!("there is no recorded variable '{}'{hint}", check.variable)
    })?;
    let inside = |time: f64| {
        let slack = 1e-9 * time.abs();
        check.from.is_none_or(|from| time >= from - slack) && check.to.is_none_or(|to| time <= to + slack)
    };
    let points: Points = series
        .points(column)
        .filter(|(time, _)| inside(*time))
        .map(|(time, value)| (time, (value + check.offset) * check.scale))
        .collect();
    if points.len() < 2 {
        return Err(format!("the window holds {} records, expected at least 2", points.len()));
    }
    Ok(points)
}

#[cfg(test)]
mod tests;
