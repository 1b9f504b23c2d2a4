//! Dense elimination inside one front. Large products are halved down to a fixed size and shared out among threads:
//! the pieces, and so the bits of the answer, do not depend on the thread count.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};

/// Columns that are eliminated one by one; more are halved, so that most of the work is a matrix product.
const NARROW: usize = 8;

/// Operations of a product that is not worth sharing out.
const SMALL_PRODUCT: usize = 1 << 22;

/// A pivot of a matrix scaled to 1 that is nothing but round-off.
const VANISHED: f64 = 64.0 * f64::EPSILON;

/// What takes the place of a vanished pivot: √ε, so that the error it makes and the growth it causes are alike.
const REPLACEMENT: f64 = 1.490_116_119_384_765_6e-8;

/// The columns of the pivots in a front, `size` rows each.
pub struct Panel<'a> {
    pub values: &'a mut [f64],
    pub size: usize,
    /// Rows that may become pivots; the same as the number of columns
    pub pivots: usize,
    /// Row exchanged with row j when column j was eliminated
    pub exchanges: &'a mut [u32],
}

impl Panel<'_> {
    /// F = P L U with row exchanges among the pivots only. Returns the number of pivots that were replaced.
    pub fn factorize(&mut self) -> usize {
        self.factorize_columns(0, self.pivots)
    }

    /// Right-looking and recursive: the left half, its effect on the right half, the right half.
    fn factorize_columns(&mut self, start: usize, end: usize) -> usize {
        if end - start <= NARROW {
            return (start..end).map(|j| self.eliminate(j, end)).sum();
        }
        let middle = start + (end - start) / 2;
        let replaced = self.factorize_columns(start, middle);
        let (left, right) = self.values[start * self.size..end * self.size].split_at_mut((middle - start) * self.size);
        let left = MatRef::from_column_major_slice(left, self.size, middle - start);
        let right = MatMut::from_column_major_slice_mut(right, self.size, end - middle);
        let (_, right) = right.split_at_row_mut(start);
        let (mut upper, lower) = right.split_at_row_mut(middle - start);
        solve_unit_lower(left.subrows(start, middle - start), upper.as_mut());
        subtract_product(lower, left.subrows(middle, self.size - middle), upper.as_ref());
        replaced + self.factorize_columns(middle, end)
    }

    /// Eliminate column j from the columns up to `end`; the others follow in blocks.
    fn eliminate(&mut self, j: usize, end: usize) -> usize {
        let Self { size, pivots, .. } = *self;
        let column = &self.values[j * size..][..pivots];
        let largest = (j + 1..pivots).fold(j, |best, i| if column[i].abs() > column[best].abs() { i } else { best });
        self.exchanges[j] = largest as u32;
        if largest != j {
            for row in self.values.chunks_exact_mut(size) {
                row.swap(j, largest);
            }
        }
        let (left, right) = self.values.split_at_mut((j + 1) * size);
        let column = &mut left[j * size..];
        let replaced = column[j].abs() <= VANISHED;
        if replaced {
            column[j] = REPLACEMENT.copysign(column[j]);
        }
        let (pivot, below) = (column[j], &mut column[j + 1..]);
        below.iter_mut().for_each(|l| *l /= pivot);
        for target in right[..(end - j - 1) * size].chunks_exact_mut(size) {
            let u = target[j];
            for (t, l) in target[j + 1..].iter_mut().zip(&*below) {
                *t -= l * u;
            }
        }
        usize::from(replaced)
    }

    /// U₁₂ = L₁₁⁻¹ P F₁₂, in place.
    pub fn solve_upper(&self, upper: &mut [f64]) {
        for column in upper.chunks_exact_mut(self.pivots) {
            exchange(column, self.exchanges);
        }
        let columns = upper.len() / self.pivots;
        let l = MatRef::from_column_major_slice(self.values, self.size, self.pivots).subrows(0, self.pivots);
        solve_unit_lower(l, MatMut::from_column_major_slice_mut(upper, self.pivots, columns));
    }

    /// F₂₂ − L₂₁ U₁₂, in place.
    pub fn subtract_contribution(&self, upper: &[f64], contribution: &mut [f64]) {
        let below = self.size - self.pivots;
        let l = MatRef::from_column_major_slice(self.values, self.size, self.pivots).subrows(self.pivots, below);
        let u = MatRef::from_column_major_slice(upper, self.pivots, below);
        subtract_product(MatMut::from_column_major_slice_mut(contribution, below, below), l, u);
    }
}

/// Apply the row exchanges in the order in which they were made.
pub fn exchange(column: &mut [f64], exchanges: &[u32]) {
    for (j, &other) in exchanges.iter().enumerate() {
        column.swap(j, other as usize);
    }
}

/// c ← c − a b
fn subtract_product(c: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    let (rows, columns) = (c.nrows(), c.ncols());
    if rows * columns * a.ncols() <= SMALL_PRODUCT {
        return matmul(c, Accum::Add, a, b, -1.0, Par::Seq);
    }
    if rows > columns {
        let (c1, c2) = c.split_at_row_mut(rows / 2);
        let (a1, a2) = a.split_at_row(rows / 2);
        rayon::join(|| subtract_product(c1, a1, b), || subtract_product(c2, a2, b));
    } else {
        let (c1, c2) = c.split_at_col_mut(columns / 2);
        let (b1, b2) = b.split_at_col(columns / 2);
        rayon::join(|| subtract_product(c1, a, b1), || subtract_product(c2, a, b2));
    }
}

/// b ← L⁻¹ b, L unit lower triangular.
fn solve_unit_lower(l: MatRef<'_, f64>, b: MatMut<'_, f64>) {
    let columns = b.ncols();
    if columns < 2 || l.nrows() * l.nrows() * columns <= SMALL_PRODUCT {
        return solve_unit_lower_triangular_in_place(l, b, Par::Seq);
    }
    let (b1, b2) = b.split_at_col_mut(columns / 2);
    rayon::join(|| solve_unit_lower(l, b1), || solve_unit_lower(l, b2));
}
