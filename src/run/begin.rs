//! What the next attempt needs first: a step that begins, explicit increments, or implicit ones again after them.

use std::sync::Arc;

use super::control::{Outputs, Phase, RESULTS};
use super::error::Error;
use super::simulation::Simulation;
use crate::model::scheme::Scheme;
use crate::model::state::State;
use crate::solve::failure::IncrementFailure;
use crate::time::explicit::Explicit;
use crate::time::increment::{begin, go_on};
use crate::time::touching::Touching;

impl Simulation {
    /// Begin what the next attempt needs: a step, explicit increments, or implicit ones again after them.
    pub(super) fn begin(&mut self) -> Result<(), Error> {
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
}
