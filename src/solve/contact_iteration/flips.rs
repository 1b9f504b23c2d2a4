//! Flips: contact states that come back every other iterate, for the record of convergence.

use crate::contact::force::{ContactState, Status};

/// Watches the contact states go to and fro between iterations: the status of every point at the last two iterates.
#[derive(Clone, Debug, Default)]
pub struct Flips([Vec<Status>; 2]);

impl Flips {
    /// Number of points that are as they were before the last iterate, and were not in it.
    pub fn count(&mut self, contacts: &[Vec<ContactState>]) -> usize {
        let now: Vec<Status> = contacts.iter().flatten().map(ContactState::status).collect();
        let [last, before] = std::mem::take(&mut self.0);
        let states = now.iter().zip(&last).zip(&before);
        let count = states.filter(|((now, last), before)| now == before && now != last).count();
        self.0 = [now, last];
        count
    }
}
