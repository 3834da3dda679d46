//! Makes fluid.fmu and structure.fmu from the two shared libraries. The same content gives the same bytes: entries
//! are sorted and carry a fixed date.

mod documentation;
mod places;
pub mod ssp;

use components::{FluidComponent, StructureComponent};
use fmi2::{Component, Model, describe};
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};
use thiserror::Error;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

pub use places::{files_with, fmus_folder, library, program_folder, scene_files, scenes_folder};

const LICENCES: [(&str, &str); 2] = [
    ("LICENSE-APACHE.txt", include_str!("../../../LICENSE-APACHE")),
    ("LICENSE-MIT.txt", include_str!("../../../LICENSE-MIT")),
];

/// An FMU that cannot be packed.
#[derive(Debug, Error)]
pub enum Error {
    /// A shared library is not where the build leaves it.
    #[error("cannot find {file} in {looked}; build it with `cargo build --release`")]
    NoLibrary {
        /// File name.
        file: String,
        /// Folders looked in.
        looked: String,
    },
    /// There is no folder of scenes.
    #[error("cannot find a folder `scenes` in {0} or above it")]
    NoScenes(String),
    /// The description cannot be made.
    #[error("cannot describe {model}: {reason}")]
    Description {
        /// Identifier of the model.
        model: String,
        /// What failed.
        reason: String,
    },
    /// A file cannot be read or written.
    #[error("{path}: {reason}")]
    File {
        /// Path of the file.
        path: String,
        /// What failed.
        reason: String,
    },
}

impl Error {
    fn file(path: &Path, reason: impl ToString) -> Self {
        Self::File { path: path.display().to_string(), reason: reason.to_string() }
    }
}

/// A packed FMU.
#[derive(Debug, Clone, PartialEq)]
pub struct Packed {
    /// The .fmu.
    pub path: PathBuf,
    /// Whether it was written; false when the same content was there.
    pub written: bool,
    /// Size in bytes.
    pub size: usize,
}

/// Modes that the FMUs of this program can be packed with.
pub fn modes_range() -> std::ops::RangeInclusive<usize> {
    let (fluid, structure) = (FluidComponent::variants(), StructureComponent::variants());
    *fluid.start().max(structure.start())..=*fluid.end().min(structure.end())
}

/// Packs both FMUs with this number of modes into `folder`, where their content differs from what is there.
pub fn pack(folder: &Path, modes: usize) -> Result<Vec<Packed>, Error> {
    pack_with(folder, modes, &scene_files(&scenes_folder()?)?)
}

/// The same for a run, whose scene is a file: a program that is installed without its scenes packs none.
pub fn pack_for_run(folder: &Path, modes: usize) -> Result<Vec<Packed>, Error> {
    let scenes = scenes_folder().map_or_else(|_| Ok(Vec::new()), |scenes| scene_files(&scenes))?;
    pack_with(folder, modes, &scenes)
}

fn pack_with(folder: &Path, modes: usize, scenes: &[(String, Vec<u8>)]) -> Result<Vec<Packed>, Error> {
    std::fs::create_dir_all(folder).map_err(|error| Error::file(folder, error))?;
    archives(modes, scenes, Vec::new())?.iter().map(|(name, bytes)| write(&folder.join(name), bytes)).collect()
}

/// Names and contents of both FMUs. `own` resources are packed besides the program's scenes, or in place of those with
/// the same name.
fn archives(
    modes: usize,
    scenes: &[(String, Vec<u8>)],
    own: Vec<(String, Vec<u8>)>,
) -> Result<Vec<(String, Vec<u8>)>, Error> {
    let mut scenes: Vec<_> = scenes.iter().map(|(name, content)| (format!("scenes/{name}"), content.clone())).collect();
    scenes.retain(|(name, _)| own.iter().all(|(other, _)| other != name));
    scenes.extend(own);
    let fluid = FluidComponent::model(modes);
    let structure = StructureComponent::model(modes);
    let packed = [
        ("fluid.fmu", archive(&fluid, "fluid_fmu", documentation::FLUID, &scenes)?),
        ("structure.fmu", archive(&structure, "structure_fmu", documentation::STRUCTURE, &scenes)?),
    ];
    Ok(packed.map(|(name, bytes)| (name.to_string(), bytes)).into())
}

