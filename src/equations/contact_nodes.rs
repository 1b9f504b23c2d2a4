//! The nodes at contacts, on which linear bodies are condensed.

use std::sync::Arc;

use super::jumps::{Jumps, fixed};
use crate::contact::master::Master;
use crate::contact::pair::ContactPair;
use crate::contact::small_sliding::SmallPoint;
use crate::linear::system::System;
use crate::linear::{Condensed, Eliminated, Pattern, SparseMatrix, Steady};
use crate::model::{Model, Step};

/// The nodes at contacts: those of the slaves, and all that they may slide to unless the slaves are counted from these. Copies
/// come with the nodes they move with.
pub struct ContactNodes {
    /// The nodes, ascending
    pub nodes: Vec<usize>,
    /// Place of each node among them
    pub(super) places: Vec<Option<u32>>,
    pub(super) jumps: Jumps,
    /// Places of the nodes of each contact
    pub(super) parts: Vec<Vec<usize>>,
    /// All nodes of each contact
    pub(super) sides: Vec<Vec<usize>>,
}

impl ContactNodes {
    /// The nodes of all contacts of a model.
    pub fn new(model: &Model) -> Self {
        let together: Vec<Vec<Vec<usize>>> = model.contacts.iter().map(|pair| nodes_of(model, pair)).collect();
        let jumps = Jumps::new(model, &together.concat());
        Self::counted_by(model, &together, jumps)
    }

    /// The same with both sides of all contacts, no node counted from another.
    pub fn of_both_sides(model: &Model) -> Self {
        let together: Vec<Vec<Vec<usize>>> = model.contacts.iter().map(|pair| nodes_of(model, pair)).collect();
        Self::counted_by(model, &together, Jumps::none(model))
    }

    fn counted_by(model: &Model, together: &[Vec<Vec<usize>>], jumps: Jumps) -> Self {
        // A point that has a jump is alone with it: none of the nodes it is counted from has equations of contact.
        let own = |nodes: &Vec<usize>| match nodes.iter().find(|node| jumps.has(**node)) {
            Some(slave) => vec![*slave],
            None => nodes.clone(),
        };
        let of_pairs: Vec<Vec<usize>> =
            together.iter().map(|pair| sorted(pair.iter().flat_map(own).collect())).collect();
        let copies = model.ties.pairs().iter().filter(|(_, original)| of_pairs.iter().flatten().any(|n| n == original));
        let nodes = sorted(of_pairs.iter().flatten().copied().chain(copies.map(|(copy, _)| *copy)).collect());
        let mut places = vec![None; model.mesh.nodes.len()];
        nodes.iter().enumerate().for_each(|(place, &node)| places[node] = Some(place as u32));
        let place = |node: &usize| places[*node].map(|place| place as usize);
        let parts = of_pairs.iter().map(|nodes| nodes.iter().filter_map(place).collect()).collect();
        let sides = together.iter().map(|pair| sorted(pair.concat())).collect();
        Self { nodes, places, jumps, parts, sides }
    }

    /// Place of a node among them.
    pub(super) fn place(&self, node: usize) -> Option<usize> {
        self.places[node].map(|place| place as usize)
    }

    /// A system of their equations, all coupled with each other: the values of a matrix are those of a dense one, column by
    /// column.
    pub fn system(&self) -> System {
        let all: Vec<usize> = (0..self.nodes.len()).collect();
        let pattern = Arc::new(Pattern::new(all.len(), std::iter::once(&all[..])));
        System {
            residual: vec![0.0; 2 * self.nodes.len()],
            tangent: SparseMatrix::zero(pattern),
            forces: 0.0,
            imbalance: f64::INFINITY,
        }
    }

    /// x from the displacements of all nodes.
    pub fn gather(&self, u: &[f64]) -> Vec<f64> {
        self.nodes.iter().flat_map(|&node| self.jumps.of(node, u)).collect()
    }

    /// Write what goes with x over the displacements of these nodes; the others stay.
    pub fn scatter(&self, x: &[f64], u: &mut [f64]) {
        for (values, &node) in x.chunks_exact(2).zip(&self.nodes) {
            u[2 * node..2 * node + 2].copy_from_slice(values);
        }
        self.jumps.resolve(u);
    }

    /// The pattern of the equations of all nodes, these coupled with each other, from that of the bodies.
    pub fn around(&self, bodies: &Pattern) -> Arc<Pattern> {
        Arc::new(self.jumps.pattern(bodies, &self.nodes))
    }

    /// The matrix on that pattern from the tangent of the bodies.
    pub fn counted(
        &self,
        (model, step): (&Model, &Step),
        bodies: &SparseMatrix,
        pattern: &Arc<Pattern>,
    ) -> SparseMatrix {
        let mut sum = SparseMatrix::zero(pattern.clone());
        self.jumps.matrix(bodies, &fixed(model, step), &mut sum);
        sum
    }

    /// Whether all of them are jumps: half of their equations do not vary while nothing opens.
    pub fn halves(&self) -> bool {
        self.nodes.iter().all(|node| self.jumps.has(*node))
    }

    /// Their equations along the normal eliminated from S of the bodies, if all of them are jumps.
    pub fn eliminated(&self, (model, step): (&Model, &Step), bodies: &Condensed) -> Option<Eliminated> {
        let (fixed, share) = (fixed(model, step), contact_share(step));
        let steady = |&node: &usize| {
            let steady = self.jumps.steady(node, &fixed)?;
            Some(Steady { stiffness: share * steady.stiffness, ..steady })
        };
        Eliminated::new(&bodies.stiffness, self.nodes.iter().map(steady).collect::<Option<_>>()?).ok()
    }

    /// The right-hand side that goes with it.
    pub fn balanced(&self, (model, step): (&Model, &Step), residual: &[f64]) -> Vec<f64> {
        let mut balanced = residual.to_vec();
        self.jumps.balance(&fixed(model, step), &mut balanced);
        balanced
    }

    /// Displacements of all nodes from a solution of it.
    pub fn resolved(&self, mut solution: Vec<f64>) -> Vec<f64> {
        self.jumps.resolve(&mut solution);
        solution
    }
}

/// 1 − α_f
pub(super) fn contact_share(step: &Step) -> f64 {
    step.scheme.coefficients().map_or(1.0, |scheme| 1.0 - scheme.alpha_f)
}

/// Ascending, each once.
fn sorted(mut nodes: Vec<usize>) -> Vec<usize> {
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// Nodes that a contact couples, or may come to couple: those of each point by itself if they never change.
fn nodes_of(model: &Model, pair: &ContactPair) -> Vec<Vec<usize>> {
    let original = |node: usize| model.ties.original(node);
    if let Some(small) = &pair.small {
        let of_point = |point: &SmallPoint| sorted(point.nodes.iter().map(|node| original(*node)).collect());
        return small.points.iter().flatten().map(of_point).collect();
    }
    let mut nodes: Vec<usize> = Vec::new();
    for point in &pair.points {
        nodes.extend(point.position.iter().map(|&(node, _)| node));
        nodes.extend(point.length.iter().flat_map(|share| share.tangent.iter().map(|&(node, _)| node)));
    }
    if let Master::Mesh(surface) = &pair.master {
        nodes.extend(surface.segments.iter().flat_map(|segment| segment.nodes()));
    }
    vec![sorted(nodes.into_iter().map(original).collect())]
}
