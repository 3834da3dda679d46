//! Messages to the importer's callback: one finished text, never a format string with arguments.

use crate::ffi::{CallbackFunctions, Status};
use fmi::Logger;
use std::ffi::CString;

/// A logger that calls the importer's function. The struct is copied: its address is valid during the call only.
pub fn logger(functions: CallbackFunctions, name: &str, logging_on: bool) -> Logger {
    let name = CString::new(name.replace('\0', " ")).unwrap_or_default();
    let mut logger = Logger::to_function(move |status, category, message| {
        let Some(logger) = functions.logger else { return };
        // A percent sign is doubled although the text is passed for "%s": several importers format it again.
        let text = CString::new(message.replace('\0', " ").replace('%', "%%")).unwrap_or_default();
        let category = CString::new(category).unwrap_or_default();
        // SAFETY: the importer's function as declared by the standard; every pointer is a string that outlives the call.
        unsafe {
            logger(
                functions.component_environment,
                name.as_ptr(),
                Status::from(status),
                category.as_ptr(),
                c"%s".as_ptr(),
                text.as_ptr(),
            );
        }
    });
    logger.switch(logging_on, &[]);
    logger
}
