//! Stress of the bodies: every element's forces on its nodes, and the sums of them at each node.
//!
//! Elements of one kind and law follow each other in a run and are evaluated in parallel; then every node sums up what its
//! elements put there, in their order: the same bits on any number of threads, and nothing is written twice.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::Vector2;
use rayon::prelude::*;

use super::coupling::Layout;
use super::dependence::Dependence;
use super::evolving::evolves;
use super::sums::{Sums, add_blocks};
use crate::equations::failure::TrialFailure;
use crate::laws::bulk::InvertedElement;
use crate::linear::SparseMatrix;
use crate::model::Model;

/// Elements whose tangents are held at once before they are added.
const BATCH: usize = 1024;

/// Elements that are done sooner than another thread wakes up.
const FEW: usize = 64;

/// Nodes whose sums are done sooner than another thread wakes up.
const FEW_NODES: usize = 1024;

/// Whether the tangent of an element is the same at every displacement: a linear law at small strains that remembers nothing;
/// with F-bar the tangent changes nevertheless.
pub fn is_constant(model: &Model, element: usize) -> bool {
    let body = model.body_of_element[element];
    model.bodies[body].material.is_linear() && !model.solids[element].is_f_bar() && !evolves(model, body)
}

/// It is the same matrix throughout if all elements are constant.
pub(super) fn dependence(model: &Model) -> Dependence {
    let all = (0..model.solids.len()).all(|e| is_constant(model, e));
    if all { Dependence::Nothing } else { Dependence::Displacement }
}

/// The elements of a model, what each puts on its nodes, and where each node finds its own.
pub(super) struct Solids {
    model: Arc<Model>,
    runs: Vec<Run>,
    /// Where the places of each node start, and where the last one's end
    starts: Vec<usize>,
    /// Places in `forces`, in the order of the elements
    places: Vec<usize>,
    /// Forces of the elements on their nodes [F]
    forces: Vec<Vector2<f64>>,
    /// What each element stores [F·L]
    energies: Vec<Result<f64, InvertedElement>>,
    /// Tangents of a batch, column by column
    tangents: Vec<f64>,
}

/// Elements of one kind and body that follow each other.
#[derive(Clone, Debug)]
struct Run {
    elements: Range<usize>,
    body: usize,
    /// Nodes of an element
    nodes: usize,
    /// Place of the first node of the first element
    first: usize,
    /// Whether [`Evolving`] adds them
    evolves: bool,
}

/// An element, and where its forces and its tangent go.
type Slot<'a> = ((usize, &'a mut [Vector2<f64>]), &'a mut [f64]);

impl Run {
    fn places(&self) -> Range<usize> {
        self.first..self.first + self.nodes * self.elements.len()
    }
}

impl Solids {
    pub fn new(model: &Arc<Model>) -> Self {
        let elements = &model.mesh.elements;
        let mut runs: Vec<Run> = Vec::new();
        let mut starts = vec![0; model.mesh.nodes.len() + 1];
        let mut count = 0;
        for (e, element) in elements.iter().enumerate() {
            let (body, kind) = (model.body_of_element[e], element.kind);
            match runs.last_mut() {
                Some(run) if run.body == body && elements[run.elements.start].kind == kind => run.elements.end += 1,
                _ => runs.push(Run {
                    elements: e..e + 1,
                    body,
                    nodes: element.nodes.len(),
                    first: count,
                    evolves: evolves(model, body),
                }),
            }
            count += element.nodes.len();
            element.nodes.iter().for_each(|&node| starts[node + 1] += 1);
        }
        (1..starts.len()).for_each(|node| starts[node] += starts[node - 1]);
        let mut next = starts.clone();
        let mut places = vec![0; count];
        for (place, &node) in elements.iter().flat_map(|element| &element.nodes).enumerate() {
            places[next[node]] = place;
            next[node] += 1;
        }
        let forces = vec![Vector2::zeros(); count];
        let model = model.clone();
        Self { model, runs, starts, places, forces, energies: vec![Ok(0.0); elements.len()], tangents: Vec::new() }
    }

    /// Write the forces over those of `sums`, and add their tangents; returns the stored energy.
    pub fn add(&mut self, u: &[f64], sums: &mut Sums) -> Result<f64, TrialFailure> {
        match &mut sums.tangent {
            None => self.evaluate(u),
            Some(tangent) => self.evaluate_with_tangents(u, sums.layout, tangent),
        }
        let energy = self.stored()?;
        self.gather(sums.force, sums.magnitudes.as_deref_mut());
        Ok(energy)
    }

    /// Forces of all elements.
    fn evaluate(&mut self, u: &[f64]) {
        let model = &*self.model;
        for run in self.runs.iter().filter(|run| !run.evolves) {
            let material = &*model.bodies[run.body].material;
            let forces = self.forces[run.places()].par_chunks_exact_mut(run.nodes);
            let elements = run.elements.clone().into_par_iter().zip(forces);
            let one = |((e, forces), energy): ((usize, &mut [Vector2<f64>]), &mut _)| {
                *energy = model.solids[e].nodal_forces(material, &nodal(model, e, u)[..run.nodes], forces);
            };
            elements.zip(&mut self.energies[run.elements.clone()]).with_min_len(FEW).for_each(one);
        }
    }

