//! Where the build leaves shared libraries, and where scenes are.

use super::Error;
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::{Path, PathBuf};

/// The shared library of a crate: in `deps` beside the program, where cargo builds dependencies, or beside the
/// program itself, where an installation may put it.
pub fn library(name: &str) -> Result<PathBuf, Error> {
    let file = format!("{DLL_PREFIX}{name}{DLL_SUFFIX}");
    let here = program_folder();
    // A test program lies in `deps` itself.
    let folders = [here.join("deps"), here];
    let found = folders.iter().map(|folder| folder.join(&file)).find(|path| path.is_file());
    found.ok_or_else(|| Error::NoLibrary {
        file,
        looked: folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>().join(", "),
    })
}

/// The folder of this program.
pub fn program_folder() -> PathBuf {
    let program = std::env::current_exe().unwrap_or_default();
    program.parent().map_or_else(PathBuf::new, Path::to_path_buf)
}

/// The nearest folder `scenes` in or above the working directory, else in or above the program's folder.
pub fn scenes_folder() -> Result<PathBuf, Error> {
    let work = std::env::current_dir().unwrap_or_default();
    let program = program_folder();
    let above = |start: &Path| start.ancestors().map(|folder| folder.join("scenes")).find(|folder| folder.is_dir());
    above(&work).or_else(|| above(&program)).ok_or_else(|| Error::NoScenes(work.display().to_string()))
}

/// Names and contents of the scenes of a folder and of the reference files below it, sorted.
pub fn scene_files(folder: &Path) -> Result<Vec<(String, Vec<u8>)>, Error> {
    let mut files = Vec::new();
    for path in files_with(folder, "toml")? {
        let content = std::fs::read(&path).map_err(|error| Error::file(&path, error))?;
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        files.push((name, content));
    }
    Ok(files)
}

/// Files of a folder with this extension, sorted.
pub fn files_with(folder: &Path, extension: &str) -> Result<Vec<PathBuf>, Error> {
    let entries = std::fs::read_dir(folder).map_err(|error| Error::file(folder, error))?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|found| found == extension));
    paths.sort();
    Ok(paths)
}
