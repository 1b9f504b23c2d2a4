//! Names that go into the header and the rows of a CSV file, and names that may stand once only.

use super::Builder;
use super::error::{Checked, ModelError};

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
        check_watched(&self.watch)?;
        check_once("contacts", self.contacts.iter().map(|contact| &contact.name))?;
        check_once("bodies", self.bodies.iter().map(|body| &body.name))?;
        check_once("point_masses", self.point_masses.iter().map(|mass| &mass.name))
    }
}

/// A name by which results are found must survive in a CSV file.
pub fn check_name(place: &str, name: &str) -> Checked<()> {
    if name.trim().is_empty() {
        return Err(ModelError::new(place, format!("the name {name:?} is empty: results are found by it")));
    }
    match name.chars().find(|c| c.is_control() || BREAKING.contains(c)) {
        Some(character) => Err(ModelError::new(
            place,
            format!("the name {name:?} has {character:?} in it, which would break the rows of history.csv: rename it"),
        )),
        None => Ok(()),
    }
}

/// The watched groups, each named once.
pub fn check_watched(watch: &[String]) -> Checked<()> {
    for (k, name) in watch.iter().enumerate() {
        check_name(&format!("watch[{k}]"), name)?;
        if watch[..k].contains(name) {
            return Err(ModelError::new(format!("watch[{k}]"), format!("`{name}` is watched already: name it once")));
        }
    }
    Ok(())
}

/// Nothing of one kind may be given twice.
pub fn check_once<'n>(of: &str, names: impl Iterator<Item = &'n String> + Clone) -> Checked<()> {
    for (k, name) in names.clone().enumerate() {
        if names.clone().take(k).any(|earlier| earlier == name) {
            return Err(ModelError::new(format!("{of}.{name}"), "is given twice: keep one, or rename one"));
        }
    }
    Ok(())
}
