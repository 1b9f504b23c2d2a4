//! Warning about friction that is integrated to first order in time, in increments too long for it: where slip is unstable they damp
//! the instability away, and events are late, or never happen.

use super::worst::Worst;
use crate::mesh::configuration::Configuration;
use crate::model::builder::OF_CRITICAL_SLIP;
use crate::model::scheme::time_text;
use crate::model::text::number;
use crate::model::{Model, State, Step};
use crate::run::observer::Attempt;
use crate::time::step_size::error_of_slip;

/// Error of slip in an increment that causes a warning, as a fraction of D_c.
const COARSE: f64 = 0.1;

/// Enters the largest error of slip of each contact, over its D_c, of an accepted implicit or static increment; others come without iterations.
pub fn record(worst: &mut Worst, model: &Model, attempt: &Attempt, state: &State, x: &Configuration) {
    let (step, old) = (attempt.step, attempt.old);
    // What exceeds the allowed error is reported as such.
    let is_reported = attempt.local_error.is_some_and(|error| error.is_excessive());
    if attempt.iterations.is_empty() || is_reported || step.increments.slip.is_some() {
        return;
    }
    for (k, pair) in model.contacts.iter().enumerate().filter(|(_, pair)| !pair.tied && step.joins(pair)) {
        for (point, (before, after)) in pair.points.iter().zip(old.contacts[k].iter().zip(&state.contacts[k])) {
            let critical = pair.ask_law(point, [state.time; 2], |law| law.description.critical_slip);
            let Some(critical) = critical.ok().flatten() else { continue };
            let error = error_of_slip([before, after], [old.last_dt(), state.dt]);
            let so_far = worst.bound(k, COARSE);
            if error > so_far * critical {
                let [slip, last] = [after, before].map(|state| state.friction.plastic_increment.abs());
                let at = point.at(x);
                let message = format!(
                    "contact `{}` at ({:.6}, {:.6}), t = {}: slip of {slip:.3e} in an increment of {:.3e}, after {last:.3e} in \
                         the last one, is wrong by about {:.1} D_c: its friction is integrated to first order in time, and increments this long damp \
                         stick-slip away; {}",
                    pair.name,
                    at.x,
                    at.y,
                    time_text(state.time),
                    state.dt,
                    error / critical,
                    remedy(step, critical)
                );
                worst.enter(k, error / critical, message);
            }
        }
    }
}

fn remedy(step: &Step, critical: f64) -> String {
    match step.increments.error {
        Some(_) => format!("lower dt.error, to {} say", number(OF_CRITICAL_SLIP * critical)),
        None => "leave \"error\": null out of dt, then the error of slip is controlled".into(),
    }
}
