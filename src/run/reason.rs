//! Why an attempt was given up: in a sentence, and in so few words that they can be counted.

use super::observer::{Attempt, Verdict};
use crate::model::told::{count, number};
use crate::solve::failure::IncrementFailure;
use crate::solve::newton::NewtonFailure;

/// Digits of an error or a doubt that is told.
fn rounded(value: f64) -> String {
    format!("{value:.2e}")
}

impl Attempt<'_> {
    /// Why it led to no new state; `None` if it did, or paused on its way there.
    pub fn reason(&self) -> Option<String> {
        let Self { step, verdict, cause, .. } = self;
        Some(match verdict {
            Verdict::Accepted => return None,
            Verdict::Unsolved => cause.map_or_else(|| "not solved".into(), |cause| self.unsolved(cause)),
            Verdict::Passed => "solved, but the reaction that ends the step passed its value".into(),
            Verdict::Error => self.inexact(),
            Verdict::Touch => {
                let share = 100.0 * self.doubt.unwrap_or_default();
                format!("solved, but points touched on the way: {share:.2} % of a contact's force depends on when")
            }
            Verdict::Rupture => {
                let rate = step.rupture.as_ref().map_or(0.0, |rupture| rupture.slip_rate);
                format!("solved, but a contact slips faster than rupture.slip_rate = {}", number(rate))
            }
        })
    }

    /// Why no equilibrium was found, and how the contacts stood when the iterations ended without one.
    fn unsolved(&self, cause: &IncrementFailure) -> String {
        let ended = matches!(
            cause,
            IncrementFailure::Newton(NewtonFailure::Diverged { .. } | NewtonFailure::TooManyIterations { .. })
        );
        let Some(last) = self.iterations.last().filter(|_| ended) else { return cause.to_string() };
        let closed = last.contacts.stick + last.contacts.slip;
        match last.flips {
            _ if closed == 0 && last.contacts.open > 0 => {
                format!("{cause}; all contact points had opened on the way, and nothing held the bodies")
            }
            0 => cause.to_string(),
            flips => format!("{cause}; {} still changed between open, stick and slip", count(flips, "contact point")),
        }
    }

    /// What was wrong in time.
    fn inexact(&self) -> String {
        let allowed = self.step.increments.error.unwrap_or_default();
        match self.local_error {
            Some(error) if error > allowed => {
                format!("solved, but the local error {} is above dt.error = {}", rounded(error), number(allowed))
            }
            _ => "solved, but a contact began to slip, stopped or turned round, at a moment that dt.error wants to be met".into(),
        }
    }
}

impl Verdict {
    /// Why a solved attempt was repeated, in a few words.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::Unsolved => "not solved",
            Self::Passed => "reaction passed",
            Self::Error => "error in time",
            Self::Touch => "points touched",
            Self::Rupture => "rupture",
        }
    }
}
