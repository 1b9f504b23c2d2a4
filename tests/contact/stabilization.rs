//! Bodies that nothing holds until contact does: steered into contact by a stabilization that is gone at the end of the step.

use std::path::Path;
use std::sync::Arc;

use crate::common::{self, Blocks, Finished, Record, close, finish, model_at};
use fecontact::model::state::State;
use fecontact::run::run;
use serde_json::{Value, json};

const PRESSURE: f64 = 2.0;

/// A column of blocks 1 × 0.5, E = 1000, ν = 0, with gaps between them, over ground that is held; pressure on the last one
/// and nothing else. Each block is turned about its lower left corner.
fn column(blocks: usize, gap: f64, turn: f64, friction: Value) -> Value {
    let mut mesh = Blocks::default().rectangle("ground", [5, 2], [-0.2, -0.5], [1.2, 0.0]);
    let material = json!({"material": {"model": "neo_hookean", "E": 1000, "nu": 0}});
    let (mut bodies, mut contacts) = (json!({"ground": material}), json!({}));
    let mut below = "ground".to_owned();
    for k in 0..blocks {
        let (name, divisions) = (format!("block{k}"), [3 + k, 2]);
        let bottom = (k + 1) as f64 * gap + k as f64 * 0.5;
        mesh = mesh.block(&name, divisions, |s, t| {
            let [x, y] = common::turned([s, 0.5 * t], turn);
            [x, bottom + y]
        });
        bodies[&name] = material.clone();
        contacts[format!("under{k}")] =
            json!({"slave": format!("{name}_bottom"), "master": format!("{below}_top"), "friction": friction});
        below = name;
    }
    json!({
        "mesh": mesh.json(),
        "bodies": bodies,
        "contacts": contacts,
        "steps": [{
            "name": "fall", "duration": 2, "dt": {"initial": 0.1}, "stabilize": 1e-3,
            "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}],
            "loads": [{"on": format!("{below}_top"), "pressure": PRESSURE}]
        }]
    })
}

fn coulomb() -> Value {
    json!({"law": "coulomb", "mu": 0.5})
}

/// Normal force of every contact.
fn normal_forces(run: &Finished, state: &State) -> Vec<f64> {
    let x = run.model.configuration(&state.displacement);
    let mut forces = vec![0.0; run.model.contacts.len()];
    for ((force, pair), states) in forces.iter_mut().zip(&run.model.contacts).zip(&state.contacts) {
        for (point, contact) in pair.points.iter().zip(states) {
            *force += point.current_length(&x) * contact.friction.pressure;
        }
    }
    forces
}

/// Every contact carries the whole load, to Newton's tolerance and the change of the loaded length; nothing else holds the
/// blocks. Flat or tilted by a degree, one block or three.
#[test]
fn free_blocks_settle_on_each_other() {
    for (blocks, turn) in [(1, 0.0), (3, 0.0), (1, 0.0175)] {
        let run = finish(&column(blocks, 0.02, turn, coulomb()));
        let last = run.last();
        for force in normal_forces(&run, last) {
            close(&format!("{blocks} blocks turned by {turn}: force"), force, PRESSURE, 1e-3 * PRESSURE);
        }
        let ground = run.reaction("ground_bottom", last);
        close("reaction", ground[1], PRESSURE, 1e-3 * PRESSURE);
        assert!(run.report.stabilization_work > 0.0);
        let shares = &run.stabilization;
        assert!(shares[0] > 1e-3, "the first increment is not stabilized: {shares:?}");
        assert_eq!(shares.last(), Some(&0.0), "the last increment is still stabilized");
    }
}

/// Without the stabilization the matrix is singular, and the message says what to do. On a smooth rigid plane a stabilized
/// block is still free along x when the stabilization has gone: that is told, not taken for an answer.
#[test]
fn what_contact_does_not_hold_is_named() {
    let message = |case: &Value| {
        let model = model_at(case, Path::new("test.json"));
        let model = Arc::new(model);
        let result = run(&model, &mut [&mut Record::default()]).1;
        result.err().map(|error| error.to_string()).expect("a body floats")
    };
    let mut unaided = column(1, 0.02, 0.0, coulomb());
    unaided["steps"][0]["stabilize"] = Value::Null;
    let text = message(&unaided);
    assert!(text.contains("nothing resists the motion of body `block0`") && text.contains("`stabilize`"), "{text}");
    let mut smooth = column(1, 0.02, 0.0, json!({"law": "frictionless"}));
    smooth["contacts"]["under0"]["master"] = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
    smooth["steps"][0]["loads"] = json!([{"on": "block0_top", "traction": {"y": -PRESSURE}}]);
    let text = message(&smooth);
    assert!(text.contains("nothing resists the motion of body `block0` along x"), "{text}");
}

