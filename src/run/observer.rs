//! Those who watch a run, and what they are told.

use crate::model::state::State;
use crate::model::until::{Course, Until};
use crate::model::{Model, Step};
use crate::run::error::Error;
use crate::solve::IterationRecord;
use crate::solve::failure::IncrementFailure;

/// An attempt at one increment, accepted or not.
#[derive(Clone, Copy, Debug)]
pub struct Attempt<'a> {
    /// the step
    pub step: &'a Step,
    /// 1 for the first attempt at this increment
    pub number: usize,
    /// the state it started from
    pub old: &'a State,
    /// its length [T]
    pub dt: f64,
    /// its linear solves
    pub iterations: &'a [IterationRecord],
    /// the new state, if it was accepted
    pub accepted: Option<&'a State>,
    /// what became of it
    pub verdict: Verdict,
    /// why no equilibrium was found, if none was
    pub cause: Option<&'a IncrementFailure>,
    /// estimated local error of a displacement, in steps under error control [L]
    pub local_error: Option<f64>,
    /// share of a contact's force that is in doubt because points touched at an unknown moment of the increment, in static
    /// steps [-]
    pub doubt: Option<f64>,
}

impl Attempt<'_> {
    /// Whether the step ends with the new state: at its time, or with the reaction that ends it.
    pub fn ends_step(&self, state: &State) -> bool {
        let Step { span, until, .. } = self.step;
        let met = |until: &Until| until.course(*span, [self.old, state]) == Course::Met;
        state.time >= span.end || until.as_ref().is_some_and(met)
    }
}

/// What became of an attempt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It led to a new state, or paused on its way there.
    Accepted,
    /// No equilibrium was found.
    Unsolved,
    /// The reaction that ends the step passed its value.
    Passed,
    /// Its local error was too large.
    Error,
    /// Points touched, and friction depends on when they did.
    Touch,
    /// A contact began to slip fast, and what follows is explicit.
    Rupture,
}

impl Verdict {
    /// A word for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::Unsolved => "unsolved",
            Self::Passed => "passed",
            Self::Error => "error",
            Self::Touch => "touch",
            Self::Rupture => "rupture",
        }
    }
}

/// Somebody who watches a run.
pub trait Observer {
    /// Called after every attempt.
    ///
    /// # Errors
    /// [`Error::Output`] when a file cannot be written; it ends the run.
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error>;

    /// The name by which what it remembers is found again.
    fn name(&self) -> &'static str {
        ""
    }

    /// What it remembers, and how far it has written: for [`restore`](Self::restore). Nothing unless it says so.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    fn save(&mut self) -> Result<Vec<u8>, Error> {
        Ok(Vec::new())
    }

    /// Whether it can go on from what was saved: what it had written by then still stands. Nothing is changed.
    ///
    /// # Errors
    /// As [`record`](Self::record), with what is wrong.
    fn check(&self, _memory: &[u8]) -> Result<(), Error> {
        Ok(())
    }

    /// Go on from what was saved; what has been written since is taken back.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    fn restore(&mut self, _memory: &[u8]) -> Result<(), Error> {
        Ok(())
    }

    /// Called once after the last attempt: what is still under way comes to its end.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    fn finish(&mut self) -> Result<(), Error> {
        Ok(())
    }
}
