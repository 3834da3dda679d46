//! Beyond the paper: load of the bulkhead against its stiffness, its thickness and the opening, with error bars.

use super::FinishedRun;
use super::cabin;
use super::hull::{Opening, Side, walls};
use maud::{Markup, html};
use report::html::{self, Failure};
use report::{Chart, Curve};

/// Largest displacement of particles at the start, in spacings.
const JITTER: f64 = 0.01;

/// A part of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Part {
    /// Young's modulus over four decades, and a rigid bulkhead.
    Modulus,
    /// Thickness of the bulkhead.
    Thickness,
    /// Height of the opening, about the same middle.
    Opening,
    /// Place of the opening.
    Place,
}

/// One point of the study.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// The part it belongs to.
    pub part: Part,
    /// Its abscissa, as text and as a number.
    pub label: String,
    /// Abscissa.
    pub value: f64,
    /// Changes of the scene.
    pub changes: Vec<String>,
}

impl Part {
    /// All parts.
    pub const ALL: [Self; 4] = [Self::Modulus, Self::Thickness, Self::Opening, Self::Place];

    fn title(self) -> &'static str {
        match self {
            Self::Modulus => "Young's modulus [Pa]",
            Self::Thickness => "thickness of the bulkhead [mm]",
            Self::Opening => "height of the opening [m]",
            Self::Place => "middle of the opening above the keel [m]",
        }
    }

    /// Its points.
    pub fn points(self) -> Vec<Point> {
        let point = |label: String, value: f64, changes: Vec<String>| Point { part: self, label, value, changes };
        let side = |low: f64, high: f64| walls(&[Opening { side: Side::Left, from: low, to: high }]);
        match self {
            Self::Modulus => {
                let modulus = |e: f64| {
                    point(format!("{e:.1e}"), e, vec![format!("body.cabin.member.bulkhead.youngs_modulus={e:e}")])
                };
                let mut all: Vec<Point> = [1.8e8, 1.8e9, 1.8e10, 1.8e11, 1.8e12].map(modulus).to_vec();
                all.push(point("rigid".into(), 1.8e13, vec!["body.cabin.member.bulkhead.modes=0".into()]));
                all
            }
            Self::Thickness => {
                let thickness = |mm: f64| {
                    point(format!("{mm}"), mm, vec![format!("body.cabin.member.bulkhead.thickness={}", 1e-3 * mm)])
                };
                [9.0, 12.7, 17.96, 25.4].map(thickness).to_vec()
            }
            Self::Opening => {
                let height = |h: f64| point(format!("{h}"), h, vec![side(0.17 - 0.5 * h, 0.17 + 0.5 * h)]);
                [0.08, 0.12, 0.16, 0.2].map(height).to_vec()
            }
            Self::Place => {
                let place = |y: f64| point(format!("{y}"), y, vec![side(y - 0.08, y + 0.08)]);
                [0.14, 0.17, 0.22, 0.27].map(place).to_vec()
            }
        }
    }
}

/// Changes of the scene for one repeat of a point.
pub fn changes(point: &Point, repeat: usize) -> Vec<String> {
    let mut all = point.changes.clone();
    all.push(format!("fluid.start.jitter={JITTER}"));
    all.push(format!("fluid.start.seed={repeat}"));
    all
}

/// Mean and standard deviation over the repeats; none without a value.
pub fn statistics(values: &[f64]) -> Option<(f64, f64)> {
    let count = values.len() as f64;
    if values.is_empty() {
        return None;
    }
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    Some((mean, if values.len() > 1 { (square / (count - 1.0)).sqrt() } else { 0.0 }))
}

/// Takes a figure from a run; none where it was not recorded.
type Measure = fn(&FinishedRun) -> Option<f64>;

/// What is measured of a run, by name.
const FIGURES: [(&str, Measure); 5] = [
    ("peak pressure on the bulkhead [kPa]", |done| {
        let peaks = (3..3 + cabin::STATIONS).filter_map(|k| cabin::peak_and_mean(&done.series, &cabin::pressure(k)));
        peaks.map(|it| 1e-3 * it.0).reduce(f64::max)
    }),
    ("peak net force [N/m]", |done| Some(cabin::peak_and_impulse(&cabin::net_force(&done.series)).0)),
    ("impulse to 1.2 s [N s/m]", |done| Some(cabin::peak_and_impulse(&cabin::net_force(&done.series)).2)),
    ("largest deflection [mm]", |done| {
        cabin::peak_and_mean(&done.series, "structure.body.cabin.bulkhead.deflection.middle").map(|it| 1e3 * it.0)
    }),
    ("roll at 1.2 s [rad]", |done| cabin::at_the_end(&done.series, "structure.body.cabin.motion.theta")),
];

