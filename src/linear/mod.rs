//! Sparse matrices of two unknowns per node, and one of a pressure, and the linear solvers with a common trait.

mod dense;
mod halved;
mod lu;
pub mod memory;
mod multifrontal;
mod sparse;
pub mod system;

pub use dense::DenseLu;
pub use halved::{Eliminated, HalvedLu, Steady};
pub use lu::SparseLu;
pub use multifrontal::{Condensation, Condensed, Forwarded, Multifrontal};
pub use sparse::{BlockPosition, Pattern, SparseMatrix};

use thiserror::Error;

/// Reason why a linear system was not solved.
#[derive(Clone, Debug, PartialEq, Error)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub enum LinearFailure {
    /// The matrix is singular, or numerically so: message of the solver.
    #[error("the linear system is singular ({0})")]
    Singular(String),
    /// The matrix pays for a factorization only while half of its equations are constant ([`HalvedLu`]), and they are not.
    #[error("more of the matrix varies than was eliminated before")]
    Varies,
    /// The factors do not fit into memory.
    #[error(
        "the factors of {size} equations need {needed:.2} GiB, and {available:.2} GiB of memory are free: use a \
         coarser mesh, or a machine with more memory"
    )]
    TooLarge {
        /// number of equations
        size: usize,
        /// required memory [GiB]
        needed: f64,
        /// free memory [GiB]
        available: f64,
    },
}

/// A direct solver: factorize once, solve often. The elimination order is kept while the pattern is unchanged.
pub trait LinearSolver: Send {
    /// Factorizes A = LU.
    ///
    /// # Errors
    /// Returns [`LinearFailure`] if no pivot remains.
    fn factorize(&mut self, matrix: &SparseMatrix) -> Result<(), LinearFailure>;

    /// Overwrites b with A⁻¹ b of the last factorized matrix.
    fn solve(&mut self, b: &mut [f64]);

    /// Whether pivots are chosen such that a solution needs no refinement: its backward error is of the order of round-off of the
    /// largest entries.
    fn is_stable(&self) -> bool {
        false
    }

    /// Number of negative eigenvalues of the last matrix beyond those of its pressures, if it was factorized as a symmetric one: by Sylvester's law
    /// of inertia that of D.
    fn negative_pivots(&self) -> Option<usize> {
        None
    }

    /// Least number of negative eigenvalues beyond those of the pressures that the last factors prove: all of them in symmetric parts, and one more if
    /// the determinant of the rest has not the sign that its pressures give it; `None` where that is not known.
    fn least_negative(&self) -> Option<usize> {
        self.negative_pivots()
    }

    /// Number of pivots of the last factorization that vanished and were replaced; a result of [`solve`](Self::solve) then
    /// needs refinement, and may not satisfy the equations even so.
    fn perturbed_pivots(&self) -> usize {
        0
    }
}

/// A solution, and the accuracy to which it satisfies its equations.
pub struct Solution {
    /// x
    pub x: Vec<f64>,
    /// ‖A x − b‖/‖b‖ after iterative refinement [-]
    pub residual: f64,
    /// maxᵢ |b − A x|ᵢ / (|A| |x| + |b|)ᵢ: the relative change of the values of A and b that makes x exact [-]
    pub backward_error: f64,
    /// Number of pivots that vanished and were replaced
    pub perturbed_pivots: usize,
    /// Negative eigenvalues of A beyond those of its pressures, if all of it was factorized as symmetric
    pub negative_pivots: Option<usize>,
    /// Least number of negative eigenvalues of A ([`LinearSolver::least_negative`]), if anything is known of them
    pub least_negative: Option<usize>,
    /// Whether [`SparseLu`] was used because refinement stalled
    pub fallback: bool,
}

/// Backward error that needs no refinement.
const EXACT: f64 = 1e-13;

/// Backward error at which refinement counts as stalled, and a solver with full row pivoting is used.
const STALLED: f64 = 1e-12;

/// Maximum number of refinement steps.
const REFINEMENTS: usize = 3;

/// Backward error above which a system with vanished pivots counts as singular.
const HOPELESS: f64 = 1e-6;

