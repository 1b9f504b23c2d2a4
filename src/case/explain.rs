//! serde's complaints in the words of somebody who writes a case.

use crate::mesh::names::{in_line, nearest};

/// Longest piece of the user's own text that a message repeats.
const LONGEST: usize = 100;

const OBJECT: &str = "an object {…}";

/// serde's complaint of an object whose only key should choose a variant.
pub const SEVERAL_KEYS: &str = "invalid value: map, expected map with a single key";

/// A complaint of serde as a sentence; unknown names come with the nearest known one.
pub fn explain(message: &str) -> String {
    if message.starts_with("unknown field") || message.starts_with("unknown variant") {
        return unknown(message);
    }
    if let Some(rest) = message.strip_prefix("missing field ") {
        return format!("the key {rest} is missing here");
    }
    if message == SEVERAL_KEYS {
        return "has several keys, but must be an object {…} with exactly one key".into();
    }
    let Some((found, expected)) = message.split_once(", expected ") else { return clipped(message) };
    let expected = plain_expected(expected);
    if let Some(found) = found.strip_prefix("invalid type: ").or_else(|| found.strip_prefix("invalid value: ")) {
        return format!("is {}, but must be {expected}", plain_found(found));
    }
    match found.strip_prefix("invalid length ") {
        Some(_) if expected == OBJECT => format!("is a list […], but must be {OBJECT}"),
        Some(length) => format!("has {length} entries, but must have {expected}"),
        None => clipped(message),
    }
}

/// serde quotes the unknown name first, and then all known ones.
fn unknown(message: &str) -> String {
    let mut quoted = message.split('`').skip(1).step_by(2);
    let name = quoted.next().unwrap_or_default();
    let known: Vec<&str> = quoted.collect();
    let name_shown = clipped(name);
    if known.is_empty() {
        return format!("`{name_shown}` is not known here: leave it out, nothing more may stand in this object");
    }
    let meant =
        nearest(name, known.iter().copied()).map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
    let stop = if meant.is_empty() { "." } else { "" };
    format!("`{name_shown}` is not known here{meant}{stop} Known are `{}`", known.join("`, `"))
}

fn plain_found(found: &str) -> String {
    let value = found.split_once('`').map(|(_, value)| value.trim_end_matches('`'));
    match (found, value) {
        ("map", _) => "an object {…}".into(),
        ("sequence", _) => "a list […]".into(),
        (_, Some(value)) => clipped(value),
        _ => clipped(found.strip_prefix("string ").unwrap_or(found)),
    }
}

fn plain_expected(expected: &str) -> &str {
    match expected {
        "f64" => "a number",
        "u64" | "usize" => "a whole number, 0 or more",
        "a string" => "text in quotes",
        "a boolean" => "true or false",
        "a map" => OBJECT,
        "a sequence" => "a list […]",
        "an array of length 2" => "2 numbers",
        "an array of length 4" => "4",
        "fewer elements in array" | "fewer elements in map" => "fewer",
        "enum" => "an object {…} with exactly one key",
        "string or map" | "variant identifier" => "a name in quotes, or an object {…} with one key",
        _ if ["struct ", "internally tagged enum "].iter().any(|kind| expected.starts_with(kind)) => OBJECT,
        _ => expected,
    }
}

/// The text in one line, cut where it is too long for a message.
pub fn clipped(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", in_line(&text[..end])),
        None => in_line(text).into(),
    }
}
