//! What a run was made of, so that it can be repeated to the bit.

use super::{Error, write_whole};
use crate::machine::Circumstances;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Name of the record in a run's folder.
pub const RECIPE: &str = "run.json";
/// Name of the copy of the scene or case file in a run's folder.
const SCENE: &str = "scene.toml";

/// Everything that decides the numbers of a run, and where it was done. Seeds are keys of the scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// Name of the scene or case.
    pub name: String,
    /// Changes of its values, `key.path=value`.
    pub set: Vec<String>,
    /// Threads of the fluid, where the command named them. The bits do not depend on it.
    pub threads: Option<usize>,
    /// Folder that reference files are relative to.
    pub references: PathBuf,
    /// Version of the program.
    pub version: String,
    /// CRC-32 of each FMU's file, by its name in the case.
    pub fmus: BTreeMap<String, String>,
    /// The command line.
    pub command: String,
    /// Date and time of day, UTC.
    pub date: String,
    /// Processor, processors, memory, operating system.
    pub machine: String,
    /// Every file of the run, relative to its folder, listed before it is written; `*` stands for a number. Nothing else
    /// is ever removed.
    #[serde(default)]
    pub files: Vec<String>,
    /// When the last byte of the report of a run that reached its end was written, UTC.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub ended: Option<String>,
}

impl Recipe {
    /// The recipe of a run that begins now, of FMUs by name and path, whose files are `files`.
    pub fn new<'a>(
        name: &str,
        set: &[String],
        threads: Option<usize>,
        references: &Path,
        fmus: impl Iterator<Item = (&'a str, &'a Path)>,
        files: Vec<String>,
    ) -> Self {
        let Circumstances { date, machine, command, .. } = Circumstances::here();
        let checksum = |path: &Path| match scene::read_file(path) {
            Ok(bytes) => format!("{:08x}", crc32fast::hash(&bytes)),
            Err(error) => error.to_string(),
        };
        Self {
            name: name.to_string(),
            set: set.to_vec(),
            threads,
            references: std::path::absolute(references).unwrap_or_else(|_| references.to_path_buf()),
            version: env!("CARGO_PKG_VERSION").to_string(),
            fmus: fmus.map(|(name, path)| (name.to_string(), checksum(path))).collect(),
            command,
            date,
            machine,
            files,
            ended: None,
        }
    }

    /// Takes over what a run that goes on has from its beginning.
    pub fn go_on_with(&mut self, begun: &Self) {
        self.date.clone_from(&begun.date);
        self.files.clone_from(&begun.files);
    }

    /// Reads the recipe of the run in `folder`; none where no run left one.
    pub fn read(folder: &Path) -> Result<Option<Self>, Error> {
        let path = folder.join(RECIPE);
        if !path.is_file() {
            return Ok(None);
        }
        let text = std::fs::read_to_string(&path).map_err(|error| Error::new(&path, error))?;
        serde_json::from_str(&text).map(Some).map_err(|error| Error::new(&path, error))
    }

    /// Writes the recipe and the text of the scene or case into `folder`: the recipe first, since it lists the other.
    pub fn write(&self, folder: &Path, text: &str) -> Result<(), Error> {
        self.store(folder)?;
        write_whole(&Self::scene_in(folder), text)
    }

    /// Lists more files, which are about to be written into `folder`.
    pub fn list(&mut self, folder: &Path, files: Vec<String>) -> Result<(), Error> {
        self.files.extend(files);
        self.files.sort();
        self.files.dedup();
        self.store(folder)
    }

    /// Notes that the run in `folder` is complete, its report with it.
    pub fn end(&mut self, folder: &Path) -> Result<(), Error> {
        self.ended = Some(Circumstances::here().date);
        self.store(folder)
    }

    /// Whether the run is complete, its report with it.
    pub fn is_whole(&self) -> bool {
        self.ended.is_some()
    }

    fn store(&self, folder: &Path) -> Result<(), Error> {
        let path = folder.join(RECIPE);
        let json = serde_json::to_string_pretty(self).map_err(|error| Error::new(&path, error))?;
        write_whole(&path, json + "\n")
    }

    /// The copy of the scene or case file in a run's folder.
    pub fn scene_in(folder: &Path) -> PathBuf {
        folder.join(SCENE)
    }
}
