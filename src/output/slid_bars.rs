//! Warning about bars that have slipped far along the body that they lie in: their bond acts where they were.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::model::Model;
use crate::model::scheme::time_text;
use crate::model::state::State;
use crate::model::text::{self, number};

/// Slip of a bar over the diagonal of the element that it lies in, above which a warning is given [-]
const FAR: f64 = 0.5;

/// The largest such share of each bar, and what is to be said of it.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct SlidBars {
    most: BTreeMap<usize, (f64, String)>,
}

impl SlidBars {
    /// Looks at an accepted increment.
    pub fn record(&mut self, model: &Model, state: &State) {
        for (k, (bar, states)) in model.bars.iter().zip(&state.bars).enumerate() {
            for (grip, own) in bar.grips.iter().zip(&states.grips).filter(|_| states.is_there) {
                let size = model.mesh.size_of(model.mesh.elements[grip.element].nodes.iter().copied());
                let share = own.slip.abs() / size;
                if share > self.most.get(&k).map_or(FAR, |(most, _)| *most) {
                    let message = format!(
                        "bar `{}` at {}, t = {}: it has slipped by {} in an element that is {} across, and its bond \
                         acts on the body where it was at first: take longer elements, or a smaller slip",
                        bar.name,
                        text::vector(bar.vertices[grip.vertex].at),
                        time_text(state.time),
                        number(own.slip.abs()),
                        number(size)
                    );
                    self.most.insert(k, (share, message));
                }
            }
        }
    }

    /// The warnings, each of which is reported once.
    pub fn warnings(&mut self) -> impl Iterator<Item = String> {
        std::mem::take(&mut self.most).into_values().map(|(_, message)| message)
    }
}
