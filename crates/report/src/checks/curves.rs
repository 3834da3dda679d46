//! A series against a reference curve or between two curves.

use super::series::{columns, interpolate, mean_about};
use super::{Figure, Points};
use scene::{Check, CheckKind};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Share of its mean by which a band is also widened: the spread of published results is itself uncertain.
const MARGIN: f64 = 0.1;
/// Largest free shift in time, as a share of the length of the reference curve.
const LARGEST_SHIFT: f64 = 0.25;

/// A reference as it is drawn and compared.
#[derive(Debug, Clone, PartialEq)]
pub enum Reference {
    /// Points (time, value).
    Curve(Points),
    /// Points (time, mean, lower, upper).
    Band(Vec<[f64; 4]>),
}

/// The reference of a check; none when it has neither points nor a file.
pub fn reference(check: &Check, folder: &Path) -> Result<Option<Reference>, String> {
    if !check.points.is_empty() {
        in_order(check.points.iter().map(|point| point[0]), "points")?;
        return Ok(Some(Reference::Curve(check.points.iter().map(|point| (point[0], point[1])).collect())));
    }
    if check.file.is_empty() {
        return Ok(None);
    }
    let wanted = if check.kind == CheckKind::Band { 4 } else { 2 };
    if check.columns.len() != wanted {
        return Err(format!("`columns` has {} names, expected {wanted}", check.columns.len()));
    }
    let table = columns(&file(check, folder)?, &check.columns)?;
    in_order(table[0].iter().copied(), &check.file)?;
    let rows = 0..table[0].len();
    Ok(Some(if wanted == 4 {
        Reference::Band(rows.map(|i| [table[0][i], table[1][i], table[2][i], table[3][i]]).collect())
    } else {
        Reference::Curve(rows.map(|i| (table[0][i], table[1][i])).collect())
    }))
}

/// Refuses a reference whose times fall: between them nothing could be looked up.
fn in_order(times: impl Iterator<Item = f64>, name: &str) -> Result<(), String> {
    let mut last = f64::NEG_INFINITY;
    for (row, time) in times.enumerate() {
        if !time.is_finite() || time < last {
            return Err(format!(
                "{name}: time {time} in row {}: expected times that do not fall, here {last}",
                row + 1
            ));
        }
        last = time;
    }
    Ok(())
}

/// The reference file of a check. A scene comes from anywhere: what lies outside its folder is none of its business.
///
/// # Errors
/// A file that is not there, is no file, or lies outside, links followed, without `file_outside`.
pub fn file(check: &Check, folder: &Path) -> Result<PathBuf, String> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let path = folder.join(&check.file);
    let wrong = |reason: String| format!("{}: the reference cannot be read: {reason}", path.display());
    scene::check_file(&path).map_err(&wrong)?;
    let real = |path: &Path| path.canonicalize().map_err(|error| wrong(error.to_string()));
    if !check.file_outside && !real(&path)?.starts_with(real(folder)?) {
        let reason = format!("it lies outside the scene's folder, {}; file_outside = true allows it", folder.display());
        return Err(wrong(reason));
    }
    Ok(path)
}

const NEEDS_CURVE: &str = "needs `points`, or `file` with two `columns`";
const NEEDS_BAND: &str = "needs `file` with four `columns`: time, mean, minimum, maximum";

/// Refuses a check whose reference cannot be read, or that has none though its kind needs one.
pub(super) fn needs(check: &Check, folder: &Path) -> Result<(), String> {
    match (check.kind, reference(check, folder)?) {
        (CheckKind::CurveRms | CheckKind::CurveMaximum, None | Some(Reference::Band(_))) => {
            Err(NEEDS_CURVE.to_string())
        }
        (CheckKind::Band, None | Some(Reference::Curve(_))) => Err(NEEDS_BAND.to_string()),
        _ => Ok(()),
    }
}

/// How the gaps at the points of a reference curve become one number.
type Norm = fn(&[f64]) -> f64;

pub(super) fn root_mean_square(gaps: &[f64]) -> f64 {
    (gaps.iter().map(|gap| gap * gap).sum::<f64>() / gaps.len() as f64).sqrt()
}

pub(super) fn largest(gaps: &[f64]) -> f64 {
    gaps.iter().map(|gap| gap.abs()).fold(0.0, f64::max)
}

