//! Bodies with internal variables or an unsymmetric tangent; internal variables are part of committed and trial state.

use rayon::prelude::*;

use super::sums::{Sums, TrialFailure};
use super::trial::Trial;
use crate::laws::bulk::MaterialFailure;
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
                let (Answer { nodes, force, tangent, energies: [stored, lost] }, work, yields) = answer?;
                all.stored += stored;
                *(if yields { &mut all.plastic } else { &mut all.dissipated }) += lost;
                all.heating += work;
                sums.push(nodes, &force);
                if wanted {
                    sums.couple(nodes, &tangent);
                }
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

/// Force and tangent of one element, with its stored energy and dissipation.
struct Answer<'a> {
    nodes: &'a [usize],
    force: Vec<f64>,
    /// column by column, or empty where none is wanted
    tangent: Vec<f64>,
    energies: [f64; 2],
}

fn evolve<'a>(
    model: &'a Model,
    e: usize,
    memory: Memory,
    u: &[f64],
    wanted: bool,
) -> Result<Answer<'a>, MaterialFailure> {
    let (local, nodes) = (model.mesh.vectors(e, u), &*model.mesh.elements[e].nodes);
    let dofs = 2 * nodes.len();
    let (mut force, mut tangent) = (vec![0.0; dofs], vec![0.0; if wanted { dofs * dofs } else { 0 }]);
    let material = &*model.bodies[model.body_of_element[e]].material;
    let matrix = wanted.then_some(&mut *tangent);
    let energies = model.solids[e].evolve(material, memory, &local, &mut force, matrix)?;
    Ok(Answer { nodes, force, tangent, energies })
}
