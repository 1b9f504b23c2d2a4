//! Names that go into the header and the rows of a CSV file, and names that may stand once only.

use std::collections::BTreeSet;

use super::Builder;
use super::error::{Checked, ModelError};
use crate::mesh::names::is_unwritable;

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
        for body in &self.bodies {
            check_name("bodies", &body.name)?;
        }
        check_title(&self.title)?;
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

/// A title stands in figures, pages and stores, in a line.
fn check_title(title: &str) -> Checked<()> {
    match title.chars().find(|c| is_unwritable(*c)) {
        Some(character) => {
            Err(ModelError::new("title", format!("{title:?} has {character:?} in it: give a line of text, without it")))
        }
        None => Ok(()),
    }
}

/// The watched groups, each named once.
pub fn check_watched(watch: &[String]) -> Checked<()> {
    let mut seen = BTreeSet::new();
    for (k, name) in watch.iter().enumerate() {
        check_name(&format!("watch[{k}]"), name)?;
        if !seen.insert(name) {
            return Err(ModelError::new(format!("watch[{k}]"), format!("`{name}` is watched already: name it once")));
        }
    }
    Ok(())
}

/// Nothing of one kind may be given twice.
pub fn check_once<'n>(of: &str, mut names: impl Iterator<Item = &'n String>) -> Checked<()> {
    let mut seen = BTreeSet::new();
    match names.find(|name| !seen.insert(*name)) {
        Some(name) => Err(ModelError::new(format!("{of}.{name}"), "is given twice: keep one, or rename one")),
        None => Ok(()),
    }
}