/// Name and kind (`input` or `output`) of the real variables that can be connected of an FMU of this program.
fn reals(name: &str, modes: usize) -> Vec<(String, &'static str)> {
    fn list<C>(model: &Model<C>) -> Vec<(String, &'static str)> {
        let real = |variable: &&fmi2::Variable<C>| matches!(variable.access, fmi2::Access::Real { .. });
        let connectable = model.variables.iter().filter(real).filter_map(|variable| match variable.causality {
            fmi2::Causality::Input => Some((variable.name.clone(), "input")),
            fmi2::Causality::Output => Some((variable.name.clone(), "output")),
            fmi2::Causality::Parameter => None,
        });
        connectable.collect()
    }
    match name {
        crate::scene_case::FLUID => list(&FluidComponent::model(modes)),
        _ => list(&StructureComponent::model(modes)),
    }
}

/// The bytes of an FMU: description, binary, scenes, documentation and licences.
fn archive<C: Component>(
    model: &Model<C>,
    library_name: &str,
    equations: &str,
    scenes: &[(String, Vec<u8>)],
) -> Result<Vec<u8>, Error> {
    let path = library(library_name)?;
    let binary = std::fs::read(&path).map_err(|error| Error::file(&path, error))?;
    let description = describe::xml(model)
        .map_err(|failure| Error::Description { model: model.identifier.to_string(), reason: failure.message })?;
    let extension = std::env::consts::DLL_EXTENSION;
    let mut entries: Vec<(String, Vec<u8>)> = vec![
        ("modelDescription.xml".to_string(), description.into_bytes()),
        (format!("binaries/{}/{}.{extension}", crate::fmu::PLATFORM, model.identifier), binary),
        ("documentation/index.html".to_string(), documentation::page(model, equations).into_bytes()),
    ];
    entries.extend(
        LICENCES.iter().map(|(name, text)| (format!("documentation/licenses/{name}"), text.as_bytes().to_vec())),
    );
    entries.extend(scenes.iter().map(|(name, content)| (format!("resources/{name}"), content.clone())));
    zipped(entries).map_err(|error| Error::file(Path::new(model.identifier), error))
}

/// A zip archive of these entries, sorted by name.
fn zipped(mut entries: Vec<(String, Vec<u8>)>) -> zip::result::ZipResult<Vec<u8>> {
    entries.sort();
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in entries {
        archive.start_file(name, options)?;
        archive.write_all(&content)?;
    }
    Ok(archive.finish()?.into_inner())
}

/// Writes the file unless it has this content already. The file appears whole or not at all, also when several
/// programs pack into one folder at once: each writes under a name of its own first.
fn write(path: &Path, content: &[u8]) -> Result<Packed, Error> {
    let written = std::fs::read(path).ok().as_deref() != Some(content);
    if written {
        let part = path.with_extension(format!("{}.part", std::process::id()));
        let renamed = std::fs::write(&part, content).and_then(|()| std::fs::rename(&part, path));
        renamed.map_err(|error| {
            // The failure to tell is the first one.
            let _ = std::fs::remove_file(&part);
            Error::file(path, error)
        })?;
    }
    Ok(Packed { path: path.to_path_buf(), written, size: content.len() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_content_gives_the_same_bytes_in_any_order() {
        let entries = vec![("b".to_string(), vec![1; 5000]), ("a/c".to_string(), b"text".to_vec())];
        let reversed = entries.iter().rev().cloned().collect();
        let bytes = zipped(entries).unwrap();
        assert_eq!(bytes, zipped(reversed).unwrap());
        let mut archive = zip::ZipArchive::new(Cursor::new(&bytes)).unwrap();
        let first = archive.by_index(0).unwrap();
        assert_eq!(
            (first.name().unwrap().as_ref(), first.last_modified().map(|date| date.year())),
            ("a/c", Some(1980))
        );
    }

    #[test]
    fn an_equal_file_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.fmu");
        assert!(write(&path, b"one").unwrap().written);
        assert!(!write(&path, b"one").unwrap().written);
        assert!(write(&path, b"two").unwrap().written);
    }

    #[test]
    fn documentation_lists_every_variable() {
        let model = FluidComponent::model(3);
        let page = documentation::page(&model, documentation::FLUID);
        assert!(model.variables.iter().all(|variable| page.contains(&variable.name)));
        assert!(page.contains("N/m") && !page.contains("<td></td><td></td><td></td>"));
    }
}
