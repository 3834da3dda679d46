//! The paper's four cabins: what is run, and the figures that are compared.

use super::Model;
use report::record::{Column, Series};

/// The models: number, Young's modulus \[Pa\] (infinite: no modes), changes of the scene.
pub const MODELS: [(&str, f64, &str); 4] = [
    ("I", 1.8e9, "body.cabin.member.bulkhead.youngs_modulus=1.8e9"),
    ("II", 3.6e9, "body.cabin.member.bulkhead.youngs_modulus=3.6e9"),
    ("III", 7.2e9, "body.cabin.member.bulkhead.youngs_modulus=7.2e9"),
    ("IV", f64::INFINITY, "body.cabin.member.bulkhead.modes=0"),
];
/// Time over which the paper takes its averages and peaks \[s\].
pub const PERIOD: f64 = 1.2;
/// The paper's table 2 \[kPa\]: peak at P1, average at P1, peak at P2, average at P2, for each model.
pub const TABLE: [[f64; 4]; 4] =
    [[15.41, 4.50, 21.47, 7.59], [16.71, 5.59, 18.55, 8.70], [22.36, 5.90, 25.94, 8.88], [35.91, 7.94, 56.15, 9.50]];
/// Probes of the scene: P1, P2, then the stations of the bulkhead's flooded face from the bottom up, then the other
/// face.
pub const STATIONS: usize = 7;
/// Height from the lowest station to the highest \[m\].
const HEIGHT: f64 = 0.43;

/// Name of the pressure at a probe, counted from 1.
pub fn pressure(probe: usize) -> String {
    let name = match probe {
        1 | 2 => format!("P{probe}"),
        station if station < 3 + STATIONS => format!("bulkhead_flooded_side_{}", station - 2),
        station => format!("bulkhead_dry_side_{}", station - 2 - STATIONS),
    };
    format!("fluid.probe.{name}.pressure")
}

/// Whether a record counts; times are sums of steps, and right to rounding.
fn within_period((time, _): &(f64, f64)) -> bool {
    *time <= PERIOD * (1.0 + 1e-9)
}

/// Largest value and mean of a variable up to `PERIOD`; none where it was not recorded.
pub fn peak_and_mean(series: &Series, name: &str) -> Option<(f64, f64)> {
    let column: &Column = series.column(name)?;
    let values: Vec<f64> = series.points(column).filter(within_period).map(|(_, value)| value).collect();
    let peak = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (!values.is_empty()).then(|| (peak, values.iter().sum::<f64>() / values.len() as f64))
}

/// Value of a variable at the last record up to `PERIOD`.
pub fn at_the_end(series: &Series, name: &str) -> Option<f64> {
    let column = series.column(name)?;
    series.points(column).filter(within_period).last().map(|(_, value)| value)
}

/// Ours beside `TABLE` \[kPa\].
pub fn table_row(model: &Model) -> [Option<f64>; 4] {
    let kilo = |value: f64| 1e-3 * value;
    let of = |probe: usize| peak_and_mean(&model.done.series, &pressure(probe));
    let (first, second) = (of(1), of(2));
    [first.map(|it| kilo(it.0)), first.map(|it| kilo(it.1)), second.map(|it| kilo(it.0)), second.map(|it| kilo(it.1))]
}

/// Pressure along the bulkhead over its height from the bottom, 0 to 1: peak and mean of a face \[kPa\].
pub fn along_bulkhead(model: &Model, flooded: bool) -> Vec<(f64, f64, f64)> {
    let first = if flooded { 3 } else { 3 + STATIONS };
    let station = |k: usize| {
        let (peak, mean) = peak_and_mean(&model.done.series, &pressure(first + k))?;
        Some((k as f64 / (STATIONS - 1) as f64, 1e-3 * peak, 1e-3 * mean))
    };
    (0..STATIONS).filter_map(station).collect()
}

/// Net force on the bulkhead from its stations over time \[N/m\]: pressure on the flooded face minus that on the other,
/// trapezoidal over the height; empty where a station was not recorded.
pub fn net_force(series: &Series) -> Vec<(f64, f64)> {
    let columns: Option<Vec<&Column>> = (3..3 + 2 * STATIONS).map(|probe| series.column(&pressure(probe))).collect();
    let Some(columns) = columns else { return Vec::new() };
    let step = HEIGHT / (STATIONS - 1) as f64;
    let force = |row: usize| {
        let net = |k: usize| columns[k].values[row] - columns[STATIONS + k].values[row];
        let ends = 0.5 * (net(0) + net(STATIONS - 1));
        step * ((1..STATIONS - 1).map(net).sum::<f64>() + ends)
    };
    series.times.iter().enumerate().map(|(row, &time)| (time, force(row))).collect()
}

/// Peak of a load up to `PERIOD`, when it came, and its impulse.
pub fn peak_and_impulse(points: &[(f64, f64)]) -> (f64, f64, f64) {
    let within: Vec<(f64, f64)> = points.iter().copied().filter(within_period).collect();
    let peak = within.iter().copied().fold((0.0, 0.0), |most, it| if it.1 > most.1 { it } else { most });
    let impulse = within.windows(2).map(|pair| 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0)).sum();
    (peak.1, peak.0, impulse)
}

/// A trend of the paper and what was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Trend {
    /// What the paper says.
    pub claim: &'static str,
    /// Whether it was found; none where a figure is missing.
    pub found: Option<bool>,
    /// Our numbers.
    pub numbers: String,
}

