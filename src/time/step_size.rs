//! Step-size control: acceptance of a solved increment, and the length of the next attempt.
//!
//! Without error control every solved increment is accepted, and the next one is longer if few tangents were needed
//! (corrections with an old tangent do not count: whether they are made is a question of cost). Static increments must also
//! resolve friction after closure ([`super::touching`]).
//!
//! With error control of a static step, the slip of every closed point is in error by at most ε in an increment, by the
//! estimate ½ Δt |v₁ − v₀| with the mean rates v of plastic slip in this increment and the last: time-dependent laws are
//! integrated to first order. As it falls with Δt², the next attempt takes Δt (ε/e)^½, with a safety factor.
//!
//! Friction whose state evolves with slip and time, such as rate-and-state friction, has this control by default, with ε a
//! fraction of its D_c, in implicit steps as well: where slip is unstable, increments that are too long damp the instability
//! away, without any other sign. Vibrations that such increments do not resolve are left to the damping of the scheme.
//!
//! With error control of a dynamic step, ε being the allowed error:
//!
//! - The estimated local error e of [`crate::model::scheme`] must not exceed ε in any free displacement. As e falls with Δt³,
//!   the next attempt takes Δt (ε/e)^⅓, with a safety factor. Accepted increments keep their length where the gain is small.
//! - An increment in which a contact as a whole starts to slip, stops or reverses is repeated with half its length until no
//!   participating point slips by more than 10 ε in it: the event is then located to 10 ε of displacement. A point's direction
//!   is ±1, that of its plastic slip, if its slip rate at the end of the increment still has that sign, otherwise 0; a contact
//!   has the mean direction of its points if the mean over the closed length exceeds ½ in magnitude. A point's slip is its
//!   plastic slip in the increment and, if it slipped before, its slip at the last rate. A contact that oscillates while
//!   sticking therefore has no events.
//! - An increment after a repeated one does not grow. Accepted halves thus approach the event without passing it, and
//!   every attempt either advances or halves the increment.
//! - Lengths are those of a ladder (below), whichever way the equations are solved. An increment that took many tangents does not grow.
//! - The shortest increment is accepted whatever its error; a warning reports an error above ε.
//!
//! Nothing much larger than ε can pass undetected: e is a fixed fraction, a quarter or more unless β is near 1/6, of the
//! difference between the new displacement and the one extrapolated with the old velocity and acceleration ((6) of
//! [`crate::model::scheme`]), and a slip, an arrest or an impact contributes its full displacement. Only what begins and ends
//! within one increment, such as a short load pulse, needs a suitable `max`.
//!
//! # Ladder
//!
//! The ladder is a set of increment lengths that recur, in every dynamic step under error control: where linear bodies are condensed
//! on contacts, the elimination for one length serves all increments of that length.
//!
//! ```text
//! Δt = Δt₀ 2^(k/4),  k whole;   Δt₀: the initial increment of the step
//! ```
//!
//! Lengths are rounded down by a fifth at most, a tenth on average.

use crate::contact::force::ContactState;
use crate::laws::friction::Regime;
use crate::model::{Increments, Model, State, Step};

/// Number of tangents, in every augmentation, up to which an increment counts as easy and the next one may be longer.
const EASY: usize = 4;
/// Growth of the increment after an easy one.
const GROWTH: f64 = 1.5;
/// Accuracy of an event, in multiples of the allowed error.
pub const EVENT_LOCATION: f64 = 10.0;
/// Safety factor on the length that the error allows; the estimate is one of several error terms.
const SAFETY: f64 = 0.8;
/// Strongest reduction of the next attempt by one estimate: far from the solution the estimate is not of third order.
pub(super) const LEAST_SHARE: f64 = 0.1;
/// Smallest useful change of length: increments of constant length keep the order of the scheme.
const WORTHWHILE: f64 = 1.25;

/// Strongest growth by one estimate of the next attempt at the rest of a subdivided increment.
const MOST_SHARE: f64 = 4.0;
/// Strongest growth from one increment to the next while water flows: two-step formulas are stable below 1 + √2.
const MOST_OF_FLOW: f64 = 2.0;
/// Relative remainder of a step that is not worth another increment.
const ROUND_OFF: f64 = 1e-6;

/// An increment counts as the shortest up to this multiple of it: distributing the rest of a step stretches it by less, and
/// the times at its ends are rounded.
const SHORTEST: f64 = 1.0 + 10.0 * ROUND_OFF;

