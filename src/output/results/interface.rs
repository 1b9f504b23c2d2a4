//! What an interface did over time and place, from `interface.zarr`.

use std::path::Path;

use crate::output::interface::read::{StoredContact, Unreadable, contacts};

/// The records of one contact: a row a time, in each row a value a point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InterfaceMap {
    /// name of the contact
    pub contact: String,
    /// of the rows, ascending [T]
    pub times: Vec<f64>,
    /// of the points along the slave [L]
    pub positions: Vec<f64>,
    /// by name, row by row
    pub quantities: Vec<(String, Vec<f64>)>,
}

impl InterfaceMap {
    /// The interfaces of a folder; none if it has no store.
    ///
    /// # Errors
    /// [`Unreadable`] with the file, and what is wrong with it.
    pub fn read(folder: &Path) -> Result<Vec<Self>, Unreadable> {
        Ok(contacts(folder, |_| true)?.into_iter().filter(|contact| !contact.times.is_empty()).map(Self::of).collect())
    }

    fn of(contact: StoredContact) -> Self {
        let StoredContact { name, times, positions, quantities, .. } = contact;
        let spoken = |name: String| match &*name {
            "p" => "pressure".into(),
            "q" => "traction".into(),
            _ => name,
        };
        let wide = |values: Vec<f32>| values.into_iter().map(f64::from).collect();
        let quantities = quantities.into_iter().map(|(name, values)| (spoken(name), wide(values))).collect();
        Self { contact: name, times, positions, quantities }
    }
}
