//! Unpacks an FMU into a temporary directory that is removed with the value.

use super::Error;
use super::unpacked::Unpacked;
use crate::case::Limits;
use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use std::io::Read;
use std::path::{Path, PathBuf};
use zip::read::ZipFile;

/// Characters that a path may not carry unescaped in a URI (RFC 3986, section 3.3), `/` excepted.
const IN_PATH: &AsciiSet = &CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'[')
    .add(b'\\')
    .add(b']')
    .add(b'^')
    .add(b'`')
    .add(b'{')
    .add(b'|')
    .add(b'}');

/// FMI 2.0 name of the platform this program runs on.
#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
pub const PLATFORM: &str = "linux64";
/// FMI 2.0 name of the platform this program runs on.
#[cfg(all(target_os = "macos", target_pointer_width = "64"))]
pub const PLATFORM: &str = "darwin64";
/// FMI 2.0 name of the platform this program runs on.
#[cfg(all(target_os = "windows", target_pointer_width = "64"))]
pub const PLATFORM: &str = "win64";

/// An unpacked FMU.
#[derive(Debug)]
pub struct Archive {
    /// Path of the .fmu, for messages.
    pub path: String,
    directory: Unpacked,
}

impl Archive {
    /// Unpacks the file at `path`, which may come from anywhere: what is no file, holds links or paths that lead out of the
    /// archive, or takes more than `limits` allow is refused.
    pub fn unpack(path: &Path, limits: &Limits) -> Result<Self, Error> {
        let name = path.display().to_string();
        let refuse = |reason: String| Error::Archive { path: name.clone(), reason };
        scene::check_file(path).map_err(|reason| refuse(format!("it cannot be opened: {reason}")))?;
        let cannot = |error: std::io::Error| refuse(format!("it cannot be opened: {error}"));
        let size = path.metadata().map_err(cannot)?.len();
        let file = std::fs::File::open(path).map_err(cannot)?;
        let mut zip = zip::ZipArchive::new(file).map_err(|error| refuse(error.to_string()))?;
        let count = zip.len() as u64;
        if count > limits.entries {
            return Err(refuse(format!("{count} entries, expected at most limits.entries = {}", limits.entries)));
        }
        let place = std::env::temp_dir();
        let directory = Unpacked::new()
            .map_err(|error| refuse(format!("no folder for it can be made in {}: {error}", place.display())))?;
        let mut room = Room::new(size, limits);
        for index in 0..zip.len() {
            let mut entry = zip.by_index(index).map_err(|error| refuse(error.to_string()))?;
            unpack_entry(&mut entry, directory.path(), &mut room).map_err(refuse)?;
        }
        Ok(Self { path: name, directory })
    }

    /// Text of modelDescription.xml.
    pub fn description(&self) -> Result<String, Error> {
        let file = self.directory.path().join("modelDescription.xml");
        std::fs::read_to_string(file).map_err(|error| Error::Description {
            path: self.path.clone(),
            reason: format!("it cannot be read: {error}"),
        })
    }

    /// The shared library of this platform.
    pub fn binary(&self, model_identifier: &str) -> Result<PathBuf, Error> {
        let file = format!("{model_identifier}.{}", std::env::consts::DLL_EXTENSION);
        let binaries = self.directory.path().join("binaries");
        let binary = binaries.join(PLATFORM).join(&file);
        if binary.is_file() {
            return Ok(binary);
        }
        let mut found: Vec<String> = std::fs::read_dir(binaries)
            .map(|entries| entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect())
            .unwrap_or_default();
        found.sort();
        Err(Error::Platform {
            path: self.path.clone(),
            platform: PLATFORM.to_string(),
            expected: format!("binaries/{PLATFORM}/{file}"),
            found: if found.is_empty() { "no binaries".to_string() } else { found.join(", ") },
        })
    }

    /// URI of the resources folder, percent-encoded.
    pub fn resource_location(&self) -> String {
        file_uri(&self.directory.path().join("resources"))
    }
}

/// How much more may be unpacked.
struct Room {
    left: u64,
    /// What is exceeded when nothing is left.
    limit: String,
}

impl Room {
    /// For an archive of this size \[bytes\].
    fn new(size: u64, limits: &Limits) -> Self {
        let by_ratio = limits.unpacked_ratio * size as f64;
        if by_ratio < limits.unpacked_bytes as f64 {
            let limit = format!("{size} bytes times limits.unpacked_ratio = {}", limits.unpacked_ratio);
            return Self { left: by_ratio as u64, limit };
        }
        let limit = format!("limits.unpacked_bytes = {}", limits.unpacked_bytes);
        Self { left: limits.unpacked_bytes, limit }
    }
}

