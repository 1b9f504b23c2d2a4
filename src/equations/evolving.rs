//! Bodies that remember, or whose tangent is not symmetric: what they remember is committed and trial state.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::Vector2;
use rayon::prelude::*;

use super::{Assembler, BATCH, Trial};
use crate::equations::failure::TrialFailure;
use crate::laws::bulk::InvertedElement;
use crate::linear::SparseMatrix;
use crate::linear::system::Contribution;
use crate::model::Model;
use crate::model::element::Memory;

/// The elements of such bodies, and where each finds what it remembers.
#[derive(Clone, Debug)]
pub(super) struct Evolving(Arc<[(usize, Range<usize>)]>);

impl Evolving {
    pub(super) fn new(model: &Model) -> Self {
        let evolves = |e: usize| {
            let material = &model.bodies[model.body_of_element[e]].material;
            !material.variables().is_empty() || !material.is_symmetric()
        };
        Self(model.memories().into_iter().enumerate().filter(|(e, _)| evolves(*e)).collect())
    }

    /// Whether an element is one of them.
    pub(super) fn has(&self, e: usize) -> bool {
        !self.0.is_empty() && self.0.binary_search_by_key(&e, |(e, _)| *e).is_ok()
    }
}

impl Assembler<'_> {
    /// Add the forces of these elements, with their variables at the end of the trial and what they dissipate; returns the
    /// stored energy.
    pub(super) fn add_evolving(
        &mut self,
        trial: Trial,
        u: &[f64],
        force: &mut [f64],
        mut tangent: Option<&mut SparseMatrix>,
    ) -> Result<f64, TrialFailure> {
        let (model, evolving, old) = (self.model, self.evolving.clone(), &trial.old.memory);
        let mut memory = std::mem::take(&mut self.evaluation.memory);
        memory.resize(old.len(), 0.0);
        let mut rest = &mut memory[..];
        let (mut energy, mut heat) = (0.0, 0.0);
        for batch in evolving.0.chunks(BATCH) {
            let mut trials: Vec<&mut [f64]> = Vec::with_capacity(batch.len());
            for (_, range) in batch {
                let (own, after) = std::mem::take(&mut rest).split_at_mut(range.len());
                trials.push(own);
                rest = after;
            }
            let wanted = tangent.is_some();
            let one = |((e, range), new): (&(usize, Range<usize>), &mut [f64])| {
                evolve(model, *e, Memory { dt: trial.dt, old: &old[range.clone()], new }, u, wanted)
            };
            let answers: Vec<_> = batch.par_iter().zip(trials).map(one).collect();
            for ((e, _), answer) in batch.iter().zip(answers) {
                let ([stored, dissipated], contribution) = answer.map_err(|inverted| self.inverted(*e, inverted))?;
                energy += stored;
                heat += dissipated;
                self.add(&contribution, force, tangent.as_deref_mut());
            }
        }
        (self.evaluation.memory, self.evaluation.dissipated) = (memory, heat);
        Ok(energy)
    }
}

/// What one element adds, with its stored energy and what it dissipates.
fn evolve(
    model: &Model,
    e: usize,
    memory: Memory,
    u: &[f64],
    tangent: bool,
) -> Result<([f64; 2], Contribution), InvertedElement> {
    let nodes = &model.mesh.elements[e].nodes;
    let local: Vec<Vector2<f64>> = nodes.iter().map(|&node| Vector2::new(u[2 * node], u[2 * node + 1])).collect();
    let mut contribution = Contribution::zero(nodes.clone());
    let Contribution { force, tangent: matrix, .. } = &mut contribution;
    let matrix = tangent.then_some(matrix.as_mut_slice());
    let material = &*model.bodies[model.body_of_element[e]].material;
    let energies = model.solids[e].evolve(material, memory, &local, force.as_mut_slice(), matrix)?;
    Ok((energies, contribution))
}
