//! Names and descriptions of the arrays of the store.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value, json};

use super::codec::{Number, RELATIVE_ERROR};
use super::zarr::Description;
use crate::contact::pair::ContactPair;
use crate::model::Model;
use crate::output::events::{ContactPoints, Point};
use crate::output::quantities::{LENGTH, NONE, PLACE, Quantity, TIME, Unit, in_store};

/// Meaning of the slip of a frictionless contact.
const FREE_MOTION: &str = "sliding along the master so far; the contact has no friction";

/// Unique names of the contacts that are valid in file names.
pub fn prefixes(model: &Model) -> Vec<String> {
    let (mut prefixes, mut taken) = (Vec::new(), BTreeSet::new());
    for pair in &model.contacts {
        let plain = |c: char| if c.is_alphanumeric() || "_-. +()=".contains(c) { c } else { '_' };
        let mut prefix: String = pair.name.chars().map(plain).collect();
        if prefix.starts_with('.') {
            prefix.replace_range(..1, "_");
        }
        while !taken.insert(prefix.to_lowercase()) {
            prefix.push('_');
        }
        prefixes.push(prefix);
    }
    prefixes
}

/// Describes a store.
pub fn attributes(model: &Model) -> Map<String, Value> {
    let mut attributes = Map::new();
    attributes.insert("Conventions".into(), json!("CF-1.11"));
    attributes.insert("title".into(), json!(model.title));
    attributes.insert("source".into(), json!(concat!("fecontact ", env!("CARGO_PKG_VERSION"))));
    attributes.insert("contacts".into(), json!(model.contacts.iter().map(|pair| &pair.name).collect::<Vec<_>>()));
    attributes.insert("prefixes".into(), json!(prefixes(model)));
    attributes
}

/// Describes the times of the records.
pub fn time(units: &BTreeMap<String, String>) -> Description {
    let mut attributes = Map::new();
    attributes.insert("long_name".into(), json!("time"));
    attributes.insert("axis".into(), json!("T"));
    attributes.extend(label(TIME, units).map(|unit| ("units".into(), json!(unit))));
    Description { name: "time".into(), number: Number::Double, dimensions: vec!["time".into()], attributes }
}

/// Describes the undeformed positions of the points of a contact.
pub fn along(
    model: &Model,
    pair: &ContactPair,
    prefix: &str,
    units: &BTreeMap<String, String>,
) -> Vec<(Description, Vec<f64>)> {
    let points = ContactPoints::new(model, pair).points;
    let array = |of: Quantity, value: fn(&Point) -> f64| {
        let mut attributes = Map::new();
        attributes.insert("long_name".into(), json!(format!("{}: {}", pair.name, of.meaning)));
        attributes.extend(label(of.unit, units).map(|unit| ("units".into(), json!(unit))));
        let dimensions = vec![format!("{prefix}.point")];
        let number = if of.unit == LENGTH { Number::Double } else { Number::Whole };
        let description = Description { name: format!("{prefix}.{}", of.name), number, dimensions, attributes };
        (description, points.iter().map(value).collect())
    };
    let [position, x, y, line] = PLACE;
    vec![
        array(position, |point| point.position),
        array(x, |point| point.at[0]),
        array(y, |point| point.at[1]),
        array(line, |point| point.line as f64),
    ]
}

/// Describes a quantity of a contact.
pub fn quantity(pair: &ContactPair, prefix: &str, name: &str, units: &BTreeMap<String, String>) -> Description {
    let known = in_store(name);
    let free = pair.laws.iter().all(|law| law.description.is_frictionless) && ["slip", "total_slip"].contains(&name);
    let long_name = if free { FREE_MOTION } else { known.map_or(name, |known| known.meaning) };
    let mut attributes: Map<String, Value> = Map::new();
    attributes.insert("long_name".into(), json!(format!("{}: {long_name}", pair.name)));
    attributes.insert("coordinates".into(), json!(["position", "x", "y"].map(|at| format!("{prefix}.{at}")).join(" ")));
    attributes.insert("relative_error".into(), json!(RELATIVE_ERROR));
    let unit = known.and_then(|known| label(known.unit, units));
    attributes.extend(unit.map(|unit| ("units".into(), json!(unit))));
    let dimensions = vec!["time".into(), format!("{prefix}.point")];
    Description { name: format!("{prefix}.{name}"), number: Number::Single, dimensions, attributes }
}

/// Describes the derivatives of a quantity of a contact.
pub fn derivatives(pair: &ContactPair, prefix: &str, name: &str) -> Description {
    let known = in_store(name).map_or(name, |known| known.meaning);
    let mut attributes: Map<String, Value> = Map::new();
    attributes.insert("long_name".into(), json!(format!("{}: derivative of {known}", pair.name)));
    attributes.insert("coordinates".into(), json!(["position", "x", "y"].map(|at| format!("{prefix}.{at}")).join(" ")));
    attributes.insert("relative_error".into(), json!(RELATIVE_ERROR));
    let dimensions = vec!["time".into(), "by".into(), format!("{prefix}.point")];
    Description { name: format!("{prefix}.{name}"), number: Number::Single, dimensions, attributes }
}

/// Describes the undeformed nodes, and the derivatives of their displacements.
pub fn of_nodes(model: &Model) -> (Vec<(Description, Vec<f64>)>, Description) {
    let describe = |name: &str, meaning: &str, number: Number, dimensions: &[&str]| {
        let attributes = Map::from_iter([("long_name".into(), json!(meaning))]);
        Description {
            name: name.into(),
            number,
            dimensions: dimensions.iter().map(|name| (*name).into()).collect(),
            attributes,
        }
    };
    let nodes = &model.mesh.nodes[..model.mesh.own_nodes()];
    let place = |name: &str, i: usize| {
        let is = describe(name, &format!("{name} of the undeformed node"), Number::Double, &["node"]);
        (is, nodes.iter().map(|node| node[i]).collect())
    };
    let moved = describe(
        "displacement",
        "derivative of the displacement",
        Number::Single,
        &["time", "by", "node", "component"],
    );
    (vec![place("x", 0), place("y", 1)], moved)
}

/// Unit label according to the CF conventions; full names of time units would be decoded as durations.
fn label(unit: Unit, units: &BTreeMap<String, String>) -> Option<String> {
    let mut units = units.clone();
    if let Some(time) = units.get_mut("time") {
        let short = match time.as_str() {
            "seconds" => "s",
            "milliseconds" => "ms",
            "minutes" => "min",
            "hours" => "h",
            "days" => "d",
            other => other,
        };
        *time = short.to_string();
    }
    if unit == NONE { Some("1".into()) } else { unit.label(&units, Unit::of_store) }
}
