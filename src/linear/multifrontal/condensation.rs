//! Static condensation: all nodes but a few are eliminated, front by front.
//!
//! ```text
//! [A_II A_IK] [x_I]   [b_I]         S x_K = g,        S = A_KK − A_KI A_II⁻¹ A_IK,   g = b_K − A_KI A_II⁻¹ b_I
//! [A_KI A_KK] [x_K] = [b_K]         x_I = A_II⁻¹ (b_I − A_IK x_K)
//! ```
//!
//! The kept nodes are the unknowns of one front, the last, which sums up S and stays open. Source: Guyan (1965), Reduction of
//! stiffness and mass matrices, doi:10.2514/3.2874; by fronts as in the multifrontal method.

use std::ops::Range;
use std::sync::Arc;

use super::super::memory::room_for;
use super::super::{LinearFailure, Pattern, SparseMatrix};
use super::factor::Factors;
use super::scale::Scaling;
use super::solve;
use super::symbolic::Symbolic;

/// Common data of condensations on the same nodes: the order of elimination and the structure of the factors.
pub struct Condensation {
    symbolic: Arc<Symbolic>,
    scaling: Scaling,
    /// Number of kept unknowns
    kept: usize,
}

impl Condensation {
    /// Keep these nodes, in this order, all of which the pattern couples with each other.
    ///
    /// # Errors
    /// [`LinearFailure`] when the pattern is too large for an order of elimination.
    pub fn new(pattern: Arc<Pattern>, kept: &[usize]) -> Result<Self, LinearFailure> {
        // Once a matrix, whatever it takes: what is constrained stays among the equations, and L and U are those of all.
        let unsymmetric = vec![true; pattern.nodes()];
        let symbolic = Arc::new(Symbolic::new(Arc::new(Pattern::clone(&pattern).symmetric_but(unsymmetric)), kept)?);
        Ok(Self { symbolic, scaling: Scaling::default(), kept: 2 * kept.len() })
    }

    /// Floating-point operations of an elimination.
    pub fn work(&self) -> f64 {
        self.symbolic.fronts.iter().map(super::front::Front::work).sum()
    }

    /// Bytes that one condensed matrix holds.
    pub fn memory(&self) -> usize {
        size_of::<f64>() * (self.symbolic.values() + self.kept * self.kept + 2 * self.symbolic.pattern.nodes() * 3)
    }

    /// Eliminate all other nodes from a matrix on the pattern; nothing if a pivot is zero, or memory is short.
    pub fn condense(&mut self, matrix: &SparseMatrix) -> Option<Condensed> {
        let Self { symbolic, scaling, kept } = self;
        let mut factors = Factors::default();
        let contributions = symbolic.contributions(rayon::current_num_threads()) + symbolic.pattern.values();
        room_for(size_of::<f64>() * (symbolic.values() + contributions), 0).ok()?;
        factors.reserve(symbolic).ok()?;
        scaling.compute_two_sided(matrix);
        factors.compute(symbolic, matrix, scaling);
        factors.settle();
        if factors.replaced() > 0 {
            return None;
        }
        let in_order = |all: &Vec<f64>| symbolic.dofs.iter().map(|&dof| all[dof]).collect();
        let [rows, columns] = [&scaling.rows, &scaling.columns].map(in_order);
        let mut condensed =
            Condensed { symbolic: symbolic.clone(), rows, columns, stiffness: Vec::new(), reach: Vec::new(), factors };
        condensed.stiffness = condensed.unscaled(*kept);
        condensed.reach = condensed.stiffness.chunks_exact((*kept).max(1)).map(reach).collect();
        Some(condensed)
    }
}

/// A matrix condensed on the kept nodes.
pub struct Condensed {
    symbolic: Arc<Symbolic>,
    factors: Factors,
    /// R and C in the order of elimination
    rows: Vec<f64>,
    columns: Vec<f64>,
    /// S, column by column
    pub stiffness: Vec<f64>,
    /// Rows between which each column of S is not zero: bodies that only contact joins do not reach each other
    pub reach: Vec<Range<usize>>,
}

/// Returns the range from the first to the last value that is not zero.
fn reach(column: &[f64]) -> Range<usize> {
    let first = column.iter().position(|value| *value != 0.0).unwrap_or(0);
    first..column.iter().rposition(|value| *value != 0.0).map_or(0, |last| last + 1)
}

impl Condensed {
    /// Writes S over the values of a dense matrix.
    pub fn copy_to(&self, values: &mut [f64]) {
        let size = self.reach.len().max(1);
        let columns = values.chunks_exact_mut(size).zip(self.stiffness.chunks_exact(size));
        for ((to, from), reach) in columns.zip(&self.reach) {
            to[..reach.start].fill(0.0);
            to[reach.clone()].copy_from_slice(&from[reach.clone()]);
            to[reach.end..].fill(0.0);
        }
    }

    /// S from that of the scaled matrix. The scales are powers of two: not a bit is lost.
    fn unscaled(&self, kept: usize) -> Vec<f64> {
        let scaled = &self.factors.values[self.factors.values.len() - kept * kept..];
        let first = self.rows.len() - kept;
        let mut stiffness = Vec::with_capacity(scaled.len());
        for (column, scale) in scaled.chunks_exact(kept.max(1)).zip(&self.columns[first..]) {
            stiffness.extend(column.iter().zip(&self.rows[first..]).map(|(s, row)| s / row / scale));
        }
        stiffness
    }

    /// g from b, with what [`Condensed::backward`] needs of b.
    pub fn forward(&self, b: &[f64]) -> Forwarded {
        let mut ordered: Vec<f64> = self.symbolic.dofs.iter().zip(&self.rows).map(|(&dof, row)| row * b[dof]).collect();
        solve::forward(&self.symbolic, &self.factors, 1, &mut ordered);
        let first = ordered.len() - self.stiffness.len().isqrt();
        let right = ordered[first..].iter().zip(&self.rows[first..]).map(|(g, row)| g / row).collect();
        Forwarded { ordered, right }
    }

    /// x of all dofs from x of the kept ones.
    pub fn backward(&self, forwarded: &Forwarded, kept: &[f64]) -> Vec<f64> {
        let mut ordered = forwarded.ordered.clone();
        let first = ordered.len() - kept.len();
        let own = ordered[first..].iter_mut().zip(kept.iter().zip(&self.columns[first..]));
        own.for_each(|(x, (kept, column))| *x = kept / column);
        solve::backward(&self.symbolic, &self.factors, 1, &mut ordered);
        let mut x = vec![0.0; 2 * self.symbolic.pattern.nodes()];
        let scaled = ordered.iter().zip(&self.columns);
        self.symbolic.dofs.iter().zip(scaled).for_each(|(&dof, (ordered, column))| x[dof] = column * ordered);
        x
    }
}

/// A right-hand side on its way through the eliminated nodes.
pub struct Forwarded {
    ordered: Vec<f64>,
    /// g
    pub right: Vec<f64>,
}
