//! Field frames that the components wrote.

use super::field::{Line, Panel, Quantity};
use frames::{ReadFrame, read_frame};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// One frame of a series.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameEntry {
    /// Time \[s\].
    pub time: f64,
    /// The .vtu file.
    pub path: PathBuf,
}

#[derive(Deserialize)]
struct File {
    #[serde(rename = "Collection")]
    collection: Collection,
}

#[derive(Deserialize)]
struct Collection {
    #[serde(rename = "DataSet", default)]
    sets: Vec<Set>,
}

#[derive(Deserialize)]
struct Set {
    #[serde(rename = "@timestep")]
    time: f64,
    #[serde(rename = "@file")]
    file: String,
}

/// The field frames of a run: particles, structure and walls.
#[derive(Debug, Clone, PartialEq)]
pub struct Fields {
    particles: Vec<FrameEntry>,
    structure: Vec<FrameEntry>,
    walls: Vec<Line>,
}

impl Fields {
    /// What stands in a run's folder of frames; there may be none.
    ///
    /// # Errors
    /// A list of frames that cannot be read.
    pub fn open(folder: &Path) -> Result<Self, String> {
        let walls = read_frame(&folder.join("walls.vtu")).map(|frame| lines(&frame)).unwrap_or_default();
        Ok(Self { particles: frames(folder, "particles")?, structure: frames(folder, "structure")?, walls })
    }

    /// Times of the frames \[s\].
    pub fn times(&self) -> Vec<f64> {
        let main = if self.particles.is_empty() { &self.structure } else { &self.particles };
        main.iter().map(|entry| entry.time).collect()
    }

    /// The frame nearest to a time, particles coloured by a quantity.
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub fn panel(&self, time: f64, quantity: Quantity) -> Result<Panel, String> {
        let (water, body) = self.read(time)?;
        let values = match quantity {
            Quantity::Pressure => {
                water.scalar("pressure").map_or_else(|| vec![0.0; water.points.len()], <[f32]>::to_vec)
            }
            Quantity::Speed => {
                let velocity = water.fields.get("velocity").map_or(&[][..], |(_, values)| values.as_slice());
                velocity.chunks_exact(3).map(|it| it[0].hypot(it[1])).collect()
            }
        };
        let walls = self.walls.clone();
        Ok(Panel { title: format!("t = {time:.3} s"), particles: water.points, values, walls, body })
    }

    fn read(&self, time: f64) -> Result<(ReadFrame, Vec<Line>), String> {
        let near = |entries: &[FrameEntry]| {
            let nearest = entries.iter().min_by(|a, b| (a.time - time).abs().total_cmp(&(b.time - time).abs()));
            nearest.map(|entry| read_frame(&entry.path).map_err(|error| error.to_string())).transpose()
        };
        let water = near(&self.particles)?.unwrap_or_default();
        let body = near(&self.structure)?.unwrap_or_default();
        Ok((water, lines(&body)))
    }
}

fn lines(frame: &ReadFrame) -> Vec<Line> {
    let point = |index: u64| frame.points.get(index as usize).copied();
    frame.lines.iter().filter_map(|[a, b]| Some([point(*a)?, point(*b)?])).collect()
}

/// The frames that `folder/series.pvd` lists; empty without such a file.
pub fn frames(folder: &Path, series: &str) -> Result<Vec<FrameEntry>, String> {
    let path = folder.join(format!("{series}.pvd"));
    let Ok(text) = std::fs::read_to_string(&path) else { return Ok(Vec::new()) };
    let file: File = quick_xml::de::from_str(&text).map_err(|error| format!("{}: {error}", path.display()))?;
    let entry = |set: Set| FrameEntry { time: set.time, path: folder.join(set.file) };
    Ok(file.collection.sets.into_iter().map(entry).collect())
}
