//! State of the run control between two increments, and outcome of an attempt at the next one.
//!
//! Counts and times of a run.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::error::Error;
use super::observer::Verdict;
use crate::contact::{ContactPair, ContactState, Master};
use crate::equations::Coupling;
use crate::model::boundary::Span;
use crate::model::{Energy, Model, State, Step};
use crate::solve::{IncrementFailure, IterationRecord, Pass};
use crate::time::explicit::Explicit;
use crate::time::step_size::LocalError;
use crate::time::touching::Touching;

/// Number of results of an explicit step if the case does not specify it; in a step that is explicit only during fast slip,
/// per travel time of a shear wave across the model.
pub(super) const RESULTS: f64 = 100.0;

/// Fraction of the output interval within which an output coincides with the end of the step.
const NEAR_END: f64 = 1e-6;

/// Control state of a run: together with the state it determines the next increment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Control {
    /// number of the step
    pub step: usize,
    pub phase: Phase,
    /// nodes coupled by the equations, which determine the elimination order
    pub coupling: Arc<Coupling>,
    /// planned and actual ends of the steps that a reaction has ended [T]
    pub ended: Vec<[f64; 2]>,
    /// motion that a static step has stopped although slip accelerated, with its fastest slip, until the step accepts an
    /// increment
    pub moving: Option<(Arc<State>, f64)>,
    /// time of the last row of the results [T]
    pub last_row: f64,
    /// negative eigenvalues of the tangent at the accepted state, where they were counted
    pub negative: usize,
}

impl Control {
    /// Current step, shifted in time to its start if an earlier step has ended early.
    pub(super) fn step_of(&self, model: &Model) -> Option<Step> {
        model.steps.get(self.step).map(|step| step.clone().after(&self.ended))
    }

    /// Whether it belongs to this model; steps may have been appended since.
    pub(super) fn fits(&self, model: &Model) -> bool {
        let exists = match &self.phase {
            Phase::Complete => self.step <= model.steps.len(),
            Phase::Rupture { before, .. } => {
                is_of(before, model) && model.steps.get(self.step).is_some_and(|step| step.rupture.is_some())
            }
            _ => self.step < model.steps.len(),
        };
        self.moving.as_ref().is_none_or(|(moving, _)| is_of(moving, model))
            && exists
            && self.coupling.fits(model.mesh.nodes.len())
    }

    /// Whether the bodies and bars that are absent in the step of a state are those of this model: steps appended since may tell of others.
    pub(super) fn has_bodies_of(&self, state: &State, model: &Model) -> bool {
        let is_absent = |absent: &[bool], body: usize| absent.get(body).copied().unwrap_or(false);
        let agrees = |step: &Step| {
            let there = &state.step_start.absent;
            (0..model.bodies.len()).all(|body| is_absent(there, body) == is_absent(&step.absent, body))
                && state.bars.iter().enumerate().all(|(bar, own)| own.is_there == step.bars.has(bar))
        };
        // Between steps the state is that of the step before; within one it may still be, while no increment is accepted.
        let is_between = matches!(self.phase, Phase::Begin | Phase::Complete);
        let last = if is_between { self.step.saturating_sub(1) } else { self.step };
        model.steps.iter().take(last + 1).skip(self.step.saturating_sub(1)).any(agrees) || model.steps.is_empty()
    }
}

/// Whether a state belongs to a model: the numbers of dofs, contact points, parts of bars and internal variables agree, and all projections
/// lie on its masters.
pub fn is_of(state: &State, model: &Model) -> bool {
    let State { displacement, velocity, acceleration, force, external, damping, reaction, .. } = state;
    let start = &state.step_start;
    let last = state.last_increment.as_ref().map(|last| &last.displacement);
    let all = [displacement, velocity, acceleration, force, external, damping, reaction];
    let contact = |(states, pair): (&Vec<ContactState>, &ContactPair)| {
        let segments = match &pair.master {
            Master::Mesh(surface) => surface.segments.len(),
            Master::Rigid(_) => usize::MAX,
        };
        let stands =
            |state: &ContactState| state.master_point.is_none_or(|master_point| master_point.segment < segments);
        states.len() == pair.points.len() && states.iter().all(stands)
    };
    all.into_iter().chain([&start.displacement, &start.reaction]).chain(last).all(|values| values.len() == model.dofs())
        && [0, model.dofs()].contains(&start.fading.len())
        && [0, model.bodies.len()].contains(&start.absent.len())
        && state.memory.len() == model.memories.total()
        && state.contacts.len() == model.contacts.len()
        && state.contacts.iter().zip(&model.contacts).all(contact)
        && state.water.change.len() == model.saddle()
        && state.water.outlets.len() <= model.flow.as_ref().map_or(0, |flow| flow.outlets.len())
        && state.water.channels.len() == model.flow.as_ref().map_or(0, |flow| flow.channels.len())
        && state.water.peaks.len() == model.flow.as_ref().map_or(0, |flow| flow.bodies.len())
        && state.bars.len() == model.bars.len()
        && state.bars.iter().zip(&model.bars).all(|(own, bar)| own.fits(bar))
}

