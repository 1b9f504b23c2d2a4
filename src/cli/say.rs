//! Output to stderr and stdout. A closed pipe or a full disk does not stop a run.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};

use super::failure::Failure;
use crate::mesh::names::printable;

/// Prints a line to stderr, ignoring errors.
macro_rules! say {
    ($($text:tt)*) => { $crate::cli::say(format_args!($($text)*)) };
}

/// Prints a line to stderr, ignoring errors.
pub fn say(text: Arguments) {
    // The failure cannot be reported anywhere.
    let _ = writeln!(std::io::stderr(), "{}", printable(&text.to_string()));
}

/// Prints the requested text to stdout; a reader may stop early.
///
/// # Errors
/// Returns [`Failure::Stopped`] if it cannot be written.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(printable(text).as_bytes()).and_then(|()| out.flush()) {
        Err(cause) if cause.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Stopped(format!("the answer could not be printed: {cause}")))
        }
        _ => Ok(()),
    }
}