/// The page's text: a table and charts of every part.
pub fn section(points: &[(Point, Vec<FinishedRun>)]) -> Result<Markup, Failure> {
    let mut parts = Vec::new();
    for part in Part::ALL {
        let own: Vec<&(Point, Vec<FinishedRun>)> = points.iter().filter(|(point, _)| point.part == part).collect();
        if !own.is_empty() {
            parts.push(part_section(part, &own)?);
        }
    }
    Ok(html! {
        p {
            "Every point is the mean of several runs whose particles start displaced at random by up to " (JITTER)
            " spacings; plus-minus is their standard deviation: a peak pressure is a statistic."
        }
        @for part in parts { (part) }
    })
}

fn part_section(part: Part, points: &[&(Point, Vec<FinishedRun>)]) -> Result<Markup, Failure> {
    let measured = |runs: &[FinishedRun], of: Measure| {
        statistics(&runs.iter().filter(|done| done.summary.error.is_none()).filter_map(of).collect::<Vec<_>>())
    };
    let row = |(point, runs): &&(Point, Vec<FinishedRun>)| {
        let cell = |of: Measure| match measured(runs, of) {
            Some((mean, deviation)) => format!("{mean:.3} \u{b1} {deviation:.3}"),
            None => "-".to_string(),
        };
        let failed = runs.iter().filter(|done| done.summary.error.is_some()).count();
        let count =
            if failed > 0 { format!("{} of {}", runs.len() - failed, runs.len()) } else { runs.len().to_string() };
        let cells = FIGURES.iter().map(|(_, of)| cell(*of));
        [point.label.clone(), count].into_iter().chain(cells).collect()
    };
    let rows: Vec<Vec<String>> = points.iter().map(row).collect();
    let head: Vec<&str> = [part.title(), "runs"].into_iter().chain(FIGURES.iter().map(|(name, _)| *name)).collect();
    let mut charts = Vec::new();
    for (name, of) in &FIGURES[..3] {
        let abscissa = |value: f64| if part == Part::Modulus { value.log10() } else { value };
        let curve = |sign: f64, label: &str| {
            let at = |(point, runs): &&(Point, Vec<FinishedRun>)| {
                measured(runs, *of).map(|(mean, deviation)| (abscissa(point.value), mean + sign * deviation))
            };
            Curve { label: label.to_string(), points: points.iter().filter_map(at).collect(), markers: false }
        };
        let axis = if part == Part::Modulus { "log10 of Young's modulus [Pa], the last rigid" } else { part.title() };
        let curves = vec![curve(0.0, "mean"), curve(-1.0, "less one deviation"), curve(1.0, "plus one deviation")];
        let chart = Chart { title: name.to_string(), x: axis.to_string(), y: name.to_string(), curves, band: None };
        charts.push(html::chart(&chart)?);
    }
    let errors = points.iter().flat_map(|(point, runs)| {
        let texts = runs.iter().filter_map(|done| done.summary.error.as_ref());
        texts.map(|error| format!("{}: {error}", point.label))
    });
    Ok(html! {
        h2 { "Against " (part.title()) }
        (html::table(&head, &rows))
        @for error in errors { p { (error) } }
        @for chart in charts { (chart) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_spread_about_their_mean() {
        assert_eq!(statistics(&[1.0, 2.0, 3.0]), Some((2.0, 1.0)));
        assert_eq!(statistics(&[4.0]), Some((4.0, 0.0)));
        assert_eq!(statistics(&[]), None);
    }

    #[test]
    fn repeats_differ_in_the_seed_alone() {
        let point = &Part::Opening.points()[2];
        let (one, other) = (changes(point, 1), changes(point, 2));
        assert_eq!(one.len(), 3);
        assert_eq!((one[2].as_str(), other[2].as_str()), ("fluid.start.seed=1", "fluid.start.seed=2"));
        assert_eq!(one[..2], other[..2]);
    }
}
