//! A run as an iterator: it owns its model, and accepts one increment after the other.
//!
//! ```text
//! Begin → Implicit → Complete                     a static or implicit step
//! Begin → Explicit → Complete                     an explicit one; increments go from output to output
//!         Implicit ⇄ Rupture                      where a contact slips too fast for implicit increments
//! ```
//!
//! [`Simulation::attempt`] finds a [`Candidate`] and changes nothing; [`Simulation::follow`] goes on as it says: to its new
//! state if it was accepted, else to another attempt. A candidate that is dropped has never been: the next attempt finds it
//! again, to the same bits.

use std::sync::Arc;
use std::time::Instant;

use super::error::Error;
use super::observer::Attempt;
use super::report::{RunReport, WallSeconds};
use crate::equations::Coupling;
use crate::linear::Multifrontal;
use crate::model::boundary::Span;
use crate::model::scheme::Scheme;
use crate::model::state::State;
use crate::model::{Model, Step};
use crate::solve::failure::IncrementFailure;
use crate::solve::{IterationRecord, Workspace};
use crate::time::explicit::Explicit;
use crate::time::increment::{begin, go_on};
use crate::time::touching::Touching;

/// Results of an explicit step if the case does not say how many, and of the time that a shear wave takes across the model
/// where a step is explicit while a contact slips fast.
pub(super) const RESULTS: f64 = 100.0;

/// Share of the time between two outputs within which an output falls on the end of a step.
const NEAR_END: f64 = 1e-6;

/// A run under way.
pub struct Simulation {
    pub(super) model: Arc<Model>,
    /// The step under way, as its caller may have changed it
    pub(super) step: Arc<Step>,
    pub(super) state: Arc<State>,
    control: Control,
    /// What explicit increments need besides the state, while there are any
    pub(super) explicit: Option<Explicit>,
    pub(super) work: Workspace,
    report: RunReport,
    started: Instant,
    /// Wall time of what was resumed [s]
    earlier: WallSeconds,
}

/// Where a run is: with the state, all that decides the next increment.
#[derive(Clone, Debug)]
struct Control {
    /// number of the step
    step: usize,
    phase: Phase,
    /// which nodes the equations couple, and so the order of their elimination
    coupling: Arc<Coupling>,
}

#[derive(Clone, Debug)]
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
    /// The same within an implicit step, while a contact slips fast
    Rupture {
        outputs: Outputs,
        /// the state since which slip is watched
        before: Arc<State>,
    },
    /// After them, before the next implicit increment
    Resume,
    /// After the last step
    Complete,
}

/// Times of output: start + k × interval.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outputs {
    start: f64,
    interval: f64,
    next: u32,
    /// number of the next attempt to get there
    pub(super) attempt: usize,
}

impl Outputs {
    pub(super) fn new(start: f64, interval: f64) -> Self {
        Self { start, interval, next: 1, attempt: 1 }
    }

    pub(super) fn time(&self, span: Span) -> f64 {
        let time = self.start + f64::from(self.next) * self.interval;
        if time > span.end - NEAR_END * self.interval { span.end } else { time }
    }

    pub(super) fn following(self) -> Self {
        Self { next: self.next + 1, attempt: 1, ..self }
    }
}

/// An attempt at one increment, or at explicit ones up to the next output. Nothing has changed yet.
pub struct Candidate {
    pub(super) number: usize,
    pub(super) dt: f64,
    pub(super) iterations: Vec<IterationRecord>,
    pub(super) accepted: Option<Arc<State>>,
    pub(super) local_error: Option<f64>,
    pub(super) doubt: Option<f64>,
    /// Accepted increments in it
    pub(super) increments: usize,
    pub(super) outcome: Outcome,
    pub(super) coupling: Arc<Coupling>,
    pub(super) explicit: Option<Explicit>,
}

/// What became of an attempt.
pub(super) enum Outcome {
    /// A new state, and how it goes on
    Accepted(Phase),
    /// Solved, and repeated for its error or an event
    Rejected(Phase),
    /// Not solved; a shorter one may be
    Cut(Phase),
    /// Explicit increments collapsed at this state; shorter ones may not
    Collapsed(Arc<State>, IncrementFailure),
    /// No other attempt can help
    Stopped(Error),
}

/// An accepted increment, or the explicit ones up to an output.
pub struct Increment {
    /// its step
    pub step: Arc<Step>,
    /// the state it started from
    pub old: Arc<State>,
    /// the state it led to
    pub state: Arc<State>,
    /// its linear solves
    pub iterations: Vec<IterationRecord>,
}

/// A run as it was: state, control and counts. What is computed after [`Simulation::resume`] has the same bits as if the run
/// had never stopped.
#[derive(Clone)]
pub struct Saved {
    step: Arc<Step>,
    state: Arc<State>,
    control: Control,
    explicit: Option<Explicit>,
    report: RunReport,
}

impl Candidate {
    /// Whether it leads to a new state.
    pub fn is_accepted(&self) -> bool {
        self.accepted.is_some()
    }

