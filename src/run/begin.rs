//! What the next attempt needs first: a step that begins, explicit or quasi-dynamic increments, or implicit ones again; and the
//! phase that one leads to.

use std::sync::Arc;

use super::control::{Outputs, Phase, RESULTS};
use super::error::Error;
use super::simulation::Simulation;
use crate::model::scheme::Scheme;
use crate::model::state::State;
use crate::solve::failure::IncrementFailure;
use crate::time::beginning::{begin, go_on, led};
use crate::time::explicit::Explicit;
use crate::time::quasi_dynamic::QuasiDynamic;
use crate::time::touching::Touching;

impl Simulation {
    /// Begin what the next attempt needs: a step, explicit increments, or implicit ones again after them.
    pub(super) fn begin(&mut self) -> Result<(), Error> {
        if let Phase::Missed = self.control.phase {
            return Err(self.not_reached());
        }
        let is_explicit = matches!(self.step.scheme, Scheme::Explicit { .. });
        let is_quasi_dynamic = matches!(self.step.scheme, Scheme::QuasiDynamic { .. });
        let begun = match self.control.phase {
            Phase::Begin if is_explicit => self.begin_explicit(true),
            Phase::Begin if is_quasi_dynamic => self.begin_quasi_dynamic(true),
            Phase::QuasiDynamic { .. } if self.quasi_dynamic.is_none() => self.begin_quasi_dynamic(false),
            Phase::Explicit(_) | Phase::Rupture { .. } if self.explicit.is_none() => self.begin_explicit(false),
            Phase::Begin | Phase::Resume { .. } => self.begin_implicit(),
            Phase::Implicit { .. } if self.led => self.take_note(),
            _ => Ok(()),
        };
        begun.map_err(|cause| self.unsolvable(cause))
    }

    /// Go on under the loads that whoever leads the run has changed.
    fn take_note(&mut self) -> Result<(), IncrementFailure> {
        let state = led(&self.model, &self.step, &self.state, &mut self.work)?;
        self.state = state.map_or_else(|| self.state.clone(), Arc::new);
        Ok(())
    }

    /// The error of a step whose reaction has not come to its value.
    fn not_reached(&self) -> Error {
        let (step, state) = (&*self.step, &*self.state);
        let Some(until) = &step.until else { return Error::Ended("the step ended".into()) };
        Error::NotReached {
            step: step.name.clone(),
            time: state.time,
            part: until.part.name(),
            on: until.on.clone(),
            value: until.value,
            reached: until.force(&state.reaction),
        }
    }

    fn begin_explicit(&mut self, step_begins: bool) -> Result<(), IncrementFailure> {
        let step = Arc::new(self.step_now().clone());
        let mut state = State::clone(&self.state);
        let goes_on = state.is_of_explicit();
        let dt = if goes_on { state.dt } else { 0.0 };
        if step_begins {
            state.begin_step();
            Explicit::launch(&self.model, &step, &mut state);
        }
        (state.dt, state.last_increment) = (dt, None);
        let explicit = Explicit::begin(&self.model, &step, &mut state, &mut self.work.assembler)?;
        if !goes_on {
            explicit.lump(&mut state);
        }
        self.explicit = Some(explicit);
        self.state = Arc::new(state);
        if step_begins {
            let interval = self.model.interval.unwrap_or((step.span.end - step.span.start) / RESULTS);
            self.control.phase = Phase::Explicit(Outputs::new(step.span.start, interval));
        }
        Ok(())
    }

    fn begin_quasi_dynamic(&mut self, step_begins: bool) -> Result<(), IncrementFailure> {
        if step_begins {
            self.state = Arc::new(begin(&self.model, &self.step, &self.state, &mut self.work)?);
        }
        let mut bodies = QuasiDynamic::new(&self.model, &self.step, &self.state)?;
        if step_begins {
            let mut state = State::clone(&self.state);
            bodies.settle(&mut state);
            self.state = Arc::new(state);
            self.control.phase = Phase::QuasiDynamic { dt: self.step.increments.initial };
        }
        self.quasi_dynamic = Some(bodies);
        Ok(())
    }

    fn begin_implicit(&mut self) -> Result<(), IncrementFailure> {
        let state = match self.control.phase {
            Phase::Resume { gains } => {
                let stops = !self.step.scheme.is_dynamic();
                self.control.moving = gains.filter(|_| stops).map(|pace| (self.state.clone(), pace));
                go_on(&self.model, &self.step, &self.state, &mut self.work)?
            }
            _ => begin(&self.model, &self.step, &self.state, &mut self.work)?,
        };
        self.state = Arc::new(state);
        let dt = self.step.increments.initial;
        self.control.phase = Phase::Implicit { dt, attempt: 1, touching: Touching::default() };
        Ok(())
    }

    /// Shorter explicit increments from the accepted state, after others collapsed.
    pub(super) fn more_carefully(&mut self, collapsed: Arc<State>, cause: IncrementFailure) -> Result<(), Error> {
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

    /// Break out of an implicit step: from its state, or with the motion that its static increments could not follow on. Returns
    /// how fast slip has been there.
    fn break_out(&mut self) -> f64 {
        let Some((moving, pace)) = self.control.moving.take() else {
            self.report.ruptures += 1;
            return 0.0;
        };
        self.state = moving;
        pace
    }

    /// Enter the phase that a candidate led to, or the next step.
    pub(super) fn enter(&mut self, mut phase: Phase) {
        let implicit = |phase: &Phase| matches!(phase, Phase::Implicit { .. });
        if let (Phase::Implicit { .. }, Phase::Rupture { before, pace, .. }) = (&self.control.phase, &mut phase) {
            *pace = self.break_out();
            *before = self.state.clone();
        }
        if implicit(&phase) || matches!(phase, Phase::Resume { .. }) {
            self.explicit = None;
        }
        let ends = self.state.time >= self.step.span.end || matches!(phase, Phase::Met);
        if self.state.time < self.step.span.end && ends {
            let planned = self.model.steps[self.control.step].span.end;
            self.control.ended.push([planned, self.state.time]);
        }
        self.control.phase = phase;
        if ends && !matches!(self.control.phase, Phase::Missed) {
            self.explicit = None;
            self.quasi_dynamic = None;
            self.led = false;
            self.control.step += 1;
            self.control.phase = Phase::Complete;
            if let Some(step) = self.control.step_of(&self.model) {
                self.step = Arc::new(step);
                self.control.phase = Phase::Begin;
            }
        }
    }
}
