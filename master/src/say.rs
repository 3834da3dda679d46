//! Lines on the terminal. A reader that has gone, as in `plimsoll list-scenes | head -1`, is no failure of the program.

use std::fmt::Arguments;
use std::io::Write;

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

/// A line of what was asked for.
pub fn answer(line: Arguments) {
    let _ = writeln!(std::io::stdout(), "{line}");
}

/// A line about how it goes.
pub fn tell(line: Arguments) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
