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
//! number does not converge, as far as these meshes can tell, unless all differences are within what is asked of them: then there is
//! neither an order nor an error bar, and no failure either.
//!
//! The finest mesh with the increments of the level before, f₂₃, divides the last difference: |f₃ − f₂₃| is that of the increments,
//! |f₂₃ − f₂| that of the mesh.
//!
//! Source: P. J. Roache, J. Fluids Eng. 116 (1994) 405.

use std::path::Path;
use std::str::FromStr;

use serde::Serialize;

use crate::model::Model;
use crate::model::text::number;
use crate::output::report::table::Columns;
use crate::output::{history, probes};

/// A number of a run: a column of its history or of its probes, or one over another, in all rows or in those of a step, and what is taken of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Measure {
    /// COLUMN or COLUMN/COLUMN
    value: String,
    of: Of,
    /// name of the step; `None` for all
    step: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Of {
    Max,
    Min,
    End,
    Mean,
}

const FORM: &str = "give COLUMN:max, COLUMN:min, COLUMN:end or COLUMN:mean, where COLUMN is a column of history.csv or \
                    probes.csv or a ratio of two (COLUMN/COLUMN), and append @STEP for one step only";

impl FromStr for Measure {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let kind = |word: &str| match word {
            "max" => Some(Of::Max),
            "min" => Some(Of::Min),
            "end" => Some(Of::End),
            "mean" => Some(Of::Mean),
            _ => None,
        };
        // Names may have colons and signs of their own.
        let measure = text.rmatch_indices(':').find_map(|(colon, _)| {
            let (value, taken) = (&text[..colon], &text[colon + 1..]);
            let (word, step) =
                taken.split_once('@').map_or((taken, None), |(word, step)| (word, Some(step.to_owned())));
            Some(Self { value: value.into(), of: kind(word)?, step })
        });
        measure.ok_or_else(|| match text.rsplit_once(':') {
            Some((_, other)) => format!("`{other}` is not max, min, end or mean: {FORM}"),
            None => format!("`{text}` is not a measure: {FORM}"),
        })
    }
}

impl Measure {
    /// The column, and the one that it is divided by, among those of a history; names may have strokes of their own.
    fn columns(&self, is_column: impl Fn(&str) -> bool) -> Option<(&str, Option<&str>)> {
        let divided = |(stroke, _)| (&self.value[..stroke], Some(&self.value[stroke + 1..]));
        let whole = std::iter::once((self.value.as_str(), None));
        let mut readings = whole.chain(self.value.match_indices('/').map(divided));
        readings.find(|(column, over)| is_column(column) && over.is_none_or(&is_column))
    }

    /// Checks that the history or the probes of a model have the columns, and the model the step.
    ///
    /// # Errors
    /// Returns a message if not, or if a column is not of numbers.
    pub fn check(&self, model: &Model) -> Result<(), String> {
        let mut header = history::columns(model);
        header.extend(if model.requests.probes.is_empty() { Vec::new() } else { probes::columns(model) });
        let (column, over) = self
            .columns(|name| header.iter().any(|other| other == name))
            .ok_or_else(|| format!("the history has no column `{}`; there are {}", self.value, header.join(", ")))?;
        if column == "step" || over == Some("step") {
            return Err("the column `step` does not hold numbers".into());
        }
        let names: Vec<&str> = model.steps.iter().map(|step| step.name.as_str()).collect();
        match self.step.as_deref().filter(|step| !names.contains(step)) {
            Some(step) => Err(format!("the case has no step `{step}`; there are {}", names.join(", "))),
            None => Ok(()),
        }
    }

