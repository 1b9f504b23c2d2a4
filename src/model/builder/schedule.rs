//! The schedule of a run: what each load step takes over from the one before, and what it replaces or ends.

use std::collections::BTreeMap;

use super::error::{Checked, ModelError};
use super::increments::{increments, rupture, stabilization};
use super::load_step::{IncrementSettings, LoadStep};
use super::loads::LoadsInForce;
use super::supports::supports;
use crate::model::boundary::{Prescribed, Span};
use crate::model::scheme::Scheme;
use crate::model::{Model, Step};

/// The steps of a run.
pub fn steps(given: &[LoadStep], model: &Model) -> Checked<Vec<Step>> {
    if given.is_empty() {
        return Err(ModelError::new("steps", "is empty: give at least one step"));
    }
    let mut schedule = Schedule {
        model,
        start: 0.0,
        scheme: Scheme::Static,
        increments: None,
        supports: BTreeMap::new(),
        loads: LoadsInForce::default(),
    };
    given.iter().enumerate().map(|(k, step)| schedule.next(&format!("steps[{k}]"), step)).collect()
}

/// What one step hands on to the next.
struct Schedule<'m> {
    model: &'m Model,
    start: f64,
    scheme: Scheme,
    increments: Option<IncrementSettings>,
    supports: BTreeMap<usize, Prescribed>,
    loads: LoadsInForce,
}

impl Schedule<'_> {
    fn next(&mut self, place: &str, given: &LoadStep) -> Checked<Step> {
        if !(given.duration > 0.0 && given.duration.is_finite()) {
            let message = format!("is {}: must be positive", given.duration);
            return Err(ModelError::new(format!("{place}.duration"), message));
        }
        self.scheme = given.scheme.unwrap_or(self.scheme);
        let scheme = self.scheme;
        scheme.check().map_err(|error| ModelError::new(format!("{place}.scheme"), error))?;
        let span = Span { start: self.start, end: self.start + given.duration };
        self.start = span.end;
        self.increments = given.increments.or(self.increments);
        let increments = increments(&format!("{place}.dt"), self.increments, span, scheme)?;
        let freed = supports(&mut self.supports, &given.supports, place, span, self.model)?;
        // In motion there is no rest of the reaction: what held is gone.
        let released = if scheme.is_dynamic() { Vec::new() } else { freed };
        for (k, load) in given.loads.iter().enumerate() {
            self.loads.change(load, &format!("{place}.loads[{k}]"), span, self.model)?;
        }
        let stabilization = stabilization(&format!("{place}.stabilize"), given, scheme, self.model)?;
        let increments = if stabilization.is_empty() { increments } else { increments.at_most(0.5 * given.duration) };
        let mut step = Step {
            name: given.name.clone(),
            span,
            scheme,
            increments,
            rupture: None,
            supports: self.supports.values().cloned().collect(),
            released,
            loads: self.loads.all(),
            stabilization,
        };
        step.rupture = rupture(&format!("{place}.rupture"), given.rupture, &step, self.model)?.map(Box::new);
        Ok(step)
    }
}
