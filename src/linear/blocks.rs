//! LU of a dense matrix by blocks, of which some are zero.
//!
//! Bodies condensed on the nodes at a contact have a dense matrix each, and contact couples a node with those opposite to it
//! only. Numbered along the contact, body after body, the blocks between the bodies are banded:
//!
//! ```text
//! A = [S₁  B ]      A_kk = P L_kk U_kk,   L_ik = A_ik U_kk⁻¹,   U_kj = L_kk⁻¹ P⁻¹ A_kj                    for k = 1, 2, …
//!     [B'  S₂]      A_ij ← A_ij − L_ik U_kj                     for all i, j > k with filled blocks A_ik and A_kj
//! ```
//!
//! L and U of the banded blocks are triangular: two equal bodies take half the operations of an LU without zeros. Rows are
//! exchanged within a block only. That is enough for bodies, whose matrices are positive definite where they are supported;
//! where an entry of L becomes large, the whole matrix is factorized with exchanges among all rows.

use std::ops::Range;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place};
use faer::{Accum, MatMut, Par};
use pulp::{Arch, NullaryFnOnce};

use super::dense::DenseLu;
use super::multifrontal::{largest, subtract};
use super::{LinearFailure, LinearSolver, SparseMatrix};

/// Unknowns of a block: fewer make products that are bound by memory, more leave fewer zeros.
const BLOCK: usize = 40;

/// Largest entry of L: with exchanges among all rows none exceeds 1, and every block may multiply round-off by this factor.
const LARGEST: f64 = 100.0;

/// LU by blocks on one thread, for a matrix of which all nodes are coupled.
#[derive(Default)]
pub struct BlockLu {
    /// First unknown of every block, and the number of unknowns
    starts: Vec<usize>,
    /// L and U, column by column; what lies in blocks that are zero is undefined
    factors: Vec<f64>,
    /// Row at each position within its block, and position of each row
    rows: Vec<usize>,
    places: Vec<usize>,
    /// Unknowns in the filled blocks below and above each block on the diagonal
    below: Vec<Vec<Range<usize>>>,
    above: Vec<Vec<Range<usize>>>,
    /// LU with exchanges among all rows
    whole: DenseLu,
    /// Whether it was used
    is_whole: bool,
}

impl BlockLu {
    /// Divides the unknowns into blocks, within the parts that start at these unknowns.
    pub fn divide(&mut self, size: usize, parts: &[usize]) {
        self.starts.clear();
        for (k, &start) in parts.iter().enumerate() {
            let length = parts.get(k + 1).map_or(size, |end| *end) - start;
            let count = length.div_ceil(BLOCK);
            self.starts.extend((0..count).map(|block| start + block * length / count));
        }
        self.starts.push(size);
    }

    /// Whether the last matrix was factorized by blocks.
    pub fn serves(&self) -> bool {
        !self.is_whole
    }

    fn block(&self, k: usize) -> Range<usize> {
        self.starts[k]..self.starts[k + 1]
    }

    fn blocks(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Finds the filled blocks of L and U, and copies the values of A there; returns whether any other block is left.
    fn fill(&mut self, values: &[f64]) -> bool {
        let (size, count) = (self.rows.len(), self.blocks());
        let mut filled = vec![false; count * count];
        for (j, i) in (0..count * count).map(|k| (k / count, k % count)) {
            let mut columns = values[size * self.starts[j]..size * self.starts[j + 1]].chunks_exact(size);
            if columns.any(|column| is_filled(&column[self.block(i)])) {
                (filled[j * count + i], filled[i * count + j]) = (true, true);
            }
        }
        for k in 0..count {
            let below: Vec<usize> = (k + 1..count).filter(|i| filled[k * count + i]).collect();
            for (&i, &j) in below.iter().flat_map(|i| below.iter().map(move |j| (i, j))) {
                filled[j * count + i] = true;
            }
        }
        if filled.iter().enumerate().all(|(k, filled)| *filled || k / count == k % count) {
            return false;
        }
        let runs = |k: usize, blocks: Range<usize>| self.runs(blocks.filter(|i| filled[k * count + i]));
        let below: Vec<_> = (0..count).map(|k| runs(k, k + 1..count)).collect();
        let above: Vec<_> = (0..count).map(|k| runs(k, 0..k)).collect();
        self.factors.resize(size * size, 0.0);
        for (k, (below, above)) in below.iter().zip(&above).enumerate() {
            let own = self.block(k);
            for j in own.clone() {
                let (from, to) = (&values[j * size..][..size], &mut self.factors[j * size..][..size]);
                for rows in above.iter().chain([&own]).chain(below) {
                    to[rows.clone()].copy_from_slice(&from[rows.clone()]);
                }
            }
        }
        (self.below, self.above) = (below, above);
        true
    }

    /// Unknowns of ascending blocks, neighbours together.
    fn runs(&self, blocks: impl Iterator<Item = usize>) -> Vec<Range<usize>> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        for own in blocks.map(|block| self.block(block)) {
            match runs.last_mut().filter(|last| last.end == own.start) {
                Some(last) => last.end = own.end,
                None => runs.push(own),
            }
        }
        runs
    }

