//! Velocities and accelerations at a trial displacement, as the scheme and the supports say.

use nalgebra::Vector2;

use super::trial::Trial;
use super::turning::{self, Turning};
use crate::model::Model;
use crate::model::scheme::{Coefficients, supported_rates};
use crate::model::support::Prescribed;

/// Velocity and acceleration at `u`; prescribed dofs have those of their supports.
pub(super) fn rates(model: &Model, trial: Trial, u: &[f64], scheme: Coefficients) -> (Vec<f64>, Vec<f64>) {
    let Trial { old, step, dt, .. } = trial;
    let free =
        |dof: usize| scheme.rates(u[dof] - old.displacement[dof], (old.velocity[dof], old.acceleration[dof]), dt);
    let (mut velocity, mut acceleration): (Vec<f64>, Vec<f64>) = (0..u.len()).map(free).unzip();
    for support in &step.supports {
        let places = trial.thirds(support, model);
        let (v, a) = supported_rates(places, support.at.of(&old.velocity), dt);
        let missed = missed(support, places[3], u);
        support.at.set(v + scheme.dvelocity(dt) * missed, &mut velocity);
        support.at.set(a + scheme.dacceleration(dt) * missed, &mut acceleration);
    }
    model.ties.spread(2, &mut velocity);
    model.ties.spread(2, &mut acceleration);
    for (dof, base, leads) in followed(model, trial, u) {
        velocity[dof] = leads(&velocity) + scheme.dvelocity(dt) * (u[dof] - base);
        acceleration[dof] = leads(&acceleration) + scheme.dacceleration(dt) * (u[dof] - base);
    }
    for plate in Turning::all(model, trial, u, scheme) {
        plate.velocities(scheme.dvelocity(dt), &mut velocity);
        plate.accelerations(scheme.dacceleration(dt), &mut acceleration);
    }
    turning::spread(model, scheme.dvelocity(dt), u, &mut velocity);
    turning::spread(model, scheme.dacceleration(dt), u, &mut acceleration);
    (velocity, acceleration)
}

/// Dofs that follow supported ones: where their leaders are to be, and how their values follow. What follows a free one has the
/// rates of its own displacement, which are the same in the solution.
pub(super) fn followed<'a>(
    model: &'a Model,
    trial: Trial<'a>,
    u: &'a [f64],
) -> impl Iterator<Item = (usize, f64, impl Fn(&[f64]) -> f64 + 'a)> {
    let target = move |dof: usize| trial.step.support_at(dof).map(|support| trial.prescribed(support, model));
    let dofs =
        model.linkage.followers.iter().flat_map(|follower| follower.dofs().map(move |(i, dof)| (follower, i, dof)));
    dofs.filter_map(move |(follower, i, dof)| {
        target(model.linkage.leading(dof))?;
        let base = follower.led_by(i, |dof| target(dof).unwrap_or(u[dof]));
        Some((dof, base, move |values: &[f64]| follower.led(i, values)))
    })
}

/// d·u − ū of an inclined support, which vanishes in the solution: with it the rates of its node vary alike in all directions, and
/// their tangent needs no turning. Along a coordinate the rates are those of the support wherever the dof is.
pub(super) fn missed(support: &Prescribed, target: f64, u: &[f64]) -> f64 {
    if support.at.inclined.is_some() { support.at.of(u) - target } else { 0.0 }
}

/// v of one dof at the end of the increment, and ∂v/∂u: what [`rates`] says or, in statics, the mean of the increment. An
/// increment of no length leaves v as it is.
pub(super) fn velocity(model: &Model, trial: Trial, u: &[f64], dof: usize) -> (f64, f64) {
    let Trial { old, step, dt, .. } = trial;
    let dof = model.linkage.leading(2 * model.ties.original(dof / 2) + dof % 2);
    let (increment, before) = (u[dof] - old.displacement[dof], old.velocity[dof]);
    if dt == 0.0 {
        return (before, 0.0);
    }
    let Some(scheme) = step.scheme.coefficients() else { return (increment / dt, 1.0 / dt) };
    let free =
        |dof: usize| scheme.rates(u[dof] - old.displacement[dof], (old.velocity[dof], old.acceleration[dof]), dt).0;
    match step.support_at(dof) {
        Some(support) if support.at.inclined.is_some() => {
            let places = trial.thirds(support, model);
            let along = supported_rates(places, support.at.of(&old.velocity), dt).0
                + scheme.dvelocity(dt) * missed(support, places[3], u);
            let (d, first) = (support.at.vector(), dof & !1);
            let rates = Vector2::new(free(first), free(first + 1));
            ((rates + d * (along - d.dot(&rates)))[dof % 2], scheme.dvelocity(dt))
        }
        Some(support) => (supported_rates(trial.thirds(support, model), before, dt).0, 0.0),
        None => (free(dof), scheme.dvelocity(dt)),
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
    let straight = step.supports.iter().filter(|support| support.at.inclined.is_none());
    straight.for_each(|support| dvelocity[support.at.dof] = 0.0);
    model.ties.spread(2, &mut dvelocity);
    Some((rates(model, trial, u, scheme).0, dvelocity))
}
