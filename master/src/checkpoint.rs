//! Checkpoints: a file from which a run goes on with the same bits as if it had never stopped.

use crate::record::{Error, IterationCounts, ResultMark};
use crate::stages::Stages;
use crate::watch;
use coupling::Memory;
use frames::write_lasting;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Name of the file in a run's folder.
pub const FILE_NAME: &str = "checkpoint.bin";
/// First bytes of the file; the last ones count its format.
const MAGIC: &[u8; 10] = b"PLIMSOLL-3";

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
        let length = (payload.len() as u64).to_le_bytes();
        write_lasting(path, &[&MAGIC[..], &length, &checksum, &payload].concat()).map_err(|error| wrong(&error))
    }

    /// Reads a file and refuses one that is damaged, of another program, or of other inputs.
    pub fn read(path: &Path, inputs: &str) -> Result<Self, Error> {
        let refuse = |reason: String| Error::new(path, reason);
        let bytes = std::fs::read(path).map_err(|error| refuse(format!("the checkpoint cannot be read: {error}")))?;
        let damaged = |reason: String| refuse(format!("{reason}; run without --resume to begin anew"));
        if !bytes.starts_with(MAGIC) && !MAGIC.starts_with(&bytes) {
            return Err(damaged("no checkpoint of this version".to_string()));
        }
        let (checksum, payload) = parts(&bytes).map_err(damaged)?;
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

/// Checksum and payload of a file that begins as a checkpoint does; the error says how much of it lacks.
fn parts(bytes: &[u8]) -> Result<(&[u8; 4], &[u8]), String> {
    let got = bytes.len();
    let short = |expected: String| format!("a truncated checkpoint: {got} bytes, expected {expected}");
    let header = MAGIC.len() + size_of::<u64>() + size_of::<u32>();
    let head = || short(format!("at least the {header} of its header"));
    let (length, rest) = bytes.get(MAGIC.len()..).and_then(<[u8]>::split_first_chunk::<8>).ok_or_else(head)?;
    let (checksum, payload) = rest.split_first_chunk::<4>().ok_or_else(head)?;
    let expected = u64::from_le_bytes(*length).saturating_add(header as u64);
    if (got as u64) < expected {
        return Err(short(expected.to_string()));
    }
    Ok((checksum, payload))
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
        assert!(refused(b"PLIMSOLL-2abcd").contains("no checkpoint of this version"));
        assert!(refused(b"").contains("a truncated checkpoint: 0 bytes, expected at least the 22 of its header"));
        assert!(refused(b"PLIMSOLL-3ab").contains("a truncated checkpoint: 12 bytes"));
        let with = |length: u64, rest: &[u8]| [&MAGIC[..], &length.to_le_bytes(), b"abcd", rest].concat();
        assert!(refused(&with(100, b"rest")).contains("a truncated checkpoint: 26 bytes, expected 122"));
        assert!(refused(&with(4, b"rest")).contains("the file is damaged"));
        let mut empty = [&MAGIC[..], &0_u64.to_le_bytes()].concat();
        empty.extend(crc32fast::hash(b"").to_le_bytes());
        assert!(refused(&empty).contains("begin anew"));
    }
}
