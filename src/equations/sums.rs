//! Where the terms of the equations put what they add.

use super::coupling::Layout;
use crate::linear::system::Contribution;
use crate::linear::{BlockPosition, SparseMatrix};

/// Forces on the nodes and, where they are asked for, their magnitudes and their tangent.
pub(super) struct Sums<'a> {
    /// F [F]
    pub force: &'a mut [f64],
    /// Sum of the magnitudes of what is added at each dof: the scale of the residual [F]
    pub magnitudes: Option<&'a mut [f64]>,
    /// ∂F/∂u [F/L]
    pub tangent: Option<&'a mut SparseMatrix>,
    /// who couples with whom
    pub layout: &'a Layout,
}

impl Sums<'_> {
    /// Add a force at a dof.
    pub fn add(&mut self, dof: usize, force: f64) {
        self.force[dof] += force;
        if let Some(magnitudes) = &mut self.magnitudes {
            magnitudes[dof] += force.abs();
        }
    }

    /// Add ∂f_i/∂u_j between the dofs of one node.
    pub fn stiffen(&mut self, node: usize, (i, j): (usize, usize), stiffness: f64) {
        if let Some(tangent) = &mut self.tangent {
            tangent.add_own(self.layout.original(node), (i, j), stiffness);
        }
    }

    /// Add the forces and the tangent of one contact point or element.
    pub fn contribute(&mut self, contribution: &Contribution) {
        self.push(&contribution.nodes, contribution.force.as_slice());
        self.couple(&contribution.nodes, contribution.tangent.as_slice());
    }

    /// Add forces of some nodes.
    pub fn push(&mut self, nodes: &[usize], force: &[f64]) {
        for (&node, force) in nodes.iter().zip(force.chunks_exact(2)) {
            (0..2).for_each(|i| self.add(2 * node + i, force[i]));
        }
    }

    /// Add a tangent of some nodes, column by column.
    pub fn couple(&mut self, nodes: &[usize], local: &[f64]) {
        if let Some(tangent) = &mut self.tangent {
            let blocks = self.layout.blocks_between(nodes);
            add_blocks(tangent, &blocks, local, nodes.len());
        }
    }
}

/// Add a dense tangent of `n` nodes (column-major, two dofs a node) at the given blocks (column by column).
pub(super) fn add_blocks(matrix: &mut SparseMatrix, blocks: &[BlockPosition], local: &[f64], n: usize) {
    for (columns, blocks) in local.chunks_exact(4 * n).zip(blocks.chunks_exact(n)) {
        for (j, column) in columns.chunks_exact(2 * n).enumerate() {
            for (pair, block) in column.chunks_exact(2).zip(blocks) {
                let target = &mut matrix.values[block.value(0, j)..][..2];
                target[0] += pair[0];
                target[1] += pair[1];
            }
        }
    }
}
