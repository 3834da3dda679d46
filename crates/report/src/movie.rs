//! A moving picture of the field as an animated PNG, which every browser plays without help.

use super::field::{Panel, Quantity, View, colour, range_of, spacing};
use super::{Error, Fields};
use frames::write_whole;
use plotters::style::RGBColor;
use resvg::tiny_skia::{Color, FillRule, Paint, PathBuilder, Pixmap, Stroke, Transform};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Width in pixels.
const WIDTH: f64 = 960.0;
/// Height of the bar that shows how far time has gone.
const BAR: f64 = 6.0;
/// Shades of the colour map; black and white are two more of the palette's 256 colours.
const SHADES: usize = 254;
const BLACK: u8 = 254;
const WHITE: u8 = 255;
/// Most frames: more are left out.
const MOST_FRAMES: usize = 80;
/// Frames per second.
const RATE: u16 = 15;

/// Part of the plane that is shown \[m\]: left, bottom, right, top.
pub type Window = [f64; 4];

/// Writes the frames of a run as `path`, coloured by pressure; nothing where there are fewer than two.
///
/// # Errors
/// A frame that cannot be read, or a file that cannot be written.
pub fn movie(fields: &Fields, window: Option<Window>, path: &Path) -> Result<Option<PathBuf>, Error> {
    let times = thinned(fields.times());
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return Ok(None) };
    if times.len() < 2 {
        return Ok(None);
    }
    let sample = |time: f64| fields.panel(time, Quantity::Pressure).map_err(|reason| Error::new(path, reason));
    let few = [sample(0.5 * (first + last))?, sample(*last)?];
    let range = range_of(&few);
    let view = window.map_or_else(|| View::of(&few), |it| View { x: (it[0], it[2]), y: (it[1], it[3]) });
    let scale = WIDTH / (view.x.1 - view.x.0);
    let height = ((view.y.1 - view.y.0) * scale + BAR).ceil();
    let canvas =
        Canvas { view, scale, size: (WIDTH as u32, height as u32), range, spacing: spacing(&few[0].particles) };
    let palette = Palette::new();
    let wrong = |error: png::EncodingError| Error::new(path, error);
    let mut content = Vec::new();
    let mut encoder = png::Encoder::new(&mut content, canvas.size.0, canvas.size.1);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette.bytes.clone());
    encoder.set_animated(times.len() as u32, 0).map_err(wrong)?;
    encoder.set_frame_delay(1, RATE).map_err(wrong)?;
    let mut writer = encoder.write_header().map_err(wrong)?;
    for time in &times {
        let share = (time - first) / (last - first);
        let image = canvas.draw(&sample(*time)?, &palette, share).ok_or_else(|| Error::new(path, "empty picture"))?;
        writer.write_image_data(&image).map_err(wrong)?;
    }
    writer.finish().map_err(wrong)?;
    write_whole(path, &content).map_err(|error| Error::unwritten(path, &error))?;
    Ok(Some(path.to_path_buf()))
}

/// At most `MOST_FRAMES` of the times, at equal distances, the last one among them.
fn thinned(times: Vec<f64>) -> Vec<f64> {
    let every = times.len().div_ceil(MOST_FRAMES).max(1);
    let last = times.len().saturating_sub(1);
    times.into_iter().enumerate().filter(|(k, _)| (last - k).is_multiple_of(every)).map(|(_, time)| time).collect()
}

/// Colours and their numbers.
struct Palette {
    bytes: Vec<u8>,
    colours: Vec<RGBColor>,
    numbers: HashMap<[u8; 3], u8>,
}

impl Palette {
    fn new() -> Self {
        let shade = |k: usize| colour(k as f64, (0.0, (SHADES - 1) as f64));
        let mut colours: Vec<RGBColor> = (0..SHADES).map(shade).collect();
        colours.extend([RGBColor(0, 0, 0), RGBColor(255, 255, 255)]);
        let bytes = colours.iter().flat_map(|colour| [colour.0, colour.1, colour.2]).collect();
        let numbers = colours.iter().enumerate().map(|(k, colour)| ([colour.0, colour.1, colour.2], k as u8)).collect();
        Self { bytes, colours, numbers }
    }

