//! Where the iterations of an increment start.
//!
//! ```text
//! u = u₀ + Δt/Δt₀ Δu₀                                 the last increment of the step goes on at its pace
//! u = u₀ + Δt v₀ + ½ Δt² a₀                           in dynamics under error control
//! ```
//!
//! Without it every increment starts at u₀, and the points that have to slip, open or close find that out once more. Where the
//! last increment ended in touch the next one is not like it. In dynamics no accepted increment under error control
//! leaves the second start by much more than the allowed error; where increments do not resolve the motion it would be far off.
//! Nodes whose mass was moved away have accelerations that mean nothing: they go on at their pace. Switch `start`;
//! `aid_start` is 1 in an iteration that begins there.
//!
//! Source: the predictor of Newmark (1959) in dynamics; in statics the secant predictor of path following.

use crate::equations::Trial;
use crate::model::Model;
use crate::model::state::{LastIncrement, State};

/// The start value of an increment, and whether it is another one than the committed displacement.
pub fn start_value(model: &Model, trial: Trial) -> (Vec<f64>, bool) {
    let Trial { old, step, dt, .. } = trial;
    let State { displacement, velocity, acceleration, .. } = old;
    let rest = || (displacement.clone(), false);
    if !model.aids.start {
        return rest();
    }
    let last = goes_on(old);
    if !(step.scheme.is_dynamic() && step.increments.error.is_some()) {
        let Some(last) = last else { return rest() };
        let share = dt / last.dt;
        return (displacement.iter().zip(&last.displacement).map(|(u, du)| u + share * du).collect(), true);
    }
    let way = |dof: usize| match last {
        _ if !model.massless[dof / 2] => dt * (velocity[dof] + 0.5 * dt * acceleration[dof]),
        Some(last) => dt / last.dt * last.displacement[dof],
        None => 0.0,
    };
    ((0..displacement.len()).map(|dof| displacement[dof] + way(dof)).collect(), true)
}

/// The last increment of the step, if the next one is expected to be like it.
fn goes_on(old: &State) -> Option<&LastIncrement> {
    old.last_increment.as_ref().filter(|last| !last.ends_in_touch)
}
