//! Progress on stderr: one line that is updated on a terminal, otherwise one line per tenth of the run; warnings are printed
//! immediately.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::say::note;
use crate::equations::ContactCounts;
use crate::mesh::names::in_line;
use crate::model::Model;
use crate::model::text::count;
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer, Verdict};
use crate::solve::failure::IncrementFailure;

/// Destination of progress and warnings.
#[derive(Clone, Debug)]
pub enum Voice {
    /// Only warnings, as lines on stderr
    Quiet,
    /// Lines on stderr
    Lines,
    /// A terminal, above the progress line
    Terminal(ProgressBar),
}

impl Voice {
    /// Creates the output of a run.
    pub fn new(quiet: bool) -> Self {
        // The line is redrawn when its content changes, at most once per frame, and only where it can be overwritten: on a
        // terminal whose TERM is set and not `dumb`.
        let target = ProgressDrawTarget::stderr();
        match (quiet, target.is_hidden()) {
            (true, _) => Self::Quiet,
            (false, true) => Self::Lines,
            (false, false) => {
                let bar = ProgressBar::with_draw_target(None, target);
                let style = ProgressStyle::with_template("{wide_msg}");
                Self::Terminal(bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())))
            }
        }
    }

    /// Prints a line.
    pub fn say(&self, line: &str) {
        match self {
            Self::Quiet => note(line),
            Self::Lines => say!("{line}"),
            Self::Terminal(bar) => bar.suspend(|| say!("{line}")),
        }
    }

    /// Prints a warning.
    pub fn warn(&self, warning: &str) {
        match self {
            Self::Quiet => say!("warning: {warning}"),
            Self::Lines | Self::Terminal(_) => self.say(&format!("warning: {warning}")),
        }
    }
}

/// Observer that prints the progress of a run.
#[derive(Debug)]
pub struct Progress {
    voice: Voice,
    start: Instant,
    /// Fraction of the run that was done at the start; `None` before the first attempt
    done_before: Option<f64>,
    /// Earliest time of the next update on a terminal, since the start
    next: Duration,
    /// Number of tenths of the run already reported
    tenths: f64,
}

/// Shortest time between two updates of the line.
const FRAME: Duration = Duration::from_millis(100);

/// Relative round-off allowed in comparing times.
const ROUND_OFF: f64 = 1e-9;

/// Time before which the remaining time is not estimated.
const TOO_EARLY: Duration = Duration::from_secs(1);

impl Progress {
    /// Creates the observer with this output.
    pub fn new(voice: Voice) -> Self {
        if let Voice::Terminal(bar) = &voice {
            bar.set_message("the first increment is under way");
        }
        Self { voice, start: Instant::now(), done_before: None, next: Duration::ZERO, tenths: 0.0 }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Voice::Terminal(bar) = &self.voice {
            bar.finish_and_clear();
        }
    }
}

impl Observer for Progress {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let now = self.start.elapsed();
        let end = model.steps.last().map_or(1.0, |step| step.span.end);
        let tenths = |share: f64| (10.0 * share * (1.0 + ROUND_OFF)).floor();
        let before = *self.done_before.get_or_insert_with(|| {
            self.tenths = tenths(attempt.old.time / end);
            attempt.old.time / end
        });
        let share = attempt.accepted.map_or(attempt.old.time, |state| state.time) / end;
        match &self.voice {
            Voice::Terminal(bar) if now >= self.next => {
                let left = left(now, share - before, 1.0 - share);
                bar.set_message(
                    in_line(&format!("{:.1} %{left}  {}", 100.0 * share, message(model, attempt, true))).into_owned(),
                );
                self.next = now + FRAME;
            }
            Voice::Quiet | Voice::Lines | Voice::Terminal(_) => {}
        }
        if tenths(share) > self.tenths {
            let line = format!("{:3.0} %  {}", 100.0 * share, message(model, attempt, false));
            match &self.voice {
                Voice::Lines => say!("{line}"),
                // A terminal shows the line that is updated; the log has one per tenth.
                Voice::Quiet | Voice::Terminal(_) => note(&line),
            }
            self.tenths = tenths(share);
        }
        Ok(())
    }
}

/// Estimated remaining time, extrapolated from the time spent.
fn left(spent: Duration, done: f64, rest: f64) -> String {
    if spent < TOO_EARLY || done <= 0.0 {
        return String::new();
    }
    let seconds = (spent.as_secs_f64() * rest / done).min(1e9) as u64;
    let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
    format!(", {hours}:{minutes:02}:{:02} left", seconds % 60)
}

/// Describes an attempt in one line; a `terse` one fits a terminal of eighty columns.
fn message(model: &Model, attempt: &Attempt, terse: bool) -> String {
    let (gap, iterations) = if terse { (" ", "iter") } else { ("  ", "iterations") };
    let solves = match attempt.iterations.len() {
        0 => String::new(),
        solves => format!("  {solves} {iterations}"),
    };
    let dt = if terse { format!("{:.2e}", attempt.dt) } else { format!("{:.3e}", attempt.dt) };
    let at = |time: f64| format!("{}{gap}t {}{gap}dt {dt}", attempt.step.name, significant(time, attempt.dt));
    match attempt.accepted {
        Some(state) => {
            let ContactCounts { open, stick, slip } = ContactCounts::of(&model.contacts, &state.contacts);
            let points = open + stick + slip;
            let contacts = if points > 0 { format!("  open {open} stick {stick} slip {slip}") } else { String::new() };
            format!("{}{solves}{contacts}", at(state.time))
        }
        None => format!("{}  {}", at(attempt.old.time), given_up(attempt)),
    }
}

/// Describes a rejected attempt by the kind of its failure; `newton.csv` contains the reason.
fn given_up(attempt: &Attempt) -> String {
    let what = if attempt.verdict == Verdict::Unsolved { "rejected" } else { "repeated" };
    let when = match attempt.iterations.len() {
        0 => "before a solve".into(),
        solves => format!("after {}", count(solves, "iteration")),
    };
    format!("{what} {when}: {}", attempt.cause.map_or(attempt.verdict.kind(), IncrementFailure::kind))
}

/// Formats a time with enough digits to distinguish increments.
fn significant(time: f64, dt: f64) -> String {
    const FEWEST: f64 = 6.0;
    const MOST: f64 = 15.0;
    let digits = ((time / dt).abs().log10() + 3.0).clamp(FEWEST, MOST) as usize;
    let rounded = format!("{time:.*e}", digits - 1).parse().unwrap_or(time);
    match rounded {
        0.0 => "0".into(),
        value if (1e-4..1e7).contains(&f64::abs(value)) => format!("{value}"),
        value => format!("{value:e}"),
    }
}
