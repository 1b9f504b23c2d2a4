//! Warning about shear that points carry without pressure, over gaps: its size goes by the opening over which strength fades.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::contact::{ContactPair, ContactState};
use crate::model::{Model, State};

/// Share of the shear of a contact on open points that is worth a warning [-]
const ON_OPEN_POINTS: f64 = 0.01;

/// Shear of the contacts whose strength fades over an opening that was not given.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct Unpressed {
    contacts: BTreeMap<String, Shear>,
}

/// Shear of a contact.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
struct Shear {
    /// Largest ∫ |q| ds so far of all points, and of those that are open [F]
    whole: f64,
    open: f64,
    /// Widest gap of a point that carries shear, and δ [L]
    widest: f64,
    opening: f64,
}

impl Unpressed {
    /// Looks at an accepted state.
    pub fn record(&mut self, model: &Model, state: &State) {
        for (pair, states) in model.contacts.iter().zip(&state.contacts) {
            let Some(opening) = chosen(pair) else { continue };
            let own = self.contacts.entry(pair.name.clone()).or_default();
            let shear = |states: &mut dyn Iterator<Item = &ContactState>| {
                states.map(|state| state.shear().abs() * state.length).sum::<f64>()
            };
            let open = || states.iter().filter(|state| state.carries_open());
            own.whole = own.whole.max(shear(&mut states.iter()));
            own.open = own.open.max(shear(&mut open()));
            own.widest = open().map(ContactState::clearance).fold(own.widest, f64::max);
            own.opening = opening;
        }
    }

    /// The warnings, each of which is reported once.
    pub fn warnings(&mut self) -> impl Iterator<Item = String> {
        let message = |(contact, own): (String, Shear)| {
            let Shear { whole, open, widest, opening } = own;
            let share = if whole > 0.0 { open / whole } else { 0.0 };
            (share > ON_OPEN_POINTS).then(|| {
                format!(
                    "contact `{contact}`: open points carry up to {:.1} % of its shear, over gaps up to {:.3} of the opening {opening:.3e} over \
                     which its strength fades, which the mesh has chosen: give that of the interface (`bond.opening`)",
                    100.0 * share,
                    widest / opening
                )
            })
        };
        std::mem::take(&mut self.contacts).into_iter().filter_map(message)
    }
}

/// δ of a contact where it was chosen.
fn chosen(pair: &ContactPair) -> Option<f64> {
    pair.fades.filter(|fades| fades.is_chosen)?;
    pair.laws.iter().find_map(|law| law.cohesion.as_ref()).map(|cohesion| cohesion.bond().opening())
}
