//! What is told on stderr and printed to stdout. Whoever closes his end of them, or has a full disk behind them, does not end
//! a run with it.

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
    // There is nobody left to tell.
    let _ = writeln!(std::io::stderr(), "{}", printable(&text.to_string()));
}

/// Print to stdout what was asked for; whoever does not read to the end has what he wants.
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