/// Slip monitored within a rupture.
pub(super) struct WatchedSlip {
    /// State since which slip is monitored
    pub before: Arc<State>,
    /// Fastest slip in the calm time before that state [L/T]
    pub pace: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) enum Phase {
    /// Before the first increment of a step
    Begin,
    /// Implicit or static increments
    Implicit {
        /// Δt of the next attempt, before the bounds of the step [T]
        dt: f64,
        /// number of the next attempt at the increment
        attempt: usize,
        touching: Touching,
    },
    /// Explicit increments to the next time of output
    Explicit(Outputs),
    /// Explicit increments within an implicit step, while a contact slips fast
    Rupture {
        outputs: Outputs,
        /// state since which slip is monitored
        before: Arc<State>,
        /// fastest slip in the calm time before that state [L/T]
        pace: f64,
    },
    /// Quasi-dynamic steps, several at a time
    QuasiDynamic {
        /// length of the next step [T]
        dt: f64,
    },
    /// After explicit increments, before the next implicit one
    Resume {
        /// fastest slip during the calm time, if it exceeds the earlier one [L/T]
        gains: Option<f64>,
    },
    /// After the last step
    Complete,
    /// The reaction that ends the step has reached its value
    Met,
    /// The step has ended before its reaction reached the value
    Missed,
}

impl Phase {
    /// Step in the variant of this phase: explicit while a contact slips fast.
    pub(super) fn of<'a>(&self, step: &'a Step) -> &'a Step {
        match (self, &step.rupture) {
            (Self::Rupture { .. }, Some(rupture)) => &rupture.explicit,
            _ => step,
        }
    }
}

/// Times of output: start + k × interval.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Outputs {
    start: f64,
    interval: f64,
    next: u32,
    /// number of the next attempt to reach this output
    pub(super) attempt: usize,
}

impl Outputs {
    pub(super) fn new(start: f64, interval: f64) -> Self {
        Self { start, interval, next: 1, attempt: 1 }
    }

    /// Returns the next output time, or an earlier requested time, and the outputs that follow.
    pub(super) fn next(self, span: Span, asked: Option<f64>) -> (f64, Self) {
        let (time, near) = (self.time(span), NEAR_END * self.interval);
        match asked.filter(|asked| *asked <= span.end && *asked <= time + near) {
            Some(asked) if asked < time - near => (asked, Self { attempt: 1, ..self }),
            Some(asked) => (asked, self.following()),
            None => (time, self.following()),
        }
    }

    fn time(&self, span: Span) -> f64 {
        let time = self.start + f64::from(self.next) * self.interval;
        if time > span.end - NEAR_END * self.interval { span.end } else { time }
    }

    fn following(self) -> Self {
        Self { next: self.next + 1, attempt: 1, ..self }
    }
}

/// Explicit increments since the last output.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Midway {
    /// current state
    pub state: Arc<State>,
    /// their number
    pub increments: usize,
}

/// Attempt at one increment, or at explicit ones up to the next output; the run itself is not changed yet.
#[must_use]
pub struct Candidate {
    pub(super) number: usize,
    pub(super) dt: f64,
    pub(super) iterations: Vec<IterationRecord>,
    pub(super) accepted: Option<Arc<State>>,
    pub(super) local_error: Option<LocalError>,
    pub(super) uncertainty: Option<f64>,
    pub(super) passes: Vec<Pass>,
    /// number of accepted increments in it
    pub(super) increments: usize,
    pub(super) outcome: Outcome,
    pub(super) coupling: Arc<Coupling>,
    pub(super) explicit: Option<Explicit>,
}

/// Outcome of an attempt.
pub(super) enum Outcome {
    /// Accepted as the new state, with the phase that follows
    Accepted(Phase),
    /// Solved but repeated, with the reason and the phase that follows
    Rejected(Verdict, Phase),
    /// Not solved, with the cause; a shorter increment may be
    Cut(IncrementFailure, Phase),
    /// Explicit increments paused before the next output
    Paused(Midway),
    /// Explicit increments collapsed at this state; shorter ones may succeed
    Collapsed(Arc<State>, IncrementFailure),
    /// No other attempt can succeed
    Stopped(Error),
}

