//! Sparse LU for unsymmetric values on a symmetric pattern: a tree of dense fronts.
//!
//! ```text
//! R A C = L U      R, C: powers of two;  rows exchanged inside a front only
//! ```
//!
//! The order of elimination, the tree and the place of every value follow from the node graph, and stay while the
//! pattern stands. A front sums up the values of A and what its children pass on, eliminates its pivots with dense
//! kernels and passes the rest on to its parent. Pivots are chosen among the unknowns of the front, which keeps the
//! structure fixed. One that is nothing but round-off is replaced by √ε and counted; refinement mends what it does.
//!
//! Source: Duff & Reid (1983), doi:10.1145/356044.356047; Liu (1990), doi:10.1137/0611010; Li & Demmel (1998), Making
//! sparse Gaussian elimination scalable by static pivoting, doi:10.1109/SC.1998.10030.

mod condensation;
mod dense;
mod factor;
mod forest;
mod front;
mod jobs;
mod order;
mod reuse;
mod scale;
mod solve;
mod stacks;
mod symbolic;
mod tree;

use std::sync::Arc;

use super::memory::available_memory;
use super::{LinearFailure, LinearSolver, Pattern, SparseMatrix};
pub use condensation::{Condensation, Condensed, Forwarded};
use factor::Factors;
use scale::Scaling;
use symbolic::{Entry, Symbolic};

/// Multifrontal LU with pivoting inside the fronts. The same bits on any number of threads.
#[derive(Default)]
pub struct Multifrontal {
    symbolic: Option<Symbolic>,
    scaling: Scaling,
    factors: Factors,
    /// Right-hand side in the order of elimination
    ordered: Vec<f64>,
}

impl Multifrontal {
    /// Order the unknowns and find the structure of the factors; what is known of this very pattern is kept.
    ///
    /// # Errors
    /// [`LinearFailure`] when the pattern is too large for an order of elimination.
    pub fn analyse(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearFailure> {
        if self.symbolic.as_ref().is_none_or(|symbolic| !Arc::ptr_eq(&symbolic.pattern, pattern)) {
            self.symbolic = Some(Symbolic::new(pattern.clone(), &[])?);
            self.factors.settle();
        }
        Ok(())
    }

    /// Bytes that a factorization takes at its largest: factors, waiting contributions, places of the values and the
    /// scaled matrix. Known once the pattern is analysed, before any of the factors is.
    pub fn memory(&self) -> usize {
        self.symbolic.as_ref().map_or(0, |symbolic| {
            let values = symbolic.values()
                + symbolic.contributions(rayon::current_num_threads())
                + 2 * symbolic.pattern.values();
            size_of::<f64>() * values + size_of::<Entry>() * symbolic.entries.len()
        })
    }

    /// Refuse what does not fit, as far as the system tells: it would be killed. Of a little memory it is not even asked.
    fn check_memory(&self, size: usize) -> Result<(), LinearFailure> {
        const LITTLE: usize = 1 << 24;
        let held = size_of::<f64>() * (self.factors.values.capacity() + self.scaling.values.capacity());
        if self.memory() < held + LITTLE {
            return Ok(());
        }
        available_memory().map_or(Ok(()), |free| fits(size, self.memory(), held + free))
    }

    /// Fronts that the last factorization eliminated, and all there are: those whose values had not changed stayed.
    pub fn eliminated(&self) -> (usize, usize) {
        (self.factors.eliminated, self.symbolic.as_ref().map_or(0, |symbolic| symbolic.fronts.len()))
    }

    /// Number of values in L and U, the zeros of relaxed fronts included.
    pub fn fill(&self) -> usize {
        self.symbolic.as_ref().map_or(0, Symbolic::values)
    }
}

/// Whether bytes that are needed are available.
fn fits(size: usize, needed: usize, available: usize) -> Result<(), LinearFailure> {
    const GIB: f64 = (1u64 << 30) as f64;
    if needed <= available {
        return Ok(());
    }
    Err(LinearFailure::TooLarge { size, needed: needed as f64 / GIB, available: available as f64 / GIB })
}

impl LinearSolver for Multifrontal {
    fn factorize(&mut self, matrix: &SparseMatrix) -> Result<(), LinearFailure> {
        self.analyse(&matrix.pattern)?;
        self.check_memory(matrix.size())?;
        if let Some(symbolic) = &self.symbolic {
            self.scaling.compute(matrix);
            self.factors.compute(symbolic, &mut self.scaling.values);
        }
        Ok(())
    }

    fn solve(&mut self, b: &mut [f64]) {
        let Some(symbolic) = &self.symbolic else { return b.fill(f64::NAN) };
        let Scaling { rows, columns, .. } = &self.scaling;
        self.ordered.clear();
        let dofs = || symbolic.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]);
        self.ordered.extend(dofs().map(|dof| rows[dof] * b[dof]));
        solve::forward(symbolic, &self.factors, &mut self.ordered);
        solve::backward(symbolic, &self.factors, &mut self.ordered);
        for (dof, x) in dofs().zip(&self.ordered) {
            b[dof] = columns[dof] * x;
        }
    }

    fn perturbed_pivots(&self) -> usize {
        self.factors.replaced()
    }
}

#[cfg(test)]
mod tests {
    use super::fits;

    #[test]
    fn what_does_not_fit_is_refused_with_its_size() {
        assert_eq!(fits(2_000_000, 3 << 30, 3 << 30), Ok(()));
        let refusal = fits(2_000_000, 7 << 29, 3 << 30).unwrap_err().to_string();
        let said = "the factors of 2000000 equations take 3.5 GiB, and 3.0 GiB of memory are free";
        assert!(refusal.starts_with(said), "{refusal}");
    }
}
