//! Lines on the terminal. A reader that has gone, as in `plimsoll list-scenes | head -1`, is no failure of the program.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};

/// Writes a line to standard output, as `println!` does.
#[macro_export]
macro_rules! answer {
    ($($text:tt)*) => { $crate::say::answer(format_args!($($text)*)) };
}

/// Writes a line to standard error, as `eprintln!` does.
#[macro_export]
macro_rules! tell {
    ($($text:tt)*) => { $crate::say::tell(format_args!($($text)*)) };
}

/// A line of what was asked for. Where it cannot be written though somebody reads, as on a full disk, the program ends:
/// half an answer must not pass for a whole one.
pub fn answer(line: Arguments) {
    match writeln!(std::io::stdout(), "{line}") {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            tell(format_args!("error: standard output: {error}"));
            crate::fmu::allow_exit();
            std::process::exit(1);
        }
        _ => {}
    }
}

/// A line about how it goes.
pub fn tell(line: Arguments) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
