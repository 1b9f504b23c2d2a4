//! Warning about surfaces that water opens, along which it flows by the transmissivity of closed ones.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::contact::point::ContactState;
use crate::model::Model;
use crate::model::scheme::time_text;
use crate::model::state::State;
use crate::model::text::{number, vector};

/// Share of the pressure that a point has lost as it opens by which that of the water has risen [-]
const BY_WATER: f64 = 0.5;

/// Contacts that water has opened, and what is to be said of each.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct Opened {
    found: BTreeMap<usize, String>,
    told: bool,
}

impl Opened {
    /// Looks at an accepted increment.
    pub fn record(&mut self, model: &Model, old: &State, state: &State) {
        for (k, pair) in model.contacts.iter().enumerate() {
            let Some(conduit) = pair.conduit.as_ref().filter(|conduit| conduit.transmissivity.aperture.is_none())
            else {
                continue;
            };
            if self.found.contains_key(&k) {
                continue;
            }
            let x = model.configuration(&state.displacement);
            let points = pair.points.iter().zip(old.contacts[k].iter().zip(&state.contacts[k]));
            // Where the water has risen by less, something else parts the surfaces.
            let opens = |old: &ContactState, new: &ContactState| {
                let rise = new.fluid - old.fluid;
                old.is_closed() && new.is_separated(pair.touch) && rise > BY_WATER * old.friction.pressure && rise > 0.0
            };
            let mut opened = points.filter(|(_, (old, new))| opens(old, new));
            if let Some((point, (_, new))) = opened.next() {
                let message = format!(
                    "contact `{}` at {}, t = {}: its water opens it, at the pressure {}, and goes on flowing by the transmissivity of closed \
                     surfaces there ({} where nothing has slipped): give the hydraulic `aperture` of the cubic law, or lower the pressure",
                    pair.name,
                    vector(point.at(&x)),
                    time_text(state.time),
                    number(new.fluid),
                    number(conduit.transmissivity.at_rest.iter().copied().fold(0.0, f64::max))
                );
                self.found.insert(k, message);
            }
        }
    }

    /// The warnings, each of which is reported once.
    pub fn warnings(&mut self) -> impl Iterator<Item = String> {
        let told = std::mem::replace(&mut self.told, true);
        self.found.clone().into_values().filter(move |_| !told)
    }
}
