//! The fluid in a contact.

use super::contact::Contact;
use super::error::{Checked, ModelError};
use super::friction::check_in_time;
use crate::contact::pair::{BadPressure, ContactPair, Fluid};
use crate::model::Model;

/// The fluid of a contact, if it has one.
pub fn fluid(place: &str, contact: &Contact) -> Checked<Option<Fluid>> {
    let Some(pressure) = contact.fluid_pressure.clone() else { return Ok(None) };
    check_in_time(&pressure, &format!("{place}.fluid_pressure"))?;
    Ok(Some(Fluid::new(move |at, time| pressure.value_at(at, time))))
}

/// A fluid pushes, and does not pull; what it does later a run sees.
pub fn check(pair: &ContactPair, place: &str, model: &Model) -> Checked<()> {
    let Some(BadPressure { at, pressure }) = pair.bad_fluid_pressure(&model.mesh.undeformed(), 0.0) else {
        return Ok(());
    };
    let message = format!(
        "is {pressure} at ({}, {}) and t = 0: must be a finite number, zero or positive, which pushes the surfaces apart",
        at.x, at.y
    );
    Err(ModelError::new(format!("{place}.fluid_pressure"), message))
}
