//! Contact closure within a static increment: limits its length so that friction after closure is known.
//!
//! - A point that was open at the start of an increment has slipped in part before closure. That part lies between zero and its
//!   value had the previous motion continued until closure; the uncertainty of friction caused by it, summed over the points of
//!   a contact, must not exceed 2 % of the contact force. With 5 % a ring that rolls in a bore takes
//!   three fifths of the solves, and the shear of pressed cylinders alternates nine times as much from point to point. Where surfaces slide at the friction limit anyway, nothing is
//!   uncertain. Where surfaces dilate, the opening by slip after closure is uncertain, too: they do not dilate in the increment
//!   in which they close (`contact/force.rs`).
//! - Otherwise the increment is subdivided: up to the predicted closure if nothing of the contact was closed before, else
//!   as far as few enough points close; then on to its intended end. The contact force is the largest of all attempts at the
//!   increment. The next increment is subdivided from the start, into parts as long as the longest of this one, or twice as long if
//!   none was rejected: where contact advances, as under a wheel, it meets closures as well.
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
            return (judged, uncertainty);
        };
        self.longest = self.longest.max(new.dt);
        let left = end - new.time;
        if left > step.increments.min {
            // Where points close one after the other, the uncertainty grows with Δt².
            let share = (AIM * UNCERTAINTY / uncertainty).sqrt().clamp(LEAST_SHARE, GROWTH);
            let next = if touches { left } else { left.min(share * new.dt) };
            return (Judgement { next, ..judged }, uncertainty);
        }
        let next = if self.was_refused { self.longest } else { GROWTH * self.longest };
        self.give_up();
        let end = (new.time + dt).min(step.span.end);
        if next < dt && end - new.time > step.increments.min {
            self.whole = Some((end, dt));
            return (Judgement { next, ..judged }, uncertainty);
        }
        (Judgement { next: dt, ..judged }, uncertainty)
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
        let mut uncertainty = 0.0f64;
        let (mut share, mut meets) = (1.0f64, false);
        for (k, pair) in model.contacts.iter().enumerate() {
            let states = old.contacts[k].iter().zip(&foreseen[k]).zip(&new.contacts[k]).zip(&pair.points);
            let arrival = |(((old, foreseen), now), slave)| pair.arrival(slave, [old, foreseen, now], new.time, new.dt);
            let unknown = Some(Arrival { at: 0.0, uncertainty: f64::INFINITY });
            let arrivals: Vec<Arrival> = states.filter_map(|states| arrival(states).unwrap_or(unknown)).collect();
            let force = |state: &ContactState| state.contact_pressure().hypot(state.shear()) * state.length;
            self.forces[k] = self.forces[k].max(new.contacts[k].iter().map(force).sum());
            let all: f64 = arrivals.iter().map(|arrival| arrival.uncertainty).sum();
            if all > 0.0 {
                uncertainty = uncertainty.max(all / self.forces[k]);
                let first = arrivals.iter().fold(1.0, |first: f64, arrival| first.min(arrival.at));
                let meets_first = first > 0.0 && old.contacts[k].iter().all(|state| !state.is_closed());
                let most = if meets_first { first } else { longest(&arrivals, AIM * UNCERTAINTY * self.forces[k]) };
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

/// Fraction of an increment in which the uncertain force is at most `allowed`, if the force of each point grows linearly
/// after its closure.
fn longest(arrivals: &[Arrival], allowed: f64) -> f64 {
    let uncertainty =
        |share: f64| -> f64 { arrivals.iter().map(|a| a.uncertainty * ((share - a.at) / (1.0 - a.at)).max(0.0)).sum() };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if uncertainty(middle) > allowed { high = middle } else { low = middle }
    }
    low
}
