//! L D Lᵀ inside one symmetric front, of which the lower half alone is stored and worked on: half the operations of an LU.
//!
//! ```text
//! Pᵀ F₁₁ P = L₁₁ D L₁₁ᵀ,   L₂₁ = F₂₁ P L₁₁⁻ᵀ D⁻¹,   F₂₂ − L₂₁ D L₂₁ᵀ goes to the parent
//! ```
//!
//! D has blocks of one and of two pivots. A pivot is eliminated in its turn unless it is far smaller than another entry of its
//! column; then the diagonal pivoting of Bunch & Kaufman chooses it, or a pair, among the pivots of the front. By Sylvester's law
//! of inertia the matrix has as many negative eigenvalues as all D of its fronts have.
//!
//! Source: Bunch & Kaufman (1977), Some stable methods for calculating inertia and solving symmetric linear systems,
//! doi:10.1090/S0025-5718-1977-0428694-0; in fronts, with the threshold: Duff & Reid (1983), doi:10.1145/356044.356047.

use std::ops::Range;

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use pulp::{Arch, NullaryFnOnce};

use super::dense::{NARROW, REPLACEMENT, SMALL_PRODUCT, VANISHED, dot, largest, subtract, subtract_product};

/// Share of the largest entry below it that a pivot must have to be eliminated in its turn.
const THRESHOLD: f64 = 0.01;

/// α of Bunch & Kaufman, (1 + √17)/8: it bounds the growth by one pair like that by two single pivots.
const ALPHA: f64 = 0.640_388_203_202_208;

/// Mark of the first pivot of a pair among the exchanges.
const PAIR: u32 = 1 << 31;

/// Rows of a square below which both of its halves are computed.
const SQUARE: usize = 24;

/// The columns of the pivots in a symmetric front.
pub struct SymmetricPanel<'a> {
    /// F₁₁ over F₂₁, by columns; what stands above the diagonal is of no matter. L afterwards, with D on the diagonal and below
    /// that of the first pivot of a pair
    pub lower: &'a mut [f64],
    /// Number of pivots, and of rows that may become pivots
    pub pivots: usize,
    /// Number of rows below
    pub below: usize,
    /// Row and column exchanged with those of each pivot
    pub exchanges: &'a mut [u32],
    /// D Lᵀ, as long as it is needed
    pub room: &'a mut Vec<f64>,
}

/// Pivots of a front that vanished and were replaced, negative eigenvalues of D, and whether P U of an unsymmetric one has a negative
/// determinant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Found {
    pub replaced: usize,
    pub negative: usize,
    pub odd: bool,
}

