//! Export of a model as an FMI 2.0 co-simulation FMU (standard 2.0.5).
//!
//! What a model is, and one instance of it, `fmi` knows whatever the version: a model implements `fmi::Component`. Here are the
//! types of the C ABI, the call sequence ([`Instance`]), modelDescription.xml ([`describe`]), and [`export!`], which puts the C
//! functions of the standard around it: use it in a `cdylib` shell and nowhere else, because two libraries that export the same
//! names and are linked into one program call each other's functions.

mod callback;
pub mod describe;
pub mod entry;
mod export;
pub mod ffi;
mod instance;
pub mod resources;
mod sequence;

pub use ffi::Status;
pub use instance::Instance;
pub use sequence::Function;
