//! The schemas that `fecontact schema` prints explain every key and leave no room for others. (That they accept the cases of this
//! repository and refuse what the reader refuses: `python/tests/test_schema.py`.)

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;

use serde_json::{Value, json};

fn schema() -> Value {
    printed(&["schema"])
}

fn printed(arguments: &[&str]) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_fecontact_tested")).args(arguments).output().unwrap();
    assert!(output.status.success());
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn the_schema_of_cases_is_meant_where_none_is_named() {
    assert_eq!(printed(&["schema", "case"]), schema());
}

#[test]
fn no_object_takes_unknown_keys() {
    let mut open = Vec::new();
    find_open(&schema(), "", &mut open);
    find_open(&printed(&["schema", "law"]), "law", &mut open);
    assert!(open.is_empty(), "any key may stand at {open:#?}");
}

/// Objects of known keys that leave room for others, whatever these hold; parameters by name, as `along` has them beside its
/// `law`, hold profiles.
fn find_open(schema: &Value, place: &str, open: &mut Vec<String>) {
    let others = &schema["additionalProperties"];
    let message = *others == json!(false) || others.is_object();
    if schema.get("properties").is_some_and(Value::is_object) && !message {
        open.push(place.into());
    }
    match schema {
        Value::Object(object) => {
            object.iter().for_each(|(key, value)| find_open(value, &format!("{place}/{key}"), open))
        }
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(k, value)| find_open(value, &format!("{place}/{k}"), open))
        }
        _ => {}
    }
}

#[test]
fn every_key_is_explained() {
    let mut silent = Vec::new();
    find_silent(&schema(), "", &mut silent);
    find_silent(&printed(&["schema", "law"]), "law", &mut silent);
    assert!(silent.is_empty(), "no description at {silent:#?}");
}

/// The whole page is compared by `docs/reference.py --check`, which needs Python; this tells of a key that it lacks.
#[test]
fn the_reference_has_every_key() {
    let page = crate::common::repository("docs/reference/case_file.md");
    let page = fs::read_to_string(page).unwrap();
    let mut keys = BTreeSet::new();
    find_keys(&schema(), &mut keys);
    find_keys(&printed(&["schema", "law"]), &mut keys);
    assert!(keys.len() > 100, "{keys:?}");
    keys.retain(|key| {
        ![format!("| `{key}` |"), format!("**`{{\"{key}\"")].iter().any(|message| page.contains(message))
    });
    // Tags of a choice: `"law": "coulomb"`.
    keys.retain(|key| !page.contains(&format!("**`\"{key}\": ")));
    assert!(keys.is_empty(), "python3 docs/reference.py: the page has no {keys:?}");
}

fn find_keys(schema: &Value, keys: &mut BTreeSet<String>) {
    let properties = schema.get("properties").and_then(Value::as_object);
    keys.extend(properties.into_iter().flatten().map(|(key, _)| key.clone()));
    match schema {
        Value::Object(object) => object.values().for_each(|value| find_keys(value, keys)),
        Value::Array(list) => list.iter().for_each(|value| find_keys(value, keys)),
        _ => {}
    }
}

fn find_silent(schema: &Value, place: &str, silent: &mut Vec<String>) {
    for (key, property) in schema.get("properties").and_then(Value::as_object).into_iter().flatten() {
        if property.get("description").and_then(Value::as_str).is_none_or(str::is_empty) {
            silent.push(format!("{place}/{key}"));
        }
    }
    match schema {
        Value::Object(object) => {
            object.iter().for_each(|(key, value)| find_silent(value, &format!("{place}/{key}"), silent))
        }
        Value::Array(list) => list.iter().for_each(|value| find_silent(value, place, silent)),
        _ => {}
    }
}
