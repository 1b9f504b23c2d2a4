//! Every key of the schema, and every law by its name, is in a model that is drawn, or in the list of those that change nothing in it.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use fecontact::case;
use serde_json::Value;

use crate::features::Draft;
use crate::model::{Ways, case as written};
use crate::relations::RELATIONS;

/// Keys that no drawn model has, and why.
const ELSEWHERE: &[(&[&str], &str)] = &[
    (
        &[
            "title",
            "units",
            "every",
            "exact",
            "derived",
            "fields",
            "report",
            "checkpoint",
            "points",
            "fronts",
            "arrival",
            "seismic_rate",
            "R",
        ],
        "what is written, not what is computed: tests/command",
    ),
    (
        &["blocks", "separated", "joined", "arcs", "corners", "grading", "kind", "middle", "sides", "body"],
        "another way to write a mesh: tests/solver/blocks.rs",
    ),
    (&["groups", "box", "center"], "another way to name sides and nodes: tests/solver/groups.rs"),
    (&["node"], "another way to name a node: tests/solver/boundary.rs"),
    (&["materials", "frictions"], "another way to write a law: tests/command/by_name.rs"),
    (
        &["b_2", "D_c2", "theta_2"],
        "a second state of friction: tests/laws/comparison_laws.rs, tests/time/quasi_dynamic.rs",
    ),
    (&["area"], "slaves that are points: tests/contact/contact.rs"),
    (&["hole"], "the rim of a hole: tests/contact/contact.rs"),
    (&["fx", "fy"], "components of the force that ends a step: tests/solver/loading.rs"),
    (&["beta", "gamma", "rho_infinity"], "parameters of schemes: tests/time/time_integration.rs"),
    (
        &["gradients", "displacement_gradients"],
        "the relation `derivatives` asks for them, tests/command/gradients.rs for those of all nodes",
    ),
    (&["measured", "file"], "a table in a file: tests/time/fluid_pressure.rs"),
    (
        &["permeability_y", "weighs", "capillary", "head", "impervious", "consolidation"],
        "water that weighs, that comes and goes: tests/solver/consolidation.rs, staged_water.rs, wet_contacts.rs, wet_conduits.rs, tests/time/saturated.rs",
    ),
    (&["clearance"], "a gap that is not that of the mesh: tests/contact/validation.rs"),
    (&["without"], "groups that are a part of another: tests/solver/groups.rs"),
    (
        &["sections"],
        "forces of sections, which nothing depends on; moved, turned, mirrored and in other units: tests/solver/cuts.rs",
    ),
    (
        &["aperture", "per_slip", "closing", "wells", "rate", "from", "leak", "coefficient"],
        "water along a contact that goes by the surfaces, wells and leaks: tests/contact/conduit.rs, tests/time/conduit.rs",
    ),
    (&["begin_with"], "the relation `begun with` does it without folders"),
];

/// Keys whose words are laws.
const NAMING: [&str; 2] = ["law", "model"];

fn keys(value: &Value, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(object) => object.iter().for_each(|(key, value)| {
            found.insert(key.clone());
            if NAMING.contains(&key.as_str()) {
                found.extend(value.as_str().map(|name| format!("{key} {name}")));
            }
            keys(value, found);
        }),
        Value::Array(array) => array.iter().for_each(|value| keys(value, found)),
        _ => {}
    }
}

/// Names of all properties of a schema, and of all laws.
fn properties(value: &Value, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(object) => {
            if let Some(Value::Object(properties)) = object.get("properties") {
                found.extend(properties.keys().cloned());
                let named = |key: &&str| Some(format!("{key} {}", properties.get(*key)?["const"].as_str()?));
                found.extend(NAMING.iter().filter_map(named));
            }
            object.values().for_each(|value| properties_of(value, found));
        }
        Value::Array(array) => array.iter().for_each(|value| properties_of(value, found)),
        _ => {}
    }
}

