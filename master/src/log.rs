//! Messages of the participants: all go to a file, warnings and errors also to the terminal. An error that is quoted in
//! what the program says itself is not told twice.

use crate::progress::Style;
use crate::record::Error;
use crate::tell;
use serde_json::json;
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Whether what is said on standard error is JSON.
static JSON: AtomicBool = AtomicBool::new(false);
/// Descriptor of the last log for the handlers of a crash, which can use nothing else; -1 before there is one.
static DESCRIPTOR: AtomicI32 = AtomicI32::new(-1);

/// Whether what is said on standard error is to be JSON.
pub fn speaks_json() -> bool {
    JSON.load(Ordering::Relaxed)
}

/// An open descriptor of the log.
pub fn descriptor() -> Option<i32> {
    Some(DESCRIPTOR.load(Ordering::Relaxed)).filter(|number| *number >= 0)
}

/// Severity of a message, as in the FMI status codes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// For the record.
    Information,
    /// Something a user should know.
    Warning,
    /// Something failed.
    Error,
}

impl Level {
    fn word(self) -> &'static str {
        match self {
            Self::Information => "information",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// Where messages go; clones share one destination.
#[derive(Debug, Clone, Default)]
pub struct Log {
    sink: Arc<Mutex<Sink>>,
}

#[derive(Debug, Default)]
struct Sink {
    file: Option<File>,
    terminal: Option<Style>,
    last_problem: Option<String>,
    /// The line of an error that may still be quoted.
    held: Option<String>,
}

impl Sink {
    fn tell_held(&mut self) {
        if let Some(line) = self.held.take() {
            tell!("{line}");
        }
    }
}

impl Drop for Sink {
    fn drop(&mut self) {
        self.tell_held();
    }
}

impl Log {
    /// Writes to a file at `path`, which is continued or made anew, and warnings and errors to the terminal in `style`.
    ///
    /// # Errors
    /// The file cannot be opened.
    pub fn to_file(path: &Path, style: Style, continued: bool) -> Result<Self, Error> {
        let file = if continued { File::options().append(true).create(true).open(path) } else { File::create(path) };
        let file = file.map_err(|error| Error::new(path, error))?;
        keep_descriptor(&file);
        Ok(Self::with(Some(file), style))
    }

    /// Writes warnings and errors to the terminal alone.
    pub fn to_terminal(style: Style) -> Self {
        Self::with(None, style)
    }

    fn with(file: Option<File>, style: Style) -> Self {
        JSON.store(style == Style::Json, Ordering::Relaxed);
        let sink = Sink { file, terminal: Some(style), last_problem: None, held: None };
        Self { sink: Arc::new(Mutex::new(sink)) }
    }

    /// Records one message of a participant.
    pub fn write(&self, participant: &str, level: Level, category: &str, text: &str) {
        let mut sink = self.sink.lock().unwrap_or_else(PoisonError::into_inner);
        let line = format!("{participant} [{}] {category}: {}", level.word(), text.trim_end());
        if let Some(file) = &mut sink.file {
            // A full disk must not end the run; the results writer reports it.
            let _ = writeln!(file, "{line}");
        }
        if level < Level::Warning {
            return;
        }
        sink.tell_held();
        sink.last_problem = Some(text.trim_end().to_string());
        let Some(style) = sink.terminal else { return };
        let event = json!({
            "event": "message", "participant": participant, "level": level.word(), "category": category,
            "text": text.trim_end(),
        });
        sink.held = Some(if style == Style::Json { event.to_string() } else { line });
        if level == Level::Warning {
            sink.tell_held();
        }
    }

    /// Keeps a warning of the master itself in the file; whoever calls has told it.
    pub fn note(&self, text: &str) {
        let mut sink = self.sink.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(file) = &mut sink.file {
            // As with messages of participants, a full disk must not end the run.
            let _ = writeln!(file, "plimsoll [{}] {}", Level::Warning.word(), text.trim_end());
        }
    }

    /// Takes the last warning or error, so that it can be quoted in the error it explains.
    pub fn take_problem(&self) -> Option<String> {
        let mut sink = self.sink.lock().unwrap_or_else(PoisonError::into_inner);
        sink.held = None;
        sink.last_problem.take()
    }
}

/// Keeps a descriptor of its own of the log; that of the log before, of another run in this process, is closed.
#[cfg(unix)]
fn keep_descriptor(file: &File) {
    use std::os::fd::{FromRawFd, IntoRawFd, OwnedFd};
    let Ok(copy) = file.try_clone() else { return };
    let before = DESCRIPTOR.swap(copy.into_raw_fd(), Ordering::Relaxed);
    if before >= 0 {
        // SAFETY: made by this function, and nobody else closes it.
        drop(unsafe { OwnedFd::from_raw_fd(before) });
    }
}

#[cfg(not(unix))]
fn keep_descriptor(_file: &File) {}
