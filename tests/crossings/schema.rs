//! Every key of the schema, and every law by its name, is in a model that is drawn, or in the list of those that change nothing in it.

use std::collections::BTreeSet;

use fecontact::case;
use serde_json::Value;

use crate::features::Draft;
use crate::model::{Ways, case as written};

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
            "R",
        ],
        "what is written, not what is computed: tests/command",
    ),
    (
        &["blocks", "apart", "joined", "arcs", "corners", "grading", "kind", "middle", "sides", "body"],
        "another way to write a mesh: tests/solver/blocks.rs",
    ),
    (&["node", "near"], "other ways to name a node: tests/solver/boundary.rs"),
    (&["area"], "slaves that are points: tests/contact/contact.rs"),
    (&["tied"], "surfaces that are held together: tests/contact/tied.rs"),
    (&["hole"], "the rim of a hole: tests/contact/contact.rs"),
    (&["outline", "group"], "a polyline by another name: tests/contact/rigid_bodies.rs"),
    (&["fx", "fy"], "components of the force that ends a step: tests/solver/loading.rs"),
    (&["beta", "gamma", "rho_infinity"], "parameters of schemes: tests/time/time_integration.rs"),
    (
        &["gradients", "displacement_gradients"],
        "derivatives of what is computed: gradients.rs, tests/command/gradients.rs",
    ),
    (&["add", "remove"], "bodies that come and go: tests/solver/stages.rs"),
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
