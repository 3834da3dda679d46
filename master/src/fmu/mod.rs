//! Import of FMI 2.0 co-simulation FMUs: unpack, read the description, load the library, call it.

mod abi;
mod archive;
mod description;
mod error;
mod library;
mod logger;
mod participant;
mod unpacked;
mod watch;

pub use archive::{Archive, PLATFORM, file_uri};
pub use description::Model;
pub use error::Error;
pub use library::Library;
pub use participant::FmuParticipant;
pub use watch::{Watch, allow_exit, watch};
