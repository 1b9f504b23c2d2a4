//! Neighbours of a case: the same case with another value at one place, for derivatives of its run ([`crate::output::gradients`]).
//!
//! ```text
//! θ (1 ± 1e-4)                        or θ (1 + 1e-4), θ (1 + 2e-4), or these below θ, at an end of its range
//! ```
//!
//! Truncation leaves ε² of a derivative, some 1e-8 where θ acts smoothly; round-off and the tolerance of the neighbours leave
//! 1e-12/ε or less.

use serde_json::{Map, Number, Value};

use super::CaseError;
use super::file::Case;
use super::read;
use super::resolved::{keep_openings, resolved};
use crate::contact::conduit::Conduit;
use crate::contact::pair::ContactPair;
use crate::mesh::Mesh;
use crate::mesh::names::nearest;
use crate::model::builder::{Checked, ModelError, refuse_if};
use crate::model::{Model, Scheme, Step};
use crate::output::checkpoint::MeshPrint;
use crate::output::gradients::{Parameter, Perturbed};
use crate::solve::neighbour::TOLERANCE;
use std::path::Path;
use std::sync::Arc;

/// ε/θ
const STEP: f64 = 1e-4;

/// k and weights of the values θ + k ε: their differences from the run add up to a derivative, to second order in ε.
const STENCILS: [&[(f64, f64)]; 3] =
    [&[(-1.0, -0.5), (1.0, 0.5)], &[(1.0, 2.0), (2.0, -0.5)], &[(-1.0, -2.0), (-2.0, 0.5)]];

/// Parts of a case whose values act on its run without changing mesh, increments or output.
const PARTS: [&str; 8] =
    ["section", "bodies", "point_masses", "rigid_bodies", "bars", "contacts", "initial_velocity", "steps"];

/// Those among them that change the forces of bodies.
const OF_BODIES: [&str; 2] = ["section", "bodies"];

/// Keys of a step that define its increments.
const OF_INCREMENTS: [&str; 4] = ["duration", "dt", "until", "rupture"];

/// A case whose run is to be differentiated.
pub struct Differentiated<'a> {
    /// the case
    pub case: &'a Case,
    /// the case as JSON
    pub document: &'a Value,
    /// its file
    pub path: &'a Path,
    /// its model
    pub model: &'a Model,
    /// whether it begins with the end of another case
    pub begins_with: bool,
}

