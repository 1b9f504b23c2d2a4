//! Cycles: contact states that come back every other iterate. Half of a correction ends between them.

use crate::contact::force::{ContactState, Status};

/// Watches the contact states go to and fro between iterations.
#[derive(Clone, Debug, Default)]
pub struct Cycle {
    /// Status of every point at the last two iterates
    last: [Vec<Status>; 2],
    /// Iterations in a row in which each point came back
    returns: Vec<usize>,
}

/// Returns in a row that are taken for a cycle. The edge of a contact that is finding its place comes back once or twice.
const CYCLE: usize = 3;

impl Cycle {
    /// Number of points that are as they were before the last iterate, and were not in it.
    pub fn count(&mut self, contacts: &[Vec<ContactState>]) -> usize {
        let now: Vec<Status> = contacts.iter().flatten().map(ContactState::status).collect();
        let [last, before] = std::mem::take(&mut self.last);
        self.returns.resize(now.len(), 0);
        for (returns, ((now, last), before)) in self.returns.iter_mut().zip(now.iter().zip(&last).zip(&before)) {
            *returns = if now == before && now != last { *returns + 1 } else { 0 };
        }
        self.last = [now, last];
        self.returns.iter().filter(|returns| **returns > 0).count()
    }

    /// Share of the next correction to take: half of it ends between the two states of a cycle.
    pub fn share(&self) -> f64 {
        if self.returns.iter().any(|returns| *returns >= CYCLE) { 0.5 } else { 1.0 }
    }
}
