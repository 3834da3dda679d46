//! Places that no run can have for its own.

use crate::record::Error;
use std::path::Path;

/// Refuses the root of a file system, the home folder, and whatever lies above it or above the working directory.
pub(super) fn check(path: &Path) -> Result<(), Error> {
    // What does not exist yet is none of them.
    let Ok(real) = path.canonicalize() else { return Ok(()) };
    let refuse = |what: &str| {
        Err(Error::new(
            path,
            format!("is {what}, expected a folder for the results of one run, for example results/NAME"),
        ))
    };
    if real.parent().is_none() {
        return refuse("the root of the file system");
    }
    let (work, home) = (std::env::current_dir().ok(), std::env::home_dir());
    let real_of = |folder: Option<std::path::PathBuf>| folder.and_then(|folder| folder.canonicalize().ok());
    if let Some(home) = real_of(home)
        && home.starts_with(&real)
    {
        return refuse(if home == real { "the home folder" } else { "above the home folder" });
    }
    if real_of(work).is_some_and(|work| work != real && work.starts_with(&real)) {
        return refuse("above the working directory");
    }
    Ok(())
}