impl Differentiated<'_> {
    /// Builds the neighbours of the case for every parameter that it asks for, on its mesh.
    ///
    /// # Errors
    /// Returns [`CaseError`] if a place has no value that can vary, or the run has no derivatives.
    pub fn neighbours(&self, mesh: &Mesh) -> Result<Vec<Parameter>, CaseError> {
        self.neighbours_on(mesh).map_err(|complaint| complaint.in_file(self.path))
    }

    fn neighbours_on(&self, mesh: &Mesh) -> Checked<Vec<Parameter>> {
        let places = &self.case.gradients;
        let message = "a case that begins with the end of another run has no derivatives of that end: give the steps \
            of both in one case";
        refuse_if(self.begins_with, "gradients", message)?;
        self.model.steps.iter().try_for_each(check_step)?;
        let defaults: Value = serde_json::from_str(&resolved(self.case, self.model)).unwrap_or_default();
        let one = |(k, place): (usize, &String)| {
            let at = format!("gradients[{k}]");
            refuse_if(places[..k].contains(place), &at, format_args!("`{place}` is given twice: keep one"))?;
            self.parameter(place, &defaults, mesh)
                .map_err(|message| ModelError::new(at, format!("`{place}`: {message}")))
        };
        places.iter().enumerate().map(one).collect()
    }

    fn parameter(&self, place: &str, defaults: &Value, mesh: &Mesh) -> Result<Parameter, String> {
        let words: Vec<String> = place.replace('[', ".").replace(']', "").split('.').map(String::from).collect();
        let written = find(self.document, &words);
        // What the case leaves open has the value of its default.
        let keys = match written.filter(|keys| !at(self.document, keys).is_null()) {
            Some(keys) => keys,
            None => find(defaults, &words).ok_or_else(|| unknown(defaults, &words))?,
        };
        check_place(&keys)?;
        check_well(self.document, &keys)?;
        let given = Some(at(self.document, &keys)).filter(|value| !value.is_null());
        let value = given.unwrap_or_else(|| at(defaults, &keys));
        let theta = value.as_f64().ok_or_else(|| format!("is {}: it must be a number", kind(value)))?;
        if theta == 0.0 {
            return Err("is 0, and it is varied by a small fraction of itself: give a value other than 0".into());
        }
        let perturbed = |stencil: &[(f64, f64)]| {
            let one = |(k, weight): &(f64, f64)| {
                let model = self.with(&keys, theta * (1.0 + k * STEP), mesh)?;
                Ok(Perturbed { offset: *k, weight: weight / (STEP * theta), model })
            };
            stencil.iter().map(one).collect::<Result<Vec<_>, String>>()
        };
        // At the end of its range a value has neighbours on one side only.
        let [both, above, below] = STENCILS;
        let neighbours =
            perturbed(both).or_else(|why| perturbed(above).or_else(|_| perturbed(below)).map_err(|_| why))?;
        let is_of_bodies = matches!(&keys[0], Key::Name(part) if OF_BODIES.contains(&part.as_str()));
        Ok(Parameter { place: place.into(), is_of_bodies, neighbours })
    }

    /// The model with another value at a place.
    fn with(&self, keys: &[Key], value: f64, mesh: &Mesh) -> Result<Arc<Model>, String> {
        let mut document = self.document.clone();
        keep_openings(&mut document, self.model);
        put(&mut document, keys, Number::from_f64(value).map_or(Value::Null, Value::Number));
        let refused = |place: &str, message: &str| format!("cannot be varied to {value}: {place}: {message}");
        let model = self.model_of(&document, mesh).map_err(|error| refused(&error.place, &error.message))?;
        if !is_alike(self.model, &model) {
            return Err("changes the mesh, contact points or times of steps, which must stay as they are".into());
        }
        Ok(solved_exactly(model))
    }

    fn model_of(&self, document: &Value, mesh: &Mesh) -> Checked<Model> {
        let case: Case = read::input(document)?;
        super::build_on(&case, mesh.clone(), self.path).map_err(|error| ModelError::new(error.place, error.message))
    }
}

/// A model to be solved with the tangent of the run.
fn solved_exactly(mut model: Model) -> Arc<Model> {
    model.newton.tolerance = TOLERANCE;
    model.aids.condense = false;
    Arc::new(model)
}

/// Whether a model has the same unknowns, contact points, internal variables and steps.
fn is_alike(one: &Model, other: &Model) -> bool {
    let points =
        |model: &Model| -> Vec<usize> { model.contacts.iter().map(|pair: &ContactPair| pair.points.len()).collect() };
    let spans = |model: &Model| -> Vec<_> { model.steps.iter().map(|step| (step.span.start, step.span.end)).collect() };
    let corners = |model: &Model| -> Vec<f64> {
        let conduits = model.contacts.iter().filter_map(|pair| pair.conduit.as_ref());
        conduits.flat_map(Conduit::corners).collect()
    };
    MeshPrint::of(&one.mesh) == MeshPrint::of(&other.mesh)
        && points(one) == points(other)
        && one.memories.total() == other.memories.total()
        && spans(one) == spans(other)
        && corners(one) == corners(other)
}

/// Checks that the increments of a step have tangents.
fn check_step(step: &Step) -> Checked<()> {
    let why = match step.scheme {
        Scheme::Explicit { .. } => "is explicit: its increments solve no equations",
        Scheme::QuasiDynamic { .. } => "is quasi-dynamic: its steps solve no equations of the bodies",
        _ if step.rupture.is_some() => "may become explicit (`rupture`), and explicit increments solve no equations",
        _ => return Ok(()),
    };
    let message = format!(
        "step `{}` {why}, so there is no tangent that derivatives could follow from: leave `gradients` out, and \
        compare runs with two values",
        step.name
    );
    Err(ModelError::new("gradients", message))
}

/// A key of an object, or a place in a list.
#[derive(Clone, Debug)]
enum Key {
    Name(String),
    Number(usize),
}