impl SymmetricPanel<'_> {
    fn size(&self) -> usize {
        self.pivots + self.below
    }

    /// L and D in place, with exchanges among the pivots only.
    pub fn factorize(&mut self) -> Found {
        let (mut done, mut found) = (0, Found::default());
        while done < self.pivots {
            done = self.eliminate(done, self.pivots, &mut found);
            if done < self.pivots {
                done = self.exchange_and_eliminate(done);
            }
        }
        found.negative = self.negative();
        found
    }

    /// Eliminate columns in their turn up to `end`, or to the first that needs an exchange, which is returned. All columns up to
    /// `end` have the effect of those that were eliminated: right-looking and recursive, the left half, its effect on the right
    /// half, the right half.
    fn eliminate(&mut self, start: usize, end: usize, found: &mut Found) -> usize {
        let size = self.size();
        if end - start <= NARROW {
            let columns = &mut self.lower[start * size..end * size];
            let exchanges = &mut self.exchanges[start..end];
            let block = Block { columns, size, start, pivots: self.pivots, exchanges, found };
            return Arch::new().dispatch(block);
        }
        let middle = start + (end - start) / 2;
        let reached = self.eliminate(start, middle, found);
        self.update(start..reached, middle..end);
        if reached < middle { reached } else { self.eliminate(middle, end, found) }
    }

    /// Subtract L D Lᵀ of the columns `from`, all single pivots, from the columns `to`.
    fn update(&mut self, from: Range<usize>, to: Range<usize>) {
        if from.is_empty() {
            return;
        }
        let (size, width, count) = (self.size(), to.len(), from.len());
        let (left, right) = self.lower[from.start * size..to.end * size].split_at_mut((to.start - from.start) * size);
        self.room.clear();
        self.room.reserve_exact(width * count);
        for (k, column) in left.chunks_exact(size).take(count).enumerate() {
            let pivot = column[from.start + k];
            self.room.extend(column[to.clone()].iter().map(|l| l * pivot));
        }
        let l = MatRef::from_column_major_slice(&left[..count * size], size, count);
        let weighted = MatRef::from_column_major_slice(&self.room[..], width, count).transpose();
        let right = MatMut::from_column_major_slice_mut(right, size, width);
        let (_, right) = right.split_at_row_mut(to.start);
        let (square, rest) = right.split_at_row_mut(width);
        subtract_lower(square, Accum::Add, l.subrows(to.start, width), weighted);
        subtract_product(rest, Accum::Add, l.subrows(to.end, size - to.end), weighted);
    }

    /// −L₂₁ D L₂₁ᵀ, its lower half written over that of `contribution`.
    pub fn contribution(&mut self, contribution: &mut [f64]) {
        let (size, below, pivots) = (self.size(), self.below, self.pivots);
        self.room.clear();
        self.room.reserve_exact(below * pivots);
        let mut k = 0;
        while k < pivots {
            let column = &self.lower[k * size..][..size];
            if self.exchanges[k] & PAIR == 0 {
                self.room.extend(column[pivots..].iter().map(|l| l * column[k]));
                k += 1;
            } else {
                let next = &self.lower[(k + 1) * size..][..size];
                let (a, b, c) = (column[k], column[k + 1], next[k + 1]);
                let both = || column[pivots..].iter().zip(&next[pivots..]);
                self.room.extend(both().map(|(l, m)| a * l + b * m));
                self.room.extend(both().map(|(l, m)| b * l + c * m));
                k += 2;
            }
        }
        let l = MatRef::from_column_major_slice(&*self.lower, size, pivots).subrows(pivots, below);
        let weighted = MatRef::from_column_major_slice(&self.room[..], below, pivots).transpose();
        let contribution = MatMut::from_column_major_slice_mut(contribution, below, below);
        subtract_lower(contribution, Accum::Replace, l, weighted);
    }

    /// Eliminate a pivot or a pair that Bunch & Kaufman's rule chooses; returns the column that follows.
    fn exchange_and_eliminate(&mut self, j: usize) -> usize {
        let (size, pivots) = (self.size(), self.pivots);
        let at = |lower: &[f64], row: usize, column: usize| lower[column * size + row].abs();
        let candidates = &self.lower[j * size..][..pivots];
        let row = (j + 1..pivots).fold(j, |best, i| {
            let is_larger = best == j || candidates[i].abs() > candidates[best].abs();
            if is_larger { i } else { best }
        });
        let (own, most) = (candidates[j].abs(), candidates[row].abs());
        let to_the_left = (j..row).map(|column| at(self.lower, row, column));
        let beneath = (row + 1..pivots).map(|i| at(self.lower, i, row));
        let adjacent = to_the_left.chain(beneath).fold(0.0, f64::max);
        // What is no number stays where it is.
        let moves = row != j && own * adjacent < ALPHA * most * most;
        if !moves {
            self.exchanges[j] = j as u32;
            self.eliminate_one(j);
            return j + 1;
        }
        if at(self.lower, row, row) >= ALPHA * adjacent {
            self.exchange(j, row);
            self.exchanges[j] = row as u32;
            self.eliminate_one(j);
            return j + 1;
        }
        self.exchange(j + 1, row);
        self.exchanges[j] = j as u32 | PAIR;
        self.exchanges[j + 1] = row as u32;
        self.eliminate_pair(j);
        j + 2
    }

    /// Exchange two pivots, rows and columns.
    fn exchange(&mut self, first: usize, second: usize) {
        if first == second {
            return;
        }
        let size = self.size();
        self.lower.chunks_exact_mut(size).take(first).for_each(|column| column.swap(first, second));
        for between in first + 1..second {
            self.lower.swap(first * size + between, between * size + second);
        }
        self.lower.swap(first * size + first, second * size + second);
        let (left, right) = self.lower.split_at_mut(second * size);
        left[first * size..][second + 1..size].swap_with_slice(&mut right[second + 1..size]);
    }

    /// Eliminate one pivot, with its effect on all columns to the right.
    fn eliminate_one(&mut self, j: usize) {
        let size = self.size();
        let (left, right) = self.lower[..self.pivots * size].split_at_mut((j + 1) * size);
        let column = &mut left[j * size..];
        Arch::new().dispatch(|| rank_one(column, right, size, j));
    }

    /// Eliminate a pair, with its effect on all columns to the right.
    fn eliminate_pair(&mut self, j: usize) {
        let size = self.size();
        let (left, right) = self.lower[..self.pivots * size].split_at_mut((j + 2) * size);
        let (first, second) = left[j * size..].split_at_mut(size);
        let (a, b, c) = (first[j], first[j + 1], second[j + 1]);
        let determinant = a * c - b * b;
        let weights = |l: f64, m: f64| [(c * l - b * m) / determinant, (a * m - b * l) / determinant];
        for (t, target) in right.chunks_exact_mut(size).enumerate() {
            let t = j + 2 + t;
            let [l, m] = weights(first[t], second[t]);
            Arch::new().dispatch(|| {
                subtract(&mut target[t..], &first[t..], l);
                subtract(&mut target[t..], &second[t..], m);
            });
        }
        for (l, m) in first[j + 2..].iter_mut().zip(&mut second[j + 2..]) {
            [*l, *m] = weights(*l, *m);
        }
    }

    /// Number of negative eigenvalues of D.
    fn negative(&self) -> usize {
        let size = self.size();
        let diagonal = |k: usize| self.lower[k * size + k];
        let (mut negative, mut k) = (0, 0);
        while k < self.pivots {
            if self.exchanges[k] & PAIR == 0 {
                negative += usize::from(diagonal(k) < 0.0);
                k += 1;
                continue;
            }
            let (a, b, c) = (diagonal(k), self.lower[k * size + k + 1], diagonal(k + 1));
            let alike = a * c > b * b;
            negative += if alike { 2 * usize::from(a < 0.0) } else { 1 };
            k += 2;
        }
        negative
    }
}

