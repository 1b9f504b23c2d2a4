//! Warning about surfaces that water opens, along which it flows by the transmissivity of closed ones.

use nalgebra::Vector2;

use crate::contact::{ContactPair, ContactState};
use crate::mesh::configuration::Configuration;
use crate::model::text::number;

/// Share of the pressure that a point has lost as it opens by which that of the water has risen [-]
const BY_WATER: f64 = 0.5;

/// The first point of a contact that its water opens in an increment, with a warning.
pub fn by_water(
    pair: &ContactPair,
    [old, new]: [&[ContactState]; 2],
    x: &Configuration,
) -> Option<(Vector2<f64>, String)> {
    let conduit = pair.conduit.as_ref().filter(|conduit| conduit.transmissivity.aperture.is_none())?;
    // Where the water has risen by less, something else parts the surfaces.
    let opens = |old: &ContactState, new: &ContactState| {
        let rise = new.fluid - old.fluid;
        old.is_closed() && new.is_separated(pair.touch) && rise > BY_WATER * old.friction.pressure && rise > 0.0
    };
    let mut points = pair.points.iter().zip(old.iter().zip(new));
    let (point, (_, new)) = points.find(|(_, (old, new))| opens(old, new))?;
    let message = format!(
        "its water opens it, at the pressure {}, and goes on flowing by the transmissivity of closed surfaces there ({} where nothing has \
         slipped): give the hydraulic `aperture` of the cubic law, or lower the pressure",
        number(new.fluid),
        number(conduit.transmissivity.at_rest.iter().copied().fold(0.0, f64::max))
    );
    Some((point.at(x), message))
}