/// Keys from a document to the place that these words name: entries of lists by their number or `name`, and names that have points
/// in them.
fn find(value: &Value, words: &[String]) -> Option<Vec<Key>> {
    if words.is_empty() {
        return Some(Vec::new());
    }
    (1..=words.len()).find_map(|count| {
        let (word, rest) = (words[..count].join("."), &words[count..]);
        let (key, inner) = match value {
            Value::Object(fields) => (Key::Name(word.clone()), fields.get(&word)?),
            Value::Array(list) => {
                let named = || list.iter().position(|entry| entry.get("name").and_then(Value::as_str) == Some(&word));
                let number = named().or_else(|| word.parse().ok())?;
                (Key::Number(number), list.get(number)?)
            }
            _ => return None,
        };
        let mut keys = vec![key];
        keys.extend(find(inner, rest)?);
        Some(keys)
    })
}

/// The value at a place; null if there is none.
fn at<'v>(value: &'v Value, keys: &[Key]) -> &'v Value {
    keys.iter().fold(value, |value, key| match key {
        Key::Name(name) => &value[name.as_str()],
        Key::Number(number) => &value[*number],
    })
}

/// Sets the value at a place; objects that the document leaves out are added.
fn put(document: &mut Value, keys: &[Key], new: Value) {
    let mut place = document;
    for key in keys {
        if let (Key::Name(_), Value::Null) = (key, &*place) {
            *place = Value::Object(Map::new());
        }
        let inner = match (key, place) {
            (Key::Name(name), Value::Object(fields)) => fields.entry(name.clone()).or_insert(Value::Null),
            (Key::Number(number), Value::Array(list)) if *number < list.len() => &mut list[*number],
            // The model then is the one of the case.
            _ => return,
        };
        place = inner;
    }
    *place = new;
}

/// Message for a place that the case does not have.
fn unknown(value: &Value, words: &[String]) -> String {
    let known = (0..words.len()).rev().find_map(|count| Some((count, find(value, &words[..count])?)));
    let (count, keys) = known.unwrap_or_default();
    let word = &words[count.min(words.len() - 1)];
    let names: Vec<String> = match at(value, &keys) {
        Value::Object(fields) => fields.keys().cloned().collect(),
        Value::Array(list) => {
            let name = |(k, entry): (usize, &Value)| entry["name"].as_str().map_or_else(|| k.to_string(), String::from);
            list.iter().enumerate().map(name).collect()
        }
        _ => Vec::new(),
    };
    let meant = nearest(word, names.iter().map(String::as_str)).map(|near| format!("; did you mean `{near}`?"));
    format!("there is no `{word}` in this case{} There are {}", meant.unwrap_or_else(|| ".".into()), names.join(", "))
}

/// Checks that a value there acts on the run alone.
fn check_place(keys: &[Key]) -> Result<(), String> {
    let name = |k: usize| match keys.get(k) {
        Some(Key::Name(name)) => name.as_str(),
        _ => "",
    };
    if !PARTS.contains(&name(0)) {
        return Err(format!(
            "`{}` is not a parameter of the run: derivatives are available with respect to values in {}",
            name(0),
            PARTS.join(", ")
        ));
    }
    let of_steps = name(0) == "steps" && OF_INCREMENTS.contains(&name(2));
    if of_steps || (name(3), name(4)) == ("flow", "error") {
        return Err(format!(
            "`{}` determines the increments, and derivatives are those of a run with fixed increments",
            if of_steps { name(2) } else { name(4) }
        ));
    }
    Ok(())
}

/// Checks that a value is not the place of a pressure that is prescribed along a contact.
fn check_well(document: &Value, keys: &[Key]) -> Result<(), String> {
    let is_place =
        matches!(keys, [.., Key::Name(wells), Key::Number(_), Key::Name(at), _] if wells == "wells" && at == "at");
    if is_place && !at(document, &keys[..keys.len() - 2])["pressure"].is_null() {
        return Err(
            "is the position of a prescribed pressure, which acts at the nearest node: a small change has no effect"
                .into(),
        );
    }
    Ok(())
}

/// A value that is no number, in words.
fn kind(value: &Value) -> String {
    match value {
        Value::String(text) => format!("the text \"{text}\""),
        Value::Array(_) => "a list".into(),
        Value::Object(_) => "an object".into(),
        other => other.to_string(),
    }
}
