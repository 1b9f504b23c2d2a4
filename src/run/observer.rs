//! Observers of a run and the attempts passed to them.
//!
//! Accepted increments are rows of the results: all of them or, with an interval, those at least that far apart in time.
//! Events are never thinned out: the increments before and after a point of a contact closes, opens, starts or stops slipping
//! are rows. So are the last increments of steps, those at requested times, and the outputs of explicit increments. The run
//! decides this once for all time series.
//!
//! The reason of a rejected attempt is available as a sentence and as a short name for counting.
//!
//! ```
//! use std::sync::Arc;
//!
//! use fecontact::laws::bulk::{ElasticConstants, NeoHookean};
//! use fecontact::mesh::InlineMesh;
//! use fecontact::model::Model;
//! use fecontact::model::builder::{LoadStep, Support};
//! use fecontact::run::error::Error;
//! use fecontact::run::observer::{Attempt, Observer};
//! use fecontact::run::run;
//!
//! /// Linear solves of every increment.
//! struct Solves(Vec<usize>);
//!
//! impl Observer for Solves {
//!     fn record(&mut self, _model: &Model, attempt: &Attempt) -> Result<(), Error> {
//!         if attempt.accepted.is_some() {
//!             self.0.push(attempt.iterations.len());
//!         }
//!         Ok(())
//!     }
//! }
//!
//! let mesh = InlineMesh::default().rectangle("block", [2, 2], [0.0, 0.0], [1.0, 1.0]).build()?;
//! let press = LoadStep::new("press", 1.0).dt(0.5).fix("block_bottom").support(Support::on("block_top").ux(0.0).uy(-0.1));
//! let rubber = NeoHookean::new(&ElasticConstants::new(1000.0, 0.3))?;
//! let model = Arc::new(Model::builder(mesh).body("block", rubber).step(press).build()?);
//! let mut solves = Solves(Vec::new());
//! let (report, end) = run(&model, &mut [&mut solves]);
//! assert_eq!((end?.time, report.newton_iterations), (1.0, solves.0.iter().sum()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::laws::friction::Regime;
use crate::model::step::{Until, UntilStatus};
use crate::model::text::{count, number};
use crate::model::{Model, Scheme, State, Step};
use crate::run::error::Error;
use crate::solve::{IncrementFailure, IterationRecord, Pass};
use crate::time::step_size::LocalError;

/// An attempt at one increment, accepted or not.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Attempt<'a> {
    /// current step
    pub step: &'a Step,
    /// its number, from 0 on
    pub step_number: usize,
    /// planned and actual ends of the steps that a reaction has ended [T]
    pub ended: &'a [[f64; 2]],
    /// 1 for the first attempt at this increment
    pub number: usize,
    /// state at its start
    pub old: &'a State,
    /// its length [T]
    pub dt: f64,
    /// its linear solves
    pub iterations: &'a [IterationRecord],
    /// new state, if it was accepted
    pub accepted: Option<&'a State>,
    /// row of the results, if it was accepted
    pub row: Row,
    /// its outcome
    pub verdict: Verdict,
    /// cause of the failure, if no equilibrium was found
    pub cause: Option<&'a IncrementFailure>,
    /// estimated local error, in steps under error control
    #[doc(hidden)]
    pub local_error: Option<LocalError>,
    /// fraction of a contact's force that is uncertain because contact closed at an unknown time within the increment,
    /// in static steps [-]
    pub uncertainty: Option<f64>,
    /// its passes, if it is an implicit or static increment that was solved
    #[doc(hidden)]
    pub passes: &'a [Pass],
}

impl Attempt<'_> {
    /// Whether the step ends with the new state, at its end time or at the reaction that ends it.
    pub fn ends_step(&self, state: &State) -> bool {
        let Step { span, until, .. } = self.step;
        let met = |until: &Until| until.status(*span, [self.old, state]) == UntilStatus::Met;
        state.time >= span.end || until.as_ref().is_some_and(met)
    }

    /// Role of the increment in the results, given the time of the last row [T].
    pub(super) fn row_after(&self, model: &Model, last: f64) -> Row {
        let Some(new) = self.accepted else { return Row::Pending };
        let Some(interval) = model.requests.interval else { return Row::Written };
        let is_kept = || {
            matches!(self.step.scheme, Scheme::Explicit { .. })
                || self.ends_step(new)
                || model.requests.is_time(new.time)
                || new.time - last >= interval * (1.0 - ROUND_OFF)
        };
        match regimes(model, self.old) != regimes(model, new) {
            true => Row::AfterTheHeld,
            false if is_kept() => Row::Written,
            false => Row::Pending,
        }
    }
}

fn regimes(model: &Model, state: &State) -> Vec<Regime> {
    let pairs = model.contacts.iter().zip(&state.contacts);
    pairs.flat_map(|(pair, states)| pair.points.iter().zip(states).map(|(p, state)| pair.regime(p, state))).collect()
}

/// Fraction of the interval allowed for round-off.
const ROUND_OFF: f64 = 1e-9;