/// Eliminate pivot j of its column, with its effect on the columns to the right of it.
#[inline(always)]
fn rank_one(column: &mut [f64], right: &mut [f64], size: usize, j: usize) {
    let inverse = 1.0 / column[j];
    for (t, target) in right.chunks_exact_mut(size).enumerate() {
        let t = j + 1 + t;
        subtract(&mut target[t..], &column[t..], column[t] * inverse);
    }
    column[j + 1..].iter_mut().for_each(|l| *l *= inverse);
}

/// A few columns that are eliminated one by one, in their turn.
struct Block<'a> {
    columns: &'a mut [f64],
    size: usize,
    /// Number of the first column
    start: usize,
    pivots: usize,
    exchanges: &'a mut [u32],
    found: &'a mut Found,
}

impl NullaryFnOnce for Block<'_> {
    type Output = usize;

    #[inline(always)]
    fn call(self) -> usize {
        let Self { columns, size, start, pivots, exchanges, found } = self;
        for (k, exchanged) in exchanges.iter_mut().enumerate() {
            let j = start + k;
            let (left, right) = columns.split_at_mut((k + 1) * size);
            let column = &mut left[k * size..];
            let (own, most) = (column[j].abs(), largest(&column[j + 1..pivots]));
            let serves = own > VANISHED && own >= THRESHOLD * most;
            if own.max(most) <= VANISHED {
                column[j] = REPLACEMENT.copysign(column[j]);
                found.replaced += 1;
            } else if !serves {
                return j;
            }
            *exchanged = j as u32;
            rank_one(column, right, size, j);
        }
        start + exchanges.len()
    }
}

