//! The page of an ensemble, and that of two of them beside each other.

use super::figures::wanted;
use super::statistics::{Sample, holm, welch};
use super::{Ensemble, Figure};
use maud::{Markup, html};
use report::checks::interpolate;
use report::html::{self, interactive, interactive_page};
use report::record::Series;
use report::{Band, Chart, Curve, Short};

/// Probability below which two ensembles are said to differ.
const LEVEL: f64 = 0.05;

fn short(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_string(), |value| Short(value).to_string())
}

fn sample(figure: &Figure) -> Option<Sample> {
    Sample::of(&figure.values.values().copied().collect::<Vec<_>>())
}

/// The page of an ensemble, with the histories of its runs.
pub fn page(ensemble: &Ensemble, histories: &[Series], variables: &[String]) -> String {
    let failed: Vec<_> = ensemble.members.iter().filter_map(|member| Some((member, member.error.as_ref()?))).collect();
    let changes = if ensemble.set.is_empty() { "none".to_string() } else { ensemble.set.join("; ") };
    let charts: Vec<Chart> = histories.first().map_or_else(Vec::new, |first| {
        wanted(first, variables).filter_map(|column| history(histories, &column.name)).collect()
    });
    let body = html! {
        p { (ensemble.scene) ": " (histories.len()) " runs that differ in the random displacement of the particles at the start. \
            Changed values: " (changes) "." }
        @if !failed.is_empty() { h2 { "Runs without figures" } ul { @for (member, why) in failed { li { (member.name) ": " (why) } } } }
        h2 { "Figures" }
        p { "95 % of further runs lie within the band, and the mean of many within the uncertainty of this one in 95 % of cases, if \
            the figures are distributed normally (Student's distribution). Repeatability is the standard deviation over the mean." }
        (figures(ensemble))
        h2 { "Histories" }
        @for (index, chart) in charts.iter().enumerate() { (interactive(chart, &format!("chart-{index}"))) }
        h2 { "Runs" }
        (html::table(&["run", "seed"], &ensemble.members.iter().map(|member| vec![member.name.clone(), member.seed.to_string()]).collect::<Vec<_>>()))
    };
    let title = if ensemble.title.is_empty() { &ensemble.scene } else { &ensemble.title };
    interactive_page(&format!("{title}: {} runs", histories.len()), &body)
}

fn figures(ensemble: &Ensemble) -> Markup {
    let row = |(name, figure): (&String, &Figure)| {
        let sample = sample(figure)?;
        let band =
            sample.band().map_or_else(|| "-".to_string(), |[low, high]| format!("{} to {}", Short(low), Short(high)));
        let repeatability =
            sample.repeatability().map_or_else(|| "-".to_string(), |share| format!("{:.1} %", 100.0 * share));
        let numbers =
            [Some(sample.mean), sample.uncertainty(), Some(sample.median), Some(sample.least), Some(sample.most)];
        let numbers = numbers.map(short).into_iter();
        Some([name.clone()].into_iter().chain(numbers).chain([band, repeatability, figure.unit.clone()]).collect())
    };
    let rows: Vec<Vec<String>> = ensemble.figures.iter().filter_map(row).collect();
    let head = [
        "figure",
        "mean",
        "uncertainty",
        "median",
        "smallest",
        "largest",
        "95 % band of single runs",
        "repeatability",
        "unit",
    ];
    html::table(&head, &rows)
}

/// Mean, median and the band of all runs at the times of the first.
fn history(histories: &[Series], name: &str) -> Option<Chart> {
    let first = histories.first()?;
    let unit = first.column(name)?.unit.clone();
    let curves: Vec<Vec<(f64, f64)>> =
        histories.iter().filter_map(|series| Some(series.points(series.column(name)?).collect())).collect();
    let at = |time: f64| Sample::of(&curves.iter().filter_map(|curve| interpolate(curve, time)).collect::<Vec<_>>());
    let samples: Vec<(f64, Sample)> = first.times.iter().filter_map(|&time| Some((time, at(time)?))).collect();
    let curve = |label: &str, value: fn(&Sample) -> f64| Curve {
        label: label.to_string(),
        points: samples.iter().map(|(time, sample)| (*time, value(sample))).collect(),
        markers: false,
    };
    let points = samples.iter().map(|(time, sample)| (*time, sample.least, sample.most)).collect();
    Some(Chart {
        title: name.to_string(),
        x: "time [s]".to_string(),
        y: format!("[{unit}]"),
        curves: vec![curve("mean", |sample| sample.mean), curve("median", |sample| sample.median)],
        band: Some(Band { label: format!("all {} runs", curves.len()), points }),
    })
}

