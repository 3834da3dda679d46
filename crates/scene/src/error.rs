//! What can be wrong with a scene file, or with another file made of its tables.

use digits::rounded;
use thiserror::Error;

/// A scene, or a document made of its tables, that cannot be used, with the place and the remedy.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Error {
    /// The file cannot be read.
    #[error("cannot read {path}: {reason}")]
    Read {
        /// Path as given.
        path: String,
        /// What the operating system said.
        reason: String,
    },
    /// The text is not what is expected: syntax, an unknown key or a wrong type.
    #[error("{name}, line {line}: {message}{hint}")]
    Parse {
        /// Name of the document.
        name: String,
        /// Line counted from one.
        line: usize,
        /// What the parser said.
        message: String,
        /// The nearest known key, if there is one.
        hint: String,
    },
    /// An override that is not `key.path=value` or does not fit the file.
    #[error("override '{text}': {reason}")]
    Override {
        /// The override as given.
        text: String,
        /// Why it cannot be applied.
        reason: String,
    },
    /// A value outside its range.
    #[error("{name}: {key} = {}: expected {}", rounded(got), rounded(expected))]
    Range {
        /// Name of the document, with the line where that is known.
        name: String,
        /// Key path of the value.
        key: String,
        /// Value found.
        got: String,
        /// What would be right.
        expected: String,
    },
}