    /// Forces and tangents of all elements, the tangents batch by batch.
    fn evaluate_with_tangents(&mut self, u: &[f64], layout: &Layout, total: &mut SparseMatrix) {
        let model = &*self.model;
        for run in self.runs.iter().filter(|run| !run.evolves) {
            let material = &*model.bodies[run.body].material;
            let (n, size) = (run.nodes, 4 * run.nodes * run.nodes);
            self.tangents.resize(self.tangents.len().max(size * BATCH.min(run.elements.len())), 0.0);
            for first in run.elements.clone().step_by(BATCH) {
                let elements = first..(first + BATCH).min(run.elements.end);
                let place = run.first + n * (first - run.elements.start);
                let forces = &mut self.forces[place..place + n * elements.len()];
                let one = |(((e, forces), tangent), energy): (Slot, &mut _)| {
                    let mut force = [0.0; 18];
                    let (u, own) = (&nodal(model, e, u)[..n], &mut force[..2 * n]);
                    *energy = model.solids[e].force_and_tangent(material, u, own, tangent);
                    forces
                        .iter_mut()
                        .zip(force.chunks_exact(2))
                        .for_each(|(sum, own)| *sum = Vector2::new(own[0], own[1]));
                };
                let all = elements.clone().into_par_iter().zip(forces.par_chunks_exact_mut(n));
                let all = all.zip(self.tangents.par_chunks_exact_mut(size));
                all.zip(&mut self.energies[elements.clone()]).with_min_len(FEW).for_each(one);
                for (e, tangent) in elements.zip(self.tangents.chunks_exact(size)) {
                    add_blocks(total, layout.blocks_of(e), tangent, n);
                }
            }
        }
    }

    /// What all elements store, or which is the first that is turned inside out.
    fn stored(&self) -> Result<f64, TrialFailure> {
        let mut energy = 0.0;
        for (e, stored) in self.energies.iter().enumerate() {
            energy += stored.map_err(|failure| TrialFailure::inverted(&self.model, e, failure))?;
        }
        Ok(energy)
    }

    /// Write the sums at the nodes over `force`, and add those of the magnitudes.
    fn gather(&self, force: &mut [f64], magnitudes: Option<&mut [f64]>) {
        let of = |node: usize| self.places[self.starts[node]..self.starts[node + 1]].iter().map(|&k| self.forces[k]);
        force.par_chunks_exact_mut(2).enumerate().with_min_len(FEW_NODES).for_each(|(node, force)| {
            let total: Vector2<f64> = of(node).sum();
            (force[0], force[1]) = (total.x, total.y);
        });
        let Some(magnitudes) = magnitudes else { return };
        magnitudes.par_chunks_exact_mut(2).enumerate().with_min_len(FEW_NODES).for_each(|(node, magnitude)| {
            for force in of(node) {
                magnitude[0] += force.x.abs();
                magnitude[1] += force.y.abs();
            }
        });
    }

    /// Write the viscous forces of the bodies at displacements `u` and velocities `v` over `force`; they resist.
    pub fn viscous(&mut self, [u, v]: [&[f64]; 2], force: &mut [f64], magnitudes: Option<&mut [f64]>) {
        let model = &*self.model;
        for run in &self.runs {
            let body = &model.bodies[run.body];
            let law = (&*body.material, body.damping.retardation);
            let one = |(e, forces): (usize, &mut [Vector2<f64>])| {
                let [u, v] = [u, v].map(|all| nodal(model, e, all));
                model.solids[e].viscous_forces(law, [&u[..run.nodes], &v[..run.nodes]], forces);
            };
            let places = &mut self.forces[run.places()];
            match body.damping.retardation > 0.0 {
                true => run
                    .elements
                    .clone()
                    .into_par_iter()
                    .zip(places.par_chunks_exact_mut(run.nodes))
                    .with_min_len(FEW)
                    .for_each(one),
                false => places.fill(Vector2::zeros()),
            }
        }
        self.gather(force, magnitudes);
    }

    /// Add the tangents of the viscous forces, where the velocity of each dof varies `dvelocity` times as much as its
    /// displacement.
    pub fn viscous_tangents(
        &mut self,
        [u, v]: [&[f64]; 2],
        dvelocity: &[f64],
        layout: &Layout,
        total: &mut SparseMatrix,
    ) {
        let model = &*self.model;
        for run in self.runs.iter().filter(|run| model.bodies[run.body].damping.retardation > 0.0) {
            let body = &model.bodies[run.body];
            let law = (&*body.material, body.damping.retardation);
            let (n, size) = (run.nodes, 4 * run.nodes * run.nodes);
            self.tangents.resize(self.tangents.len().max(size * BATCH.min(run.elements.len())), 0.0);
            for first in run.elements.clone().step_by(BATCH) {
                let elements = first..(first + BATCH).min(run.elements.end);
                let one = |(e, tangent): (usize, &mut [f64])| {
                    let [u, v, rates] = [u, v, dvelocity].map(|all| nodal(model, e, all));
                    let mut own = [0.0; 18];
                    own.chunks_exact_mut(2).zip(&rates).for_each(|(own, rate)| own.copy_from_slice(rate.as_slice()));
                    model.solids[e].viscous_tangent(law, [&u[..n], &v[..n]], &own[..2 * n], tangent);
                };
                let all = elements.clone().into_par_iter().zip(self.tangents.par_chunks_exact_mut(size));
                all.with_min_len(FEW).for_each(one);
                for (e, tangent) in elements.zip(self.tangents.chunks_exact(size)) {
                    add_blocks(total, layout.blocks_of(e), tangent, n);
                }
            }
        }
    }
}

/// Values of an element's nodes, from those of all dofs.
fn nodal(model: &Model, e: usize, all: &[f64]) -> [Vector2<f64>; 9] {
    let mut local = [Vector2::zeros(); 9];
    for (local, &node) in local.iter_mut().zip(&model.mesh.elements[e].nodes) {
        *local = Vector2::new(all[2 * node], all[2 * node + 1]);
    }
    local
}
