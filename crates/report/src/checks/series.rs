//! Figures of one time series. All take points (time, value) in the order of time, at least two of them.

use crate::record;

fn values(points: &[(f64, f64)]) -> impl Iterator<Item = f64> + '_ {
    points.iter().map(|(_, value)| *value)
}

/// Mean of the records.
pub(super) fn mean(points: &[(f64, f64)]) -> Result<f64, String> {
    Ok(values(points).sum::<f64>() / points.len() as f64)
}

/// Root mean square about the mean.
pub(super) fn rms(points: &[(f64, f64)]) -> Result<f64, String> {
    let mean = mean(points)?;
    let square: f64 = values(points).map(|value| (value - mean) * (value - mean)).sum();
    Ok((square / points.len() as f64).sqrt())
}

/// Time and value of the largest record.
pub(super) fn maximum(points: &[(f64, f64)]) -> Result<(f64, f64), String> {
    let largest = points.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    largest.copied().ok_or_else(|| "there are no records".to_string())
}

/// Smallest value.
pub(super) fn minimum(points: &[(f64, f64)]) -> Result<f64, String> {
    values(points).min_by(f64::total_cmp).ok_or_else(|| "there are no records".to_string())
}

/// Last minus first value.
pub(super) fn change(points: &[(f64, f64)]) -> Result<f64, String> {
    match (points.first(), points.last()) {
        (Some(first), Some(last)) => Ok(last.1 - first.1),
        _ => Err("there are no records".to_string()),
    }
}

/// Share of the rms about the mean by which a series must have fallen below its mean before the next upward crossing
/// counts: a jagged signal crosses its mean more than once.
const HYSTERESIS: f64 = 0.5;

/// Mean period \[s\] from the upward crossings of the mean, each found by linear interpolation.
pub(super) fn period(points: &[(f64, f64)]) -> Result<f64, String> {
    let (mean, low) = (mean(points)?, mean(points)? - HYSTERESIS * rms(points)?);
    let mut armed = false;
    let mut times = Vec::new();
    for pair in points.windows(2) {
        let ((t0, v0), (t1, v1)) = (pair[0], pair[1]);
        armed |= v0 < low;
        if armed && v0 < mean && v1 >= mean {
            times.push(t0 + (t1 - t0) * (mean - v0) / (v1 - v0));
            armed = false;
        }
    }
    match (times.first(), times.last()) {
        (Some(first), Some(last)) if times.len() > 1 => Ok((last - first) / (times.len() - 1) as f64),
        _ => Err(format!("{} upward crossings of the mean, expected at least 2", times.len())),
    }
}

/// Half-width of the search for a spectral peak, as a share of the expected frequency.
const SEARCHED: f64 = 0.15;
/// Frequencies tried in it.
const TRIED: usize = 400;

/// Frequency of the largest peak of the spectrum within 15 % of `expected` \[Hz\], from the records weighted by Hann's
/// window; between the frequencies tried by a parabola.
pub(super) fn spectral_peak(points: &[(f64, f64)], expected: f64) -> Result<f64, String> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Err("there are no records".into()) };
    let (mean, length) = (mean(points)?, last.0 - first.0);
    if expected <= 0.0 || length * expected < 10.0 {
        return Err(format!("{length} s of records at an expected {expected} Hz, expected at least 10 periods"));
    }
    let power = |frequency: f64| {
        let (mut real, mut imaginary) = (0.0, 0.0);
        for (time, value) in points {
            let weight = 1.0 - (std::f64::consts::TAU * (time - first.0) / length).cos();
            let (sin, cos) = (std::f64::consts::TAU * frequency * time).sin_cos();
            real += weight * (value - mean) * cos;
            imaginary += weight * (value - mean) * sin;
        }
        real * real + imaginary * imaginary
    };
    let step = 2.0 * SEARCHED * expected / TRIED as f64;
    let frequency = |k: usize| (1.0 - SEARCHED) * expected + k as f64 * step;
    let powers: Vec<f64> = (0..=TRIED).map(|k| power(frequency(k))).collect();
    let peak = (1..TRIED).filter(|&k| powers[k] >= powers[k - 1] && powers[k] > powers[k + 1]);
    let peak = peak.max_by(|&a, &b| powers[a].total_cmp(&powers[b]));
    let k = peak.ok_or_else(|| format!("no peak of the spectrum within 15 % of {expected} Hz"))?;
    let curvature = powers[k - 1] - 2.0 * powers[k] + powers[k + 1];
    Ok(frequency(k) + 0.5 * step * (powers[k - 1] - powers[k + 1]) / curvature)
}

/// Square root of the mean value.
pub(super) fn root_mean(points: &[(f64, f64)]) -> Result<f64, String> {
    match mean(points)? {
        value if value >= 0.0 => Ok(value.sqrt()),
        value => Err(format!("the mean is {value}, expected at least 0 under a square root")),
    }
}

/// Root mean square distance from the running mean over `window` \[s\], at the records with half a window on both
/// sides.
pub(super) fn noise(points: &[(f64, f64)], window: f64) -> Result<f64, String> {
    let (half, slack) = (0.5 * window, 1e-9 * window);
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Err("there are no records".into()) };
    let (mut begin, mut end) = (0, 0);
    let (mut square, mut count) = (0.0, 0);
    for (time, value) in points.iter().filter(|(time, _)| time - half >= first.0 - slack) {
        if time + half > last.0 + slack {
            break;
        }
        begin += points[begin..].partition_point(|(t, _)| *t < time - half - slack);
        end += points[end..].partition_point(|(t, _)| *t <= time + half + slack);
        square += (value - mean(&points[begin..end])?).powi(2);
        count += 1;
    }
    match count {
        0 => Err(format!("{} s of records, expected more than the window of {window} s", last.0 - first.0)),
        _ => Ok((square / f64::from(count)).sqrt()),
    }
}

