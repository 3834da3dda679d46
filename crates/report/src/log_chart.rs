//! Curves over logarithmic axes.

use super::Curve;
use super::canvas::{Error, FAMILY, save};
use super::chart::COLOURS;
use plotters::coord::combinators::{BindKeyPoints, IntoLogRange, LogCoord, WithKeyPoints};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use std::path::{Path, PathBuf};

const SIZE: (u32, u32) = (640, 480);
const GUIDE_COLOUR: RGBColor = RGBColor(140, 140, 140);
/// Lengths of dash and gap of guides \[px\].
const DASHES: [(i32, i32); 2] = [(7, 4), (2, 3)];

type Axis = WithKeyPoints<LogCoord<f64>>;
type Axes<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

/// A figure with two logarithmic axes. Points that are not positive are left out.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LogChart {
    /// Above the axes.
    pub title: String,
    /// Name and unit of the horizontal axis.
    pub x: String,
    /// Name and unit of the vertical axis.
    pub y: String,
    /// Places of labels on the horizontal axis; empty for 1, 2, 5 per decade.
    pub ticks: Vec<f64>,
    /// Curves in the order of the legend, drawn as lines with markers.
    pub curves: Vec<Curve>,
    /// Thin dashed lines behind the curves, for example of a known slope.
    pub guides: Vec<Curve>,
}

impl LogChart {
    /// Writes `stem.svg` and `stem.png`; gives the path of the PNG.
    pub fn draw(&self, stem: &Path) -> Result<PathBuf, Error> {
        let mut svg = String::new();
        self.draw_svg(&mut svg).map_err(|error| Error::new(stem, error))?;
        save(&svg, stem)
    }

    fn draw_svg(&self, svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
        let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let points = || self.curves.iter().chain(&self.guides).flat_map(|curve| positive(&curve.points));
        let x = range(points().map(|(x, _)| x).chain(self.ticks.iter().copied()), (0.06, 0.06));
        // Below the curves there is room for the legend.
        let y = range(points().map(|(_, y)| y), (0.4, 0.1));
        let ticks = if self.ticks.is_empty() { ticks(x) } else { self.ticks.clone() };
        let mut chart = ChartBuilder::on(&area)
            .caption(&self.title, (FAMILY, 15))
            .margin(14)
            .x_label_area_size(44)
            .y_label_area_size(76)
            .build_cartesian_2d(axis(x, ticks), axis(y, self::ticks(y)))?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 225, 225))
            .x_desc(&self.x)
            .y_desc(&self.y)
            .axis_desc_style((FAMILY, 14))
            .label_style((FAMILY, 12))
            .x_label_formatter(&|value| label(*value))
            .y_label_formatter(&|value| label(*value))
            .draw()?;
        self.draw_guides(&mut chart)?;
        self.draw_curves(&mut chart)?;
        // Errors grow with the spacing and fall with the time: these corners are the emptiest.
        let below =
            if self.guides.is_empty() { SeriesLabelPosition::LowerLeft } else { SeriesLabelPosition::LowerRight };
        chart
            .configure_series_labels()
            .position(below)
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(200, 200, 200))
            .label_font((FAMILY, 13))
            .draw()?;
        area.present()?;
        Ok(())
    }

    fn draw_guides(&self, chart: &mut Axes) -> Result<(), Box<dyn std::error::Error>> {
        for (guide, (dash, gap)) in self.guides.iter().zip(DASHES.into_iter().cycle()) {
            let style = GUIDE_COLOUR.stroke_width(1);
            let points: Vec<(f64, f64)> = positive(&guide.points).collect();
            chart
                .draw_series(DashedLineSeries::new(points, dash as u32, gap as u32, style))?
                .label(&guide.label)
                .legend(move |(x, y)| {
                    let dashes = [(x, y), (x + 20, y)];
                    DashedPathElement::new(dashes, dash, gap, style)
                });
        }
        Ok(())
    }

    fn draw_curves(&self, chart: &mut Axes) -> Result<(), Box<dyn std::error::Error>> {
        for (curve, colour) in self.curves.iter().zip(COLOURS.iter().cycle()) {
            let points: Vec<(f64, f64)> = positive(&curve.points).collect();
            chart.draw_series(points.iter().map(|point| Circle::new(*point, 4, colour.filled())))?;
            chart
                .draw_series(LineSeries::new(points, colour.stroke_width(2)))?
                .label(&curve.label)
                .legend(|(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(3)));
        }
        Ok(())
    }
}