/// C ← C − A B, or C ← −A B, of a symmetric C whose lower half is wanted.
fn subtract_lower(c: MatMut<'_, f64>, accum: Accum, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    let size = c.nrows();
    if size <= SQUARE {
        return matmul(c, accum, a, b, -1.0, Par::Seq);
    }
    // Whole registers, whatever the size.
    let half = (size / 2).next_multiple_of(8);
    let (left, right) = c.split_at_col_mut(half);
    let (upper, lower) = left.split_at_row_mut(half);
    let (_, corner) = right.split_at_row_mut(half);
    let ((a1, a2), (b1, b2)) = (a.split_at_row(half), b.split_at_col(half));
    if size * size * a.ncols() <= SMALL_PRODUCT {
        subtract_lower(upper, accum, a1, b1);
        subtract_product(lower, accum, a2, b1);
        return subtract_lower(corner, accum, a2, b2);
    }
    let both = || rayon::join(|| subtract_lower(upper, accum, a1, b1), || subtract_lower(corner, accum, a2, b2));
    rayon::join(|| subtract_product(lower, accum, a2, b1), both);
}

/// Write the lower half of a square over the upper.
pub fn mirror(square: &mut [f64], size: usize) {
    for column in 1..size {
        let (left, right) = square.split_at_mut(column * size);
        for (row, value) in right[..column].iter_mut().enumerate() {
            *value = left[row * size + column];
        }
    }
}

/// y₁ ← L₁₁⁻¹ Pᵀ y₁, y₂ ← y₂ − L₂₁ y₁ in every column of y
pub struct Forward<'a> {
    pub lower: &'a [f64],
    pub exchanges: &'a [u32],
    pub size: usize,
    pub y: &'a mut [f64],
}

impl NullaryFnOnce for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { lower, exchanges, size, y } = self;
        for y in y.chunks_exact_mut(size) {
            for (j, other) in exchanges.iter().enumerate() {
                y.swap(j, (other & !PAIR) as usize);
            }
        }
        let mut columns = lower.chunks_exact(size).zip(exchanges).enumerate();
        while let Some((j, (column, exchanged))) = columns.next() {
            let mut first = j + 1;
            if exchanged & PAIR != 0
                && let Some((_, (next, _))) = columns.next()
            {
                first = j + 2;
                for y in y.chunks_exact_mut(size) {
                    let (done, rest) = y.split_at_mut(first);
                    subtract(rest, &next[first..], done[j + 1]);
                }
            }
            for y in y.chunks_exact_mut(size) {
                let (done, rest) = y.split_at_mut(first);
                subtract(rest, &column[first..], done[j]);
            }
        }
    }
}

/// y₁ ← P L₁₁⁻ᵀ (D⁻¹ y₁ − L₂₁ᵀ y₂) in every column of y
pub struct Backward<'a> {
    pub lower: &'a [f64],
    pub exchanges: &'a [u32],
    pub size: usize,
    pub y: &'a mut [f64],
}

impl NullaryFnOnce for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { lower, exchanges, size, y } = self;
        let mut j = exchanges.len();
        while j > 0 {
            j -= 1;
            let column = &lower[j * size..][..size];
            if j > 0 && exchanges[j - 1] & PAIR != 0 {
                let before = &lower[(j - 1) * size..][..size];
                let (a, b, c) = (before[j - 1], before[j], column[j]);
                let determinant = a * c - b * b;
                for y in y.chunks_exact_mut(size) {
                    let (first, second) = (y[j - 1], y[j]);
                    let rest = &y[j + 1..];
                    let sums = [dot(&before[j + 1..], rest), dot(&column[j + 1..], rest)];
                    y[j - 1] = (c * first - b * second) / determinant - sums[0];
                    y[j] = (a * second - b * first) / determinant - sums[1];
                }
                j -= 1;
            } else {
                for y in y.chunks_exact_mut(size) {
                    y[j] = y[j] / column[j] - dot(&column[j + 1..], &y[j + 1..]);
                }
            }
        }
        for y in y.chunks_exact_mut(size) {
            for (j, other) in exchanges.iter().enumerate().rev() {
                y.swap(j, (other & !PAIR) as usize);
            }
        }
    }
}
