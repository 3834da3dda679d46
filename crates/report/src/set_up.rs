//! What a scene looks like before its first step: water, walls, structure, and what is measured where.

use super::canvas::{Error, FAMILY, save};
use super::chart::{COLOURS, tick};
use super::field::{Line, spacing};
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use scene::{Fluid, Gauge, Probe, Region, Scene};
use std::path::{Path, PathBuf};

const WIDTH: f64 = 1100.0;
const LABELS: (f64, f64) = (62.0, 44.0);
const CAPTION: f64 = 30.0;
/// Height of a line of the legend, and texts side by side.
const LINE: f64 = 20.0;
const COLUMNS: usize = 2;
const WATER: RGBColor = RGBColor(150, 200, 235);

type Axes<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

/// A scene, and what a run would make of it.
pub struct SetUp<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Places of particles \[m\].
    pub particles: &'a [[f32; 2]],
    /// Lines of the structure \[m\].
    pub structure: &'a [Line],
}

impl SetUp<'_> {
    /// Writes `stem.svg` and `stem.png`; gives the path of the PNG.
    ///
    /// # Errors
    /// A picture that cannot be written.
    pub fn draw(&self, stem: &Path) -> Result<PathBuf, Error> {
        let mut svg = String::new();
        self.draw_svg(&mut svg).map_err(|error| Error::new(stem, error))?;
        save(&svg, stem)
    }

    fn draw_svg(&self, svg: &mut String) -> Drawn {
        let (low, high) = self.bounds();
        let marks = self.scene.fluid.as_ref().map_or_else(Vec::new, |fluid| marks(fluid, high[1]));
        let scale = (WIDTH - LABELS.0 - 16.0) / (high[0] - low[0]);
        let height = (scale * (high[1] - low[1])).clamp(120.0, WIDTH) + CAPTION + LABELS.1 + 16.0;
        let legend = LINE * marks.len().div_ceil(COLUMNS) as f64;
        let whole = SVGBackend::with_string(svg, (WIDTH as u32, (height + legend).ceil() as u32)).into_drawing_area();
        whole.fill(&WHITE)?;
        let (area, below) = whole.split_vertically(height as i32);
        let mut axes = ChartBuilder::on(&area)
            .caption(&self.scene.title, (FAMILY, 17))
            .margin(8)
            .x_label_area_size(LABELS.1 as i32)
            .y_label_area_size(LABELS.0 as i32)
            .build_cartesian_2d(low[0]..high[0], low[1]..high[1])?;
        let (width, tall) = (high[0] - low[0], high[1] - low[1]);
        axes.configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(BLACK.mix(0.08))
            .x_desc("X [m]")
            .y_desc("Y [m]")
            .axis_desc_style((FAMILY, 14))
            .label_style((FAMILY, 13))
            .x_label_formatter(&|value| tick(*value, width))
            .y_label_formatter(&|value| tick(*value, tall))
            .draw()?;
        let radius = (0.5 * scale * spacing(self.particles)).clamp(1.0, 12.0).ceil() as i32;
        let dots = self.particles.iter().map(|place| Circle::new(point(place), radius, WATER.filled()));
        axes.draw_series(dots)?;
        if let Some(fluid) = &self.scene.fluid {
            draw_areas(&mut axes, fluid, (low[1], high[1]))?;
            draw_walls(&mut axes, fluid)?;
        }
        let line = |line: &Line| PathElement::new(line.map(|end| point(&end)), COLOURS[1].stroke_width(3));
        axes.draw_series(self.structure.iter().map(line))?;
        if let Some(fluid) = &self.scene.fluid {
            draw_instruments(&mut axes, fluid, (low[1], high[1]))?;
        }
        draw_numbers(&mut axes, &below, &marks)?;
        whole.present()?;
        Ok(())
    }

    /// Lowest and highest place of anything, with room \[m\].
    fn bounds(&self) -> ([f64; 2], [f64; 2]) {
        let walls = self.scene.fluid.iter().flat_map(|fluid| &fluid.wall).flat_map(|wall| &wall.points);
        let structure = self.structure.iter().flatten();
        let places = structure.chain(self.particles).map(|place| place.map(f64::from)).chain(walls.copied());
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in places {
            for axis in 0..2 {
                low[axis] = low[axis].min(place[axis]);
                high[axis] = high[axis].max(place[axis]);
            }
        }
        if low[0] > high[0] {
            return ([0.0; 2], [1.0; 2]);
        }
        let room = 0.04 * (high[0] - low[0]).max(high[1] - low[1]).max(1e-9);
        (low.map(|value| value - room), high.map(|value| value + room))
    }
}

