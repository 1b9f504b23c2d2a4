//! LU of a dense matrix: one with all nodes coupled.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::{MatMut, MatRef, Par};

use super::{LinearFailure, LinearSolver, SparseMatrix};

/// Dense LU with row pivoting on one thread: the few hundred unknowns of a contact take less time than starting another
/// thread.
#[derive(Default)]
pub struct DenseLu {
    size: usize,
    /// L and U, column by column
    factors: Vec<f64>,
    /// Row at each position, and position of each row
    rows: Vec<usize>,
    places: Vec<usize>,
    room: Option<MemBuffer>,
}

impl DenseLu {
    /// Factorizes a matrix of this size, given column by column.
    ///
    /// # Errors
    /// Returns [`LinearFailure::Singular`] if a pivot vanishes.
    pub fn factorize_columns(&mut self, size: usize, columns: Vec<f64>) -> Result<(), LinearFailure> {
        self.resize(size);
        if size == 0 {
            return Ok(());
        }
        let Self { size, factors, rows, places, room } = self;
        *factors = columns;
        let Some(room) = room else { return Ok(()) };
        let lu = MatMut::from_column_major_slice_mut(factors, *size, *size);
        factor::lu_in_place(lu, rows, places, Par::Seq, MemStack::new(room), Default::default());
        let vanished = |k: &usize| factors[k * *size + k] == 0.0;
        match (0..*size).find(vanished) {
            Some(k) => Err(LinearFailure::Singular(format!("pivot {k} of {size} is zero"))),
            None => Ok(()),
        }
    }

    /// Solves for as many right-hand sides as there are columns.
    pub fn solve_columns(&self, b: &mut [f64]) {
        if b.is_empty() {
            return;
        }
        let Self { size, factors, rows, places, .. } = self;
        let count = b.len() / (*size).max(1);
        let mut room = MemBuffer::new(solve::solve_in_place_scratch::<usize, f64>(*size, count, Par::Seq));
        let lu = MatRef::from_column_major_slice(factors, *size, *size);
        let right = MatMut::from_column_major_slice_mut(b, *size, count);
        let exchanges = PermRef::new_checked(rows, places, *size);
        solve::solve_in_place_with_conj(lu, lu, exchanges, faer::Conj::No, right, Par::Seq, MemStack::new(&mut room));
    }

    /// Allocates memory for matrices of this size.
    fn resize(&mut self, size: usize) {
        if self.size == size && self.room.is_some() {
            return;
        }
        self.size = size;
        self.rows = vec![0; size];
        self.places = vec![0; size];
        let needed = factor::lu_in_place_scratch::<usize, f64>(size, size, Par::Seq, Default::default());
        self.room = Some(MemBuffer::new(needed));
    }
}

impl LinearSolver for DenseLu {
    fn factorize(&mut self, matrix: &SparseMatrix) -> Result<(), LinearFailure> {
        let mut columns = std::mem::take(&mut self.factors);
        columns.clone_from(&matrix.values);
        self.factorize_columns(matrix.size(), columns)
    }

    fn is_stable(&self) -> bool {
        true
    }

    fn solve(&mut self, b: &mut [f64]) {
        match self.room {
            Some(_) => self.solve_columns(b),
            None => b.fill(f64::NAN),
        }
    }
}
