//! The loop over the elements of a block.

use nalgebra::Vector2;
use pulp::{Arch, NullaryFnOnce};

use super::blocks::{Block, NODES};
use crate::mesh::shape::ElementKind;

/// What the blocks are asked for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Pass<'a> {
    /// Forces at displacements, and the sums of their magnitudes if wanted
    Elastic { u: &'a [f64], scaled: bool },
    /// Viscous forces at velocities, and the sums of their magnitudes if wanted
    Viscous { v: &'a [f64], scaled: bool },
    /// Forces at displacements, and viscous ones at velocities
    Both { u: &'a [f64], v: &'a [f64] },
}

fn all(motion: &[f64]) -> &[[f64; 2]] {
    motion.as_chunks().0
}

impl Block {
    /// Write what the elements put on the nodes, and what the pass asks for besides, over `sums`; returns what the first of
    /// its motions stores.
    pub fn evaluate(&self, stiffness: &[f64], tau: f64, pass: Pass, sums: [&mut [Vector2<f64>]; 2]) -> f64 {
        match pass {
            Pass::Elastic { u, scaled: false } => self.of_kind::<1, false>(stiffness, [(all(u), 1.0)], sums),
            Pass::Elastic { u, scaled: true } => self.of_kind::<1, true>(stiffness, [(all(u), 1.0)], sums),
            Pass::Viscous { v, scaled: false } => self.of_kind::<1, false>(stiffness, [(all(v), tau)], sums),
            Pass::Viscous { v, scaled: true } => self.of_kind::<1, true>(stiffness, [(all(v), tau)], sums),
            Pass::Both { u, v } => self.of_kind::<2, false>(stiffness, [(all(u), 1.0), (all(v), tau)], sums),
        }
    }

    fn of_kind<const M: usize, const SCALED: bool>(
        &self,
        stiffness: &[f64],
        motions: [(&[[f64; 2]], f64); M],
        sums: [&mut [Vector2<f64>]; 2],
    ) -> f64 {
        match self.kind {
            ElementKind::T3 => self.dispatched::<3, M, SCALED>(stiffness, motions, sums),
            ElementKind::T6 => self.dispatched::<6, M, SCALED>(stiffness, motions, sums),
            ElementKind::Q4 => self.dispatched::<4, M, SCALED>(stiffness, motions, sums),
            ElementKind::Q8 => self.dispatched::<8, M, SCALED>(stiffness, motions, sums),
            ElementKind::Q9 => self.dispatched::<9, M, SCALED>(stiffness, motions, sums),
        }
    }

    fn dispatched<const N: usize, const M: usize, const SCALED: bool>(
        &self,
        stiffness: &[f64],
        motions: [(&[[f64; 2]], f64); M],
        sums: [&mut [Vector2<f64>]; 2],
    ) -> f64 {
        Arch::new().dispatch(Elements::<N, M, SCALED> { block: self, stiffness, motions, sums })
    }
}

/// Elements of N nodes at M motions of their nodes, each with the factor of its forces.
struct Elements<'a, const N: usize, const M: usize, const SCALED: bool> {
    block: &'a Block,
    stiffness: &'a [f64],
    motions: [(&'a [[f64; 2]], f64); M],
    sums: [&'a mut [Vector2<f64>]; 2],
}

impl<const N: usize, const M: usize, const SCALED: bool> NullaryFnOnce for Elements<'_, N, M, SCALED> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        let Self { block, stiffness, motions, sums } = self;
        let (mut moved, mut total) = ([[[0.0; 2]; M]; NODES], [[[0.0; 2]; 2]; NODES]);
        for (moved, &node) in moved.iter_mut().zip(&block.nodes) {
            for (moved, (motion, factor)) in moved.iter_mut().zip(&motions) {
                *moved = motion[node as usize].map(|x| factor * x);
            }
        }
        // Columns of N nodes' rows, 2 (N − 1) a matrix
        let columns = stiffness.as_chunks::<2>().0.as_chunks::<N>().0;
        let mut energy = 0.0;
        for (places, &matrix) in block.places.as_chunks::<N>().0.iter().zip(&block.matrices) {
            let places = places.map(|place| place as usize % NODES);
            let columns = &columns[2 * (N - 1) * matrix as usize..][..2 * (N - 1)];
            let first = moved[places[0]];
            let mut forces = [[[0.0; 2]; N]; M];
            for (pair, place) in columns.chunks_exact(2).zip(&places[1..]) {
                for (m, forces) in forces.iter_mut().enumerate() {
                    let [x, y] = [0, 1].map(|i| moved[*place][m][i] - first[m][i]);
                    for (force, (cx, cy)) in forces.iter_mut().zip(pair[0].iter().zip(&pair[1])) {
                        (0..2).for_each(|i| force[i] += cx[i] * x + cy[i] * y);
                    }
                }
            }
            for (a, &place) in places.iter().enumerate() {
                let sums = &mut total[place];
                for i in 0..2 {
                    energy += (moved[place][0][i] - first[0][i]) * forces[0][a][i];
                    sums[0][i] += forces[0][a][i];
                    if SCALED {
                        sums[1][i] += forces[0][a][i].abs();
                    } else if M == 2 {
                        sums[1][i] += forces[M - 1][a][i];
                    }
                }
            }
        }
        let [forces, others] = sums;
        for (place, total) in total[..block.nodes.len()].iter().enumerate() {
            forces[place] = Vector2::from(total[0]);
            if SCALED || M == 2 {
                others[place] = Vector2::from(total[1]);
            }
        }
        0.5 * energy
    }
}
