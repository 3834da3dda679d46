//! Import of FMI 2.0 co-simulation FMUs: unpack, read the description, load the library, call it.

mod abi;
mod archive;
mod description;
mod error;
mod library;
mod logger;
mod participant;

pub use archive::{Archive, PLATFORM, file_uri};
pub use description::Model;
pub use error::Error;
pub use library::Library;
pub use participant::FmuParticipant;
