//! LU of a dense matrix of two unknowns per node, in which only the diagonal block of every node varies, and in it not the
//! equation of one direction: these constant equations are eliminated once.
//!
//! ```text
//! A = S + diag(C_k),   C_k = [c_tt  c_tn]           n: direction of node k with a constant equation, t: perpendicular
//!                            [ 0     α_k]
//! A_NN = S_NN + α                                    N, T: the unknowns along n and t of all nodes
//! G = A_NN⁻¹ S_NT,   y = A_NN⁻¹ b_N
//! (S_TT − S_TN G + c_tt − c_tn G) x_T = b_T − S_TN y − c_tn y,   x_N = y − G x_T
//! ```
//!
//! G and S_TT − S_TN G are constant. The remaining matrix has half as many equations, an eighth of the operations. An A without
//! that form is factorized as a whole, if that pays.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::{Matrix2, Vector2};

use super::dense::DenseLu;
use super::{LinearFailure, LinearSolver, SparseMatrix};

/// Constant part of the equations of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steady {
    /// n, a unit vector
    pub direction: Vector2<f64>,
    /// α
    pub stiffness: f64,
}

/// Relative round-off of a node's diagonal block, within which its constant equation counts as unchanged.
const UNCHANGED: f64 = 1e-12;

/// S with the equations along n eliminated.
pub struct Eliminated {
    steady: Vec<Steady>,
    /// S_kk
    own: Vec<Matrix2<f64>>,
    /// A_NN
    along: DenseLu,
    /// G, S_TN and S_TT − S_TN G, column by column
    following: Vec<f64>,
    pulling: Vec<f64>,
    left: Vec<f64>,
}

impl Eliminated {
    /// Eliminates the constant equations from the matrix S, stored by columns.
    ///
    /// # Errors
    /// Returns [`LinearFailure`] if A_NN is singular.
    pub fn new(stiffness: &[f64], steady: Vec<Steady>) -> Result<Self, LinearFailure> {
        let count = steady.len();
        let block = |row: usize, column: usize| {
            let at = |i: usize, j: usize| stiffness[(2 * column + j) * 2 * count + 2 * row + i];
            Matrix2::new(at(0, 0), at(0, 1), at(1, 0), at(1, 1))
        };
        type Direction = fn(&Steady) -> Vector2<f64>;
        let part = |rows: Direction, columns: Direction| -> Vec<f64> {
            let entry = |at: usize| {
                let (row, column) = (at % count, at / count);
                rows(&steady[row]).dot(&(block(row, column) * columns(&steady[column])))
            };
            (0..count * count).map(entry).collect()
        };
        let mut held = part(normal, normal);
        (0..count).for_each(|k| held[k * count + k] += steady[k].stiffness);
        let mut along = DenseLu::default();
        along.factorize_columns(count, held)?;
        let mut following = part(normal, across);
        along.solve_columns(&mut following);
        let (pulling, mut left) = (part(across, normal), part(across, across));
        subtract_products(&pulling, &following, &mut left, count);
        let own = (0..count).map(|k| block(k, k)).collect();
        Ok(Self { steady, own, along, following, pulling, left })
    }

    /// Memory for this number of nodes [bytes].
    pub fn memory(nodes: usize) -> usize {
        4 * size_of::<f64>() * nodes * nodes
    }

    /// c_tt and c_tn of all nodes, if A has the form.
    fn varying(&self, matrix: &SparseMatrix) -> Option<Vec<[f64; 2]>> {
        let size = matrix.size();
        let node = |(k, (steady, own)): (usize, (&Steady, &Matrix2<f64>))| {
            let at = |i: usize, j: usize| matrix.values[(2 * k + j) * size + 2 * k + i];
            let whole = Matrix2::new(at(0, 0), at(0, 1), at(1, 0), at(1, 1));
            let (n, t, added) = (normal(steady), across(steady), whole - own);
            let little = UNCHANGED * whole.amax().max(own.amax());
            let unchanged =
                (n.dot(&(added * n)) - steady.stiffness).abs() <= little && n.dot(&(added * t)).abs() <= little;
            unchanged.then(|| [t.dot(&(added * t)), t.dot(&(added * n))])
        };
        self.steady.iter().zip(&self.own).enumerate().map(node).collect()
    }

