//! Warning about tractions that alternate from point to point: sums of them may be right, the distribution is not.

use super::worst::Worst;
use crate::contact::master::Master;
use crate::contact::scatter::Course;
use crate::model::scheme::{Scheme, time_text};
use crate::model::{Method, Model, State};
use crate::run::observer::Attempt;

/// Scatter of tractions at the end of a step that causes a warning, over the mean pressure.
const SCATTERS: f64 = 0.05;

/// Enters the largest scatter of each contact at the end of a step without explicit increments, whose waves alternate as well.
pub fn record(worst: &mut Worst, model: &Model, attempt: &Attempt, state: &State) {
    if !attempt.ends_step(state) || matches!(attempt.step.scheme, Scheme::Explicit { .. }) {
        return;
    }
    let undeformed = model.mesh.undeformed();
    let contacts = model.contacts.iter().zip(&model.methods).zip(&state.contacts).enumerate();
    for (k, ((pair, chosen), states)) in contacts.filter(|(_, ((pair, _), _))| attempt.step.joins(pair)) {
        let scatter = Course::new(&pair.points, &undeformed).scatter(states);
        if scatter <= worst.bound(k, SCATTERS) {
            continue;
        }
        let by_mortar = chosen.as_ref().is_some_and(|chosen| chosen.method == Method::Mortar);
        let remedy = match &pair.master {
            Master::Mesh(_) if !by_mortar => "take \"method\": \"mortar\", or a softer alpha_n",
            _ => "take softer alpha_n and alpha_t, a finer slave, or shorter increments while points close",
        };
        let message = format!(
            "contact `{}`, t = {}: tractions alternate from point to point by {:.0} % of the mean pressure (column scatter): sums of \
                 them may be right, their distribution is not; {remedy}",
            pair.name,
            time_text(state.time),
            100.0 * scatter
        );
        worst.enter(k, scatter, message);
    }
}