    fn paint(&self, number: u8) -> Paint<'static> {
        let RGBColor(red, green, blue) = self.colours[usize::from(number)];
        let mut paint = Paint { anti_alias: false, ..Paint::default() };
        paint.set_color_rgba8(red, green, blue, 255);
        paint
    }
}

/// What every frame has in common.
struct Canvas {
    view: View,
    scale: f64,
    size: (u32, u32),
    range: (f64, f64),
    spacing: f64,
}

impl Canvas {
    fn draw(&self, panel: &Panel, palette: &Palette, share: f64) -> Option<Vec<u8>> {
        let mut image = Pixmap::new(self.size.0, self.size.1)?;
        image.fill(Color::WHITE);
        let radius = (0.6 * self.scale * self.spacing).max(1.0) as f32;
        let inside = |place: &&([f32; 2], f32)| self.shows(&place.0);
        let particles: Vec<_> = panel.particles.iter().copied().zip(panel.values.iter().copied()).collect();
        for (place, pressure) in particles.iter().filter(inside) {
            let (x, y) = self.pixel(place);
            let level = (f64::from(*pressure) - self.range.0) / (self.range.1 - self.range.0);
            let number = (level.clamp(0.0, 1.0) * (SHADES - 1) as f64).round() as u8;
            let disc = PathBuilder::from_circle(x, y, radius)?;
            image.fill_path(&disc, &palette.paint(number), FillRule::Winding, Transform::identity(), None);
        }
        let mut lines = PathBuilder::new();
        for [start, end] in panel.lines() {
            let (a, b) = (self.pixel(start), self.pixel(end));
            lines.move_to(a.0, a.1);
            lines.line_to(b.0, b.1);
        }
        if let Some(lines) = lines.finish() {
            let stroke = Stroke { width: 2.0, ..Stroke::default() };
            image.stroke_path(&lines, &palette.paint(BLACK), &stroke, Transform::identity(), None);
        }
        let top = f64::from(self.size.1) - BAR + 2.0;
        let bar =
            resvg::tiny_skia::Rect::from_ltrb(0.0, top as f32, (share * WIDTH).max(1.0) as f32, self.size.1 as f32)?;
        image.fill_rect(bar, &palette.paint(BLACK), Transform::identity(), None);
        let number = |pixel: &[u8]| palette.numbers.get(&pixel[..3]).copied().unwrap_or(WHITE);
        Some(image.data().chunks_exact(4).map(number).collect())
    }

    fn shows(&self, place: &[f32; 2]) -> bool {
        let (x, y, room) = (f64::from(place[0]), f64::from(place[1]), self.spacing);
        let within = |value: f64, (low, high): (f64, f64)| (low - room..=high + room).contains(&value);
        within(x, self.view.x) && within(y, self.view.y)
    }

    fn pixel(&self, place: &[f32; 2]) -> (f32, f32) {
        let x = (f64::from(place[0]) - self.view.x.0) * self.scale;
        let y = (self.view.y.1 - f64::from(place[1])) * self.scale;
        (x as f32, y as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use frames::{Field, Frame, Series};

    #[test]
    fn frames_become_an_animation_with_their_colours() {
        let folder = tempfile::tempdir().unwrap();
        let mut series = Series::new(folder.path(), "particles", 0.1, 0.0).unwrap();
        for k in 0..3_u64 {
            let points = (0..100).map(|i| [0.01 * (i % 10) as f32, 0.01 * (i / 10) as f32 + 0.02 * k as f32]);
            let pressures = (0..100).map(|i| i as f32).collect();
            let frame = Frame {
                points: points.collect(),
                fields: vec![Field::Scalar("pressure", pressures)],
                ..Frame::default()
            };
            series.write(k, 0.1 * k as f64, frame).unwrap();
        }
        let fields = Fields::open(folder.path()).unwrap();
        let path = movie(&fields, None, &folder.path().join("movie.png")).unwrap().unwrap();
        let reader = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(path).unwrap()));
        let mut reader = reader.read_info().unwrap();
        assert_eq!(reader.info().animation_control().unwrap().num_frames, 3);
        let mut image = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut image).unwrap();
        let mut seen = image.clone();
        seen.sort_unstable();
        seen.dedup();
        assert!(seen.len() > 20, "{} colours", seen.len());
    }
}
