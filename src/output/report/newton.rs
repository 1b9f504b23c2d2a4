//! Convergence from `newton.csv`: solves and residuals by increment, and the rejected attempts.

use std::cmp::Reverse;
use std::ops::Range;

use serde_json::{Value, json};

use super::source::ReportError;
use super::table::Columns;

/// Increments whose residuals are drawn, those with the most linear solves.
pub const HARDEST: usize = 100;

/// Rows of `newton.csv` that belong to each increment, including failed attempts.
///
/// # Errors
/// Returns [`ReportError::Unreadable`] if a column is missing.
pub fn increments(newton: &Columns) -> Result<Vec<Range<usize>>, ReportError> {
    let numbers = newton.get("increment")?;
    let mut start = 0;
    let rows = numbers.chunk_by(|a, b| a == b).map(|rows| {
        start += rows.len();
        start - rows.len()..start
    });
    Ok(rows.collect())
}

/// Number of linear solves of an increment, with the time at its end; the row of an attempt rejected before its first solve
/// does not count.
///
/// # Errors
/// Returns [`ReportError::Unreadable`] if a column is missing.
pub fn solves(newton: &Columns, increment: &Range<usize>) -> Result<[f64; 2], ReportError> {
    let iterations = &newton.get("iteration")?[increment.clone()];
    Ok([newton.get("time")?[increment.end - 1], iterations.iter().filter(|iteration| **iteration > 0.0).count() as f64])
}

/// Residual over iteration in the hardest increments, attempts in sequence with gaps between them.
///
/// # Errors
/// Returns [`ReportError::Unreadable`] if a column is missing.
pub fn residuals(newton: &Columns, increments: &[Range<usize>]) -> Result<Vec<[f64; 2]>, ReportError> {
    let (iterations, values) = (newton.get("iteration")?, newton.get("residual")?);
    let mut hardest: Vec<&Range<usize>> = increments.iter().collect();
    hardest.sort_by_key(|rows| Reverse(rows.len()));
    let mut curve = Vec::new();
    let solved = |row: &usize| iterations[*row] > 0.0;
    for row in hardest.into_iter().take(HARDEST).cloned().flatten().filter(solved) {
        if iterations[row] == 1.0 {
            curve.push([f64::NAN; 2]);
        }
        curve.push([iterations[row], values[row]]);
    }
    Ok(curve)
}

/// Upper bound of the number of rejected attempts shown.
const MOST: usize = 500;

/// Summary of the rows of one attempt.
struct Attempt {
    rows: Range<usize>,
    /// whether another attempt at the same increment followed
    given_up: bool,
}

/// Required columns of the table; `None` where they are missing.
struct Table<'a> {
    step: Words<'a>,
    increment: &'a [f64],
    attempt: &'a [f64],
    time: &'a [f64],
    iteration: &'a [f64],
    residual: &'a [f64],
    counts: [&'a [f64]; 3],
    verdict: Option<Words<'a>>,
    reason: Option<Words<'a>>,
}

impl<'a> Table<'a> {
    fn of(newton: &'a Columns) -> Option<Self> {
        let get = |name| newton.get(name).ok();
        let words = |name| Some(Words { numbers: get(name)?, words: newton.words(name)? });
        Some(Self {
            step: words("step")?,
            increment: get("increment")?,
            attempt: get("attempt")?,
            time: get("time")?,
            iteration: get("iteration")?,
            residual: get("residual")?,
            counts: [get("open")?, get("stick")?, get("slip")?],
            verdict: words("verdict"),
            reason: words("reason"),
        })
    }

    fn attempts(&self) -> Vec<Attempt> {
        let mut attempts: Vec<Attempt> = Vec::new();
        for row in 0..self.increment.len() {
            let before = row.checked_sub(1);
            let same = |of: &[f64]| before.is_some_and(|before| of[before] == of[row]);
            match attempts.last_mut() {
                Some(last) if same(self.increment) && same(self.attempt) => last.rows.end = row + 1,
                last => {
                    if let Some(last) = last.filter(|_| same(self.increment)) {
                        last.given_up = true;
                    }
                    attempts.push(Attempt { rows: row..row + 1, given_up: false });
                }
            }
        }
        for attempt in &mut attempts {
            attempt.given_up = self.verdict(&attempt.rows).map_or(attempt.given_up, |verdict| verdict != "accepted");
        }
        attempts
    }

    /// Outcome of an attempt, if the table contains it.
    fn verdict(&self, rows: &Range<usize>) -> Option<&str> {
        self.verdict?.at(rows.end - 1)
    }

    /// Reason of a rejected attempt according to the table.
    fn why(&self, rows: &Range<usize>) -> &str {
        let reason = self.reason.and_then(|reason| reason.at(rows.end - 1)).filter(|reason| !reason.is_empty());
        reason.or_else(|| self.verdict(rows)).unwrap_or("not solved")
    }
}

/// A column of words.
#[derive(Clone, Copy)]
struct Words<'a> {
    /// Number of each row's word
    numbers: &'a [f64],
    words: &'a [String],
}

impl<'a> Words<'a> {
    /// Word of a row.
    fn at(self, row: usize) -> Option<&'a str> {
        self.words.get(self.numbers[row] as usize).map(String::as_str)
    }
}

/// Every increment with its solves, and every rejected attempt with its reason as far as known.
pub fn attempts(newton: &Columns, complete: bool) -> Value {
    let Some(table) = Table::of(newton) else { return Value::Null };
    let mut attempts = table.attempts();
    // A stopped run ended in its last attempt, unless the table states otherwise.
    if !complete && let Some(last) = attempts.last_mut() {
        last.given_up |= table.verdict(&last.rows).is_none();
    }
    let mut start = 0.0;
    let (mut given_up, mut total) = (Vec::new(), 0);
    for Attempt { rows, given_up: dropped } in &attempts {
        let last = rows.end - 1;
        let time = table.time[last];
        if !dropped {
            start = time;
            continue;
        }
        total += 1;
        if given_up.len() < MOST {
            given_up.push(json!({
                "time": start,
                "dt": time - start,
                "step": table.step.at(last),
                "increment": table.increment[last],
                "attempt": table.attempt[last],
                "iterations": table.iteration[last],
                "residual": table.residual[last],
                "counts": table.counts.map(|counts| counts[last]),
                "why": table.why(rows),
            }));
        }
    }
    json!({ "given_up": given_up, "total": total })
}
