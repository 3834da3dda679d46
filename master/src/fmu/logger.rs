//! The receiving end of an FMU's messages.

use crate::log::{Level, Log};
use fmi2::ffi::{Status, Text};
use std::ffi::{CStr, c_void};

/// Where the messages of one instance go; its address is the componentEnvironment of the callbacks.
pub(super) struct Environment {
    pub log: Log,
    pub participant: String,
}

/// Called by the C shim with a formatted message.
///
/// # Safety
/// `environment` is the address of a live [`Environment`]; the texts are NULL or terminated.
#[unsafe(no_mangle)]
unsafe extern "C" fn plimsoll_log_message(
    environment: *mut c_void,
    _instance: Text,
    status: Status,
    category: Text,
    text: Text,
) {
    // SAFETY: by the contract above; the participant keeps its environment until the instance is freed.
    let Some(environment) = (unsafe { environment.cast::<Environment>().as_ref() }) else { return };
    let level = match status {
        Status::OK => Level::Information,
        Status::WARNING => Level::Warning,
        _ => Level::Error,
    };
    // SAFETY: by the contract above.
    let (category, text) = unsafe { (owned(category), owned(text)) };
    // Some FMUs double the percent sign for importers that format a message twice.
    environment.log.write(&environment.participant, level, &category, &text.replace("%%", "%"));
}

/// # Safety
/// `text` is NULL or a terminated string.
unsafe fn owned(text: Text) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: non-null and terminated by the contract.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}