/// Decision about a solved increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement {
    /// Whether it is accepted or repeated
    pub accepted: bool,
    /// Δt of the next attempt, before the bounds of the step [T]
    pub next: f64,
    /// Estimated local error, in steps under error control
    pub error: Option<LocalError>,
}

/// Estimated error of an increment, of a displacement or of slip, and what is allowed [L].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalError {
    /// estimate
    pub estimate: f64,
    /// allowed error
    pub allowed: f64,
}

impl LocalError {
    /// Of what is not controlled.
    const NONE: Self = Self { estimate: 0.0, allowed: f64::INFINITY };

    /// Whether it is above what is allowed.
    pub fn is_excessive(&self) -> bool {
        self.estimate > self.allowed
    }

    /// ε/e: by how much it could grow.
    fn room(&self) -> f64 {
        self.allowed / self.estimate
    }

    /// The one with less room.
    fn worse(self, other: Self) -> Self {
        if other.room() < self.room() { other } else { self }
    }
}

impl Judgement {
    /// Adjusts the decision after an increment that was shortened only to end at an output time: the next one is not shortened
    /// for that reason.
    pub fn after_output(self, attempt: usize, dt: f64, wanted: f64) -> Self {
        let shortened = attempt == 1 && self.accepted && dt < wanted && self.next >= dt;
        Self { next: if shortened { self.next.max(wanted) } else { self.next }, ..self }
    }
}

/// Δt of the next attempt within the bounds of the step. The last increment ends at the end of the step; under error
/// control the last two divide the remainder evenly, so that none is much shorter than the one before. The same applies to
/// an increment that must end earlier, at a time of `output`.
pub fn bounded(step: &Step, time: f64, dt: f64, output: Option<f64>) -> f64 {
    let output = output.filter(|output| *output < step.span.end);
    let remaining = output.unwrap_or(step.span.end) - time;
    let dt = dt.min(step.increments.max);
    let left = (remaining / dt - ROUND_OFF).ceil().max(1.0);
    let shared = if step.increments.are_controlled() || output.is_some() { 2.0 } else { 1.0 };
    if left <= shared { remaining / left } else { dt }
}

/// Whether an increment is longer than the shortest.
pub(super) fn can_shorten(step: &Step, old: &State, new: &State) -> bool {
    new.time > old.time + SHORTEST * step.increments.min
}

/// Judges a solved increment from `old` to `new` with the number of `tangents` of its hardest augmentation; `repeated` says
/// that an attempt at it was rejected before.
pub fn judge(model: &Model, step: &Step, states: [&State; 2], tangents: usize, repeated: bool) -> Judgement {
    let easy = tangents <= EASY;
    match step.increments.are_controlled() {
        false => judge_flow(step, states, [easy, repeated]),
        true if step.scheme.is_dynamic() => judge_motion(model, step, states, easy && !repeated),
        true => judge_slip(model, step, states, repeated),
    }
}

/// Judges an increment without error control: by the error of water that flows along contacts alone, if any does.
fn judge_flow(step: &Step, [old, new]: [&State; 2], [easy, repeated]: [bool; 2]) -> Judgement {
    let grown = |growth: f64| new.dt * growth;
    let Some(error) = flow_error(new) else {
        return Judgement { accepted: true, next: if easy { grown(GROWTH) } else { new.dt }, error: None };
    };
    let may_grow = easy && !repeated;
    let share = (SAFETY * error.room().sqrt()).clamp(LEAST_SHARE, GROWTH);
    let accepted = !can_shorten(step, old, new) || !error.is_excessive();
    let next = match accepted {
        true if may_grow => grown(share.max(1.0)),
        true => new.dt,
        false => grown(share).max(step.increments.min),
    };
    Judgement { accepted, next, error: Some(error) }
}

/// The worst error of the pressure of water by what surfaces do within an increment, over the allowed one; `None` where no water flows.
fn flow_error(new: &State) -> Option<LocalError> {
    let flowing = new.conduits.iter().filter(|water| !water.pressure.is_empty());
    let worst = flowing.map(|water| LocalError { estimate: water.uncertainty, allowed: 1.0 });
    worst.reduce(LocalError::worse)
}

