//! What the points of an interface did so far: when fronts passed them, in which events.

use serde::{Deserialize, Serialize};

use super::events::{Energies, Mark, SlipEvent};
use super::wave_speeds::WaveSpeeds;
use crate::contact::force::ContactState;
use crate::contact::pair::ContactPair;
use crate::model::Model;
use crate::model::state::State;

/// A point of the slave surface: where it is, and what it did so far.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Point {
    /// Number of its unbroken line
    pub line: usize,
    /// Distance along the line [L]
    pub position: f64,
    pub at: [f64; 2],
    /// Length that the point stands for [L]
    pub length: f64,
    /// Whether it has friction: what slides freely has no fronts
    pub rubs: bool,
    /// What it was left with by the last increment
    pub mark: Mark,
    /// Slip rate of that increment [L/T], and what an arrival is told by (see [`Arrive`])
    pub rate: f64,
    pub signal: f64,
    pub arrivals: Vec<Arrival>,
}

/// When a front passed a point.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Arrival {
    /// [T]
    pub time: f64,
    /// Number of the event of the contact, from 1; 0 outside of events
    pub event: usize,
    /// What loads and stored energies had given since the start of the run [F·L]
    pub given: f64,
}

/// The points of one contact.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Interface {
    pub name: String,
    pub speeds: Option<WaveSpeeds>,
    pub points: Vec<Point>,
    /// Events so far; the last one may not be over
    pub events: Vec<SlipEvent>,
}

/// What tells that a front arrives at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Arrive {
    /// The slip rate passes that of a front from below.
    Rate,
    /// R passes a value from below.
    R(f64),
    /// μ passes a value from above.
    Mu(f64),
}

/// An increment as fronts see it.
#[derive(Clone, Copy)]
pub(super) struct Passing<'a> {
    /// Slip rate of a front [L/T]
    pub threshold: f64,
    pub arrive: Arrive,
    /// Time and energies of the model at the ends of the last two increments
    pub last: [(f64, Energies); 2],
    /// State at the end of this one
    pub after: &'a State,
}

/// An event of a contact: its arrivals in order of time, each with the length that it had broken by then.
#[derive(Clone, Debug, Default)]
pub(super) struct Event {
    pub reached: Vec<(Arrival, f64)>,
}

impl Event {
    /// Rupture length and energy released by an arrival of the event [L, F·L].
    pub fn by(&self, arrival: &Arrival) -> (f64, f64) {
        let until = self.reached.partition_point(|(other, _)| other.time <= arrival.time);
        let first = self.reached.first().map_or(arrival.given, |(first, _)| first.given);
        (self.reached[..until].last().map_or(0.0, |(_, length)| *length), arrival.given - first)
    }
}

impl Passing<'_> {
    /// The arrival of a front at a point in this increment, told by the signal at its end. Slip rates are those of the middles
    /// of increments, other signals those of their ends.
    fn arrival(&self, point: &Point, signal: f64, event: usize) -> Option<Arrival> {
        let (level, mean) = match self.arrive {
            Arrive::Rate => (self.threshold, true),
            Arrive::R(level) => (level, false),
            Arrive::Mu(level) => (-level, false),
        };
        if !(point.rubs && point.signal <= level && signal > level) {
            return None;
        }
        let [(earlier, _), (then, _)] = self.last;
        let (old_dt, dt) = (then - earlier, self.after.time - then);
        let share = if point.signal.is_finite() { (level - point.signal) / (signal - point.signal) } else { 1.0 };
        let time = match mean {
            true => then - 0.5 * old_dt + share * 0.5 * (old_dt + dt),
            false => then + share * dt,
        };
        Some(Arrival { time, event, given: self.given_at(time) })
    }

    /// What loads and stored energies had given at a time, linear over each increment [F·L].
    fn given_at(&self, time: f64) -> f64 {
        let [(t0, e0), (t1, e1)] = self.last;
        let (t2, e2) = (self.after.time, Energies::of(self.after));
        match time < t1 {
            true => e1.given + (e1.given - e0.given) * (time - t1) / (t1 - t0),
            false => e1.given + (e2.given - e1.given) * (time - t1) / (t2 - t1),
        }
    }
}

