//! Where the build leaves shared libraries, and where scenes are.

use super::Error;
use components::{FluidComponent, Interface};
use fmi::Component;
use fmi2::describe;
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::{Path, PathBuf};
use std::time::Duration;

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

/// Where a run finds FMUs with this interface, or packs them: beside the program, or with its results where an installed
/// program cannot write beside itself.
///
/// # Errors
/// An interface that makes no description.
pub fn fmus_folder(interface: &Interface, results: &Path) -> Result<PathBuf, Error> {
    let guid = describe::guid(&FluidComponent::model(interface));
    let guid = guid.map_err(|failure| Error::Description { model: "fluid".to_string(), reason: failure.message })?;
    // Eight digits of it are short enough for a path and tell what a folder ever sees apart.
    let name = format!("fmus-{}", &guid.simple().to_string()[..8]);
    let beside = program_folder().join(&name);
    let writable = std::fs::create_dir_all(&beside).is_ok() && tempfile::tempfile_in(&beside).is_ok();
    if !writable {
        return Ok(results.join(name));
    }
    forget_old(&program_folder(), &beside);
    Ok(beside)
}

/// Time after which FMUs that no run asked for are packed again when one does.
const KEPT: Duration = Duration::from_hours(24);

/// Notes that `used` is in use, and removes folders of FMUs that were not for long: every interface has one, and a study may
/// have many.
fn forget_old(folder: &Path, used: &Path) {
    let stamp = |folder: &Path| folder.join("used");
    // Where it cannot be noted or removed nothing is lost but room.
    let _ = std::fs::write(stamp(used), "");
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    let is_ours = |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("fmus-"));
    for path in entries.flatten().map(|entry| entry.path()).filter(is_ours) {
        let age = std::fs::metadata(stamp(&path)).and_then(|data| data.modified()).map(|time| time.elapsed());
        if age.is_ok_and(|age| age.is_ok_and(|age| age > KEPT)) {
            let _ = std::fs::remove_dir_all(&path);
        }
    }
}

/// The nearest folder `scenes` in or above the working directory, else in or above the program's folder.
pub fn scenes_folder() -> Result<PathBuf, Error> {
    let work = std::env::current_dir().unwrap_or_default();
    let program = program_folder();
    let above = |start: &Path| start.ancestors().map(|folder| folder.join("scenes")).find(|folder| folder.is_dir());
    above(&work).or_else(|| above(&program)).ok_or_else(|| Error::NoScenes(work.display().to_string()))
}

/// Names and contents of the scenes of a folder and of the reference curves in its folder `reference`, sorted.
pub fn scene_files(folder: &Path) -> Result<Vec<(String, Vec<u8>)>, Error> {
    let mut paths = files_with(folder, "toml")?;
    let references = folder.join("reference");
    if references.is_dir() {
        paths.extend(files_with(&references, "csv")?);
    }
    let read = |path: &PathBuf| {
        let content = std::fs::read(path).map_err(|error| Error::file(path, error))?;
        let name = path.strip_prefix(folder).unwrap_or(path).components();
        let name: Vec<_> = name.map(|part| part.as_os_str().to_string_lossy()).collect();
        Ok((name.join("/"), content))
    };
    paths.iter().map(read).collect()
}

/// Files of a folder with this extension, sorted.
pub fn files_with(folder: &Path, extension: &str) -> Result<Vec<PathBuf>, Error> {
    let entries = std::fs::read_dir(folder).map_err(|error| Error::file(folder, error))?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|found| found == extension));
    paths.sort();
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fmus_that_were_not_used_for_long_are_forgotten() {
        let folder = tempfile::tempdir().unwrap();
        let make = |name: &str, days: u64| {
            let path = folder.path().join(name);
            std::fs::create_dir(&path).unwrap();
            let file = std::fs::File::create(path.join("used")).unwrap();
            file.set_modified(std::time::SystemTime::now() - Duration::from_hours(24 * days)).unwrap();
            path
        };
        let (old, recent, other) = (make("fmus-1", 2), make("fmus-2", 0), make("results", 9));
        let used = make("fmus-3", 5);
        forget_old(folder.path(), &used);
        assert_eq!([&old, &recent, &other, &used].map(|path| path.is_dir()), [false, true, true, true]);
    }

    #[test]
    fn scenes_come_with_the_curves_that_their_checks_name() {
        let files = scene_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes")).unwrap();
        let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        assert!(names.contains(&"hydrostatic.toml"), "{names:?}");
        for (name, content) in files.iter().filter(|(name, _)| name.ends_with(".toml")) {
            let scene = scene::Scene::from_str(std::str::from_utf8(content).unwrap(), name).unwrap();
            let missing = scene.check.iter().find(|check| !check.file.is_empty() && !names.contains(&&*check.file));
            assert!(missing.is_none(), "{name}: {missing:?} is not among {names:?}");
        }
    }
}
