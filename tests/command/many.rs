//! Cases of many parts: the work of reading and checking them grows with their size, or little faster, so that each of these is
//! over in a moment; where it grew with the square or the cube of it, they took from a quarter of a minute to hours.

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use serde_json::{Value, json};
use tempfile::TempDir;

/// What `check` says of a case; it must be a good one.
#[track_caller]
fn checked(case: &Value) -> String {
    let folder = TempDir::new().expect("a folder");
    fs::write(folder.path().join("case.json"), case.to_string()).expect("a file");
    let program = env!("CARGO_BIN_EXE_fecontact_tested");
    let output = Command::new(program).current_dir(folder.path()).args(["check", "case.json"]).output();
    let output = output.expect("the program runs");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("a text")
}

fn material() -> Value {
    json!({"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}})
}

/// A block of one body: a rectangle of so many elements, with names of its lower and upper side.
fn block(body: &str, corners: [Value; 4], elements: [usize; 2], [low, high]: [&str; 2]) -> Value {
    json!({"body": body, "corners": corners, "elements": elements, "sides": [low, null, high, null]})
}

/// The unit square of a body, moved to the right.
fn square(body: &str, x: f64, elements: [usize; 2], sides: [&str; 2]) -> Value {
    block(body, [json!([x, 0]), json!([x + 1.0, 0]), json!([x + 1.0, 1]), json!([x, 1])], elements, sides)
}

/// Bodies on a mesh, held below and pressed from above.
fn pressed(mesh: Value, bodies: impl IntoIterator<Item = String>) -> Value {
    let bodies: BTreeMap<String, Value> = bodies.into_iter().map(|body| (body, material())).collect();
    json!({
        "mesh": mesh,
        "bodies": bodies,
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 1}, "supports": [
            {"on": "low", "ux": 0, "uy": 0}, {"on": "high", "uy": -0.01}]}],
    })
}

/// Parameters that depend on each other in a chain, against the order of their names.
#[test]
fn a_chain_of_parameters() {
    let count = 2000;
    let mut parameters: BTreeMap<String, Value> =
        (1..count).map(|k| (format!("p{k:04}"), json!(format!("p{:04}", k + 1)))).collect();
    parameters.insert(format!("p{count:04}"), json!(2.0));
    let corners = [json!([0, 0]), json!(["p0001", 0]), json!(["p0001", 1]), json!([0, 1])];
    let blocks = [block("bar", corners, [1, 1], ["low", "high"])];
    let message = checked(&pressed(json!({"parameters": parameters, "blocks": blocks}), ["bar".into()]));
    assert!(message.contains("x from 0 to 2"), "{message}");
}

/// Blocks in a row, each joined to the next.
#[test]
fn a_row_of_blocks() {
    let blocks: Vec<Value> = (0..5000).map(|k| square("bar", f64::from(k), [1, 1], ["low", "high"])).collect();
    let message = checked(&pressed(json!({"blocks": blocks}), ["bar".into()]));
    assert!(message.contains("10002 nodes, 5000 elements"), "{message}");
}

/// Feet of a long bar, each on a rigid floor of its own.
#[test]
fn many_contacts_with_rigid_bodies() {
    let count = 300;
    let names: Vec<String> = (0..count).map(|k| format!("foot{k:03}")).collect();
    let blocks: Vec<Value> =
        (0..count).map(|k| square("bar", f64::from(k as u32), [1, 1], [&names[k], "high"])).collect();
    let mut case = pressed(json!({"blocks": blocks}), ["bar".into()]);
    case["steps"][0]["supports"] = json!([{"on": "high", "ux": 0, "uy": -0.01}]);
    let contact = |name: &String| {
        let plane = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
        let normal = json!({"penetration": 1e-4});
        (
            format!("on_{name}"),
            json!({"slave": name, "master": plane, "normal": normal, "friction": {"law": "coulomb", "mu": 0.3}}),
        )
    };
    case["contacts"] = names.iter().map(contact).collect::<serde_json::Map<_, _>>().into();
    assert!(checked(&case).contains("on_foot299"));
}

/// Bodies with plates that turn, with loads, probes and all.
#[test]
fn many_bodies_with_plates_that_turn() {
    let count = 1000;
    let name = |kind: &str, k: usize| format!("{kind}{k:03}");
    let blocks: Vec<Value> = (0..count)
        .map(|k| square(&name("b", k), 2.0 * k as f64, [1, 1], [&name("low", k), &name("high", k)]))
        .collect();
    let mut case = pressed(json!({"blocks": blocks}), (0..count).map(|k| name("b", k)));
    let all = || 0..count;
    case["plates"] = all().map(|k| json!({"on": name("high", k), "moves": "rigid"})).collect();
    case["steps"][0]["supports"] = all().map(|k| json!({"on": name("low", k), "ux": 0, "uy": 0})).collect();
    case["steps"][0]["loads"] = all().map(|k| json!({"on": name("high", k), "total_force": {"y": -0.01}})).collect();
    case["watch"] = all().map(|k| json!(name("low", k))).collect();
    let probe = |k: usize| (name("gauge", k), json!({"at": [2.0 * k as f64 + 0.5, 0.5]}));
    case["probes"] = all().map(probe).collect::<serde_json::Map<_, _>>().into();
    assert!(checked(&case).contains("1000 probes in probes.csv"));
}

/// A line of probes through a fine mesh.
#[test]
fn many_probes_in_many_elements() {
    let blocks = [square("bar", 0.0, [150, 150], ["low", "high"])];
    let mut case = pressed(json!({"blocks": blocks}), ["bar".into()]);
    case["probes"] = json!({"line": {"from": [0.01, 0.02], "to": [0.99, 0.98], "number": 20_000}});
    assert!(checked(&case).contains("20000 probes in probes.csv"));
}

/// Point masses of their own groups.
#[test]
fn many_point_masses() {
    let count = 20_000;
    let name = |k: usize| format!("m{k:05}");
    let nodes: Vec<Value> = (0..count).map(|k| json!([k, 0])).collect();
    let masses = |of: fn(usize) -> Value| (0..count).map(|k| (name(k), of(k))).collect::<serde_json::Map<_, _>>();
    let case = json!({
        "mesh": {"nodes": nodes, "points": masses(|k| json!([k]))},
        "point_masses": masses(|_| json!({"mass": 1})),
        "steps": [{"name": "fly", "duration": 1, "dt": {"initial": 1}, "scheme": {"newmark": {}}}],
    });
    assert!(checked(&case).contains("m19999"));
}
