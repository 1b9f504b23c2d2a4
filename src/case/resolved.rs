//! Resolved case: every default filled in, with bitwise identical results.

use serde_json::{Map, Value};

use super::file::Case;
use crate::bars::Bar;
use crate::contact::pair::ContactPair;
use crate::laws::friction::{Cohesion, FrictionParameters};
use crate::model::Model;
use crate::model::builder::{BarInput, Contact, DefaultAlphaT, Friction, default_alpha_t, with_friction};
use crate::model::method::{Chosen, Method};

/// Returns the case of a model as the text of a file, with the defaults chosen by the model: scheme and increments of every
/// step, and of contacts the method and the stiffnesses. Those of a case that begins with another one are kept, since they must
/// equal those of the other.
pub fn resolved(case: &Case, model: &Model) -> String {
    let mut case = case.clone();
    let taken_over = model.steps.len().saturating_sub(case.steps.len());
    for (given, step) in case.steps.iter_mut().zip(&model.steps[taken_over..]) {
        given.scheme = Some(step.scheme);
        given.dt = Some(step.increments.into());
    }
    if case.begin_with.is_none() {
        for (pair, chosen) in model.contacts.iter().zip(&model.methods) {
            if let Some(contact) = case.contacts.get_mut(&pair.name) {
                written_out(contact, &pair.name, model);
                let alpha_t = default_alpha_t(contact, model, &case.steps);
                fill(contact, pair.alpha_n, chosen.as_ref(), alpha_t);
                keep_opening(contact, pair, model);
                keep_stiffness(contact, pair);
            }
        }
    }
    for bar in &model.bars {
        if let Some(input) = case.bars.get_mut(&bar.name).filter(|_| case.begin_with.is_none()) {
            fill_bar(input, bar);
        }
    }
    // Values read from JSON can be written as JSON.
    serde_json::to_string_pretty(&case).unwrap_or_default()
}

/// Segments and penalties of a bar along one line, which are the same all along it.
fn fill_bar(input: &mut BarInput, bar: &Bar) {
    if input.points.len() != 2 {
        return;
    }
    input.segments = Some(bar.segments.len());
    let bond = input.embedded.as_mut().and_then(|embedded| embedded.bond.as_mut());
    let (Some(bond), Some(first)) = (bond, bar.grips.first()) else { return };
    if bar.grips.iter().all(|grip| grip.normal == first.normal && grip.bond == first.bond) {
        (bond.stiffness, bond.normal) = (Some(first.bond.stiffness()), Some(first.normal));
    }
}

/// Writes the friction and the bond of an interface in place of its strength.
pub(super) fn written_out(contact: &mut Contact, name: &str, model: &Model) {
    let named = Contact { name: name.into(), ..contact.clone() };
    if let Ok(written) = with_friction(&named, model) {
        *contact = written;
    }
}

fn fill(contact: &mut Contact, alpha_n: f64, chosen: Option<&Chosen>, default: Option<DefaultAlphaT>) {
    contact.normal.alpha_n = Some(alpha_n);
    let Some(Chosen { method, points, .. }) = chosen else { return };
    contact.method = Some(*method);
    if *method == Method::GaussToSegment {
        contact.points = Some(*points);
    }
    let Some(default) = default else { return };
    if let Some(parameters) = contact.friction.parameters() {
        contact.friction = Friction::from(with_alpha_t(parameters, default));
    }
    for choice in &mut contact.along.law {
        choice.friction = with_alpha_t(&choice.friction, default);
    }
}

/// Writes the opening over which strength without pressure fades into a contact that leaves it open; quasi-dynamic steps know none.
pub(super) fn keep_opening(contact: &mut Contact, pair: &ContactPair, model: &Model) {
    if model.steps.iter().any(|step| step.scheme.is_quasi_dynamic()) {
        return;
    }
    if let Some(cohesion) = pair.laws.iter().find_map(|law| law.cohesion.as_ref()) {
        contact.bond.get_or_insert_default().opening = Some(cohesion.bond().opening());
    }
}

/// Writes the stiffness of a bond that no friction law gives into a contact.
fn keep_stiffness(contact: &mut Contact, pair: &ContactPair) {
    let of_friction = pair.laws.iter().all(|law| law.law.description().stiffness_is_penalty);
    let bond_stiffness = pair.laws.iter().find_map(|law| match &law.cohesion {
        Some(Cohesion::Parallel(bond)) => Some(bond.stiffness()),
        _ => None,
    });
    if let (false, Some(stiffness), Some(bond)) = (of_friction, bond_stiffness, &mut contact.bond) {
        bond.alpha_t = Some(stiffness);
    }
}

/// Writes those openings into a document: they stay as other values vary.
pub(super) fn keep_openings(document: &mut Value, model: &Model) {
    for pair in &model.contacts {
        let chosen = pair.fades.filter(|fades| fades.is_chosen);
        let cohesion = chosen.and_then(|_| pair.laws.iter().find_map(|law| law.cohesion.as_ref()));
        let contact = document.get_mut("contacts").and_then(|contacts| contacts.get_mut(&pair.name));
        let (Some(cohesion), Some(contact)) = (cohesion, contact) else { continue };
        if !contact["bond"].is_object() {
            contact["bond"] = Value::Object(Map::new());
        }
        contact["bond"]["opening"] = cohesion.bond().opening().into();
    }
}

/// Returns the parameters with the default α_t, if they have one and do not specify it.
fn with_alpha_t(parameters: &FrictionParameters, default: DefaultAlphaT) -> FrictionParameters {
    let alpha_t = default.of(|alpha_t| parameters.build(alpha_t));
    let filled = |mut fields: Value| {
        match fields.get_mut("alpha_t") {
            Some(open @ Value::Null) => *open = alpha_t.into(),
            _ => return None,
        }
        super::read::input(&fields).ok()
    };
    serde_json::to_value(parameters).ok().and_then(filled).unwrap_or_else(|| parameters.clone())
}

/// Returns the document of a case with the defaults of its types filled in, so that explicit defaults make no difference;
/// unchanged if it is not a valid case.
pub fn with_defaults(document: &Value) -> Value {
    let read = super::read::input::<Case>(document).ok();
    read.and_then(|case| serde_json::to_value(case).ok()).unwrap_or_else(|| document.clone())
}
