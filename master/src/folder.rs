//! The folder of a run: what may stand in it, what a new run removes there, and the lock that keeps two runs apart.
//!
//! `run.json` lists every file of a run before it is written. A folder that holds anything else is refused, and nothing
//! else is ever removed.

mod lock;
mod names;
mod place;

use crate::record::{Error, RECIPE, Recipe, Status, Summary};
use lock::Lock;
use std::path::{Path, PathBuf};

pub use names::{plots, tables};

/// Summary in a run's folder.
const SUMMARY: &str = "summary.json";

/// What to do with a run that stands in the folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Wish {
    /// Go on with it, or finish what a kill cut off.
    pub resume: bool,
    /// Replace it, also when it is complete.
    pub overwrite: bool,
}

/// A folder that belongs to this process until the value is dropped.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    lock: Lock,
    /// The run that stands there.
    recipe: Option<Recipe>,
}

impl RunFolder {
    /// Makes the folder where it is missing and takes hold of it.
    ///
    /// # Errors
    /// A place that no run can have for its own, a folder in which another run is at work, one that holds a file that no
    /// run wrote, or one that cannot be read or made.
    pub fn open(path: &Path) -> Result<Self, Error> {
        place::check(path)?;
        std::fs::create_dir_all(path).map_err(|error| Error::new(path, error))?;
        // Before the lock is made: a folder that is refused stays as it is.
        names::check(path, Recipe::read(path)?.as_ref())?;
        let lock = Lock::take(path)?;
        let recipe = Recipe::read(path)?;
        names::check(path, recipe.as_ref())?;
        Ok(Self { path: path.to_path_buf(), lock, recipe })
    }

    /// What a user should know of it: the run before was killed, or the file system knows no locks.
    pub fn note(&self) -> Option<&str> {
        self.lock.note.as_deref()
    }

    /// The run that stands there, or stood there until [`RunFolder::clear`].
    pub fn recipe(&self) -> Option<&Recipe> {
        self.recipe.as_ref()
    }

    /// Refuses to lose a complete run.
    ///
    /// # Errors
    /// A complete run, unless it is to be overwritten; one whose report was cut off may also be resumed.
    pub fn allow(&self, wish: Wish) -> Result<(), Error> {
        let whole = self.recipe.as_ref().is_some_and(Recipe::is_whole);
        let computed = || Summary::read(&self.path.join(SUMMARY)).is_ok_and(|it| it.status == Status::Complete);
        let reason = match wish {
            Wish { overwrite: true, .. } => return Ok(()),
            Wish { resume: true, .. } if whole => {
                "holds a complete run of other inputs, and no checkpoint to go on from; --overwrite replaces it, --out \
                 FOLDER writes elsewhere"
            }
            Wish { resume: true, .. } => return Ok(()),
            _ if whole => "holds a complete run; --overwrite replaces it, --out FOLDER writes elsewhere",
            _ if computed() => {
                "holds a run that reached its end, but not its report; --resume finishes it, --overwrite replaces it, --out \
                 FOLDER writes elsewhere"
            }
            _ => return Ok(()),
        };
        Err(Error::new(&self.path, reason))
    }

    /// Removes the files that the list of the run there names.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn clear(&self) -> Result<(), Error> {
        let Some(recipe) = &self.recipe else { return Ok(()) };
        // A run that is cut off here must pass neither for complete nor for one to go on with.
        for name in [SUMMARY, crate::checkpoint::FILE_NAME] {
            if recipe.files.iter().any(|listed| listed == name) {
                remove(&self.path.join(name))?;
            }
        }
        for file in names::files(&self.path)? {
            // The list goes last, replaced by that of the next run.
            if file != RECIPE && names::is_listed(&file, &recipe.files) {
                remove(&self.path.join(&file))?;
            }
        }
        for folder in names::folders(&recipe.files) {
            // What else may stand there keeps it.
            let _ = std::fs::remove_dir(self.path.join(folder));
        }
        Ok(())
    }
}

/// Clears away what a kill after the last byte of the report has left of a run that is complete: checkpoint and lock.
///
/// # Errors
/// Another process that is at work there, or a file that cannot be removed.
pub fn tidy(path: &Path) -> Result<(), Error> {
    let left = [lock::FILE_NAME, crate::checkpoint::FILE_NAME];
    if !left.iter().any(|name| path.join(name).exists()) {
        return Ok(());
    }
    // Removed with the value.
    let _lock = Lock::take(path)?;
    crate::checkpoint::remove(path)
}

fn remove(path: &Path) -> Result<(), Error> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Error::new(path, error)),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;
