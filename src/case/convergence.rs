//! How sure a number of a run is: what runs on meshes and with increments that are refined alike make of it.
//!
//! ```text
//! f₁, f₂, f₃                          the number with h, h/2, h/4                  d₁ = f₂ − f₁,  d₂ = f₃ − f₂
//! 2^p = d₁/d₂                        observed order p                                                           (1)
//! f = f₃ + δ,  δ = d₂/(2^p − 1)      extrapolated value (Richardson)                                              (2)
//! |f₃ − f| < F |δ|                   error bar of f₃ (grid convergence index)                                     (3)
//! ```
//! F is 1.25 where p is within 0.2 of a whole number from 1 to 4, as it is where the solution is smooth and the mesh fine enough, otherwise 3.
//! Where p is above 4.5 the last difference is small by chance, and where differences alternate there is no p: the error bar is three
//! times the last difference, and not less than a quarter of the one before. Where the last difference is not the smaller one, or p is below ½, the
//! number does not converge, as far as these meshes can tell.
//!
//! The finest mesh with the increments of the level before, f₂₃, divides the last difference: |f₃ − f₂₃| is that of the increments,
//! |f₂₃ − f₂| that of the mesh.
//!
//! Source: P. J. Roache, J. Fluids Eng. 116 (1994) 405.

use std::path::Path;
use std::str::FromStr;

use serde::Serialize;

use crate::model::Model;
use crate::output::history;
use crate::output::report::table::Columns;

/// A number of a run: a column of its history, and what is taken of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Measure {
    column: String,
    of: Of,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Of {
    Max,
    Min,
    End,
    Mean,
}

impl FromStr for Measure {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let form = "give COLUMN:max, COLUMN:min, COLUMN:end or COLUMN:mean, with a column of history.csv";
        let (column, of) = text.rsplit_once(':').ok_or_else(|| format!("`{text}` is no measure: {form}"))?;
        let of = match of {
            "max" => Of::Max,
            "min" => Of::Min,
            "end" => Of::End,
            "mean" => Of::Mean,
            other => return Err(format!("`{other}` is nothing that is taken of a column: {form}")),
        };
        Ok(Self { column: column.into(), of })
    }
}

impl Measure {
    /// Checks that the history of a model has the column.
    ///
    /// # Errors
    /// Returns a message if it has not, or the column is not of numbers.
    pub fn check(&self, model: &Model) -> Result<(), String> {
        let header = history::columns(model);
        match header.contains(&self.column) {
            _ if self.column == "step" => Err("the column `step` is not of numbers".into()),
            true => Ok(()),
            false => Err(format!("the history has no column `{}`; there are {}", self.column, header.join(", "))),
        }
    }

    /// Takes the number from the results in a folder; the mean is that over time.
    ///
    /// # Errors
    /// Returns a message if the history cannot be read, or has no such column or no number there.
    pub fn of(&self, folder: &Path) -> Result<f64, String> {
        let path = folder.join("history.csv");
        let (table, fault) = Columns::read(&path).map_err(|fault| fault.to_string())?;
        if let Some(fault) = fault {
            return Err(fault.to_string());
        }
        let told = |message: String| format!("{}: {message}", path.display());
        if table.words(&self.column).is_some() {
            return Err(told(format!("the column `{}` is not of numbers", self.column)));
        }
        let column = |name: &str| table.get(name).map_err(|fault| fault.to_string());
        let (values, times) = (column(&self.column)?, column("time")?);
        let value = match self.of {
            Of::Max => values.iter().copied().reduce(f64::max),
            Of::Min => values.iter().copied().reduce(f64::min),
            Of::End => values.last().copied(),
            Of::Mean => mean(times, values),
        };
        let value = value.filter(|value| value.is_finite());
        value.ok_or_else(|| told(format!("the column `{}` has no such number", self.column)))
    }
}

/// Mean over time from the first to the last row, linear between them.
fn mean(times: &[f64], values: &[f64]) -> Option<f64> {
    let span = times.last()? - times.first()?;
    if span == 0.0 {
        return values.last().copied();
    }
    let areas = times.windows(2).zip(values.windows(2)).map(|(t, v)| 0.5 * (t[1] - t[0]) * (v[0] + v[1]));
    Some(areas.sum::<f64>() / span)
}

