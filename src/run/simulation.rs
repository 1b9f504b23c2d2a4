//! A run as an iterator: it owns its model and accepts one increment after the other.
//!
//! ```text
//! Begin → Implicit → Complete                     a static or implicit step
//! Begin → Explicit → Complete                     an explicit one; increments go from output to output
//! Begin → QuasiDynamic → Complete                 a quasi-dynamic one; an increment is some steps of the interface
//!         Implicit ⇄ Rupture                      where a contact slips too fast for implicit increments
//! ```
//!
//! [`Simulation::try_increment`] finds a [`Candidate`] without changing the run; [`Simulation::apply`] continues with its new
//! state if it was accepted, otherwise with another attempt. A dropped candidate has no effect: the next attempt reproduces it
//! bitwise.
//!
//! A saved run continues in the same process, or from bytes in a file.

use std::sync::Arc;
use std::time::Instant;

use super::control::{
    Candidate, Control, Increment, Midway, Outcome, Phase, RunReport, WallSeconds, WatchedSlip, is_of, negative_after,
};
use super::error::Error;
use super::observer::{Attempt, Row};
use crate::linear::Multifrontal;
use crate::model::{Energy, Model, State, Step};
use crate::solve::{IncrementFailure, Workspace};
use crate::time::explicit::{Explicit, ExplicitMemory};
use crate::time::quasi_dynamic::QuasiDynamic;

/// Condition under which explicit increments pause.
pub type Pause = Arc<dyn Fn() -> bool + Send + Sync>;

/// A run; see the example at the head of the library. To shorten an increment that the caller rejects, drop its candidate and
/// set `increments.max` of the step by [`Simulation::change`]; a candidate that is only dropped is reproduced bitwise.
pub struct Simulation {
    pub(super) model: Arc<Model>,
    /// Current step, with the changes of its caller
    pub(super) step: Arc<Step>,
    /// Whether the caller has changed the step
    pub(super) step_changed: bool,
    /// Whether the caller has stopped the run
    stopped: bool,
    pub(super) state: Arc<State>,
    pub(super) control: Control,
    /// Data of explicit increments besides the state, during such increments
    pub(super) explicit: Option<Explicit>,
    /// Progress of explicit increments since the last output, if they paused
    pub(super) midway: Option<Midway>,
    /// A state that is gone, for its memory
    pub(super) spare: Option<State>,
    /// Whether explicit increments must pause before the next output
    pub(super) pause: Pause,
    /// Data of quasi-dynamic steps besides the state, during such steps
    pub(super) quasi_dynamic: Option<QuasiDynamic>,
    pub(super) work: Workspace,
    pub(super) report: RunReport,
    started: Instant,
    /// Wall time before the run was resumed [s]
    earlier: WallSeconds,
}

impl Simulation {
    /// Creates a run of a model from its initial state.
    pub fn new(model: impl Into<Arc<Model>>) -> Self {
        let model = model.into();
        let work = Workspace::new(&model, Box::<Multifrontal>::default());
        let phase = if model.steps.is_empty() { Phase::Complete } else { Phase::Begin };
        let state = model.initial_state();
        let coupling = work.assembler.coupling();
        Self {
            step: Arc::new(model.steps.first().cloned().unwrap_or_default()),
            step_changed: false,
            stopped: false,
            control: Control {
                step: 0,
                phase,
                coupling,
                ended: Vec::new(),
                moving: None,
                last_row: state.time,
                negative: 0,
            },
            state: Arc::new(state),
            explicit: None,
            midway: None,
            spare: None,
            pause: Arc::new(|| false),
            quasi_dynamic: None,
            work,
            report: RunReport::default(),
            started: Instant::now(),
            earlier: WallSeconds::default(),
            model,
        }
    }

    /// Saves the run.
    pub fn save(&self) -> Saved {
        Saved {
            step: self.step.clone(),
            state: self.state.clone(),
            control: self.control.clone(),
            explicit: self.explicit.clone(),
            midway: self.midway.clone(),
            report: self.report(),
            step_changed: self.step_changed,
        }
    }

    /// Resumes a saved run of the same model; for a model with other future steps, pass the result of [`Saved::on`].
    pub fn resume(model: impl Into<Arc<Model>>, saved: Saved) -> Self {
        let Saved { step, state, control, explicit, midway, report, step_changed } = saved;
        let earlier = report.wall_s;
        Self { step, step_changed, state, control, explicit, midway, report, earlier, ..Self::new(model) }
    }

    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Step of the next increment; after the last increment of a step this is already the following step. The step of an
    /// accepted increment is [`Increment::step`].
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

    /// Adds to the wall time of the observers [s].
    #[doc(hidden)]
    pub fn observed(&mut self, seconds: f64) {
        self.report.wall_s.output += seconds;
    }