/// A probability.
fn small(probability: f64) -> String {
    if probability < 1e-3 { "below 0.001".to_string() } else { format!("{probability:.3}") }
}

/// Two ensembles, figure by figure, and whether they differ.
pub fn differences(labels: [&str; 2], ensembles: [&Ensemble; 2]) -> Markup {
    let [one, other] = ensembles;
    let shared = one.figures.iter().filter_map(|(name, figure)| {
        let second = other.figures.get(name).filter(|second| second.unit == figure.unit)?;
        let samples = [sample(figure)?, sample(second)?];
        Some((name, &figure.unit, samples, welch(&samples[0], &samples[1])?))
    });
    let shared: Vec<_> = shared.collect();
    let adjusted = holm(&shared.iter().map(|(_, _, _, probability)| *probability).collect::<Vec<_>>());
    let row = |((name, unit, [a, b], probability), adjusted): (&(&String, &String, [Sample; 2], f64), &f64)| {
        let means = [a, b].map(|sample| format!("{} +- {}", Short(sample.mean), short(sample.uncertainty())));
        let change = if a.mean == 0.0 { "-".to_string() } else { format!("{:+.1} %", 100.0 * (b.mean / a.mean - 1.0)) };
        let verdict = if *adjusted < LEVEL { "differ" } else { "not told apart" };
        let numbers = [change, small(*probability), small(*adjusted), verdict.to_string(), (*unit).clone()];
        [(*name).clone()].into_iter().chain(means).chain(numbers).collect()
    };
    let rows: Vec<Vec<String>> = shared.iter().zip(&adjusted).map(row).collect();
    html! {
        p { "Welch's t-test of the means, for unequal variances: p is the probability of means at least as far apart if both ensembles \
            were of one kind. Of so many tests some fall below " (LEVEL) " by chance: the verdict is that of the p raised by Holm's method." }
        (html::table(&["figure", labels[0], labels[1], "change", "p", "p raised", "verdict", "unit"], &rows))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ensemble(values: &[f64]) -> Ensemble {
        let mut ensemble = Ensemble { scene: "wedge".into(), ..Ensemble::default() };
        for (index, value) in values.iter().enumerate() {
            for (name, value) in [("peak", *value), ("depth", 0.3 + 1e-6 * value)] {
                let figure = ensemble.figures.entry(name.to_string()).or_default();
                figure.unit = "Pa".to_string();
                figure.values.insert(format!("member-{index}"), value);
            }
        }
        ensemble
    }

    #[test]
    fn ensembles_are_told_apart_where_they_differ() {
        let (low, high) = (ensemble(&[10.0, 11.0, 9.0, 10.5]), ensemble(&[20.0, 21.0, 19.0, 20.5]));
        let text = differences(["a", "b"], [&low, &high]).into_string();
        assert_eq!(text.matches("<td>differ</td>").count(), 2, "{text}");
        let text = differences(["a", "b"], [&low, &low]).into_string();
        assert_eq!(text.matches("<td>not told apart</td>").count(), 2, "{text}");
    }

    #[test]
    fn a_history_has_its_mean_and_all_runs() {
        let series = |value: f64| Series {
            times: vec![0.0, 1.0],
            columns: vec![report::record::Column { name: "p".into(), unit: "Pa".into(), values: vec![0.0, value] }],
        };
        let chart = history(&[series(1.0), series(2.0), series(6.0)], "p").unwrap();
        assert_eq!((chart.curves[0].points[1], chart.curves[1].points[1]), ((1.0, 3.0), (1.0, 2.0)));
        assert_eq!(chart.band.unwrap().points[1], (1.0, 1.0, 6.0));
    }
}
