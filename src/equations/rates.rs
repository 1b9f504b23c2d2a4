//! Velocities and accelerations at a trial displacement, as the scheme and the supports say.

use super::trial::Trial;
use crate::model::Model;
use crate::model::scheme::{Coefficients, supported_rates};

/// Velocity and acceleration at `u`; prescribed dofs have those of their supports.
pub(super) fn rates(model: &Model, trial: Trial, u: &[f64], scheme: Coefficients) -> (Vec<f64>, Vec<f64>) {
    let Trial { old, step, dt, .. } = trial;
    let free =
        |dof: usize| scheme.rates(u[dof] - old.displacement[dof], (old.velocity[dof], old.acceleration[dof]), dt);
    let (mut velocity, mut acceleration): (Vec<f64>, Vec<f64>) = (0..u.len()).map(free).unzip();
    for support in &step.supports {
        let dof = support.dof;
        let places = trial.thirds(support, model);
        (velocity[dof], acceleration[dof]) = supported_rates(places, old.velocity[dof], dt);
    }
    model.ties.spread(2, &mut velocity);
    model.ties.spread(2, &mut acceleration);
    (velocity, acceleration)
}

/// v of one dof at the end of the increment, and ∂v/∂u: what [`rates`] says or, in statics, the mean of the increment. An
/// increment of no length leaves v as it is.
pub(super) fn velocity(model: &Model, trial: Trial, u: &[f64], dof: usize) -> (f64, f64) {
    let Trial { old, step, dt, .. } = trial;
    let dof = 2 * model.ties.original(dof / 2) + dof % 2;
    let (increment, before) = (u[dof] - old.displacement[dof], old.velocity[dof]);
    if dt == 0.0 {
        return (before, 0.0);
    }
    let Some(scheme) = step.scheme.coefficients() else { return (increment / dt, 1.0 / dt) };
    match step.supports.binary_search_by_key(&dof, |support| support.dof) {
        Ok(support) => (supported_rates(trial.thirds(&step.supports[support], model), before, dt).0, 0.0),
        Err(_) => (scheme.rates(increment, (before, old.acceleration[dof]), dt).0, scheme.dvelocity(dt)),
    }
}

/// v and ∂v/∂u of every dof in a dynamic increment; v alone at the start of dynamics, and nothing in statics.
pub(super) fn motion(model: &Model, trial: Trial, u: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let Trial { old, step, dt, .. } = trial;
    if dt == 0.0 {
        return Some((old.velocity.clone(), vec![0.0; u.len()]));
    }
    let scheme = step.scheme.coefficients()?;
    let mut dvelocity = vec![scheme.dvelocity(dt); u.len()];
    step.supports.iter().for_each(|support| dvelocity[support.dof] = 0.0);
    model.ties.spread(2, &mut dvelocity);
    Some((rates(model, trial, u, scheme).0, dvelocity))
}
