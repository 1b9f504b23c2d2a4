//! Row and column scaling by powers of two, which is free of rounding.

use super::super::SparseMatrix;

/// R A C, with the largest value of each row and column of the order of 1.
///
/// The row of a prescribed displacement has its own scale, and a penalty is far stiffer than a solid. Without scaling
/// neither the choice of a pivot among rows nor the size of a vanished one would mean anything.
#[derive(Default)]
pub struct Scaling {
    pub rows: Vec<f64>,
    pub columns: Vec<f64>,
    /// Values of R A C
    pub values: Vec<f64>,
}

impl Scaling {
    pub fn compute(&mut self, matrix: &SparseMatrix) {
        let n = matrix.size();
        self.values.clone_from(&matrix.values);
        self.rows.clear();
        self.rows.resize(n, 0.0);
        for_columns(matrix, &mut self.values, |_, row, values| {
            self.rows[row] = values[0].abs().max(self.rows[row]);
            self.rows[row + 1] = values[1].abs().max(self.rows[row + 1]);
        });
        self.rows.iter_mut().for_each(|size| *size = inverse_power_of_two(*size));
        self.columns.clear();
        self.columns.resize(n, 0.0);
        for_columns(matrix, &mut self.values, |column, row, values| {
            values[0] *= self.rows[row];
            values[1] *= self.rows[row + 1];
            self.columns[column] = values[0].abs().max(values[1].abs()).max(self.columns[column]);
        });
        self.columns.iter_mut().for_each(|size| *size = inverse_power_of_two(*size));
        for_columns(matrix, &mut self.values, |column, _, values| {
            values[0] *= self.columns[column];
            values[1] *= self.columns[column];
        });
    }
}

/// Visit each pair of values of a node in a column: column, first row of the pair, the pair.
fn for_columns(matrix: &SparseMatrix, values: &mut [f64], mut visit: impl FnMut(usize, usize, &mut [f64])) {
    let mut pairs = values.chunks_exact_mut(2);
    for node in 0..matrix.pattern.nodes() {
        for column in 2 * node..2 * node + 2 {
            for (&row, pair) in matrix.pattern.neighbours(node).iter().zip(&mut pairs) {
                visit(column, 2 * row, pair);
            }
        }
    }
}

/// The power of two that brings `size` into [1, 2); 1 for zero and for what is not finite.
fn inverse_power_of_two(size: f64) -> f64 {
    if size == 0.0 || !size.is_finite() {
        return 1.0;
    }
    let exponent = (size.to_bits() >> 52).min(2045);
    f64::from_bits((2046 - exponent) << 52)
}
