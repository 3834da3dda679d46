//! Signals of a crash, and writing in a handler, where little else is allowed.

use super::{announce, describe};
use nix::sys::signal::{SaFlags, SigAction, SigHandler, SigSet, Signal, raise, sigaction};
use std::ffi::c_int;
use std::os::fd::BorrowedFd;

/// Signals by which code that went wrong ends its process.
const CRASHES: [Signal; 5] = [Signal::SIGSEGV, Signal::SIGBUS, Signal::SIGILL, Signal::SIGFPE, Signal::SIGABRT];

pub(super) fn catch_crashes() {
    // On the stack that the runtime keeps aside: the usual one may be what is used up.
    let action = SigAction::new(SigHandler::Handler(on_crash), SaFlags::SA_ONSTACK, SigSet::empty());
    for signal in CRASHES {
        // SAFETY: the handler restricts itself to what is allowed in one. Where it cannot be installed a crash ends the
        // process without a word, as it did before.
        let _ = unsafe { sigaction(signal, &action) };
    }
}

extern "C" fn on_crash(number: c_int) {
    let name = Signal::try_from(number).map_or("a signal", Signal::as_str);
    announce(&describe(format_args!("crashed ({name})")));
    let default = SigAction::new(SigHandler::SigDfl, SaFlags::empty(), SigSet::empty());
    if let Ok(signal) = Signal::try_from(number) {
        // SAFETY: the default action ends the process, with a memory image for whoever wrote the FMU.
        let _ = unsafe { sigaction(signal, &default) };
        // Held back until this handler returns.
        let _ = raise(signal);
    }
}

/// Writes to standard error, and to the log where there is one.
pub(super) fn write(bytes: &[u8]) {
    for descriptor in [Some(2), crate::log::descriptor()].into_iter().flatten() {
        // SAFETY: both stay open as long as the process lives.
        let descriptor = unsafe { BorrowedFd::borrow_raw(descriptor) };
        let _ = nix::unistd::write(descriptor, bytes);
    }
}