    /// The remaining matrix to be factorized.
    fn halved(&self, varying: &[[f64; 2]]) -> Vec<f64> {
        let count = varying.len();
        let mut left = self.left.clone();
        for (column, (left, following)) in
            left.chunks_exact_mut(count.max(1)).zip(self.following.chunks_exact(count.max(1))).enumerate()
        {
            let rows = left.iter_mut().zip(following.iter().zip(varying));
            rows.for_each(|(left, (g, [_, c_tn]))| *left -= c_tn * g);
            left[column] += varying[column][0];
        }
        left
    }
}

fn normal(steady: &Steady) -> Vector2<f64> {
    steady.direction
}

/// t, n turned by −90°.
fn across(steady: &Steady) -> Vector2<f64> {
    Vector2::new(steady.direction.y, -steady.direction.x)
}

/// b − M x, M column by column.
fn subtract_product(columns: &[f64], x: &[f64], b: &mut [f64]) {
    for (column, x) in columns.chunks_exact(b.len().max(1)).zip(x) {
        b.iter_mut().zip(column).for_each(|(b, m)| *b -= m * x);
    }
}

/// B − M X, all square, column by column.
fn subtract_products(m: &[f64], x: &[f64], b: &mut [f64], size: usize) {
    let [m, x] = [m, x].map(|columns| MatRef::from_column_major_slice(columns, size, size));
    let b = MatMut::from_column_major_slice_mut(b, size, size);
    matmul(b, Accum::Add, m, x, -1.0, Par::Seq);
}

/// Dense LU that eliminates the constant part once.
#[derive(Default)]
pub struct HalvedLu {
    lu: DenseLu,
    whole: DenseLu,
    /// c_tt and c_tn of a matrix factorized by halves
    varying: Option<Vec<[f64; 2]>>,
}

impl HalvedLu {
    /// Returns a solver for matrices with the constant part `eliminated`; others may be factorized as a whole if that pays.
    pub fn with<'a>(&'a mut self, eliminated: Option<&'a Eliminated>, whole_pays: bool) -> impl LinearSolver + 'a {
        Halving { eliminated, whole_pays, own: self }
    }

    /// Whether the last matrix had the form.
    pub fn halved(&self) -> bool {
        self.varying.is_some()
    }
}

struct Halving<'a> {
    eliminated: Option<&'a Eliminated>,
    whole_pays: bool,
    own: &'a mut HalvedLu,
}

impl LinearSolver for Halving<'_> {
    fn factorize(&mut self, matrix: &SparseMatrix) -> Result<(), LinearFailure> {
        self.own.varying = self.eliminated.and_then(|eliminated| eliminated.varying(matrix));
        match (self.eliminated, &self.own.varying) {
            (Some(eliminated), Some(varying)) => {
                self.own.lu.factorize_columns(varying.len(), eliminated.halved(varying))
            }
            _ if self.whole_pays => self.own.whole.factorize(matrix),
            _ => Err(LinearFailure::Varies),
        }
    }

    fn is_stable(&self) -> bool {
        true
    }

    fn solve(&mut self, b: &mut [f64]) {
        let (Some(eliminated), Some(varying)) = (self.eliminated, &self.own.varying) else {
            return self.own.whole.solve(b);
        };
        let directions = || eliminated.steady.iter().zip(b.chunks_exact(2));
        let mut y: Vec<f64> = directions().map(|(steady, b)| normal(steady).dot(&Vector2::new(b[0], b[1]))).collect();
        let mut x: Vec<f64> = directions().map(|(steady, b)| across(steady).dot(&Vector2::new(b[0], b[1]))).collect();
        eliminated.along.solve_columns(&mut y);
        subtract_product(&eliminated.pulling, &y, &mut x);
        x.iter_mut().zip(varying.iter().zip(&y)).for_each(|(x, ([_, c_tn], y))| *x -= c_tn * y);
        self.own.lu.solve_columns(&mut x);
        subtract_product(&eliminated.following, &x, &mut y);
        for (b, (steady, (x, y))) in b.chunks_exact_mut(2).zip(eliminated.steady.iter().zip(x.iter().zip(&y))) {
            b.copy_from_slice((normal(steady) * *y + across(steady) * *x).as_slice());
        }
    }
}