/// Judges a static increment by the error of slip.
fn judge_slip(model: &Model, step: &Step, [old, new]: [&State; 2], repeated: bool) -> Judgement {
    let slip = slip_error(model, step, [old, new]).worse(pressure_error(model, step, [old, new]));
    let error = flow_error(new).map_or(slip, |flow| slip.worse(flow));
    let most = if model.flow.is_some() { MOST_OF_FLOW } else { MOST_SHARE };
    let share = (SAFETY * error.room().sqrt()).clamp(LEAST_SHARE, most);
    let accepted = !can_shorten(step, old, new) || !error.is_excessive();
    let keeps = accepted && (repeated || share <= WORTHWHILE);
    let next = if keeps { new.dt } else { (share * new.dt).max(step.increments.min) };
    Judgement { accepted, next, error: Some(error) }
}

/// Judges a dynamic increment by the error of displacements and its events, and by the error of slip.
fn judge_motion(model: &Model, step: &Step, [old, new]: [&State; 2], may_grow: bool) -> Judgement {
    let (dt, shortest) = (new.dt, step.increments.min);
    let motion = step.increments.error.map_or(LocalError::NONE, |allowed| {
        let estimate = local_error(model, step, old, new);
        LocalError { estimate, allowed }
    });
    let slip = slip_error(model, step, [old, new]).worse(pressure_error(model, step, [old, new]));
    let slip = flow_error(new).map_or(slip, |flow| slip.worse(flow));
    let error = motion.worse(slip);
    let share = (SAFETY * motion.room().cbrt().min(slip.room().sqrt())).clamp(LEAST_SHARE, GROWTH);
    let judged = |accepted: bool, next: f64| Judgement { accepted, next, error: Some(error) };
    let can_shorten = can_shorten(step, old, new);
    if can_shorten && error.is_excessive() {
        return judged(false, (share * dt).max(shortest));
    }
    let location = step.increments.error.filter(|_| can_shorten).map(|allowed| EVENT_LOCATION * allowed);
    if location.is_some_and(|location| slip_at_events(model, old, new) > location) {
        return judged(false, (0.5 * dt).max(shortest));
    }
    let grows = may_grow && share > WORTHWHILE;
    judged(true, if grows { share * dt } else { dt })
}

/// Highest slip rate of a contact point with friction from one state to a later one [L/T].
pub fn fastest_slip(model: &Model, old: &State, new: &State) -> f64 {
    let mut fastest = 0.0f64;
    for (pair, (old, new)) in model.contacts.iter().zip(old.contacts.iter().zip(&new.contacts)) {
        for (slave, (old, new)) in pair.points.iter().zip(old.iter().zip(new)) {
            // Frictionless contacts have no rupture.
            if !pair.law(slave).description.is_frictionless {
                fastest = fastest.max((new.friction.plastic_slip - old.friction.plastic_slip).abs());
            }
        }
    }
    fastest / (new.time - old.time)
}

/// C Δt² |a₁ − a₀|, the largest of all free dofs; dofs without mass follow without an error of their own [L].
fn local_error(model: &Model, step: &Step, old: &State, new: &State) -> f64 {
    let constant = step.scheme.error_constant().unwrap_or(0.0);
    let rates = new.acceleration.iter().zip(&old.acceleration).enumerate();
    let heavy = rates.filter(|(dof, _)| !model.massless[dof / 2]);
    let free = heavy.filter(|(dof, _)| step.support_at(*dof).is_none());
    let change = free.fold(0.0, |largest: f64, (_, (new, old))| largest.max((new - old).abs()));
    let across = step.supports.iter().filter_map(|support| support.at.across());
    let across = across.filter(|at| !model.massless[at.node()]);
    let change = across.fold(change, |most, at| most.max((at.of(&new.acceleration) - at.of(&old.acceleration)).abs()));
    constant * new.dt.powi(2) * change
}

/// ½ Δt |v₁ − v₀| of a point, with the rates of plastic slip v in an increment of length Δt and in the last one; 0 unless it is
/// closed at both ends [L].
pub fn error_of_slip([before, after]: [&ContactState; 2], [last, dt]: [f64; 2]) -> f64 {
    let rate = |state: &ContactState, dt: f64| if dt > 0.0 { state.friction.plastic_increment / dt } else { 0.0 };
    let closed = before.friction.pressure > 0.0 && after.friction.pressure > 0.0;
    if closed { 0.5 * dt * (rate(after, dt) - rate(before, last)).abs() } else { 0.0 }
}