    /// Eliminates all unknowns; returns whether no entry of L became too large, nor a pivot zero.
    fn eliminate(&mut self) -> bool {
        (0..self.blocks()).for_each(|k| self.eliminate_block(k));
        let size = self.rows.len();
        (0..self.blocks()).all(|k| {
            self.block(k).all(|j| {
                let column = &self.factors[j * size..][..size];
                let largest = self.below[k].iter().map(|rows| largest(&column[rows.clone()])).fold(0.0, f64::max);
                largest <= LARGEST && column[j] != 0.0
            })
        })
    }

    /// Eliminates the unknowns of block k.
    fn eliminate_block(&mut self, k: usize) {
        let size = self.rows.len();
        let own = self.block(k);
        let (first, end, width) = (own.start, own.end, own.len());
        let (left, right) = self.factors.split_at_mut(end * size);
        let panel = MatMut::from_column_major_slice_mut(&mut left[first * size..], size, width);
        let (_, panel) = panel.split_at_row_mut(first);
        let (mut corner, mut lower) = panel.split_at_row_mut(width);
        let needed = factor::lu_in_place_scratch::<usize, f64>(width, width, Par::Seq, Default::default());
        let (rows, places) = (&mut self.rows[own.clone()], &mut self.places[own]);
        let mut room = MemBuffer::new(needed);
        factor::lu_in_place(corner.as_mut(), rows, places, Par::Seq, MemStack::new(&mut room), Default::default());
        let corner = corner.as_ref();
        let below = &self.below[k];
        for run in below {
            let lower = lower.as_mut().subrows_mut(run.start - end, run.len());
            solve_lower_triangular_in_place(corner.transpose(), lower.transpose_mut(), Par::Seq);
            for column in right[(run.start - end) * size..(run.end - end) * size].chunks_exact_mut(size) {
                exchange(&mut column[first..end], rows);
            }
        }
        let right = MatMut::from_column_major_slice_mut(right, size, size - end);
        let (mut upper, mut rest) = right.split_at_row_mut(end);
        let mut upper = upper.as_mut().subrows_mut(first, width);
        for run in below {
            let upper = upper.as_mut().subcols_mut(run.start - end, run.len());
            solve_unit_lower_triangular_in_place(corner, upper, Par::Seq);
        }
        for (columns, rows) in below.iter().flat_map(|columns| below.iter().map(move |rows| (columns, rows))) {
            let l = lower.as_ref().subrows(rows.start - end, rows.len());
            let u = upper.as_ref().subcols(columns.start - end, columns.len());
            let rest = rest.as_mut().subrows_mut(rows.start - end, rows.len());
            matmul(rest.subcols_mut(columns.start - end, columns.len()), Accum::Add, l, u, -1.0, Par::Seq);
        }
    }
}

impl LinearSolver for BlockLu {
    fn factorize(&mut self, matrix: &SparseMatrix) -> Result<(), LinearFailure> {
        let size = matrix.size();
        if self.starts.last() != Some(&size) {
            self.divide(size, &[0]);
        }
        self.rows.resize(size, 0);
        self.places.resize(size, 0);
        self.is_whole = !(self.fill(&matrix.values) && self.eliminate());
        if self.is_whole { self.whole.factorize(matrix) } else { Ok(()) }
    }

    fn is_stable(&self) -> bool {
        true
    }

    fn solve(&mut self, b: &mut [f64]) {
        if self.is_whole {
            return self.whole.solve(b);
        }
        Arch::new().dispatch(Substitution { lu: self, b });
    }
}

/// b ← U⁻¹ L⁻¹ b
struct Substitution<'a> {
    lu: &'a BlockLu,
    b: &'a mut [f64],
}

impl NullaryFnOnce for Substitution<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { lu, b } = self;
        let size = lu.rows.len();
        for k in 0..lu.blocks() {
            let own = lu.block(k);
            exchange(&mut b[own.clone()], &lu.rows[own.clone()]);
            for j in own.clone() {
                let (column, value) = (&lu.factors[j * size..][..size], b[j]);
                subtract(&mut b[j + 1..own.end], &column[j + 1..own.end], value);
                for rows in &lu.below[k] {
                    subtract(&mut b[rows.clone()], &column[rows.clone()], value);
                }
            }
        }
        for k in (0..lu.blocks()).rev() {
            let own = lu.block(k);
            for j in own.clone().rev() {
                let column = &lu.factors[j * size..][..size];
                b[j] /= column[j];
                let value = b[j];
                subtract(&mut b[own.start..j], &column[own.start..j], value);
                for rows in &lu.above[k] {
                    subtract(&mut b[rows.clone()], &column[rows.clone()], value);
                }
            }
        }
    }
}

/// Whether any value is not zero.
fn is_filled(values: &[f64]) -> bool {
    values.iter().fold(0, |bits, value| bits | value.to_bits() << 1) != 0
}

/// Sorts the values of a block by the rows at each position.
fn exchange(values: &mut [f64], rows: &[usize]) {
    if rows.iter().enumerate().all(|(k, row)| k == *row) {
        return;
    }
    let old = values.to_vec();
    values.iter_mut().zip(rows).for_each(|(value, &row)| *value = old[row]);
}
