//! Parts of the equations by themselves: the masses, and the tangent of one term.

use super::Assembler;
use crate::contact::response::PairResponse;
use crate::equations::failure::TrialFailure;
use crate::equations::inertia::{self, Inertia};
use crate::equations::term::Term;
use crate::equations::trial::Trial;
use crate::linear::SparseMatrix;
use crate::linear::system::Request;

impl Assembler {
    /// Number of the distinct stiffness matrices that the elements whose tangent never changes share.
    pub fn stored_matrices(&self) -> usize {
        self.solids.matrices()
    }

    /// The mass matrix on the current pattern.
    pub fn mass(&mut self) -> &SparseMatrix {
        let Self { model, layout, mass, .. } = self;
        mass.get_or_insert_with(|| inertia::mass(model, layout))
    }

    /// The tangent of one term by itself, with no supports: see [`Term::dependence`].
    ///
    /// # Errors
    /// As [`Assembler::residual`].
    pub fn tangent_of(&mut self, term: Term, trial: Trial, u: &[f64]) -> Result<SparseMatrix, TrialFailure> {
        self.with_responses(trial, u, Request::Tangent, |assembler, responses| {
            assembler.tangent_with(term, trial, u, responses)
        })
    }

    fn tangent_with(
        &mut self,
        term: Term,
        trial: Trial,
        u: &[f64],
        responses: &[PairResponse],
    ) -> Result<SparseMatrix, TrialFailure> {
        self.cover(trial, responses);
        let mut tangent = self.layout.matrix();
        if term == Term::Inertia {
            let mass = self.mass().clone();
            let inertia = Inertia::at(&self.model, trial, u, &mass);
            inertia.into_iter().for_each(|inertia| inertia.stiffen(&self.model, &mass, &mut tangent));
            return Ok(tangent);
        }
        let kept = std::mem::take(&mut self.evaluation);
        let added = self.add(&[term], (trial, u, None), responses, false, Some(&mut tangent));
        self.evaluation = kept;
        added.map(|()| tangent)
    }
}
