//! Laws with their parameters, as `check` understood them.

use serde::Serialize;
use serde_json::Value;

use crate::model::told::number;

/// The law named by `tag`, and its parameters but those in `skip`.
pub fn parameters(law: &impl Serialize, tag: &str, skip: &[&str]) -> String {
    let Ok(Value::Object(fields)) = serde_json::to_value(law) else { return String::new() };
    let name = fields.get(tag).and_then(Value::as_str).unwrap_or_default();
    let shown = fields.iter().filter(|(key, value)| *key != tag && !skip.contains(&key.as_str()) && !value.is_null());
    let shown: Vec<String> = shown.map(|(key, value)| format!("{key} {}", plain(value))).collect();
    if shown.is_empty() { name.into() } else { format!("{name}: {}", shown.join(", ")) }
}

/// A value without quotation marks or needless digits.
pub fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        value => value.as_f64().map_or_else(|| value.to_string(), number),
    }
}