/// Fewest runs that tell an order.
pub const FEWEST: usize = 3;

/// What numbers of runs that are refined alike say; the last three count.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Convergence {
    /// Numbers, the coarsest first
    pub values: Vec<f64>,
    /// p; `None` if the differences alternate or are round-off
    pub order: Option<f64>,
    /// Extrapolated value; `None` if they do not converge
    pub extrapolated: Option<f64>,
    /// Error bar of the last number; `None` if they do not converge
    pub bar: Option<f64>,
    /// In words
    pub verdict: String,
}

/// What the increments have to do with the last difference, a fraction of it: `longer` is the number of the finest mesh with the increments
/// of the level before. `None` if nothing differs.
pub fn fraction_of_increments(values: &[f64], longer: f64) -> Option<f64> {
    let [.., before, last] = *values else { return None };
    let [by_mesh, by_increments] = [longer - before, last - longer].map(f64::abs);
    Some(by_increments / (by_mesh + by_increments)).filter(|fraction| fraction.is_finite())
}

/// Difference of numbers that is round-off and the tolerance of Newton's method, relative to them.
const ROUND_OFF: f64 = 1e-8;

/// Orders at which (3) holds.
const PLAUSIBLE: [f64; 2] = [0.5, 4.5];

/// Largest distance of an order from a whole number at which it counts as that of a smooth solution.
const WHOLE: f64 = 0.2;

/// F: safety factors where the order is that of a smooth solution, and where it is not.
const SAFETY: [f64; 2] = [1.25, 3.0];

/// Least fraction of the difference before the last that an error bar without an order is.
const LEAST: f64 = 0.25;

/// Judges three or more numbers, the coarsest first.
///
/// # Errors
/// Returns a message if there are fewer, or one is not finite.
pub fn judge(values: &[f64]) -> Result<Convergence, String> {
    let [.., first, second, last] = *values else {
        return Err(format!("there are {} numbers: an order takes {FEWEST} levels", values.len()));
    };
    if let Some(bad) = values.iter().find(|value| !value.is_finite()) {
        return Err(format!("{bad} is no number that can converge"));
    }
    let [before, after] = [second - first, last - second];
    let judged = |order, extrapolated, bar, verdict: String| {
        Ok(Convergence { values: values.to_vec(), order, extrapolated, bar, verdict })
    };
    let least = ROUND_OFF * first.abs().max(last.abs());
    if before.abs().max(after.abs()) <= least {
        let verdict = "does not change with mesh and increments, but for round-off".into();
        return judged(None, Some(last), Some(least), verdict);
    }
    if after.abs() >= before.abs() {
        let verdict = format!(
            "does not converge: the last refinement changes it by {after:.3e}, the one before by {before:.3e}; refine further, or ask \
             for a number without a singularity"
        );
        return judged(None, None, None, verdict);
    }
    let by_difference = (SAFETY[1] * after.abs()).max(LEAST * before.abs());
    if before * after <= 0.0 {
        let verdict = "converges, to and fro; the bar follows from the differences".into();
        return judged(None, Some(last), Some(by_difference), verdict);
    }
    let order = (before / after).log2();
    if order < PLAUSIBLE[0] {
        let verdict = format!(
            "does not converge: its order is {order:.2}, and the differences hardly get smaller; refine further"
        );
        return judged(Some(order), None, None, verdict);
    }
    let correction = after / (before / after - 1.0);
    if order > PLAUSIBLE[1] {
        let verdict =
            format!("converges; the order of {order:.2} is by chance, and the bar follows from the differences");
        return judged(Some(order), Some(last + correction), Some(by_difference), verdict);
    }
    let smooth = order > 1.0 - WHOLE && (order - order.round()).abs() < WHOLE;
    let bar = SAFETY[usize::from(!smooth)] * correction.abs();
    judged(Some(order), Some(last + correction), Some(bar), format!("converges with the order {order:.2}"))
}
