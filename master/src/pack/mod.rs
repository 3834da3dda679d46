//! Makes fluid.fmu and structure.fmu from the two shared libraries. The same content gives the same bytes: entries
//! are sorted and carry a fixed date.

mod documentation;
mod places;
pub mod ssp;

use components::{DEFAULT_SCENE, FluidComponent, INTERFACE_FILE, Interface, OWN_SCENE, StructureComponent};
use fmi::{Component, Model};
use fmi2::describe;
use scene::Scene;
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

/// Packs both FMUs for no scene into `folder`, with the program's scenes, where their content differs from what is there.
///
/// # Errors
/// What is missing, or a file that cannot be written.
pub fn pack(folder: &Path) -> Result<Vec<Packed>, Error> {
    let scenes = scene_files(&scenes_folder()?)?.into_iter().map(|(name, content)| (format!("scenes/{name}"), content));
    let interface = Interface::of_resources(None)
        .map_err(|error| Error::Description { model: DEFAULT_SCENE.to_string(), reason: error.to_string() })?;
    write_all(folder, archives(&interface, &Parts::BOTH, &scenes.collect::<Vec<_>>())?)
}

/// Packs the FMUs that a scene has into `folder`, with its variables and the scene itself.
///
/// # Errors
/// What is missing, or a file that cannot be written.
pub fn pack_scene(folder: &Path, scene: &Scene) -> Result<Vec<Packed>, Error> {
    let text = toml::to_string(scene).map_err(|error| Error::file(folder, error))?;
    let interface = Interface::of(scene);
    let resources = vec![interface_file(&interface), (OWN_SCENE.to_string(), text.into_bytes())];
    let parts = Parts { fluid: scene.fluid.is_some(), structure: !scene.body.is_empty() };
    write_all(folder, archives(&interface, &parts, &resources)?)
}

/// Packs both FMUs with an interface for a run, whose scene is a file.
///
/// # Errors
/// What is missing, or a file that cannot be written.
pub fn pack_interface(folder: &Path, interface: &Interface) -> Result<Vec<Packed>, Error> {
    write_all(folder, archives(interface, &Parts::BOTH, &[interface_file(interface)])?)
}

fn write_all(folder: &Path, archives: Vec<(String, Vec<u8>)>) -> Result<Vec<Packed>, Error> {
    std::fs::create_dir_all(folder).map_err(|error| Error::file(folder, error))?;
    archives.iter().map(|(name, bytes)| write(&folder.join(name), bytes)).collect()
}

/// The resource in which an FMU finds its interface.
fn interface_file(interface: &Interface) -> (String, Vec<u8>) {
    (INTERFACE_FILE.to_string(), interface.to_text().into_bytes())
}

/// Which FMUs there are to pack.
struct Parts {
    fluid: bool,
    structure: bool,
}

impl Parts {
    const BOTH: Self = Self { fluid: true, structure: true };
}

/// Names and contents of the FMUs, with these resources.
fn archives(
    interface: &Interface,
    parts: &Parts,
    resources: &[(String, Vec<u8>)],
) -> Result<Vec<(String, Vec<u8>)>, Error> {
    let mut packed = Vec::new();
    if parts.fluid {
        let model = FluidComponent::model(interface);
        packed.push(("fluid.fmu".to_string(), archive(&model, "fluid_fmu", documentation::FLUID, resources)?));
    }
    if parts.structure {
        let model = StructureComponent::model(interface);
        packed.push((
            "structure.fmu".to_string(),
            archive(&model, "structure_fmu", documentation::STRUCTURE, resources)?,
        ));
    }
    Ok(packed)
}

/// Name and kind (`input` or `output`) of the real variables that can be connected of an FMU of this program.
fn reals(name: &str, interface: &Interface) -> Vec<(String, &'static str)> {
    fn list<C>(model: &Model<C>) -> Vec<(String, &'static str)> {
        let real = |variable: &&fmi::Variable<C>| matches!(variable.access, fmi::Access::Real { .. });
        let connectable = model.variables.iter().filter(real).filter_map(|variable| match variable.causality {
            fmi::Causality::Input => Some((variable.name.clone(), "input")),
            fmi::Causality::Output => Some((variable.name.clone(), "output")),
            fmi::Causality::Parameter => None,
        });
        connectable.collect()
    }
    match name {
        crate::scene_case::FLUID => list(&FluidComponent::model(interface)),
        _ => list(&StructureComponent::model(interface)),
    }
}

/// The bytes of an FMU: description, binary, resources, documentation and licences.
fn archive<C: Component>(
    model: &Model<C>,
    library_name: &str,
    equations: &str,
    resources: &[(String, Vec<u8>)],
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
    entries.extend(resources.iter().map(|(name, content)| (format!("resources/{name}"), content.clone())));
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
        let model = FluidComponent::model(&Interface::of_resources(None).unwrap());
        let page = documentation::page(&model, documentation::FLUID);
        assert!(model.variables.iter().all(|variable| page.contains(&variable.name)));
        assert!(page.contains("N/m") && !page.contains("<td></td><td></td><td></td>"));
    }
}
