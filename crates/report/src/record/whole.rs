//! Files that are there whole or not at all.

use super::Error;
use std::path::Path;

/// Writes a file beside its place and renames it.
///
/// # Errors
/// A file that cannot be written; then nothing is left of it, and an earlier file of that name stays.
pub fn write_whole(path: &Path, content: impl AsRef<[u8]>) -> Result<(), Error> {
    frames::write_whole(path, content.as_ref()).map_err(|error| Error::new(path, error))
}
