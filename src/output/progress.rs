//! Progress on stderr: a bar on a terminal, a plain line per increment elsewhere.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

use super::{Attempt, Observer};
use crate::assembly::ContactCounts;
use crate::error::Error;
use crate::model::Model;

/// Shows progress.
#[derive(Debug)]
pub struct Progress(Option<ProgressBar>);

/// Ticks of a full bar.
const FULL: u64 = 1000;

impl Progress {
    /// A bar if stderr is a terminal, lines otherwise.
    pub fn new() -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{bar:30} {percent:>3}% {elapsed} {msg}");
            ProgressBar::new(FULL).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Self(bar)
    }
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

impl Observer for Progress {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let solves = attempt.iterations.len();
        let (time, dt, step) = (attempt.old.time, attempt.dt, &attempt.step.name);
        let message = match attempt.accepted {
            Some(state) => {
                let counts = ContactCounts::of(&state.contacts);
                format!(
                    "{step}  t {:.6}  dt {dt:.3e}  {solves} iterations  open {} stick {} slip {}",
                    state.time, counts.open, counts.stick, counts.slip
                )
            }
            None => format!("{step}  t {time:.6}  dt {dt:.3e}  repeated after {solves} iterations"),
        };
        match &self.0 {
            Some(bar) => {
                let end = model.steps.last().map_or(1.0, |step| step.span.end);
                let reached = attempt.accepted.map_or(time, |state| state.time);
                bar.set_position((FULL as f64 * reached / end) as u64);
                bar.set_message(message);
            }
            None => eprintln!("{message}"),
        }
        Ok(())
    }
}
