//! Runs of elements evaluated each time: consecutive elements of one kind and body, in parallel.
//!
//! Nodes sum the forces computed element by element and block by block.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::Vector2;
use rayon::prelude::*;

use crate::equations::coupling::Layout;
use crate::equations::evolving::evolves;
use crate::equations::sums::{TrialFailure, add_blocks};
use crate::equations::trial::nodal;
use crate::laws::bulk::Answer;
use crate::linear::SparseMatrix;
use crate::model::{Activated, Model};

/// Number of elements below which evaluation takes less time than starting another thread.
const FEW: usize = 64;

/// Elements of a model in runs.
pub(super) struct Runs {
    runs: Vec<Run>,
    /// Positions of each node's element forces
    pub places: Places,
    /// Forces of the elements on their nodes [F]
    pub forces: Vec<Vector2<f64>>,
    /// Energy stored in each element of the model that is in a run [F·L]
    energies: Vec<Answer<f64>>,
    /// Tangents of a batch, column by column
    tangents: Vec<f64>,
    /// Elements that came into a deformed model
    activated: Arc<Activated>,
}

/// Consecutive elements of one kind and body.
#[derive(Clone, Debug)]
struct Run {
    elements: Range<usize>,
    body: usize,
    /// Nodes per element
    nodes: usize,
    /// Position of the first node of the first element
    first: usize,
    /// Whether they are added by [`crate::equations::evolving::Evolving`]
    evolves: bool,
}

/// An element, with the memory for its forces and its tangent.
type Slot<'a> = ((usize, &'a mut [Vector2<f64>]), &'a mut [f64]);

impl Run {
    fn places(&self) -> Range<usize> {
        self.first..self.first + self.nodes * self.elements.len()
    }
}