    /// The state it leads to, if it does.
    pub fn state(&self) -> Option<&State> {
        self.accepted.as_deref()
    }

    /// Its length [T].
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// Its linear solves.
    pub fn iterations(&self) -> &[IterationRecord] {
        &self.iterations
    }
}

impl Simulation {
    /// A run of a model from its initial state.
    pub fn new(model: impl Into<Arc<Model>>) -> Self {
        let model = model.into();
        let work = Workspace::new(&model, Box::<Multifrontal>::default());
        let phase = if model.steps.is_empty() { Phase::Complete } else { Phase::Begin };
        Self {
            step: Arc::new(model.steps.first().cloned().unwrap_or_default()),
            state: Arc::new(model.initial_state()),
            control: Control { step: 0, phase, coupling: work.assembler.coupling() },
            explicit: None,
            work,
            report: RunReport::default(),
            started: Instant::now(),
            earlier: WallSeconds::default(),
            model,
        }
    }

    /// The run as it is.
    pub fn save(&self) -> Saved {
        Saved {
            step: self.step.clone(),
            state: self.state.clone(),
            control: self.control.clone(),
            explicit: self.explicit.clone(),
            report: self.report(),
        }
    }

    /// A run as it was, of the same model.
    pub fn resume(model: impl Into<Arc<Model>>, saved: Saved) -> Self {
        let Saved { step, state, control, explicit, report } = saved;
        let earlier = report.wall_s;
        Self { step, state, control, explicit, report, earlier, ..Self::new(model) }
    }

    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// The step under way, or the last one.
    pub fn step(&self) -> &Step {
        &self.step
    }

    /// The accepted state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Counts and times so far.
    pub fn report(&self) -> RunReport {
        let Self { work, earlier, state, .. } = self;
        let mut report = self.report.clone();
        report.stabilization_work = state.energy.stabilization;
        report.energy = state.energy;
        report.wall_s.assembly = earlier.assembly + work.assembler.seconds.assembly;
        report.wall_s.contact = earlier.contact + work.assembler.seconds.contact;
        report.wall_s.linear = earlier.linear + work.linear_seconds;
        report.wall_s.total = earlier.total + self.started.elapsed().as_secs_f64();
        report
    }

    /// Add to the time that observers took [s].
    pub fn observed(&mut self, seconds: f64) {
        self.report.wall_s.output += seconds;
    }

    /// What observers are told of a candidate.
    pub fn told<'a>(&'a self, candidate: &'a Candidate) -> Attempt<'a> {
        Attempt {
            step: self.step_now(),
            number: candidate.number,
            old: &self.state,
            dt: candidate.dt,
            iterations: &candidate.iterations,
            accepted: candidate.accepted.as_deref(),
            local_error: candidate.local_error,
            doubt: candidate.doubt,
        }
    }

    /// Try the next increment; `None` after the last one. Nothing changes but that a step begins.
    ///
    /// # Errors
    /// [`Error::Unsolvable`] when a step cannot begin.
    pub fn attempt(&mut self) -> Result<Option<Candidate>, Error> {
        // An attempt that was dropped may have coupled other nodes.
        self.work.assembler.couple(&self.control.coupling);
        self.begin()?;
        Ok(match self.control.phase.clone() {
            Phase::Complete | Phase::Begin | Phase::Resume => None,
            Phase::Implicit { dt, attempt, touching } => Some(self.implicit(dt, attempt, touching)),
            Phase::Explicit(outputs) => Some(self.explicit(outputs, None)),
            Phase::Rupture { outputs, before } => Some(self.explicit(outputs, Some(before))),
        })
    }

    /// Go on as a candidate says.
    ///
    /// # Errors
    /// [`Error`] when no other attempt can help.
    pub fn follow(&mut self, candidate: Candidate) -> Result<(), Error> {
        let Candidate { iterations, accepted, increments, outcome, coupling, explicit, .. } = candidate;
        self.report.newton_iterations += iterations.len();
        self.report.factorizations += iterations.iter().filter(|iteration| iteration.newton.factorized).count();
        self.report.increments += increments;
        self.control.coupling = coupling;
        if let Some(state) = accepted {
            self.state = state;
            self.explicit = explicit;
        }
        match outcome {
            Outcome::Accepted(phase) => self.enter(phase),
            Outcome::Rejected(phase) => {
                self.report.rejected += 1;
                self.enter(phase);
            }
            Outcome::Cut(phase) => {
                self.report.cutbacks += 1;
                self.enter(phase);
            }
            Outcome::Collapsed(collapsed, cause) => {
                self.report.cutbacks += 1;
                return self.more_carefully(collapsed, cause);
            }
            Outcome::Stopped(error) => return Err(error),
        }
        Ok(())
    }

