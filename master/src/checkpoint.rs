//! Checkpoints: a file from which a run goes on with the same bits as if it had never stopped.

use crate::coupling::Memory;
use crate::record::{Error, IterationCounts, ResultMark};
use crate::stages::Stages;
use crate::watch;
use components::frames::write_lasting;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Name of the file in a run's folder.
pub const FILE_NAME: &str = "checkpoint.bin";
/// First bytes of the file; the last ones count its format.
const MAGIC: &[u8; 10] = b"PLIMSOLL-2";

/// Everything that a run carries from step to step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Version of the program: another one need not give the same bits.
    pub program: String,
    /// The inputs of the run as text; a run goes on with the same ones only.
    pub inputs: String,
    /// States of the participants in their order.
    pub participants: Vec<Vec<u8>>,
    /// What the coupling carries on.
    pub memory: Memory,
    /// Where results.csv stands.
    pub results: ResultMark,
    /// Bytes of iterations.csv.
    pub iterations: u64,
    /// Iterations so far.
    pub counts: IterationCounts,
    /// Wall-clock time by stage so far.
    pub stages: Stages,
    /// Warnings so far.
    pub warnings: Vec<String>,
    /// What the watch carries on.
    pub watch: watch::Memory,
    /// Wall-clock time so far \[s\].
    pub wall: f64,
}

impl Checkpoint {
    /// Writes the file beside its place and renames it: what is there is always whole.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let wrong = |reason: &dyn ToString| Error::new(path, reason.to_string());
        let payload = postcard::to_stdvec(self).map_err(|error| wrong(&error))?;
        let checksum = crc32fast::hash(&payload).to_le_bytes();
        write_lasting(path, &[&MAGIC[..], &checksum, &payload].concat()).map_err(|error| wrong(&error))
    }

    /// Reads a file and refuses one that is damaged, of another program, or of other inputs.
    pub fn read(path: &Path, inputs: &str) -> Result<Self, Error> {
        let refuse = |reason: String| Error::new(path, reason);
        let bytes = std::fs::read(path).map_err(|error| refuse(error.to_string()))?;
        let rest = bytes.strip_prefix(MAGIC).ok_or_else(|| {
            refuse("no checkpoint of this version: delete it, or run without --resume to begin anew".to_string())
        })?;
        let damaged = |reason: String| refuse(format!("{reason}; run without --resume to begin anew"));
        let (checksum, payload) =
            rest.split_first_chunk::<4>().ok_or_else(|| damaged(format!("{} bytes only", bytes.len())))?;
        let (expected, got) = (u32::from_le_bytes(*checksum), crc32fast::hash(payload));
        if expected != got {
            return Err(damaged(format!("checksum {got:08x}, expected {expected:08x}: the file is damaged")));
        }
        let checkpoint: Self = postcard::from_bytes(payload).map_err(|error| damaged(error.to_string()))?;
        if checkpoint.program != env!("CARGO_PKG_VERSION") {
            let (got, expected) = (&checkpoint.program, env!("CARGO_PKG_VERSION"));
            return Err(damaged(format!("written by version {got}, this is {expected}")));
        }
        match difference(&checkpoint.inputs, inputs) {
            None => Ok(checkpoint),
            Some(line) => Err(damaged(format!("the run was begun with other inputs: {line}"))),
        }
    }
}

/// Removes the checkpoint of a run that is complete.
///
/// # Errors
/// A file that cannot be removed.
pub fn remove(folder: &Path) -> Result<(), Error> {
    let path = folder.join(FILE_NAME);
    // A directory of that name is told when the checkpoint is written.
    if !path.is_file() {
        return Ok(());
    }
    std::fs::remove_file(&path).map_err(|error| Error::new(&path, error))
}

/// The first line in which two texts differ.
fn difference(before: &str, now: &str) -> Option<String> {
    if before == now {
        return None;
    }
    let (mut old, mut new) = (before.lines(), now.lines());
    loop {
        let (before, now) = (old.next(), new.next());
        if before != now || before.is_none() {
            return Some(format!("`{}` then, `{}` now", before.unwrap_or(""), now.unwrap_or("")));
        }
    }
}

/// Where and how often checkpoints are written.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// The file.
    pub path: PathBuf,
    /// Wall-clock time between checkpoints \[s\]; 0 writes none.
    pub interval: f64,
    /// The inputs of the run as text.
    pub inputs: String,
    last: Instant,
}

impl Schedule {
    /// Checkpoints of a run with these inputs into `folder`.
    pub fn new(folder: &Path, interval: f64, inputs: String) -> Self {
        Self { path: folder.join(FILE_NAME), interval, inputs, last: Instant::now() }
    }

    /// No checkpoints.
    pub fn never() -> Self {
        Self::new(Path::new(""), 0.0, String::new())
    }

    /// Whether the interval has passed.
    pub fn due(&self) -> bool {
        self.interval > 0.0 && self.last.elapsed() >= Duration::from_secs_f64(self.interval)
    }

    /// The interval begins anew.
    pub fn done(&mut self) {
        self.last = Instant::now();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_line_that_differs_is_named() {
        assert_eq!(difference("a\nb", "a\nb"), None);
        assert_eq!(difference("a\nb = 1", "a\nb = 2"), Some("`b = 1` then, `b = 2` now".to_string()));
        assert_eq!(difference("a", "a\nb"), Some("`` then, `b` now".to_string()));
    }

    #[test]
    fn what_is_no_checkpoint_is_refused_with_the_reason() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(FILE_NAME);
        let refused = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            Checkpoint::read(&path, "").unwrap_err().to_string()
        };
        assert!(refused(b"").contains("no checkpoint of this version"));
        assert!(refused(b"PLIMSOLL-2ab").contains("12 bytes only"));
        assert!(refused(b"PLIMSOLL-2abcdrest").contains("the file is damaged"));
        let mut empty = MAGIC.to_vec();
        empty.extend(crc32fast::hash(b"").to_le_bytes());
        assert!(refused(&empty).contains("begin anew"));
    }
}
