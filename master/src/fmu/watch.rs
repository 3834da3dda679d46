//! Watches over calls into FMUs, whose code may crash, never return, or end the program: says which FMU it was, in which
//! call, at what time, before the process ends.
//!
//! All run in one process, so that a crash takes the run with it; its tables are whole up to there, for every row is
//! written at once.

#[cfg(unix)]
mod system;

use super::abi;
use std::fmt::Write as _;
#[cfg(not(unix))]
use std::io::Write as _;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Once, OnceLock};
use std::time::{Duration, Instant};

/// Name of an FMU, kept for ever: a handler may read it at any moment.
type Caller = &'static &'static str;

/// The call that is being made, or was made last. One thread makes all calls of a run.
struct Current {
    caller: AtomicPtr<&'static str>,
    call: AtomicPtr<&'static str>,
    /// Bits of the time in the run \[s\].
    time: AtomicU64,
    /// Milliseconds from the start of the program to the start of the call, plus one; 0 outside of calls.
    begun: AtomicU64,
}

static CURRENT: Current = Current {
    caller: AtomicPtr::new(null_mut()),
    call: AtomicPtr::new(null_mut()),
    time: AtomicU64::new(0),
    begun: AtomicU64::new(0),
};
/// Letters of a name in a message.
const LONGEST_NAME: usize = 60;
/// FMUs that are loaded.
static LOADED: AtomicUsize = AtomicUsize::new(0);
/// Whether the program itself is about to exit.
static LEAVING: AtomicBool = AtomicBool::new(false);
static START: OnceLock<Instant> = OnceLock::new();

fn milliseconds() -> u64 {
    u64::try_from(START.get_or_init(Instant::now).elapsed().as_millis()).unwrap_or(u64::MAX)
}

/// An FMU whose calls are watched over.
pub(super) struct Watched(Caller);

impl Watched {
    /// Registers an FMU that is about to be loaded, and with the first one what watches over all.
    pub fn new(name: &str) -> Self {
        static HANDLERS: Once = Once::new();
        HANDLERS.call_once(|| {
            // SAFETY: the handler takes nothing, and does nothing that is not allowed while a process exits.
            unsafe { abi::atexit(on_exit) };
            #[cfg(unix)]
            system::catch_crashes();
        });
        LOADED.fetch_add(1, Ordering::Relaxed);
        // Words of a message in JSON as well.
        let plain: String = name
            .chars()
            .map(|letter| if letter.is_control() || letter == '"' || letter == '\\' { '?' } else { letter })
            .take(LONGEST_NAME)
            .collect();
        Self(Box::leak(Box::new(&*Box::leak(plain.into_boxed_str()))))
    }

    /// Notes that a function of the FMU is called, at a time in the run \[s\], until the value is dropped.
    pub fn enter(&self, call: &'static &'static str, time: f64) -> Inside {
        CURRENT.caller.store(std::ptr::from_ref(self.0).cast_mut(), Ordering::Relaxed);
        CURRENT.call.store(std::ptr::from_ref(call).cast_mut(), Ordering::Relaxed);
        CURRENT.time.store(time.to_bits(), Ordering::Relaxed);
        CURRENT.begun.store(milliseconds() + 1, Ordering::Release);
        Inside(())
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        LOADED.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Says that the program itself is about to exit while FMUs are loaded.
pub fn allow_exit() {
    LEAVING.store(true, Ordering::Relaxed);
}

/// A call that is being made, until the value is dropped.
pub(super) struct Inside(());

impl Drop for Inside {
    fn drop(&mut self) {
        CURRENT.begun.store(0, Ordering::Release);
    }
}

/// A text of limited length, made without memory from the heap: a handler must not ask for any.
struct Text {
    bytes: [u8; 512],
    length: usize,
}

impl std::fmt::Write for Text {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        let room = &mut self.bytes[self.length..];
        let count = text.len().min(room.len());
        room[..count].copy_from_slice(&text.as_bytes()[..count]);
        self.length += count;
        Ok(())
    }
}

impl Text {
    fn new() -> Self {
        Self { bytes: [0; 512], length: 0 }
    }

    fn bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

/// What happened in or after which call.
fn describe(what: std::fmt::Arguments) -> Text {
    let begun = CURRENT.begun.load(Ordering::Acquire);
    let name = |pointer: &AtomicPtr<&'static str>| {
        // SAFETY: null, or a reference to a text that lives for ever.
        unsafe { pointer.load(Ordering::Relaxed).as_ref() }.copied().unwrap_or("")
    };
    let (caller, call) = (name(&CURRENT.caller), name(&CURRENT.call));
    let time = f64::from_bits(CURRENT.time.load(Ordering::Relaxed));
    let mut text = Text::new();
    // The buffer has room for the longest name.
    let _ = if begun > 0 {
        write!(text, "{caller}: {what} in {call} at t = {time:.6} s")
    } else {
        write!(text, "the program {what}, last after {call} of {caller} at t = {time:.6} s")
    };
    let _ =
        write!(text, "; the tables hold what was recorded up to there, and --resume goes on from the last checkpoint");
    text
}

/// Says it on standard error and in the log.
fn announce(text: &Text) {
    let mut line = Text::new();
    let words = std::str::from_utf8(text.bytes()).unwrap_or("an FMU ended the program");
    let _ = if crate::log::speaks_json() {
        writeln!(line, "{{\"event\":\"end\",\"status\":\"failed\",\"error\":\"{words}\"}}")
    } else {
        writeln!(line, "error: {words}")
    };
    #[cfg(unix)]
    system::write(line.bytes());
    #[cfg(not(unix))]
    let _ = std::io::stderr().write_all(line.bytes());
}

/// Runs when the process exits, whoever asked for it.
extern "C" fn on_exit() {
    let inside = CURRENT.begun.load(Ordering::Acquire) > 0;
    let loaded = LOADED.load(Ordering::Relaxed) > 0;
    if LEAVING.load(Ordering::Relaxed) || !(inside || loaded) {
        return;
    }
    announce(&describe(format_args!("called exit")));
    // SAFETY: ends the process at once, without other handlers; 1 is the code of a run that failed.
    unsafe { abi::_exit(1) }
}

/// Ends the process when a call takes longer than its limit, until the value is dropped.
pub struct Watch(Arc<AtomicBool>);

/// Watches over the calls of all FMUs; `limit` is the longest that a call may take \[s\], 0 is no limit.
pub fn watch(limit: f64) -> Watch {
    let ended = Arc::new(AtomicBool::new(false));
    if limit > 0.0 {
        let flag = Arc::clone(&ended);
        // Without a thread to spare a run goes on unwatched.
        let _ = std::thread::Builder::new().name("watch".to_string()).spawn(move || look(limit, &flag));
    }
    Watch(ended)
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

fn look(limit: f64, ended: &AtomicBool) {
    let pause = Duration::from_secs_f64((0.1 * limit).clamp(0.001, 0.2));
    while !ended.load(Ordering::Relaxed) {
        std::thread::sleep(pause);
        let begun = CURRENT.begun.load(Ordering::Acquire);
        let elapsed = milliseconds().saturating_sub(begun.saturating_sub(1));
        if begun > 0 && elapsed as f64 > 1e3 * limit {
            announce(&describe(format_args!("did not return within limits.step_limit_seconds = {limit} s")));
            // SAFETY: ends the process at once: the thread inside the FMU cannot be asked to.
            unsafe { abi::_exit(1) }
        }
    }
}