    /// Attempts until one is accepted; `None` after the last increment.
    ///
    /// # Errors
    /// [`Error`] when no increment is short enough.
    pub fn next_increment(&mut self) -> Result<Option<Increment>, Error> {
        while let Some(candidate) = self.attempt()? {
            let (step, old) = (self.step.clone(), self.state.clone());
            let (state, iterations) = (candidate.accepted.clone(), candidate.iterations.clone());
            self.follow(candidate)?;
            if let Some(state) = state {
                return Ok(Some(Increment { step, old, state, iterations }));
            }
        }
        Ok(None)
    }

    /// Whether the last step is over.
    pub fn is_complete(&self) -> bool {
        matches!(self.control.phase, Phase::Complete)
    }

    /// Stop here: no increment follows.
    pub fn stop(&mut self) {
        self.control.phase = Phase::Complete;
    }

    /// Change loads and supports of the step under way: what changes is so from the next increment on.
    pub fn change(&mut self, change: impl Fn(&mut Step)) {
        let step = Arc::make_mut(&mut self.step);
        change(step);
        if let Some(rupture) = &mut step.rupture {
            change(&mut rupture.explicit);
        }
        // Explicit increments keep what follows from the step.
        self.explicit = None;
    }

    pub(super) fn unsolvable(&self, cause: IncrementFailure) -> Error {
        Error::Unsolvable { step: self.step.name.clone(), time: self.state.time, cause }
    }

    /// Begin what the next attempt needs: a step, explicit increments, or implicit ones again after them.
    fn begin(&mut self) -> Result<(), Error> {
        let is_explicit = matches!(self.step.scheme, Scheme::Explicit { .. });
        let begun = match self.control.phase {
            Phase::Begin if is_explicit => self.begin_explicit(true),
            Phase::Explicit(_) | Phase::Rupture { .. } if self.explicit.is_none() => self.begin_explicit(false),
            Phase::Begin | Phase::Resume => self.begin_implicit(),
            _ => Ok(()),
        };
        begun.map_err(|cause| self.unsolvable(cause))
    }

    fn begin_explicit(&mut self, step_begins: bool) -> Result<(), IncrementFailure> {
        let step = Arc::new(self.step_now().clone());
        let mut state = State::clone(&self.state);
        if step_begins {
            state.begin_step();
            let interval = self.model.interval.unwrap_or((step.span.end - step.span.start) / RESULTS);
            self.control.phase = Phase::Explicit(Outputs::new(step.span.start, interval));
        }
        self.explicit = Some(Explicit::begin(&self.model, &step, &mut state, &mut self.work.assembler)?);
        self.state = Arc::new(state);
        Ok(())
    }

    fn begin_implicit(&mut self) -> Result<(), IncrementFailure> {
        let state = match self.control.phase {
            Phase::Begin => begin(&self.model, &self.step, &self.state, &mut self.work)?,
            _ => go_on(&self.model, &self.step, &self.state, &mut self.work)?,
        };
        self.state = Arc::new(state);
        let dt = self.step.increments.initial;
        self.control.phase = Phase::Implicit { dt, attempt: 1, touching: Touching::default() };
        Ok(())
    }

    /// Shorter explicit increments from the accepted state, after others collapsed.
    fn more_carefully(&mut self, collapsed: Arc<State>, cause: IncrementFailure) -> Result<(), Error> {
        let mut state = State::clone(&self.state);
        let Some(explicit) = &mut self.explicit else { return Err(self.unsolvable(cause)) };
        let again = explicit.more_carefully(&mut state, &mut self.work.assembler);
        if again.map_err(|cause| self.unsolvable(cause))? {
            self.state = Arc::new(state);
            if let Phase::Explicit(outputs) | Phase::Rupture { outputs, .. } = &mut self.control.phase {
                outputs.attempt += 1;
            }
            return Ok(());
        }
        self.state = collapsed;
        Err(self.unsolvable(cause.after_all()))
    }

    /// The step as it goes on at present: explicitly while a contact slips fast.
    fn step_now(&self) -> &Step {
        match (&self.control.phase, &self.step.rupture) {
            (Phase::Rupture { .. }, Some(rupture)) => &rupture.explicit,
            _ => &self.step,
        }
    }

    /// Enter the phase that a candidate led to, or the next step.
    fn enter(&mut self, phase: Phase) {
        let implicit = |phase: &Phase| matches!(phase, Phase::Implicit { .. });
        let rupture = |phase: &Phase| matches!(phase, Phase::Rupture { .. });
        self.report.ruptures += usize::from(implicit(&self.control.phase) && rupture(&phase));
        if implicit(&phase) || matches!(phase, Phase::Resume) {
            self.explicit = None;
        }
        self.control.phase = phase;
        if self.state.time >= self.step.span.end {
            self.explicit = None;
            self.control.step += 1;
            self.control.phase = Phase::Complete;
            if let Some(step) = self.model.steps.get(self.control.step) {
                self.step = Arc::new(step.clone());
                self.control.phase = Phase::Begin;
            }
        }
    }
}

/// Accepted increments, one after the other; after an error, or [`Simulation::stop`], none.
impl Iterator for Simulation {
    type Item = Result<Increment, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = self.next_increment().transpose();
        if let Some(Err(_)) = next {
            self.stop();
        }
        next
    }
}
