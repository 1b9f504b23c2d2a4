//! Warning about surfaces that rattle on their penalty in explicit increments.
//!
//! Every closure answers a difference of two motions by a larger one. After some tens of closures of a point that of round-off is as large as
//! the forces themselves, which no increment, mesh or output then makes the same again.

use nalgebra::Vector2;

use crate::contact::{ContactPair, ContactState};
use crate::mesh::configuration::Configuration;

/// Number of closures of a point from which on round-off is seen in its force.
const RATTLES: u32 = 30;

/// The point of a contact that has closed most often, where that is too often, with a warning.
pub fn rattles(pair: &ContactPair, states: &[ContactState], x: &Configuration) -> Option<(Vector2<f64>, String)> {
    let points = pair.points.iter().zip(states).max_by_key(|(_, state)| state.closures);
    let (point, state) = points.filter(|(_, state)| state.closures >= RATTLES)?;
    let message = format!(
        "its surfaces rattle on the penalty, and have closed {} times there: forces at single moments go by round-off, and only their means over time \
         (impulses) count; give the bodies viscosity (`damping`: {{\"stiffness\": …}}), or a softer alpha_n",
        state.closures
    );
    Some((point.at(x), message))
}
