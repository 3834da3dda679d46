//! The field: particles coloured by pressure, walls, and the outline of the structure.

use super::canvas::{Error, FAMILY, save};
use super::chart::tick;
pub use frames::Line;
use plotters::coord::Shift;
use plotters::prelude::*;
use std::path::{Path, PathBuf};

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// Width of the whole figure in pixels, and room for titles, labels and the colour bar.
const WIDTH: f64 = 1100.0;
const TITLE: f64 = 24.0;
const BAR: f64 = 90.0;
const LABELS: (f64, f64) = (62.0, 42.0);
/// Largest height of a panel over its width: a tall jet is shown smaller, with room beside it.
const TALLEST: f64 = 1.2;

/// One moment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Panel {
    /// Above the panel.
    pub title: String,
    /// Places of particles \[m\].
    pub particles: Vec<[f32; 2]>,
    /// What colours each particle, in SI: its pressure or its speed.
    pub values: Vec<f32>,
    /// Lines of fixed walls: start and end \[m\].
    pub walls: Vec<Line>,
    /// Lines of the structure.
    pub body: Vec<Line>,
}

impl Panel {
    /// The square of half side `half` around a place, under another title.
    pub fn around(self, centre: [f64; 2], half: f64, title: &str) -> Self {
        let near = |place: &[f32; 2]| (0..2).all(|axis| (f64::from(place[axis]) - centre[axis]).abs() <= half);
        let kept = self.particles.into_iter().zip(self.values).filter(|(place, _)| near(place));
        let (particles, values) = kept.unzip();
        let lines = |lines: Vec<Line>| lines.into_iter().filter(|line| line.iter().any(near)).collect();
        let (walls, body) = (lines(self.walls), lines(self.body));
        Self { title: title.to_string(), particles, values, walls, body }
    }

    /// All lines.
    pub fn lines(&self) -> impl Iterator<Item = &Line> {
        self.walls.iter().chain(&self.body)
    }
}

/// What the colours of particles show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quantity {
    /// Pressure, shown in kPa.
    #[default]
    Pressure,
    /// Speed in m/s.
    Speed,
}

impl Quantity {
    fn label(self) -> &'static str {
        match self {
            Self::Pressure => "p [kPa]",
            Self::Speed => "u [m/s]",
        }
    }

    /// Size of the shown unit in SI.
    fn unit(self) -> f64 {
        match self {
            Self::Pressure => 1000.0,
            Self::Speed => 1.0,
        }
    }
}

/// Panels with a common view and colour bar.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FieldFigure {
    /// Moments in order.
    pub panels: Vec<Panel>,
    /// Panels side by side.
    pub columns: usize,
    /// What the colours show.
    pub quantity: Quantity,
}

/// What part of the plane is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct View {
    pub(super) x: (f64, f64),
    pub(super) y: (f64, f64),
}

impl FieldFigure {
    /// Writes `stem.svg` and `stem.png`; gives the path of the PNG.
    pub fn draw(&self, stem: &Path) -> Result<PathBuf, Error> {
        let mut svg = String::new();
        self.draw_svg(&mut svg).map_err(|error| Error::new(stem, error))?;
        save(&svg, stem)
    }

    fn draw_svg(&self, svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
        let view = View::of(&self.panels);
        let columns = self.columns.clamp(1, self.panels.len().max(1));
        let rows = self.panels.len().div_ceil(columns).max(1);
        let width = (WIDTH - BAR) / columns as f64;
        let scale = (width - LABELS.0 - 16.0) / (view.x.1 - view.x.0);
        let height = scale * (view.y.1 - view.y.0) + TITLE + LABELS.1 + 16.0;
        let size = (WIDTH as u32, (height * rows as f64).ceil() as u32 + 8);
        let area = SVGBackend::with_string(svg, size).into_drawing_area();
        area.fill(&WHITE)?;
        let (left, right) = area.split_horizontally((WIDTH - BAR) as i32);
        let range = range_of(&self.panels);
        for (place, panel) in left.split_evenly((rows, columns)).iter().zip(&self.panels) {
            draw_panel(place, panel, view, range, scale)?;
        }
        draw_bar(&right, range, self.quantity)?;
        area.present()?;
        Ok(())
    }
}

