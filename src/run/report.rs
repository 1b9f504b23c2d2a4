//! Counts and times of a run.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::control::Outcome;
use crate::model::state::Energy;

/// Counts and times of a run.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct RunReport {
    /// accepted increments
    pub increments: usize,
    /// attempts that could not be solved
    pub cutbacks: usize,
    /// attempts that were solved, and repeated because their error was too large or they met an event of contact
    pub rejected: usize,
    /// the same attempts, solved or not, by why they were given up
    pub given_up: BTreeMap<String, usize>,
    /// times that a step turned to explicit increments because a contact slipped fast
    pub ruptures: usize,
    /// linear solves, those of failed attempts included
    pub newton_iterations: usize,
    /// matrix factorizations
    pub factorizations: usize,
    /// energies at the end
    pub energy: Energy,
    /// energy that went into the stabilization of floating bodies [F·L]
    pub stabilization_work: f64,
    /// wall time by phase
    pub wall_s: WallSeconds,
}

impl RunReport {
    /// Count an attempt if it was given up.
    pub(super) fn note(&mut self, outcome: &Outcome) {
        let (count, kind) = match outcome {
            Outcome::Rejected(why, _) => (&mut self.rejected, why.kind()),
            Outcome::Cut(cause, _) | Outcome::Collapsed(_, cause) => (&mut self.cutbacks, cause.kind()),
            Outcome::Accepted(_) | Outcome::Paused(_) | Outcome::Stopped(_) => return,
        };
        *count += 1;
        *self.given_up.entry(kind.into()).or_default() += 1;
    }
}

/// Wall time by phase [s].
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct WallSeconds {
    /// everything
    pub total: f64,
    /// solids, loads, sums
    pub assembly: f64,
    /// search, friction, contact forces
    pub contact: f64,
    /// factorization and solution
    pub linear: f64,
    /// observers
    pub output: f64,
}
