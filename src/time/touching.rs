//! Contact closure within a static increment: limits its length so that friction after closure is known.
//!
//! - A point that was open at the start of an increment has slipped in part before closure. That part lies between zero and its
//!   value had the previous motion continued until closure; the uncertainty of friction caused by it, summed over the points of
//!   a contact, must not exceed 2 % of the contact force. With 5 % a ring that rolls in a bore takes
//!   three fifths of the solves, and the shear of pressed cylinders alternates nine times as much from point to point. Where surfaces slide at the friction limit anyway, nothing is
//!   uncertain. Where surfaces dilate, the opening by slip after closure is uncertain, too: they do not dilate in the increment
//!   in which they close (`contact/force.rs`).
//! - Otherwise the increment is subdivided: up to the predicted closure if nothing of the contact was closed before, else
//!   as far as few enough points close. The contact force is the largest of all attempts at the increment. The increments that follow
//!   are no longer than it was meant to be, and begin as long as its longest part, or twice as long if none was rejected: where
//!   contact advances, as under a wheel, they meet closures as well.
//! - As soon as such a part is rejected as well, in which points open, as behind a wheel, each increment ends just beyond the next closure. (Where
//!   contact only grows, shear that is locked in would alternate from point to point.) The closure is foreseen from the gaps and
//!   the rates at which they close, and comes later in the ratio in which the last one did; from then on friction becomes uncertain at the
//!   rate at which it did after the last one, up to half of what is allowed.
//! - The shortest increment is accepted whatever its uncertainty; a warning reports it.
//! - A point that closes and opens again within one increment is not detected.

use serde::{Deserialize, Serialize};

use super::step_size::{Judgement, LEAST_SHARE, can_shorten};
use crate::contact::force::ContactState;
use crate::contact::pair::Arrival;
use crate::model::{Model, State, Step};

/// Largest uncertain fraction of a contact's force in a static increment in which points closed.
pub const UNCERTAINTY: f64 = 0.02;
/// Fraction of that limit at which the next attempt aims.
const AIM: f64 = 0.5;
/// Largest growth of the parts of a subdivided increment.
const GROWTH: f64 = 2.0;
/// Number of bisections that locate the end of an increment; sufficient for round-off.
const HALVINGS: usize = 50;

/// Information on contact closure from the attempts at a static increment.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Touching {
    /// End and length of the subdivided increment [T]
    whole: Option<(f64, f64)>,
    /// Largest force of each contact in all attempts [F]
    forces: Vec<f64>,
    /// Number of rejected attempts
    refused: usize,
    /// Whether the attempt ends at the closure of a contact
    ends_in_touch: bool,
    /// Longest part of the subdivided increment so far [T]
    longest: f64,
    /// Whether a part of it was rejected
    was_refused: bool,
    /// Whether a part was rejected whose length followed from the one before, and in which points opened: from then on increments follow the
    /// closures
    follows: bool,
    /// How points of each contact close in subdivided increments
    advances: Vec<Advance>,
}

/// How points of a contact close one after the other.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Advance {
    /// Rate at which friction became uncertain after the last closures [F/T]; 0 before the first
    growth: f64,
    /// How much later than foreseen they came, as a ratio of times; `None` before the second
    delay: Option<f64>,
    /// When the next one was foreseen, after the last, and for when [T]
    foreseen: Option<(f64, f64)>,
}

