//! Warning about tractions that alternate from point to point: sums of them may be right, the distribution is not.

use std::collections::{BTreeMap, VecDeque};

use serde::{Deserialize, Serialize};

use super::worst::Worst;
use crate::contact::ContactState;
use crate::contact::master::Master;
use crate::contact::scatter::PointSequence;
use crate::model::scheme::{Scheme, time_text};
use crate::model::text::count;
use crate::model::{Method, Model, State};
use crate::run::observer::Attempt;

/// Scatter of tractions that causes a warning, at the end of a step or as rms over a part of its time, over the mean pressure.
const SCATTERS: f64 = 0.05;

/// Shortest part of a step over which tractions that alternate are told, as a fraction of its time.
const PART: f64 = 0.1;
/// Its least number of increments, unless it is half of the step: in one or two, slip that begins and contact that advances alternate as well.
const INCREMENTS: usize = 3;

/// Most of that part which increments in a row are kept together for, as a fraction of it: however short they are, few are looked at.
const TOGETHER: f64 = 1.0 / 32.0;

/// The same at the end of a step for a contact so short that all of it lies close to its ends, where pressures are steep, unless one more
/// residual alternates.
const SCATTERS_IF_SHORT: f64 = 0.125;

/// The largest scatter of each contact over its bound, and what it was so far in this step.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct Scattered {
    /// By contact
    pub worst: Worst,
    within: BTreeMap<usize, Within>,
    /// How the points of each contact follow each other
    #[serde(skip)]
    sequences: BTreeMap<usize, PointSequence>,
}

/// Scatter of a contact within a step.
#[derive(Clone, Default, Serialize, Deserialize)]
struct Within {
    /// The last increments, twice as long as the shortest part: half of a longer one alternates as much
    last: VecDeque<Increments>,
    worst: Part,
}

/// Scatter at the end of an increment.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
struct Scatter {
    /// [T]
    end: f64,
    scatter: f64,
}

/// One or more increments in a row.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
struct Increments {
    count: usize,
    /// [T]
    begin: f64,
    /// [T]
    duration: f64,
    /// Integral of the square of the scatter over their time [T]
    squares: f64,
    /// That with the largest scatter
    largest: Scatter,
}

/// Part of a step.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
struct Part {
    /// Its beginning and end [T]
    span: [f64; 2],
    /// rms of the scatter over its time
    mean: f64,
    /// The increment with the largest scatter
    largest: Scatter,
}

impl Scattered {
    /// Looks at an increment, unless it is explicit: their waves alternate as well.
    pub fn record(&mut self, model: &Model, attempt: &Attempt, state: &State) {
        if matches!(attempt.step.scheme, Scheme::Explicit { .. }) {
            return;
        }
        let contacts = model.contacts.iter().zip(&model.methods).zip(&state.contacts).enumerate();
        for (k, ((pair, chosen), states)) in contacts.filter(|(_, ((pair, _), _))| attempt.step.joins(pair)) {
            let sequence =
                self.sequences.entry(k).or_insert_with(|| PointSequence::new(&pair.points, &model.mesh.undeformed()));
            let within = self.within.entry(k).or_default();
            let increment = Scatter { end: state.time, scatter: sequence.scatter(states) };
            within.add(increment, attempt.dt, attempt.step.span.end - attempt.step.span.start);
            if !attempt.ends_step(state) {
                continue;
            }
            let within = std::mem::take(within);
            let (size, found) = within.largest(sequence, states, state.time);
            if size <= self.worst.bound(k, 1.0) {
                continue;
            }
            let by_mortar = chosen.as_ref().is_some_and(|chosen| chosen.method == Method::Mortar);
            let remedy = match &pair.master {
                Master::Mesh(_) if !by_mortar => "take \"method\": \"mortar\", or a softer alpha_n",
                Master::Mesh(_) => {
                    "take softer alpha_n and alpha_t, edges of the master no longer than the slave's, or shorter increments while points \
                     close"
                }
                _ => "take softer alpha_n and alpha_t, a finer slave, or shorter increments while points close",
            };
            let message = format!(
                "contact `{}`, {found}: sums of them may be right, their distribution is not; {remedy}",
                pair.name
            );
            self.worst.enter(k, size, message);
        }
    }
}

impl Increments {
    /// A single one.
    fn one(increment: Scatter, dt: f64) -> Self {
        let squares = increment.scatter.powi(2) * dt;
        Self { count: 1, begin: increment.end - dt, duration: dt, squares, largest: increment }
    }

    /// These with those before them.
    fn after(self, before: &Self) -> Self {
        let largest = if before.largest.scatter > self.largest.scatter { before.largest } else { self.largest };
        Self {
            count: before.count + self.count,
            begin: before.begin,
            duration: before.duration + self.duration,
            squares: before.squares + self.squares,
            largest,
        }
    }
}

impl Within {
    /// Adds an increment of a step so long, which ends parts of it.
    fn add(&mut self, increment: Scatter, dt: f64, step: f64) {
        let Self { last, worst } = self;
        let one = Increments::one(increment, dt);
        match last.back_mut() {
            Some(before) if before.duration + dt <= TOGETHER * PART * step => *before = one.after(before),
            _ => last.push_back(one),
        }
        let mut all: Option<Increments> = None;
        for before in last.iter().rev() {
            let sum = all.map_or(*before, |all| all.after(before));
            let Increments { count, begin, duration, squares, largest } = sum;
            let mean = (squares / duration).sqrt();
            let least = if count < INCREMENTS { 0.5 } else { PART };
            if duration >= least * step && mean > worst.mean {
                *worst = Part { span: [begin, increment.end], mean, largest };
            }
            all = Some(sum);
        }
        let mut duration = all.map_or(0.0, |all| all.duration);
        while last.len() > 2 * INCREMENTS && duration - last[0].duration > 2.0 * PART * step {
            duration -= last[0].duration;
            last.pop_front();
        }
    }

    /// The largest scatter of a step over its bound, in the end and over a part of its time, and what there is to be said of it.
    fn largest(&self, sequence: &PointSequence, states: &[ContactState], end: f64) -> (f64, String) {
        let text = |time: f64, scatter: f64, how: String| {
            let percent = 100.0 * scatter;
            format!(
                "t = {}: tractions alternate from point to point by {percent:.0} % of the mean pressure{how}",
                time_text(time)
            )
        };
        let Part { span, mean, largest } = self.worst;
        let at_end = sequence.scatter(states);
        let most = |a: (f64, String), b: (f64, String)| if b.0 > a.0 { b } else { a };
        let [from, to] = span.map(time_text);
        let over_time = format!(" (column scatter), and by {:.0} % from t = {from} to {to}", 100.0 * mean);
        let found = most(
            (at_end / SCATTERS, text(end, at_end, " (column scatter)".into())),
            (mean / SCATTERS, text(largest.end, largest.scatter, over_time)),
        );
        let Some([pairs, rows]) = sequence.short_scatter(states) else { return found };
        let closed = states.iter().filter(|state| state.is_closed()).count();
        let on = format!(" on {}", count(closed, "closed point"));
        let found = most(found, (pairs / SCATTERS_IF_SHORT, text(end, pairs, on.clone())));
        most(found, (rows / SCATTERS, text(end, rows, on)))
    }
}
