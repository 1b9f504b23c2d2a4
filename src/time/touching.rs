//! How far a static increment goes in which points touch: friction after touch must be known.
//!
//! - A point that was apart at the start of an increment has slipped in part before it touched. That part lies between
//!   nothing and what it would have been had the motion before the increment gone on until touch; what friction may have to do
//!   with it, summed over the points of a contact, must not exceed 2 % of its force. Where points slide at the limit of
//!   friction anyway, nothing is in doubt. Where surfaces dilate, what the slip after touch would have lifted is in doubt, too: they
//!   do not ride up on each other in the increment in which they meet (`contact/force.rs`).
//! - Else the increment is made in parts: up to the touch that was foreseen if nothing of the contact was closed before, else
//!   as far as few enough points touch; then on to where it should have ended. The contact's force is the largest of
//!   all attempts at the increment.
//! - The shortest increment is accepted whatever its doubt, which is told as a warning.
//! - A point that touches and parts again within one increment is not seen.

use serde::{Deserialize, Serialize};

use super::step_size::{Judgement, LEAST_SHARE, MOST_SHARE, can_shorten};
use crate::contact::force::ContactState;
use crate::contact::pair::Arrival;
use crate::model::state::State;
use crate::model::{Model, Step};

/// Share of a contact's force that may be in doubt after a static increment in which points touched.
pub const DOUBT: f64 = 0.02;
/// Part of that which the next attempt aims at.
const AIM: f64 = 0.5;
/// Halvings of an increment that find where to end it: as many as it takes for round-off.
const HALVINGS: usize = 50;

/// Knowledge about contact closure from the attempts at an increment of a static step.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
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
        let (doubt, share, meets) = self.doubt(model, [old, new], foreseen);
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

    /// The largest share of a contact's force that is in doubt; how far the increment may go for little enough of it, as a share
    /// of it, and whether it ends there in the first touch of a contact.
    fn doubt(&mut self, model: &Model, [old, new]: [&State; 2], foreseen: &[Vec<ContactState>]) -> (f64, f64, bool) {
        self.forces.resize(model.contacts.len(), 0.0);
        let mut doubt = 0.0f64;
        let (mut share, mut meets) = (1.0f64, false);
        for (k, pair) in model.contacts.iter().enumerate() {
            let states = old.contacts[k].iter().zip(&foreseen[k]).zip(&new.contacts[k]).zip(&pair.points);
            let arrival = |(((old, foreseen), now), slave)| pair.arrival(slave, [old, foreseen, now], new.time, new.dt);
            let unknown = Some(Arrival { at: 0.0, doubt: f64::INFINITY });
            let arrivals: Vec<Arrival> = states.filter_map(|states| arrival(states).unwrap_or(unknown)).collect();
            let force = |state: &ContactState| state.friction.pressure.hypot(state.friction.traction) * state.length;
            self.forces[k] = self.forces[k].max(new.contacts[k].iter().map(force).sum());
            let all: f64 = arrivals.iter().map(|arrival| arrival.doubt).sum();
            if all > 0.0 {
                doubt = doubt.max(all / self.forces[k]);
                let first = arrivals.iter().fold(1.0, |first: f64, arrival| first.min(arrival.at));
                let meets_first = first > 0.0 && old.contacts[k].iter().all(|state| !state.is_closed());
                let most = if meets_first { first } else { longest(&arrivals, AIM * DOUBT * self.forces[k]) };
                if most < share {
                    (share, meets) = (most, meets_first);
                }
            }
        }
        (doubt, share, meets)
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
