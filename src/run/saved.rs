//! A run as it was: in this process, or as bytes for a file.

use std::sync::Arc;

use super::control::{Control, Midway, Phase, is_of};
use super::error::Error;
use super::report::RunReport;
use crate::model::state::{Energy, State};
use crate::model::{Model, Step};
use crate::time::explicit::{Explicit, ExplicitMemory};

/// A run as it was: state, control and counts, for the same model. What is computed after [`super::Simulation::resume`] has the same
/// bits as if the run had never stopped.
#[derive(Clone)]
pub struct Saved {
    pub(super) step: Arc<Step>,
    pub(super) state: Arc<State>,
    pub(super) control: Control,
    pub(super) explicit: Option<Explicit>,
    pub(super) midway: Option<Midway>,
    pub(super) report: RunReport,
    /// Whether its caller has changed the step under way
    pub(super) led: bool,
}

/// What goes to a file.
type Written = (State, Control, Option<ExplicitMemory>, Option<Midway>, RunReport);

impl Saved {
    /// The accepted state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// How many steps of the model the run depends on so far: those that have begun.
    pub fn begun(&self) -> usize {
        // What its caller has changed of a step holds in place of what the model says.
        self.control.step + usize::from(self.led || !matches!(self.control.phase, Phase::Begin | Phase::Complete))
    }

    /// Whether its last step is over.
    pub fn is_complete(&self) -> bool {
        matches!(self.control.phase, Phase::Complete)
    }

    /// The bytes of a run for a file.
    ///
    /// # Errors
    /// [`Error::Led`] where its caller has changed the step under way, which no file holds.
    pub fn bytes(&self) -> Result<Vec<u8>, Error> {
        let Self { step, state, control, explicit, midway, report, led } = self;
        if *led {
            return Err(Error::Led { step: step.name.clone() });
        }
        let memory = explicit.as_ref().map(Explicit::memory);
        let run = (&**state, control, memory, midway, report);
        postcard::to_allocvec(&run).map_err(|cause| Error::NotSaved(cause.to_string()))
    }

    /// The run that the bytes tell of. Steps that had not begun may have changed since, or have come after the last one.
    ///
    /// # Errors
    /// Why they tell of no run of this model.
    pub fn from_bytes(bytes: &[u8], model: &Arc<Model>) -> Result<Self, String> {
        let written: Written = postcard::from_bytes(bytes).map_err(|cause| cause.to_string())?;
        Self::fitted(written, None, model)
    }

    /// The run on another model, whose steps that have not begun may be other ones, or come after the last one.
    ///
    /// # Errors
    /// Why it is no run of this model.
    pub fn on(self, model: &Arc<Model>) -> Result<Self, String> {
        let Self { step, state, control, explicit, midway, report, led } = self;
        let memory = explicit.as_ref().map(Explicit::memory);
        Self::fitted((Arc::unwrap_or_clone(state), control, memory, midway, report), led.then_some(step), model)
    }

    /// A run of a model, with the step under way if its caller has changed it.
    fn fitted(run: Written, led: Option<Arc<Step>>, model: &Arc<Model>) -> Result<Self, String> {
        let (state, mut control, memory, midway, report) = run;
        let fits = |memory: &ExplicitMemory| memory.fits(model);
        let on_its_way = midway.as_ref().is_none_or(|midway| is_of(&midway.state, model) && memory.is_some());
        if !(is_of(&state, model) && control.fits(model) && memory.as_ref().is_none_or(fits) && on_its_way) {
            return Err("it is not of this model".into());
        }
        if matches!(control.phase, Phase::Complete) && control.step < model.steps.len() {
            control.phase = Phase::Begin;
        }
        let is_led = led.is_some();
        let step = led.unwrap_or_else(|| Arc::new(control.step_of(model).unwrap_or_default()));
        let under_way = control.phase.of(&step);
        let explicit = memory.map(|memory| Explicit::again(model, &Arc::new(under_way.clone()), memory));
        Ok(Self { step, state: Arc::new(state), control, explicit, midway, report, led: is_led })
    }

    /// The same place, from where another run begins: it counts its increments, and the energies that come and go, from here.
    #[must_use]
    pub fn begin(mut self) -> Self {
        let mut state = State::clone(&self.state);
        let Energy { kinetic, strain, contact_elastic, .. } = state.energy;
        let initial = kinetic + strain + contact_elastic;
        state.energy = Energy { kinetic, strain, contact_elastic, initial, ..Energy::default() };
        (self.state, self.report) = (Arc::new(state), RunReport::default());
        self
    }
}
