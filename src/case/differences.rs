//! How two cases differ, place by place.

use serde_json::{Map, Value};

use super::error::{Checked, Complaint};
use super::explain::clipped;

/// Parameters of friction that only the start of a run depends on, or that what is stored depends on.
const STARTING: [&str; 4] = ["alpha_t", "law", "structure", "theta"];

/// Differences that are told at once.
const TOLD: usize = 5;

/// A place where two cases differ.
pub struct Difference {
    place: String,
    was: Option<Value>,
    is: Option<Value>,
}

impl Difference {
    /// Whether it makes a variant of the same model: other parameters of friction, other damping.
    pub fn is_variant(&self) -> bool {
        let parts: Vec<&str> = self.place.split('.').collect();
        match parts[..] {
            ["contacts", _, "friction", parameter, ..] => !STARTING.contains(&parameter),
            ["bodies", _, "damping", ..] => true,
            _ => false,
        }
    }
}

/// Refuse differences, if there are any.
pub fn told(differences: Vec<Difference>, what: &str) -> Checked<()> {
    if differences.is_empty() {
        return Ok(());
    }
    let value = |value: &Option<Value>| value.as_ref().map_or("not given".into(), |value| clipped(&value.to_string()));
    let told = differences.iter().take(TOLD);
    let told: Vec<String> = told
        .map(|Difference { place, was, is }| format!("`{}` is {}, and was {}", clipped(place), value(is), value(was)))
        .collect();
    let more =
        if differences.len() > TOLD { format!(", and {} more", differences.len() - TOLD) } else { String::new() };
    Err(Complaint::new("", format!("{what}: {}{more}", told.join("; "))))
}

/// The keys of a value; none unless it is an object.
pub fn object(value: &Value) -> &Map<String, Value> {
    static NONE: std::sync::LazyLock<Map<String, Value>> = std::sync::LazyLock::new(Map::new);
    value.as_object().unwrap_or(&NONE)
}

/// Keys of two objects with their values in both.
pub fn both<'a>(
    was: &'a Map<String, Value>,
    is: &'a Map<String, Value>,
) -> impl Iterator<Item = (&'a str, Option<&'a Value>, Option<&'a Value>)> {
    let new = is.keys().filter(|key| !was.contains_key(*key));
    was.keys().chain(new).map(|key| (key.as_str(), was.get(key), is.get(key)))
}

/// Note how what stands at a place of two cases differs.
pub fn compare(place: String, was: Option<&Value>, is: Option<&Value>, differences: &mut Vec<Difference>) {
    match (was, is) {
        // Two meshes are compared themselves, wherever they lie.
        (Some(Value::String(_)), Some(Value::String(_))) if place == "mesh" => {}
        (Some(Value::Object(was)), Some(Value::Object(is))) => {
            both(was, is).for_each(|(key, was, is)| compare(format!("{place}.{key}"), was, is, differences));
        }
        (Some(Value::Array(was)), Some(Value::Array(is))) => {
            let places = 0..was.len().max(is.len());
            places.for_each(|k| compare(format!("{place}[{k}]"), was.get(k), is.get(k), differences));
        }
        (Some(Value::Number(was)), Some(Value::Number(is))) if was.as_f64() == is.as_f64() => {}
        (was, is) if was == is => {}
        (was, is) => differences.push(Difference { place, was: was.cloned(), is: is.cloned() }),
    }
}