/// Role of an increment in the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Row {
    /// A row of the results.
    Written,
    /// A row, preceded by the pending increment before it, if there is one.
    AfterTheHeld,
    /// A row only if an event follows. Rejected attempts are never rows.
    Pending,
}

/// Outcome of an attempt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Verdict {
    /// Accepted, or paused before its end.
    Accepted,
    /// No equilibrium was found.
    Unsolved,
    /// The reaction that ends the step overshot its value.
    Passed,
    /// Its local error was too large.
    Error,
    /// Contact closed within the increment, at a time that its friction depends on.
    Touch,
    /// A contact began to slip fast; explicit increments follow.
    Rupture,
    /// Its tangent has more negative eigenvalues than before: it has passed from stable equilibria to unstable ones.
    Unstable,
}

impl Verdict {
    /// One-word name for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::Unsolved => "unsolved",
            Self::Passed => "passed",
            Self::Error => "error",
            Self::Touch => "touch",
            Self::Rupture => "rupture",
            Self::Unstable => "unstable",
        }
    }
}

/// Observer of a run.
pub trait Observer {
    /// Called after every attempt.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if a file cannot be written, which ends the run.
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error>;

    /// Name under which its memory is saved.
    fn name(&self) -> &'static str {
        ""
    }

    /// Returns its memory and the extent of its output, for [`restore`](Self::restore); empty by default.
    ///
    /// # Errors
    /// The same as for [`record`](Self::record).
    fn save(&mut self) -> Result<Vec<u8>, Error> {
        Ok(Vec::new())
    }

    /// Checks, without changes, whether it can resume from the saved memory: whether its output up to then still exists.
    ///
    /// # Errors
    /// The same as for [`record`](Self::record), with a description of the mismatch.
    fn check(&self, _memory: &[u8]) -> Result<(), Error> {
        Ok(())
    }

    /// Resumes from the saved memory and removes later output.
    ///
    /// # Errors
    /// The same as for [`record`](Self::record).
    fn restore(&mut self, _memory: &[u8]) -> Result<(), Error> {
        Ok(())
    }

    /// Called once after the last attempt, to complete pending output.
    ///
    /// # Errors
    /// The same as for [`record`](Self::record).
    fn finish(&mut self) -> Result<(), Error> {
        Ok(())
    }
}

/// Formats an error or uncertainty with the printed number of digits.
fn rounded(value: f64) -> String {
    format!("{value:.2e}")
}

impl Attempt<'_> {
    /// Reason of the rejection; `None` if the attempt was accepted or paused.
    pub fn reason(&self) -> Option<String> {
        let Self { step, verdict, cause, .. } = self;
        Some(match verdict {
            Verdict::Accepted => return None,
            Verdict::Unsolved => cause.map_or_else(|| "not solved".into(), |cause| self.unsolved(cause)),
            Verdict::Passed => "solved, but the reaction overshot the value that ends the step".into(),
            Verdict::Error => self.inexact(),
            Verdict::Touch => {
                let share = 100.0 * self.uncertainty.unwrap_or_default();
                format!(
                    "solved, but contact closed within the increment; friction force uncertain by {share:.2} % of the \
                     contact force"
                )
            }
            Verdict::Unstable => "solved, but the equilibrium is unstable, and that before was not".into(),
            Verdict::Rupture => {
                let rate = step.rupture.as_ref().map_or(0.0, |rupture| rupture.slip_rate);
                format!("solved, but a contact slips faster than rupture.slip_rate = {}", number(rate))
            }
        })
    }

    /// Reason why no equilibrium was found, with the contact status at the end of the iterations.
    fn unsolved(&self, cause: &IncrementFailure) -> String {
        let ended = matches!(cause, IncrementFailure::Newton(failure) if failure.is_without_end());
        let Some(last) = self.iterations.last().filter(|_| ended) else { return cause.to_string() };
        let closed = last.contacts.stick + last.contacts.slip;
        match last.flips {
            _ if closed == 0 && last.contacts.open > 0 => {
                format!(
                    "{cause}; all contact points had opened during the iterations, and nothing constrained the bodies"
                )
            }
            0 => cause.to_string(),
            flips => format!("{cause}; {} still changing between open, stick and slip", count(flips, "contact point")),
        }
    }

    /// Reason of a rejection because of the time error.
    fn inexact(&self) -> String {
        match self.local_error {
            Some(LocalError { estimate, allowed }) if estimate > allowed => {
                let is_given = self.step.increments.error == Some(allowed);
                let what = if is_given { "dt.error = " } else { "the error allowed in slip, " };
                format!("solved, but the local error {} is above {what}{}", rounded(estimate), number(allowed))
            }
            _ => "solved, but a contact began to slip, stopped or reversed at a time that dt.error requires to be \
                  located"
                .into(),
        }
    }
}

impl Verdict {
    /// Short name of the rejection, for counting.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::Unsolved => "not solved",
            Self::Passed => "reaction overshot",
            Self::Error => "time error",
            Self::Touch => "contact closure",
            Self::Unstable => "unstable equilibrium",
            Self::Rupture => "rupture",
        }
    }
}
