//! Rows of `newton.csv` by increment.

use std::ops::Range;

use super::error::PlotError;
use super::read::Columns;

/// Increments whose residuals are drawn, those with the most linear solves.
pub const HARDEST: usize = 100;

/// Rows of `newton.csv` that belong to each increment, failed attempts included.
///
/// # Errors
/// [`PlotError::Unreadable`] when a column is missing.
pub fn increments(newton: &Columns) -> Result<Vec<Range<usize>>, PlotError> {
    let numbers = newton.get("increment")?;
    let mut start = 0;
    let rows = numbers.chunk_by(|a, b| a == b).map(|rows| {
        start += rows.len();
        start - rows.len()..start
    });
    Ok(rows.collect())
}

/// Linear solves of an increment over the time at its end: an attempt given up before its first solve has a row without one.
///
/// # Errors
/// [`PlotError::Unreadable`] when a column is missing.
pub fn solves(newton: &Columns, increment: &Range<usize>) -> Result<[f64; 2], PlotError> {
    let iterations = &newton.get("iteration")?[increment.clone()];
    Ok([newton.get("time")?[increment.end - 1], iterations.iter().filter(|iteration| **iteration > 0.0).count() as f64])
}

/// Residual over iteration in the hardest increments, one attempt after the other, broken between them.
///
/// # Errors
/// [`PlotError::Unreadable`] when a column is missing.
pub fn residuals(newton: &Columns, increments: &[Range<usize>]) -> Result<Vec<[f64; 2]>, PlotError> {
    let (points, iterations) = (newton.points("iteration", "residual")?, newton.get("iteration")?);
    let mut hardest: Vec<&Range<usize>> = increments.iter().collect();
    hardest.sort_by_key(|rows| std::cmp::Reverse(rows.len()));
    let mut curve = Vec::new();
    let solved = |row: &usize| iterations[*row] > 0.0;
    for row in hardest.into_iter().take(HARDEST).cloned().flatten().filter(solved) {
        if iterations[row] == 1.0 {
            curve.push([f64::NAN; 2]);
        }
        curve.push(points[row]);
    }
    Ok(curve)
}
