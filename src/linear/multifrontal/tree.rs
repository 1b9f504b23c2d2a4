//! Elimination tree, postorder and supernodes of the node graph.

use super::super::Pattern;

/// A node without a parent in the elimination forest.
pub const ROOT: usize = usize::MAX;

/// The order of elimination and what depends on which, in *positions*: position k is eliminated as the k-th.
pub struct Elimination {
    /// Node at each position
    pub nodes: Vec<usize>,
    /// Position of each node
    pub positions: Vec<usize>,
    /// First position below the diagonal of each column of L, or [`ROOT`]
    pub parents: Vec<usize>,
    /// Nodes in each column of L, the diagonal included
    pub counts: Vec<usize>,
}

impl Elimination {
    /// Elimination forest of the graph in a fill-reducing order, renumbered so that every subtree is contiguous.
    ///
    /// Source: Liu (1990), The role of elimination trees in sparse factorization, doi:10.1137/0611010;
    /// Davis (2006), Direct Methods for Sparse Linear Systems, sections 4.1–4.4.
    pub fn new(pattern: &Pattern, order: Vec<usize>) -> Self {
        let parents = parents(pattern, &order, &inverse(&order));
        let postorder = postorder(&parents);
        let new_position = inverse(&postorder);
        let nodes: Vec<usize> = postorder.iter().map(|&k| order[k]).collect();
        let parents: Vec<usize> =
            postorder.iter().map(|&k| if parents[k] == ROOT { ROOT } else { new_position[parents[k]] }).collect();
        let positions = inverse(&nodes);
        let counts = counts(pattern, &nodes, &positions, &parents);
        Self { nodes, positions, parents, counts }
    }
}

fn inverse(permutation: &[usize]) -> Vec<usize> {
    let mut inverse = vec![0; permutation.len()];
    for (k, &value) in permutation.iter().enumerate() {
        inverse[value] = k;
    }
    inverse
}

/// Liu's algorithm: climb from each entry of a row to the root found so far; short cuts keep the climb short.
fn parents(pattern: &Pattern, nodes: &[usize], positions: &[usize]) -> Vec<usize> {
    let mut parents = vec![ROOT; nodes.len()];
    let mut short_cut = vec![ROOT; nodes.len()];
    for (k, &node) in nodes.iter().enumerate() {
        for &neighbour in pattern.neighbours(node) {
            let mut i = positions[neighbour];
            while i < k {
                let next = std::mem::replace(&mut short_cut[i], k);
                if next == ROOT {
                    parents[i] = k;
                    break;
                }
                i = next;
            }
        }
    }
    parents
}

fn postorder(parents: &[usize]) -> Vec<usize> {
    let n = parents.len();
    let (mut first_child, mut sibling) = (vec![ROOT; n], vec![ROOT; n]);
    for k in (0..n).rev().filter(|&k| parents[k] != ROOT) {
        sibling[k] = first_child[parents[k]];
        first_child[parents[k]] = k;
    }
    let mut postorder = Vec::with_capacity(n);
    let mut path = Vec::new();
    for root in (0..n).filter(|&k| parents[k] == ROOT) {
        path.push(root);
        while let Some(&k) = path.last() {
            let child = first_child[k];
            if child == ROOT {
                postorder.push(k);
                path.pop();
            } else {
                first_child[k] = sibling[child];
                path.push(child);
            }
        }
    }
    postorder
}

/// Row k of L is the subtree of the elimination tree that its entries span: count each column it passes.
fn counts(pattern: &Pattern, nodes: &[usize], positions: &[usize], parents: &[usize]) -> Vec<usize> {
    let mut counts = vec![1; nodes.len()];
    let mut last_row = vec![ROOT; nodes.len()];
    for (k, &node) in nodes.iter().enumerate() {
        for &neighbour in pattern.neighbours(node) {
            let mut i = positions[neighbour];
            while i < k && last_row[i] != k {
                last_row[i] = k;
                counts[i] += 1;
                i = parents[i];
            }
        }
    }
    counts
}

/// Consecutive positions that are eliminated in one dense front.
#[derive(Clone, Copy)]
pub struct Supernode {
    /// First position
    pub first: usize,
    /// One past the last position
    pub end: usize,
    /// Nodes below: those of the last column, the diagonal excluded
    pub below: usize,
    /// Nodes of the trapezoid that are zero
    zeros: usize,
}

impl Supernode {
    fn width(&self) -> usize {
        self.end - self.first
    }

    /// A child taken into its parent: the child's columns get the parent's rows.
    fn with_child(&self, child: &Self) -> Self {
        let new_zeros = child.width() * (self.width() + self.below - child.below);
        Self { first: child.first, zeros: child.zeros + self.zeros + new_zeros, ..*self }
    }

    /// Small fronts may carry zeros: dense kernels lose more on the calls than on the zeros.
    fn worth_it(&self) -> bool {
        let width = self.width();
        let size = width * (width + 1) / 2 + width * self.below;
        let allowed = match width {
            0..=4 => 1.0,
            5..=8 => 0.8,
            9..=32 => 0.1,
            _ => 0.05,
        };
        self.zeros as f64 <= allowed * size as f64
    }
}

/// Fundamental supernodes, relaxed by taking small last children into their parents. None holds positions both below and
/// above `eliminated`.
///
/// Source: Ashcraft & Grimes (1989), doi:10.1145/76909.76910.
pub fn supernodes(elimination: &Elimination, eliminated: usize) -> Vec<Supernode> {
    let Elimination { parents, counts, .. } = elimination;
    let n = parents.len();
    let mut supernodes: Vec<Supernode> = Vec::new();
    let mut first = 0;
    while first < n {
        let mut last = first;
        while parents[last] == last + 1 && counts[last] == counts[last + 1] + 1 && last + 1 != eliminated {
            last += 1;
        }
        let mut current = Supernode { first, end: last + 1, below: counts[last] - 1, zeros: 0 };
        while let Some(child) = supernodes.last() {
            // In postorder the one before is a child or belongs to another subtree.
            if parents[child.end - 1] >= current.end || current.first == eliminated {
                break;
            }
            let merged = current.with_child(child);
            if !merged.worth_it() {
                break;
            }
            current = merged;
            supernodes.pop();
        }
        supernodes.push(current);
        first = last + 1;
    }
    supernodes
}
