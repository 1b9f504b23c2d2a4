//! Sparse matrices of two unknowns a node, and the linear solvers behind one trait.

mod lu;
mod sparse;

pub use lu::SparseLu;
pub use sparse::{BlockPosition, Pattern, SparseMatrix};

use thiserror::Error;

/// The matrix has no inverse, or none that double precision can find.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("the linear system is singular ({detail})")]
pub struct SingularMatrix {
    /// What the solver met.
    pub detail: String,
}

/// A direct solver: factorize once, solve often. The order of elimination is kept while the pattern stands.
pub trait LinearSolver {
    /// Factorize A = LU.
    ///
    /// # Errors
    /// [`SingularMatrix`] when no pivot is left.
    fn factorize(&mut self, matrix: &SparseMatrix) -> Result<(), SingularMatrix>;

    /// Overwrite b with A⁻¹ b of the last factorized matrix.
    fn solve(&mut self, b: &mut [f64]);
}

/// A solution and how well it satisfies its equations.
pub struct Solution {
    /// x
    pub x: Vec<f64>,
    /// ‖A x − b‖/‖b‖ after one step of iterative refinement [-]
    pub residual: f64,
}

/// Factorize A, solve A x = b and refine once.
///
/// # Errors
/// [`SingularMatrix`] when the factorization fails or the solution is not finite.
pub fn solve(solver: &mut dyn LinearSolver, matrix: &SparseMatrix, b: &[f64]) -> Result<Solution, SingularMatrix> {
    solver.factorize(matrix)?;
    let mut x = b.to_vec();
    solver.solve(&mut x);
    let mut correction = matrix.residual(&x, b);
    solver.solve(&mut correction);
    for (x, d) in x.iter_mut().zip(&correction) {
        *x += d;
    }
    if !x.iter().all(|v| v.is_finite()) {
        return Err(SingularMatrix { detail: "the solution is not finite: a pivot vanished".into() });
    }
    let size = norm(b);
    let residual = if size > 0.0 { norm(&matrix.residual(&x, b)) / size } else { 0.0 };
    Ok(Solution { x, residual })
}

/// Euclidean norm ‖v‖.
pub fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
