//! What the arrays of the store are called, and what they are.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value, json};

use super::codec::{Number, RELATIVE_ERROR};
use super::zarr::Description;
use crate::contact::pair::ContactPair;
use crate::model::Model;
use crate::output::events::{Interface, Point};

/// Quantities of every contact: name, CF-like long name, units as powers of length, force and time.
pub const QUANTITIES: [(&str, &str, Option<Unit>); 9] = [
    ("slip", "plastic slip so far, positive along the tangent of the master", Some(Unit::Length)),
    ("total_slip", "plastic and elastic slip", Some(Unit::Length)),
    ("slip_rate", "plastic slip since the record before over the time since", Some(Unit::Speed)),
    ("p", "contact pressure, positive in compression", Some(Unit::Stress)),
    ("q", "friction traction, resisting positive slip", Some(Unit::Stress)),
    ("gap", "gap of the surfaces, positive when open", Some(Unit::Length)),
    ("R", "ratio of the traction to its peak |q|/(mu p)", None),
    ("mu", "peak friction coefficient available now", None),
    ("structure", "degree of structure 1/R*", None),
];

/// Quantities of some contacts.
const OF_SOME: [(&str, &str, Option<Unit>); 3] = [
    ("p_w", "pressure of the fluid, beside the contact pressure", Some(Unit::Stress)),
    ("dilation", "opening by dilatancy", Some(Unit::Length)),
    ("wear", "depth of wear", Some(Unit::Length)),
];

/// Where the slip stands among them, ...
pub const SLIP: usize = 0;
/// ... and its rate.
pub const SLIP_RATE: usize = 2;

/// What a friction-free contact's slip is.
const FREE_MOTION: &str = "motion along the master so far; the contact has no friction";

/// What a quantity is measured in.
#[derive(Clone, Copy)]
pub enum Unit {
    /// [L]
    Length,
    /// [L/T]
    Speed,
    /// [F/L²]
    Stress,
}

/// Names of the contacts as they can stand in names of files, each one once.
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

/// The times of the records.
pub fn time(units: &BTreeMap<String, String>) -> Description {
    let mut attributes = Map::new();
    attributes.insert("long_name".into(), json!("time"));
    attributes.insert("axis".into(), json!("T"));
    attributes.extend(unit_of_time(units).map(|unit| ("units".into(), json!(unit))));
    Description { name: "time".into(), number: Number::Double, dimensions: vec!["time".into()], attributes }
}

/// Where the points of a contact are before anything moves.
pub fn along(
    model: &Model,
    pair: &ContactPair,
    prefix: &str,
    units: &BTreeMap<String, String>,
) -> Vec<(Description, Vec<f64>)> {
    let points = Interface::new(model, pair).points;
    let array = |name: &str, long_name: &str, number: Number, values: Vec<f64>| {
        let mut attributes = Map::new();
        attributes.insert("long_name".into(), json!(format!("{}: {long_name}", pair.name)));
        let unit = units.get("length").filter(|_| number == Number::Double);
        attributes.extend(unit.map(|unit| ("units".into(), json!(unit))));
        let dimensions = vec![format!("{prefix}.point")];
        (Description { name: format!("{prefix}.{name}"), number, dimensions, attributes }, values)
    };
    let values = |of: fn(&Point) -> f64| points.iter().map(of).collect::<Vec<f64>>();
    vec![
        array("position", "way along the slave, undeformed", Number::Double, values(|point| point.position)),
        array("x", "x of the points, undeformed", Number::Double, values(|point| point.at[0])),
        array("y", "y of the points, undeformed", Number::Double, values(|point| point.at[1])),
        array("line", "number of the unbroken line of the slave", Number::Whole, values(|point| point.line as f64)),
    ]
}

/// A quantity of a contact.
pub fn quantity(pair: &ContactPair, prefix: &str, name: &str, units: &BTreeMap<String, String>) -> Description {
    let known = QUANTITIES.iter().chain(&OF_SOME).find(|(known, ..)| *known == name);
    let free = pair.laws.iter().all(|law| law.description.is_frictionless) && ["slip", "total_slip"].contains(&name);
    let long_name = if free { FREE_MOTION } else { known.map_or(name, |(_, long_name, _)| long_name) };
    let mut attributes: Map<String, Value> = Map::new();
    attributes.insert("long_name".into(), json!(format!("{}: {long_name}", pair.name)));
    attributes.insert("coordinates".into(), json!(["position", "x", "y"].map(|at| format!("{prefix}.{at}")).join(" ")));
    attributes.insert("relative_error".into(), json!(RELATIVE_ERROR));
    let unit = match known {
        Some((.., Some(unit))) => unit_of(*unit, units),
        Some(_) => Some("1".into()),
        None => None,
    };
    attributes.extend(unit.map(|unit| ("units".into(), json!(unit))));
    let dimensions = vec!["time".into(), format!("{prefix}.point")];
    Description { name: format!("{prefix}.{name}"), number: Number::Single, dimensions, attributes }
}

/// The label of the unit of time; under their full names numbers would be read as durations.
fn unit_of_time(units: &BTreeMap<String, String>) -> Option<&str> {
    let short = |unit| match unit {
        "seconds" => "s",
        "milliseconds" => "ms",
        "minutes" => "min",
        "hours" => "h",
        "days" => "d",
        other => other,
    };
    units.get("time").map(|unit| short(unit.as_str()))
}

/// The label of a unit, made of those that are known.
fn unit_of(unit: Unit, units: &BTreeMap<String, String>) -> Option<String> {
    let label = |of: &str| units.get(of);
    match unit {
        Unit::Length => label("length").cloned(),
        Unit::Speed => Some(format!("{} {}-1", label("length")?, unit_of_time(units)?)),
        Unit::Stress => match label("stress") {
            Some(unit) => Some(unit.clone()),
            None => Some(format!("{} {}-2", label("force")?, label("length")?)),
        },
    }
}