impl View {
    /// The box of the structure and of all particles but a few drops, with room; walls beyond it are clipped.
    pub(super) fn of(panels: &[Panel]) -> Self {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        let mut add = |point: &[f32; 2]| {
            for axis in 0..2 {
                low[axis] = low[axis].min(f64::from(point[axis]));
                high[axis] = high[axis].max(f64::from(point[axis]));
            }
        };
        let any = panels.iter().any(|panel| !panel.particles.is_empty());
        panels.iter().filter_map(body_of_water).flatten().for_each(|corner| add(&corner));
        let horizontal = |line: &&[[f32; 2]; 2]| !any || (line[0][1] - line[1][1]).abs() < 1e-6;
        let seen = panels.iter().flat_map(|panel| panel.walls.iter().filter(horizontal).chain(&panel.body));
        seen.flatten().for_each(&mut add);
        if low[0] > high[0] {
            return Self { x: (0.0, 1.0), y: (0.0, 1.0) };
        }
        let room = 0.04 * (high[0] - low[0]).max(high[1] - low[1]).max(1e-9);
        let (width, height) = (high[0] - low[0] + 2.0 * room, high[1] - low[1] + 2.0 * room);
        let beside = 0.5 * (height / TALLEST - width).max(0.0);
        Self { x: (low[0] - room - beside, high[0] + room + beside), y: (low[1] - room, high[1] + room) }
    }
}

/// Corners of the box of a panel's particles without the outermost five-hundredth on each side: drops that fly off on their
/// own would make everything else small.
fn body_of_water(panel: &Panel) -> Option<[[f32; 2]; 2]> {
    let out = panel.particles.len() / 500;
    let mut corners = [[0.0; 2]; 2];
    for axis in 0..2 {
        let mut places: Vec<f32> = panel.particles.iter().map(|point| point[axis]).collect();
        places.sort_unstable_by(f32::total_cmp);
        corners[0][axis] = *places.get(out)?;
        corners[1][axis] = places[places.len() - 1 - out];
    }
    Some(corners)
}

/// Range of colours: from 0 (or the lowest hundredth) to what all but a hundredth of the particles stay below.
pub(super) fn range_of(panels: &[Panel]) -> (f64, f64) {
    let mut all: Vec<f32> = panels.iter().flat_map(|panel| panel.values.iter().copied()).collect();
    all.retain(|pressure| pressure.is_finite());
    all.sort_by(f32::total_cmp);
    let at = |share: f64| all.get((share * all.len() as f64) as usize).map_or(0.0, |value| f64::from(*value));
    let (low, high) = (at(0.01).min(0.0), at(0.99));
    (low, if high > low { high } else { low + 1.0 })
}

fn draw_panel(
    area: &Area,
    panel: &Panel,
    view: View,
    range: (f64, f64),
    scale: f64,
) -> Result<(), Box<dyn std::error::Error>> {
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, (FAMILY, 15))
        .margin(8)
        .x_label_area_size(LABELS.1 as i32)
        .y_label_area_size(LABELS.0 as i32)
        .build_cartesian_2d(view.x.0..view.x.1, view.y.0..view.y.1)?;
    let (width, height) = (view.x.1 - view.x.0, view.y.1 - view.y.0);
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("X [m]")
        .y_desc("Y [m]")
        .axis_desc_style((FAMILY, 13))
        .x_labels(6)
        .y_labels(5)
        .label_style((FAMILY, 12))
        .x_label_formatter(&|value| tick(*value, width))
        .y_label_formatter(&|value| tick(*value, height))
        .draw()?;
    let radius = (0.58 * scale * spacing(&panel.particles)).clamp(0.6, 12.0).ceil() as i32;
    let particles = panel.particles.iter().map(|point| point.map(f64::from)).zip(&panel.values);
    let seen = particles.filter(|([x, y], _)| (view.x.0..=view.x.1).contains(x) && (view.y.0..=view.y.1).contains(y));
    chart.draw_series(
        seen.map(|([x, y], value)| Circle::new((x, y), radius, colour(f64::from(*value), range).filled())),
    )?;
    let inside = panel.lines().filter_map(|line| clip(line, view));
    chart.draw_series(inside.map(|line| PathElement::new(line, BLACK.stroke_width(2))))?;
    Ok(())
}

fn draw_bar(area: &Area, range: (f64, f64), quantity: Quantity) -> Result<(), Box<dyn std::error::Error>> {
    const STEPS: i32 = 64;
    let height = area.dim_in_pixel().1 as i32 - 56;
    for i in 0..STEPS {
        let (top, bottom) = (34 + height * i / STEPS, 34 + height * (i + 1) / STEPS);
        let value = range.1 - (range.1 - range.0) * (f64::from(i) + 0.5) / f64::from(STEPS);
        area.draw(&Rectangle::new([(6, top), (22, bottom)], colour(value, range).filled()))?;
    }
    area.draw(&Text::new(quantity.label(), (4, 12), (FAMILY, 13)))?;
    for i in 0..=4 {
        let share = f64::from(i) / 4.0;
        let value = (range.1 + share * (range.0 - range.1)) / quantity.unit();
        let y = 34 + (share * f64::from(height)) as i32 - 6;
        area.draw(&Text::new(tick(value, (range.1 - range.0) / quantity.unit()), (27, y), (FAMILY, 13)))?;
    }
    Ok(())
}

