//! What is wrong with a model, and where.
//!
//! Numbers that may be computed with.
//!
//! Names that go into the header and the rows of a CSV file, and names that may stand once only.

use std::collections::BTreeSet;

use thiserror::Error;

use super::Builder;
use crate::laws::parameter::InvalidParameter;
use crate::mesh::names::is_unwritable;

/// Something in a model that cannot be solved as it is given.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{}{message}", if place.is_empty() { String::new() } else { format!("{place}: ") })]
#[non_exhaustive]
pub struct ModelError {
    /// Path of what is meant, in the words of the case file: `bodies.block.material`, `steps[0].supports[1].ux`
    pub place: String,
    /// What is wrong, and what to do
    pub message: String,
}

/// What is given, once it is found to be good.
pub type Checked<T> = Result<T, ModelError>;

impl ModelError {
    /// An error at a place.
    pub fn new(place: impl Into<String>, message: impl ToString) -> Self {
        Self { place: place.into(), message: message.to_string() }
    }
}

/// A parameter of a law, whose place is added by what has the law.
impl From<InvalidParameter> for ModelError {
    fn from(error: InvalidParameter) -> Self {
        Self::new("", error)
    }
}

/// Stiffnesses outside this range cannot be squared in double precision.
const STIFFNESSES: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

/// A stiffness, mass or area must be of a size that can be squared.
pub fn check_size(place: &str, name: &str, value: f64) -> Checked<()> {
    if STIFFNESSES.contains(&value) {
        return Ok(());
    }
    let (low, high) = (STIFFNESSES.start(), STIFFNESSES.end());
    let message = format!("{name} is {value:.6e}: it must lie between {low:e} and {high:e}; choose other units");
    Err(ModelError::new(place, message))
}

/// A number that must be positive, with what else is to be said of it.
pub fn check_positive(place: &str, value: f64, besides: &str) -> Checked<()> {
    match value > 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(ModelError::new(place, format!("is {value}: must be positive{besides}"))),
    }
}

/// A number that must be zero or positive.
pub fn check_not_negative(place: &str, value: f64) -> Checked<()> {
    match value >= 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(ModelError::new(place, format!("is {value}: must be zero or positive"))),
    }
}

/// Numbers that must be finite.
pub fn check_finite(place: &str, values: impl IntoIterator<Item = f64>) -> Checked<()> {
    match values.into_iter().find(|value| !value.is_finite()) {
        Some(value) => Err(ModelError::new(place, format!("is {value}: must be a finite number"))),
        None => Ok(()),
    }
}

/// Longest name [bytes]: with that of a quantity behind it, it is a column of a table and the name of a file.
const LONGEST: usize = 100;

/// Letters of a longer one that are shown.
const SHOWN: usize = 20;

/// Characters that would break a row apart, besides line breaks and other control characters.
const BREAKING: [char; 2] = [',', '"'];

impl Builder {
    /// Names must survive in results, and stand once.
    pub(super) fn check_names(&self) -> Checked<()> {
        for (k, step) in self.steps.iter().enumerate() {
            check_name(&format!("steps[{k}].name"), &step.name)?;
        }
        for contact in &self.contacts {
            check_name("contacts", &contact.name)?;
        }
        for (body, _) in &self.bodies {
            check_name("bodies", body)?;
        }
        for (body, _) in &self.rigid_bodies {
            check_name("rigid_bodies", body)?;
        }
        check_line("title", &self.title)?;
        check_once("contacts", self.contacts.iter().map(|contact| &contact.name))?;
        check_once("bodies", self.bodies.iter().map(|(name, _)| name))?;
        check_once("rigid_bodies", self.rigid_bodies.iter().map(|(name, _)| name))?;
        check_once("point_masses", self.point_masses.iter().map(|(name, _)| name))?;
        let Some(name) = &self.unknown else { return Ok(()) };
        Err(no_body(name, self.bodies.iter().map(|(name, _)| name.as_str()), &format!("bodies.{name}")))
    }
}

/// A name by which results are found must survive in a CSV file.
pub fn check_name(place: &str, name: &str) -> Checked<()> {
    if name.trim().is_empty() {
        return Err(ModelError::new(place, format!("the name {name:?} is empty: results are found by it")));
    }
    if name.len() > LONGEST {
        let start: String = name.chars().take(SHOWN).collect();
        let message = format!(
            "the name {start:?}… is {} bytes long: results are filed under it; take at most {LONGEST} (letters beyond ASCII \
             count for 2 to 4)",
            name.len()
        );
        return Err(ModelError::new(place, message));
    }
    match name.chars().find(|c| is_unwritable(*c) || BREAKING.contains(c)) {
        Some(character) => Err(ModelError::new(
            place,
            format!("the name {name:?} has {character:?} in it, which would break the rows of history.csv: rename it"),
        )),
        None => Ok(()),
    }
}

/// Titles and labels of units go into figures, pages and stores as they are: each must be a line of text.
pub fn check_line(place: &str, text: &str) -> Checked<()> {
    match text.chars().find(|c| is_unwritable(*c)) {
        Some(character) => {
            Err(ModelError::new(place, format!("{text:?} has {character:?} in it: give a line of text, without it")))
        }
        None => Ok(()),
    }
}

/// That a body is not among those that there are.
pub fn no_body<'n>(name: &str, known: impl Iterator<Item = &'n str>, place: &str) -> ModelError {
    let known: Vec<&str> = known.collect();
    ModelError::new(place, format!("there is no body `{name}`; the bodies are {}", known.join(", ")))
}

/// Nothing of one kind may be given twice.
pub fn check_once<'n>(of: &str, mut names: impl Iterator<Item = &'n String>) -> Checked<()> {
    let mut seen = BTreeSet::new();
    match names.find(|name| !seen.insert(*name)) {
        Some(name) => Err(ModelError::new(format!("{of}.{name}"), "is given twice: keep one, or rename one")),
        None => Ok(()),
    }
}
