//! Surfaces that are tied: what has no meaning beside it.

use super::contact::{Contact, MasterSide, Radiation};
use super::error::{Checked, ModelError};
use crate::contact::pair::ContactPair;

/// A tie holds by itself, whatever the pressure: it takes no friction, and any other contact needs one.
pub fn check_friction(contact: &Contact, place: &str) -> Checked<()> {
    let message = match (contact.tied, contact.friction.is_tie()) {
        (true, false) => "is for surfaces that slide, and these are tied: leave it out",
        (false, true) => "is missing: give the law, such as {\"law\": \"coulomb\", \"mu\": 0.3}, or \"tied\": true",
        _ => return Ok(()),
    };
    Err(ModelError::new(format!("{place}.friction"), message))
}

/// Some point must face the master.
pub fn check_feet(pair: &ContactPair, place: &str) -> Checked<()> {
    let faces = pair.small.iter().flat_map(|small| &small.points).any(Option::is_some);
    let message = "ties nothing: no point of the slave has a projection on the master; check the groups named and their positions";
    if faces { Ok(()) } else { Err(ModelError::new(format!("{place}.tied"), message)) }
}

/// Surfaces of two bodies can be tied, and what moves or presses them otherwise is refused.
pub fn check(contact: &Contact, place: &str) -> Checked<()> {
    let refused = |key: &str, why: &str| Err(ModelError::new(format!("{place}.{key}"), why));
    if !matches!(contact.master, MasterSide::Group(_)) || contact.is_own() {
        return refused(
            "master",
            "is no other group of edges, to which a surface can be tied: hold it by supports instead",
        );
    }
    let beside = [
        ("area", contact.area.is_some()),
        ("smooth", contact.smooth),
        ("normal.penetration", contact.normal.penetration.is_some()),
        ("stick", contact.stick.is_some()),
        ("shrink_fit", contact.shrink_fit),
        ("massless", contact.massless),
        ("dilatancy", contact.dilatancy.is_some()),
        ("wear", contact.wear.is_some()),
        ("radiation_damping", contact.radiation_damping != Radiation::OfBodies(false)),
        ("fluid_pressure", contact.fluid_pressure.is_some()),
        ("along", !contact.along.is_empty()),
        ("initial", contact.initial.is_some()),
    ];
    match beside.iter().find(|(_, given)| *given) {
        Some((key, _)) => refused(key, "has no meaning for surfaces that are tied: leave it out"),
        None => Ok(()),
    }
}
