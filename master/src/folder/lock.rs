//! A lock file that keeps two runs out of one folder. The system lets go of it when its process ends, however that is.

use crate::record::Error;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};

/// Name of the file in a run's folder while the run is at work.
pub(super) const FILE_NAME: &str = "run.lock";
/// How often a lock is tried for that another process took away in the moment in which it was got.
const ATTEMPTS: usize = 100;

/// A lock that is held. Dropping it removes the file.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    _file: File,
    /// What a user should know.
    pub note: Option<String>,
}

impl Lock {
    /// Takes the lock of a folder.
    pub fn take(folder: &Path) -> Result<Self, Error> {
        let path = folder.join(FILE_NAME);
        let wrong = |error: std::io::Error| Error::new(&path, error);
        for _ in 0..ATTEMPTS {
            let open = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
            let mut file = open.map_err(wrong)?;
            let note = match file.try_lock() {
                Ok(()) => {
                    if !is_at(&file, &path) {
                        // Removed by its holder between our two calls.
                        continue;
                    }
                    stale(&mut file)
                }
                Err(TryLockError::WouldBlock) => return Err(taken(folder, &mut file)),
                Err(TryLockError::Error(error)) => Some(format!(
                    "{}: cannot be locked ({error}): two runs at once would spoil each other",
                    path.display()
                )),
            };
            // On a full disk the lock holds without its text.
            let _ = file.set_len(0).and_then(|()| file.rewind());
            let _ = file.write_all(format!("process {}\n", std::process::id()).as_bytes());
            return Ok(Self { path, _file: file, note });
        }
        Err(Error::new(&path, format!("taken away {ATTEMPTS} times in the moment it was locked")))
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // While it is locked still: whoever opens the file now finds that it is gone.
        let _ = std::fs::remove_file(&self.path);
    }
}

fn content(file: &mut File) -> String {
    let mut text = String::new();
    let _ = file.rewind().and_then(|()| file.read_to_string(&mut text));
    text.trim().to_string()
}

/// The lock of a process that has ended without taking its file away.
fn stale(file: &mut File) -> Option<String> {
    let holder = content(file);
    (!holder.is_empty()).then(|| format!("the run before in this folder ({holder}) was cut off before its end"))
}

fn taken(folder: &Path, file: &mut File) -> Error {
    let holder = content(file);
    let holder = if holder.is_empty() { "another process".to_string() } else { holder };
    Error::new(
        folder,
        format!("a run is at work there ({holder}): wait for its end, or choose another folder with --out"),
    )
}

/// Whether an open file is the one at a path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let same =
        |here: std::fs::Metadata, there: std::fs::Metadata| (here.dev(), here.ino()) == (there.dev(), there.ino());
    file.metadata().and_then(|here| Ok(same(here, path.metadata()?))).unwrap_or(false)
}

/// Whether an open file is the one at a path.
#[cfg(not(unix))]
fn is_at(_file: &File, path: &Path) -> bool {
    path.is_file()
}
