//! Increments of a step, its stabilization, and when it goes on explicitly.

use super::error::{Checked, ModelError};
use super::load_step::{IncrementSettings, LoadStep, RuptureSettings};
use crate::model::boundary::Span;
use crate::model::scheme::Scheme;
use crate::model::{Body, Increments, Model, Rupture, Step};

/// Shortest increment as a share of the run time at its end: below it, round-off would swallow the increment.
const SHORTEST_INCREMENT: f64 = 16.0 * f64::EPSILON;

/// A run of more increments, or rows of results, is a slip of the keyboard: it would take days for a single point.
pub const MOST_INCREMENTS: f64 = 1e8;

/// The increments of a step, what is not given chosen by its first.
pub fn increments(place: &str, given: Option<IncrementSettings>, span: Span, scheme: Scheme) -> Checked<Increments> {
    let duration = span.end - span.start;
    let given = given.unwrap_or(IncrementSettings::from(0.1 * duration));
    let least = SHORTEST_INCREMENT * span.end;
    let quasi_dynamic = matches!(scheme, Scheme::QuasiDynamic { .. });
    let (default_min, default_max) = match given.error {
        None if quasi_dynamic => (least, given.initial.max(0.1 * duration)),
        None => (1e-3 * given.initial, given.initial),
        Some(_) => ((1e-6 * given.initial).max(least), given.initial.max(0.1 * duration)),
    };
    let (min, max) = (given.min.unwrap_or(default_min), given.max.unwrap_or(default_max));
    let increments = Increments { initial: given.initial, min, max, error: given.error };
    for (name, value) in [("initial", Some(given.initial)), ("error", given.error)] {
        value.map_or(Ok(()), |value| check_positive(&format!("{place}.{name}"), value))?;
    }
    check_bounds(place, [min, max], span, scheme)?;
    if given.initial > max || given.initial < min {
        let message = format!("initial = {} must lie between min = {min} and max = {max}", given.initial);
        return Err(ModelError::new(place, message));
    }
    if given.error.is_some() && scheme != Scheme::Static && scheme.error_constant().is_none() {
        let message = match scheme {
            Scheme::Explicit { .. } => "explicit takes increments as long as they are stable: leave error out",
            Scheme::QuasiDynamic { .. } => "quasi_dynamic has a tolerance of its own: leave error out",
            Scheme::Wilson { .. } => "wilson has no estimate of its error: take newmark, hht or generalized_alpha",
            _ => "newmark with beta near 1/6 has no estimate of its error: take another beta",
        };
        return Err(ModelError::new(format!("{place}.error"), message));
    }
    Ok(increments)
}

/// Bounds of increments must leave room between them, not be lost in the round-off of the time, and not ask for too many
/// increments of what is left of a step.
pub fn check_bounds(place: &str, [min, max]: [f64; 2], left: Span, scheme: Scheme) -> Checked<()> {
    check_positive(&format!("{place}.min"), min)?;
    check_positive(&format!("{place}.max"), max)?;
    if min > max {
        let message = format!("min = {min} is above max = {max}: increments must have room between them");
        return Err(ModelError::new(place, message));
    }
    let (end, least, duration) = (left.end, SHORTEST_INCREMENT * left.end, left.end - left.start);
    if min < least {
        // Where the two are one number, it is max that was given.
        let name = if min < max { "min" } else { "max" };
        let message = format!("is {min:e}: at the time {end:e} increments below {least:.1e} are lost in round-off");
        return Err(ModelError::new(format!("{place}.{name}"), message));
    }
    let count = duration / max;
    if count > MOST_INCREMENTS && !matches!(scheme, Scheme::Explicit { .. }) {
        let message = format!(
            "increments of at most {max:e} make {count:.1e} of them in a step of {duration:e}, and {MOST_INCREMENTS:e} are the \
             most: make them longer"
        );
        return Err(ModelError::new(place, message));
    }
    Ok(())
}

fn check_positive(place: &str, value: f64) -> Checked<()> {
    match value > 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(ModelError::new(place, format!("is {value}: must be positive"))),
    }
}

/// c₀ of every dof: the nodes of a body share `stabilize` × (λ + 2G) × duration.
pub fn stabilization(place: &str, given: &LoadStep, scheme: Scheme, model: &Model) -> Checked<Vec<f64>> {
    let Some(share) = given.stabilize else { return Ok(Vec::new()) };
    if !(share > 0.0 && share <= 1.0) {
        let message =
            format!("is {share}: must be a share of the stiffness, above 0 and at most 1 (1e-3 is a good start)");
        return Err(ModelError::new(place, message));
    }
    if scheme != Scheme::Static {
        return Err(ModelError::new(place, "is for static steps: in a dynamic one inertia holds the bodies"));
    }
    let mut coefficients = vec![0.0; model.dofs()];
    for body in &model.bodies {
        let coefficient = share * body.material.p_wave_modulus() * given.duration / body.nodes.len() as f64;
        let dofs = body.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]);
        dofs.for_each(|dof| coefficients[dof] = coefficient * model.mesh.section.weight(model.mesh.nodes[dof / 2]));
    }
    Ok(coefficients)
}

/// When a step goes on explicitly, and how.
pub fn rupture(place: &str, given: Option<RuptureSettings>, step: &Step, model: &Model) -> Checked<Option<Rupture>> {
    let Some(RuptureSettings { slip_rate, safety }) = given else { return Ok(None) };
    if !(slip_rate > 0.0 && slip_rate.is_finite()) {
        return Err(ModelError::new(format!("{place}.slip_rate"), format!("is {slip_rate}: must be positive")));
    }
    if matches!(step.scheme, Scheme::Explicit { .. }) {
        return Err(ModelError::new(place, "is for static and implicit steps: this one is explicit throughout"));
    }
    if matches!(step.scheme, Scheme::QuasiDynamic { .. }) {
        return Err(ModelError::new(
            place,
            "is for static and implicit steps: this one follows slip at any rate by itself",
        ));
    }
    if model.contacts.is_empty() {
        return Err(ModelError::new(place, "needs a contact that may slip: leave it out"));
    }
    if model.bodies.is_empty() {
        let cause = "needs a body: slip is over when it is slow over the time in which a shear wave crosses the bodies; use a \
                     dynamic scheme under error control (`dt.error`)";
        return Err(ModelError::new(place, cause));
    }
    let scheme = Scheme::Explicit { safety };
    scheme.check().map_err(|error| ModelError::new(place, error))?;
    let slowest = |body: &Body| (body.material.shear_modulus() / body.material.density()).sqrt();
    let slowest = model.bodies.iter().map(slowest).fold(f64::INFINITY, f64::min);
    let calm = (model.mesh.diagonal() / slowest).max(step.increments.min);
    let increments = Increments { error: None, ..step.increments };
    let explicit = Step { scheme, increments, stabilization: Vec::new(), ..step.clone() };
    Ok(Some(Rupture { slip_rate, calm, explicit }))
}