    /// Returns the attempt that observers receive for a candidate.
    pub fn attempt_of<'a>(&'a self, candidate: &'a Candidate) -> Attempt<'a> {
        let mut attempt = Attempt {
            step: self.step_now(),
            step_number: self.control.step,
            ended: &self.control.ended,
            number: candidate.number,
            old: &self.state,
            dt: candidate.dt,
            iterations: &candidate.iterations,
            accepted: candidate.accepted.as_deref(),
            row: Row::Pending,
            verdict: candidate.verdict(),
            cause: candidate.cause(),
            local_error: candidate.local_error,
            uncertainty: candidate.uncertainty,
            passes: &candidate.passes,
        };
        attempt.row = attempt.row_after(&self.model, self.control.last_row);
        attempt
    }

    /// Tries the next increment; returns `None` after the last one. The run is unchanged, except that a step may begin.
    ///
    /// # Errors
    /// Returns [`Error::Unsolvable`] if a step cannot begin.
    pub fn try_increment(&mut self) -> Result<Option<Candidate>, Error> {
        if self.stopped {
            return Ok(None);
        }
        // A dropped attempt may have coupled other nodes.
        self.work.assembler.couple(&self.control.coupling);
        self.begin()?;
        Ok(match self.control.phase.clone() {
            Phase::Complete | Phase::Begin | Phase::Resume { .. } | Phase::Met | Phase::Missed => None,
            Phase::Implicit { dt, attempt, touching } => Some(self.implicit(dt, attempt, touching)),
            Phase::Explicit(outputs) => Some(self.explicit(outputs, None)),
            Phase::QuasiDynamic { dt } => Some(self.quasi_dynamic(dt)),
            Phase::Rupture { outputs, before, pace } => {
                Some(self.explicit(outputs, Some(WatchedSlip { before, pace })))
            }
        })
    }

    /// Applies a candidate: continues from its new state or with another attempt.
    ///
    /// # Errors
    /// Returns [`Error`] if no other attempt can succeed.
    pub fn apply(&mut self, candidate: Candidate) -> Result<(), Error> {
        let is_row = self.attempt_of(&candidate).row != Row::Pending;
        let Candidate { iterations, accepted, increments, outcome, coupling, explicit, .. } = candidate;
        if let Outcome::Paused(midway) = outcome {
            (self.control.coupling, self.explicit, self.midway) = (coupling, explicit, Some(midway));
            return Ok(());
        }
        self.midway = None;
        self.report.newton_iterations += iterations.len();
        self.report.factorizations += iterations.iter().filter(|iteration| iteration.newton.factorized).count();
        self.report.increments += increments;
        self.report.note(&outcome);
        self.control.coupling = coupling;
        if let Some(state) = accepted {
            self.control.negative = negative_after(&self.step, &iterations, self.control.negative);
            let gone = std::mem::replace(&mut self.state, state);
            self.spare = explicit.as_ref().and_then(|_| Arc::into_inner(gone));
            self.explicit = explicit;
            self.control.moving = None;
            if is_row {
                self.control.last_row = self.state.time;
            }
        }
        match outcome {
            Outcome::Accepted(phase) | Outcome::Rejected(_, phase) | Outcome::Cut(_, phase) => self.enter(phase),
            Outcome::Collapsed(collapsed, cause) => return self.more_carefully(collapsed, cause),
            Outcome::Stopped(error) => return Err(error),
            Outcome::Paused(_) => {}
        }
        Ok(())
    }

    /// Lets explicit increments pause before an output whenever `pause` returns true. The candidate is then neither accepted
    /// nor rejected, and the continuation is bitwise the same as without the pause.
    pub fn pause_when(&mut self, pause: Pause) {
        self.pause = pause;
    }

    /// Makes attempts until one is accepted; returns `None` after the last increment.
    ///
    /// # Errors
    /// Returns [`Error`] if no increment is short enough to be solved.
    pub fn next_increment(&mut self) -> Result<Option<Increment>, Error> {
        while let Some(candidate) = self.try_increment()? {
            let (step, old) = (self.step.clone(), self.state.clone());
            let (state, iterations) = (candidate.accepted.clone(), candidate.iterations.clone());
            self.apply(candidate)?;
            if let Some(state) = state {
                return Ok(Some(Increment { step, old, state, iterations }));
            }
        }
        Ok(None)
    }

    /// Whether the last step is over, or its caller has stopped it.
    pub fn is_complete(&self) -> bool {
        self.stopped || matches!(self.control.phase, Phase::Complete)
    }

    /// Stops the run: no increment follows. A saved run continues as if it had not been stopped.
    pub fn stop(&mut self) {
        self.stopped = true;
    }

    /// Changes loads, supports and increment bounds of the current step, from the next increment to the end of the step; later
    /// steps are unaffected.
    pub fn change(&mut self, change: impl Fn(&mut Step)) {
        self.step_changed = true;
        let step = Arc::make_mut(&mut self.step);
        change(step);
        if let Some(rupture) = &mut step.rupture {
            change(&mut rupture.explicit);
        }
        // Explicit and quasi-dynamic increments hold data derived from the step.
        (self.explicit, self.midway) = (None, None);
        self.quasi_dynamic = None;
    }

    pub(super) fn unsolvable(&self, cause: IncrementFailure) -> Error {
        Error::Unsolvable { step: self.step.name.clone(), time: self.state.time, cause: Box::new(cause) }
    }

