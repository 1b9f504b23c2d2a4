//! faer's sparse LU with column ordering; its symbolic part is kept while the pattern is unchanged.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::lu::{LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Spec};

use super::{LinearFailure, LinearSolver, Pattern, SparseMatrix};

/// Supernodal LU with partial pivoting for unsymmetric values (faer).
#[derive(Default)]
pub struct SparseLu {
    order: Option<Order>,
    factors: NumericLu<usize, f64>,
}

/// Data that depend only on the pattern.
struct Order {
    pattern: Arc<Pattern>,
    columns: Vec<usize>,
    rows: Vec<usize>,
    symbolic: SymbolicLu<usize>,
}

// The factorization uses one thread: its pivots, and therefore the bits of the result, must not depend on the number of
// threads.
const SERIAL: Par = Par::Seq;

impl Order {
    fn new(pattern: Arc<Pattern>) -> Result<Self, LinearFailure> {
        let (columns, rows) = pattern.scalar();
        let n = columns.len() - 1;
        let scalar = SymbolicSparseColMatRef::new_checked(n, n, &columns, None, &rows);
        // The automatic choice is column-by-column elimination for a few thousand unknowns, which is 5 times slower.
        let supernodal = SupernodalThreshold::FORCE_SUPERNODAL;
        let parameters = LuSymbolicParams { supernodal_flop_ratio_threshold: supernodal, ..Default::default() };
        let symbolic = factorize_symbolic_lu(scalar, parameters).map_err(failed)?;
        Ok(Self { pattern, columns, rows, symbolic })
    }
}

fn failed(cause: impl std::fmt::Debug) -> LinearFailure {
    LinearFailure::Singular(format!("{cause:?}"))
}

impl LinearSolver for SparseLu {
    fn factorize(&mut self, matrix: &SparseMatrix) -> Result<(), LinearFailure> {
        let order = match self.order.take() {
            Some(order) if Arc::ptr_eq(&order.pattern, &matrix.pattern) => order,
            _ => Order::new(matrix.pattern.clone())?,
        };
        let n = matrix.size();
        let scalar = SymbolicSparseColMatRef::new_checked(n, n, &order.columns, None, &order.rows);
        let a = SparseColMatRef::new(scalar, &matrix.values[..]);
        let mut buffer = MemBuffer::new(order.symbolic.factorize_numeric_lu_scratch::<f64>(SERIAL, Spec::default()));
        order
            .symbolic
            .factorize_numeric_lu(&mut self.factors, a, SERIAL, MemStack::new(&mut buffer), Spec::default())
            .map_err(failed)?;
        self.order = Some(order);
        Ok(())
    }

    fn solve(&mut self, b: &mut [f64]) {
        let Some(order) = &self.order else { return b.fill(f64::NAN) };
        let mut buffer = MemBuffer::new(order.symbolic.solve_in_place_scratch::<f64>(1, SERIAL));
        let n = b.len();
        let factors = LuRef::new_unchecked(&order.symbolic, &self.factors);
        let x = MatMut::from_column_major_slice_mut(b, n, 1);
        factors.solve_in_place_with_conj(Conj::No, x, SERIAL, MemStack::new(&mut buffer));
    }
}
