//! How long an increment is: whether a solved one is accepted, and the length of the next attempt.
//!
//! Without error control every solved increment is accepted, and the next one is longer if few tangents did it (corrections with
//! an old tangent do not count: whether they are made is a question of cost); but static increments must know friction after
//! touch:
//!
//! - A point that was apart at the start of an increment has slipped in part before it touched. That part lies between
//!   nothing and what it would have been had the motion before the increment gone on until touch; what friction may have to do
//!   with it, summed over the points of a contact, must not exceed 2 % of its force. Where points slide at the limit of
//!   friction anyway, nothing is in doubt.
//! - Else the increment is made in parts: up to the touch that was foreseen if nothing of the contact was closed before, else
//!   as far as few enough points touch; then on to where it should have ended. The contact's force is the largest of
//!   all attempts at the increment.
//! - The shortest increment is accepted whatever its doubt, which is told as a warning.
//! - A point that touches and parts again within one increment is not seen.
//!
//! With error control of a static step, the slip of every closed point is in error by no more than ε in an increment, by the
//! estimate ½ Δt |v₁ − v₀| with the mean rates v of plastic slip in this increment and the last: laws that know time are
//! integrated to first order. As it falls with Δt², the next attempt takes Δt (ε/e)^½, with a margin.
//!
//! With error control of a dynamic step, ε being the error allowed:
//!
//! - The estimated local error e of [`crate::model::scheme`] must not exceed ε in any free displacement. As e falls with Δt³, the
//!   next attempt takes Δt (ε/e)^⅓, with a margin. Accepted increments keep their length where the gain is small.
//! - An increment in which a contact as a whole begins to slip, stops or turns round is repeated with half its length
//!   until no point that takes part slips by more than 10 ε in it: the event is then known to 10 ε of displacement.
//!   A point's direction is ±1, that of its plastic slip, if its slip rate at the end of the increment still goes that
//!   way, else 0; a contact has that of its points if the mean over the closed length exceeds ½ in size. What a point
//!   slips is its plastic slip in the increment and, if it comes from slip, what it would have slipped at its last rate.
//!   So a contact that swings to and fro in stick has no events.
//! - An increment after a repeated one does not grow. Halves that are accepted thus walk up to the event and never jump
//!   over it, and every attempt either moves on or halves the increment.
//! - The shortest increment is accepted whatever its error, which is told as a warning if it exceeds ε.
//!
//! Nothing much larger than ε can be stepped over unseen: e is a fixed share, a quarter or more unless β is near 1/6, of
//! what the new displacement differs from the one extrapolated with the old velocity and acceleration ((6) of
//! [`crate::model::scheme`]), and a slip, an arrest or an impact changes the displacement by all it moves. Only what comes and
//! goes within one increment, such as a short pulse of a load, needs a `max` that meets it.

use crate::contact::force::ContactState;
use crate::contact::pair::Arrival;
use crate::laws::friction::Regime;
use crate::model::state::State;
use crate::model::{Model, Step};

/// An increment solved with this many tangents or fewer, in every pass, was easy: the next one may be longer.
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

/// Share of a contact's force that may be in doubt after a static increment in which points touched.
pub const DOUBT: f64 = 0.02;
/// Part of that which the next attempt aims at.
const AIM: f64 = 0.5;
/// Most that one estimate lengthens the next attempt at the rest of an increment that is made in parts.
const MOST_SHARE: f64 = 4.0;
/// Halvings of an increment that find where to end it: as many as it takes for round-off.
const HALVINGS: usize = 50;

/// Excess of what is left of a step over an increment that is not worth another one.
const ROUND_OFF: f64 = 1e-6;

/// An increment is as short as may be when it is this many times the shortest: sharing what is left of a step stretches it
/// by less, and the times at its ends are rounded.
const SHORTEST: f64 = 1.0 + 10.0 * ROUND_OFF;

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
    let shared = if step.increments.error.is_some() { 2.0 } else { 1.0 };
    if left <= shared { remaining / left } else { dt }
}

/// Whether an increment is longer than the shortest.
fn can_shorten(step: &Step, old: &State, new: &State) -> bool {
    new.time > old.time + SHORTEST * step.increments.min
}

