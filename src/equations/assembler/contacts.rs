//! What the assembler asks of the contacts, and what it keeps of their answers.

use std::time::Instant;

use super::Assembler;
use crate::contact::pair::Presumption;
use crate::contact::response::PairResponse;
use crate::equations::failure::TrialFailure;
use crate::equations::interfaces;
use crate::equations::trial::Trial;
use crate::linear::system::Request;

impl Assembler {
    /// Do something with the responses of all contact points where nothing is presumed.
    ///
    /// # Errors
    /// [`TrialFailure`] when a friction law fails, and those of what is done.
    pub fn with_responses<T>(
        &mut self,
        trial: Trial,
        u: &[f64],
        request: Request,
        act: impl FnOnce(&mut Self, &[PairResponse]) -> Result<T, TrialFailure>,
    ) -> Result<T, TrialFailure> {
        let mut responses = std::mem::take(&mut self.responses);
        let found = self.interfaces(trial, u, |_, _| Presumption::default(), request, &mut responses);
        let done = found.and_then(|()| act(self, &responses));
        self.responses = responses;
        done
    }

    /// Responses of all contact points at the displacement `u`, with what is presumed about a point of a pair: for a tangent
    /// alone, a residual that may be accepted knows no presumptions. They come in `responses`, whose memory is used again.
    ///
    /// # Errors
    /// [`TrialFailure`] when a friction law fails.
    pub fn interfaces(
        &mut self,
        trial: Trial,
        u: &[f64],
        presumed: impl Fn(usize, usize) -> Presumption + Sync,
        request: Request,
        responses: &mut Vec<PairResponse>,
    ) -> Result<(), TrialFailure> {
        if self.model.contacts.is_empty() {
            return Ok(());
        }
        let clock = Instant::now();
        let answer = interfaces::respond(&self.model, trial, u, presumed, request, responses);
        self.seconds.contact += clock.elapsed().as_secs_f64();
        answer
    }

    /// Keep the states of the contact points, and how large their forces are.
    pub fn note_contacts(&mut self, trial: Trial, responses: &[PairResponse]) {
        self.equilibrium.note_contacts(&self.model, trial, responses);
        self.keep_states(responses);
    }

    /// Norm of the nodal forces of each contact at the last evaluation [F].
    pub fn contact_forces(&self) -> &[f64] {
        self.equilibrium.contact_forces()
    }

    /// |u|² of some nodes, as far as round-off of it counts [L²].
    pub fn ways(&self, trial: Trial, u: &[f64], nodes: &[usize]) -> Vec<f64> {
        self.equilibrium.ways(trial.old, u, nodes)
    }

    /// Square of what round-off of the contacts that were noted last can leave at nodes that have gone these ways [F²].
    pub fn contact_round_off(&self, nodes: &[usize], ways: &[f64]) -> f64 {
        self.equilibrium.contact_round_off(nodes, ways)
    }

    /// Square of what round-off can leave at every node, at the displacement that was evaluated last [F²].
    pub fn round_off(&self, trial: Trial, u: &[f64]) -> Vec<f64> {
        let mass = self.mass.as_ref().filter(|_| trial.step.scheme.coefficients().is_some());
        self.equilibrium.round_off((&self.model, mass), trial, u, &self.magnitudes)
    }

    /// Keep the trial states of the contact points for the accepted state.
    pub(super) fn keep_states(&mut self, responses: &[PairResponse]) {
        let contacts = &mut self.evaluation.contacts;
        contacts.resize_with(responses.len(), Vec::new);
        contacts.iter_mut().zip(responses).for_each(|(states, pair)| states.clone_from(&pair.states));
    }
}
