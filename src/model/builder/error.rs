//! Errors of a model, with their place.
//!
//! Numbers are checked for their range.
//!
//! Names are checked for use in the header and rows of CSV files, and for uniqueness.

use std::collections::BTreeSet;

use thiserror::Error;

use super::Builder;
use crate::laws::parameter::InvalidParameter;
use crate::mesh::names::is_unwritable;
use crate::model::text::readable;

/// An error in the input of a model.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{}{message}", if place.is_empty() { String::new() } else { format!("{place}: ") })]
#[non_exhaustive]
pub struct ModelError {
    /// Place, in the terms of the case file: `bodies.block.material`, `steps[0].supports[1].ux`
    pub place: String,
    /// Error and remedy
    pub message: String,
}

/// A checked input.
pub type Checked<T> = Result<T, ModelError>;

impl ModelError {
    /// Creates an error at a place.
    pub fn new(place: impl Into<String>, message: impl ToString) -> Self {
        Self { place: place.into(), message: readable(&message.to_string()) }
    }
}

/// Refuses the input at a place if it fails a check.
pub fn refuse_if(fails: bool, place: impl Into<String>, message: impl ToString) -> Checked<()> {
    if fails { Err(ModelError::new(place, message)) } else { Ok(()) }
}

/// Parameter of a law; its place is completed by the owner of the law.
impl From<InvalidParameter> for ModelError {
    fn from(error: InvalidParameter) -> Self {
        Self::new("", error)
    }
}

/// Range of stiffnesses that can be squared in double precision.
const STIFFNESSES: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

/// Checks that a stiffness, mass or area can be squared.
pub fn check_size(place: &str, name: &str, value: f64) -> Checked<()> {
    let (low, high) = (STIFFNESSES.start(), STIFFNESSES.end());
    let message = format!("{name} is {value:.6e}: it must lie between {low:e} and {high:e}; choose other units");
    refuse_if(!STIFFNESSES.contains(&value), place, message)
}

/// Checks that a number is positive; `hint` is added to the message.
pub fn check_positive(place: &str, value: f64, hint: &str) -> Checked<()> {
    let fails = !(value > 0.0 && value.is_finite());
    refuse_if(fails, place, format_args!("is {value}: must be positive{hint}"))
}

/// Checks that a number is zero or positive.
pub fn check_not_negative(place: &str, value: f64) -> Checked<()> {
    let fails = !(value >= 0.0 && value.is_finite());
    refuse_if(fails, place, format_args!("is {value}: must be zero or positive"))
}

/// Checks that numbers are finite.
pub fn check_finite(place: &str, values: impl IntoIterator<Item = f64>) -> Checked<()> {
    let mut values = values.into_iter();
    values
        .try_for_each(|value| refuse_if(!value.is_finite(), place, format_args!("is {value}: must be a finite number")))
}

/// Largest coordinate; squares of lengths up to it are finite [L].
const FARTHEST: f64 = 1e100;

/// Checks that coordinates and lengths can be squared.
pub fn check_place(place: &str, values: impl IntoIterator<Item = f64>) -> Checked<()> {
    let message = |value: f64| {
        format!("is {value:e}: places must lie between -{FARTHEST:e} and {FARTHEST:e}; choose other units")
    };
    let mut values = values.into_iter();
    values.try_for_each(|value| refuse_if(value.is_nan() || value.abs() > FARTHEST, place, message(value)))
}

/// Maximum length of a name [bytes]; combined with a quantity, it is a column of a table and the name of a file.
const LONGEST: usize = 100;

/// Number of characters shown of a longer one.
const SHOWN: usize = 20;

/// Characters that would split a row, in addition to line breaks and other control characters.
const BREAKING: [char; 2] = [',', '"'];

impl Builder {
    /// Checks that names are unique and can be used in results.
    pub(super) fn check_names(&self) -> Checked<()> {
        for (k, step) in self.steps.iter().enumerate() {
            check_name(&format!("steps[{k}].name"), &step.name)?;
        }
        let contacts = self.contacts.iter().map(|contact| &contact.name).collect();
        let kinds: [(&str, Vec<&String>); 4] = [
            ("contacts", contacts),
            ("bodies", self.bodies.iter().map(|(name, _)| name).collect()),
            ("rigid_bodies", self.rigid_bodies.iter().map(|(name, _)| name).collect()),
            ("bars", self.bars.iter().map(|(name, _)| name).collect()),
        ];
        for (of, names) in &kinds {
            names.iter().try_for_each(|name| check_name(of, name))?;
        }
        check_line("title", &self.title)?;
        for (of, names) in kinds {
            check_once(of, names.into_iter())?;
        }
        check_once("point_masses", self.point_masses.iter().map(|(name, _)| name))?;
        let Some(name) = &self.unknown else { return Ok(()) };
        Err(no_body(name, self.bodies.iter().map(|(name, _)| name.as_str()), &format!("bodies.{name}")))
    }
}

/// Checks that a name can be used in a CSV file.
pub fn check_name(place: &str, name: &str) -> Checked<()> {
    refuse_if(name.trim().is_empty(), place, format_args!("the name {name:?} is empty: results are found by it"))?;
    let start: String = name.chars().take(SHOWN).collect();
    let message = format!(
        "the name {start:?}… is {} bytes long: results are filed under it; take at most {LONGEST} (letters beyond ASCII \
         count for 2 to 4)",
        name.len()
    );
    refuse_if(name.len() > LONGEST, place, message)?;
    let message =
        |c| format!("the name {name:?} has {c:?} in it, which would break the rows of history.csv: rename it");
    let breaking = name.chars().find(|c| is_unwritable(*c) || BREAKING.contains(c));
    breaking.map_or(Ok(()), |c| Err(ModelError::new(place, message(c))))
}

/// Checks that a title or unit label is one line of text, as used in figures, pages and stores.
pub fn check_line(place: &str, text: &str) -> Checked<()> {
    let message = |c| format!("{text:?} has {c:?} in it: give a line of text, without it");
    text.chars().find(|c| is_unwritable(*c)).map_or(Ok(()), |c| Err(ModelError::new(place, message(c))))
}

/// Error for an unknown body.
pub fn no_body<'n>(name: &str, known: impl Iterator<Item = &'n str>, place: &str) -> ModelError {
    let known: Vec<&str> = known.collect();
    ModelError::new(place, format!("there is no body `{name}`; the bodies are {}", known.join(", ")))
}

/// Checks that no item of one kind is given twice.
pub fn check_once<'n>(of: &str, mut names: impl Iterator<Item = &'n String>) -> Checked<()> {
    let mut seen = BTreeSet::new();
    let message = "is given twice: keep one, or rename one";
    names.try_for_each(|name| refuse_if(!seen.insert(name), format!("{of}.{name}"), message))
}