/// Judge a solved increment from `old` to `new`, which took so many `tangents` in its hardest pass; `repeated` says that an
/// attempt at it was given up before.
pub fn judge(model: &Model, step: &Step, [old, new]: [&State; 2], tangents: usize, repeated: bool) -> Judgement {
    let dt = new.dt;
    let easy = tangents <= EASY;
    let Some(allowed) = step.increments.error else {
        return Judgement { accepted: true, next: if easy { dt * GROWTH } else { dt }, error: None };
    };
    let shortest = step.increments.min;
    if !step.scheme.is_dynamic() {
        let error = slip_error(model, old, new);
        let share = (SAFETY * (allowed / error).sqrt()).clamp(LEAST_SHARE, MOST_SHARE);
        let accepted = !can_shorten(step, old, new) || error <= allowed;
        let keeps = accepted && (repeated || share <= WORTHWHILE);
        let next = if keeps { dt } else { (share * dt).max(shortest) };
        return Judgement { accepted, next, error: Some(error) };
    }
    let error = local_error(model, step, old, new);
    let share = (SAFETY * (allowed / error).cbrt()).clamp(LEAST_SHARE, GROWTH);
    let judged = |accepted: bool, share: f64| Judgement { accepted, next: share * dt, error: Some(error) };
    let can_shorten = can_shorten(step, old, new);
    if can_shorten && error > allowed {
        return Judgement { next: (share * dt).max(shortest), ..judged(false, share) };
    }
    if can_shorten && slip_at_events(model, old, new) > EVENT_LOCATION * allowed {
        return Judgement { next: (0.5 * dt).max(shortest), ..judged(false, share) };
    }
    let grows = easy && !repeated && share > WORTHWHILE;
    judged(true, if grows { share } else { 1.0 })
}

/// What the attempts at an increment of a static step have shown about points that touch in it.
#[derive(Clone, Debug, Default)]
pub struct Touching {
    /// End and length of the increment that is made in parts [T]
    whole: Option<(f64, f64)>,
    /// Largest force of each contact in an attempt [F]
    forces: Vec<f64>,
    /// Attempts given up
    refused: usize,
    /// Whether the attempt is to end where a contact touches
    ends_in_touch: bool,
}

impl Touching {
    /// Judge a solved increment that is accepted otherwise; `foreseen` are the contact states had its motion gone on as before.
    /// The share of a contact's force that is in doubt comes with the judgement.
    pub fn judge(
        &mut self,
        model: &Model,
        step: &Step,
        old: &State,
        new: &mut State,
        foreseen: &[Vec<ContactState>],
        judged: Judgement,
    ) -> (Judgement, f64) {
        self.forces.resize(model.contacts.len(), 0.0);
        let mut doubt = 0.0f64;
        let (mut share, mut meets) = (1.0f64, false);
        for (k, pair) in model.contacts.iter().enumerate() {
            let states = old.contacts[k].iter().zip(&foreseen[k]).zip(&new.contacts[k]).zip(&pair.points);
            let arrival = |(((old, foreseen), now), slave)| pair.arrival(slave, [old, foreseen, now], new.dt);
            let unknown = Some(Arrival { at: 0.0, doubt: f64::INFINITY });
            let arrivals: Vec<Arrival> = states.filter_map(|states| arrival(states).unwrap_or(unknown)).collect();
            let force = |state: &ContactState| state.friction.pressure.hypot(state.friction.traction) * state.length;
            self.forces[k] = self.forces[k].max(new.contacts[k].iter().map(force).sum());
            let all: f64 = arrivals.iter().map(|arrival| arrival.doubt).sum();
            if all > 0.0 {
                doubt = doubt.max(all / self.forces[k]);
                let first = arrivals.iter().fold(1.0, |first: f64, arrival| first.min(arrival.at));
                let meets_first = first > 0.0 && old.contacts[k].iter().all(|state| state.friction.pressure <= 0.0);
                let most = if meets_first { first } else { longest(&arrivals, AIM * DOUBT * self.forces[k]) };
                if most < share {
                    (share, meets) = (most, meets_first);
                }
            }
        }
        if doubt > DOUBT && can_shorten(step, old, new) {
            self.whole.get_or_insert((new.time, new.dt));
            // What was foreseen has been wrong before.
            let most = if self.refused == 0 { 1.0 } else { 0.5 };
            self.refused += 1;
            self.ends_in_touch = meets;
            let share = if meets { share } else { share.max(LEAST_SHARE) };
            let next = (share.min(most) * new.dt).max(step.increments.min);
            return (Judgement { accepted: false, next, ..judged }, doubt);
        }
        self.refused = 0;
        let touches = std::mem::take(&mut self.ends_in_touch);
        if let Some(last) = &mut new.last_increment {
            last.ends_in_touch = touches;
        }
        let Some((end, dt)) = self.whole else {
            self.forces.clear();
            return (judged, doubt);
        };
        let left = end - new.time;
        if left > step.increments.min {
            // Where points touch one after the other, their doubt grows with Δt².
            let share = (AIM * DOUBT / doubt).sqrt().clamp(LEAST_SHARE, MOST_SHARE);
            let next = if touches { left } else { left.min(share * new.dt) };
            return (Judgement { next, ..judged }, doubt);
        }
        self.give_up();
        (Judgement { next: dt, ..judged }, doubt)
    }

    /// The attempt could not be solved, and is made shorter.
    pub fn cut(&mut self) {
        self.ends_in_touch = false;
    }

    /// Forget the increment: it is repeated for other reasons.
    pub fn give_up(&mut self) {
        *self = Self::default();
    }
}