/// The paper's trends, one by one.
pub fn trends(models: &[Model]) -> Vec<Trend> {
    let whole = models.len() == MODELS.len();
    let deflections = largest(models, "structure.body.cabin.bulkhead.deflection.middle");
    let (peaks, means) = (bulkhead(models, true), bulkhead(models, false));
    let rolls: Vec<f64> =
        models.iter().filter_map(|model| at_the_end(&model.done.series, "structure.body.cabin.motion.theta")).collect();
    let rising = |claim, values: &[f64], factor: f64| Trend {
        claim,
        found: whole.then(|| values.windows(2).all(|pair| pair[1] > pair[0])),
        numbers: format!("{}; I over IV {:.2}", list(values, factor, "kPa"), first_over_last(values)),
    };
    let alike = |claim, values: &[f64], unit| Trend {
        claim,
        found: whole.then(|| spread(values) < 0.1),
        numbers: format!("{}; spread {:.1} %", list(values, 1.0, unit), 100.0 * spread(values)),
    };
    let flexible = deflections.get(..3);
    vec![
        Trend {
            claim: "A stiffer bulkhead deflects less (I about three times III)",
            found: flexible.filter(|_| whole).map(|it| it[0] > it[1] && it[1] > it[2]),
            numbers: flexible.map_or_else(String::new, |it| {
                format!("{}; I over III {:.2}", list(it, 1e3, "mm"), first_over_last(it))
            }),
        },
        rising("The peak pressure on the bulkhead rises with its stiffness (I about 0.43 of IV)", &peaks, 1.0),
        rising("The peak at P1 rises with the stiffness (0.43)", &largest(models, &pressure(1)), 1e-3),
        rising("The peak at P2 rises with the stiffness (0.38)", &largest(models, &pressure(2)), 1e-3),
        alike("The average pressure on the bulkhead is nearly the same (here: within 10 %)", &means, "kPa"),
        alike("The roll is nearly the same (here: within 10 % at 1.2 s)", &rolls, "rad"),
    ]
}

/// Largest value of a variable in each model.
fn largest(models: &[Model], name: &str) -> Vec<f64> {
    models.iter().filter_map(|model| peak_and_mean(&model.done.series, name).map(|it| it.0)).collect()
}

/// Largest peak of the bulkhead's flooded face, or the mean over it, in each model \[kPa\].
fn bulkhead(models: &[Model], peak: bool) -> Vec<f64> {
    let of = |model: &Model| {
        let stations = along_bulkhead(model, true);
        let count = stations.len().max(1) as f64;
        let values = stations.iter().map(|&(_, most, mean)| if peak { most } else { mean });
        if peak { values.fold(0.0, f64::max) } else { values.sum::<f64>() / count }
    };
    models.iter().map(of).collect()
}

fn list(values: &[f64], factor: f64, unit: &str) -> String {
    let texts: Vec<String> = values.iter().map(|value| format!("{:.3}", factor * value)).collect();
    format!("{} {unit}", texts.join(", "))
}

fn first_over_last(values: &[f64]) -> f64 {
    values.first().zip(values.last()).map_or(f64::NAN, |(first, last)| first / last)
}

/// Difference of the extremes over the mean.
fn spread(values: &[f64]) -> f64 {
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(low, high), &it| (low.min(it), high.max(it)));
    (high - low) / (values.iter().sum::<f64>() / values.len() as f64).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(name: &str, values: &[f64]) -> Series {
        let column = Column { name: name.to_string(), unit: "Pa".to_string(), values: values.to_vec() };
        Series { times: (0..values.len()).map(|k| 0.4 * k as f64).collect(), columns: vec![column] }
    }

    #[test]
    fn peaks_and_means_end_with_the_paper_s_period() {
        // 0, 0.4, 0.8, 1.2 s count, 1.6 s does not.
        let series = series(&pressure(1), &[1.0, 5.0, 2.0, 4.0, 100.0]);
        assert_eq!(peak_and_mean(&series, &pressure(1)), Some((5.0, 3.0)));
        assert_eq!(at_the_end(&series, &pressure(1)), Some(4.0));
        assert_eq!(peak_and_mean(&series, &pressure(2)), None);
    }

    #[test]
    fn a_net_force_is_the_difference_of_the_faces() {
        let column = |probe: usize| {
            let value = if probe < 3 + STATIONS { 30.0 } else { 10.0 };
            Column { name: pressure(probe), unit: "Pa".to_string(), values: vec![value, 0.0] }
        };
        let series = Series { times: vec![0.0, 0.5], columns: (3..3 + 2 * STATIONS).map(column).collect() };
        let force = net_force(&series);
        assert!((force[0].1 - 20.0 * HEIGHT).abs() < 1e-12 && force[1].1 == 0.0, "{force:?}");
        let (peak, time, impulse) = peak_and_impulse(&force);
        assert!(peak == force[0].1 && time == 0.0 && (impulse - 0.25 * peak).abs() < 1e-12);
    }

    #[test]
    fn a_spread_is_relative_to_the_mean() {
        assert!((spread(&[0.9, 1.0, 1.1]) - 0.2).abs() < 1e-12);
        assert!((first_over_last(&[3.0, 5.0, 6.0]) - 0.5).abs() < 1e-12);
    }
}
