//! A run as an iterator: every increment tried twice, dropped, stopped and resumed, to the same bits; loads changed on the way.

use std::path::Path;
use std::sync::Arc;

use crate::common::{Blocks, finish_at};
use fecontact::model::Model;
use fecontact::model::state::State;
use fecontact::run::Simulation;
use serde_json::{Value, json};

fn repository(file: &str) -> (Value, std::path::PathBuf) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let case = std::fs::read_to_string(&path).expect("a committed case");
    (serde_json::from_str(&case).expect("JSON"), path)
}

/// Every increment is tried and dropped, the run stopped, resumed with nothing but what was saved, and the increment made.
fn redone_and_resumed(model: &Arc<Model>) -> Vec<State> {
    let mut simulation = Simulation::new(model.clone());
    let mut states = Vec::new();
    while let Some(dropped) = simulation.attempt().expect("the step begins") {
        let saved = simulation.save();
        simulation = Simulation::resume(model.clone(), saved);
        let again = simulation.attempt().expect("it begins").expect("there is one");
        assert_eq!(dropped.is_accepted(), again.is_accepted());
        assert!(dropped.state() == again.state(), "the attempt at {} is another one", simulation.state().time);
        states.extend(again.state().cloned());
        simulation.follow(again).expect("it goes on");
    }
    states
}

#[track_caller]
fn check(case: &Value, path: &Path) {
    let run = finish_at(case, path);
    let states = redone_and_resumed(&run.model);
    assert_eq!(states.len(), run.states.len());
    for (k, (redone, straight)) in states.iter().zip(&run.states).enumerate() {
        assert!(redone == straight, "increment {k} has other bits, time {}", straight.time);
    }
}

/// A block pressed and dragged over another one, its contact by a method, with a scheme.
fn dragged(contact: Value, scheme: Value) -> Value {
    let mesh = Blocks::default().rectangle("ground", [12, 3], [0.0, -0.5], [3.0, 0.0]).rectangle(
        "block",
        [5, 3],
        [0.4, 0.01],
        [1.4, 0.51],
    );
    let material = json!({"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 1e-4});
    let mut base = json!({
        "slave": "block_bottom", "master": "ground_top",
        "friction": {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 2e3, "r": 100, "kappa": 10, "xi": 0.002,
            "m": 1, "n": 1, "structure": 2.0},
    });
    for (key, value) in contact.as_object().expect("an object") {
        base[key] = value.clone();
    }
    json!({
        "mesh": mesh.json(),
        "bodies": {"ground": {"material": material}, "block": {"material": material}},
        "contacts": {"base": base},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.5, "min": 1e-4}, "supports": [
                {"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.02},
            ]},
            {"name": "drag", "duration": 4, "scheme": scheme, "dt": {"initial": 1.0, "min": 1e-4},
                "supports": [{"on": "block_top", "ux": {"rate": 0.1}}]},
        ],
    })
}

#[test]
fn every_increment_of_static_and_implicit_runs_can_be_redone_and_resumed() {
    let methods = [
        json!({"method": "node_to_segment"}),
        json!({"method": "gauss_to_segment"}),
        json!({"method": "mortar"}),
        json!({"method": "gauss_to_segment", "normal": {"penetration": 1e-6}}),
    ];
    for contact in methods {
        check(&dragged(contact, json!("static")), Path::new("test.json"));
    }
    for scheme in [json!({"hht": {"alpha": -0.1}}), json!({"newmark": {}}), json!({"wilson": {}})] {
        check(&dragged(json!({}), scheme), Path::new("test.json"));
    }
}

#[test]
fn every_increment_of_committed_cases_can_be_redone_and_resumed() {
    for file in ["cases/coulomb_drag_5k.json", "cases/tube.json"] {
        let (case, path) = repository(file);
        check(&case, &path);
    }
    let (mut case, path) = repository("cases/block_on_ground.json");
    case["steps"][1]["duration"] = json!(2);
    check(&case, &path);
}
