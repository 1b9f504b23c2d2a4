//! The schemas that `fecontact schema` prints: they accept the cases of this repository, refuse bad ones, and explain
//! every key.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
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

fn cases(folder: &Path) -> Vec<PathBuf> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<_>, Vec<_>) = paths.partition(|path| path.is_dir());
    let files = files.into_iter().filter(|path| path.extension() == Some("json".as_ref()));
    files.chain(folders.iter().flat_map(|folder| cases(folder))).collect()
}

#[test]
fn every_case_is_valid() {
    let folder = crate::common::repository("cases");
    let (tests, cases): (Vec<_>, Vec<_>) =
        cases(&folder).into_iter().partition(|path| path.starts_with(folder.join("law")));
    every_file_is_valid(&tests, &printed(&["schema", "law"]));
    every_file_is_valid(&cases, &schema());
    assert_eq!(printed(&["schema", "case"]), schema());
}

fn every_file_is_valid(files: &[PathBuf], schema: &Value) {
    let validator = jsonschema::validator_for(schema).unwrap();
    assert!(!files.is_empty());
    for path in files {
        let case: Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
        let errors: Vec<String> =
            validator.iter_errors(&case).map(|error| format!("{}: {error}", error.instance_path())).collect();
        assert!(errors.is_empty(), "{}: {errors:?}", path.display());
    }
}

#[test]
fn bad_cases_are_not() {
    let validator = jsonschema::validator_for(&schema()).unwrap();
    let good = json!({
        "mesh": "a.msh",
        "bodies": {"block": {"material": {"model": "linear", "E": 1, "nu": 0.3}}},
        "contacts": {"base": {"slave": "a", "master": "b", "friction": {"law": "coulomb", "mu": 0.3}}},
        "steps": [{"name": "press", "duration": 1, "supports": [{"on": "top", "ux": 0, "uy": {"rate": 1}}]}]
    });
    assert!(validator.is_valid(&good));
    for (pointer, key, value) in [
        ("", "contact", json!({})),
        ("", "steps", json!({})),
        ("", "mesh", json!(3)),
        ("/bodies/block", "colour", json!("red")),
        ("/bodies/block/material", "young", json!(1)),
        ("/bodies/block/material", "E", json!("soft")),
        ("/bodies/block/material", "model", json!("rubber")),
        ("/contacts/base", "points", json!(2.5)),
        ("/contacts/base", "master", json!({"plane": {"point": [0, 0]}})),
        ("/contacts/base/friction", "mus", json!(1)),
        ("/steps/0", "scheme", json!("newmrk")),
        ("/steps/0", "dt", json!({"min": 1})),
        ("/steps/0/supports/0", "uz", json!(0)),
        ("/steps/0/supports/0", "ux", json!({"rat": 1})),
        ("/steps/0/supports/0", "on", json!({"node": -1})),
    ] {
        let mut bad = good.clone();
        bad.pointer_mut(pointer).unwrap()[key] = value.clone();
        assert!(!validator.is_valid(&bad), "{pointer}/{key}: {value} is accepted");
    }
}

#[test]
fn bad_tests_of_a_law_are_not() {
    let validator = jsonschema::validator_for(&printed(&["schema", "law"])).unwrap();
    let good = json!({
        "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 1000}, "initial": {"pressure": 1},
        "path": [{"duration": 1, "slip": "sin(t)", "pressure": {"table": [[0, 1], [1, 2]]}}]
    });
    assert!(validator.is_valid(&good));
    for (pointer, key, value) in [
        ("", "mesh", json!("a.msh")),
        ("", "path", json!([[0, 0, 1]])),
        ("", "table", json!([[0, 0]])),
        ("/friction", "law", json!("rubber")),
        ("/initial", "presure", json!(1)),
        ("/path/0", "durations", json!(1)),
        ("/path/0", "slip", json!([1])),
    ] {
        let mut bad = good.clone();
        bad.pointer_mut(pointer).unwrap()[key] = value.clone();
        assert!(!validator.is_valid(&bad), "{pointer}/{key}: {value} is accepted");
    }
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
    let told = *others == json!(false) || others.is_object();
    if schema.get("properties").is_some_and(Value::is_object) && !told {
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
    keys.retain(|key| ![format!("| `{key}` |"), format!("**`{{\"{key}\"")].iter().any(|told| page.contains(told)));
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
