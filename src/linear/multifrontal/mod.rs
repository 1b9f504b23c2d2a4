//! Sparse factors on a symmetric pattern: a tree of dense fronts.
//!
//! ```text
//! R A C = L U      R, C: powers of two;  rows exchanged inside a front only
//! ```
//!
//! A front whose own values are symmetric, as the pattern says, and those that its children pass on, is factorized as L D Lᵀ
//! (`symmetric.rs`), with half the operations and half the memory; any other, and all above it, as L U.
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
mod front;
mod scale;
mod solve;
mod symbolic;
mod symmetric;

use std::sync::Arc;

use super::memory::{NoRoom, available_memory, gibibytes, room_for};
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
    /// Dofs with an equation of their own
    constrained: Vec<Constrained>,
    /// Whether the equations of the matrix reverse the sign of its determinant
    reversed: bool,
    /// Right-hand sides in the order of elimination
    ordered: Vec<f64>,
}

/// A dof with an equation of its own, A_dd x_d = b_d, and its column in the others: one that is constrained, or the second of a pressure.
struct Constrained {
    dof: usize,
    diagonal: f64,
    column: Vec<f64>,
}

impl Constrained {
    /// All of a matrix.
    fn of(matrix: &SparseMatrix) -> Vec<Self> {
        let pattern = &matrix.pattern;
        let is_second = |dof: usize| dof % 2 == 1 && pattern.is_pressure(dof / 2);
        let one = |dof: usize| {
            let blocks = pattern.column(dof / 2).filter(|_| !is_second(dof));
            let column = blocks.flat_map(|block| [0, 1].map(|i| matrix.values[block.value(i, dof % 2)])).collect();
            let own = pattern.coupled(dof / 2, dof / 2);
            let diagonal = matrix.values[own.value(dof % 2, dof % 2)];
            Self { dof, diagonal, column }
        };
        (0..matrix.size()).filter(|&dof| matrix.constrained[dof] || is_second(dof)).map(one).collect()
    }

    /// Solves for the dof by itself and moves its effect to the right-hand side; returns its value.
    fn solve(&self, pattern: &Pattern, b: &mut [f64]) -> f64 {
        let x = b[self.dof] / self.diagonal;
        if x != 0.0 {
            for (&row, pair) in pattern.neighbours(self.dof / 2).iter().zip(self.column.as_chunks::<2>().0) {
                (0..2).for_each(|i| b[2 * row + i] -= pair[i] * x);
            }
        }
        x
    }
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

    /// Bytes that a factorization takes at its largest: factors, waiting contributions, the scaled values and their places. Known
    /// once the pattern is analysed, before any of the factors is.
    pub fn memory(&self) -> usize {
        self.symbolic.as_ref().map_or(0, |symbolic| {
            let values =
                symbolic.values() + symbolic.contributions(rayon::current_num_threads()) + 4 * symbolic.entries.len();
            size_of::<f64>() * values + size_of::<Entry>() * symbolic.entries.len()
        })
    }

    /// Refuse what does not fit, and make room for what does.
    fn make_room(&mut self, size: usize) -> Result<(), LinearFailure> {
        let constrained = size_of::<f64>() * self.factors.values.capacity();
        let (needed, symbolic) = (self.memory(), self.symbolic.as_ref());
        let too_large = |NoRoom { needed, available }| LinearFailure::TooLarge { size, needed, available };
        room_for(needed, constrained).map_err(too_large)?;
        let reserved = symbolic.map_or(Ok(()), |symbolic| self.factors.reserve(symbolic));
        reserved.map_err(|_| {
            too_large(NoRoom { needed: gibibytes(needed), available: gibibytes(available_memory().unwrap_or(0)) })
        })
    }

    /// Overwrites every b with A⁻¹ b, to the bits of one by itself. L and U are read once for all of them.
    pub fn solve_all(&mut self, columns: &mut [&mut [f64]]) {
        let Some(symbolic) = &self.symbolic else { return columns.iter_mut().for_each(|b| b.fill(f64::NAN)) };
        let Scaling { rows, columns: scales } = &self.scaling;
        let own = |b: &mut &mut [f64]| {
            self.constrained.iter().map(|constrained| constrained.solve(&symbolic.pattern, b)).collect()
        };
        let constrained: Vec<Vec<f64>> = columns.iter_mut().map(own).collect();
        let count = columns.len();
        self.ordered.clear();
        for front in &symbolic.fronts {
            for b in columns.iter() {
                self.ordered.extend(symbolic.pivots(front).iter().map(|&dof| rows[dof] * b[dof]));
            }
        }
        solve::forward(symbolic, &self.factors, count, &mut self.ordered);
        solve::backward(symbolic, &self.factors, count, &mut self.ordered);
        let mut rest = &self.ordered[..];
        for front in &symbolic.fronts {
            for b in columns.iter_mut() {
                let values = rest.split_off(..front.pivots).unwrap_or_default();
                symbolic.pivots(front).iter().zip(values).for_each(|(&dof, x)| b[dof] = scales[dof] * x);
            }
        }
        for (b, constrained) in columns.iter_mut().zip(constrained) {
            self.constrained.iter().zip(constrained).for_each(|(constrained, x)| b[constrained.dof] = x);
        }
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

impl LinearSolver for Multifrontal {
    fn factorize(&mut self, matrix: &SparseMatrix) -> Result<(), LinearFailure> {
        self.analyse(&matrix.pattern)?;
        self.make_room(matrix.size())?;
        if let Some(symbolic) = &self.symbolic {
            self.scaling.compute(matrix);
            self.factors.compute(symbolic, matrix, &self.scaling);
            self.constrained = Constrained::of(matrix);
            self.reversed = matrix.reversed;
        }
        Ok(())
    }

    fn solve(&mut self, b: &mut [f64]) {
        self.solve_all(&mut [b]);
    }

    fn perturbed_pivots(&self) -> usize {
        self.factors.replaced()
    }

    fn negative_pivots(&self) -> Option<usize> {
        let symbolic = self.symbolic.as_ref()?;
        let negative = || self.factors.negative().saturating_sub(symbolic.pressures(true));
        symbolic.fronts.iter().all(|front| front.symmetric).then(negative)
    }

    fn least_negative(&self) -> Option<usize> {
        let symbolic = self.symbolic.as_ref()?;
        let [by_nature, of_rest] = [true, false].map(|symmetric| symbolic.pressures(symmetric));
        let odd = symbolic.fronts.iter().any(|front| !front.symmetric)
            && (self.factors.is_odd() != self.reversed) != (of_rest % 2 == 1);
        let negative = self.factors.negative().saturating_sub(by_nature);
        (self.factors.replaced() == 0).then_some(negative + usize::from(odd))
    }
}
