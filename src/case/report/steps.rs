//! Steps in the report of `check`: supports and loads in force in each, and those that it ends.

use serde_json::Value;

use super::contact::plain;
use crate::case::file::Case;
use crate::model::boundary::Drive;
use crate::model::builder::Place;
use crate::model::builder::schedule::critical_slip;
use crate::model::step::{Entry, Until};
use crate::model::text::{count, number, vector};
use crate::model::{Damping, Model, Step};
use crate::time::step_size::EVENT_LOCATION;

/// Lines about every step: scheme, increments, supports and loads in force.
pub fn steps(case: &Case, model: &Model) -> Vec<String> {
    let mut lines = Vec::new();
    for (step, input) in model.steps.iter().zip(&case.steps) {
        lines.push(step.name.clone());
        let mut own = step_lines(step, critical_slip(model, step.span));
        own.extend(
            input
                .remove
                .iter()
                .map(|name| format!("body {name} is removed: its forces on the rest fade over the step")),
        );
        own.extend(
            input
                .add
                .iter()
                .map(|name| format!("body {name} is added, without strain; its weight grows over the step")),
        );
        let launched = input.velocity.iter();
        own.extend(launched.map(|(name, velocity)| format!("{name}: initial velocity {}", vector(*velocity))));
        own.extend(input.damping.iter().map(|(name, Damping { mass, retardation })| {
            format!("damping of {name} from this step on: mass {}, stiffness {}", number(*mass), number(*retardation))
        }));
        own.extend(
            input.temperature.iter().map(|(name, given)| format!("temperature of {name}: {}", Drive::from(given))),
        );
        own.extend(step.entries.iter().map(entry));
        lines.extend(own.into_iter().map(|line| format!("  {line}")));
        lines.push(format!("  {} prescribed", count(step.supports.len(), "dof")));
    }
    lines
}

/// Lines about a step in which `critical` is the smallest D_c of friction that is integrated to first order in time.
fn step_lines(step: &Step, critical: Option<f64>) -> Vec<String> {
    let increments = &step.increments;
    let scheme = match serde_json::to_value(step.scheme) {
        Ok(Value::Object(scheme)) => scheme.iter().map(|(name, numbers)| format!("{name} {numbers}")).collect(),
        scheme => scheme.map(|name| plain(&name)).unwrap_or_default(),
    };
    let [initial, min, max] = [increments.initial, increments.min, increments.max].map(number);
    let mut lines = vec![
        format!("time {} to {}, {scheme}", number(step.span.start), number(step.span.end)),
        format!("dt: initial {initial}, min {min}, max {max}"),
    ];
    if !step.stabilization.is_empty() {
        lines.push("stabilized: fading dashpots constrain bodies until contact does".into());
    }
    lines.extend(step.until.as_ref().map(|until| {
        let Until { on, value, tolerance, .. } = until;
        let [value, tolerance] = [value, tolerance].map(|number_of| number(*number_of));
        format!("ends when {} of {on} reaches {value}, relative tolerance {tolerance}", until.name())
    }));
    lines.extend(increments.error.map(|error| {
        let located = number(EVENT_LOCATION * error);
        let of = match step.scheme.is_dynamic() {
            true => format!("any displacement, contact events located within {located}"),
            false => "the slip of any contact point".into(),
        };
        format!("error per increment at most {} in {of}", number(error))
    }));
    let critical = critical.filter(|_| !step.scheme.is_integrated_explicitly()).map(number);
    lines.extend(critical.and_then(|critical| match (increments.slip, increments.error) {
        (Some(share), _) => {
            Some(format!("error per increment at most {} D_c in slip, D_c {critical} at least", number(share)))
        }
        (None, None) => {
            Some(format!("no error control: slip per increment must be small against D_c, {critical} at least"))
        }
        (None, Some(_)) => None,
    }));
    lines.extend(step.rupture.as_ref().map(|rupture| {
        let [rate, calm] = [rupture.slip_rate, rupture.calm].map(number);
        format!(
            "explicit integration while a contact slips faster than {rate}; implicit again from the mean motion over \
             {calm}"
        )
    }));
    lines
}

/// A support or load that is in force, or that the step ends.
fn entry(Entry { is_load, on, kind, value, kept, fades }: &Entry) -> String {
    let [what, ended, fading] =
        if *is_load { ["load", "ended", "it"] } else { ["support", "released", "its reaction"] };
    match value {
        Some(value) => {
            let equals = if value.starts_with(char::is_alphabetic) { "" } else { "= " };
            let kept = if *kept { " (kept)" } else { "" };
            format!("{what} {on}: {kind} {equals}{value}{kept}")
        }
        None if *fades => format!("{what} {on}: {kind} {ended}, {fading} fades over the step"),
        None => format!("{what} {on}: {kind} {ended}, at once"),
    }
}

/// Describes a watched place by its name in results, with the tag of the node nearest to a point.
pub fn watched(place: &Place, model: &Model) -> String {
    match place {
        Place::Near(_) => format!("{} ({})", place.column(), place.in_words(&model.mesh)),
        _ => place.column(),
    }
}