    /// Takes the number from the results in a folder; the mean is that over time.
    ///
    /// # Errors
    /// Returns a message if a table cannot be read, or there is no such column or no number there.
    pub fn of(&self, folder: &Path) -> Result<f64, String> {
        let path = folder.join("history.csv");
        let table = read(&path)?;
        let path_of_probes = folder.join("probes.csv");
        let probes = if path_of_probes.exists() { Some(read(&path_of_probes)?) } else { None };
        let error = |message: String| format!("{}: {message}", path.display());
        // Both tables have the same rows.
        let of_probes = |name: &str| probes.as_ref().filter(|probes| probes.rows() == table.rows())?.get(name).ok();
        let has = |name: &str| table.get(name).is_ok() || of_probes(name).is_some();
        let (column, over) = self.columns(has).unwrap_or((&self.value, None));
        if let Some(words) = [Some(column), over].into_iter().flatten().find(|name| table.words(name).is_some()) {
            return Err(error(format!("the column `{words}` does not hold numbers")));
        }
        let numbers = |name: &str| table.get(name).or_else(|fault| of_probes(name).ok_or(fault.to_string()));
        let (values, times, steps) = (numbers(column)?, numbers("time")?, numbers("step")?);
        let divisors = over.map(numbers).transpose()?;
        let names = table.words("step").unwrap_or_default();
        let is_asked = |row: &usize| self.step.as_ref().is_none_or(|step| names[steps[*row] as usize] == *step);
        let rows: Vec<usize> = (0..table.rows()).filter(is_asked).collect();
        let values: Vec<f64> =
            rows.iter().map(|&row| values[row] / divisors.map_or(1.0, |divisors| divisors[row])).collect();
        let value = match self.of {
            Of::Max => values.iter().copied().reduce(f64::max),
            Of::Min => values.iter().copied().reduce(f64::min),
            Of::End => values.last().copied(),
            Of::Mean => mean(&rows.iter().map(|&row| times[row]).collect::<Vec<_>>(), &values),
        };
        let value = value.filter(|value| value.is_finite());
        let place = self.step.as_ref().map_or(String::new(), |step| format!(" in the step `{step}`"));
        value.ok_or_else(|| error(format!("`{}` is not a number{place}", self.value)))
    }
}

fn read(path: &Path) -> Result<Columns, String> {
    let (table, fault) = Columns::read(path).map_err(|fault| fault.to_string())?;
    fault.map_or(Ok(table), |fault| Err(fault.to_string()))
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
    /// Whether they do not converge, but differ by less than asked
    pub settled: bool,
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

/// Differences, as fractions of the numbers, within which they count as settled where nothing else is asked.
pub const WITHIN: f64 = 1e-3;

/// Judges three or more numbers, the coarsest first; those that do not converge count as settled if their last differences are `within` this
/// fraction of the largest.
///
/// # Errors
/// Returns a message if there are fewer, or one is not finite.
pub fn judge(values: &[f64], within: f64) -> Result<Convergence, String> {
    let [.., first, second, last] = *values else {
        return Err(format!("there are {} numbers: an order of convergence needs {FEWEST} levels", values.len()));
    };
    if let Some(bad) = values.iter().find(|value| !value.is_finite()) {
        return Err(format!("{bad} is not a finite number"));
    }
    let judged = of_three([first, second, last]);
    let most = (second - first).abs().max((last - second).abs());
    let largest = [first, second, last].into_iter().map(f64::abs).fold(0.0, f64::max);
    let settled = judged.bar.is_none() && most <= within * largest;
    let changed = || format!("changed by less than {} %; no order can be measured", number(100.0 * within));
    let verdict = if settled { changed() } else { judged.verdict };
    Ok(Convergence { values: values.to_vec(), settled, verdict, ..judged })
}

/// Judges the last three numbers.
fn of_three(values: [f64; 3]) -> Convergence {
    let [first, second, last] = values;
    let [before, after] = [second - first, last - second];
    let judged = |order, extrapolated, bar, verdict: String| Convergence {
        values: values.to_vec(),
        order,
        extrapolated,
        bar,
        settled: false,
        verdict,
    };
    let least = ROUND_OFF * first.abs().max(last.abs());
    if before.abs().max(after.abs()) <= least {
        let verdict = "does not change with mesh and increments, apart from round-off".into();
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
        let verdict =
            "converges, with differences of alternating sign; the error bar follows from the differences".into();
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
            format!("converges; the order of {order:.2} is accidental, and the error bar follows from the differences");
        return judged(Some(order), Some(last + correction), Some(by_difference), verdict);
    }
    let smooth = order > 1.0 - WHOLE && (order - order.round()).abs() < WHOLE;
    let bar = SAFETY[usize::from(!smooth)] * correction.abs();
    judged(Some(order), Some(last + correction), Some(bar), format!("converges with the order {order:.2}"))
}
