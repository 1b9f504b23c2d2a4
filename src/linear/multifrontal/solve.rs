//! Forward and backward substitution, front by front.

use super::dense::exchange;
use super::factor::Factors;
use super::symbolic::{Front, Symbolic};

/// x ← (L U)⁻¹ x in the order of elimination. `work` is a scratch of the largest front's size.
pub fn substitute(symbolic: &Symbolic, factors: &Factors, x: &mut [f64], work: &mut Vec<f64>) {
    for front in &symbolic.fronts {
        work.clear();
        work.resize(front.size(), 0.0);
        forward(front, factors, x, work);
    }
    for front in symbolic.fronts.iter().rev() {
        work.clear();
        work.extend(front.rows.iter().flat_map(|&row| [x[2 * row as usize], x[2 * row as usize + 1]]));
        backward(front, factors, x, work);
    }
}

/// y = L₁₁⁻¹ P x₁, x₂ ← x₂ − L₂₁ y
fn forward(front: &Front, factors: &Factors, x: &mut [f64], y: &mut [f64]) {
    let pivots = front.first..front.first + front.pivots;
    let own = &mut y[..front.pivots];
    own.copy_from_slice(&x[pivots.clone()]);
    exchange(own, &factors.exchanges[pivots.clone()]);
    let lower = &factors.values[front.values.clone()][..front.size() * front.pivots];
    for (j, column) in lower.chunks_exact(front.size()).enumerate() {
        let (done, rest) = y.split_at_mut(j + 1);
        subtract(rest, &column[j + 1..], done[j]);
    }
    x[pivots].copy_from_slice(&y[..front.pivots]);
    for (pair, &row) in y[front.pivots..].chunks_exact(2).zip(&front.rows) {
        x[2 * row as usize] += pair[0];
        x[2 * row as usize + 1] += pair[1];
    }
}

/// x₁ ← U₁₁⁻¹ (y − U₁₂ x₂)
fn backward(front: &Front, factors: &Factors, x: &mut [f64], below: &[f64]) {
    let own = &mut x[front.first..front.first + front.pivots];
    let (lower, upper) = factors.values[front.values.clone()].split_at(front.size() * front.pivots);
    for (column, &value) in upper.chunks_exact(front.pivots).zip(below) {
        subtract(own, column, value);
    }
    for (j, column) in lower.chunks_exact(front.size()).enumerate().rev() {
        own[j] /= column[j];
        let (rest, done) = own.split_at_mut(j);
        subtract(rest, &column[..j], done[0]);
    }
}

/// y ← y − c v
fn subtract(y: &mut [f64], column: &[f64], value: f64) {
    for (y, c) in y.iter_mut().zip(column) {
        *y -= c * value;
    }
}
