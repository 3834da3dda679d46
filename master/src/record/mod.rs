//! What a run writes while it goes: tables of results and iterations.

mod interval;
mod iterations;
mod results;

pub use iterations::{IterationCounts, IterationWriter};
pub use report::record::*;
pub use results::{Choice, Grid, ResultMark, ResultWriter, STAGE, recorded};

use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

/// Opens a table for what follows its first `bytes`; the rest is cut off.
fn reopen(path: &Path, bytes: u64) -> Result<File, Error> {
    let wrong = |error: std::io::Error| Error::new(path, error);
    let mut file = OpenOptions::new().read(true).write(true).open(path).map_err(wrong)?;
    let got = length(&file, path)?;
    if got < bytes {
        return Err(Error::new(path, format!("{got} bytes, expected at least the {bytes} of the checkpoint")));
    }
    file.set_len(bytes).and_then(|()| file.seek(SeekFrom::Start(bytes))).map_err(wrong)?;
    Ok(file)
}

/// Writes a row at once, past any buffer: a run that was cut off leaves whole rows, whoever ended it, and so does one
/// that fills its disk.
fn write_row(file: &mut File, row: &str) -> std::io::Result<()> {
    let start = file.stream_position()?;
    let written = file.write_all(format!("{row}\n").as_bytes());
    if written.is_err() {
        // Half a row would only trouble whoever reads the table of a failed run.
        let _ = file.set_len(start).and_then(|()| file.seek(SeekFrom::Start(start)));
    }
    written
}

/// Bytes of a table, once all of them are on the disk: a checkpoint that counts them must not outlast them.
fn settled(file: &File, path: &Path) -> Result<u64, Error> {
    file.sync_data().map_err(|error| Error::new(path, error))?;
    length(file, path)
}

fn length(file: &File, path: &Path) -> Result<u64, Error> {
    file.metadata().map(|data| data.len()).map_err(|error| Error::new(path, error))
}
