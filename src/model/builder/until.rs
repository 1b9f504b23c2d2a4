//! A reaction that ends a step, and what has no meaning in a step that may end before its time.

use super::error::{Checked, ModelError};
use super::groups::{nodes_at, originals};
use super::load_step::{LoadStep, UntilSettings};
use crate::contact::pair::ContactPair;
use crate::model::boundary::{Amplitude, Drive};
use crate::model::scheme::Scheme;
use crate::model::support::Motion;
use crate::model::until::{Part, Until};
use crate::model::{Model, Step};

/// A looser tolerance is no value.
const LOOSEST: f64 = 0.1;

/// The reaction that ends a step, if one does.
pub fn until(place: &str, given: &LoadStep, step: &Step, model: &Model) -> Checked<Option<Until>> {
    let Some(UntilSettings { on, part, value, tolerance }) = &given.until else { return Ok(None) };
    let (part, value, tolerance) = (*part, *value, *tolerance);
    let place = format!("{place}.until");
    let refused = |key: &str, message: String| Err(ModelError::new(format!("{place}{key}"), message));
    if !value.is_finite() || part == Part::Size && value < 0.0 {
        let kind = if part == Part::Size { "zero or positive, the size of a force" } else { "a finite number" };
        return refused(&format!(".{}", part.name()), format!("is {value}: must be {kind}"));
    }
    if !(tolerance > 0.0 && tolerance <= LOOSEST) {
        return refused(
            ".tolerance",
            format!("is {tolerance}: must be above 0 and at most {LOOSEST}; 1e-6 is the default"),
        );
    }
    let nodes = nodes_at(&model.mesh, on, &format!("{place}.on"))?;
    let held = [0, 1].map(|i| originals(model, &model.held(&nodes, i)));
    let along = |i: usize| {
        let of = |node: &usize| held[i].binary_search(node).is_ok();
        step.supports.iter().any(|support| of(&support.at.node()) && support.at.vector()[i] != 0.0)
    };
    let (has, axis) = match part {
        Part::X => (along(0), " along x"),
        Part::Y => (along(1), " along y"),
        Part::Size => (along(0) || along(1), ""),
    };
    if !has {
        let message =
            format!("{on} has no support{axis} in this step, and no reaction: name the side that is moved or held");
        return refused(".on", message);
    }
    check_step(&place, given, step, model)?;
    Ok(Some(Until { on: on.to_string(), held, part, value, tolerance }))
}

/// What counts on the whole of the step.
fn check_step(place: &str, given: &LoadStep, step: &Step, model: &Model) -> Checked<()> {
    let refused = |message: &str| Err(ModelError::new(place, message));
    if matches!(step.scheme, Scheme::Explicit { .. } | Scheme::QuasiDynamic { .. }) {
        return refused("ends static and implicit steps alone: leave it out, and give the step its time");
    }
    if given.rupture.is_some() {
        return refused(
            "and rupture do not go together: what slips fast is explicit, and has no increments that are cut",
        );
    }
    if given.stabilize.is_some() || !step.released.is_empty() {
        return refused(
            "ends the step before its time, and what fades over the step (stabilize, or the reaction of supports that null frees) \
             would be left: let it fade in a step before",
        );
    }
    check_ramps(place, step, model)
}

/// What comes to a value over the whole of the step would go on coming to it in the next one.
fn check_ramps(place: &str, step: &Step, model: &Model) -> Checked<()> {
    let refused = |what: &str, instead: &str| {
        let message = format!("ends the step before its time, and {what} would not be there yet: {instead}");
        Err(ModelError::new(place, message))
    };
    let is_new = |of: &Amplitude| of.span == step.span && matches!(of.drive, Drive::Constant(_) | Drive::ByPlace(..));
    let mut loads = step.loads.clone();
    let mut turns = step.supports.iter().filter_map(|support| match &support.motion {
        Motion::Rotation { angle, .. } => Some(angle),
        _ => None,
    });
    if loads.amplitudes().any(|amplitude| is_new(amplitude)) || turns.any(is_new) {
        return refused(
            "a load, driver or rotation given as a number (or ended by null)",
            "give it in the step before, or as a rate, table or expression",
        );
    }
    if let Some(heated) = step.temperatures.iter().find(|temperature| is_new(&temperature.amplitude)) {
        return refused(
            &format!("the temperature of `{}`, given as a number or by place,", model.bodies[heated.body].name),
            "give it in the step before, or as a rate, table in time or expression",
        );
    }
    let fits = |pair: &&ContactPair| pair.points.iter().any(|point| point.overlap > 0.0);
    match model.contacts.iter().find(fits).filter(|_| step.span.start == 0.0) {
        Some(pair) => refused(
            &format!("the overlap of `{}`, brought in over the first step (shrink_fit),", pair.name),
            "bring it in over a step without until before this one",
        ),
        None => Ok(()),
    }
}
