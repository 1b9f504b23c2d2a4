//! Those who watch a run, and what they are told.

use crate::model::state::State;
use crate::model::{Model, Step};
use crate::run::error::Error;
use crate::solve::IterationRecord;

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
    /// estimated local error of a displacement, in steps under error control [L]
    pub local_error: Option<f64>,
    /// share of a contact's force that is in doubt because points touched at an unknown moment of the increment, in static
    /// steps [-]
    pub doubt: Option<f64>,
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