    /// Step of the current phase: explicit while a contact slips fast.
    pub(super) fn step_now(&self) -> &Step {
        self.control.phase.of(&self.step)
    }
}

/// Iterates over the accepted increments; ends after an error or [`Simulation::stop`].
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

/// Saved run: state, control and counts, for the same model. A run continued by [`super::Simulation::resume`] is bitwise
/// identical to one that never stopped.
#[derive(Clone)]
#[must_use]
pub struct Saved {
    pub(super) step: Arc<Step>,
    pub(super) state: Arc<State>,
    pub(super) control: Control,
    pub(super) explicit: Option<Explicit>,
    pub(super) midway: Option<Midway>,
    pub(super) report: RunReport,
    /// Whether its caller has changed the current step
    pub(super) step_changed: bool,
}

/// Reason why a saved run cannot be resumed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NotResumable {
    /// The bytes are not those of a run.
    #[error("{0}")]
    Unreadable(String),
    /// The run belongs to another model.
    #[error("it is not of this model")]
    OtherModel,
}

/// Content of a saved run in a file.
type Written = (State, Control, Option<ExplicitMemory>, Option<Midway>, RunReport);

impl Saved {
    /// The accepted state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Number of steps of the model that have begun, on which the run depends so far.
    pub fn begun(&self) -> usize {
        // The caller's changes of a step replace the step of the model.
        self.control.step
            + usize::from(self.step_changed || !matches!(self.control.phase, Phase::Begin | Phase::Complete))
    }

    /// Whether the last step is over.
    pub fn is_complete(&self) -> bool {
        matches!(self.control.phase, Phase::Complete)
    }

    /// Returns the bytes of the run for a file.
    ///
    /// # Errors
    /// Returns [`Error::StepChanged`] if the caller has changed the current step, which a file cannot hold.
    pub fn bytes(&self) -> Result<Vec<u8>, Error> {
        let Self { step, state, control, explicit, midway, report, step_changed } = self;
        if *step_changed {
            return Err(Error::StepChanged { step: step.name.clone() });
        }
        let memory = explicit.as_ref().map(Explicit::memory);
        let run = (&**state, control, memory, midway, report);
        postcard::to_allocvec(&run).map_err(|cause| Error::NotSaved(cause.to_string()))
    }

    /// Restores a run from its bytes. Steps that had not begun may have changed or been appended since.
    ///
    /// # Errors
    /// Returns [`NotResumable`] if the bytes are unreadable or belong to another model.
    pub fn from_bytes(bytes: &[u8], model: &Arc<Model>) -> Result<Self, NotResumable> {
        let written: Written =
            postcard::from_bytes(bytes).map_err(|cause| NotResumable::Unreadable(cause.to_string()))?;
        Self::fitted(written, None, model)
    }

    /// Transfers the run to another model, whose steps that have not begun may differ or be appended.
    ///
    /// # Errors
    /// Returns [`NotResumable::OtherModel`] if anything else differs.
    pub fn on(self, model: &Arc<Model>) -> Result<Self, NotResumable> {
        let Self { step, state, control, explicit, midway, report, step_changed } = self;
        let memory = explicit.as_ref().map(Explicit::memory);
        Self::fitted(
            (Arc::unwrap_or_clone(state), control, memory, midway, report),
            step_changed.then_some(step),
            model,
        )
    }

    /// Combines a run with a model, and with the current step if its caller has changed it.
    fn fitted(run: Written, step_changed: Option<Arc<Step>>, model: &Arc<Model>) -> Result<Self, NotResumable> {
        let (state, mut control, memory, midway, report) = run;
        let fits = |memory: &ExplicitMemory| memory.fits(model);
        let on_its_way = midway.as_ref().is_none_or(|midway| is_of(&midway.state, model) && memory.is_some());
        let is_of_it = is_of(&state, model) && control.fits(model) && control.has_bodies_of(&state, model);
        if !(is_of_it && memory.as_ref().is_none_or(fits) && on_its_way) {
            return Err(NotResumable::OtherModel);
        }
        if matches!(control.phase, Phase::Complete) && control.step < model.steps.len() {
            control.phase = Phase::Begin;
        }
        let is_changed = step_changed.is_some();
        let step = step_changed.unwrap_or_else(|| Arc::new(control.step_of(model).unwrap_or_default()));
        let under_way = control.phase.of(&step);
        let explicit = memory.map(|memory| Explicit::again(model, &Arc::new(under_way.clone()), memory));
        Ok(Self { step, state: Arc::new(state), control, explicit, midway, report, step_changed: is_changed })
    }

    /// Returns the state as the start of another run, with increments and energies counted from here.
    pub fn begin(mut self) -> Self {
        let mut state = State::clone(&self.state);
        let Energy { kinetic, strain, contact_elastic, .. } = state.energy;
        let initial = kinetic + strain + contact_elastic;
        state.energy = Energy { kinetic, strain, contact_elastic, initial, ..Energy::default() };
        self.control.last_row = state.time;
        (self.state, self.report) = (Arc::new(state), RunReport::default());
        self
    }
}
