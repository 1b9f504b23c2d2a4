//! Stress of the bodies: every element's forces on its nodes, and the sums of them at each node.
//!
//! Elements whose stiffness never changes use the stored one, block by block ([`constant`]). The others of one kind and law
//! follow each other in a run and are evaluated in parallel. Then every node sums up what its elements and blocks put there,
//! in their order: the same bits on any number of threads, and nothing is written twice.

mod blocks;
mod constant;
mod kernel;

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
use constant::Constant;
pub use constant::is_constant;
use kernel::Pass;

/// Elements whose tangents are held at once before they are added.
const BATCH: usize = 1024;

/// Elements that are done sooner than another thread wakes up.
const FEW: usize = 64;

/// Nodes whose sums are done sooner than another thread wakes up.
const FEW_NODES: usize = 1024;

/// It is the same matrix throughout if all elements are constant.
pub(super) fn dependence(model: &Model) -> Dependence {
    let all = (0..model.solids.len()).all(|e| is_constant(model, e));
    if all { Dependence::Nothing } else { Dependence::Displacement }
}

/// The elements of a model, what each puts on its nodes, and where each node finds its own.
pub(super) struct Solids {
    model: Arc<Model>,
    constant: Constant,
    /// The other elements
    runs: Vec<Run>,
    /// Where each node finds its elements' forces
    elements: Places,
    /// Where each node finds its blocks' forces
    blocks: Places,
    /// Forces of the elements that are not constant on their nodes [F]
    forces: Vec<Vector2<f64>>,
    /// Forces of the blocks of constant elements on their nodes [F]
    block_forces: Vec<Vector2<f64>>,
    /// Viscous forces of the blocks, or magnitudes of their elements' forces [F]
    block_others: Vec<Vector2<f64>>,
    /// What each element stores that is not constant [F·L]
    energies: Vec<Result<f64, InvertedElement>>,
    /// Tangents of a batch, column by column
    tangents: Vec<f64>,
}

/// Where each node finds what is summed up there.
struct Places {
    /// Where the places of each node start, and where the last one's end; empty if no node has any
    starts: Vec<u32>,
    places: Vec<u32>,
}

impl Places {
    /// Of `count` nodes, the places being those of the given nodes.
    fn new(count: usize, nodes: impl Iterator<Item = (u32, usize)> + Clone) -> Self {
        let mut starts = vec![0; count + 1];
        nodes.clone().for_each(|(_, node)| starts[node + 1] += 1);
        (1..starts.len()).for_each(|node| starts[node] += starts[node - 1]);
        let (mut next, mut places) = (starts.clone(), vec![0; starts[count] as usize]);
        for (place, node) in nodes {
            places[next[node] as usize] = place;
            next[node] += 1;
        }
        if places.is_empty() {
            starts.clear();
        }
        Self { starts, places }
    }

