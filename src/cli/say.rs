//! Output to stderr and stdout, and the log of a run in its results folder. A closed pipe or a full disk does not stop a run.

use std::fmt::Arguments;
use std::fs::File;
use std::io::{self, ErrorKind, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::Mutex;

use super::failure::Failure;
use crate::mesh::names::printable;
use crate::output::files;
pub use crate::output::files::LOG;

/// First words of a log of this program, by which it is told from a user's own file of this name.
const HEAD: &str = "fecontact log, version ";

/// The log that is being written.
static OPEN: Mutex<Option<File>> = Mutex::new(None);

/// Starts the log of a run in `folder`, or continues it, if the run does.
///
/// # Errors
/// Returns the error of the system, or that a file of this name is not a log of this program.
pub fn log_to(folder: &Path, goes_on: bool) -> io::Result<()> {
    let path = folder.join(LOG);
    let is_there = path.symlink_metadata().is_ok();
    if is_there && !files::bears(&path, HEAD) {
        return Err(io::Error::other("is not a log of this program: move it, and the next run is logged"));
    }
    let mut file = if is_there && goes_on { files::open(&path)? } else { files::create(&path)? };
    if file.seek(SeekFrom::End(0))? == 0 {
        writeln!(file, "{HEAD}{}", env!("CARGO_PKG_VERSION"))?;
    }
    if let Ok(mut open) = OPEN.lock() {
        *open = Some(file);
    }
    Ok(())
}

/// Writes a line to the log alone, ignoring errors.
pub fn note(line: &str) {
    if let Ok(mut open) = OPEN.lock()
        && let Some(file) = open.as_mut()
    {
        let _ = writeln!(file, "{}", printable(line));
    }
}

/// Prints a line to stderr, ignoring errors.
macro_rules! say {
    ($($text:tt)*) => { $crate::cli::say(format_args!($($text)*)) };
}

/// Prints a line to stderr, ignoring errors.
pub fn say(text: Arguments) {
    let text = text.to_string();
    // The failure cannot be reported anywhere.
    let _ = writeln!(std::io::stderr(), "{}", printable(&text));
    note(&text);
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