fn properties_of(value: &Value, found: &mut BTreeSet<String>) {
    properties(value, found);
}

#[test]
fn every_key_is_crossed() {
    let mut written_keys = BTreeSet::new();
    for seed in 0..3000 {
        let draft = Draft::new(seed);
        keys(&written(&draft, &Ways::plain(&draft)), &mut written_keys);
    }
    let mut known = BTreeSet::new();
    properties(&case::schema(), &mut known);
    let elsewhere: BTreeSet<&str> = ELSEWHERE.iter().flat_map(|(keys, _)| keys.iter().copied()).collect();
    let missing: Vec<&String> =
        known.iter().filter(|key| !written_keys.contains(*key) && !elsewhere.contains(key.as_str())).collect();
    assert!(missing.is_empty(), "no model that is drawn has {missing:?}: enter them in tests/crossings/features.rs");
}

/// Every command, option and reader, and the relation that crosses it, or the file in which it is tried.
const AROUND: &[(&str, &str)] = &[
    ("run", "derivatives"),
    ("run --out", "derivatives"),
    ("run --threads", "threads"),
    ("run --quiet", "derivatives"),
    ("run --resume", "further"),
    ("check", "tests/command/input.rs"),
    ("check --resolved", "tests/command/resolved.rs"),
    ("converge", "tests/command/converge.rs"),
    ("converge --measure", "tests/command/converge.rs"),
    ("converge --levels", "tests/command/converge.rs"),
    ("converge --within", "tests/command/converge.rs"),
    ("converge --out", "tests/command/converge.rs"),
    ("converge --threads", "tests/command/converge.rs"),
    ("init", "tests/command/init.rs"),
    ("completions", "tests/command/init.rs"),
    ("safety", "tests/published/safety.rs"),
    ("safety --body", "tests/published/safety.rs"),
    ("safety --contact", "tests/published/safety.rs"),
    ("safety --within", "tests/published/safety.rs"),
    ("safety --most", "tests/published/safety.rs"),
    ("safety --out", "tests/published/safety.rs"),
    ("safety --threads", "tests/published/safety.rs"),
    ("law", "tests/command/law.rs"),
    ("law --out", "tests/command/law.rs"),
    ("report", "tests/command/report.rs"),
    ("report --out", "tests/command/report.rs"),
    ("schema", "tests/command/schema.rs"),
    ("fecontact.Mesh.read", "python/tests/test_meshes.py"),
];

/// Commands and their options as the frozen list has them, and functions of the Python package that read.
fn around() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the checkout");
    let read = |file: &str| fs::read_to_string(root.join(file)).expect(file);
    let mut found = Vec::new();
    let mut command = String::new();
    for line in read("tests/command/surface/commands.txt").lines() {
        match line.trim().split([' ', ',']).find(|word| word.starts_with("--")) {
            Some("--help") => {}
            Some(option) => found.push(format!("{command} {option}")),
            None if !line.starts_with(' ') => {
                command = line.to_owned();
                found.push(command.clone());
            }
            None => {}
        }
    }
    let names = read("python/tests/surface.txt");
    let functions = names.lines().filter_map(|line| line.split_once('(')).map(|(name, _)| name);
    found.extend(
        functions.filter(|name| name.rsplit('.').next().is_some_and(|last| last.starts_with("read"))).map(String::from),
    );
    found
}

#[test]
fn every_option_and_reader_is_crossed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the checkout");
    for (what, place) in AROUND {
        let is_there = RELATIONS.iter().any(|relation| relation.name == *place) || root.join(place).is_file();
        assert!(is_there, "{what}: there is no relation or file {place}");
    }
    let missing: Vec<String> =
        around().into_iter().filter(|what| !AROUND.iter().any(|(known, _)| known == what)).collect();
    assert!(
        missing.is_empty(),
        "{missing:?}: enter a relation that crosses each in tests/crossings, or its test, in AROUND"
    );
}