impl Interface {
    pub fn new(model: &Model, pair: &ContactPair) -> Self {
        let x = model.mesh.undeformed();
        let mut points: Vec<Point> = Vec::with_capacity(pair.points.len());
        for (line, range) in pair.lines().into_iter().enumerate() {
            let mut position = 0.0;
            for k in range.clone() {
                let at = pair.points[k].at(&x);
                if k > range.start {
                    position += (at - pair.points[k - 1].at(&x)).norm();
                }
                let length = pair.points[k].current_length(&x);
                let rubs = !pair.law(&pair.points[k]).start().is_frictionless();
                let (at, arrivals) = (at.into(), Vec::new());
                let (mark, rate, signal) = (Mark::default(), 0.0, f64::NEG_INFINITY);
                points.push(Point { line, position, at, length, rubs, mark, rate, signal, arrivals });
            }
        }
        let speeds = WaveSpeeds::behind(model, pair);
        Self { name: pair.name.clone(), speeds, points, events: Vec::new() }
    }

    /// The contact after an increment.
    pub fn pass(&mut self, pair: &ContactPair, passing: &Passing, states: &[ContactState]) {
        let Passing { threshold, after, last: [_, before], .. } = *passing;
        let dt = after.time - before.0;
        let marks: Vec<Mark> = states.iter().map(Mark::of).collect();
        let rate = |(point, mark): (&Point, &Mark)| (mark.slip - point.mark.slip) / dt;
        let rates: Vec<f64> = self.points.iter().zip(&marks).map(rate).collect();
        let slipping = self.points.iter().zip(&rates).any(|(point, rate)| point.rubs && rate.abs() > threshold);
        let goes_on = self.events.last().is_some_and(|event| !event.over);
        if slipping && !goes_on {
            self.events.push(SlipEvent::begin(
                self.events.len() + 1,
                self.points.iter().map(|point| point.mark),
                before,
            ));
        }
        let event = if slipping || goes_on { self.events.len() } else { 0 };
        if let Some(last) = self.events.last_mut().filter(|event| !event.over) {
            last.go_on(after, marks.iter().copied().zip(rates.iter().copied()), !slipping);
        }
        let points = self.points.iter_mut().zip(marks.iter().zip(&rates)).zip(pair.points.iter().zip(states));
        for ((point, (mark, rate)), (slave, state)) in points {
            let observed = |name| pair.observed(slave, name, (&state.friction, after.time));
            let signal = match passing.arrive {
                Arrive::Rate => rate.abs(),
                Arrive::R(_) => observed("R"),
                Arrive::Mu(_) => -observed("mu"),
            };
            point.arrivals.extend(passing.arrival(point, signal, event));
            (point.mark, point.rate, point.signal) = (*mark, *rate, signal);
        }
    }

    /// How often a point set out again within an event, a point and time.
    pub fn chatter(&self, time: f64) -> f64 {
        let again = |point: &Point| point.arrivals.windows(2).filter(|pair| pair[0].event == pair[1].event).count();
        let rubbing = self.points.iter().filter(|point| point.rubs).count();
        let restarts: usize = self.points.iter().map(again).sum();
        if restarts == 0 { 0.0 } else { restarts as f64 / (rubbing as f64 * time) }
    }

    /// What each event had reached by when.
    pub fn reached(&self) -> Vec<Event> {
        let mut events = vec![Event::default(); self.events.len()];
        for point in &self.points {
            let mut last = 0;
            for arrival in point.arrivals.iter().filter(|arrival| arrival.event > 0) {
                // A point that stops and sets out again within an event has broken once.
                let length = if arrival.event == last { 0.0 } else { point.length };
                last = arrival.event;
                events[last - 1].reached.push((*arrival, length));
            }
        }
        for event in &mut events {
            event.reached.sort_by(|(a, _), (b, _)| a.time.total_cmp(&b.time));
            let mut total = 0.0;
            for (_, length) in &mut event.reached {
                total += *length;
                *length = total;
            }
        }
        events
    }

    /// Local speed of the front that passes a point at a time [L/T]; NaN if it passed no neighbour.
    pub fn speed(&self, k: usize, arrival: f64) -> f64 {
        let own = &self.points[k];
        let nearest = |arrivals: &[Arrival], time: f64| {
            arrivals.iter().map(|a| a.time).min_by(|a, b| (a - time).abs().total_cmp(&(b - time).abs()))
        };
        // A neighbour that only another front has passed tells nothing of this one.
        let passed = |k: usize| {
            let point = self.points.get(k).filter(|point| point.line == own.line)?;
            let there = nearest(&point.arrivals, arrival)?;
            (nearest(&own.arrivals, there) == Some(arrival)).then_some((point.position, there))
        };
        let here = Some((own.position, arrival));
        let (before, after) = (k.checked_sub(1).and_then(passed).or(here), passed(k + 1).or(here));
        match before.zip(after) {
            Some(((s0, t0), (s1, t1))) if s1 > s0 => (s1 - s0) / (t1 - t0).abs(),
            _ => f64::NAN,
        }
    }
}
