//! Field frames that the components wrote.

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

/// The frames that `folder/series.pvd` lists; empty without such a file.
pub fn frames(folder: &Path, series: &str) -> Result<Vec<FrameEntry>, String> {
    let path = folder.join(format!("{series}.pvd"));
    let Ok(text) = std::fs::read_to_string(&path) else { return Ok(Vec::new()) };
    let file: File = quick_xml::de::from_str(&text).map_err(|error| format!("{}: {error}", path.display()))?;
    let entry = |set: Set| FrameEntry { time: set.time, path: folder.join(set.file) };
    Ok(file.collection.sets.into_iter().map(entry).collect())
}
