//! Nodes with equal displacements: the two sides of a periodic model, and the nodes of a loading platen.
//!
//! Every node of a periodic side is a copy of its partner on the other side, and all nodes of a platen are copies of one node:
//! u, v and a of a copy are those of that node, and forces on a copy act on it. A copy keeps its own position, and thereby the
//! shape of the adjacent elements.

use super::joined::Joined;

/// Copies and the nodes that they follow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ties {
    /// (copy, its original node, which is no copy), ascending
    pairs: Vec<(usize, usize)>,
}

impl Ties {
    /// Ties pairs of nodes. Nodes joined by several pairs, such as the corners of a model that is periodic in both directions,
    /// all follow the first of them.
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

    /// (copy, its original node), ascending.
    pub fn pairs(&self) -> &[(usize, usize)] {
        &self.pairs
    }

    /// Original of a node: the node itself unless it is a copy.
    pub fn original(&self, node: usize) -> usize {
        self.pairs.binary_search_by_key(&node, |(copy, _)| *copy).map_or(node, |k| self.pairs[k].1)
    }

    /// Originals of some nodes, ascending, each once.
    pub fn originals(&self, nodes: impl IntoIterator<Item = usize>) -> Vec<usize> {
        let mut originals: Vec<usize> = nodes.into_iter().map(|node| self.original(node)).collect();
        originals.sort_unstable();
        originals.dedup();
        originals
    }

    /// Adds the values of copies, `width` per node, to their originals, and sets those of the copies to zero.
    pub fn gather(&self, width: usize, values: &mut [f64]) {
        for &(copy, original) in &self.pairs {
            for i in 0..width {
                values[width * original + i] += std::mem::take(&mut values[width * copy + i]);
            }
        }
    }

    /// Copies the values of originals to their copies.
    pub fn spread(&self, width: usize, values: &mut [f64]) {
        for &(copy, original) in &self.pairs {
            values.copy_within(width * original..width * (original + 1), width * copy);
        }
    }
}
