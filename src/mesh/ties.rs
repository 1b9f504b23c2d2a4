//! Nodes that move as one: the two sides of a periodic model, and the nodes of a loading plate.
//!
//! Every node of a side is a copy of its partner on the other, and all nodes of a plate are copies of one: u, v and a are those of
//! that node, and what acts on a copy acts on it. The copy keeps its own position, so that the elements beside it know their shape.

use super::joined::Joined;

/// Copies and the nodes they move with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ties {
    /// (copy, the node it moves with, which is no copy), ascending
    pairs: Vec<(usize, usize)>,
}

impl Ties {
    /// Ties between pairs of nodes. Nodes joined by several pairs, as the corners of a model that is periodic both ways, all
    /// move with the first of them.
    pub fn new(nodes: usize, joined: &[[usize; 2]]) -> Self {
        if joined.is_empty() {
            return Self::default();
        }
        let mut all = Joined::new(nodes);
        joined.iter().for_each(|&[a, b]| all.join(a, b));
        let copies = |group: Vec<usize>| group.clone().into_iter().skip(1).map(move |copy| (copy, group[0]));
        let mut pairs: Vec<(usize, usize)> = all.groups().into_iter().flat_map(copies).collect();
        pairs.sort_unstable();
        Self { pairs }
    }

    /// (copy, the node it moves with), ascending.
    pub fn pairs(&self) -> &[(usize, usize)] {
        &self.pairs
    }

    /// The node that a node moves with: itself unless it is a copy.
    pub fn original(&self, node: usize) -> usize {
        self.pairs.binary_search_by_key(&node, |(copy, _)| *copy).map_or(node, |k| self.pairs[k].1)
    }

    /// The nodes that some nodes move with, ascending, each once.
    pub fn originals(&self, nodes: impl IntoIterator<Item = usize>) -> Vec<usize> {
        let mut originals: Vec<usize> = nodes.into_iter().map(|node| self.original(node)).collect();
        originals.sort_unstable();
        originals.dedup();
        originals
    }

    /// Add what copies have, with `width` values a node, to the nodes they move with, and leave them nothing.
    pub fn gather(&self, width: usize, values: &mut [f64]) {
        for &(copy, original) in &self.pairs {
            for i in 0..width {
                values[width * original + i] += std::mem::take(&mut values[width * copy + i]);
            }
        }
    }

    /// Give copies what the nodes have that they move with.
    pub fn spread(&self, width: usize, values: &mut [f64]) {
        for &(copy, original) in &self.pairs {
            values.copy_within(width * original..width * (original + 1), width * copy);
        }
    }
}
