//! The sums at the nodes, of forces that are found element by element and block by block.

use nalgebra::Vector2;
use rayon::prelude::*;

/// Elements whose tangents are held at once before they are added.
pub const BATCH: usize = 1024;

/// Nodes whose sums are done sooner than another thread wakes up.
const FEW_NODES: usize = 1024;

/// Where each node finds what is summed up there.
pub(super) struct Places {
    /// Where the places of each node start, and where the last one's end; empty if no node has any
    starts: Vec<u32>,
    places: Vec<u32>,
}

impl Places {
    /// Of `count` nodes, the places being those of the given nodes.
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

    /// What is at the places of a node.
    fn at<'a>(&'a self, node: usize, forces: &'a [Vector2<f64>]) -> impl Iterator<Item = Vector2<f64>> + 'a {
        let own =
            if self.starts.is_empty() { 0..0 } else { self.starts[node] as usize..self.starts[node + 1] as usize };
        self.places[own].iter().map(|&place| forces[place as usize])
    }
}

/// Forces at their places, and where each node finds its own.
pub(super) type Source<'a> = (&'a Places, &'a [Vector2<f64>]);

/// Write the sums at the nodes over `force`, those of the elements before those of the blocks.
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

/// Add the sums of the magnitudes at the nodes.
pub(super) fn gather_magnitudes([elements, blocks]: [Source; 2], magnitudes: &mut [f64]) {
    magnitudes.par_chunks_exact_mut(2).enumerate().with_min_len(FEW_NODES).for_each(|(node, magnitude)| {
        for force in elements.0.at(node, elements.1).chain(blocks.0.at(node, blocks.1)) {
            magnitude[0] += force.x.abs();
            magnitude[1] += force.y.abs();
        }
    });
}