    /// What is at the places of a node.
    fn at<'a>(&'a self, node: usize, forces: &'a [Vector2<f64>]) -> impl Iterator<Item = Vector2<f64>> + 'a {
        let own =
            if self.starts.is_empty() { 0..0 } else { self.starts[node] as usize..self.starts[node + 1] as usize };
        self.places[own].iter().map(|&place| forces[place as usize])
    }
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
        let constant = Constant::new(model);
        let mut runs: Vec<Run> = Vec::new();
        let mut count = 0;
        for (e, element) in elements.iter().enumerate().filter(|(e, _)| !constant.is[*e]) {
            let (body, kind) = (model.body_of_element[e], element.kind);
            match runs.last_mut() {
                Some(run) if run.elements.end == e && run.body == body && elements[run.elements.start].kind == kind => {
                    run.elements.end += 1;
                }
                _ => runs.push(Run {
                    elements: e..e + 1,
                    body,
                    nodes: element.nodes.len(),
                    first: count,
                    evolves: evolves(model, body),
                }),
            }
            count += element.nodes.len();
        }
        let nodes = model.mesh.nodes.len();
        let others = elements.iter().enumerate().filter(|(e, _)| !constant.is[*e]);
        let own = others.flat_map(|(_, element)| element.nodes.iter().copied()).enumerate();
        let stride = constant.stride;
        let of_block = |(block, own): (usize, &'_ [u32])| {
            let first = block * stride;
            own.iter().enumerate().map(move |(k, &node)| ((first + k) as u32, node as usize)).collect::<Vec<_>>()
        };
        let of_blocks: Vec<(u32, usize)> = constant.nodes().enumerate().flat_map(of_block).collect();
        let places = stride * constant.nodes().count();
        Self {
            model: model.clone(),
            runs,
            elements: Places::new(nodes, own.map(|(place, node)| (place as u32, node))),
            blocks: Places::new(nodes, of_blocks.iter().copied()),
            forces: vec![Vector2::zeros(); count],
            block_forces: vec![Vector2::zeros(); places],
            block_others: vec![Vector2::zeros(); places],
            energies: vec![Ok(0.0); if count > 0 { elements.len() } else { 0 }],
            tangents: Vec::new(),
            constant,
        }
    }

    /// Number of the distinct matrices that constant elements share.
    pub fn matrices(&self) -> usize {
        self.constant.matrices()
    }

    /// Σ K_e of the constant elements on the current pattern; nothing if there are none.
    pub fn constant_stiffness(&mut self, layout: &Layout) -> Option<&SparseMatrix> {
        self.constant.total(&self.model, layout)
    }

    /// Write the forces over those of `sums`, and add the tangents of all elements that are not constant; returns the stored
    /// energy. With velocities `v` the viscous forces of the constant elements are found on the way, for
    /// [`Solids::other_viscous`].
    pub fn add(&mut self, u: &[f64], v: Option<&[f64]>, sums: &mut Sums) -> Result<f64, TrialFailure> {
        match &mut sums.tangent {
            None => self.evaluate(u),
            Some(tangent) => self.evaluate_with_tangents(u, sums.layout, tangent),
        }
        let scaled = sums.magnitudes.is_some();
        self.pass(v.map_or(Pass::Elastic { u, scaled }, |v| Pass::Both { u, v }));
        let energy = self.stored()? + self.constant.stored(&self.model, u)?;
        gather([(&self.elements, &self.forces), (&self.blocks, &self.block_forces)], sums.force);
        if let Some(magnitudes) = sums.magnitudes.as_deref_mut() {
            self.gather_magnitudes(magnitudes);
        }
        Ok(energy)
    }

    fn pass(&mut self, pass: Pass) {
        self.constant.evaluate(&self.model, pass, &mut self.block_forces, &mut self.block_others);
    }

    /// Forces of all elements that are not constant.
    fn evaluate(&mut self, u: &[f64]) {
        let model = &*self.model;
        for run in &self.runs {
            if run.evolves {
                self.forces[run.places()].fill(Vector2::zeros());
                continue;
            }
            let material = &*model.bodies[run.body].material;
            let forces = self.forces[run.places()].par_chunks_exact_mut(run.nodes);
            let elements = run.elements.clone().into_par_iter().zip(forces);
            let one = |((e, forces), energy): ((usize, &mut [Vector2<f64>]), &mut _)| {
                *energy = model.solids[e].nodal_forces(material, &nodal(model, e, u)[..run.nodes], forces);
            };
            elements.zip(&mut self.energies[run.elements.clone()]).with_min_len(FEW).for_each(one);
        }
    }

    /// Forces and tangents of the same, the tangents batch by batch.
    fn evaluate_with_tangents(&mut self, u: &[f64], layout: &Layout, total: &mut SparseMatrix) {
        let model = &*self.model;
        for run in &self.runs {
            if run.evolves {
                self.forces[run.places()].fill(Vector2::zeros());
                continue;
            }
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

    /// What all elements store that are not constant, or which is the first that is turned inside out.
    fn stored(&self) -> Result<f64, TrialFailure> {
        let mut energy = 0.0;
        for e in self.runs.iter().filter(|run| !run.evolves).flat_map(|run| run.elements.clone()) {
            energy += self.energies[e].map_err(|failure| TrialFailure::inverted(&self.model, e, failure))?;
        }
        Ok(energy)
    }

    /// Add the sums of the forces' magnitudes at the nodes.
    fn gather_magnitudes(&self, magnitudes: &mut [f64]) {
        magnitudes.par_chunks_exact_mut(2).enumerate().with_min_len(FEW_NODES).for_each(|(node, magnitude)| {
            for force in self.elements.at(node, &self.forces).chain(self.blocks.at(node, &self.block_others)) {
                magnitude[0] += force.x.abs();
                magnitude[1] += force.y.abs();
            }
        });
    }

    /// Write the viscous forces of the bodies at displacements `u` and velocities `v` over `force`; they resist.
    pub fn viscous(&mut self, [u, v]: [&[f64]; 2], force: &mut [f64], magnitudes: Option<&mut [f64]>) {
        self.pass(Pass::Viscous { v, scaled: magnitudes.is_some() });
        self.evaluate_viscous([u, v]);
        gather([(&self.elements, &self.forces), (&self.blocks, &self.block_forces)], force);
        if let Some(magnitudes) = magnitudes {
            self.gather_magnitudes(magnitudes);
        }
    }

    /// The same, after [`Solids::add`] has found those of the constant elements.
    pub fn other_viscous(&mut self, [u, v]: [&[f64]; 2], force: &mut [f64]) {
        self.evaluate_viscous([u, v]);
        gather([(&self.elements, &self.forces), (&self.blocks, &self.block_others)], force);
    }

    /// Viscous forces of all elements that are not constant.
    fn evaluate_viscous(&mut self, [u, v]: [&[f64]; 2]) {
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
        if let Some(viscous) = self.constant.viscous(model, layout) {
            total.add_columns(viscous, dvelocity);
        }
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

/// Write the sums at the nodes over `force`.
fn gather([elements, blocks]: [(&Places, &[Vector2<f64>]); 2], force: &mut [f64]) {
    let nodes = force.par_chunks_exact_mut(2).enumerate().with_min_len(FEW_NODES);
    let write = |force: &mut [f64], total: Vector2<f64>| force.copy_from_slice(total.as_slice());
    match [elements, blocks].map(|(places, _)| places.places.is_empty()) {
        [true, _] => nodes.for_each(|(node, force)| write(force, blocks.0.at(node, blocks.1).sum())),
        [_, true] => nodes.for_each(|(node, force)| write(force, elements.0.at(node, elements.1).sum())),
        _ => nodes.for_each(|(node, force)| {
            write(force, elements.0.at(node, elements.1).chain(blocks.0.at(node, blocks.1)).sum());
        }),
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