/// The worst [`error_of_slip`] of all points. A given error is that of slip in static steps only, and otherwise of slip that
/// is integrated to first order.
fn slip_error(model: &Model, step: &Step, [old, new]: [&State; 2]) -> LocalError {
    let Increments { error, slip, .. } = step.increments;
    let mut worst = LocalError::NONE;
    for (pair, states) in model.contacts.iter().zip(old.contacts.iter().zip(&new.contacts)) {
        for (slave, (before, after)) in pair.points.iter().zip(states.0.iter().zip(states.1)) {
            let law = &pair.law(slave).description;
            let given = error.filter(|_| !step.scheme.is_dynamic() || law.critical_slip.is_some());
            let share = law.critical_slip.zip(slip).map(|(critical, share)| share * critical);
            if let Some(allowed) = given.into_iter().chain(share).reduce(f64::min).filter(|_| !law.is_frictionless) {
                let estimate = error_of_slip([before, after], [old.last_dt(), new.dt]);
                worst = worst.worse(LocalError { estimate, allowed });
            }
        }
    }
    worst
}

/// ½ Δt |ṗ₁ − ṗ₀| of the pressures of water that flows, with the rates in the increment and in the last one of the step; the first has none, nor has
/// one that begins anew.
fn pressure_error(model: &Model, step: &Step, [old, new]: [&State; 2]) -> LocalError {
    let last = old.last_increment.as_ref().filter(|last| last.ratio(new.dt).is_some());
    let (Some(allowed), Some(flow), Some(last)) = (step.increments.pore_pressure, &model.flow, last) else {
        return LocalError::NONE;
    };
    let of = |k: usize| {
        let dof = flow.dof(k);
        let rate = (new.displacement[dof] - old.displacement[dof]) / new.dt - last.displacement[dof] / last.dt;
        0.5 * new.dt * flow.scales[k] * rate.abs()
    };
    let estimate = (0..flow.count()).map(of).fold(0.0, f64::max);
    LocalError { estimate, allowed }
}

/// Largest slip in the increment of a point that participates in an event of its contact; 0 if there is none, and in the
/// first increment of a run, which may start sliding [L].
fn slip_at_events(model: &Model, old: &State, new: &State) -> f64 {
    let mut largest = 0.0f64;
    if old.last_dt() == 0.0 {
        return largest;
    }
    // Frictionless slip has no onset.
    for k in
        (0..model.contacts.len()).filter(|&k| model.contacts[k].laws.iter().any(|law| !law.description.is_frictionless))
    {
        let [before, after] = [old, new].map(|state| Directions::of(model, k, state));
        if before.contact == after.contact {
            continue;
        }
        let lost = new.dt / old.last_dt();
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

/// Plastic slip of the last increment where a point slips, otherwise 0 [L].
fn slip(state: &ContactState) -> f64 {
    if state.regime() == Regime::Slip { state.friction.plastic_increment } else { 0.0 }
}

/// Direction of slip of a contact at the end of an increment: ±1 along ±s, 0 if it does not slip, or has just stopped.
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

/// 2^(k/4), k = 0 … 3.
const FRACTIONS: [f64; 4] = [1.0, 1.189_207_115_002_721, std::f64::consts::SQRT_2, 1.681_792_830_507_429];

/// Relative round-off allowed in comparing with a length of the ladder.
const LADDER_ROUND_OFF: f64 = 1e-12;

/// Δt of the next attempt, from the length that the error of a dynamic step or its iterations require.
pub fn on_ladder(step: &Step, dt: f64) -> f64 {
    let Increments { initial, min, .. } = step.increments;
    let climbs = step.scheme.is_dynamic() && step.increments.are_controlled();
    if climbs { standard_length(initial, dt).max(min) } else { dt }
}

/// Longest length of the ladder starting at `first` that does not exceed `dt`.
fn standard_length(first: f64, dt: f64) -> f64 {
    let reached = dt * (1.0 + LADDER_ROUND_OFF);
    if !(first.is_normal() && dt.is_normal() && first > 0.0 && dt > 0.0) {
        return dt;
    }
    let mut octave = first;
    while octave > reached {
        octave *= 0.5;
    }
    while 2.0 * octave <= reached {
        octave *= 2.0;
    }
    FRACTIONS
        .iter()
        .map(|standard_length| standard_length * octave)
        .rfind(|standard_length| *standard_length <= reached)
        .unwrap_or(octave)
}
