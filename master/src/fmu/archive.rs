//! Unpacks an FMU into a temporary directory that is removed with the value.

use super::Error;
use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use std::path::{Path, PathBuf};

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
    directory: tempfile::TempDir,
}

impl Archive {
    /// Unpacks the file at `path`; entries that point outside the archive are refused by the zip reader.
    pub fn unpack(path: &Path) -> Result<Self, Error> {
        let name = path.display().to_string();
        let refuse = |reason: String| Error::Archive { path: name.clone(), reason };
        let file = std::fs::File::open(path).map_err(|error| refuse(error.to_string()))?;
        let mut zip = zip::ZipArchive::new(file).map_err(|error| refuse(error.to_string()))?;
        let directory = tempfile::TempDir::new().map_err(|error| refuse(error.to_string()))?;
        zip.extract(directory.path()).map_err(|error| refuse(error.to_string()))?;
        Ok(Self { path: name, directory })
    }

    /// Text of modelDescription.xml.
    pub fn description(&self) -> Result<String, Error> {
        let file = self.directory.path().join("modelDescription.xml");
        std::fs::read_to_string(file)
            .map_err(|error| Error::Description { path: self.path.clone(), reason: error.to_string() })
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

/// The file URI of an absolute path.
pub fn file_uri(path: &Path) -> String {
    let text = path.to_string_lossy().replace('\\', "/");
    let slash = if text.starts_with('/') { "" } else { "/" };
    format!("file://{slash}{}", utf8_percent_encode(&text, IN_PATH))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uri_encodes_what_a_path_may_not_carry() {
        // RFC 3986: space %20, percent %25, hash %23, non-ASCII as UTF-8 bytes.
        let uri = file_uri(Path::new("/tmp/a b/50%#\u{e4}/resources"));
        assert_eq!(uri, "file:///tmp/a%20b/50%25%23%C3%A4/resources");
    }

    #[test]
    fn missing_file_and_wrong_file_name_the_path() {
        let missing = Archive::unpack(Path::new("/nowhere/x.fmu")).unwrap_err().to_string();
        assert!(missing.starts_with("/nowhere/x.fmu: cannot unpack"), "{missing}");
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("text.fmu");
        std::fs::write(&file, "not a zip").unwrap();
        assert!(Archive::unpack(&file).unwrap_err().to_string().contains("text.fmu"));
    }
}
