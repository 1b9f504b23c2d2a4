//! Titles and labels of units, which go into figures, pages and stores as they are.

use std::collections::BTreeMap;

use super::error::{Checked, Complaint};
use crate::mesh::names::is_unwritable;

/// Each must be a line of text.
pub fn check(title: &str, units: &BTreeMap<String, String>) -> Checked<()> {
    let units = units.iter().map(|(of, label)| (format!("units.{of}"), label.as_str()));
    for (place, text) in [("title".to_string(), title)].into_iter().chain(units) {
        if let Some(character) = text.chars().find(|c| is_unwritable(*c)) {
            let message = format!("{text:?} has {character:?} in it: give a line of text, without it");
            return Err(Complaint::new(place, message));
        }
    }
    Ok(())
}
