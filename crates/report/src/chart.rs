//! Curves against time.

use super::canvas::{Error, FAMILY, save};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::path::{Path, PathBuf};

/// Colours that stay apart for colour-blind readers (Okabe and Ito 2008).
pub(super) const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(60, 60, 60),
];
const BAND_COLOUR: RGBColor = RGBColor(150, 150, 150);
const SIZE: (u32, u32) = (900, 480);
/// Most points drawn of a curve; more than pixels across show nothing more.
const MOST_POINTS: usize = 1800;

type Axes<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// One curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curve {
    /// Name in the legend.
    pub label: String,
    /// Points (x, y).
    pub points: Vec<(f64, f64)>,
    /// Markers instead of a line.
    pub markers: bool,
}

/// An area between two curves.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Band {
    /// Name in the legend.
    pub label: String,
    /// Points (x, lower, upper).
    pub points: Vec<(f64, f64, f64)>,
}

/// A figure with axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chart {
    /// Above the axes.
    pub title: String,
    /// Name and unit of the horizontal axis.
    pub x: String,
    /// Name and unit of the vertical axis.
    pub y: String,
    /// Curves in the order of the legend.
    pub curves: Vec<Curve>,
    /// An area behind the curves.
    pub band: Option<Band>,
}

impl Chart {
    /// Writes `stem.svg` and `stem.png`; gives the path of the PNG.
    pub fn draw(&self, stem: &Path) -> Result<PathBuf, Error> {
        let mut svg = String::new();
        self.draw_svg(&mut svg).map_err(|error| Error::new(stem, error))?;
        save(&svg, stem)
    }

    /// The drawing itself.
    ///
    /// # Errors
    /// Axes that cannot be drawn.
    pub fn svg(&self) -> Result<String, Error> {
        let mut svg = String::new();
        self.draw_svg(&mut svg).map_err(|error| Error::new(Path::new(&self.title), error))?;
        Ok(svg)
    }

    fn draw_svg(&self, svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
        let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let ((x0, x1), (y0, y1)) = self.ranges();
        let mut chart = ChartBuilder::on(&area)
            .caption(&self.title, (FAMILY, 19))
            .margin(14)
            .x_label_area_size(44)
            .y_label_area_size(84)
            .build_cartesian_2d(x0..x1, y0..y1)?;
        let number = |value: &f64| tick(*value, y1 - y0);
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 225, 225))
            .x_desc(&self.x)
            .y_desc(&self.y)
            .axis_desc_style((FAMILY, 15))
            .label_style((FAMILY, 13))
            .x_label_formatter(&|value| tick(*value, x1 - x0))
            .y_label_formatter(&number)
            .draw()?;
        self.draw_band(&mut chart)?;
        self.draw_curves(&mut chart)?;
        if self.curves.len() > 1 || self.band.is_some() {
            chart
                .configure_series_labels()
                .position(self.free_corner((x0, x1), (y0, y1)))
                .background_style(WHITE.mix(0.85))
                .border_style(RGBColor(200, 200, 200))
                .label_font((FAMILY, 14))
                .draw()?;
        }
        area.present()?;
        Ok(())
    }

    /// The corner for the legend where the fewest points of curves are.
    fn free_corner(&self, x: (f64, f64), y: (f64, f64)) -> SeriesLabelPosition {
        let corners = [
            (SeriesLabelPosition::UpperRight, true, true),
            (SeriesLabelPosition::UpperLeft, false, true),
            (SeriesLabelPosition::LowerRight, true, false),
            (SeriesLabelPosition::LowerLeft, false, false),
        ];
        // A legend takes about a third of the width and, line by line, a share of the height.
        let height = (0.06 * (self.curves.len() + 2) as f64).min(0.5);
        let inside = |right: bool, upper: bool, point: &(f64, f64)| {
            let (across, up) = ((point.0 - x.0) / (x.1 - x.0), (point.1 - y.0) / (y.1 - y.0));
            (if right { across > 0.65 } else { across < 0.35 }) && (if upper { up > 1.0 - height } else { up < height })
        };
        let points = || self.curves.iter().flat_map(|curve| thinned(&curve.points));
        let count = |right: bool, upper: bool| points().filter(|point| inside(right, upper, point)).count();
        let best = corners.into_iter().min_by_key(|(_, right, upper)| count(*right, *upper));
        best.map_or(SeriesLabelPosition::UpperRight, |(corner, ..)| corner)
    }

    fn draw_band(&self, chart: &mut Axes) -> Result<(), Box<dyn std::error::Error>> {
        if let Some(band) = &self.band {
            let lower = band.points.iter().map(|(x, low, _)| (*x, *low));
            let outline: Vec<(f64, f64)> = lower.chain(band.points.iter().rev().map(|(x, _, up)| (*x, *up))).collect();
            chart
                .draw_series(std::iter::once(Polygon::new(outline, BAND_COLOUR.mix(0.4).filled())))?
                .label(&band.label)
                .legend(|(x, y)| Rectangle::new([(x, y - 5), (x + 20, y + 5)], BAND_COLOUR.mix(0.4).filled()));
        }
        Ok(())
    }

    fn draw_curves(&self, chart: &mut Axes) -> Result<(), Box<dyn std::error::Error>> {
        for (curve, colour) in self.curves.iter().zip(COLOURS.iter().cycle()) {
            let points = thinned(&curve.points);
            let drawn = if curve.markers {
                chart.draw_series(points.into_iter().map(|point| Circle::new(point, 3, colour.filled())))?
            } else {
                chart.draw_series(LineSeries::new(points, colour.stroke_width(2)))?
            };
            drawn.label(&curve.label).legend(|(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(3)));
        }
        Ok(())
    }

    /// Ranges of both axes, with some room above and below.
    fn ranges(&self) -> ((f64, f64), (f64, f64)) {
        let curves = self.curves.iter().flat_map(|curve| curve.points.iter().copied());
        let band = self.band.iter().flat_map(|band| &band.points);
        let band = band.flat_map(|(x, low, up)| [(*x, *low), (*x, *up)]);
        let (mut x, mut y) = (Range::default(), Range::default());
        for (horizontal, vertical) in curves.chain(band).filter(|(x, y)| x.is_finite() && y.is_finite()) {
            x.add(horizontal);
            y.add(vertical);
        }
        (x.padded(0.0), y.padded(0.06))
    }
}

