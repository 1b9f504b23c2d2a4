//! Bodies with internal variables or an unsymmetric tangent; internal variables are part of committed and trial state.

use std::sync::Arc;

use rayon::prelude::*;

use super::sums::{Sums, TrialFailure};
use super::trial::{Trial, nodal};
use crate::model::element::Memory;
use crate::model::{Activated, Model};

/// Number of elements whose contributions are stored at once before they are added.
const BATCH: usize = 1024;

/// Elements of such bodies, evaluated each time.
#[derive(Clone, Debug)]
pub(super) struct Evolving {
    /// Whether each element is one of them; empty if none is
    own: Vec<bool>,
    /// Most dofs of one
    dofs: usize,
    /// Forces and tangents of a batch, column by column, in chunks for as many dofs each
    forces: Vec<f64>,
    tangents: Vec<f64>,
    /// Elements that came into a deformed model
    activated: Arc<Activated>,
}

/// Memory for the force and the tangent of an element.
type Place<'a> = (&'a mut [f64], &'a mut [f64]);

/// Whether a body is one of them.
pub(super) fn evolves(model: &Model, body: usize) -> bool {
    let material = model.bodies[body].law_of_elements();
    !material.description().variables.is_empty() || !material.description().is_symmetric
}

impl Evolving {
    /// Finds the evolving elements that are there, except those that are `constant`; `activated` came into a deformed model.
    pub fn new(
        model: &Model,
        constant: &[bool],
        are_there: impl Fn(usize) -> bool,
        activated: &Arc<Activated>,
    ) -> Self {
        let is_own = |e: usize| evolves(model, model.body_of_element[e]) && !constant[e] && are_there(e);
        let mut own: Vec<bool> = (0..constant.len()).map(is_own).collect();
        let elements = model.mesh.elements.iter().zip(&own);
        let dofs = elements.filter(|(_, own)| **own).map(|(element, _)| 2 * element.nodes.len()).max();
        if dofs.is_none() {
            own.clear();
        }
        let activated = activated.clone();
        Self { own, dofs: dofs.unwrap_or_default(), forces: Vec::new(), tangents: Vec::new(), activated }
    }

    /// Adds the forces of these elements, and stores their internal variables at the end of the trial in `memory`.
    pub fn add(
        &mut self,
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
        if self.own.is_empty() {
            return Ok(Evolved::default());
        }
        let Self { own, dofs, forces, tangents, activated } = self;
        let (dofs, size) = (*dofs, *dofs * *dofs);
        let count = BATCH.min(own.len());
        forces.resize(count * dofs, 0.0);
        tangents.resize(count * size, 0.0);
        let wanted = sums.tangent.is_some();
        let yields: Vec<bool> = model.bodies.iter().map(|body| body.material.description().flow.is_some()).collect();
        let one = |((e, new), (force, tangent)): ((usize, &mut [f64]), Place)| {
            let old = model.memories.of(e, old);
            model.write_temperatures(trial.step, trial.moment(), e, old, new);
            model.write_pressures(trial.moment(), e, new);
            model.write_flow(Some(u), e, new);
            let body = &model.bodies[model.body_of_element[e]];
            let (n, memory) = (model.mesh.elements[e].nodes.len(), Memory { dt: trial.dt, old, new: &mut *new });
            let (u, dofs) = (&nodal(model, e, u)[..n], 2 * n);
            let tangent = wanted.then_some(&mut tangent[..dofs * dofs]);
            let solid = model.as_activated(activated, e);
            let found = solid.evolve(&*body.material, memory, u, &mut force[..dofs], tangent);
            let energies = found.map_err(|failure| TrialFailure::material(model, e, failure))?;
            Ok((e, energies, model.heating(solid, e, [old, new]) + model.filling(solid, e, [old, new])))
        };
        let mut all = Evolved::default();
        let elements = model.memories.each_mut(memory).enumerate().zip(&*own);
        let mut elements = elements.filter_map(|(element, own)| own.then_some(element));
        loop {
            let batch: Vec<(usize, &mut [f64])> = elements.by_ref().take(BATCH).collect();
            if batch.is_empty() {
                break;
            }
            let places = forces.par_chunks_exact_mut(dofs).zip(tangents.par_chunks_exact_mut(size));
            let answers: Vec<Result<_, TrialFailure>> = batch.into_par_iter().zip(places).map(one).collect();
            let places = forces.chunks_exact(dofs).zip(tangents.chunks_exact(size));
            for (answer, (force, tangent)) in answers.into_iter().zip(places) {
                let (e, [stored, lost], work) = answer?;
                all.stored += stored;
                *(if yields[model.body_of_element[e]] { &mut all.plastic } else { &mut all.dissipated }) += lost;
                all.heating += work;
                let nodes = &model.mesh.elements[e].nodes;
                sums.push(nodes, &force[..2 * nodes.len()]);
                if wanted {
                    sums.couple_element(e, nodes.len(), &tangent[..4 * nodes.len() * nodes.len()]);
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
    /// Work of changes of temperatures and of pressures in pores
    pub heating: f64,
}
