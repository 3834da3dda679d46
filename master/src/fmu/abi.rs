//! The C functions that are handed to an FMU; the types of the standard are in [`fmi2::ffi`].

use fmi2::ffi::{Status, Text};
use std::ffi::{c_int, c_void};

unsafe extern "C" {
    /// The shim in source/logger.c.
    pub fn plimsoll_logger(
        environment: *mut c_void,
        instance: Text,
        status: Status,
        category: Text,
        message: Text,
        ...
    );
    /// The C library's.
    pub fn calloc(count: usize, size: usize) -> *mut c_void;
    /// The C library's.
    pub fn free(memory: *mut c_void);
    /// The C library's; 0 when the function was taken.
    pub fn atexit(function: extern "C" fn()) -> c_int;
    /// The C library's: ends the process without further ado.
    pub fn _exit(code: c_int) -> !;
}