impl Touching {
    /// Judges a solved increment that is otherwise accepted; `foreseen` are the contact states for continued previous motion, those
    /// at the end of the increment where none were. The judgement contains the uncertain fraction of a contact's force.
    pub fn judge(
        &mut self,
        model: &Model,
        step: &Step,
        old: &State,
        new: &mut State,
        foreseen: Option<&[Vec<ContactState>]>,
        judged: Judgement,
    ) -> (Judgement, f64) {
        let (uncertainty, share, meets) = self.uncertainty(model, [old, new], foreseen.unwrap_or(&new.contacts));
        if uncertainty > UNCERTAINTY && can_shorten(step, old, new) {
            self.follows |= self.whole.is_some() && self.refused == 0 && moves_on(model, [old, new]);
            self.whole.get_or_insert((new.time, new.dt));
            // A rejected attempt shows that the prediction was inaccurate.
            let most = if self.refused == 0 { 1.0 } else { 0.5 };
            self.refused += 1;
            self.was_refused = true;
            self.ends_in_touch = meets;
            let share = if meets { share } else { share.max(LEAST_SHARE) };
            let next = (share.min(most) * new.dt).max(step.increments.min);
            return (Judgement { accepted: false, next, ..judged }, uncertainty);
        }
        self.refused = 0;
        let touches = std::mem::take(&mut self.ends_in_touch);
        if let Some(last) = &mut new.last_increment {
            last.ends_in_touch = touches;
        }
        let Some((end, dt)) = self.whole else {
            self.forces.clear();
            self.advances.clear();
            return (judged, uncertainty);
        };
        self.longest = self.longest.max(new.dt);
        let next = self.until_next_closure(model, [old, new]).filter(|_| self.follows);
        let left = end - new.time;
        if left > step.increments.min {
            // Where points close one after the other, the uncertainty grows with Δt².
            let share = (AIM * UNCERTAINTY / uncertainty).sqrt().clamp(LEAST_SHARE, GROWTH);
            let next = match next {
                Some(next) if !touches => dt.min(next),
                _ if touches => left,
                _ => left.min(share * new.dt),
            };
            return (Judgement { next, ..judged }, uncertainty);
        }
        let longest = if self.was_refused { self.longest } else { GROWTH * self.longest };
        let next = next.unwrap_or(longest);
        let (follows, advances) = (self.follows, std::mem::take(&mut self.advances));
        self.give_up();
        let end = (new.time + dt).min(step.span.end);
        if next < dt && end - new.time > step.increments.min {
            (self.whole, self.follows, self.advances) = (Some((end, dt)), follows, advances);
            return (Judgement { next, ..judged }, uncertainty);
        }
        (Judgement { next: dt, ..judged }, uncertainty)
    }

    /// Length of an increment to just beyond the next closure, `None` where none is foreseen or none has come [T].
    ///
    /// ```text
    /// Δt = ρ τ + ½ ε F/u̇          τ = min g/(−ġ) over open points, ρ: delay; u̇: growth of what is uncertain, ε F: what is allowed of it
    /// ```
    fn until_next_closure(&mut self, model: &Model, [old, new]: [&State; 2]) -> Option<f64> {
        let contacts = model.contacts.iter().zip(&self.forces).zip(old.contacts.iter().zip(&new.contacts));
        let mut least: Option<f64> = None;
        for (advance, ((pair, force), states)) in self.advances.iter_mut().zip(contacts) {
            let first = states.0.iter().zip(states.1).filter_map(|(old, now)| {
                let approach = old.clearance() - now.clearance();
                let comes = now.is_separated(pair.touch) && approach > 0.0 && approach.is_finite();
                comes.then(|| new.dt * now.clearance() / approach)
            });
            let Some(first) = first.reduce(f64::min).filter(|_| advance.growth > 0.0) else { continue };
            advance.foreseen.get_or_insert((new.time, new.time + first));
            let delay = advance.delay.unwrap_or(1.0);
            let next = delay * first + AIM * UNCERTAINTY * force / advance.growth;
            least = Some(least.map_or(next, |least| least.min(next)));
        }
        least
    }

