//! The loop over the elements of a block.

use nalgebra::Vector2;
use pulp::{Arch, Simd, WithSimd};

use super::blocks::{Block, NODES, rows};
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

/// The first node whose columns are kept. Motions count against the first node, whose own columns then are not needed, but
/// along x in rings: there a motion of all nodes stretches the hoops.
pub(super) const fn first(ring: bool) -> usize {
    if ring { 0 } else { 1 }
}

/// Motions by nodes.
fn all(motion: &[f64]) -> &[[f64; 2]] {
    motion.as_chunks().0
}

impl Block {
    /// Write what the elements put on the nodes, and what the pass asks for besides, over `sums`; returns what the first of
    /// its motions stores.
    pub fn evaluate(
        &self,
        (stiffness, ring): (&[f64], bool),
        tau: f64,
        pass: Pass,
        sums: [&mut [Vector2<f64>]; 2],
    ) -> f64 {
        match ring {
            false => self.of_section::<false>(stiffness, tau, pass, sums),
            true => self.of_section::<true>(stiffness, tau, pass, sums),
        }
    }

    fn of_section<const RING: bool>(
        &self,
        stiffness: &[f64],
        tau: f64,
        pass: Pass,
        sums: [&mut [Vector2<f64>]; 2],
    ) -> f64 {
        let (elastic, viscous) = ((stiffness, &self.initial[..]), (stiffness, &[][..]));
        match pass {
            Pass::Elastic { u, scaled: false } => self.of_kind::<1, false, RING>(elastic, [(all(u), 1.0)], sums),
            Pass::Elastic { u, scaled: true } => self.of_kind::<1, true, RING>(elastic, [(all(u), 1.0)], sums),
            Pass::Viscous { v, scaled: false } => self.of_kind::<1, false, RING>(viscous, [(all(v), tau)], sums),
            Pass::Viscous { v, scaled: true } => self.of_kind::<1, true, RING>(viscous, [(all(v), tau)], sums),
            Pass::Both { u, v } => self.of_kind::<2, false, RING>(elastic, [(all(u), 1.0), (all(v), tau)], sums),
        }
    }

    fn of_kind<const M: usize, const SCALED: bool, const RING: bool>(
        &self,
        matrices: (&[f64], &[f64]),
        motions: [(&[[f64; 2]], f64); M],
        sums: [&mut [Vector2<f64>]; 2],
    ) -> f64 {
        match self.kind {
            ElementKind::T3 => self.dispatched::<3, { rows(3) }, M, SCALED, RING>(matrices, motions, sums),
            ElementKind::T6 => self.dispatched::<6, { rows(6) }, M, SCALED, RING>(matrices, motions, sums),
            ElementKind::Q4 => self.dispatched::<4, { rows(4) }, M, SCALED, RING>(matrices, motions, sums),
            ElementKind::Q8 => self.dispatched::<8, { rows(8) }, M, SCALED, RING>(matrices, motions, sums),
            ElementKind::Q9 => self.dispatched::<9, { rows(9) }, M, SCALED, RING>(matrices, motions, sums),
        }
    }

    fn dispatched<const N: usize, const R: usize, const M: usize, const SCALED: bool, const RING: bool>(
        &self,
        (stiffness, initial): (&[f64], &[f64]),
        motions: [(&[[f64; 2]], f64); M],
        sums: [&mut [Vector2<f64>]; 2],
    ) -> f64 {
        let mut moved = [[[0.0; 2]; M]; NODES];
        for (moved, &node) in moved.iter_mut().zip(&self.nodes) {
            moved.iter_mut().zip(&motions).for_each(|(moved, (motion, _))| *moved = motion[node as usize]);
        }
        let factors = motions.map(|(_, factor)| factor);
        let mut total = [[[0.0; 2]; 2]; NODES];
        let elements = Elements::<N, R, M, SCALED, RING> {
            block: self,
            stiffness,
            initial,
            moved: &moved,
            factors,
            total: &mut total,
        };
        let energy = Arch::new().dispatch(elements);
        let [forces, others] = sums;
        for (place, total) in total[..self.nodes.len()].iter().enumerate() {
            forces[place] = Vector2::from(total[0]);
            if SCALED || M == 2 {
                others[place] = Vector2::from(total[1]);
            }
        }
        energy
    }
}

