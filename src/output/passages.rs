//! What the points of an interface did so far: when fronts passed them, in which events.

use serde::{Deserialize, Serialize};

use super::wave_speeds::WaveSpeeds;
use crate::contact::pair::ContactPair;
use crate::model::Model;

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
    pub slip: f64,
    pub rate: f64,
    pub arrivals: Vec<Arrival>,
}

/// When a front passed a point.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Arrival {
    /// [T]
    pub time: f64,
    /// Number of the event of the contact, from 1
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
    /// Events so far
    pub events: usize,
    /// Whether a point slipped faster than the threshold in the last row
    pub slipping: bool,
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
                let rubs = !pair.law(&pair.points[k]).is_frictionless();
                let (at, arrivals) = (at.into(), Vec::new());
                points.push(Point { line, position, at, length, rubs, slip: 0.0, rate: 0.0, arrivals });
            }
        }
        let speeds = WaveSpeeds::behind(model, pair);
        Self { name: pair.name.clone(), speeds, points, events: 0, slipping: false }
    }

    /// What each event had reached by when.
    pub fn events(&self) -> Vec<Event> {
        let mut events = vec![Event::default(); self.events];
        for point in &self.points {
            let mut last = 0;
            for arrival in point.arrivals.iter() {
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
