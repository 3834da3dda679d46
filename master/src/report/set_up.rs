//! What a scene looks like before its first step: water, walls, structure, and what is measured where.

use super::canvas::{Error, FAMILY, save};
use super::chart::{COLOURS, tick};
use super::field::{Line, spacing};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use scene::{Fluid, Scene};
use std::path::{Path, PathBuf};

const WIDTH: f64 = 1100.0;
const LABELS: (f64, f64) = (48.0, 30.0);
const CAPTION: f64 = 30.0;
const WATER: RGBColor = RGBColor(150, 200, 235);

type Axes<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
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
        let scale = (WIDTH - LABELS.0 - 16.0) / (high[0] - low[0]);
        let height = (scale * (high[1] - low[1])).clamp(120.0, 2.0 * WIDTH) + CAPTION + LABELS.1 + 16.0;
        let area = SVGBackend::with_string(svg, (WIDTH as u32, height.ceil() as u32)).into_drawing_area();
        area.fill(&WHITE)?;
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
            .label_style((FAMILY, 13))
            .x_label_formatter(&|value| tick(*value, width))
            .y_label_formatter(&|value| tick(*value, tall))
            .draw()?;
        let radius = (0.5 * scale * spacing(self.particles)).clamp(0.5, 12.0) as i32;
        let dots = self.particles.iter().map(|place| Circle::new(point(place), radius.max(1), WATER.filled()));
        axes.draw_series(dots)?;
        if let Some(fluid) = &self.scene.fluid {
            draw_walls(&mut axes, fluid)?;
            draw_measured(&mut axes, fluid, (low[1], high[1]))?;
        }
        let lines =
            self.structure.iter().map(|line| PathElement::new(line.map(|end| point(&end)), COLOURS[1].stroke_width(3)));
        axes.draw_series(lines)?;
        area.present()?;
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

/// Regions, gauges, damping zones and probes with their names.
fn draw_measured(axes: &mut Axes, fluid: &Fluid, (low, high): (f64, f64)) -> Drawn {
    for region in &fluid.region {
        let corners: Vec<(f64, f64)> = region.polygon.iter().map(|&[x, y]| (x, y)).collect();
        axes.draw_series([Polygon::new(corners.clone(), COLOURS[4].mix(0.2))])?;
        axes.draw_series([Text::new(region.name.clone(), corners[0], (FAMILY, 13))])?;
    }
    for zone in &fluid.damping {
        axes.draw_series([Rectangle::new([(zone.from, low), (zone.to, high)], COLOURS[6].mix(0.08).filled())])?;
    }
    for gauge in &fluid.gauge {
        let line = PathElement::new([(gauge.x, low), (gauge.x, high)], COLOURS[2].mix(0.6));
        axes.draw_series([line])?;
        axes.draw_series([Text::new(
            gauge.name.clone(),
            (gauge.x, high),
            (FAMILY, 13).into_font().color(&COLOURS[2]),
        )])?;
    }
    for probe in &fluid.probe {
        let places: Vec<(f64, f64)> = probe.points().iter().map(|&[x, y]| (x, y)).collect();
        axes.draw_series(places.iter().map(|&place| Cross::new(place, 5, COLOURS[3].stroke_width(2))))?;
        let name = places.first().map(|&place| Text::new(probe.name.clone(), place, (FAMILY, 13)));
        axes.draw_series(name)?;
    }
    Ok(())
}