/// Elements of N nodes with R rows of numbers, at M motions of their nodes.
struct Elements<'a, const N: usize, const R: usize, const M: usize, const SCALED: bool, const RING: bool> {
    block: &'a Block,
    stiffness: &'a [f64],
    /// Forces of each element on its nodes that the first motion adds to, if there are any
    initial: &'a [f64],
    /// The motions of the block's nodes
    moved: &'a [[[f64; 2]; M]; NODES],
    /// The factors of their forces
    factors: [f64; M],
    /// The forces of the first motion, and those of the second or the magnitudes
    total: &'a mut [[[f64; 2]; 2]; NODES],
}

impl<const N: usize, const R: usize, const M: usize, const SCALED: bool, const RING: bool> WithSimd
    for Elements<'_, N, R, M, SCALED, RING>
{
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Self { block, stiffness, initial, moved, factors, total } = self;
        let mut initial = initial.as_chunks::<R>().0.iter();
        let length = 2 * (N - first(RING)) * R;
        let mut twice = simd.splat_f64s(0.0);
        for (places, &matrix) in block.places.as_chunks::<N>().0.iter().zip(&block.matrices) {
            // The remainder only tells the compiler that the place is one of the block's.
            let places = places.map(|place| place as usize % NODES);
            let matrix = &stiffness[length * matrix as usize..][..length];
            let mut motions = [[0.0; R]; M];
            for (m, motion) in motions.iter_mut().enumerate() {
                for (a, &place) in places.iter().enumerate().skip(first(RING)) {
                    let against = |i: usize| match RING && i == 0 {
                        true => moved[place][m][i],
                        false => moved[place][m][i] - moved[places[0]][m][i],
                    };
                    (0..2).for_each(|i| motion[2 * a + i] = factors[m] * against(i));
                }
            }
            let mut forces = [[simd.splat_f64s(0.0); R]; M];
            if let Some(initial) = initial.next().map(|own| S::as_simd_f64s(own).0) {
                forces[0].iter_mut().zip(initial).for_each(|(f, own)| *f = *own);
                twice = dot(simd, initial, S::as_simd_f64s(&motions[0]).0, twice);
            }
            for (dof, column) in matrix.as_chunks::<R>().0.iter().enumerate() {
                let column = S::as_simd_f64s(column).0;
                for (forces, motion) in forces.iter_mut().zip(&motions) {
                    let moved = simd.splat_f64s(motion[2 * first(RING) + dof]);
                    forces.iter_mut().zip(column).for_each(|(f, k)| *f = simd.mul_add_e_f64s(*k, moved, *f));
                }
            }
            twice = dot(simd, &forces[0], S::as_simd_f64s(&motions[0]).0, twice);
            for (m, forces) in forces.iter().enumerate() {
                let mut own = [0.0; R];
                S::as_mut_simd_f64s(&mut own).0.iter_mut().zip(forces).for_each(|(own, f)| *own = *f);
                for (a, &place) in places.iter().enumerate() {
                    for i in 0..2 {
                        total[place][m][i] += own[2 * a + i];
                        if SCALED {
                            total[place][1][i] += own[2 * a + i].abs();
                        }
                    }
                }
            }
        }
        0.5 * simd.reduce_sum_f64s(twice)
    }
}

/// sum + a·x, register by register.
#[inline(always)]
fn dot<S: Simd>(simd: S, a: &[S::f64s], x: &[S::f64s], sum: S::f64s) -> S::f64s {
    a.iter().zip(x).fold(sum, |sum, (a, x)| simd.mul_add_e_f64s(*a, *x, sum))
}