struct Range {
    low: f64,
    high: f64,
}

impl Default for Range {
    fn default() -> Self {
        Self { low: f64::INFINITY, high: f64::NEG_INFINITY }
    }
}

impl Range {
    fn add(&mut self, value: f64) {
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }

    /// The range with a margin; an empty or flat one is opened to something that can be drawn.
    fn padded(&self, share: f64) -> (f64, f64) {
        if self.low > self.high {
            return (0.0, 1.0);
        }
        let length = self.high - self.low;
        let flat = length <= 1e-12 * self.low.abs().max(self.high.abs()) || length == 0.0;
        let margin = if flat { 0.5 * self.low.abs().max(1e-6) } else { share * length };
        (self.low - margin, self.high + margin)
    }
}

/// A label of an axis that spans `length`.
pub(super) fn tick(value: f64, length: f64) -> String {
    let value = if value.abs() < 1e-9 * length { 0.0 } else { value };
    if value != 0.0 && !(1e-3..1e5).contains(&length) {
        return format!("{value:.2e}");
    }
    let decimals = (2.0 - length.log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.decimals$}");
    if decimals == 0 { text } else { text.trim_end_matches('0').trim_end_matches('.').to_string() }
}

/// Keeps lowest and highest point of each of equally many parts, so that peaks survive.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let finite: Vec<(f64, f64)> = points.iter().copied().filter(|(x, y)| x.is_finite() && y.is_finite()).collect();
    if finite.len() <= MOST_POINTS {
        return finite;
    }
    let part = finite.len().div_ceil(MOST_POINTS / 2);
    let extremes = |chunk: &[(f64, f64)]| {
        let order = |a: &(usize, &(f64, f64)), b: &(usize, &(f64, f64))| a.1.1.total_cmp(&b.1.1);
        let low = chunk.iter().enumerate().min_by(order).map_or(0, |(index, _)| index);
        let high = chunk.iter().enumerate().max_by(order).map_or(0, |(index, _)| index);
        [chunk[low.min(high)], chunk[low.max(high)]]
    };
    finite.chunks(part).flat_map(extremes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_peaks() {
        let mut points: Vec<(f64, f64)> = (0..100_000).map(|i| (f64::from(i), 0.0)).collect();
        points[43_210].1 = 7.0;
        let thin = thinned(&points);
        assert!(thin.len() <= MOST_POINTS && thin.contains(&(43_210.0, 7.0)));
    }

    #[test]
    fn ticks_are_short() {
        assert_eq!(tick(0.25, 1.0), "0.25");
        assert_eq!(tick(4905.0, 6000.0), "4905");
        assert_eq!(tick(2e-5, 1e-4), "2.00e-5");
        assert_eq!(tick(1e-18, 1.0), "0");
    }

    #[test]
    fn a_chart_gives_two_files_with_text() {
        super::super::prepare_font();
        let folder = tempfile::tempdir().unwrap();
        let line = (0..50).map(|i| (f64::from(i), f64::from(i * i))).collect();
        let curves = vec![
            Curve { label: "computed".into(), points: line, markers: false },
            Curve { label: "measured".into(), points: vec![(10.0, 90.0)], markers: true },
        ];
        let band = Some(Band { label: "band".into(), points: vec![(0.0, 0.0, 100.0), (40.0, 1000.0, 2000.0)] });
        let chart = Chart { title: "T".into(), x: "time [s]".into(), y: "y [m]".into(), curves, band };
        let png = chart.draw(&folder.path().join("a")).unwrap();
        // PNG signature (RFC 2083), and enough bytes for a picture with text.
        let bytes = std::fs::read(png).unwrap();
        assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n") && bytes.len() > 10_000, "{}", bytes.len());
        let svg = std::fs::read_to_string(folder.path().join("a.svg")).unwrap();
        assert!(svg.contains("time [s]") && svg.contains("measured"));
        // Nothing to draw must not fail either.
        Chart::default().draw(&folder.path().join("empty")).unwrap();
    }
}