impl Runs {
    /// Finds the runs of equal elements among those that are `wanted`.
    pub fn new(model: &Model, wanted: impl Fn(usize) -> bool + Clone, activated: &Arc<Activated>) -> Self {
        let elements = &model.mesh.elements;
        let mut runs: Vec<Run> = Vec::new();
        let mut count = 0;
        for (e, element) in elements.iter().enumerate().filter(|(e, _)| wanted(*e)) {
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
        let nodes = elements.iter().enumerate().filter(|(e, _)| wanted(*e)).flat_map(|(_, element)| &element.nodes);
        Self {
            runs,
            places: Places::new(model.mesh.nodes.len(), nodes.enumerate().map(|(place, &node)| (place as u32, node))),
            forces: vec![Vector2::zeros(); count],
            energies: vec![Ok(0.0); if count > 0 { elements.len() } else { 0 }],
            tangents: Vec::new(),
            activated: activated.clone(),
        }
    }

    /// Computes the forces of all elements.
    pub fn evaluate(&mut self, model: &Model, u: &[f64]) {
        let activated = &*self.activated;
        for run in &self.runs {
            if run.evolves {
                self.forces[run.places()].fill(Vector2::zeros());
                continue;
            }
            let material = model.bodies[run.body].law_of_elements();
            let forces = self.forces[run.places()].par_chunks_exact_mut(run.nodes);
            let elements = run.elements.clone().into_par_iter().zip(forces);
            let one = |((e, forces), energy): ((usize, &mut [Vector2<f64>]), &mut _)| {
                *energy =
                    model.as_activated(activated, e).nodal_forces(material, &nodal(model, e, u)[..run.nodes], forces);
            };
            elements.zip(&mut self.energies[run.elements.clone()]).with_min_len(FEW).for_each(one);
        }
    }

    /// Computes the forces and tangents, the tangents batch by batch.
    pub fn evaluate_with_tangents(&mut self, model: &Model, u: &[f64], layout: &Layout, total: &mut SparseMatrix) {
        let activated = &*self.activated;
        for run in &self.runs {
            if run.evolves {
                self.forces[run.places()].fill(Vector2::zeros());
                continue;
            }
            let material = model.bodies[run.body].law_of_elements();
            let (n, size) = (run.nodes, 4 * run.nodes * run.nodes);
            self.tangents.resize(self.tangents.len().max(size * BATCH.min(run.elements.len())), 0.0);
            for first in run.elements.clone().step_by(BATCH) {
                let elements = first..(first + BATCH).min(run.elements.end);
                let place = run.first + n * (first - run.elements.start);
                let forces = &mut self.forces[place..place + n * elements.len()];
                let one = |(((e, forces), tangent), energy): (Slot, &mut _)| {
                    let mut force = [0.0; 18];
                    let (u, own) = (&nodal(model, e, u)[..n], &mut force[..2 * n]);
                    *energy = model.as_activated(activated, e).force_and_tangent(material, u, own, tangent);
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

    /// Stored energy of all elements; an error for the first one that is inverted.
    pub fn stored(&self, model: &Model) -> Result<f64, TrialFailure> {
        let mut energy = 0.0;
        for e in self.runs.iter().filter(|run| !run.evolves).flat_map(|run| run.elements.clone()) {
            energy += self.energies[e].map_err(|failure| TrialFailure::material(model, e, failure))?;
        }
        Ok(energy)
    }

    /// Computes the viscous forces of all elements.
    pub fn evaluate_viscous(&mut self, model: &Model, retardation: &[f64], [u, v]: [&[f64]; 2]) {
        let activated = &*self.activated;
        for run in &self.runs {
            let (material, tau) = (model.bodies[run.body].law_of_elements(), retardation[run.body]);
            let one = |(e, forces): (usize, &mut [Vector2<f64>])| {
                let [u, v] = [u, v].map(|all| nodal(model, e, all));
                model.as_activated(activated, e).viscous_forces(
                    material,
                    tau,
                    [&u[..run.nodes], &v[..run.nodes]],
                    forces,
                );
            };
            let places = &mut self.forces[run.places()];
            match retardation[run.body] > 0.0 {
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

    /// Adds the tangents of the viscous forces, where the velocity of each dof varies by the factor `dvelocity` with its
    /// displacement.
    pub fn viscous_tangents(
        &mut self,
        model: &Model,
        retardation: &[f64],
        [u, v]: [&[f64]; 2],
        dvelocity: &[f64],
        layout: &Layout,
        total: &mut SparseMatrix,
    ) {
        let activated = &*self.activated;
        for run in self.runs.iter().filter(|run| retardation[run.body] > 0.0) {
            let (material, tau) = (model.bodies[run.body].law_of_elements(), retardation[run.body]);
            let (n, size) = (run.nodes, 4 * run.nodes * run.nodes);
            self.tangents.resize(self.tangents.len().max(size * BATCH.min(run.elements.len())), 0.0);
            for first in run.elements.clone().step_by(BATCH) {
                let elements = first..(first + BATCH).min(run.elements.end);
                let one = |(e, tangent): (usize, &mut [f64])| {
                    let [u, v, rates] = [u, v, dvelocity].map(|all| nodal(model, e, all));
                    let mut own = [0.0; 18];
                    own.chunks_exact_mut(2).zip(&rates).for_each(|(own, rate)| own.copy_from_slice(rate.as_slice()));
                    model.as_activated(activated, e).viscous_tangent(
                        material,
                        tau,
                        [&u[..n], &v[..n]],
                        &own[..2 * n],
                        tangent,
                    );
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

/// Number of elements whose tangents are stored at once before they are added.
pub const BATCH: usize = 1024;

/// Number of nodes below which summation takes less time than starting another thread.
const FEW_NODES: usize = 1024;

/// For each node, the positions of the values to be summed.
pub(super) struct Places {
    /// Start of the positions of each node, and end of the last; empty without positions
    starts: Vec<u32>,
    places: Vec<u32>,
}

impl Places {
    /// Creates the positions for `count` nodes, from pairs of node and position.
    pub fn new(count: usize, nodes: impl Iterator<Item = (u32, usize)> + Clone) -> Self {
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

    /// Forces at the positions of a node.
    fn at<'a>(&'a self, node: usize, forces: &'a [Vector2<f64>]) -> impl Iterator<Item = Vector2<f64>> + 'a {
        let own =
            if self.starts.is_empty() { 0..0 } else { self.starts[node] as usize..self.starts[node + 1] as usize };
        self.places[own].iter().map(|&place| forces[place as usize])
    }
}

/// Forces, and their positions for each node.
type Source<'a> = (&'a Places, &'a [Vector2<f64>]);

/// Writes the sums at the nodes to `force`, elements before blocks.
pub(super) fn gather([elements, blocks]: [Source; 2], force: &mut [f64]) {
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

/// Adds the sums of the magnitudes at the nodes.
pub(super) fn gather_magnitudes([elements, blocks]: [Source; 2], magnitudes: &mut [f64]) {
    magnitudes.par_chunks_exact_mut(2).enumerate().with_min_len(FEW_NODES).for_each(|(node, magnitude)| {
        for force in elements.0.at(node, elements.1).chain(blocks.0.at(node, blocks.1)) {
            magnitude[0] += force.x.abs();
            magnitude[1] += force.y.abs();
        }
    });
}