fn axis((low, high): (f64, f64), ticks: Vec<f64>) -> Axis {
    (low..high).log_scale().with_key_points(ticks)
}

fn positive(points: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> + '_ {
    points.iter().copied().filter(|(x, y)| x.is_finite() && y.is_finite() && *x > 0.0 && *y > 0.0)
}

/// Smallest and largest value, with a share of their distance in the logarithm below and above, at least a factor 1.2.
fn range(values: impl Iterator<Item = f64>, (below, above): (f64, f64)) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    if low > high {
        return (0.1, 10.0);
    }
    let margin = |share: f64| (high / low).powf(share).max(1.2);
    (low / margin(below), high * margin(above))
}

/// Multiples of powers of ten inside a range: fewer per decade the more decades it spans, and tenths of the power in
/// one so narrow that it would have none.
fn ticks((low, high): (f64, f64)) -> Vec<f64> {
    let decades = (high / low).log10();
    let steps: Vec<f64> = match decades {
        2.5.. => vec![1.0],
        0.8.. => vec![1.0, 2.0, 5.0],
        0.3.. => (1..10).map(f64::from).collect(),
        _ => (10..100).map(|tenths| f64::from(tenths) / 10.0).collect(),
    };
    let exponents = low.log10().floor() as i32..=high.log10().ceil() as i32;
    let all = exponents.flat_map(|exponent| steps.iter().map(move |step| step * 10_f64.powi(exponent)));
    all.filter(|tick| (low..=high).contains(tick)).collect()
}

/// A short label.
fn label(value: f64) -> String {
    if !(1e-3..1e5).contains(&value) {
        return format!("{value:.0e}");
    }
    let decimals = (2.0 - value.log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_and_ticks_of_decades() {
        assert_eq!(ticks((0.015, 0.3)), [0.02, 0.05, 0.1, 0.2]);
        assert_eq!(ticks((0.5e-4, 2.0)).len(), 5);
        // Narrow ranges: 0.04 to 0.07, and 0.031 to 0.037 by tenths.
        assert_eq!((ticks((0.035, 0.075)).len(), ticks((0.0305, 0.0375)).len()), (4, 7));
        let labels: Vec<String> = [0.0125, 1.0, 2e-4, 1e-6, 500.0, 20000.0].map(label).to_vec();
        assert_eq!(labels, ["0.0125", "1", "2e-4", "1e-6", "500", "20000"]);
        assert_eq!(range([].into_iter(), (0.1, 0.1)), (0.1, 10.0));
    }

    #[test]
    fn a_chart_leaves_out_what_has_no_logarithm() {
        super::super::prepare_font();
        let folder = tempfile::tempdir().unwrap();
        let points = vec![(0.01, 1e-3), (0.02, 0.0), (0.04, f64::NAN), (0.08, 0.1)];
        let curve = Curve { label: "voronoi, order 2.0".into(), points, markers: false };
        let guide = Curve { label: "order 1".into(), points: vec![(0.01, 0.01), (0.08, 0.08)], markers: false };
        let ticks = vec![0.01, 0.02, 0.04, 0.08];
        let (curves, guides) = (vec![curve], vec![guide]);
        let chart = LogChart { title: "T".into(), x: "h [m]".into(), y: "error".into(), ticks, curves, guides };
        let png = chart.draw(&folder.path().join("a")).unwrap();
        assert!(std::fs::read(png).unwrap().len() > 5_000);
        let svg = std::fs::read_to_string(folder.path().join("a.svg")).unwrap();
        assert!(svg.contains("voronoi, order 2.0") && svg.contains("0.08"));
        LogChart::default().draw(&folder.path().join("empty")).unwrap();
    }
}
