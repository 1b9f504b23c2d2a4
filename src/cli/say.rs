//! Output to stderr and stdout. A closed pipe or a full disk behind them does not end a run with it.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};

use super::failure::Failure;
use crate::mesh::names::printable;

/// Tell stderr a line, if it listens.
macro_rules! say {
    ($($text:tt)*) => { $crate::cli::say(format_args!($($text)*)) };
}

/// Tell stderr a line, if it listens.
pub fn say(text: Arguments) {
    // There is no one left to report to.
    let _ = writeln!(std::io::stderr(), "{}", printable(&text.to_string()));
}

/// Print the requested text to stdout; a reader may stop early.
///
/// # Errors
/// [`Failure::Stopped`] when it cannot be written.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(printable(text).as_bytes()).and_then(|()| out.flush()) {
        Err(cause) if cause.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Stopped(format!("the answer could not be printed: {cause}")))
        }
        _ => Ok(()),
    }
}
