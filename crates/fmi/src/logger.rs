//! Messages of an instance, by category.

use crate::Status;

/// Categories of messages and their meaning; descriptions list them.
pub const CATEGORIES: [(&str, &str); 4] = [
    ("logStatusError", "calls that failed"),
    ("logStatusDiscard", "calls that another value or a shorter step would do for"),
    ("logStatusWarning", "things to look at"),
    ("logEvents", "initialisation, field frames and other milestones"),
];

type Sink = Box<dyn Fn(Status, &str, &str)>;

/// Where messages of one instance go.
pub struct Logger {
    sink: Option<Sink>,
    enabled: [bool; CATEGORIES.len()],
}

impl Logger {
    /// Messages to a function of (status, category, message).
    pub fn to_function(sink: impl Fn(Status, &str, &str) + 'static) -> Self {
        Self { sink: Some(Box::new(sink)), enabled: [true; CATEGORIES.len()] }
    }

    /// No messages.
    pub fn silent() -> Self {
        Self { sink: None, enabled: [false; CATEGORIES.len()] }
    }

    /// Switches categories; an empty list means all of them, unknown names are ignored.
    pub fn switch(&mut self, on: bool, categories: &[String]) {
        for (index, (name, _)) in CATEGORIES.iter().enumerate() {
            if categories.is_empty() || categories.iter().any(|category| category == name || category == "logAll") {
                self.enabled[index] = on;
            }
        }
    }

    /// A milestone, shown when the importer asked for logging.
    pub fn event(&self, message: &str) {
        self.send(Status::Ok, message);
    }

    /// Something to look at, shown when the importer asked for logging.
    pub fn warning(&self, message: &str) {
        self.send(Status::Warning, message);
    }

    /// Sends a message in the category of its status. Errors and discards are sent even with logging off: they say
    /// why a call did not succeed.
    pub fn send(&self, status: Status, message: &str) {
        let index = match status {
            Status::Error => 0,
            Status::Discard => 1,
            Status::Warning => 2,
            Status::Ok => 3,
        };
        if let Some(sink) = self.sink.as_ref().filter(|_| index < 2 || self.enabled[index]) {
            sink(status, CATEGORIES[index].0, message);
        }
    }
}