/// Factorizes A, solves A x = b and refines x until its backward error is small or no longer decreases.
///
/// ```text
/// d = (L U)⁻¹ (b − A x),   x ← x + d
/// ```
///
/// A system whose matrix lost pivots may still have a solution; see [`Solution::perturbed_pivots`]. If refinement stalls,
/// [`SparseLu`] is used, which is slower and pivots among all rows.
///
/// # Errors
/// Returns [`LinearFailure`] if the factors do not fit into memory, the factorization fails, the solution is not finite, or
/// pivots vanished and refinement cannot compensate for them.
///
/// Source: Arioli, Demmel & Duff (1989), Solving sparse linear systems with sparse backward error, doi:10.1137/0610013.
pub fn solve(solver: &mut dyn LinearSolver, matrix: &SparseMatrix, b: &[f64]) -> Result<Solution, LinearFailure> {
    solver.factorize(matrix)?;
    let mut solution = refined(solver, matrix, b, REFINEMENTS);
    let stalled = |solution: &Solution| solution.backward_error.is_nan() || solution.backward_error > STALLED;
    if stalled(&solution) && matrix.values.iter().chain(b).all(|value| value.is_finite()) {
        let mut other = SparseLu::default();
        if other.factorize(matrix).is_ok() {
            let second = refined(&mut other, matrix, b, REFINEMENTS);
            if second.backward_error < solution.backward_error || solution.backward_error.is_nan() {
                // Factors so far off tell no sign of a determinant.
                let Solution { perturbed_pivots, negative_pivots, .. } = solution;
                solution = Solution { perturbed_pivots, negative_pivots, fallback: true, ..second };
            }
        }
    }
    if !solution.x.iter().all(|v| v.is_finite()) {
        return Err(LinearFailure::Singular("the solution is not finite: a pivot is zero".into()));
    }
    if solution.perturbed_pivots > 0 && solution.residual > HOPELESS {
        return Err(LinearFailure::Singular(format!("{} pivots are zero", solution.perturbed_pivots)));
    }
    Ok(solution)
}

/// Solves A x = b with the factors of an earlier [`solve`] on the same A, without refactorization.
pub fn solve_again(solver: &mut dyn LinearSolver, matrix: &SparseMatrix, b: &[f64]) -> Solution {
    refined(solver, matrix, b, 0)
}

/// Solves with the last factors, with at most `most` refinement steps as long as they help.
fn refined(solver: &mut dyn LinearSolver, matrix: &SparseMatrix, b: &[f64], most: usize) -> Solution {
    let mut x = b.to_vec();
    solver.solve(&mut x);
    if solver.is_stable() {
        return stable(matrix, x, b);
    }
    let (mut residual, mut backward_error) = backward_error(matrix, &x, b);
    for _ in 0..most {
        if backward_error <= EXACT {
            break;
        }
        let mut correction = residual.clone();
        solver.solve(&mut correction);
        let refined: Vec<f64> = x.iter().zip(&correction).map(|(x, d)| x + d).collect();
        let (new_residual, new_error) = self::backward_error(matrix, &refined, b);
        if new_error >= backward_error {
            break;
        }
        (x, residual, backward_error) = (refined, new_residual, new_error);
    }
    let perturbed_pivots = solver.perturbed_pivots();
    let (negative_pivots, least_negative) = (solver.negative_pivots(), solver.least_negative());
    let residual = relative(&residual, b);
    Solution { x, residual, backward_error, perturbed_pivots, negative_pivots, least_negative, fallback: false }
}

/// Returns the solution of a stable solver unrefined.
fn stable(matrix: &SparseMatrix, x: Vec<f64>, b: &[f64]) -> Solution {
    let residual = relative(&matrix.residual(&x, b), b);
    // A non-finite residual has no backward error, so that another solver is used.
    let backward_error = if residual.is_finite() { 0.0 } else { f64::NAN };
    let (perturbed_pivots, negative_pivots, least_negative) = (0, None, None);
    Solution { x, residual, backward_error, perturbed_pivots, negative_pivots, least_negative, fallback: false }
}

/// ‖r‖/‖b‖, 0 for b = 0
fn relative(residual: &[f64], b: &[f64]) -> f64 {
    let size = norm(b);
    if size > 0.0 { norm(residual) / size } else { 0.0 }
}

/// b − A x, and its largest fraction of |A| |x| + |b|.
fn backward_error(matrix: &SparseMatrix, x: &[f64], b: &[f64]) -> (Vec<f64>, f64) {
    let (residual, sizes) = matrix.residual_and_size(x, b);
    let share = |(r, size): (&f64, &f64)| match *r {
        0.0 => 0.0,
        r if r.is_finite() => r.abs() / size,
        _ => f64::INFINITY,
    };
    let largest = residual.iter().zip(&sizes).map(share).fold(0.0, f64::max);
    (residual, largest)
}

/// Euclidean norm ‖v‖.
pub fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
