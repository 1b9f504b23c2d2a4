//! Row and column scaling by powers of two, which is free of rounding.

use pulp::Arch;

use super::super::SparseMatrix;
use super::dense::largest;

/// R A C, with the largest value of each row and column of the order of 1.
///
/// ```text
/// R_i = 1/maxⱼ |A_ij|,   C_j = 1/maxᵢ |R_i A_ij|
/// R_i = C_i = (maxⱼ |A_ij|)^-½                      where the pattern says that values are symmetric, between some nodes or all
/// ```
///
/// The row of a prescribed displacement has its own scale, and a penalty is far stiffer than a solid. Without scaling
/// neither the choice of a pivot among rows nor the size of a vanished one would mean anything. A constrained dof has the scale 0: its equation is
/// solved by itself.
///
/// The rows of a point that begins to slip get other scales, and with them fronts change that would stay otherwise.
/// They are few: where a soft block slides on a linear ground, 2 to 7 % more than those whose values have changed (664
/// to 676 instead of 651 of 2814 fronts, 1796 to 1950 instead of 1743 to 1826 of 11 000, with penalties of 10 to 1000
/// E/L). Scales from what is constant alone would save them, but not bring a stiff penalty to 1, and a zero pivot could
/// not be distinguished from its round-off.
#[derive(Default)]
pub struct Scaling {
    pub rows: Vec<f64>,
    pub columns: Vec<f64>,
}

impl Scaling {
    /// Scales of a matrix as the fronts of its pattern need them, 0 for what is constrained.
    pub fn compute(&mut self, matrix: &SparseMatrix) {
        if matrix.pattern.is_all_unsymmetric() {
            self.compute_two_sided(matrix);
        } else {
            self.clear(matrix.size());
            Arch::new().dispatch(|| symmetric(matrix, &mut self.rows));
            self.columns.copy_from_slice(&self.rows);
        }
        for dof in (0..matrix.size()).filter(|&dof| matrix.constrained[dof]) {
            (self.rows[dof], self.columns[dof]) = (0.0, 0.0);
        }
    }

    /// Scales of a matrix as one without any symmetry, all equations being solved together.
    pub fn compute_two_sided(&mut self, matrix: &SparseMatrix) {
        self.clear(matrix.size());
        Arch::new().dispatch(|| two_sided(matrix, &mut self.rows, &mut self.columns));
    }

    fn clear(&mut self, size: usize) {
        for scales in [&mut self.rows, &mut self.columns] {
            scales.clear();
            scales.resize(size, 0.0);
        }
    }
}

#[inline(always)]
fn symmetric(matrix: &SparseMatrix, scales: &mut [f64]) {
    let unsymmetric = matrix.pattern.unsymmetric();
    each_column(matrix, |column, nodes, values| {
        if matrix.constrained[column] {
            return;
        }
        scales[column] = largest(values).max(scales[column]);
        // A row is like its column but between nodes with unsymmetric values.
        if unsymmetric[column / 2] {
            let rows = nodes.iter().zip(values.as_chunks::<2>().0).filter(|(row, _)| unsymmetric[**row]);
            rows.for_each(|(&row, pair)| (0..2).for_each(|i| grow(&mut scales[2 * row + i], pair[i])));
        }
    });
    scales.iter_mut().for_each(|size| *size = inverse_root_of_two(*size));
}

#[inline(always)]
fn two_sided(matrix: &SparseMatrix, rows: &mut [f64], columns: &mut [f64]) {
    each_column(matrix, |_, nodes, values| {
        for (&row, pair) in nodes.iter().zip(values.as_chunks::<2>().0) {
            (0..2).for_each(|i| grow(&mut rows[2 * row + i], pair[i]));
        }
    });
    rows.iter_mut().for_each(|size| *size = inverse_power_of_two(*size));
    each_column(matrix, |column, nodes, values| {
        let mut most = [0.0; 2];
        for (&row, pair) in nodes.iter().zip(values.as_chunks::<2>().0) {
            (0..2).for_each(|i| grow(&mut most[i], pair[i] * rows[2 * row + i]));
        }
        columns[column] = inverse_power_of_two(most[0].max(most[1]));
    });
}

#[inline(always)]
fn grow(most: &mut f64, value: f64) {
    *most = value.abs().max(*most);
}

/// Visit the columns of unknowns with the nodes of their rows and their values.
#[inline(always)]
fn each_column(matrix: &SparseMatrix, mut visit: impl FnMut(usize, &[usize], &[f64])) {
    let mut rest = &matrix.values[..];
    for node in 0..matrix.pattern.nodes() {
        let rows = matrix.pattern.neighbours(node);
        let columns = rest.split_off(..4 * rows.len()).unwrap_or_default().chunks_exact(2 * rows.len());
        columns
            .take(matrix.pattern.unknowns(node))
            .enumerate()
            .for_each(|(j, values)| visit(2 * node + j, rows, values));
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

/// The power of two whose square brings `size` into [1, 4); 1 for zero and for what is not finite.
fn inverse_root_of_two(size: f64) -> f64 {
    if size == 0.0 || !size.is_finite() {
        return 1.0;
    }
    let exponent = (size.to_bits() >> 52) as i64 - 1023;
    f64::from_bits(((1023 - exponent.div_euclid(2)) as u64) << 52)
}
