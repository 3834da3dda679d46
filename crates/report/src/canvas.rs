//! A drawing as SVG and, rendered from that, as PNG. The font comes with the program: no system font is needed.

use frames::write_whole;
use plotters::style::{FontStyle, register_font};
use resvg::{tiny_skia, usvg};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use thiserror::Error;

/// Family under which the font is known to both libraries.
pub(super) const FAMILY: &str = "sans-serif";
/// Resolution of the PNG relative to the SVG's units.
const SCALE: f32 = 2.0;

/// A picture that could not be made.
#[derive(Debug, Error)]
#[error("{path}: cannot draw: {reason}")]
pub struct Error {
    /// Path of the picture.
    pub path: String,
    /// What failed.
    pub reason: String,
    /// Whether the disk would not take it: drawn again it may be there.
    pub unwritten: bool,
}

impl Error {
    pub(super) fn new(path: &Path, reason: impl ToString) -> Self {
        Self { path: path.display().to_string(), reason: reason.to_string(), unwritten: false }
    }

    pub(super) fn unwritten(path: &Path, error: &std::io::Error) -> Self {
        Self { unwritten: true, ..Self::new(path, error) }
    }
}

/// Makes the font known to the drawing library. Call it once before drawing; calling it again does no harm.
pub fn prepare_font() {
    // The only failure is a font file that cannot be parsed, and then labels are merely spaced by a rough guess.
    let _ = register_font(FAMILY, FontStyle::Normal, dejavu::sans::regular());
    let _ = register_font(FAMILY, FontStyle::Bold, dejavu::sans::bold());
}

/// Writes `stem.svg` and `stem.png`; gives the path of the PNG.
pub(super) fn save(svg: &str, stem: &Path) -> Result<PathBuf, Error> {
    let with = |extension: &str| {
        let mut name = stem.as_os_str().to_os_string();
        name.push(extension);
        PathBuf::from(name)
    };
    let path = with(".svg");
    write_whole(&path, svg.as_bytes()).map_err(|error| Error::unwritten(&path, &error))?;
    let path = with(".png");
    let mut options = usvg::Options { font_family: FAMILY.to_string(), ..usvg::Options::default() };
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.load_font_data(dejavu::sans::bold().to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    let tree = usvg::Tree::from_str(svg, &options).map_err(|error| Error::new(&path, error))?;
    let size = tree.size().to_int_size();
    let (width, height) = ((size.width() as f32 * SCALE) as u32, (size.height() as f32 * SCALE) as u32);
    let mut image = tiny_skia::Pixmap::new(width, height).ok_or_else(|| Error::new(&path, "the picture is empty"))?;
    image.fill(tiny_skia::Color::WHITE);
    resvg::render(&tree, tiny_skia::Transform::from_scale(SCALE, SCALE), &mut image.as_mut());
    let content = image.encode_png().map_err(|error| Error::new(&path, error))?;
    write_whole(&path, &content).map_err(|error| Error::unwritten(&path, &error))?;
    Ok(path)
}