/// A step that asks for one increment has two: the dashpots fade over the first, and nothing but contact holds the block
/// in the second. A shortest increment longer than half of the step gives way as well.
#[test]
fn a_single_increment_is_stabilized_too() {
    for dt in [json!({"initial": 2}), json!({"initial": 1.5, "max": 2}), json!({"initial": 2, "min": 2})] {
        // A tilted block falls past the ground in its first iterate: it needs increments that may be cut.
        let tilted = dt.get("min").is_none().then_some((1, 0.0175));
        for (blocks, turn) in [(1, 0.0), (2, 0.0)].into_iter().chain(tilted) {
            let mut case = column(blocks, 0.02, turn, coulomb());
            case["steps"][0]["dt"] = dt.clone();
            let run = finish(&case);
            for force in normal_forces(&run, run.last()) {
                close(&format!("{blocks} blocks turned by {turn}, {dt}"), force, PRESSURE, 1e-3 * PRESSURE);
            }
            let shares = &run.stabilization;
            assert!(shares[0] > 0.0 && shares.last() == Some(&0.0), "{dt}: {shares:?}");
        }
    }
}

/// `count` blocks of one element in a row on ground of one element that is held. They stick to it, but for two: one has no
/// friction, or is lifted off the ground.
fn row(count: usize, smooth: Option<usize>, lifted: Option<usize>) -> Value {
    let mut mesh = Blocks::default().rectangle("ground", [1, 1], [-1.0, -1.0], [2.0 * count as f64, 0.0]);
    let material = json!({"material": {"model": "linear", "E": 1000, "nu": 0.3}});
    let mut bodies = json!({"ground": material});
    let (mut rough, mut free) = (Vec::new(), Vec::new());
    for k in 0..count {
        let name = format!("b{k}");
        let (left, bottom) = (2.0 * k as f64, if lifted == Some(k) { 0.1 } else { 0.0 });
        mesh = mesh.rectangle(&name, [1, 1], [left, bottom], [left + 1.0, bottom + 1.0]);
        bodies[&name] = material.clone();
        let edge = json!([4 + 4 * k, 5 + 4 * k]);
        if smooth == Some(k) { &mut free } else { &mut rough }.push(edge);
    }
    let mut mesh = mesh.json();
    mesh["edges"]["rough"] = json!(rough);
    let mut contacts = json!({"rough": {"slave": "rough", "master": "ground_top", "friction": coulomb()}});
    if smooth.is_some() {
        mesh["edges"]["smooth"] = json!(free);
        contacts["smooth"] = json!({"slave": "smooth", "master": "ground_top", "friction": {"law": "frictionless"}});
    }
    let loads: Vec<Value> = (0..count).map(|k| json!({"on": format!("b{k}_top"), "traction": {"y": -1e-3}})).collect();
    json!({
        "mesh": mesh, "bodies": bodies, "contacts": contacts,
        "steps": [{
            "name": "press", "duration": 1, "dt": {"initial": 1},
            "supports": [{"on": "ground", "ux": 0, "uy": 0}], "loads": loads,
        }]
    })
}

/// One body of a thousand that floats is found, beside the group that all others form through the ground, and within it.
/// Singular values of the 3003 motions together would take hours, those of the three of a lone body take nothing.
#[test]
fn one_of_a_thousand_bodies_floats() {
    for (smooth, lifted, expected) in [
        (Some(637), None, "nothing resists the motion of body `b637` along x;"),
        (None, Some(637), "nothing resists the motion of body `b637` "),
    ] {
        let model = model_at(&row(1000, smooth, lifted), Path::new("test.json"));
        let text = run(&Arc::new(model), &mut []).1.err().map(|error| error.to_string()).expect("a body floats");
        assert!(text.contains(expected), "{text}");
        assert_eq!(
            text.matches("body `").count(),
            if lifted.is_some() { text.matches("b637").count() } else { 1 },
            "{text}"
        );
    }
}

/// Two materials with nodes in common are one part: it floats as a whole, and is named so.
#[test]
fn bodies_that_share_nodes_float_together() {
    let material = json!({"material": {"model": "linear", "E": 1000, "nu": 0.3}});
    let case = json!({
        "mesh": {
            "nodes": [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]],
            "elements": {"left": [[0, 1, 4, 3]], "right": [[1, 2, 5, 4]]},
            "edges": {"bottom": [[0, 1], [1, 2]], "top": [[3, 4], [4, 5]]}
        },
        "bodies": {"left": material, "right": material},
        "contacts": {"base": {
            "slave": "bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "friction": {"law": "frictionless"}
        }},
        "steps": [{"name": "press", "duration": 1, "loads": [{"on": "top", "traction": {"y": -1}}]}]
    });
    let model = model_at(&case, Path::new("test.json"));
    let text = run(&Arc::new(model), &mut []).1.err().map(|error| error.to_string()).expect("it floats");
    assert!(text.contains("nothing resists the motion of bodies `left` and `right` along x;"), "{text}");
}
