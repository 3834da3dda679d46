//! Field frames for ParaView: VTK XML unstructured grids (binary, zlib) and one .pvd series per field.
//!
//! A frame is written for the accepted state from which a step starts, and its number follows from its time, so that
//! steps that are repeated after a rollback overwrite their frames with the same content.

use nalgebra::Vector2;
use quick_xml::Writer;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use thiserror::Error;
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataArray, DataSet, ElementType, IOBuffer, Piece,
    UnstructuredGridPiece, Version, VertexNumbers, Vtk,
};
use vtkio::xml::Compressor;

/// A field frame that cannot be written or read.
#[derive(Debug, Error)]
#[error("field frame {path}: {reason}")]
pub struct Error {
    /// Path of the file.
    pub path: String,
    /// What the system or the library said.
    pub reason: String,
}

/// Compression level: 6 takes twice the time of 1 for a tenth less.
const COMPRESSION: u32 = 3;

/// A named field with one entry per point.
#[derive(Debug, Clone, PartialEq)]
pub enum Field {
    /// One number per point.
    Scalar(&'static str, Vec<f32>),
    /// Two components per point; the third is written as zero.
    Vector(&'static str, Vec<[f32; 2]>),
    /// One small number per point.
    Flag(&'static str, Vec<u8>),
}

/// Points with fields, joined by lines or not at all.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Frame {
    /// Places \[m\].
    pub points: Vec<[f32; 2]>,
    /// Pairs of points joined by a line; empty: every point stands alone.
    pub lines: Vec<[u64; 2]>,
    /// Fields.
    pub fields: Vec<Field>,
}

/// A straight line from start to end \[m\], in single precision.
pub type Line = [[f32; 2]; 2];

/// A place in single precision, as frames hold it.
pub fn single(vector: &Vector2<f64>) -> [f32; 2] {
    [vector.x as f32, vector.y as f32]
}

/// When frames are due and which were written.
#[derive(Debug, Clone)]
pub struct Series {
    folder: PathBuf,
    field: &'static str,
    start: f64,
    interval: f64,
    /// Times \[s\] of the frames by number.
    written: BTreeMap<u64, f64>,
    last: Option<(u64, f64)>,
}

impl Series {
    /// A series `field` in `folder`, which is made when missing, with a frame every `interval` seconds from `start`.
    pub fn new(folder: &Path, field: &'static str, start: f64, interval: f64) -> Result<Self, Error> {
        std::fs::create_dir_all(folder).map_err(|error| failed(folder, &error))?;
        let (folder, written) = (folder.to_path_buf(), BTreeMap::new());
        Ok(Self { folder, field, start, interval, written, last: None })
    }

    /// Takes up the frames before `time` that stand in the folder, when this series has written none: the run began in
    /// another process, and goes on here from a saved state.
    pub fn resume(&mut self, time: f64) -> Result<(), Error> {
        // First, since every iteration of a coupling restores a state.
        if self.last.is_some() || time <= self.start {
            return Ok(());
        }
        let path = self.folder.join(format!("{}.pvd", self.field));
        if !path.is_file() {
            return Ok(());
        }
        let text = std::fs::read_to_string(&path).map_err(|error| failed(&path, &error))?;
        let listed: Listed = quick_xml::de::from_str(&text).map_err(|error| failed(&path, &error))?;
        for frame in listed.collection.frames.iter().filter(|frame| frame.time < time) {
            self.written.insert(self.number(frame.time), frame.time);
        }
        self.last = self.written.iter().next_back().map(|(number, at)| (*number, *at));
        Ok(())
    }

    /// The number of the frame that is due at `time`, if one is.
    pub fn due(&self, time: f64) -> Option<u64> {
        let number = self.number(time);
        match self.last {
            Some((last, at)) if last == number && time >= at => None,
            _ => Some(number),
        }
    }

    /// The number of a last frame at `time`, unless that time has one.
    pub fn due_at_end(&self, time: f64) -> Option<u64> {
        match self.last {
            Some((_, at)) if at == time => None,
            Some((last, _)) if last >= self.number(time) => Some(last + 1),
            _ => Some(self.number(time)),
        }
    }

    fn number(&self, time: f64) -> u64 {
        // The share added makes up for the last digits of times that were added up.
        ((time - self.start) / self.interval + 1e-6).max(0.0) as u64
    }

    /// Writes a frame and the list of all frames.
    pub fn write(&mut self, number: u64, time: f64, frame: Frame) -> Result<(), Error> {
        write_frame(&self.folder.join(self.file_name(number)), frame)?;
        self.last = Some((number, time));
        self.written.insert(number, time);
        let path = self.folder.join(format!("{}.pvd", self.field));
        let text = self.collection().map_err(|error| failed(&path, &error))?;
        write_whole(&path, &text).map_err(|error| failed(&path, &error))
    }

    fn file_name(&self, number: u64) -> String {
        format!("{}_{number:06}.vtu", self.field)
    }

    fn collection(&self) -> io::Result<Vec<u8>> {
        let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
        writer
            .create_element("VTKFile")
            .with_attribute(("type", "Collection"))
            .with_attribute(("version", "0.1"))
            .with_attribute(("byte_order", "LittleEndian"))
            .write_inner_content(|writer| {
                writer.create_element("Collection").write_inner_content(|writer| {
                    for (&number, time) in &self.written {
                        writer
                            .create_element("DataSet")
                            .with_attribute(("timestep", time.to_string().as_str()))
                            .with_attribute(("part", "0"))
                            .with_attribute(("file", self.file_name(number).as_str()))
                            .write_empty()?;
                    }
                    Ok(())
                })?;
                Ok(())
            })?;
        Ok(writer.into_inner())
    }
}

/// A .pvd file as it is read again.
#[derive(Deserialize)]
struct Listed {
    #[serde(rename = "Collection")]
    collection: Collection,
}

#[derive(Deserialize)]
struct Collection {
    #[serde(rename = "DataSet", default)]
    frames: Vec<ListedFrame>,
}

#[derive(Deserialize)]
struct ListedFrame {
    #[serde(rename = "@timestep")]
    time: f64,
}

fn failed(path: &Path, error: &dyn std::fmt::Display) -> Error {
    Error { path: path.display().to_string(), reason: error.to_string() }
}

/// Writes beside the file, with the extension `part`, and renames: whoever looks finds the whole file or none, also
/// after the end of a run on a full disk.
///
/// # Errors
/// A file that cannot be written; then nothing is left of it, and an earlier file of that name stays.
pub fn write_whole(path: &Path, content: &[u8]) -> io::Result<()> {
    replace(path, content, |_| Ok(()))
}

/// The same, on the disk when this returns: it outlasts a machine that stops at once.
///
/// # Errors
/// As those of [`write_whole`].
pub fn write_lasting(path: &Path, content: &[u8]) -> io::Result<()> {
    replace(path, content, File::sync_all)
}

fn replace(path: &Path, content: &[u8], settle: impl Fn(&File) -> io::Result<()>) -> io::Result<()> {
    let temporary = path.with_extension("part");
    let write = || {
        let mut file = File::create(&temporary)?;
        file.write_all(content)?;
        settle(&file)?;
        std::fs::rename(&temporary, path)
    };
    let written = write();
    if written.is_err() {
        // The failure to tell is the first one.
        let _ = std::fs::remove_file(&temporary);
    }
    written
}

/// Writes one frame as a .vtu file.
pub fn write_frame(path: &Path, frame: Frame) -> Result<(), Error> {
    let file = grid(frame).try_into_xml_format(Compressor::ZLib, COMPRESSION).map_err(|error| failed(path, &error))?;
    // Through memory: the library's export to a file drops its last buffer without looking whether it could be written.
    let mut content = Vec::new();
    file.write(&mut content).map_err(|error| failed(path, &error))?;
    write_whole(path, &content).map_err(|error| failed(path, &error))
}

fn grid(frame: Frame) -> Vtk {
    let count = frame.points.len() as u64;
    let (connectivity, offsets, kind, cells) = if frame.lines.is_empty() {
        ((0..count).collect(), (1..=count).collect(), CellType::Vertex, frame.points.len())
    } else {
        let lines = frame.lines.len();
        let offsets = (1..=lines as u64).map(|line| 2 * line).collect();
        (frame.lines.concat(), offsets, CellType::Line, lines)
    };
    let piece = UnstructuredGridPiece {
        points: IOBuffer::F32(with_depth(&frame.points)),
        cells: Cells { cell_verts: VertexNumbers::XML { connectivity, offsets }, types: vec![kind; cells] },
        data: Attributes { point: frame.fields.into_iter().map(attribute).collect(), cell: Vec::new() },
    };
    Vtk {
        version: Version::new_xml(1, 0),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        file_path: None,
        data: DataSet::UnstructuredGrid { meta: None, pieces: vec![Piece::Inline(Box::new(piece))] },
    }
}

fn with_depth(points: &[[f32; 2]]) -> Vec<f32> {
    points.iter().flat_map(|point| [point[0], point[1], 0.0]).collect()
}

fn attribute(field: Field) -> Attribute {
    let scalar = ElementType::Scalars { num_comp: 1, lookup_table: None };
    let (name, elem, data) = match field {
        Field::Scalar(name, values) => (name, scalar, IOBuffer::F32(values)),
        Field::Flag(name, values) => (name, scalar, IOBuffer::U8(values)),
        Field::Vector(name, values) => (name, ElementType::Vectors, IOBuffer::F32(with_depth(&values))),
    };
    Attribute::DataArray(DataArray { name: name.to_string(), elem, data })
}

/// A frame as read from a file: places, lines, and scalar fields by name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadFrame {
    /// Places \[m\].
    pub points: Vec<[f32; 2]>,
    /// Pairs of joined points; empty when the points stand alone.
    pub lines: Vec<[u64; 2]>,
    /// Fields with the number of components per point.
    pub fields: BTreeMap<String, (usize, Vec<f32>)>,
}

impl ReadFrame {
    /// The values of a field with one component.
    pub fn scalar(&self, name: &str) -> Option<&[f32]> {
        self.fields.get(name).filter(|(components, _)| *components == 1).map(|(_, values)| values.as_slice())
    }
}

/// Reads a frame that [`write_frame`] wrote.
pub fn read_frame(path: &Path) -> Result<ReadFrame, Error> {
    let vtk = Vtk::import(path).map_err(|error| failed(path, &error))?;
    let DataSet::UnstructuredGrid { pieces, .. } = vtk.data else {
        return Err(failed(path, &"expected an unstructured grid"));
    };
    let mut frame = ReadFrame::default();
    for piece in pieces {
        let piece = piece.into_loaded_piece_data(None).map_err(|error| failed(path, &error))?;
        read_piece(piece, &mut frame).ok_or_else(|| failed(path, &"a field is not a number"))?;
    }
    Ok(frame)
}

fn read_piece(piece: UnstructuredGridPiece, frame: &mut ReadFrame) -> Option<()> {
    let places: Vec<f32> = piece.points.cast_into()?;
    frame.points.extend(places.chunks_exact(3).map(|point| [point[0], point[1]]));
    if piece.cells.types.first() == Some(&CellType::Line)
        && let VertexNumbers::XML { connectivity, .. } = piece.cells.cell_verts
    {
        frame.lines.extend(connectivity.chunks_exact(2).map(|pair| [pair[0], pair[1]]));
    }
    for attribute in piece.data.point {
        let Attribute::DataArray(array) = attribute else { continue };
        let components = array.num_comp();
        frame.fields.insert(array.name, (components, array.data.cast_into()?));
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(count: usize) -> Frame {
        let points = (0..count).map(|i| [i as f32 * 0.1, 1.0 - i as f32]).collect();
        let pressure = (0..count).map(|i| i as f32 * 9.81).collect();
        let velocity = (0..count).map(|i| [i as f32, -1.0]).collect();
        let surface = (0..count).map(|i| u8::from(i % 3 == 0)).collect();
        let fields = vec![
            Field::Scalar("pressure", pressure),
            Field::Vector("velocity", velocity),
            Field::Flag("surface", surface),
        ];
        Frame { points, lines: Vec::new(), fields }
    }

    #[test]
    fn a_frame_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.vtu");
        write_frame(&path, sample(20_000)).unwrap();
        let back = read_frame(&path).unwrap();
        assert_eq!(back.points, sample(20_000).points);
        assert_eq!(back.scalar("pressure").unwrap()[19_999], 19_999.0 * 9.81_f32);
        assert_eq!(back.scalar("surface").unwrap()[..4], [1.0, 0.0, 0.0, 1.0]);
        let (components, velocity) = &back.fields["velocity"];
        assert_eq!((*components, &velocity[3..6]), (3, &[1.0, -1.0, 0.0][..]));
    }

    #[test]
    fn a_file_that_cannot_be_written_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let taken = folder.path().join("walls.vtu");
        std::fs::create_dir(&taken).unwrap();
        let message = write_frame(&taken, sample(3)).unwrap_err().to_string();
        assert!(message.contains("walls.vtu"), "{message}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn lines_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("walls.vtu");
        let frame = Frame { lines: vec![[0, 1], [1, 2]], ..sample(3) };
        write_frame(&path, frame).unwrap();
        assert_eq!(read_frame(&path).unwrap().lines, [[0, 1], [1, 2]]);
    }

    #[test]
    fn repeats_overwrite_and_the_last_state_gets_a_frame() {
        let folder = tempfile::tempdir().unwrap();
        let mut series = Series::new(folder.path(), "particles", 0.0, 0.02).unwrap();
        for step in 0..10 {
            let time = 0.01 * f64::from(step);
            for _repeat in 0..3 {
                if let Some(number) = series.due(time) {
                    series.write(number, time, sample(5)).unwrap();
                }
            }
        }
        let number = series.due_at_end(0.095).unwrap();
        series.write(number, 0.095, sample(5)).unwrap();
        assert_eq!(series.due_at_end(0.095), None);
        let text = std::fs::read_to_string(folder.path().join("particles.pvd")).unwrap();
        let times: Vec<&str> = text.split("timestep=\"").skip(1).filter_map(|part| part.split('"').next()).collect();
        assert_eq!(times, ["0", "0.02", "0.04", "0.06", "0.08", "0.095"]);
        // A rollback past the last frame makes it due again.
        assert_eq!(series.due(0.02), Some(1));
    }
}
