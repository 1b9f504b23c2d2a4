//! Which accepted increments are rows of the results: all of them or, with an interval, those that are at least so far apart in
//! time.
//!
//! Events are never thinned away: where a point of a contact closes, opens, begins to slip or stops, the increments before and
//! after are rows. So are the last ones of steps, those at the times asked for, and the outputs of explicit increments. It is
//! decided once, by the run; all that is written over time goes by it.

use crate::laws::friction::Regime;
use crate::model::Model;
use crate::model::scheme::Scheme;
use crate::model::state::State;
use crate::run::observer::Attempt;

/// Share of the interval that round-off may take away.
const ROUND_OFF: f64 = 1e-9;

/// What becomes of an increment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Row {
    /// It is a row
    Written,
    /// It is a row, and so is the one that was held, if there is one
    AfterTheHeld,
    /// It is one if an event follows; what was not accepted is none
    #[default]
    Held,
}

impl Row {
    /// What becomes of an attempt, where the last row was at a time [T].
    pub(super) fn of(model: &Model, attempt: &Attempt, last: f64) -> Self {
        let Some(new) = attempt.accepted else { return Self::Held };
        let Some(interval) = model.interval else { return Self::Written };
        let is_kept = || {
            matches!(attempt.step.scheme, Scheme::Explicit { .. })
                || attempt.ends_step(new)
                || model.is_output_time(new.time)
                || new.time - last >= interval * (1.0 - ROUND_OFF)
        };
        match regimes(model, attempt.old) != regimes(model, new) {
            true => Self::AfterTheHeld,
            false if is_kept() => Self::Written,
            false => Self::Held,
        }
    }
}

fn regimes(model: &Model, state: &State) -> Vec<Regime> {
    let pairs = model.contacts.iter().zip(&state.contacts);
    pairs.flat_map(|(pair, states)| pair.points.iter().zip(states).map(|(p, state)| pair.regime(p, state))).collect()
}
