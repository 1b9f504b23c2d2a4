//! Names that go into the header and the rows of a CSV file.

use super::error::Complaint;
use super::file::Case;

/// Characters that would break a row apart, besides line breaks and other control characters.
const BREAKING: [char; 2] = [',', '"'];

/// The names of steps, contacts and watched groups must survive in a CSV file.
pub fn check(case: &Case) -> Result<(), Complaint> {
    for (k, step) in case.steps.iter().enumerate() {
        check_name(&format!("steps[{k}].name"), &step.name)?;
    }
    for name in case.contacts.keys() {
        check_name("contacts", name)?;
    }
    for (k, name) in case.watch.iter().enumerate() {
        check_name(&format!("watch[{k}]"), name)?;
        if case.watch[..k].contains(name) {
            return Err(Complaint::new(format!("watch[{k}]"), format!("`{name}` is watched already: name it once")));
        }
    }
    Ok(())
}

fn check_name(place: &str, name: &str) -> Result<(), Complaint> {
    if name.trim().is_empty() {
        return Err(Complaint::new(place, format!("the name {name:?} is empty: results are found by it")));
    }
    match name.chars().find(|c| c.is_control() || BREAKING.contains(c)) {
        Some(character) => Err(Complaint::new(
            place,
            format!("the name {name:?} has {character:?} in it, which would break the rows of history.csv: rename it"),
        )),
        None => Ok(()),
    }
}