/// (last - first) / |first - rest|; means over the first and the last `window` \[s\] if one is given. The records must
/// reach `to` \[s\]: a run that ended early has lost less.
pub(super) fn relative_change(
    points: &[(f64, f64)],
    rest: f64,
    window: Option<f64>,
    to: Option<f64>,
) -> Result<f64, String> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Err("there are no records".into()) };
    let gap = (last.0 - first.0) / (points.len() - 1).max(1) as f64;
    if let Some(to) = to.filter(|to| last.0 + gap < to * (1.0 - 1e-9)) {
        return Err(format!("the records end at {} s, expected {to} s", last.0));
    }
    let window = window.unwrap_or(0.0) * (1.0 + 1e-9);
    let begin = points.partition_point(|(time, _)| *time <= first.0 + window);
    let end = points.partition_point(|(time, _)| *time < last.0 - window);
    let (start, end) = (mean(&points[..begin])?, mean(&points[end..])?);
    match (start - rest).abs() {
        0.0 => Err(format!("the first value equals the value at rest, {rest}")),
        size => Ok((end - start) / size),
    }
}

/// Time \[s\] when the value first exceeds a level, linear between records.
pub(super) fn arrival(points: &[(f64, f64)], level: f64) -> Result<f64, String> {
    let after = points.iter().position(|(_, value)| *value > level);
    let after = after.ok_or_else(|| format!("no value exceeds {level}"))?;
    let (t1, v1) = points[after];
    let Some((t0, v0)) = after.checked_sub(1).map(|before| points[before]) else { return Ok(t1) };
    Ok(t0 + (t1 - t0) * (level - v0) / (v1 - v0))
}

/// Slope of the straight line of least squares against time times `time_scale`.
pub(super) fn slope(points: &[(f64, f64)], time_scale: f64) -> Result<f64, String> {
    let count = points.len() as f64;
    let (time, value) = (points.iter().map(|(time, _)| time * time_scale).sum::<f64>() / count, mean(points)?);
    let (mut product, mut square) = (0.0, 0.0);
    for (t, v) in points {
        product += (t * time_scale - time) * (v - value);
        square += (t * time_scale - time).powi(2);
    }
    Ok(product / square)
}

/// Value at a time, linear between records.
pub(super) fn value_at(points: &[(f64, f64)], time: f64) -> Result<f64, String> {
    interpolate(points, time).ok_or_else(|| {
        let range = points.first().zip(points.last());
        let range = range.map_or_else(String::new, |(first, last)| format!("{} s to {} s", first.0, last.0));
        format!("t = {time} s lies outside the records from {range}")
    })
}

/// Linear interpolation; none outside, but for rounding of the ends.
pub fn interpolate(points: &[(f64, f64)], time: f64) -> Option<f64> {
    let (first, last) = (points.first()?, points.last()?);
    let slack = 1e-9 * (last.0 - first.0).abs();
    if time < first.0 - slack || time > last.0 + slack {
        return None;
    }
    let after = points.partition_point(|(t, _)| *t < time).clamp(1, points.len().max(2) - 1);
    let ((t0, v0), (t1, v1)) = (*points.get(after - 1)?, *points.get(after)?);
    Some(if t1 > t0 { v0 + (v1 - v0) * ((time - t0) / (t1 - t0)).clamp(0.0, 1.0) } else { v0 })
}

/// Mean over a window about a time, of the straight lines between the records; none where the window is not within
/// them. Without a window the value at the time.
pub(super) fn mean_about(points: &[(f64, f64)], time: f64, window: f64) -> Option<f64> {
    if window <= 0.0 {
        return interpolate(points, time);
    }
    let (begin, end) = (time - 0.5 * window, time + 0.5 * window);
    let first = (begin, interpolate(points, begin)?);
    let last = (end, interpolate(points, end)?);
    let within = points.partition_point(|(t, _)| *t <= begin)..points.partition_point(|(t, _)| *t < end);
    let all = std::iter::once(first).chain(points.get(within)?.iter().copied()).chain(std::iter::once(last));
    let areas = all.clone().zip(all.skip(1)).map(|((t0, v0), (t1, v1))| 0.5 * (t1 - t0) * (v0 + v1));
    Some(areas.sum::<f64>() / window)
}

/// Columns of a reference file by name: comma-separated, `#` starts a comment, the first row names the columns.
pub(super) fn columns(path: &std::path::Path, names: &[String]) -> Result<Vec<Vec<f64>>, String> {
    let wrong = |reason: String| record::Error::new(path, reason).to_string();
    scene::check_file(path).map_err(wrong)?;
    let reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).flexible(true).from_path(path);
    let mut reader = reader.map_err(|error| wrong(format!("the reference cannot be read: {error}")))?;
    let header = reader.headers().map_err(|error| wrong(error.to_string()))?.clone();
    // What stands in the file never reaches a message: it may be any file.
    let place = |name: &String| {
        let found = header.iter().position(|column| column == name);
        found.ok_or_else(|| wrong(format!("no column '{name}' among its {}", header.len())))
    };
    let places = names.iter().map(place).collect::<Result<Vec<_>, _>>()?;
    let mut columns = vec![Vec::new(); names.len()];
    for (number, row) in reader.records().enumerate() {
        let row = row.map_err(|error| wrong(error.to_string()))?;
        for ((column, place), name) in columns.iter_mut().zip(&places).zip(names) {
            let value = row.get(*place).and_then(|text| text.parse::<f64>().ok());
            column.push(value.ok_or_else(|| wrong(format!("row {}, column '{name}': no number", number + 1)))?);
        }
    }
    Ok(columns)
}