/// Share of an increment in which the force in doubt comes to no more than `allowed`, if that of each point grows steadily
/// once it has touched.
fn longest(arrivals: &[Arrival], allowed: f64) -> f64 {
    let doubt =
        |share: f64| -> f64 { arrivals.iter().map(|a| a.doubt * ((share - a.at) / (1.0 - a.at)).max(0.0)).sum() };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if doubt(middle) > allowed { high = middle } else { low = middle }
    }
    low
}

/// Highest slip rate of a contact point with friction from one state to a later one [L/T].
pub fn fastest_slip(model: &Model, old: &State, new: &State) -> f64 {
    let mut fastest = 0.0f64;
    for (pair, (old, new)) in model.contacts.iter().zip(old.contacts.iter().zip(&new.contacts)) {
        for (slave, (old, new)) in pair.points.iter().zip(old.iter().zip(new)) {
            // What slides freely has nothing to break.
            if pair.law(slave).stiffness() > 0.0 {
                fastest = fastest.max((new.friction.plastic_slip - old.friction.plastic_slip).abs());
            }
        }
    }
    fastest / (new.time - old.time)
}

/// C Δt² |a₁ − a₀|, the largest of all free dofs; those without mass follow without error of their own [L].
fn local_error(model: &Model, step: &Step, old: &State, new: &State) -> f64 {
    let constant = step.scheme.error_constant().unwrap_or(0.0);
    let rates = new.acceleration.iter().zip(&old.acceleration).enumerate();
    let heavy = rates.filter(|(dof, _)| !model.massless[dof / 2]);
    let free = heavy.filter(|(dof, _)| step.supports.binary_search_by_key(dof, |support| support.dof).is_err());
    let change = free.fold(0.0, |largest: f64, (_, (new, old))| largest.max((new - old).abs()));
    constant * new.dt.powi(2) * change
}

/// ½ Δt |v₁ − v₀|, the largest of all points that are closed at both ends, with v = plastic slip/Δt of an increment [L].
fn slip_error(model: &Model, old: &State, new: &State) -> f64 {
    let rate = |state: &ContactState, dt: f64| if dt > 0.0 { state.friction.plastic_increment / dt } else { 0.0 };
    let mut largest = 0.0f64;
    for (pair, states) in model.contacts.iter().zip(old.contacts.iter().zip(&new.contacts)) {
        for (slave, (before, after)) in pair.points.iter().zip(states.0.iter().zip(states.1)) {
            let closed = before.friction.pressure > 0.0 && after.friction.pressure > 0.0;
            if closed && pair.law(slave).stiffness() > 0.0 {
                largest = largest.max(0.5 * new.dt * (rate(after, new.dt) - rate(before, old.dt)).abs());
            }
        }
    }
    largest
}

/// Largest slip, in the increment, of a point that takes part in an event of its contact; 0 if there is none, and in the
/// first increment of a run, which may start sliding [L].
fn slip_at_events(model: &Model, old: &State, new: &State) -> f64 {
    let mut largest = 0.0f64;
    if old.dt == 0.0 {
        return largest;
    }
    // Slip without friction has no onset.
    for k in (0..model.contacts.len()).filter(|&k| model.contacts[k].laws.iter().any(|law| law.stiffness() > 0.0)) {
        let [before, after] = [old, new].map(|state| Directions::of(model, k, state));
        if before.contact == after.contact {
            continue;
        }
        let lost = new.dt / old.dt;
        for (k, (old, new)) in old.contacts[k].iter().zip(&new.contacts[k]).enumerate() {
            if before.points[k] != after.points[k] {
                largest = largest.max(slip(new).abs());
            }
            if before.points[k] != 0.0 && before.points[k] != after.points[k] {
                largest = largest.max(slip(old).abs() * lost);
            }
        }
    }
    largest
}

/// Plastic slip of the last increment where a point slips, else 0 [L].
fn slip(state: &ContactState) -> f64 {
    if state.regime() == Regime::Slip { state.friction.plastic_increment } else { 0.0 }
}

/// Which way a contact slips at the end of an increment: ±1 along ±s, 0 if it does not, or has just come to rest.
struct Directions {
    points: Vec<f64>,
    contact: f64,
}

impl Directions {
    fn of(model: &Model, contact: usize, state: &State) -> Self {
        let (pair, states) = (&model.contacts[contact], &state.contacts[contact]);
        if states.iter().all(|state| slip(state) == 0.0) {
            return Self { points: vec![0.0; states.len()], contact: 0.0 };
        }
        let x = model.configuration(&state.displacement);
        let rates = pair.slip_rates(states, &x, &state.velocity);
        let going = |(state, rate): (&ContactState, &f64)| if slip(state) * rate > 0.0 { rate.signum() } else { 0.0 };
        let points: Vec<f64> = states.iter().zip(&rates).map(going).collect();
        let (mut closed, mut forward) = (0.0, 0.0);
        for k in (0..states.len()).filter(|&k| states[k].regime() != Regime::Open) {
            let length = pair.points[k].current_length(&x);
            closed += length;
            forward += length * points[k];
        }
        let contact = if f64::abs(forward) > 0.5 * closed { forward.signum() } else { 0.0 };
        Self { points, contact }
    }
}
