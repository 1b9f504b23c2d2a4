//! What varies along an interface: parameters of its law and initial tractions, by reference position.

use std::collections::BTreeMap;

use nalgebra::Vector2;
use serde_json::Value;

use super::build::expression;
use super::error::Complaint;
use super::explain::explain;
use super::file::{ContactInput, ProfileInput, ProfileTable};
use crate::contact::surface::SlavePoint;
use crate::laws::friction::{FrictionLaw, FrictionParameters};
use crate::mesh::Mesh;
use crate::model::boundary::Profile;

type Checked<T> = Result<T, Complaint>;

/// The laws of a contact, and to every slave point the number of its own: one for all that have the same parameters.
pub fn laws(
    place: &str,
    input: &ContactInput,
    points: &mut [SlavePoint],
    mesh: &Mesh,
    default_alpha_t: f64,
) -> Checked<Vec<Box<dyn FrictionLaw>>> {
    let friction = format!("{place}.friction");
    let build = |parameters: &FrictionParameters, place: &str| {
        parameters.build(default_alpha_t).map_err(|error| Complaint::new(place, error))
    };
    let mut varying = Vec::new();
    for (name, input) in &input.along {
        let place = format!("{place}.along.{name}");
        varying.push((name.as_str(), profile(input, &place)?, place));
    }
    if let Some(structure) = input.initial.as_ref().and_then(|initial| initial.structure.as_ref()) {
        let place = format!("{place}.initial.structure");
        if !input.friction.has_structure() {
            return Err(Complaint::new(place, "this friction law has no structure: leave it out"));
        }
        if input.along.contains_key("structure") {
            return Err(Complaint::new(place, "is given by `along` already: leave one of them out"));
        }
        varying.push(("structure", profile(structure, &place)?, place));
    }
    let first = build(&input.friction, &friction)?;
    if varying.is_empty() {
        return Ok(vec![first]);
    }
    let mut laws = Vec::new();
    let mut numbers: BTreeMap<Vec<u64>, usize> = BTreeMap::new();
    for point in points {
        let at = position(point, mesh);
        let values =
            varying.iter().map(|(_, profile, place)| defined(profile, at, place)).collect::<Checked<Vec<_>>>()?;
        let key: Vec<u64> = values.iter().map(|value| value.to_bits()).collect();
        if let Some(&law) = numbers.get(&key) {
            point.law = law;
            continue;
        }
        let mut parameters = input.friction;
        for ((name, _, place), &value) in varying.iter().zip(&values) {
            parameters = with(&parameters, name, value, place)?;
        }
        let (_, _, place) = &varying[0];
        point.law = laws.len();
        numbers.insert(key, laws.len());
        laws.push(build(&parameters, &format!("{place} at ({}, {})", at.x, at.y))?);
    }
    Ok(laws)
}

/// The parameters with one of them replaced.
fn with(parameters: &FrictionParameters, name: &str, value: f64, place: &str) -> Checked<FrictionParameters> {
    let complain = |error: serde_json::Error| Complaint::new(place, explain(&error.to_string()));
    let mut fields = serde_json::to_value(parameters).map_err(complain)?;
    fields[name] = Value::from(value);
    serde_json::from_value(fields).map_err(complain)
}

/// Reference position of a slave point.
pub fn position(point: &SlavePoint, mesh: &Mesh) -> Vector2<f64> {
    point.position.iter().map(|&(node, w)| mesh.nodes[node] * w).sum()
}

/// The value of a profile, which must be a finite number.
pub fn defined(profile: &Profile, at: Vector2<f64>, place: &str) -> Checked<f64> {
    let value = profile.value(at);
    match value.is_finite() {
        true => Ok(value),
        false => Err(Complaint::new(place, format!("is not a finite number at ({}, {})", at.x, at.y))),
    }
}

/// A profile as written, checked.
pub fn profile(input: &ProfileInput, place: &str) -> Checked<Profile> {
    let (component, name, table) = match input {
        ProfileInput::Constant(value) => return Ok(Profile::Constant(*value)),
        ProfileInput::Expression(text) => {
            let expression = expression(text, place)?;
            return match expression.depends_on_time() {
                true => Err(Complaint::new(place, "the time t has no meaning here: the variables are x and y")),
                false => Ok(Profile::Expression(expression)),
            };
        }
        ProfileInput::Table(ProfileTable::X(table)) => (0, "x", table),
        ProfileInput::Table(ProfileTable::Y(table)) => (1, "y", table),
    };
    if table.is_empty() {
        return Err(Complaint::new(
            format!("{place}.{name}"),
            format!("the table is empty: give pairs [{name}, value]"),
        ));
    }
    if let Some(pair) = table.windows(2).find(|pair| pair[1][0] < pair[0][0]) {
        let message = format!("the coordinates of the table must ascend: {} follows {}", pair[1][0], pair[0][0]);
        return Err(Complaint::new(format!("{place}.{name}"), message));
    }
    Ok(Profile::Table(component, table.clone()))
}
