//! Parts of a model that act on each other: by elements, contacts, bars, ties and platens. What serves numerics, such as the round-off
//! that forces and displacements may have, goes by the part where it is asked for: other parts have no say in it.

use std::ops::Range;

use super::Model;
use crate::mesh::joined::Joined;

/// Nodes that act on each other.
#[derive(Clone, Debug, PartialEq)]
pub struct CoupledPart {
    /// their numbers, consecutive ones together
    pub nodes: Vec<Range<usize>>,
    /// diagonal of their bounding box [L]
    pub size: f64,
}

/// All parts of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct CoupledParts {
    /// list of parts
    pub parts: Vec<CoupledPart>,
    /// part of every node
    pub of_node: Vec<usize>,
}

impl CoupledParts {
    /// Finds the parts of a model; contacts couple what may touch in some step.
    pub fn of(model: &Model) -> Self {
        let mut joined = Joined::new(model.mesh.nodes.len());
        let mut join = |nodes: &mut dyn Iterator<Item = usize>| {
            let first = nodes.next();
            first.into_iter().for_each(|first| nodes.for_each(|node| joined.join(first, node)));
        };
        model.mesh.elements.iter().for_each(|element| join(&mut element.nodes.iter().copied()));
        let wet = model.flow.iter().flat_map(|flow| &flow.elements);
        wet.for_each(|wet| join(&mut wet.nodes.iter().copied()));
        model.contacts.iter().for_each(|pair| join(&mut pair.nodes()));
        model.ties.pairs().iter().for_each(|&(copy, original)| join(&mut [copy, original].into_iter()));
        model.bars.iter().flat_map(|bar| bar.groups()).for_each(|group| join(&mut group.iter().copied()));
        model.mesh.rigid_bodies.iter().for_each(|body| join(&mut body.nodes().into_iter()));
        for follower in &model.linkage.followers {
            join(&mut follower.leaders.iter().map(|(leader, _)| *leader).chain([follower.node]));
        }
        let groups = joined.groups();
        let mut of_node = vec![0; model.mesh.nodes.len()];
        for (part, nodes) in groups.iter().enumerate() {
            nodes.iter().for_each(|&node| of_node[node] = part);
        }
        let part = |nodes: Vec<usize>| {
            let size = model.mesh.size_of(nodes.iter().copied());
            let run = |run: &[usize]| run[0]..run[0] + run.len();
            CoupledPart { nodes: nodes.chunk_by(|a, b| a + 1 == *b).map(run).collect(), size }
        };
        Self { parts: groups.into_iter().map(part).collect(), of_node }
    }
}