/// Unpacks one entry below `folder`. What the archive says of its size is not relied on.
fn unpack_entry<R: Read>(entry: &mut ZipFile<R>, folder: &Path, room: &mut Room) -> Result<(), String> {
    let name = entry.name().map_err(|error| error.to_string())?.into_owned();
    let wrong = |reason: &dyn std::fmt::Display| format!("'{name}': {reason}");
    let inside = entry.enclosed_name().ok_or_else(|| wrong(&"leads out of the archive"))?;
    if entry.is_symlink() {
        return Err(wrong(&"is a link, expected files and folders only"));
    }
    let path = folder.join(inside);
    if entry.is_dir() {
        return std::fs::create_dir_all(path).map_err(|error| wrong(&error));
    }
    if let Some(above) = path.parent() {
        std::fs::create_dir_all(above).map_err(|error| wrong(&error))?;
    }
    let mode = entry.unix_mode();
    let mut file = std::fs::File::create_new(&path).map_err(|error| wrong(&error))?;
    let written = std::io::copy(&mut entry.take(room.left + 1), &mut file).map_err(|error| wrong(&error))?;
    room.left = room.left.checked_sub(written).ok_or_else(|| format!("unpacks to more than {}", room.limit))?;
    allow_to_run(&file, mode).map_err(|error| wrong(&error))
}

/// Programs among the resources stay programs.
#[cfg(unix)]
fn allow_to_run(file: &std::fs::File, mode: Option<u32>) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    let Some(0o100..) = mode.map(|mode| mode & 0o100) else { return Ok(()) };
    file.set_permissions(std::fs::Permissions::from_mode(0o700))
}

/// Programs among the resources stay programs.
#[cfg(not(unix))]
fn allow_to_run(_file: &std::fs::File, _mode: Option<u32>) -> std::io::Result<()> {
    Ok(())
}

/// The file URI of an absolute path.
pub fn file_uri(path: &Path) -> String {
    let text = path.to_string_lossy().replace('\\', "/");
    let slash = if text.starts_with('/') { "" } else { "/" };
    format!("file://{slash}{}", utf8_percent_encode(&text, IN_PATH))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn uri_encodes_what_a_path_may_not_carry() {
        // RFC 3986: space %20, percent %25, hash %23, non-ASCII as UTF-8 bytes.
        let uri = file_uri(Path::new("/tmp/a b/50%#\u{e4}/resources"));
        assert_eq!(uri, "file:///tmp/a%20b/50%25%23%C3%A4/resources");
    }

    #[test]
    fn missing_file_and_wrong_file_name_the_path() {
        let unpack = |path: &Path| Archive::unpack(path, &Limits::default());
        let missing = unpack(Path::new("/nowhere/x.fmu")).unwrap_err().to_string();
        assert!(missing.starts_with("/nowhere/x.fmu: cannot unpack"), "{missing}");
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("text.fmu");
        std::fs::write(&file, "not a zip").unwrap();
        assert!(unpack(&file).unwrap_err().to_string().contains("text.fmu"));
    }

    /// An archive of files of zeros with these names and sizes.
    fn zeros(path: &Path, entries: &[(&str, usize)]) {
        let mut archive = zip::ZipWriter::new(std::fs::File::create(path).unwrap());
        for (name, size) in entries {
            archive.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
            archive.write_all(&vec![0; *size]).unwrap();
        }
        archive.finish().unwrap();
    }

    #[test]
    fn what_unpacks_to_more_than_allowed_is_refused() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.fmu");
        zeros(&path, &[("a", 40_000), ("b", 40_000)]);
        let plain = Limits { unpacked_ratio: 1e9, ..Limits::default() };
        assert!(Archive::unpack(&path, &plain).is_ok());
        let refused = |limits: Limits| Archive::unpack(&path, &limits).unwrap_err().to_string();
        let size = path.metadata().unwrap().len();
        let ratio = refused(Limits::default());
        let expected = format!("unpacks to more than {size} bytes times limits.unpacked_ratio = 200");
        assert!(ratio.contains(&expected), "{ratio}");
        let bytes = refused(Limits { unpacked_bytes: 79_999, ..plain.clone() });
        assert!(bytes.contains("more than limits.unpacked_bytes = 79999"), "{bytes}");
        assert!(Archive::unpack(&path, &Limits { unpacked_bytes: 80_000, ..plain.clone() }).is_ok());
        let entries = refused(Limits { entries: 1, ..plain });
        assert!(entries.contains("2 entries, expected at most limits.entries = 1"), "{entries}");
    }

    #[test]
    fn links_and_paths_that_lead_out_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.fmu");
        zeros(&path, &[("../outside", 1)]);
        let message = Archive::unpack(&path, &Limits::default()).unwrap_err().to_string();
        assert!(message.contains("'../outside'") && !directory.path().join("outside").exists(), "{message}");
        let mut archive = zip::ZipWriter::new(std::fs::File::create(&path).unwrap());
        archive.add_symlink("binaries", "/usr/lib", zip::write::SimpleFileOptions::default()).unwrap();
        archive.finish().unwrap();
        let message = Archive::unpack(&path, &Limits::default()).unwrap_err().to_string();
        assert!(message.contains("'binaries': is a link"), "{message}");
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_and_a_device_are_no_archives() {
        let directory = tempfile::tempdir().unwrap();
        let pipe = directory.path().join("pipe.fmu");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let refused = |path: &Path| Archive::unpack(path, &Limits::default()).unwrap_err().to_string();
        assert!(refused(&pipe).contains("is a named pipe, expected a file"));
        assert!(refused(Path::new("/dev/zero")).contains("is a device, expected a file"));
    }
}