pub(super) fn colour(value: f64, range: (f64, f64)) -> RGBColor {
    let share = ((value - range.0) / (range.1 - range.0)).clamp(0.0, 1.0);
    ViridisRGB.get_color(share)
}

/// Spacing of particles from the area that a cell of a coarse grid holds: its fullest cells are full of water.
pub(super) fn spacing(particles: &[[f32; 2]]) -> f64 {
    let mut low = [f32::INFINITY; 2];
    let mut high = [f32::NEG_INFINITY; 2];
    for point in particles {
        for axis in 0..2 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    let (width, height) = (f64::from(high[0] - low[0]), f64::from(high[1] - low[1]));
    if particles.len() < 2 || width <= 0.0 || height <= 0.0 {
        return 0.01;
    }
    // Cells that would hold nine particles if all of the box were water.
    let cell = 3.0 * (width * height / particles.len() as f64).sqrt();
    let mut counts = std::collections::BTreeMap::new();
    for point in particles {
        let index = [0, 1].map(|axis| (f64::from(point[axis] - low[axis]) / cell) as u32);
        *counts.entry(index).or_insert(0_u32) += 1;
    }
    let mut counts: Vec<u32> = counts.into_values().collect();
    counts.sort_unstable();
    let full = counts[counts.len() * 3 / 4].max(1);
    cell / f64::from(full).sqrt()
}

/// The part of a line inside the view (Liang and Barsky 1984).
fn clip(line: &[[f32; 2]; 2], view: View) -> Option<[(f64, f64); 2]> {
    let start = line[0].map(f64::from);
    let change = [0, 1].map(|axis| f64::from(line[1][axis] - line[0][axis]));
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (axis, (low, high)) in [view.x, view.y].into_iter().enumerate() {
        if change[axis] == 0.0 {
            if start[axis] < low || start[axis] > high {
                return None;
            }
            continue;
        }
        let (a, b) = ((low - start[axis]) / change[axis], (high - start[axis]) / change[axis]);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    let at = |share: f64| (start[0] + share * change[0], start[1] + share * change[1]);
    (enter <= leave).then(|| [at(enter), at(leave)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_at_the_view() {
        let view = View { x: (0.0, 1.0), y: (0.0, 1.0) };
        assert_eq!(clip(&[[0.5, -1.0], [0.5, 2.0]], view), Some([(0.5, 0.0), (0.5, 1.0)]));
        assert_eq!(clip(&[[2.0, 0.0], [2.0, 1.0]], view), None);
    }

    #[test]
    fn single_drops_do_not_set_the_scale() {
        let mut particles: Vec<[f32; 2]> =
            (0..3000).map(|i| [(i % 60) as f32 * 0.01, (i / 60) as f32 * 0.01]).collect();
        particles.extend([[0.1, 7.0], [-3.0, 0.2]]);
        let walls = vec![[[0.0, 0.0], [0.8, 0.0]], [[0.8, 0.0], [0.8, 9.0]]];
        let body = vec![[[0.3, 0.5], [0.3, 0.7]]];
        let panel = Panel { title: String::new(), values: vec![0.0; 3002], particles, walls, body };
        let view = View::of(&[panel]);
        let room = 0.04 * 0.8;
        for (found, expected) in [(view.x.0, -room), (view.x.1, 0.8 + room), (view.y.0, -room), (view.y.1, 0.7 + room)]
        {
            assert!((found - expected).abs() < 0.02, "{found} against {expected}");
        }
    }

    #[test]
    fn a_field_gives_two_files() {
        super::super::prepare_font();
        let folder = tempfile::tempdir().unwrap();
        let particles: Vec<[f32; 2]> = (0..400).map(|i| [(i % 20) as f32 * 0.01, (i / 20) as f32 * 0.01]).collect();
        assert!((spacing(&particles) - 0.01).abs() < 0.002, "{}", spacing(&particles));
        let values = particles.iter().map(|point| 9810.0 * (0.2 - point[1])).collect();
        let walls = vec![[[0.0, 0.0], [0.5, 0.0]], [[0.0, 1.0], [0.0, 0.0]]];
        let panel = Panel { title: "t = 0 s".into(), particles, values, walls, body: Vec::new() };
        let figure = FieldFigure { panels: vec![panel.clone(), panel], columns: 2, quantity: Quantity::Speed };
        let png = figure.draw(&folder.path().join("field")).unwrap();
        assert!(std::fs::read(png).unwrap().len() > 5_000);
        FieldFigure::default().draw(&folder.path().join("none")).unwrap();
    }
}
