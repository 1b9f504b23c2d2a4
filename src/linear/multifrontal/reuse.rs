//! Which fronts of an earlier factorization stay: those whose values have not changed, nor those of any front below.
//!
//! Only what passes from a front that stays to one that does not must be at hand again; it is kept from the second
//! factorization on in which it is wanted. A front that is eliminated anew has the same values and children as in a
//! factorization from scratch, and so the same bits.

use std::collections::HashMap;

use super::front::Front;
use super::symbolic::{Entry, Symbolic};

/// What becomes of a front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// It is eliminated
    Eliminate,
    /// It is eliminated, and what it passes on is kept for the next time
    EliminateAndKeep,
    /// It stays, and what it passes on is at hand
    PassOn,
    /// It stays, and so does the front above
    Rest,
}

impl Action {
    /// Whether the front is eliminated.
    pub fn eliminates(self) -> bool {
        matches!(self, Self::Eliminate | Self::EliminateAndKeep)
    }
}

/// What becomes of every front when the values `new` follow those `before`, if any, and this is `kept`.
pub fn actions(symbolic: &Symbolic, before: Option<&[f64]>, new: &[f64], kept: &HashMap<u32, Vec<f64>>) -> Vec<Action> {
    let fronts = &symbolic.fronts;
    let Some(before) = before else { return vec![Action::Eliminate; fronts.len()] };
    let mut changed: Vec<bool> = Vec::with_capacity(fronts.len());
    for front in fronts {
        let below = front.children.iter().any(|&child| changed[child as usize]);
        changed.push(below || values_changed(front, &symbolic.entries, before, new));
    }
    // Nothing wants what a root passes on.
    let mut wanted = vec![false; fronts.len()];
    let mut actions = vec![Action::Rest; fronts.len()];
    for (number, front) in fronts.iter().enumerate().rev() {
        actions[number] = match (changed[number], wanted[number]) {
            (true, _) => Action::Eliminate,
            (false, false) => Action::Rest,
            (false, true) if kept.contains_key(&(number as u32)) => Action::PassOn,
            (false, true) => Action::EliminateAndKeep,
        };
        front.children.iter().for_each(|&child| wanted[child as usize] = actions[number].eliminates());
    }
    actions
}

/// Whether the values of A in a front are others than before.
fn values_changed(front: &Front, entries: &[Entry], before: &[f64], new: &[f64]) -> bool {
    let blocks = entries[front.lower.start..front.upper.end].iter().map(|entry| entry.block);
    let mut columns = blocks.flat_map(|block| [block.value(0, 0), block.value(0, 1)]);
    columns.any(|first| (0..2).any(|i| before[first + i].to_bits() != new[first + i].to_bits()))
}
