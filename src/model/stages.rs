//! Bodies that come and go with the steps.
//!
//! ```text
//! R = F(u₀; bodies of the step) − F(u₀; bodies before)           at the start of the step
//! F(u; bodies of the step) − (1 − s) R = 0                       s: elapsed fraction of the step
//! ```
//!
//! A step that adds or removes bodies begins in the equilibrium of the one before, whatever the bodies exerted on the rest: internal
//! forces, contact, weight and other loads. The difference fades linearly to zero.
//!
//! Nodes that only absent bodies have are held where they are.

use super::Model;
use super::state::State;
use super::step::Step;
use crate::contact::pair::ContactPair;
use crate::contact::point::ContactState;

#[doc(hidden)]
impl Model {
    /// Nodes that only absent bodies have, ascending; of tied ones the original.
    pub fn idle_nodes(&self, absent: &[bool]) -> Vec<usize> {
        let mut is_idle = vec![false; self.mesh.nodes.len()];
        for is_absent in [true, false] {
            let bodies = self.bodies.iter().zip(absent).filter(|(_, absent)| **absent == is_absent);
            let nodes = bodies.flat_map(|(body, _)| self.ties.originals(body.nodes.iter().copied()));
            nodes.for_each(|node| is_idle[node] = is_absent);
        }
        (0..is_idle.len()).filter(|node| is_idle[*node]).collect()
    }

    /// The states of a contact at the start of the run.
    pub fn first_states(&self, pair: &ContactPair) -> Vec<ContactState> {
        match self.steps.first().is_none_or(|step| step.joins(pair)) {
            true => pair.initial_states(&self.mesh.undeformed()),
            false => pair.apart(),
        }
    }

    /// Takes the history from the bodies that a step adds or removes, and from their contacts.
    pub fn forget(&self, step: &Step, state: &mut State) {
        let initial = self.initial_memory();
        let memory = self.memories.each_mut(&mut state.memory).zip(self.memories.each(&initial));
        for ((own, initial), body) in memory.zip(&self.body_of_element) {
            if step.changed.contains(body) {
                own.copy_from_slice(initial);
            }
        }
        let x = self.configuration(&state.displacement);
        for (pair, states) in self.contacts.iter().zip(&mut state.contacts) {
            if pair.bodies.iter().flatten().any(|body| step.changed.contains(body)) {
                *states = if step.joins(pair) { pair.initial_states(&x) } else { pair.apart() };
            }
        }
    }
}