fn point(place: &[f32; 2]) -> (f64, f64) {
    (f64::from(place[0]), f64::from(place[1]))
}

fn draw_walls(axes: &mut Axes, fluid: &Fluid) -> Drawn {
    let corners = |wall: &scene::Wall| {
        let last = wall.closed.then(|| wall.points[0]);
        wall.points.iter().copied().chain(last).map(|[x, y]| (x, y)).collect::<Vec<_>>()
    };
    axes.draw_series(fluid.wall.iter().map(|wall| PathElement::new(corners(wall), BLACK.stroke_width(3))))?;
    Ok(())
}

/// Damping zones and regions.
fn draw_areas(axes: &mut Axes, fluid: &Fluid, (low, high): (f64, f64)) -> Drawn {
    for zone in &fluid.damping {
        axes.draw_series([Rectangle::new([(zone.from, low), (zone.to, high)], COLOURS[6].mix(0.08).filled())])?;
    }
    for region in &fluid.region {
        let corners: Vec<(f64, f64)> = region.polygon.iter().map(|&[x, y]| (x, y)).collect();
        axes.draw_series([Polygon::new(corners, COLOURS[4].mix(0.2))])?;
    }
    Ok(())
}

/// Gauges and probes.
fn draw_instruments(axes: &mut Axes, fluid: &Fluid, (low, high): (f64, f64)) -> Drawn {
    let gauge = |gauge: &Gauge| PathElement::new([(gauge.x, low), (gauge.x, high)], COLOURS[2].stroke_width(1));
    axes.draw_series(fluid.gauge.iter().map(gauge))?;
    let places = fluid.probe.iter().flat_map(Probe::points);
    axes.draw_series(places.map(|[x, y]| Cross::new((x, y), 4, COLOURS[3].stroke_width(2))))?;
    Ok(())
}

/// Where the number of each instrument stands, and what it is.
fn marks(fluid: &Fluid, top: f64) -> Vec<((f64, f64), String)> {
    let probe = |probe: &Probe| {
        let places = probe.points();
        let text = match places.len() {
            1 => format!("{}, pressure", probe.name),
            count => format!("{}, pressure at {count} points from here", probe.name),
        };
        places.first().map(|&[x, y]| ((x, y), text))
    };
    let region = |region: &Region| {
        let count = region.polygon.len().max(1) as f64;
        let middle = [0, 1].map(|axis| region.polygon.iter().map(|corner| corner[axis]).sum::<f64>() / count);
        ((middle[0], middle[1]), format!("{}, mass of water", region.name))
    };
    let gauges = fluid.gauge.iter().map(|gauge| ((gauge.x, top), format!("{}, water level", gauge.name)));
    let probes = fluid.probe.iter().filter_map(probe);
    probes.chain(gauges).chain(fluid.region.iter().map(region)).collect()
}

fn draw_numbers(axes: &mut Axes, below: &Area, marks: &[((f64, f64), String)]) -> Drawn {
    let style = (FAMILY, 14);
    let number = |(k, (place, _)): (usize, &((f64, f64), String))| {
        EmptyElement::at(*place) + Text::new((k + 1).to_string(), (5, 2), style)
    };
    axes.draw_series(marks.iter().enumerate().map(number))?;
    for (k, (_, text)) in marks.iter().enumerate() {
        let corner = (
            (LABELS.0 + (k % COLUMNS) as f64 * (WIDTH - LABELS.0) / COLUMNS as f64) as i32,
            (LINE * (k / COLUMNS) as f64) as i32,
        );
        below.draw(&Text::new(format!("{}  {text}", k + 1), corner, style))?;
    }
    Ok(())
}
