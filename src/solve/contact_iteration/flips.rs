//! Flips: contact states that come back every other iterate, for the record of the iterations.

use crate::contact::force::ContactState;
use crate::laws::friction::Regime;

/// Regime of every point at the last two iterates.
#[derive(Clone, Debug, Default)]
pub struct Flips([Vec<Regime>; 2]);

impl Flips {
    /// Number of points that are as they were before the last iterate, and were not in it.
    pub fn count(&mut self, contacts: &[Vec<ContactState>]) -> usize {
        let now: Vec<Regime> = contacts.iter().flatten().map(ContactState::regime).collect();
        let [last, before] = std::mem::take(&mut self.0);
        let back = now.iter().zip(&last).zip(&before).filter(|((now, last), before)| now == before && now != last);
        let count = back.count();
        self.0 = [now, last];
        count
    }
}
