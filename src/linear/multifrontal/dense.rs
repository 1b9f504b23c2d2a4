//! Dense elimination inside one front. Large products are halved down to a fixed size and shared out among threads:
//! the pieces, and so the bits of the answer, do not depend on the thread count.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use pulp::{Arch, NullaryFnOnce};

/// Columns that are eliminated one by one; more are halved, so that most of the work is a matrix product.
pub const NARROW: usize = 8;

/// Operations of a product that is not worth sharing out.
pub const SMALL_PRODUCT: usize = 1 << 22;

/// A pivot of a matrix scaled to 1 that is nothing but round-off.
pub const VANISHED: f64 = 64.0 * f64::EPSILON;

/// Replacement of a zero pivot: √ε, so that the error it makes and the growth it causes are alike.
pub const REPLACEMENT: f64 = 1.490_116_119_384_765_6e-8;

/// The rows and columns of the pivots in a front.
pub struct Panel<'a> {
    /// F₁₁ over F₂₁, by columns
    pub lower: &'a mut [f64],
    /// F₁₂ transposed, by columns: one column a pivot, so that all loops are long
    pub upper: &'a mut [f64],
    /// Number of pivots, and of rows that may become pivots
    pub pivots: usize,
    /// Number of rows in `upper`
    pub below: usize,
    /// Row exchanged with row j when column j was eliminated
    pub exchanges: &'a mut [u32],
}

impl Panel<'_> {
    fn size(&self) -> usize {
        self.pivots + self.below
    }

    /// F₁₁ = P L₁₁ U₁₁, L₂₁ = F₂₁ U₁₁⁻¹, U₁₂ = L₁₁⁻¹ P F₁₂ in place, with row exchanges among the pivots only. Returns
    /// the number of pivots that were replaced.
    pub fn factorize(&mut self) -> usize {
        let replaced = self.factorize_columns(0, self.pivots);
        if self.below > 0 {
            for (j, &other) in self.exchanges.iter().enumerate().filter(|&(j, &other)| other as usize != j) {
                let (left, right) = self.upper.split_at_mut(other as usize * self.below);
                left[j * self.below..][..self.below].swap_with_slice(&mut right[..self.below]);
            }
            let l = MatRef::from_column_major_slice(&*self.lower, self.size(), self.pivots);
            solve_upper(l.subrows(0, self.pivots), self.upper, self.below);
        }
        replaced
    }

    /// Right-looking and recursive: the left half, its effect on the right half, the right half.
    fn factorize_columns(&mut self, start: usize, end: usize) -> usize {
        let size = self.size();
        if end - start <= NARROW {
            let columns = &mut self.lower[start * size..end * size];
            let block = Block { columns, size, start, pivots: self.pivots, exchanges: &mut self.exchanges[start..end] };
            return Arch::new().dispatch(block);
        }
        let middle = start + (end - start) / 2;
        let replaced = self.factorize_columns(start, middle);
        let (left, right) = self.lower[start * size..end * size].split_at_mut((middle - start) * size);
        for column in right.chunks_exact_mut(size) {
            exchange(&mut column[start..], &self.exchanges[start..middle], start);
        }
        let l = MatRef::from_column_major_slice(left, size, middle - start);
        let right = MatMut::from_column_major_slice_mut(right, size, end - middle);
        let (_, right) = right.split_at_row_mut(start);
        let (mut upper, rest) = right.split_at_row_mut(middle - start);
        solve_unit_lower(l.subrows(start, middle - start), upper.as_mut());
        subtract_product(rest, Accum::Add, l.subrows(middle, size - middle), upper.as_ref());
        let replaced = replaced + self.factorize_columns(middle, end);
        for column in self.lower[start * size..middle * size].chunks_exact_mut(size) {
            exchange(&mut column[middle..], &self.exchanges[middle..end], middle);
        }
        replaced
    }

    /// Whether det F₁₁ is negative: every row exchange and every negative pivot reverses its sign.
    pub fn is_odd(&self) -> bool {
        let reverses = |(j, &other): (usize, &u32)| (other as usize != j) != (self.lower[j * self.size() + j] < 0.0);
        self.exchanges.iter().enumerate().filter(|pivot| reverses(*pivot)).count() % 2 == 1
    }

    /// −L₂₁ U₁₂, written over `contribution`.
    pub fn contribution(&self, contribution: &mut [f64]) {
        let (below, pivots) = (self.below, self.pivots);
        let l = MatRef::from_column_major_slice(&*self.lower, self.size(), pivots).subrows(pivots, below);
        let u = MatRef::from_column_major_slice(&*self.upper, below, pivots).transpose();
        subtract_product(MatMut::from_column_major_slice_mut(contribution, below, below), Accum::Replace, l, u);
    }
}

