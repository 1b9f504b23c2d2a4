//! Motions of the parts of a model that nothing resists.
//!
//! Parts move as rigid bodies,
//!
//! ```text
//! u(X) = (U, V) + Θ J (X − X_c)/R          R: to the farthest node, so that all three numbers are lengths
//! ```
//!
//! and what resists is a matrix A of three rows a part: Σ r rᵀ over the equations r·(U, V, Θ) = 0 before a run
//! ([`crate::model::builder`]), and Φᵀ K Φ of the tangent K in it (`solve/floating.rs`). A vanishing singular value of A is a motion
//! without resistance. Groups of parts that A does not couple are tested separately.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Matrix2x3, Matrix3, Vector2, Vector3};

use crate::linear::{LinearSolver, Multifrontal, Pattern, SparseMatrix, norm};
use crate::mesh::joined::Joined;

/// Singular value below which a motion counts as free, of an A whose entries are about 1: far above round-off, far below any
/// contact penalty.
pub const FREE: f64 = 1e-12;

/// Number of parts up to which singular values are computed directly.
pub const FEW_PARTS: usize = 32;

/// Share of the longest projection from which another counts as long.
const NEARLY: f64 = 0.999;

/// Number of inverse iterations; each amplifies the null motion by another 1/√ε.
const ITERATIONS: usize = 4;

/// (√5 − 1)/2, whose multiples are evenly distributed modulo 1.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The three motions of a part in words.
pub const MOTIONS: [&str; 3] = ["along x", "along y", "in rotation"];

/// Centre and size of a part.
#[derive(Clone, Copy)]
pub struct Frame {
    centre: Vector2<f64>,
    radius: f64,
}

impl Frame {
    /// Creates the frame of a part with nodes at these places.
    pub fn of(places: impl Iterator<Item = Vector2<f64>> + Clone) -> Self {
        let centre = places.clone().sum::<Vector2<f64>>() / places.clone().count() as f64;
        let radius = places.fold(f64::MIN_POSITIVE, |radius, at| radius.max((at - centre).norm()));
        Self { centre, radius }
    }

    /// Motion of a place by U, V and Θ.
    pub fn motion(&self, at: Vector2<f64>) -> Matrix2x3<f64> {
        let arm = (at - self.centre) / self.radius;
        Matrix2x3::new(1.0, 0.0, -arm.y, 0.0, 1.0, arm.x)
    }
}

/// What an equation between motions has of a part: coefficients of U, V and Θ.
pub struct Term {
    /// number of the part
    pub part: usize,
    /// coefficients
    pub share: Vector3<f64>,
}

/// A by pairs of parts that it couples.
#[derive(Clone)]
pub struct Resistance {
    /// 3 × 3 blocks
    pub blocks: BTreeMap<(usize, usize), Matrix3<f64>>,
    parts: usize,
}

impl Resistance {
    /// Parts whose motions nothing resists.
    pub fn nothing(parts: usize) -> Self {
        Self { blocks: BTreeMap::new(), parts }
    }

    /// Adds an equation Σ share·(U, V, Θ) = 0, whatever its size; terms of the same part are summed.
    pub fn equate(&mut self, terms: &[Term]) {
        // Cancelling terms leave round-off relative to their size.
        let square = terms.iter().map(|term| term.share.norm_squared()).sum::<f64>().max(f64::MIN_POSITIVE);
        for (row, column) in terms.iter().flat_map(|row| terms.iter().map(move |column| (row, column))) {
            *self.blocks.entry((row.part, column.part)).or_default() += row.share * column.share.transpose() / square;
        }
    }

    /// Groups of parts that are coupled, directly or through others.
    pub fn groups(&self) -> Vec<Vec<usize>> {
        let mut joined = Joined::new(self.parts);
        self.blocks.keys().for_each(|&(row, column)| joined.join(row, column));
        joined.groups()
    }

    /// Motion of the parts of a group, three numbers each, without resistance: of a small group the one that is nearest to a motion of
    /// one part, by singular values; of a large one any, by inverse iteration with sparse factors, where a vanishing pivot is replaced
    /// by √ε.
    pub fn free_motion(&self, group: &[usize]) -> Option<DVector<f64>> {
        if group.len() <= FEW_PARTS {
            let size = 3 * group.len();
            let at =
                |i: usize, j: usize| self.blocks.get(&(group[i / 3], group[j / 3])).map_or(0.0, |b| b[(i % 3, j % 3)]);
            let decomposed = DMatrix::from_fn(size, size, at).svd(false, true);
            let ways = decomposed.v_t?;
            let free = ways.row_iter().zip(&decomposed.singular_values).filter(|(_, value)| **value < FREE);
            let onto = free.fold(DMatrix::zeros(size, size), |onto, (way, _)| onto + way.transpose() * way);
            // The first of those that are equally near.
            let near = NEARLY * onto.diagonal().max();
            return (0..size).find(|&k| onto[(k, k)] > near).map(|nearest| onto.column(nearest).into());
        }
        let matrix = self.sparse(group);
        let mut solver = Multifrontal::default();
        solver.factorize(&matrix).ok()?;
        // No motion of a few parts is orthogonal to this one.
        let mut motion: Vec<f64> = (0..matrix.size()).map(|dof| 1.0 + (dof as f64 * GOLDEN).fract()).collect();
        for _ in 0..ITERATIONS {
            solver.solve(&mut motion);
            let size = norm(&motion);
            motion.iter_mut().for_each(|m| *m /= size);
            if norm(&matrix.multiply(&motion)) < FREE {
                return Some(DVector::from_fn(3 * group.len(), |k, _| motion[4 * (k / 3) + k % 3]));
            }
        }
        None
    }

    /// A of a group, two nodes of two dofs for the three motions of a part; the fourth dof is fixed.
    fn sparse(&self, group: &[usize]) -> SparseMatrix {
        let place: BTreeMap<usize, usize> = group.iter().enumerate().map(|(k, &part)| (part, k)).collect();
        let within =
            || self.blocks.iter().filter_map(|((row, column), b)| Some((*place.get(row)?, *place.get(column)?, b)));
        let coupled: Vec<[usize; 4]> =
            within().map(|(row, column, _)| [2 * row, 2 * row + 1, 2 * column, 2 * column + 1]).collect();
        let pattern = Pattern::new(2 * group.len(), coupled.iter().map(|nodes| &nodes[..]));
        let mut matrix = SparseMatrix::zero(Arc::new(pattern));
        for (row, column, block) in within() {
            for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                matrix.add(4 * row + i, 4 * column + j, block[(i, j)]);
            }
        }
        (0..group.len()).for_each(|k| matrix.add_diagonal(4 * k + 3, 1.0));
        matrix
    }
}
