//! Messages to the importer: one finished text, never a format string with arguments.

use crate::ffi::{CallbackFunctions, Status};
use std::ffi::CString;

/// Categories of messages and their meaning; the XML lists them.
pub const CATEGORIES: [(&str, &str); 4] = [
    ("logStatusError", "calls that ended with fmi2Error"),
    ("logStatusDiscard", "calls that ended with fmi2Discard"),
    ("logStatusWarning", "things to look at"),
    ("logEvents", "initialisation, field frames and other milestones"),
];

type Sink = Box<dyn Fn(Status, &str, &str)>;

enum Target {
    Callback { functions: CallbackFunctions, name: CString },
    Function(Sink),
    Nowhere,
}

/// Where messages of one instance go.
pub struct Logger {
    target: Target,
    enabled: [bool; CATEGORIES.len()],
}

impl Logger {
    /// Messages to the importer's callback. The struct is copied: its address is valid during the call only.
    pub(crate) fn to_callback(functions: CallbackFunctions, name: &str, logging_on: bool) -> Self {
        let name = CString::new(name.replace('\0', " ")).unwrap_or_default();
        Self { target: Target::Callback { functions, name }, enabled: [logging_on; CATEGORIES.len()] }
    }

    /// Messages to a function of (status, category, message), for use in process.
    pub fn to_function(sink: impl Fn(Status, &str, &str) + 'static) -> Self {
        Self { target: Target::Function(Box::new(sink)), enabled: [true; CATEGORIES.len()] }
    }

    /// No messages.
    pub fn silent() -> Self {
        Self { target: Target::Nowhere, enabled: [false; CATEGORIES.len()] }
    }

    /// Switches categories; an empty list means all of them, unknown names are ignored.
    pub(crate) fn switch(&mut self, on: bool, categories: &[String]) {
        for (index, (name, _)) in CATEGORIES.iter().enumerate() {
            if categories.is_empty() || categories.iter().any(|category| category == name || category == "logAll") {
                self.enabled[index] = on;
            }
        }
    }

    /// A milestone, shown when the importer asked for logging.
    pub fn event(&self, message: &str) {
        self.send(Status::OK, message);
    }

    /// Something to look at, shown when the importer asked for logging.
    pub fn warning(&self, message: &str) {
        self.send(Status::WARNING, message);
    }

    /// Sends a message in the category of its status. Errors and discards are sent even with logging off: they say
    /// why a call did not succeed.
    pub(crate) fn send(&self, status: Status, message: &str) {
        let index = match status {
            Status::ERROR => 0,
            Status::DISCARD => 1,
            Status::WARNING => 2,
            _ => 3,
        };
        if index < 2 || self.enabled[index] {
            self.deliver(status, CATEGORIES[index].0, message);
        }
    }

    fn deliver(&self, status: Status, category: &str, message: &str) {
        match &self.target {
            Target::Nowhere => {}
            Target::Function(sink) => sink(status, category, message),
            Target::Callback { functions, name } => {
                let Some(logger) = functions.logger else { return };
                // A percent sign is doubled although the text is passed for "%s": several importers format it again.
                let text = CString::new(message.replace('\0', " ").replace('%', "%%")).unwrap_or_default();
                let category = CString::new(category).unwrap_or_default();
                // SAFETY: the importer's function as declared by the standard; every pointer is a string that
                // outlives the call.
                unsafe {
                    logger(
                        functions.component_environment,
                        name.as_ptr(),
                        status,
                        category.as_ptr(),
                        c"%s".as_ptr(),
                        text.as_ptr(),
                    );
                }
            }
        }
    }
}