    /// Largest uncertain fraction of a contact's force; the fraction of the increment for which it is small enough, and whether
    /// the increment ends there at the first closure of a contact.
    fn uncertainty(
        &mut self,
        model: &Model,
        [old, new]: [&State; 2],
        foreseen: &[Vec<ContactState>],
    ) -> (f64, f64, bool) {
        self.forces.resize(model.contacts.len(), 0.0);
        self.advances.resize(model.contacts.len(), Advance::default());
        let mut uncertainty = 0.0f64;
        let (mut share, mut meets) = (1.0f64, false);
        for (k, pair) in model.contacts.iter().enumerate() {
            let states = old.contacts[k].iter().zip(&foreseen[k]).zip(&new.contacts[k]).zip(&pair.points);
            let arrival = |(((old, foreseen), now), slave)| pair.arrival(slave, [old, foreseen, now], new.time, new.dt);
            let unknown = Some(Arrival { at: 0.0, came: 0.0, uncertainty: f64::INFINITY });
            let mut arrivals: Vec<Arrival> = states.filter_map(|states| arrival(states).unwrap_or(unknown)).collect();
            let force = |state: &ContactState| state.contact_pressure().hypot(state.shear()) * state.length;
            self.forces[k] = self.forces[k].max(new.contacts[k].iter().map(force).sum());
            self.advances[k].note(&arrivals, new.time - new.dt, new.dt);
            arrivals.retain(|arrival| arrival.uncertainty > 0.0);
            let all: f64 = arrivals.iter().map(|arrival| arrival.uncertainty).sum();
            if all > 0.0 {
                uncertainty = uncertainty.max(all / self.forces[k]);
                let first = arrivals.iter().fold(1.0, |first: f64, arrival| first.min(arrival.at));
                let meets_first = first > 0.0 && old.contacts[k].iter().all(|state| !state.is_closed());
                let most = if meets_first {
                    first
                } else {
                    longest(&arrivals, AIM * UNCERTAINTY * self.forces[k], self.follows)
                };
                if most < share {
                    (share, meets) = (most, meets_first);
                }
            }
        }
        (uncertainty, share, meets)
    }

    /// Records that the attempt could not be solved and is shortened.
    pub fn cut(&mut self) {
        self.ends_in_touch = false;
    }

    /// Resets after the increment is repeated for other reasons.
    pub fn give_up(&mut self) {
        *self = Self::default();
    }
}

/// Whether a contact opens somewhere in an increment.
fn moves_on(model: &Model, [old, new]: [&State; 2]) -> bool {
    let contacts = model.contacts.iter().zip(old.contacts.iter().zip(&new.contacts));
    contacts.into_iter().any(|(pair, (old, new))| {
        let mut states = old.iter().zip(new);
        states.any(|(old, new)| old.is_closed() && new.is_separated(pair.touch))
    })
}

/// Bounds of the delay of a closure.
const DELAYS: [f64; 2] = [0.25, 4.0];

impl Advance {
    /// Records the closures in an increment from a time, accepted or not.
    fn note(&mut self, arrivals: &[Arrival], from: f64, dt: f64) {
        let known = || arrivals.iter().filter(|arrival| arrival.came < 1.0 && arrival.uncertainty.is_finite());
        let Some(first) = known().map(|arrival| arrival.came).reduce(f64::min) else { return };
        let rate = |arrival: &Arrival| arrival.uncertainty / ((1.0 - arrival.came) * dt);
        self.growth = known().map(rate).fold(0.0, f64::max);
        if let Some((made, expected)) = self.foreseen.take() {
            let delay = (from + first * dt - made) / (expected - made);
            self.delay = Some(delay.clamp(DELAYS[0], DELAYS[1]));
        }
    }
}

/// Fraction of an increment in which the uncertain force is at most `allowed`, if the force of each point grows linearly
/// after its closure: as foreseen, or as it came.
fn longest(arrivals: &[Arrival], allowed: f64, as_it_came: bool) -> f64 {
    let at = |arrival: &Arrival| if as_it_came { arrival.came } else { arrival.at };
    let uncertainty = |share: f64| -> f64 {
        arrivals.iter().map(|a| a.uncertainty * ((share - at(a)) / (1.0 - at(a))).max(0.0)).sum()
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if uncertainty(middle) > allowed { high = middle } else { low = middle }
    }
    low
}
