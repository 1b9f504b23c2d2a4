//! Warning about bars that have slipped far along the body that they lie in: their bond acts where they were.

use super::worst::Worst;
use crate::model::scheme::time_text;
use crate::model::text::{self, number};
use crate::model::{Model, State};

/// Slip of a bar over the diagonal of the element that it lies in, above which a warning is given [-]
const FAR: f64 = 0.5;

/// Enters the largest such share of each bar in an accepted increment.
pub fn record(worst: &mut Worst, model: &Model, state: &State) {
    for (k, (bar, states)) in model.bars.iter().zip(&state.bars).enumerate() {
        for (grip, own) in bar.grips.iter().zip(&states.grips).filter(|_| states.is_there) {
            let size = model.mesh.size_of(model.mesh.elements[grip.element].nodes.iter().copied());
            let share = own.slip.abs() / size;
            if share > worst.bound(k, FAR) {
                let message = format!(
                    "bar `{}` at {}, t = {}: it has slipped by {} in an element that is {} across, and its bond \
                         acts on the body where it was at first: take longer elements, or a smaller slip",
                    bar.name,
                    text::vector(bar.vertices[grip.vertex].at),
                    time_text(state.time),
                    number(own.slip.abs()),
                    number(size)
                );
                worst.enter(k, share, message);
            }
        }
    }
}
