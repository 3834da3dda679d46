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

/// Frequency \[Hz\] from the upward crossings of the mean, each found by linear interpolation.
pub(super) fn frequency(points: &[(f64, f64)]) -> Result<f64, String> {
    let mean = mean(points)?;
    let crossing = |pair: &[(f64, f64)]| {
        let ((t0, v0), (t1, v1)) = (pair[0], pair[1]);
        (v0 < mean && v1 >= mean).then(|| t0 + (t1 - t0) * (mean - v0) / (v1 - v0))
    };
    let times: Vec<f64> = points.windows(2).filter_map(crossing).collect();
    match (times.first(), times.last()) {
        (Some(first), Some(last)) if times.len() > 1 => Ok((times.len() - 1) as f64 / (last - first)),
        _ => Err(format!("{} upward crossings of the mean, expected at least 2", times.len())),
    }
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
pub(super) fn interpolate(points: &[(f64, f64)], time: f64) -> Option<f64> {
    let (first, last) = (points.first()?, points.last()?);
    let slack = 1e-9 * (last.0 - first.0).abs();
    if time < first.0 - slack || time > last.0 + slack {
        return None;
    }
    let after = points.partition_point(|(t, _)| *t < time).clamp(1, points.len().max(2) - 1);
    let ((t0, v0), (t1, v1)) = (*points.get(after - 1)?, *points.get(after)?);
    Some(if t1 > t0 { v0 + (v1 - v0) * ((time - t0) / (t1 - t0)).clamp(0.0, 1.0) } else { v0 })
}

/// Columns of a reference file by name: comma-separated, `#` starts a comment, the first row names the columns.
pub(super) fn columns(path: &std::path::Path, names: &[String]) -> Result<Vec<Vec<f64>>, String> {
    let wrong = |reason: String| record::Error::new(path, reason).to_string();
    let reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).flexible(true).from_path(path);
    let mut reader = reader.map_err(|error| wrong(error.to_string()))?;
    let header = reader.headers().map_err(|error| wrong(error.to_string()))?.clone();
    let place = |name: &String| {
        let known = || header.iter().collect::<Vec<_>>().join(", ");
        header
            .iter()
            .position(|column| column == name)
            .ok_or_else(|| wrong(format!("no column '{name}' in {}", known())))
    };
    let places = names.iter().map(place).collect::<Result<Vec<_>, _>>()?;
    let mut columns = vec![Vec::new(); names.len()];
    for row in reader.records() {
        let row = row.map_err(|error| wrong(error.to_string()))?;
        for (column, place) in columns.iter_mut().zip(&places) {
            let text = row.get(*place).unwrap_or("");
            column.push(text.parse::<f64>().map_err(|_| wrong(format!("'{text}' is no number")))?);
        }
    }
    Ok(columns)
}
