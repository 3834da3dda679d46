//! Temporary folders for unpacked FMUs. Each holds a lock that the system lets go of when its process ends, so that the next
//! start finds and removes what a killed run has left.

use std::fs::{File, Metadata};
use std::path::{Path, PathBuf};

/// How the names of these folders begin.
const PREFIX: &str = "plimsoll-fmu-";
/// How they begin as long as they are not locked.
const NEW: &str = "plimsoll-new-";
/// The lock in each of them.
const LOCK: &str = "lock";
/// Age at which a folder that is not locked yet counts as left behind \[s\].
const OLD: u64 = 600;

/// A temporary folder, removed with the value.
#[derive(Debug)]
pub(super) struct Unpacked {
    path: PathBuf,
    _lock: File,
}

impl Unpacked {
    /// A new folder; removes those of processes that have ended.
    pub fn new() -> std::io::Result<Self> {
        Self::within(&std::env::temp_dir())
    }

    fn within(temporary: &Path) -> std::io::Result<Self> {
        let told = |error: std::io::Error| {
            std::io::Error::new(error.kind(), format!("temporary folder {}: {error}", temporary.display()))
        };
        let new = tempfile::Builder::new().prefix(NEW).tempdir_in(temporary)?;
        let lock = File::create(new.path().join(LOCK)).map_err(told)?;
        // Where nothing can be locked, nothing is ever removed but by its own process.
        let _ = lock.try_lock();
        if let Ok(own) = new.path().metadata() {
            remove_left(temporary, &own);
        }
        let name = new.path().file_name().unwrap_or_default().to_string_lossy().replacen(NEW, PREFIX, 1);
        let path = temporary.join(name);
        std::fs::rename(new.path(), &path).map_err(told)?;
        // It is no longer there to be removed under its first name.
        let _ = new.keep();
        Ok(Self { path: path.canonicalize()?, _lock: lock })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Unpacked {
    fn drop(&mut self) {
        // What cannot be removed here is removed at the next start.
        let _ = std::fs::remove_dir_all(&self.path);
    }
}

/// Removes the folders of processes that have ended; `own` is one of this user's.
fn remove_left(temporary: &Path, own: &Metadata) {
    let Ok(entries) = std::fs::read_dir(temporary) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        // A link, or somebody else's folder, is none of ours whatever its name.
        let ours = entry.metadata().is_ok_and(|data| data.is_dir() && same_owner(&data, own));
        let left = match () {
            () if !ours => false,
            () if name.starts_with(PREFIX) => is_free(&entry.path().join(LOCK)),
            () => name.starts_with(NEW) && is_old(&entry.path()),
        };
        if left {
            let _ = std::fs::remove_dir_all(entry.path());
        }
    }
}

/// Whether nobody holds a lock.
fn is_free(lock: &Path) -> bool {
    File::open(lock).is_ok_and(|file| file.try_lock().is_ok())
}

fn is_old(folder: &Path) -> bool {
    let modified = folder.metadata().and_then(|data| data.modified());
    modified.is_ok_and(|time| time.elapsed().is_ok_and(|age| age.as_secs() > OLD))
}

#[cfg(unix)]
fn same_owner(one: &Metadata, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    one.uid() == other.uid()
}

#[cfg(not(unix))]
fn same_owner(_one: &Metadata, _other: &Metadata) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_of_the_dead_are_removed_and_those_of_the_living_stay() {
        let temporary = tempfile::tempdir().unwrap();
        let at = temporary.path();
        let living = Unpacked::within(at).unwrap();
        std::fs::write(living.path().join("a"), "").unwrap();
        let dead = at.join("plimsoll-fmu-dead");
        std::fs::create_dir(&dead).unwrap();
        std::fs::write(dead.join(LOCK), "").unwrap();
        std::fs::write(dead.join("library"), "").unwrap();
        let foreign = at.join("plimsoll-fmu-without-a-lock");
        std::fs::create_dir(&foreign).unwrap();
        let second = Unpacked::within(at).unwrap();
        assert!(!dead.exists(), "its process has ended");
        assert!(living.path().join("a").exists() && second.path().exists() && foreign.exists());
        drop((living, second));
        assert_eq!(std::fs::read_dir(at).unwrap().count(), 1, "only what is not ours is left");
    }
}