/// An accepted increment, or the explicit ones up to an output.
#[non_exhaustive]
pub struct Increment {
    /// its step
    pub step: Arc<Step>,
    /// state at its start
    pub old: Arc<State>,
    /// state at its end
    pub state: Arc<State>,
    /// its linear solves
    pub iterations: Vec<IterationRecord>,
}

impl Candidate {
    /// Whether explicit increments paused before the next output.
    pub fn is_paused(&self) -> bool {
        matches!(self.outcome, Outcome::Paused(_))
    }

    /// Whether the run stops after it.
    pub fn stops(&self) -> bool {
        match &self.outcome {
            Outcome::Stopped(_) => true,
            Outcome::Collapsed(..) => self.explicit.as_ref().is_none_or(Explicit::is_most_careful),
            _ => false,
        }
    }

    /// Verdict on the attempt.
    pub fn verdict(&self) -> Verdict {
        match &self.outcome {
            Outcome::Accepted(_) | Outcome::Paused(_) => Verdict::Accepted,
            Outcome::Rejected(why, _) => *why,
            Outcome::Cut(..) | Outcome::Collapsed(..) | Outcome::Stopped(_) => Verdict::Unsolved,
        }
    }

    /// Cause of the failure if no equilibrium was found.
    pub fn cause(&self) -> Option<&IncrementFailure> {
        match &self.outcome {
            Outcome::Cut(cause, _) | Outcome::Collapsed(_, cause) => Some(cause),
            Outcome::Stopped(error) => error.cause(),
            Outcome::Accepted(_) | Outcome::Paused(_) | Outcome::Rejected(..) => None,
        }
    }

    /// Whether it leads to a new state.
    pub fn is_accepted(&self) -> bool {
        self.accepted.is_some()
    }

    /// The new state, if there is one.
    pub fn state(&self) -> Option<&State> {
        self.accepted.as_deref()
    }

    /// The accepted state, shared so that it can be kept.
    pub fn shared_state(&self) -> Option<Arc<State>> {
        self.accepted.clone()
    }

    /// Length of the increment [T].
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// Linear solves of the increment.
    pub fn iterations(&self) -> &[IterationRecord] {
        &self.iterations
    }
}

/// Negative eigenvalues of the tangent at the end of a static increment; as `before` where they cannot be counted, as where pivots had
/// to be replaced.
pub(super) fn negative_after(step: &Step, iterations: &[IterationRecord], before: usize) -> usize {
    let last = iterations.last().filter(|_| !step.scheme.is_dynamic());
    last.and_then(|iteration| iteration.newton.least_negative).unwrap_or(before)
}

/// Counts and times of a run.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct RunReport {
    /// accepted increments
    pub increments: usize,
    /// attempts that could not be solved
    pub cutbacks: usize,
    /// attempts that were solved but repeated, because of their error or a contact event
    pub rejected: usize,
    /// rejected attempts, solved or not, by reason
    pub given_up: BTreeMap<String, usize>,
    /// number of switches to explicit increments because a contact slipped fast
    pub ruptures: usize,
    /// linear solves, those of failed attempts included
    pub newton_iterations: usize,
    /// matrix factorizations
    pub factorizations: usize,
    /// energies at the end
    pub energy: Energy,
    /// energy absorbed by the stabilization of bodies with unconstrained rigid-body modes [F·L]
    pub stabilization_work: f64,
    /// wall time by phase
    pub wall_s: WallSeconds,
}

impl RunReport {
    /// Counts an attempt if it was rejected.
    pub(super) fn note(&mut self, outcome: &Outcome) {
        let (count, kind) = match outcome {
            Outcome::Rejected(why, _) => (&mut self.rejected, why.kind()),
            Outcome::Cut(cause, _) | Outcome::Collapsed(_, cause) => (&mut self.cutbacks, cause.kind()),
            Outcome::Accepted(_) | Outcome::Paused(_) | Outcome::Stopped(_) => return,
        };
        *count += 1;
        *self.given_up.entry(kind.into()).or_default() += 1;
    }
}

/// Wall time by phase [s].
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct WallSeconds {
    /// total
    pub total: f64,
    /// solids, loads, sums
    pub assembly: f64,
    /// search, friction, contact forces
    pub contact: f64,
    /// factorization and solution
    pub linear: f64,
    /// observers
    pub output: f64,
}
