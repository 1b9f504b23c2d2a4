//! Progress on stderr: a bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::equations::ContactCounts;
use crate::model::Model;
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer};

/// Shows progress.
#[derive(Debug)]
pub struct Progress {
    /// `None` where stderr is no terminal
    bar: Option<ProgressBar>,
    start: Instant,
    /// when to speak again, after the start
    next: Duration,
    lines: u32,
}

/// Ticks of a full bar.
const FULL: u64 = 1000;

/// A bar is drawn no more often than this.
const FRAME: Duration = Duration::from_millis(100);

/// Every increment has a line up to this many, ...
const LINES: u32 = 100;

/// ... and later there is one in this time.
const PAUSE: Duration = Duration::from_millis(500);

impl Progress {
    /// A bar if stderr is a terminal, lines otherwise.
    pub fn new() -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{bar:30} {percent:>3}% {elapsed} {msg}");
            ProgressBar::new(FULL).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Self { bar, start: Instant::now(), next: Duration::ZERO, lines: 0 }
    }

    fn line(&mut self, message: &str) {
        say!("{message}");
        self.lines += 1;
        if self.lines == LINES {
            say!("… from here on not every increment has a line");
        }
    }
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

impl Observer for Progress {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let now = self.start.elapsed();
        if now < self.next {
            return Ok(());
        }
        match &self.bar {
            Some(bar) => {
                let end = model.steps.last().map_or(1.0, |step| step.span.end);
                let reached = attempt.accepted.map_or(attempt.old.time, |state| state.time);
                bar.set_position((FULL as f64 * reached / end) as u64);
                bar.set_message(message(attempt));
                self.next = now + FRAME;
            }
            None => {
                self.line(&message(attempt));
                self.next = if self.lines < LINES { now } else { now + PAUSE };
            }
        }
        Ok(())
    }
}

fn message(attempt: &Attempt) -> String {
    let solves = attempt.iterations.len();
    let (time, dt, step) = (attempt.old.time, attempt.dt, &attempt.step.name);
    match attempt.accepted {
        Some(state) => {
            let counts = ContactCounts::of(&state.contacts);
            format!(
                "{step}  t {:.6}  dt {dt:.3e}  {solves} iterations  open {} stick {} slip {}",
                state.time, counts.open, counts.stick, counts.slip
            )
        }
        None => format!("{step}  t {time:.6}  dt {dt:.3e}  repeated after {solves} iterations"),
    }
}