/// Distance from the points of the reference curve inside the window, with the best shift in time if one is free.
pub(super) fn distance_to(check: &Check, points: &Points, folder: &Path, norm: Norm) -> Result<Figure, String> {
    let Some(Reference::Curve(mut curve)) = reference(check, folder)? else { return Err(NEEDS_CURVE.to_string()) };
    let bound = |bound: Option<f64>, open: f64| bound.map_or(open, |time| time * check.time_scale);
    let (from, to) = (bound(check.from, f64::NEG_INFINITY), bound(check.to, f64::INFINITY));
    curve.retain(|(time, _)| (from..=to).contains(time));
    let scaled: Points = points.iter().map(|(time, value)| (time * check.time_scale, *value)).collect();
    let window = check.window.unwrap_or(0.0) * check.time_scale;
    let distance = |shift: f64| distance(&scaled, &curve, shift, window, norm);
    let shift = if check.free_shift { best_shift(&curve, &distance) } else { 0.0 };
    let (distance, share) = distance(shift);
    if !distance.is_finite() {
        return Err("the records do not overlap the reference curve".to_string());
    }
    let mut details = BTreeMap::from([("points_compared".to_string(), share * curve.len() as f64)]);
    if check.free_shift {
        details.insert("shift".to_string(), shift);
    }
    let mean = curve.iter().map(|(_, value)| value.abs()).sum::<f64>() / curve.len() as f64;
    let value = if check.relative { distance / mean } else { distance };
    Ok(Figure { value, reference: Some(0.0), details })
}

/// Distance of means over `window`, and the share of the curve's points that lie in the series; infinite below one half.
fn distance(series: &[(f64, f64)], curve: &[(f64, f64)], shift: f64, window: f64, norm: Norm) -> (f64, f64) {
    let gap = |(time, value): &(f64, f64)| mean_about(series, time + shift, window).map(|found| found - value);
    let gaps: Vec<f64> = curve.iter().filter_map(gap).collect();
    let share = gaps.len() as f64 / curve.len().max(1) as f64;
    (if share < 0.5 { f64::INFINITY } else { norm(&gaps) }, share)
}

/// The shift with the smallest distance: a scan, then thrice a finer one around the best.
fn best_shift(curve: &[(f64, f64)], distance: &dyn Fn(f64) -> (f64, f64)) -> f64 {
    let length = curve.last().zip(curve.first()).map_or(0.0, |(last, first)| last.0 - first.0);
    let (mut centre, mut reach) = (0.0, LARGEST_SHIFT * length);
    for _ in 0..4 {
        let candidates = (-50..=50).map(|i| centre + reach * f64::from(i) / 50.0);
        let best = candidates.min_by(|a, b| distance(*a).0.total_cmp(&distance(*b).0));
        centre = best.unwrap_or(centre);
        reach /= 25.0;
    }
    centre
}

/// Largest excess over the band, with the share of records inside it, also when it is widened by a tenth of its mean.
pub(super) fn band(check: &Check, points: &Points, folder: &Path) -> Result<Figure, String> {
    let Some(Reference::Band(band)) = reference(check, folder)? else {
        return Err(NEEDS_BAND.to_string());
    };
    let side = |k: usize| band.iter().map(|row| (row[0], row[k])).collect::<Points>();
    let (middle, lower, upper) = (side(1), side(2), side(3));
    let mut excesses = Vec::new();
    for (time, value) in points {
        let time = time * check.time_scale;
        let at = |curve: &Points| interpolate(curve, time);
        let (Some(middle), Some(lower), Some(upper)) = (at(&middle), at(&lower), at(&upper)) else { continue };
        let excess = (lower - value).max(value - upper).max(0.0);
        excesses.push((excess, excess <= MARGIN * middle.abs()));
    }
    if excesses.is_empty() {
        return Err("the records do not overlap the band in time".to_string());
    }
    let share = |inside: &dyn Fn(&(f64, bool)) -> bool| {
        excesses.iter().filter(|excess| inside(excess)).count() as f64 / excesses.len() as f64
    };
    let details = BTreeMap::from([
        ("share_inside".to_string(), share(&|excess| excess.0 == 0.0)),
        ("share_inside_with_10_percent".to_string(), share(&|excess| excess.1)),
    ]);
    let value = excesses.iter().map(|excess| excess.0).fold(0.0, f64::max);
    Ok(Figure { value, reference: Some(0.0), details })
}
