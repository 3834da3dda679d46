//! What can be wrong with an FMU as a file.

use thiserror::Error;

/// An FMU that cannot be loaded. Every message names the file.
#[derive(Debug, Error)]
pub enum Error {
    /// The archive cannot be read or unpacked.
    #[error("{path}: cannot unpack the FMU: {reason}")]
    Archive {
        /// Path of the FMU.
        path: String,
        /// What failed.
        reason: String,
    },
    /// modelDescription.xml is missing or not understood.
    #[error("{path}: modelDescription.xml: {reason}")]
    Description {
        /// Path of the FMU.
        path: String,
        /// What failed.
        reason: String,
    },
    /// There is no binary for this platform.
    #[error("{path}: no binary for {platform}: expected {expected}; the FMU has {found}")]
    Platform {
        /// Path of the FMU.
        path: String,
        /// FMI name of this platform.
        platform: String,
        /// File looked for.
        expected: String,
        /// Platforms present.
        found: String,
    },
    /// The shared library cannot be loaded or lacks a function.
    #[error("{path}: {reason}")]
    Library {
        /// Path of the FMU.
        path: String,
        /// What the loader said.
        reason: String,
    },
    /// fmi2Instantiate returned NULL.
    #[error("{path}: fmi2Instantiate of '{instance}' returned NULL{message}")]
    Instantiate {
        /// Path of the FMU.
        path: String,
        /// Instance name.
        instance: String,
        /// The FMU's own message with a leading separator.
        message: String,
    },
}
