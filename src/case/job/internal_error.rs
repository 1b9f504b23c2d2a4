//! Internal errors: a panic is reported with the information to send, and the results are kept.

use std::backtrace::{Backtrace, BacktraceStatus};
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::sync::Mutex;

/// Message and place of the last panic.
static LAST: Mutex<Option<String>> = Mutex::new(None);

/// Records panics instead of printing them.
pub fn watch() {
    panic::set_hook(Box::new(|panic| {
        if let Ok(mut last) = LAST.lock() {
            // Later panics are consequences of the first.
            last.get_or_insert_with(|| described(panic));
        }
    }));
}

/// Runs `work` and catches a panic.
///
/// # Errors
/// Returns message and place of the panic, if [`watch`] was called.
pub fn catch<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    panic::catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
        let noted = LAST.lock().ok().and_then(|mut last| last.take());
        noted.unwrap_or_else(|| payload_text(&*payload).into())
    })
}

fn described(panic: &PanicHookInfo) -> String {
    let place = panic.location().map_or_else(String::new, |place| format!(" at {place}"));
    let trace = Backtrace::capture();
    let trace = if trace.status() == BacktraceStatus::Captured { format!("\n{trace}") } else { String::new() };
    format!("{}{place}{trace}", payload_text(panic.payload()))
}

fn payload_text(payload: &(dyn std::any::Any + Send)) -> &str {
    let text = payload.downcast_ref::<&str>().copied();
    text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("it does not say why")
}

/// Returns the text for the user.
pub fn message(what: &str) -> String {
    format!(
        "internal error: {what}\nThis is an error of fecontact {}, not of your input. Please report it with this text, the command, the \
         case file and its mesh; RUST_BACKTRACE=1 before the command adds where it came from. The results so far are kept.",
        env!("CARGO_PKG_VERSION")
    )
}
