//! Loads in the form of the case file, changed between two increments of a run.

use std::path::Path;

use serde_json::Value;

use super::error::CaseError;
use super::file::Case;
use super::read;
use crate::model::boundary::Span;
use crate::model::builder::{Checked, Load, LoadsInForce, refuse_if};
use crate::run::Simulation;

/// Loads of the current step, with the changes of its caller.
#[derive(Clone)]
pub struct LoadChanges {
    /// number of the step
    step: usize,
    in_force: LoadsInForce,
}

impl LoadChanges {
    /// Returns the loads of a case in the current step of its run, with the caller's changes `before`.
    fn of(case: &Case, simulation: &Simulation, before: Option<&Self>) -> Checked<Self> {
        let model = simulation.model();
        let message = "cannot be set after a step that `until` ended early: set it in the steps";
        refuse_if(simulation.has_ended_early(), "load", message)?;
        let step = simulation.step_number();
        if let Some(before) = before.filter(|before| before.step == step) {
            return Ok(before.clone());
        }
        Ok(Self { step, in_force: LoadsInForce::of_step(step, &case.steps, model)? })
    }
}

/// Changes a load from now on, as in a step that begins now and ends at the time `by`; immediately if `by` is now. It remains
/// until the end of the current step. `loading` contains the earlier changes in it.
///
/// # Errors
/// Returns [`CaseError`] with the place within the load if it is invalid.
pub fn load(
    case: &Case,
    path: &Path,
    simulation: &mut Simulation,
    loading: &mut Option<LoadChanges>,
    document: &Value,
    by: f64,
) -> Result<(), CaseError> {
    changed(case, simulation, loading, document, by).map_err(|complaint| complaint.in_file(path))
}

fn changed(
    case: &Case,
    simulation: &mut Simulation,
    loading: &mut Option<LoadChanges>,
    document: &Value,
    by: f64,
) -> Checked<()> {
    let now = simulation.state().time;
    let message = format!("is {by}: must not be before the current time, {now}");
    refuse_if(!(by >= now && by.is_finite()), "by", message)?;
    let load: Load = read::input(document)?;
    let mut changed = LoadChanges::of(case, simulation, loading.as_ref())?;
    changed.in_force.change_within(&load, "load", Span { start: now, end: by }, simulation.model())?;
    let loads = changed.in_force.all();
    simulation.change(|step| step.loads = loads.clone());
    *loading = Some(changed);
    Ok(())
}
