//! The schedule of a run: what each load step takes over from the one before, and what it replaces or ends.

use std::collections::BTreeMap;

use super::body::check_damping;
use super::defined;
use super::error::{Checked, ModelError};
use super::imposed::{in_force, temperatures};
use super::inclined::{InForce, freed};
use super::increments::{increments, rupture, stabilization};
use super::initial::launch;
use super::load_step::{IncrementSettings, LoadStep};
use super::loads::LoadsInForce;
use super::section::hold_axis;
use super::supports::supports;
use super::until::until;
use crate::model::boundary::{Amplitude, Span};
use crate::model::scheme::Scheme;
use crate::model::support::Prescribed;
use crate::model::{Damping, Model, Step};

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
        in_force: InForce::default(),
        may_end_early: false,
        damping: model.bodies.iter().map(|body| body.damping).collect(),
        supports: Vec::new(),
        loads: LoadsInForce::default(),
        temperatures: BTreeMap::new(),
    };
    given.iter().enumerate().map(|(k, step)| schedule.next(&format!("steps[{k}]"), step)).collect()
}

/// What one step hands on to the next.
struct Schedule<'m> {
    model: &'m Model,
    start: f64,
    scheme: Scheme,
    increments: Option<IncrementSettings>,
    in_force: InForce,
    /// whether the last step may end before its time
    may_end_early: bool,
    damping: Vec<Damping>,
    /// those of the last step
    supports: Vec<Prescribed>,
    loads: LoadsInForce,
    temperatures: BTreeMap<usize, Amplitude>,
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
        if std::mem::replace(&mut self.may_end_early, given.until.is_some()) {
            self.in_force.stay();
        }
        supports(&mut self.in_force, &given.supports, place, span, self.model)?;
        hold_axis(&mut self.in_force.dofs, place, span, self.model)?;
        let before = std::mem::replace(&mut self.supports, self.in_force.all(place, self.model)?);
        // In motion there is no rest of the reaction: what held is gone.
        let released = if scheme.is_dynamic() { Vec::new() } else { freed(&before, &self.supports) };
        for (k, load) in given.loads.iter().enumerate() {
            self.loads.change(load, &format!("{place}.loads[{k}]"), span, self.model)?;
        }
        self.damp(&given.damping, place)?;
        temperatures(&mut self.temperatures, given, place, span, self.model)?;
        defined::check(place, given, (scheme, span), self.model)?;
        let stabilization = stabilization(&format!("{place}.stabilize"), given, scheme, self.model)?;
        let increments = if stabilization.is_empty() { increments } else { increments.at_most(0.5 * given.duration) };
        let mut step = Step {
            name: given.name.clone(),
            span,
            scheme,
            increments,
            rupture: None,
            launch: launch(given, scheme, place, self.model)?,
            supports: self.supports.clone(),
            released,
            loads: self.loads.all(),
            damping: self.damping.clone(),
            until: None,
            temperatures: in_force(&self.temperatures),
            stabilization,
        };
        step.until = until(place, given, &step, self.model)?;
        step.rupture = rupture(&format!("{place}.rupture"), given.rupture, &step, self.model)?.map(Box::new);
        Ok(step)
    }

    /// Give bodies another damping.
    fn damp(&mut self, given: &[(String, Damping)], place: &str) -> Checked<()> {
        let bodies = &self.model.bodies;
        for (name, damping) in given {
            let place = format!("{place}.damping.{name}");
            let Some(body) = bodies.iter().position(|body| body.name == *name) else {
                let known: Vec<&str> = bodies.iter().map(|body| body.name.as_str()).collect();
                let message = format!("there is no body of this name; the bodies are {}", known.join(", "));
                return Err(ModelError::new(place, message));
            };
            check_damping(*damping, &*bodies[body].material, &place)?;
            self.damping[body] = *damping;
        }
        Ok(())
    }
}
