//! Which increments have rows in the tables: all of them or, with an interval, those that are at least so far apart in time.
//!
//! Events are never thinned away: where a point of a contact closes, opens, begins to slip or stops, the increments before and
//! after are rows. So are the last ones of steps, those at the times asked for, and the outputs of explicit increments.

use serde::{Deserialize, Serialize};

use crate::laws::friction::Regime;
use crate::model::Model;
use crate::model::scheme::Scheme;
use crate::model::state::State;
use crate::run::observer::Attempt;

/// Share of the interval that round-off may take away.
const ROUND_OFF: f64 = 1e-9;

/// What becomes of an increment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Row {
    /// It is a row
    Written,
    /// It is a row, and so is the one that was held, if there is one
    AfterTheHeld,
    /// It is one if an event follows
    Held,
}

/// Judges one accepted increment after the other. It knows the time of the last row, and the regimes of all points of all
/// contacts after the last increment; nothing before the first one.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Rows(Option<(f64, Vec<Regime>)>);

impl Rows {
    /// What becomes of the increment that led to a state.
    pub fn judge(&mut self, model: &Model, attempt: &Attempt, state: &State) -> Row {
        let Some(interval) = model.interval else { return Row::Written };
        let (last, before) = self.0.take().unwrap_or_else(|| (attempt.old.time, regimes(model, attempt.old)));
        let regimes = regimes(model, state);
        let row = match regimes != before {
            true => Row::AfterTheHeld,
            false if is_kept(model, attempt, state) => Row::Written,
            false if state.time - last >= interval * (1.0 - ROUND_OFF) => Row::Written,
            false => Row::Held,
        };
        self.0 = Some((if row == Row::Held { last } else { state.time }, regimes));
        row
    }
}

fn is_kept(model: &Model, attempt: &Attempt, state: &State) -> bool {
    matches!(attempt.step.scheme, Scheme::Explicit { .. })
        || attempt.ends_step(state)
        || model.is_output_time(state.time)
}

fn regimes(model: &Model, state: &State) -> Vec<Regime> {
    let pairs = model.contacts.iter().zip(&state.contacts);
    pairs.flat_map(|(pair, states)| pair.points.iter().zip(states).map(|(p, state)| pair.regime(p, state))).collect()
}