/// A few columns that are eliminated one by one.
struct Block<'a> {
    columns: &'a mut [f64],
    size: usize,
    /// Number of the first column
    start: usize,
    pivots: usize,
    exchanges: &'a mut [u32],
}

impl NullaryFnOnce for Block<'_> {
    type Output = usize;

    #[inline(always)]
    fn call(self) -> usize {
        let Self { columns, size, start, pivots, exchanges } = self;
        let mut replaced = 0;
        for (k, exchanged) in exchanges.iter_mut().enumerate() {
            let j = start + k;
            let mut largest = j;
            let candidates = &columns[k * size..][..pivots];
            let mut best = candidates[j].abs();
            for (i, value) in candidates.iter().enumerate().skip(j + 1) {
                if value.abs() > best {
                    (largest, best) = (i, value.abs());
                }
            }
            *exchanged = largest as u32;
            if largest != j {
                for column in columns.chunks_exact_mut(size) {
                    column.swap(j, largest);
                }
            }
            let (left, right) = columns.split_at_mut((k + 1) * size);
            let column = &mut left[k * size..];
            if column[j].abs() <= VANISHED {
                column[j] = REPLACEMENT.copysign(column[j]);
                replaced += 1;
            }
            let inverse = 1.0 / column[j];
            let below = &mut column[j + 1..];
            for l in below.iter_mut() {
                *l *= inverse;
            }
            for target in right.chunks_exact_mut(size) {
                let u = target[j];
                subtract(&mut target[j + 1..], below, u);
            }
        }
        replaced
    }
}

/// X ← X L⁻ᵀ for the unit lower triangle L.
fn solve_upper(l: MatRef<'_, f64>, x: &mut [f64], rows: usize) {
    let n = l.ncols();
    if n <= NARROW {
        return Arch::new().dispatch(Substitution { l, x, rows });
    }
    let middle = n / 2;
    let (left, right) = x.split_at_mut(middle * rows);
    solve_upper(l.submatrix(0, 0, middle, middle), left, rows);
    let product = MatRef::from_column_major_slice(&*left, rows, middle);
    let target = MatMut::from_column_major_slice_mut(right, rows, n - middle);
    subtract_product(target, Accum::Add, product, l.submatrix(middle, 0, n - middle, middle).transpose());
    solve_upper(l.submatrix(middle, middle, n - middle, n - middle), right, rows);
}

/// Substitution for a few columns, one by one.
struct Substitution<'a> {
    l: MatRef<'a, f64>,
    x: &'a mut [f64],
    rows: usize,
}

impl NullaryFnOnce for Substitution<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { l, x, rows } = self;
        for j in 0..l.ncols() {
            let (done, rest) = x.split_at_mut((j + 1) * rows);
            let own = &done[j * rows..];
            for (i, target) in rest.chunks_exact_mut(rows).enumerate() {
                subtract(target, own, l[(j + 1 + i, j)]);
            }
        }
    }
}

/// y ← y − c v
#[inline(always)]
pub fn subtract(y: &mut [f64], column: &[f64], value: f64) {
    for (y, c) in y.iter_mut().zip(column) {
        *y -= c * value;
    }
}

/// a·b in eight sums, so that the processor can work on several at once.
#[inline(always)]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    for (a, b) in a.iter().zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// The largest |v|, eight of them at a time; what is no number is passed over.
#[inline(always)]
pub fn largest(values: &[f64]) -> f64 {
    let mut most = [0.0f64; 8];
    let (chunks, rest) = values.as_chunks::<8>();
    for chunk in chunks {
        for (most, value) in most.iter_mut().zip(chunk) {
            *most = if value.abs() > *most { value.abs() } else { *most };
        }
    }
    most.iter().chain(rest).fold(0.0, |most, value| if value.abs() > most { value.abs() } else { most })
}

/// Apply the row exchanges in the order in which they were made; both count from row `first` of the front.
pub fn exchange(column: &mut [f64], exchanges: &[u32], first: usize) {
    for (j, &other) in exchanges.iter().enumerate() {
        column.swap(j, other as usize - first);
    }
}

/// c ← c − a b, or c ← −a b
pub fn subtract_product(c: MatMut<'_, f64>, accum: Accum, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    let (rows, columns) = (c.nrows(), c.ncols());
    if rows * columns * a.ncols() <= SMALL_PRODUCT {
        return matmul(c, accum, a, b, -1.0, Par::Seq);
    }
    if rows > columns {
        let (c1, c2) = c.split_at_row_mut(rows / 2);
        let (a1, a2) = a.split_at_row(rows / 2);
        rayon::join(|| subtract_product(c1, accum, a1, b), || subtract_product(c2, accum, a2, b));
    } else {
        let (c1, c2) = c.split_at_col_mut(columns / 2);
        let (b1, b2) = b.split_at_col(columns / 2);
        rayon::join(|| subtract_product(c1, accum, a, b1), || subtract_product(c2, accum, a, b2));
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
