//! Bodies with internal variables or an unsymmetric tangent; internal variables are part of committed and trial state.

use rayon::prelude::*;

use super::sums::{Sums, TrialFailure};
use super::trial::Trial;
use crate::laws::bulk::MaterialFailure;
use crate::linear::system::Contribution;
use crate::model::Model;
use crate::model::element::Memory;

/// Number of elements whose contributions are held at once before they are added.
const BATCH: usize = 1024;

/// Whether each element belongs to such a body; empty if none does.
#[derive(Clone, Debug)]
pub(super) struct Evolving(Vec<bool>);

/// Whether a body is one of them.
pub(super) fn evolves(model: &Model, body: usize) -> bool {
    let material = &model.bodies[body].material;
    !material.description().variables.is_empty() || !material.description().is_symmetric
}

impl Evolving {
    /// Finds the evolving elements of the bodies, except those that are `constant`.
    pub fn new(model: &Model, constant: &[bool]) -> Self {
        let own = |(&body, constant): (&usize, &bool)| evolves(model, body) && !constant;
        let all: Vec<bool> = model.body_of_element.iter().zip(constant).map(own).collect();
        Self(if all.contains(&true) { all } else { Vec::new() })
    }

    /// Adds the forces of these elements, and stores their internal variables at the end of the trial in `memory`.
    pub fn add(
        &self,
        model: &Model,
        trial: Trial,
        u: &[f64],
        memory: &mut Vec<f64>,
        sums: &mut Sums,
    ) -> Result<Evolved, TrialFailure> {
        let old = &trial.old.memory;
        if memory.len() != old.len() {
            // The initial stress of constant elements is unchanged.
            memory.clone_from(old);
        }
        let mut all = Evolved::default();
        let wanted = sums.tangent.is_some();
        let one = |(e, new): (usize, &mut [f64])| {
            let old = model.memories.of(e, old);
            model.write_temperatures(trial.step, trial.moment(), e, old, new);
            let found = evolve(model, e, Memory { dt: trial.dt, old, new: &mut *new }, u, wanted);
            let found = found.map_err(|failure| TrialFailure::material(model, e, failure))?;
            let yields = model.bodies[model.body_of_element[e]].material.description().flow.is_some();
            Ok((found, model.heating(e, [old, new]), yields))
        };
        let elements = model.memories.each_mut(memory).enumerate().zip(&self.0);
        let mut own = elements.filter_map(|(element, own)| own.then_some(element));
        loop {
            let batch: Vec<(usize, &mut [f64])> = own.by_ref().take(BATCH).collect();
            if batch.is_empty() {
                break;
            }
            let answers: Vec<Result<_, TrialFailure>> = batch.into_par_iter().map(one).collect();
            for answer in answers {
                let (([stored, lost], contribution), work, yields) = answer?;
                all.stored += stored;
                *(if yields { &mut all.plastic } else { &mut all.dissipated }) += lost;
                all.heating += work;
                sums.contribute(&contribution);
            }
        }
        Ok(all)
    }
}

/// Energies of these elements in an increment [F·L].
#[derive(Default)]
pub struct Evolved {
    /// ∫ W dV at its end
    pub stored: f64,
    /// Dissipation of those that do not yield
    pub dissipated: f64,
    /// Dissipation of those that do
    pub plastic: f64,
    /// Work of the temperature change
    pub heating: f64,
}

/// Contribution of one element, with its stored energy and dissipation.
fn evolve(
    model: &Model,
    e: usize,
    memory: Memory,
    u: &[f64],
    tangent: bool,
) -> Result<([f64; 2], Contribution), MaterialFailure> {
    let local = model.mesh.vectors(e, u);
    let mut contribution = Contribution::zero(model.mesh.elements[e].nodes.clone());
    let Contribution { force, tangent: matrix, .. } = &mut contribution;
    let matrix = tangent.then_some(matrix.as_mut_slice());
    let material = &*model.bodies[model.body_of_element[e]].material;
    let energies = model.solids[e].evolve(material, memory, &local, force.as_mut_slice(), matrix)?;
    Ok((energies, contribution))
}
