//! How long an increment is: whether a solved one is accepted, and the length of the next attempt.
//!
//! Without error control every solved increment is accepted, and the next one is longer if few iterations did it.
//!
//! With error control, ε being the error allowed:
//!
//! - The estimated local error e of [`crate::time`] must not exceed ε in any free displacement. As e falls with Δt³, the
//!   next attempt takes Δt (ε/e)^⅓, with a margin. Accepted increments keep their length where the gain is small.
//! - An increment in which a contact as a whole begins to slip, stops or turns round is repeated with half its length
//!   until no point that takes part slips by more than 10 ε in it: the event is then known to 10 ε of displacement.
//!   The direction of a contact is that of the slip of more than half its closed length, else 0. What a point slips is
//!   its plastic slip in the increment or, where it stops, what it would have slipped at its last rate. So a contact
//!   that swings to and fro in stick has no events.
//! - An increment after a repeated one does not grow. Halves that are accepted thus walk up to the event and never jump
//!   over it, and every attempt either moves on or halves the increment.
//! - The shortest increment is accepted whatever its error, which is told as a warning if it exceeds ε.
//!
//! Nothing much larger than ε can be stepped over unseen: e is a fixed share, at least a twelfth, of what the new
//! displacement differs from the one extrapolated with the old velocity and acceleration ((6) of [`crate::time`]), and a
//! slip, an arrest or an impact changes the displacement by all it moves. Only what comes and goes within one increment,
//! such as a short pulse of a load, needs a `max` that meets it.

use crate::configuration::Configuration;
use crate::contact::force::{ContactState, Status};
use crate::contact::pair::ContactPair;
use crate::model::{Model, Step};
use crate::state::State;

/// An increment solved in this many iterations or fewer was easy: the next one may be longer.
const EASY: usize = 4;
/// Growth of the increment after an easy one.
const GROWTH: f64 = 1.5;
/// An event is located to this many times the allowed error.
pub const EVENT_LOCATION: f64 = 10.0;
/// Part of the length that the error allows which is taken: the estimate is one of several terms.
const SAFETY: f64 = 0.8;
/// Most that one estimate shortens the next attempt: far from the solution the estimate is not of third order.
const LEAST_SHARE: f64 = 0.1;
/// A change that is not worth having: increments of one length keep the orders of the scheme.
const WORTHWHILE: f64 = 1.25;

/// Excess of what is left of a step over an increment that is not worth another one.
const ROUND_OFF: f64 = 1e-6;

/// What becomes of a solved increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement {
    /// Whether it is accepted or repeated
    pub accepted: bool,
    /// Δt of the next attempt, before the bounds of the step [T]
    pub next: f64,
    /// Estimated local error of a displacement, in steps under error control [L]
    pub error: Option<f64>,
}

/// Δt of the next attempt within the bounds of the step. The last increment ends on the end of the step; under error
/// control the last two share what is left, so that none is much shorter than the one before.
pub fn bounded(step: &Step, time: f64, dt: f64) -> f64 {
    let remaining = step.span.end - time;
    let dt = dt.min(step.increments.max);
    let left = (remaining / dt - ROUND_OFF).ceil().max(1.0);
    if step.increments.error.is_some() && left <= 2.0 { remaining / left } else { dt.min(remaining) }
}

/// Judge a solved increment from `old` to `new`; `repeated` says that an attempt at it was given up before.
pub fn judge(model: &Model, step: &Step, [old, new]: [&State; 2], iterations: usize, repeated: bool) -> Judgement {
    let dt = new.dt;
    let easy = iterations <= EASY;
    let Some(allowed) = step.increments.error else {
        return Judgement { accepted: true, next: if easy { dt * GROWTH } else { dt }, error: None };
    };
    let error = local_error(step, old, new);
    let share = (SAFETY * (allowed / error).cbrt()).clamp(LEAST_SHARE, GROWTH);
    let judged = |accepted: bool, share: f64| Judgement { accepted, next: share * dt, error: Some(error) };
    let shortest = step.increments.min;
    if dt > shortest && error > allowed {
        return Judgement { next: (share * dt).max(shortest), ..judged(false, share) };
    }
    if dt > shortest && slip_at_events(model, old, new) > EVENT_LOCATION * allowed {
        return Judgement { next: (0.5 * dt).max(shortest), ..judged(false, share) };
    }
    let grows = easy && !repeated && share > WORTHWHILE;
    judged(true, if grows { share } else { 1.0 })
}

/// C Δt² |a₁ − a₀|, the largest of all free dofs [L].
fn local_error(step: &Step, old: &State, new: &State) -> f64 {
    let constant = step.scheme.error_constant().unwrap_or(0.0);
    let rates = new.acceleration.iter().zip(&old.acceleration).enumerate();
    let free = rates.filter(|(dof, _)| step.supports.binary_search_by_key(dof, |support| support.dof).is_err());
    let change = free.fold(0.0, |largest: f64, (_, (new, old))| largest.max((new - old).abs()));
    constant * new.dt.powi(2) * change
}

/// Largest slip, in the increment, of a point that takes part in an event of its contact; 0 if there is none [L].
fn slip_at_events(model: &Model, old: &State, new: &State) -> f64 {
    let [x0, x1] = [old, new].map(|state| model.configuration(&state.displacement));
    let pairs = model.contacts.iter().zip(old.contacts.iter().zip(&new.contacts));
    // Slip without friction has no onset.
    let rough = pairs.filter(|(pair, _)| pair.law.stiffness() > 0.0);
    let events = rough.filter(|(pair, (old, new))| direction(pair, old, &x0) != direction(pair, new, &x1));
    let points = events.flat_map(|(_, (old, new))| old.iter().zip(new));
    let involved = points.filter(|(old, new)| point_direction(old) != point_direction(new));
    let slip = |state: &ContactState, share: f64| match state.status() {
        Status::Slip => state.friction.plastic_increment.abs() * share,
        _ => 0.0,
    };
    involved.fold(0.0, |largest, (before, after)| largest.max(slip(after, 1.0)).max(slip(before, new.dt / old.dt)))
}

/// Sign of the slip of more than half the closed length of a contact, else 0.
fn direction(pair: &ContactPair, states: &[ContactState], x: &Configuration) -> f64 {
    let (mut closed, mut slipping, mut slip) = (0.0, 0.0, 0.0);
    for (point, state) in pair.points.iter().zip(states).filter(|(_, state)| state.status() != Status::Open) {
        let length = point.current_length(x);
        closed += length;
        if state.status() == Status::Slip {
            slipping += length;
            slip += length * state.friction.plastic_increment;
        }
    }
    if slipping > 0.5 * closed { sign(slip) } else { 0.0 }
}

fn point_direction(state: &ContactState) -> f64 {
    if state.status() == Status::Slip { sign(state.friction.plastic_increment) } else { 0.0 }
}

fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}
