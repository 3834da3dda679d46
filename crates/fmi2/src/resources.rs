//! The resource location of fmi2Instantiate: a URI in theory, many things in practice.

use percent_encoding::percent_decode_str;
use std::path::PathBuf;

/// The folder that a resource location names. Takes `file:///a`, `file:////a`, `file:/a`, `file://localhost/a`, a bare
/// path, a trailing slash and percent-encoded characters; the text itself when it names an existing folder that
/// the decoded text does not. None for a scheme other than `file`.
pub fn folder(location: &str) -> Option<PathBuf> {
    let path = match location.split_once(':') {
        Some((scheme, rest)) if scheme.eq_ignore_ascii_case("file") => without_authority(rest),
        Some((scheme, _)) if scheme.len() > 1 && location.contains("://") => return None,
        _ => location.to_string(),
    };
    let decoded = PathBuf::from(percent_decode_str(&path).decode_utf8().ok()?.as_ref());
    let raw = PathBuf::from(&path);
    let chosen = if !decoded.is_dir() && raw.is_dir() { raw } else { decoded };
    // Components drop a trailing slash and doubled slashes.
    Some(chosen.components().collect())
}

fn without_authority(rest: &str) -> String {
    let path = match rest.strip_prefix("//") {
        // The authority reaches up to the next slash; it is empty or names this host.
        Some(after) => after.find('/').map_or("", |slash| &after[slash..]),
        None => rest,
    };
    let path = if path.starts_with('/') { format!("/{}", path.trim_start_matches('/')) } else { path.to_string() };
    // `/C:/folder` on Windows.
    match path.as_bytes() {
        [b'/', drive, b':', ..] if drive.is_ascii_alphabetic() => path[1..].to_string(),
        _ => path,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_that_importers_use() {
        for location in [
            "file:///tmp/a b/resources",
            "file:///tmp/a%20b/resources",
            "file:////tmp/a%20b/resources/",
            "file:/tmp/a%20b/resources",
            "file://localhost/tmp/a%20b/resources",
            "/tmp/a b/resources/",
        ] {
            assert_eq!(folder(location), Some(PathBuf::from("/tmp/a b/resources")), "{location}");
        }
        assert_eq!(folder("file:///C:/fmu/resources"), Some(PathBuf::from("C:/fmu/resources")));
        assert_eq!(folder("https://host/resources"), None);
    }
}
