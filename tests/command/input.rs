//! Bad input, and runs that cannot go on: every failure has a face.
//!
//! Bad input ends with exit code 2, a message that names file, key and value, and nothing written. A run that stops
//! ends with exit code 1, says when and why, and keeps what it computed.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};
use tempfile::TempDir;

/// A block of three elements on a ground of two.
pub fn good() -> Value {
    json!({
        "mesh": {
            "nodes": [
                [0, -1], [2, -1], [4, -1], [0, 0], [2, 0], [4, 0],
                [0.5, 0], [1.5, 0], [2.5, 0], [3.5, 0], [0.5, 1], [1.5, 1], [2.5, 1], [3.5, 1]
            ],
            "elements": {
                "ground": [[0, 1, 4, 3], [1, 2, 5, 4]],
                "block": [[6, 7, 11, 10], [7, 8, 12, 11], [8, 9, 13, 12]]
            },
            "edges": {
                "ground_bottom": [[0, 1], [1, 2]], "ground_top": [[3, 4], [4, 5]],
                "block_bottom": [[6, 7], [7, 8], [8, 9]], "block_top": [[10, 11], [11, 12], [12, 13]]
            }
        },
        "bodies": {
            "ground": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}},
            "block": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}}
        },
        "contacts": {"base": {
            "slave": "block_bottom", "master": "ground_top",
            "normal": {"alpha_n": 1e5},
            "friction": {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 1e5, "r": 100, "kappa": 10}
        }},
        "steps": [{
            "name": "press", "duration": 1, "dt": {"initial": 0.5, "min": 0.01, "max": 0.5},
            "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.001}]
        }],
        "watch": ["block_top"]
    })
}

/// Pointers of all objects inside a document.
fn objects(value: &Value, pointer: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(object) => {
            found.push(pointer.into());
            object.iter().for_each(|(key, value)| objects(value, &format!("{pointer}/{key}"), found));
        }
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(k, value)| objects(value, &format!("{pointer}/{k}"), found));
        }
        _ => {}
    }
}

/// The good case with the values at these JSON pointers set.
fn with(edits: &[(&str, Value)]) -> Value {
    edited(good(), edits)
}

fn edited(mut case: Value, edits: &[(&str, Value)]) -> Value {
    for (pointer, value) in edits {
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer begins with a slash");
        match case.pointer_mut(parent) {
            Some(Value::Object(object)) => drop(object.insert(key.into(), value.clone())),
            Some(Value::Array(list)) => list[key.parse::<usize>().expect("an index")] = value.clone(),
            _ => panic!("nothing at {parent}"),
        }
    }
    case
}

fn without(pointer: &str) -> Value {
    let mut case = good();
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer begins with a slash");
    let parent = case.pointer_mut(parent).and_then(Value::as_object_mut).expect("an object");
    parent.remove(key).expect("the key is there");
    case
}

fn fecontact(folder: &Path, arguments: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_fecontact_tested")).current_dir(folder).args(arguments).output();
    let output = output.expect("the program starts");
    assert!(!stderr(&output).contains("panicked"), "{arguments:?}: {}", stderr(&output));
    output
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn write(folder: &Path, name: &str, content: impl AsRef<[u8]>) {
    fs::write(folder.join(name), content).expect("the temporary folder can be written");
}

/// The command must end with exit code 2 and one error line that holds all the fragments, and leave no results.
fn refused(folder: &Path, arguments: &[&str], fragments: &[&str]) {
    let output = fecontact(folder, arguments);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?} {fragments:?}: {message}");
    assert!(message.starts_with("error: "), "{message}");
    assert!(message.len() < 2000, "a message of {} bytes", message.len());
    for fragment in fragments {
        assert!(message.contains(fragment), "`{fragment}` is not in: {message}");
    }
    assert!(!folder.join("out").exists(), "results were written: {message}");
}

fn refused_case(case: impl AsRef<[u8]>, fragments: &[&str]) {
    let folder = TempDir::new().expect("a temporary folder");
    write(folder.path(), "bad.json", case);
    for command in ["run", "check"] {
        refused(folder.path(), &[command, "bad.json"], &[&["error: bad.json: "], fragments].concat());
    }
}

fn refused_edits(edits: &[(&str, Value)], fragments: &[&str]) {
    refused_case(with(edits).to_string(), fragments);
}

/// What a command says of the good case with edits, on stdout and stderr.
fn outcome(command: &str, edits: &[(&str, Value)]) -> [String; 2] {
    let folder = TempDir::new().unwrap();
    write(folder.path(), "case.json", with(edits).to_string());
    let output = fecontact(folder.path(), &[command, "case.json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap())
}

#[test]
fn the_good_case_is_good() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), "good.json", good().to_string());
    for arguments in [["check", "good.json"], ["run", "good.json"]] {
        let output = fecontact(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
}

/// Whatever a value is chosen from: no variant lets a key pass that it does not know, nor does an object inside it.
#[test]
fn every_variant_refuses_unknown_keys() {
    let friction = "/contacts/base/friction";
    let material = "/bodies/block/material";
    let master = "/contacts/base/master";
    let (mesh, ux, scheme) = ("/mesh", "/steps/0/supports/1/ux", "/steps/0/scheme");
    let elastic = |model: &str| json!({"model": model, "E": 1000, "nu": 0.3});
    let drag = json!({"rate": 1});
    for (pointer, value) in [
        (friction, json!({"law": "frictionless"})),
        (friction, json!({"law": "coulomb", "mu": 0.3})),
        (friction, json!({"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "r": 100})),
        (friction, json!({"law": "slip_weakening", "mu_s": 0.4, "mu_d": 0.2, "D_c": 1})),
        (friction, json!({"law": "rate_and_state", "f_0": 0.6, "V_0": 1, "a": 0.01, "b": 0.02, "D_c": 1})),
        (material, elastic("linear")),
        (material, elastic("saint_venant_kirchhoff")),
        (material, elastic("neo_hookean")),
        (material, elastic("hencky")),
        (master, json!({"plane": {"point": [0, 0], "normal": [0, 1]}})),
        (master, json!({"circle": {"centre": [0, -5], "radius": 5}})),
        (master, json!({"polyline": {"points": [[0, 0], [4, 0]]}})),
        (mesh, good()["mesh"].clone()),
        (ux, json!({"rate": 1})),
        (ux, json!({"table": [[0, 0], [1, 1]]})),
        (scheme, json!({"newmark": {"beta": 0.3}})),
        (scheme, json!({"hht": {"alpha": -0.05}})),
        (scheme, json!({"generalized_alpha": {"rho_infinity": 0.8}})),
        (scheme, json!({"explicit": {"safety": 0.9}})),
        (scheme, json!({"wilson": {"theta": 1.4}})),
        ("/steps/0/dt", json!({"initial": 0.5, "min": 0.01, "max": 0.5})),
        ("/steps/0/supports/1/on", json!({"node": 1})),
        ("/steps/0/supports/1", json!({"on": "block_top", "rotation": {"about": [0, 0], "angle": drag}})),
        ("/steps/0/loads", json!([{"on": "block_top", "pressure": drag}])),
        ("/steps/0/loads", json!([{"on": "block_top", "dead_pressure": drag}])),
        ("/steps/0/loads", json!([{"on": "block_top", "total_force": {"x": drag}}])),
        ("/steps/0/loads", json!([{"on": "block_top", "traction": {"x": drag}}])),
        ("/steps/0/loads", json!([{"on": "block", "gravity": {"x": 1}}])),
        ("/steps/0/loads", json!([{"on": "block_top", "force": {"x": 1}}])),
        ("/steps/0/loads", json!([{"on": "block_top", "spring": {"kx": 1, "driver": {"x": drag}}}])),
        ("/steps/0/loads", json!([{"on": "block_top", "dashpot": {"cx": 1, "driver": {"x": drag}}}])),
        ("/newton", json!({"tolerance": 1e-8})),
        ("/output", json!({"every": 1, "fronts": {"slip_rate": 1}})),
    ] {
        let case = with(&[(pointer, value.clone())]);
        let mut places = Vec::new();
        objects(&value, pointer, &mut places);
        for place in places {
            let bad = edited(case.clone(), &[(&format!("{place}/stray"), json!(1))]);
            let folder = TempDir::new().unwrap();
            write(folder.path(), "bad.json", bad.to_string());
            let message = stderr(&fecontact(folder.path(), &["check", "bad.json"]));
            // What is chosen by its only key has two now.
            let told =
                message.contains("stray") || message.contains("2 entries") || message.contains("exactly one key");
            assert!(told, "{place}: {message}");
            refused(folder.path(), &["check", "bad.json"], &["bad.json: "]);
        }
    }
    let frictionless = json!({"law": "frictionless", "mu": 0.3});
    refused_edits(
        &[(friction, frictionless)],
        &["contacts.base.friction.mu: ", "`mu` is not known here", "leave it out"],
    );
}

#[test]
fn unknown_keys_are_named_with_the_nearest() {
    for (pointer, place, nearest) in [
        ("/contact", "contact: ", "contacts"),
        ("/bodies/block/materail", "bodies.block.materail: ", "material"),
        ("/bodies/block/material/NU", "bodies.block.material.NU: ", "nu"),
        ("/contacts/base/slaves", "contacts.base.slaves: ", "slave"),
        ("/contacts/base/normal/alpha", "contacts.base.normal.alpha: ", "alpha_n"),
        ("/contacts/base/friction/mus", "contacts.base.friction.mus: ", "mu_s"),
        ("/steps/0/schema", "steps[0].schema: ", "scheme"),
        ("/steps/0/dt/minimum", "steps[0].dt.minimum: ", "min"),
        ("/steps/0/supports/1/uxx", "steps[0].supports[1].uxx: ", "ux"),
        ("/mesh/node", "mesh.node: ", "nodes"),
        ("/newton", "newton.", "tolerance"),
        ("/output", "output.", "every"),
    ] {
        let value = match pointer {
            "/newton" => json!({"tolerence": 1e-6}),
            "/output" => json!({"evry": 2}),
            _ => json!(1),
        };
        refused_edits(&[(pointer, value)], &[place, "is not known here", &format!("did you mean `{nearest}`?")]);
    }
    let support = |ux: Value| ("/steps/0/supports/1/ux", ux);
    refused_edits(&[support(json!({"rat": 1}))], &["steps[0].supports[1].ux", "`rat`", "did you mean `rate`?"]);
    refused_edits(&[support(json!({"rate": 1, "table": []}))], &["steps[0].supports[1].ux", "2 entries"]);
    refused_edits(&[("/steps/0/supports/1/on", json!({"nod": 1}))], &["supports[1].on.nod", "did you mean `node`?"]);
    let master = json!({"plane": {"point": [0, 0], "norm": [0, 1]}});
    refused_edits(&[("/contacts/base/master", master)], &["contacts.base.master.plane.norm", "`normal`"]);
}

#[test]
fn wrong_types_are_named() {
    for (pointer, value, fragments) in [
        ("/title", json!(3), ["title: ", "is 3, but must be text in quotes"]),
        ("/bodies/block/material/E", json!("soft"), ["bodies.block.material.E: ", "\"soft\", but must be a number"]),
        ("/bodies/block/material/nu", json!([0.3]), ["bodies.block.material.nu: ", "a list […], but must be a number"]),
        ("/contacts/base/friction/mu_s", json!(null), ["contacts.base.friction.mu_s: ", "null, but must be a number"]),
        ("/contacts/base/points", json!(2.5), ["contacts.base.points: ", "2.5, but must be a whole number"]),
        ("/contacts/base/points", json!(-2), ["contacts.base.points: ", "-2, but must be a whole number"]),
        ("/contacts/base/friction/approach", json!("linear"), ["contacts.base.friction.approach: ", "`logarithmic`"]),
        ("/contacts/base/friction/law", json!("colomb"), ["contacts.base.friction.law: ", "did you mean `coulomb`?"]),
        ("/contacts/base/method", json!("gauss"), ["contacts.base.method: ", "did you mean `gauss_to_segment`?"]),
        ("/contacts/base/master", json!(7), ["contacts.base.master: ", "is 7, but must be the name of an edge group"]),
        ("/bodies/block/material/model", json!("neohooke"), ["bodies.block.material.model: ", "`neo_hookean`"]),
        ("/steps/0/dt", json!([0.1]), ["steps[0].dt: ", "is a list […], but must be an object {…}"]),
        ("/steps", json!({}), ["steps: ", "an object {…}, but must be a list"]),
        ("/steps/0/duration", json!("1 s"), ["steps[0].duration: ", "\"1 s\", but must be a number"]),
        ("/steps/0/supports/0/uy", json!({}), ["steps[0].supports[0].uy: ", "an object {…} with exactly one key"]),
        (
            "/steps/0/scheme",
            json!("newmark"),
            ["steps[0].scheme.newmark: ", "is a name alone, but must be an object {…}"],
        ),
        ("/steps/0/supports/0/uy", json!(true), ["steps[0].supports[0].uy: ", "true, but must be a number, an expr"]),
        ("/steps/0/supports/0/uy", json!({"rate": "x"}), ["steps[0].supports[0].uy", "\"x\", but must be a number"]),
        ("/initial_velocity", json!({"block": [1, 2, 3]}), ["initial_velocity.block: ", "has 3 entries"]),
        ("/mesh", json!([3]), ["mesh[0]: ", "is 3, but must be text in quotes"]),
        ("/mesh", json!([]), ["mesh: ", "is an empty list: give the paths of mesh files"]),
        ("/mesh", json!(3), ["mesh: ", "must be the path of a mesh file, a list of such paths"]),
        ("/mesh/nodes/3", json!([1]), ["mesh.nodes[3]", "has 1 entries, but must have 2 numbers"]),
        ("/output", json!({"fields": 0}), ["output.fields: ", "0, but must be true or false"]),
    ] {
        refused_edits(&[(pointer, value)], &fragments);
    }
    for (pointer, place, key) in [
        ("/mesh", "bad.json: ", "mesh"),
        ("/bodies/block/material/E", "bodies.block.material: ", "E"),
        ("/bodies/block/material/model", "bodies.block.material: ", "model"),
        ("/steps/0/name", "steps[0]: ", "name"),
        ("/contacts/base/slave", "contacts.base: ", "slave"),
    ] {
        refused_case(without(pointer).to_string(), &[place, &format!("the key `{key}` is missing here")]);
    }
}

#[test]
fn text_that_is_no_case_is_refused() {
    refused_case("", &["is empty"]);
    refused_case(" \n", &["is empty"]);
    refused_case([0xff, 0xfe, 0x00], &["is not a text file"]);
    refused_case("mesh: a.msh", &["there is no JSON value at line 1, column 1"]);
    refused_case("[1, 2]", &["is a list […], but must be an object {…}"]);
    refused_case("3", &["is 3, but must be an object {…}"]);
    let text = good().to_string();
    for length in [1, 20, text.len() / 2, text.len() - 1] {
        refused_case(&text[..length], &["ends too early, at line 1"]);
    }
    refused_case(format!("{text} {text}"), &["has text after the end"]);
    refused_case(text.replacen("\"duration\":1", "\"duration\":NaN", 1), &["steps[0].duration: ", "no NaN"]);
    refused_case(text.replacen("\"duration\":1", "\"duration\":1e999", 1), &["steps[0].duration: ", "too large"]);
    refused_case("[".repeat(100_000), &["this is not JSON: recursion limit exceeded"]);
    refused_case(format!("{{\"{}\": 1}}", "x".repeat(1 << 20)), &["is not known here"]);
}

#[test]
fn a_key_that_stands_twice_is_refused() {
    let body = r#"{"material":{"model":"linear","E":1,"nu":0.3}}"#;
    let text = format!(r#"{{"mesh":"a.msh","bodies":{{"block":{body},"block":{body}}},"steps":[]}}"#);
    refused_case(text, &["bodies: ", "the key `block` appears here twice"]);
    refused_case(r#"{"contacts":{"base":{},"base":{}}}"#, &["contacts: ", "the key `base` appears here twice"]);
    refused_case(r#"{"title":"a","title":"b"}"#, &["the key `title` appears here twice"]);
}

#[test]
fn bodies_are_checked() {
    let material = |key: &str, value: f64| (format!("/bodies/block/material/{key}"), json!(value));
    for (key, value, allowed) in [
        ("nu", 0.5, "less than 0.5"),
        ("nu", -1.0, "greater than -1"),
        ("E", -1.0, "must be positive"),
        ("E", 0.0, "must be positive"),
        ("density", -1e-9, "zero or positive"),
    ] {
        let (pointer, value) = material(key, value);
        refused_edits(&[(&pointer, value)], &["bodies.block.material: ", key, allowed]);
    }
    for value in [1e300, 1e-300] {
        let (pointer, value) = material("E", value);
        refused_edits(&[(&pointer, value)], &["bodies.block.material: ", "must lie between 1e-100 and 1e100"]);
    }
    refused_case(without("/bodies/block").to_string(), &["bodies: ", "`block` of the mesh has no material"]);
    refused_edits(
        &[("/bodies/blok", json!({"material": {"model": "linear", "E": 1, "nu": 0}}))],
        &["bodies.blok: ", "no group `blok` (did you mean `block`?)", "`ground_top`"],
    );
    refused_edits(
        &[("/bodies/block_top", json!({"material": {"model": "linear", "E": 1, "nu": 0}}))],
        &["bodies.block_top: ", "a group of edges, not of solid elements"],
    );
    let triangles = json!([[6, 7, 10], [7, 8, 11], [8, 9, 12]]);
    let edges = json!({"block_bottom": [[6, 7], [7, 8], [8, 9]], "ground_top": [[3, 4]], "ground_bottom": [[0, 1]]});
    refused_edits(
        &[("/mesh/elements/block", triangles), ("/mesh/edges", edges), ("/bodies/block/element", json!("f_bar"))],
        &["bodies.block.element: ", "f_bar", "Q4", "not for T3"],
    );
}

#[test]
fn contacts_are_checked() {
    let friction = |key: &str| format!("/contacts/base/friction/{key}");
    for (key, value, allowed) in [
        ("mu_s", 0.1, "not less than \"mu_k\", which is 0.2"),
        ("mu_k", 0.0, "must be positive"),
        ("alpha_t", 0.0, "must be positive"),
        ("alpha_t", -1e5, "must be positive"),
        ("structure", 2.5, "must lie between 1 and mu_s/mu_k = 2"),
        ("structure", 0.5, "must lie between 1 and mu_s/mu_k = 2"),
        ("r", 0.0, "must be positive"),
        ("kappa", -1.0, "zero or positive"),
        ("elastic_core", 1.0, "less than 1"),
    ] {
        refused_edits(&[(&friction(key), json!(value))], &["contacts.base.friction: ", key, allowed]);
    }
    for (value, allowed) in [(0.0, "must be positive"), (-1.0, "must be positive"), (1e300, "choose other units")] {
        let edits = [("/contacts/base/normal/alpha_n", json!(value))];
        refused_edits(&edits, &["contacts.base.normal", "alpha_n", allowed]);
    }
    refused_edits(&[(&friction("alpha_t"), json!(1e300))], &["contacts.base.friction: ", "alpha_t is 1.000000e300"]);
    refused_edits(&[("/contacts/base/points", json!(7))], &["contacts.base.points: ", "is 7: must be 2, 3 or 4"]);
    for normal in [json!([0, 0]), json!([1e-300, 0])] {
        let plane = json!({"plane": {"point": [0, 0], "normal": normal}});
        refused_edits(&[("/contacts/base/master", plane)], &["contacts.base.master.plane.normal: ", "a direction"]);
    }
    refused_edits(
        &[("/contacts/base/slave", json!("block_botom"))],
        &["contacts.base.slave: ", "no group `block_botom` (did you mean `block_bottom`?); it has `block`, `block_"],
    );
    refused_edits(&[("/contacts/base/slave", json!("block"))], &["contacts.base.slave: ", "not of edges"]);
    refused_edits(
        &[("/mesh/edges/part", json!([[6, 7]])), ("/contacts/base/master", json!("part"))],
        &[
            "contacts.base: ",
            "the edge between nodes 6 and 7 is both slave (`block_bottom`) and master",
            "for contact of a surface with itself name the same group of edges twice",
        ],
    );
}

/// 0.2 − 0.5 t is negative after t = 0.4, of which the hundredth parts of the step see 0.41 first; a step that may end before is not asked.
#[test]
fn fluids_that_would_pull_are_found_before_the_run() {
    let fluid = |pressure: Value| ("/contacts/base/fluid_pressure", pressure);
    for (pressure, told) in [
        (json!("0.2 - 0.5*t"), "t = 0.41: must be a finite number, zero or positive"),
        (json!("1 + 0*sqrt(0.5 - t)"), "is NaN at ("),
        (json!("erfc(x)*(t - 0.7)*(t - 0.9)"), "t = 0.71: "),
        (json!({"x": [[0.8, -1], [0.9, 1]]}), "and t = 0: "),
    ] {
        refused_edits(&[fluid(pressure)], &["contacts.base.fluid_pressure: ", told]);
    }
    outcome("check", &[fluid(json!("0.5*t"))]);
    let until = json!({"on": "block_top", "fy": -0.001});
    outcome("check", &[fluid(json!("0.2 - 0.5*t")), ("/steps/0/until", until)]);
}

/// A run that stops beside an absurd number says so in a few digits, on stderr and in the summary.
#[test]
fn no_number_has_hundreds_of_digits() {
    let folder = TempDir::new().expect("a folder");
    let until = json!({"on": "block_top", "fy": -1e300});
    write(folder.path(), "case.json", with(&[("/steps/0/until", until)]).to_string());
    let output = fecontact(folder.path(), &["run", "case.json"]);
    let summary = fs::read_to_string(folder.path().join("out/case/summary.json")).expect("a summary");
    let summary: Value = serde_json::from_str(&summary).expect("JSON");
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    for said in [stderr(&output), summary["reason"].to_string()] {
        assert!(said.contains("reached -1e300: it is ") && !said.contains("00000000"), "{said}");
    }
}

/// Standard output of `check` of the good case with edits.
fn checked(edits: &[(&str, Value)]) -> String {
    let folder = TempDir::new().expect("a folder");
    write(folder.path(), "case.json", with(edits).to_string());
    let output = fecontact(folder.path(), &["check", "case.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    String::from_utf8(output.stdout).expect("text")
}

/// Edges of the block's bottom begin at x = 0.5, 1.5, 2.5: a pressure at x = 1.5 alone is an isolated one.
#[test]
fn a_fluid_that_starts_at_one_point_is_told_and_round_off_is_no_suction() {
    let initial = ("/contacts/base/initial", json!({"pressure": 1.0}));
    let nodal = ("/contacts/base/method", json!("node_to_segment"));
    let at_start =
        |text: &str| checked(&[initial.clone(), nodal.clone(), ("/contacts/base/fluid_pressure", json!(text))]);
    let told = "its fluid_pressure is 0.1 at (1.5, 0) at t = 0 and none beside it";
    let diffusing = at_start("0.1*erfc(abs(x - 1.5)/(2*sqrt(0.1*t + 1e-12)))");
    assert!(diffusing.contains(told), "{diffusing}");
    for right in [
        "0.1*erfc((abs(x - 1.5) + 1e-9)/(2*sqrt(0.1*t + 1e-30)))", // begins with 0
        "0.1*erfc(abs(x - 1.5)/(2*sqrt(0.1*t + 0.1)))",            // begins everywhere
        "0.1*(1 + t)*max(0, 1 - abs(x - 1.5))",                    // stays there
        "0.1*t*erfc(x) - 1e-306",
        "-1e-306",
    ] {
        let text = at_start(right);
        assert!(!text.contains("none beside it"), "{right}: {text}");
    }
    refused_edits(
        &[("/contacts/base/fluid_pressure", json!("-1e-3"))],
        &["fluid_pressure: is -0.001 at (", "zero or positive"],
    );
    refused_edits(&[("/contacts/base/fluid_pressure", json!("-1e300"))], &["fluid_pressure: is -1e300 at ("]);
}

#[test]
fn numbers_that_cannot_be_squared_are_refused_with_their_place() {
    for far in [1e200, 1.797e308] {
        refused_edits(
            &[("/contacts/base/master", json!({"polyline": {"points": [[far, 0.8], [2.4, 0.0], [2.1, 0.8]]}}))],
            &["contacts.base.master.polyline.points: is 1", "places must lie between -1e100 and 1e100"],
        );
        refused_edits(
            &[("/contacts/base/master", json!({"circle": {"centre": [0, far], "radius": 1}}))],
            &["contacts.base.master.circle.centre: is 1"],
        );
        refused_edits(
            &[("/contacts/base/master", json!({"circle": {"centre": [0, 0], "radius": far}}))],
            &["contacts.base.master.circle.radius: is 1"],
        );
        refused_edits(
            &[("/contacts/base/master", json!({"plane": {"point": [0, far], "normal": [0, 1]}}))],
            &["contacts.base.master.plane.point: is 1"],
        );
        refused_edits(&[("/mesh/nodes/0/1", json!(far))], &["mesh: node 0 has the coordinate 1", "choose other units"]);
    }
    // Less than the smallest length that is positive when squared
    refused_edits(
        &[("/contacts/base/master", json!({"polyline": {"points": [[0, 0], [1e-200, 0], [4, 0]]}}))],
        &["contacts.base.master.polyline.points: points 0 and 1 are the same"],
    );
    refused_edits(&[("/bodies/block/material/nu", json!(-1e300))], &["is -1e300, but"]);
}

#[test]
fn a_static_step_cannot_start_above_the_strength_of_any_law() {
    let laws = [
        (json!({"law": "coulomb", "mu": 0.6}), "0.6"),
        (json!({"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.5, "D_c": 0.1}), "0.6"),
        (json!({"law": "slip_weakening", "mu_s": 0.5, "mu_d": 0.4, "D_c": 0.1, "cohesion": 0.1}), "0.6"),
        (json!({"law": "adhesion", "strength": 0.6}), "0.6"),
    ];
    for (law, strength) in laws {
        let of = |traction: f64| {
            [
                ("/contacts/base/friction", law.clone()),
                ("/contacts/base/initial", json!({"pressure": 1.0, "traction": traction, "balanced": true})),
            ]
        };
        refused_edits(
            &of(0.601),
            &["contacts.base.initial.traction: is 0.601 at (", "exceeds the initial strength", strength],
        );
        checked(&of(0.599));
    }
}

/// The tip of a crack, whose node is on both sides: it neither opens nor slips. The crack is closed along y = 0 and pressed.
#[test]
fn a_crack_whose_sides_share_a_node_runs_with_every_method() {
    let block = |corners: Value, sides: Value| json!({"body": "b", "corners": corners, "elements": [2, 1], "kind": "Q4", "sides": sides});
    for method in ["node_to_segment", "gauss_to_segment", "mortar"] {
        for sliding in ["small", "finite"] {
            let case = json!({
                "mesh": {"separated": ["low", "up"], "blocks": [
                    block(json!([[0, -1], [1, -1], [1, 0], [0, 0]]), json!(["bottom", null, "low", null])),
                    block(json!([[1, -1], [2, -1], [2, 0], [1, 0]]), json!(["bottom", null, null, null])),
                    block(json!([[0, 0], [1, 0], [1, 1], [0, 1]]), json!(["up", null, "top", null])),
                    block(json!([[1, 0], [2, 0], [2, 1], [1, 1]]), json!([null, null, "top", null])),
                ]},
                "bodies": {"b": {"material": {"model": "linear", "E": 500, "nu": 0.3}}},
                "contacts": {"crack": {"slave": "up", "master": "low", "method": method, "sliding": sliding,
                    "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 1e4}, "normal": {"alpha_n": 4e4}}},
                "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.5}, "supports": [
                    {"on": "bottom", "ux": 0, "uy": 0}, {"on": "top", "ux": 0.001, "uy": -0.01}]}],
                "output": {"fields": false, "report": false}
            });
            let folder = TempDir::new().expect("a folder");
            write(folder.path(), "case.json", case.to_string());
            for command in ["check", "run"] {
                let output = fecontact(folder.path(), &[command, "case.json"]);
                assert_eq!(output.status.code(), Some(0), "{method}, {sliding}: {}", stderr(&output));
            }
        }
    }
}

#[test]
fn rigid_masters_and_formulations_that_make_no_sense_are_refused() {
    let at = "contacts.base.master";
    for (master, place, message) in [
        (json!({"circle": {"centre": [0, 0], "radius": 0}}), format!("{at}.circle.radius: "), "must be positive"),
        (json!({"polyline": {"points": [[0, 0]]}}), format!("{at}.polyline.points: "), "two or more"),
        (json!({"polyline": {"points": [[0, 0], [0, 0]]}}), format!("{at}.polyline.points: "), "the same"),
        (json!({"circle": {"center": [0, 0], "radius": 1}}), format!("{at}.circle.center"), "`centre`"),
    ] {
        refused_edits(&[("/contacts/base/master", master)], &[&place, message]);
    }
    let plane = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
    let mortar = ("/contacts/base/method", json!("mortar"));
    let smooth = ("/contacts/base/smooth", json!(true));
    refused_edits(&[smooth.clone(), mortar], &["contacts.base.smooth: ", "is not for mortar"]);
    refused_edits(&[smooth, ("/contacts/base/master", plane)], &["contacts.base.smooth: ", "a rigid body needs none"]);
    let small = ("/contacts/base/sliding", json!("small"));
    let itself = ("/contacts/base/master", json!("block_bottom"));
    refused_edits(&[small, itself], &["contacts.base.sliding: ", "self-contact comes about", "name the two parts"]);
    refused_edits(&[("/contacts/base/sliding", json!("little"))], &["contacts.base.sliding", "`small`"]);
    refused_edits(
        &[("/contacts/base/shrink_fit", json!(true)), ("/contacts/base/initial", json!({"pressure": 1}))],
        &["contacts.base.shrink_fit: ", "leave one out"],
    );
    refused_edits(
        &[("/contacts/base/clearance", json!(-1e-3)), ("/contacts/base/initial", json!({"pressure": 1}))],
        &["contacts.base.clearance: ", "leave one out"],
    );
    let itself = ("/contacts/base/master", json!("block_bottom"));
    refused_edits(
        &[("/contacts/base/clearance", json!(0.1)), itself],
        &["contacts.base.clearance: ", "one touches itself"],
    );
    refused_edits(&[("/contacts/base/clearance", json!(1e300))], &["contacts.base.clearance: "]);
    refused_edits(&[("/contacts/base/interference", json!(1e-3))], &["here that is `clearance`"]);
    refused_edits(
        &[
            ("/mesh/points", json!({"corner": [6]})),
            ("/contacts/base/slave", json!("corner")),
            ("/contacts/base/area", json!(1)),
            ("/contacts/base/normal", json!({})),
        ],
        &["contacts.base.normal.alpha_n: ", "sides of elements like those there take"],
    );
    refused_edits(
        &[("/contacts/base/normal", json!({"penetration": 0}))],
        &["contacts.base.normal.penetration: ", "positive"],
    );
    refused_edits(
        &[
            ("/contacts/base/normal", json!({"penetration": 1e-6})),
            ("/steps/0/scheme", json!({"wilson": {"theta": 1.4}})),
            ("/bodies/block/material/density", json!(1)),
            ("/bodies/ground/material/density", json!(1)),
        ],
        &["contacts.base.normal.penetration: ", "Wilson", "leave it out"],
    );
}

#[test]
fn steps_are_checked() {
    for (pointer, value, fragments) in [
        ("/steps", json!([]), ["steps: ", "at least one step"]),
        ("/steps/0/duration", json!(0), ["steps[0].duration: ", "is 0: must be positive"]),
        ("/steps/0/duration", json!(-1), ["steps[0].duration: ", "is -1: must be positive"]),
        ("/steps/0/duration", json!(1e300), ["steps[0].dt.min: ", "lost in round-off"]),
        ("/steps/0/dt/min", json!(0.6), ["steps[0].dt: ", "min = 0.6 is above max = 0.5"]),
        ("/steps/0/dt/min", json!(0), ["steps[0].dt.min: ", "must be positive"]),
        ("/steps/0/dt/initial", json!(-0.1), ["steps[0].dt.initial: ", "must be positive"]),
        ("/steps/0/dt/max", json!(0.1), ["steps[0].dt: ", "initial = 0.5 must lie between"]),
        ("/steps/0/scheme", json!("newmrk"), ["steps[0].scheme", "did you mean `newmark`?"]),
        (
            "/steps/0/scheme",
            json!({"hht": {"alpha": -0.9}}),
            ["steps[0].scheme: ", "\"alpha\" is -0.9, but it must be between -1/3"],
        ),
        (
            "/steps/0/scheme",
            json!({"newmark": {"gamma": 0.1}}),
            ["steps[0].scheme: ", "\"gamma\" is 0.1, but it must be at least"],
        ),
        (
            "/steps/0/scheme",
            json!({"generalized_alpha": {"rho_infinity": 1.5}}),
            ["steps[0].scheme: ", "\"rho_infinity\" is 1.5, but it must be between 0 (most damping) and 1"],
        ),
        (
            "/steps/0/scheme",
            json!({"wilson": {"theta": 1.3}}),
            ["steps[0].scheme: ", "\"theta\" is 1.3, but it must be between 1.37, below which long increments blow up"],
        ),
        ("/steps/0/scheme", json!({"wilson": {"tetha": 1.4}}), ["steps[0].scheme", "did you mean `theta`?"]),
        ("/steps/0/dt/error", json!(0), ["steps[0].dt.error: ", "is 0: must be positive"]),
        ("/steps/0/dt/error", json!(-1e-3), ["steps[0].dt.error: ", "is -0.001: must be positive"]),
        ("/steps/0/dt/eror", json!(1e-3), ["steps[0].dt.eror: ", "did you mean `error`?"]),
        ("/steps/0/scheme", json!({"hht": {}}), ["steps[0].scheme.hht", "the key `alpha` is missing"]),
        ("/steps/0/scheme", json!({"hht": {"alpha": -0.1}}), ["bodies.block.material.density: ", "needs a mass"]),
        ("/steps/0/stabilize", json!(0), ["steps[0].stabilize: ", "is 0: must be a fraction of the stiffness"]),
        ("/steps/0/stabilize", json!(2), ["steps[0].stabilize: ", "is 2: must be a fraction of the stiffness"]),
        ("/steps/0/name", json!(""), ["steps[0].name: ", "is empty"]),
        ("/steps/0/name", json!("press, drag"), ["steps[0].name: ", "','"]),
        ("/steps/0/name", json!("press\ndrag"), ["steps[0].name: ", "'\\n'"]),
        ("/watch/0", json!("block_tip"), ["watch[0]: ", "did you mean `block_top`?"]),
        ("/watch", json!(["block_top", "block_top"]), ["watch[1]: ", "watched already"]),
        ("/watch/0", json!({"near": [0.5, 7]}), ["watch[0]: ", "no node is near (0.5, 7)"]),
        ("/watch/0", json!({"node": 99}), ["watch[0]: ", "the mesh has no node 99"]),
        ("/watch", json!([{"node": 3}, {"node": 3}]), ["watch[1]: ", "`node_3` is watched already"]),
        ("/output", json!({"every": 0}), ["output.every: ", "must be at least 1"]),
        ("/newton", json!({"tolerance": 0}), ["newton.tolerance: ", "above 0 and at most 0.01"]),
        ("/newton", json!({"max_iterations": 0}), ["newton.max_iterations: ", "1 to 1000"]),
        ("/initial_velocity", json!({"brick": [0, 1]}), ["initial_velocity.brick: ", "the bodies are block, ground"]),
    ] {
        refused_edits(&[(pointer, value)], &fragments);
    }
    for (scheme, fragment) in [
        (json!({"wilson": {}}), "wilson has no error estimate: take newmark, hht or generalized_alpha"),
        (json!({"newmark": {"beta": 0.166}}), "newmark with beta near 1/6 has no error estimate"),
    ] {
        let edits = [("/steps/0/scheme", scheme), ("/steps/0/dt/error", json!(1e-3))];
        refused_edits(&edits, &["steps[0].dt.error: ", fragment]);
    }
    let contact = good()["contacts"]["base"].clone();
    refused_edits(&[("/contacts", json!({"a,b": contact}))], &["contacts: ", "\"a,b\"", "','"]);
}

#[test]
fn supports_are_checked() {
    refused_edits(
        &[("/steps/0/supports", json!([]))],
        &["steps[0].supports: ", "`block` with `ground`", "there is no support at all"],
    );
    let alone = [("/contacts", json!({}))];
    let floating = json!([{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0}]);
    refused_edits(
        &[&alone[..], &[("/steps/0/supports", floating)]].concat(),
        &["steps[0].supports: ", "`block` can move freely along y", "supports do not constrain it"],
    );
    let turning = json!([{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": {"node": 10}, "ux": 0, "uy": 0}]);
    refused_edits(
        &[&alone[..], &[("/steps/0/supports", turning)]].concat(),
        &["steps[0].supports: ", "`block` can move freely", "in rotation"],
    );
    for (support, fragments) in [
        (json!({"on": "top", "ux": 0}), ["steps[0].supports[1].on: ", "no group `top`"]),
        (json!({"on": {"node": 99}, "ux": 0}), ["steps[0].supports[1].on: ", "the mesh has no node 99"]),
        (
            json!({"on": "block_top"}),
            ["steps[0].supports[1]: ", "prescribes nothing: give ux, uy, along with u, un or rotation"],
        ),
        (json!({"on": "block_top", "ux": null}), ["steps[0].supports[1].ux: ", "null ends what an earlier step gave"]),
        (json!({"on": "block_top", "rotation": null}), ["supports[1].rotation: ", "null ends what an earlier step"]),
        (
            json!({"on": "block_top", "ux": 0, "rotation": {"about": [0, 0], "angle": 1}}),
            ["steps[0].supports[1]: ", "gives rotation and ux"],
        ),
    ] {
        refused_edits(&[("/steps/0/supports/1", support)], &fragments);
    }
    let mut nodes = good()["mesh"]["nodes"].clone();
    nodes.as_array_mut().expect("a list").push(json!([9, 9]));
    refused_edits(
        &[("/mesh/nodes", nodes), ("/mesh/points", json!({"lone": [14]}))],
        &["steps[0].supports: ", "node 14 belongs to no element and is free along x"],
    );
}

#[test]
fn amplitudes_are_checked() {
    for (value, fragment) in [
        (json!("0.01*z"), "`z` is not one of the variables x, y, t"),
        (json!("sin("), "\"sin(\" cannot be read: a number, a name or a bracket is missing here\n    sin(\n        ^"),
        (json!("2 + SIN(t)"), "`SIN` is not one of the variables x, y, t (did you mean `sin`?)"),
        (json!("2 + SIN(t)"), "    2 + SIN(t)\n        ^"),
        (json!("z"), "nor a function: abs, acos,"),
        (json!("2t"), "an operator is missing here: a product is written 2*t\n    2t\n     ^"),
        (json!("0,01*t"), "decimals have a point\n    0,01*t\n     ^"),
        (json!("t**2"), "a power is written with ^\n    t**2\n      ^"),
        (json!("sin t"), "`sin` needs its value in brackets: sin(…)"),
        (json!("atan2(t)"), "a comma and another value are missing: atan2(…, …)"),
        (json!("(t > 2)*3"), "`>` is not an operator: there are + - * / ^ and brackets\n    (t > 2)*3\n       ^"),
        (json!("1 + (t*2"), "this bracket is not closed\n    1 + (t*2\n        ^"),
        (json!("t)"), "this bracket was not opened"),
        (json!(format!("{}z", "t + ".repeat(200))), "\"…+ t + t + t"),
        (json!(format!("{}t{}", "1+(".repeat(80), ")".repeat(80))), "more than 32 levels of brackets"),
        (json!("1e-3*ln(t-0.5)"), "has no finite value at t = 0.01, (x, y) = (0.5, 1): check the expression"),
        (json!("0.001/(x-2.5)"), "has no finite value at t = 0.01, (x, y) = (2.5, 1)"),
        (json!("1/(t-0.25)"), "has no finite value at t = 0.25"),
        (json!(""), "cannot be read"),
        (json!("1 +"), "cannot be read"),
        (json!("(".repeat(2000)), "longer than 1000 characters"),
        (json!({"table": []}), "the table is empty"),
        (json!({"table": [[1, 0], [0, 1]]}), "times of the table must increase: 0 follows 1"),
        (json!({"table": [[0, 0], [0, 1]]}), "times of the table must increase"),
    ] {
        refused_edits(&[("/steps/0/supports/1/uy", value)], &["steps[0].supports[1].uy", fragment]);
    }
}

#[test]
fn loads_are_checked() {
    for (load, fragments) in [
        (json!({"on": "block", "pressure": 1}), ["steps[0].loads[0].on: ", "of solid elements, not of edges"]),
        (json!({"on": "block", "gravity": {"y": -9.81}}), ["loads[0].on: ", "give bodies.block.material.density"]),
        (
            json!({"on": "block_top", "gravity": {"y": 1}}),
            ["loads[0].on: ", "no body or point mass `block_top`, on which gravity acts; there are block, ground"],
        ),
        (json!({"on": "block_top", "pressure": 1, "force": {"x": 1}}), ["loads[0]: ", "exactly one of pressure"]),
        (json!({"on": "block_top"}), ["loads[0]: ", "exactly one of pressure"]),
        (json!({"on": {"node": 3}, "pressure": 1}), ["loads[0].on: ", "node 3 cannot carry this load"]),
        (json!({"on": {"near": [1]}, "force": {"x": 1}}), ["loads[0].on.near: ", "must have 2 numbers"]),
        (
            json!({"on": {"nod": 3}, "force": {"x": 1}}),
            ["loads[0].on", "`nod` is not known here; did you mean `node`?"],
        ),
        (
            json!({"on": {"near": [1e3, 0]}, "force": {"x": 1}}),
            ["loads[0].on: ", "no node is near (1000, 0): the nearest, "],
        ),
        (
            json!({"on": "block_top", "total_force": {"x": "x"}}),
            ["loads[0].total_force.x: ", "is the force on the whole group"],
        ),
        (json!({"on": "block_top", "dead_pressure": null}), ["loads[0]: ", "null ends what an earlier step gave"]),
        (json!({"on": "block_top", "spring": {"kx": -1}}), ["loads[0].spring.kx: ", "must be zero or positive"]),
        (json!({"on": "block_top", "traction": {"z": 1}}), ["loads[0].traction.z: ", "is not known here"]),
        (json!({"on": "block_top", "pressure": null}), ["loads[0]: ", "null ends what an earlier step gave"]),
    ] {
        refused_edits(&[("/steps/0/loads", json!([load]))], &fragments);
    }
}

/// A point mass on a plane, in contact from the start.
fn point() -> Value {
    json!({
        "mesh": {"nodes": [[0, 0], [1, 0], [2, 0]], "points": {"block": [0], "pin": [1, 2]}},
        "point_masses": {"block": {"mass": 10, "velocity": [1, 0]}},
        "contacts": {"base": {
            "slave": "block", "area": 1, "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 1000},
            "friction": {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 1000, "r": 100, "kappa": 10},
            "initial": {"pressure": 98.1, "traction": 20, "structure": 1.5}
        }},
        "steps": [{
            "name": "slide", "duration": 0.1, "scheme": {"newmark": {}}, "dt": {"initial": 0.01},
            "supports": [{"on": "pin", "ux": 0, "uy": 0}],
            "loads": [{"on": "block", "gravity": {"y": "-9.81"}},
                      {"on": "block", "spring": {"kx": 10, "driver": {"x": {"rate": 0.1}}}},
                      {"on": "block", "dashpot": {"cx": 2, "driver": {"x": "0.1"}}}]
        }]
    })
}

fn refused_point(edits: &[(&str, Value)], fragments: &[&str]) {
    refused_case(edited(point(), edits).to_string(), fragments);
}

#[test]
fn points_are_checked() {
    for (pointer, value, fragments) in [
        ("/point_masses/block/mass", json!(0), ["point_masses.block.mass: ", "is 0: must be positive"]),
        ("/point_masses/block/mass", json!(-1), ["point_masses.block.mass: ", "is -1: must be positive"]),
        ("/point_masses/block/mass", json!(1e300), ["point_masses.block: ", "choose other units"]),
        ("/point_masses/block/weight", json!(1), ["point_masses.block.weight: ", "is not known here"]),
        ("/point_masses/block/velocity", json!([1]), ["point_masses.block.velocity", "2 numbers"]),
        ("/point_masses", json!({"blok": {"mass": 1}}), ["point_masses.blok: ", "did you mean `block`?"]),
        ("/contacts/base/area", json!(null), ["contacts.base.area: ", "is missing: `block` is a group of points"]),
        ("/contacts/base/area", json!(0), ["contacts.base.area: ", "is 0: must be positive"]),
        ("/contacts/base/area", json!(1e300), ["contacts.base: ", "area is 1.000000e300"]),
        (
            "/contacts/base/normal",
            json!({}),
            ["contacts.base.normal.alpha_n: ", "get a spring of alpha_n × area each; take 100 times"],
        ),
        ("/contacts/base/friction/alpha_t", json!(null), ["contacts.base.friction.alpha_t: ", "is missing"]),
        ("/contacts/base/initial/pressure", json!(-1), ["contacts.base.initial.pressure: ", "is -1: must be zero or"]),
        ("/contacts/base/initial/traction", json!(-30), ["contacts.base.initial.traction: ", "mu p = 29.43"]),
        ("/contacts/base/initial/traction", json!(29.44), ["initial.traction: ", "it exceeds the initial strength"]),
        (
            "/contacts/base/initial/structure",
            json!(2.5),
            ["contacts.base.initial.structure at ", "\"structure\" is 2.5, but it must"],
        ),
        (
            "/contacts/base/initial/structure",
            json!(0.9),
            ["contacts.base.initial.structure at ", "between 1 and mu_s/mu_k = 2"],
        ),
        ("/contacts/base/initial", json!({"traction": 1}), ["contacts.base.initial.pressure: ", "is missing"]),
        ("/steps/0/loads/0/on", json!("pin"), ["loads[0].on: ", "no body or point mass `pin`, on which gravity acts"]),
        ("/steps/0/loads/2/dashpot/cx", json!(-2), ["loads[2].dashpot.cx: ", "is -2: must be zero or positive"]),
        ("/steps/0/loads/2/dashpot/c", json!(2), ["loads[2].dashpot.c: ", "did you mean `cx`?"]),
        ("/steps/0/loads/2/on", json!("blocks"), ["loads[2].on: ", "did you mean `block`?"]),
        ("/steps/0/loads/2/dashpot", json!(null), ["loads[2]: ", "null ends what an earlier step gave"]),
        (
            "/steps/0/loads/2/spring",
            json!({}),
            [
                "loads[2]: ",
                "exactly one of pressure, dead_pressure, traction, gravity, force, total_force, moment, spring",
            ],
        ),
    ] {
        refused_point(&[(pointer, value)], &fragments);
    }
    refused_point(
        &[("/point_masses", json!({})), ("/steps/0/loads", json!([]))],
        &["point_masses: ", "node 0 belongs to no element, and the dynamic step `slide` (steps[0]) needs a mass"],
    );
    let two = [("/mesh/points/both", json!([0, 1])), ("/point_masses/both", json!({"mass": 1, "velocity": [0, 1]}))];
    refused_point(&two, &["point_masses.both.velocity: ", "node 0 starts with the velocity [1, 0] already"]);
    let initial = |structure: Value| json!({"pressure": 98.1, "structure": structure});
    let coulomb = json!({"law": "coulomb", "mu": 0.3, "alpha_t": 1000});
    refused_point(
        &[("/contacts/base/friction", coulomb), ("/contacts/base/initial", initial(json!(1)))],
        &["contacts.base.initial.structure: ", "has no structure"],
    );
    refused_point(
        &[("/contacts/base/friction", json!({"law": "frictionless"}))],
        &["contacts.base.initial.structure: ", "has no structure"],
    );
    let pushed = json!({"pressure": 98.1, "traction": 1});
    refused_point(
        &[("/contacts/base/friction", json!({"law": "frictionless"})), ("/contacts/base/initial", pushed)],
        &["contacts.base.initial.traction: ", "it exceeds the initial strength, mu p = 0"],
    );
    refused_point(
        &[("/steps/0/scheme", json!("static")), ("/contacts", json!({})), ("/steps/0/loads", json!([]))],
        &["steps[0].supports: ", "node 0 belongs to no element and is free along x", "a spring or contact"],
    );
    // On elements: edges bring their own lengths, a slave point must not lie on the master, and a point beside the
    // master cannot start closed.
    refused_edits(&[("/contacts/base/area", json!(1))], &["contacts.base.area: ", "lengths of their own"]);
    let lone = |node: usize, initial: Value| {
        let mut contact = point()["contacts"]["base"].clone();
        contact["master"] = json!("ground_top");
        contact["initial"] = initial;
        let mut nodes = good()["mesh"]["nodes"].clone();
        nodes.as_array_mut().expect("a list").push(json!([9, 0]));
        let points = json!({"block": [node], "pin": [0, 1], "lone": [14]});
        with(&[("/mesh/nodes", nodes), ("/mesh/points", points), ("/contacts/base", contact)])
    };
    let contacts = |case: Value| {
        let mut case = case;
        case["contacts"]["base"]["slave"] = json!("tip");
        let node = case["mesh"]["points"]["block"].take();
        case["mesh"]["points"] = json!({"tip": node, "lone": [14]});
        case.to_string()
    };
    refused_case(contacts(lone(4, Value::Null)), &["contacts.base: ", "node 4 is both slave (`tip`) and master"]);
    refused_case(
        contacts(lone(14, json!({"pressure": 1}))),
        &["contacts.base.initial: ", "the slave point at (9, 0) has no projection on the master"],
    );
}

#[test]
fn check_tells_of_points_and_of_velocities_that_are_lost() {
    let folder = TempDir::new().unwrap();
    let check = |case: Value| {
        write(folder.path(), "point.json", case.to_string());
        let output = fecontact(folder.path(), &["check", "point.json"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let text = check(point());
    for part in [
        "3 nodes, 0 elements, 6 dofs",
        "block  mass 10 at 1 node, initial velocity (1, 0)",
        "area of each point: 1: 1 contact point",
        "starts closed: pressure 98.1, traction 20; mu 0.3, structure 1.5",
        "load block: dashpot cx 2, cy 0, far end moving with (\"0.1\", 0)",
        "load block: spring kx 10, ky 0, far end displaced by (at the rate 0.1, 0)",
        "warnings  none",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
    let lost = "the initial velocities have no effect: the first step, `slide`, is static";
    let text = check(edited(point(), &[("/steps/0/scheme", json!("static"))]));
    assert!(text.contains(lost), "{text}");
    let output = fecontact(folder.path(), &["run", "point.json"]);
    assert!(output.status.code() == Some(0) && stderr(&output).contains(lost), "{}", stderr(&output));
    let summary = fs::read_to_string(folder.path().join("out/point/summary.json")).unwrap();
    assert!(summary.contains(lost) && summary.contains("\"point_masses\": 1"), "{summary}");
}

/// A mass that nothing holds along a smooth plane is named while solving, not taken for an answer.
#[test]
fn a_point_that_floats_while_solving_is_named() {
    let smooth = edited(
        point(),
        &[
            ("/contacts/base/friction", json!({"law": "frictionless"})),
            ("/contacts/base/initial", Value::Null),
            ("/steps/0/scheme", json!("static")),
            ("/steps/0/loads", json!([{"on": "block", "force": {"x": 1, "y": -1}}])),
        ],
    );
    let rows = stopped(&smooth, &["step `slide` stopped at time 0", "nothing resists the motion of node 0 along x"]);
    assert_eq!(rows, 0);
}

#[test]
fn files_that_are_no_meshes_are_refused() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), "old.msh", "$MeshFormat\n2.1 0 8\n$EndMeshFormat\n");
    write(folder.path(), "cut.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n4 4 1 0\n1 0 0 0 0\n");
    write(folder.path(), "empty.msh", "");
    fs::create_dir(folder.path().join("folder.msh")).unwrap();
    for (mesh, fragments) in [
        ("nowhere.msh", ["nowhere.msh: ", "there is no such mesh file"]),
        ("folder.msh", ["folder.msh: ", "not a file but a folder"]),
        ("old.msh", ["old.msh: ", "MSH format 2.1, and only 4.1 and 2.2 are read"]),
        ("cut.msh", ["cut.msh: ", "the file was cut short"]),
        ("empty.msh", ["empty.msh: ", "not a gmsh mesh"]),
    ] {
        write(folder.path(), "bad.json", with(&[("/mesh", json!(mesh))]).to_string());
        refused(folder.path(), &["run", "bad.json"], &[&["error: bad.json: mesh: "], &fragments[..]].concat());
    }
}

/// Two files are one mesh, unless both have a group, or a node that is named by its tag.
#[test]
fn what_two_mesh_files_share_is_refused() {
    let folder = TempDir::new().unwrap();
    let file = |body: &str, y: f64, top: &str| {
        let [low, high] = [y, y + 1.0];
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"{body}_bottom\"\n1 2 \"{top}\"\n2 3 \"{body}\"\n\
             $EndPhysicalNames\n$Nodes\n4\n1 0 {low} 0\n2 1 {low} 0\n3 1 {high} 0\n4 0 {high} 0\n$EndNodes\n$Elements\n3\n\
             1 1 2 1 1 1 2\n2 1 2 2 1 3 4\n3 3 2 3 1 1 2 3 4\n$EndElements\n"
        )
    };
    write(folder.path(), "ground.msh", file("ground", -1.0, "ground_top"));
    write(folder.path(), "block.msh", file("block", 0.0, "block_top"));
    write(folder.path(), "clash.msh", file("block", 0.0, "ground_top"));
    let both = |edits: &[(&str, Value)]| {
        let mesh = ("/mesh", json!(["ground.msh", "block.msh"]));
        with(&[std::slice::from_ref(&mesh), edits].concat()).to_string()
    };
    write(folder.path(), "good.json", both(&[]));
    let checked = fecontact(folder.path(), &["check", "good.json"]);
    assert_eq!(checked.status.code(), Some(0), "{}", stderr(&checked));
    let told = String::from_utf8_lossy(&checked.stdout).into_owned();
    assert!(told.contains("ground.msh, block.msh") && told.contains("8 nodes, 2 elements"), "{told}");
    let node = json!([{"node": 3}]);
    for (edits, fragments) in [
        (vec![("/mesh/1", json!("clash.msh"))], ["mesh[1]: ", "`ground_top` is in ground.msh and in clash.msh"]),
        (vec![("/mesh/1", json!("ground.msh"))], ["mesh[1]: ", "is in ground.msh and in ground.msh"]),
        (vec![("/mesh/1", json!("nowhere.msh"))], ["mesh: nowhere.msh: ", "no such mesh file"]),
        (
            vec![("/watch", node)],
            ["watch[0]: ", "several of the mesh files have a node 3: name it by {\"near\": [x, y]}"],
        ),
    ] {
        write(folder.path(), "bad.json", both(&edits));
        refused(folder.path(), &["run", "bad.json"], &fragments);
    }
}

#[test]
fn a_hundred_megabytes_of_garbage_are_refused() {
    let folder = TempDir::new().unwrap();
    let mut file = fs::File::create(folder.path().join("garbage")).unwrap();
    let block: Vec<u8> = (0..1u32 << 20).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    (0..100).for_each(|_| file.write_all(&block).unwrap());
    drop(file);
    refused(folder.path(), &["run", "garbage"], &["error: garbage: ", "larger than 16 MiB"]);
    write(folder.path(), "bad.json", with(&[("/mesh", json!("garbage"))]).to_string());
    refused(folder.path(), &["run", "bad.json"], &["garbage", "not a gmsh mesh"]);
}

#[test]
fn paths_and_arguments_are_checked() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), "good.json", good().to_string());
    write(folder.path(), "file", "");
    refused(folder.path(), &["run", "nowhere.json"], &["nowhere.json: ", "there is no such file"]);
    refused(folder.path(), &["run", "."], &["error: .: ", "is a folder"]);
    refused(folder.path(), &["run", "good.json", "--out", "file/results"], &["file/results: --out: results cannot"]);
    refused(folder.path(), &["run", "good.json", "--out", "file"], &["file: --out: results cannot be written here"]);
    refused(folder.path(), &["run", "good.json", "--out", ""], &["--out"]);
    refused(folder.path(), &["run", "good.json", "--threads", "0"], &["--threads 0: give 1 to"]);
    refused(folder.path(), &["run", "good.json", "--threads", "1000000"], &["--threads 1000000: give 1 to"]);
    refused(folder.path(), &["run", "good.json", "--threads", "-1"], &["-1"]);
    refused(folder.path(), &["run", "good.json", "--threads", "many"], &["many"]);
    refused(folder.path(), &["walk"], &["walk"]);
}

/// The command must stop with exit code 1 and all the fragments on stderr and in `summary.json`; gives the rows of
/// `history.csv`.
fn stopped(case: &Value, fragments: &[&str]) -> usize {
    let folder = TempDir::new().unwrap();
    write(folder.path(), "case.json", case.to_string());
    let output = fecontact(folder.path(), &["run", "case.json"]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    let summary = fs::read_to_string(folder.path().join("out/case/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["status"], "stopped");
    let reason = summary["reason"].as_str().unwrap();
    for fragment in fragments {
        assert!(message.contains(fragment), "`{fragment}` is not in: {message}");
        assert!(reason.contains(fragment), "`{fragment}` is not in the summary: {reason}");
    }
    let rows = history_rows(&folder.path().join("out/case"));
    assert_eq!(summary["increments"], json!(rows));
    rows
}

/// Rows below the header of `history.csv`, each with as many cells.
fn history_rows(results: &Path) -> usize {
    let text = fs::read_to_string(results.join("history.csv")).unwrap();
    let columns = text.lines().next().unwrap().split(',').count();
    assert!(text.ends_with('\n') && text.lines().all(|row| row.split(',').count() == columns), "{text}");
    text.lines().count() - 1
}

#[test]
fn a_body_that_floats_while_solving_is_named_with_its_motion() {
    let mut case = with(&[
        ("/steps/0/supports", json!([{"on": "ground_bottom", "ux": 0, "uy": 0}])),
        ("/steps/0/loads", json!([{"on": "block_top", "pressure": 1}])),
    ]);
    for node in 6..14 {
        let y = &mut case["mesh"]["nodes"][node][1];
        *y = json!(y.as_f64().unwrap() + 0.1);
    }
    let rows = stopped(&case, &["step `press` stopped at time 0", "nothing resists the motion of body `block`"]);
    assert_eq!(rows, 0);
}

#[test]
fn a_load_that_turns_elements_inside_out_stops_with_step_time_and_element() {
    let mut case = with(&[
        ("/contacts", json!({})),
        ("/bodies/block/material/model", json!("saint_venant_kirchhoff")),
        ("/steps/0/dt", json!({"initial": 0.1, "min": 0.02})),
    ]);
    case["steps"][0]["supports"] = json!([
        {"on": "ground_bottom", "ux": 0, "uy": 0},
        {"on": "block_bottom", "ux": 0, "uy": 0},
        {"on": "block_top", "ux": 0, "uy": -2}
    ]);
    let rows = stopped(&case, &["step `press` stopped at time 0.", "element ", "body `block` is inverted"]);
    assert!(rows >= 1);
}

#[test]
fn an_expression_without_a_value_names_its_node() {
    // Not one of the hundred times at which it is looked at before the run.
    let case = with(&[("/steps/0/supports/1/uy", json!("-0.001*sqrt(abs(t - 0.505) - 0.004)"))]);
    let case = edited(case, &[("/steps/0/dt", json!({"initial": 0.101, "min": 0.101, "max": 0.101}))]);
    let rows =
        stopped(&case, &["a support or load at node 1", "is not a finite number at time", "check its expression"]);
    assert!(rows >= 1);
    refused_edits(
        &[("/steps/0/loads", json!([{"on": "block_top", "pressure": "1/(t - t)"}]))],
        &["steps[0].loads[0].pressure: has no finite value at t = 0.01"],
    );
}

#[test]
fn numbers_beyond_double_precision_stop_the_run() {
    let fragment = "step `press` stopped at time 0: ";
    for value in [-1e300, 1e300] {
        stopped(&with(&[("/steps/0/supports/1/uy", json!(value))]), &[fragment]);
    }
    let load = |load: Value| with(&[("/steps/0/loads", json!([load]))]);
    stopped(&load(json!({"on": "ground_top", "force": {"x": 1e300}})), &[fragment, "too large for double precision"]);
    stopped(&load(json!({"on": "ground_top", "pressure": -1e300})), &[fragment, "too large for double precision"]);
    refused_edits(
        &[("/mesh/nodes/6", json!([-1e300, 1e300]))],
        &["mesh: node 6 has the coordinate -1e300: it must lie between -1e100 and 1e100"],
    );
}

#[test]
fn results_are_overwritten_and_paths_may_hold_spaces() {
    let folder = TempDir::new().unwrap();
    let inside = folder.path().join("my cases");
    fs::create_dir(&inside).unwrap();
    write(&inside, "a case.json", good().to_string());
    let absolute = folder.path().join("my results");
    for out in ["../my results", absolute.to_str().unwrap()] {
        let output = fecontact(&inside, &["run", "a case.json", "--quiet", "--out", out]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(stderr(&output).lines().count() == 1 && stderr(&output).contains("results in "), "{}", stderr(&output));
        assert_eq!(history_rows(&absolute), 2);
        assert!(absolute.join("solid/00002.vtu").exists() && absolute.join("solid.pvd").exists());
    }
    write(&absolute, "notes.txt", "mine");
    let quick = with(&[("/output", json!({"fields": false}))]).to_string();
    write(&inside, "a case.json", &quick);
    fecontact(&inside, &["run", "a case.json", "--out", "../my results"]);
    assert!(!absolute.join("solid.pvd").exists() && !absolute.join("solid/00000.vtu").exists(), "old frames are gone");
    assert!(absolute.join("notes.txt").exists(), "what is not ours stays");

    fecontact(&inside, &["run", "a case.json"]);
    assert!(inside.join("out/a case/summary.json").exists());
}

#[test]
fn bad_input_leaves_earlier_results_alone() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), "case.json", good().to_string());
    fecontact(folder.path(), &["run", "case.json"]);
    let before = fs::read(folder.path().join("out/case/summary.json")).unwrap();
    write(folder.path(), "case.json", "{}");
    assert_eq!(fecontact(folder.path(), &["run", "case.json"]).status.code(), Some(2));
    assert_eq!(fs::read(folder.path().join("out/case/summary.json")).unwrap(), before);
}

/// The default penalty is that of the softer side, whichever is the slave.
#[test]
fn default_penalty_is_that_of_the_softer_side() {
    let folder = TempDir::new().unwrap();
    let mut case = with(&[("/contacts/base/normal", json!({})), ("/bodies/ground/material/E", json!(100))]);
    case["contacts"]["base"]["friction"].as_object_mut().unwrap().remove("alpha_t");
    write(folder.path(), "case.json", case.to_string());
    let output = fecontact(folder.path(), &["check", "case.json"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("alpha_n 40384.6 "), "a tenth of 300 (λ + 2G)/h = 403846 is not in:\n{text}");
}

/// Parameters of a law with a peak are told in the numbers of a test, in a line: the peak from rest 25.0175/98.1 and its plastic slip
/// 0.040384 − 25.0175/1000 are those of `the_attained_peak_converges_to_25_0175`, the rest is ln 2 μ_k/κ and ln 2 μ_s/ξ.
#[test]
fn check_tells_what_the_numbers_of_a_law_mean() {
    let told = |changes: &[(&str, Value)]| {
        let [told, _] = outcome("check", changes);
        let lines: Vec<String> =
            told.lines().filter(|line| line.contains("q/p")).map(|line| line.trim().into()).collect();
        assert_eq!(lines.len(), 1, "{told}");
        lines.into_iter().next().unwrap()
    };
    let first = "rapid slip after a long hold: peak q/p 0.255 at a plastic slip of 0.0154";
    let falls = "residual q/p 0.2, half of the weakening from mu_s within 0.0139 of slip";
    assert_eq!(told(&[]), format!("{first}, {falls}; no healing"));
    let heals = [("/contacts/base/friction/xi", json!(0.02)), ("/contacts/base/friction/structure", json!(1))];
    assert_eq!(told(&heals), format!("{first} (0.2 at the start of the run), {falls}; half recovers in 13.9"));
    let along = ("/contacts/base/along", json!({"kappa": "5*x"}));
    let varies = told(&[along]);
    // Ranges of the peak, its slip and the slip of half of the fall.
    assert!(varies.matches(" to ").count() == 3 && varies.contains(", residual q/p 0.2, "), "{varies}");
    let coulomb = ("/contacts/base/friction", json!({"law": "coulomb", "mu": 0.3}));
    let [told, _] = outcome("check", &[coulomb]);
    assert!(!told.contains("q/p"), "{told}");
    for (every, words) in [(2, "every 2nd row"), (3, "every 3rd row"), (11, "every 11th row"), (21, "every 21st row")] {
        let [told, _] = outcome("check", &[("/output", json!({"every": every}))]);
        assert!(told.contains(words), "{told}");
    }
}

/// What the case leaves open follows from the surfaces, not from their round-off, and is told with the reason; a method that
/// is named stays, with a warning where pressures are known to suffer, in `check`, in the summary and on stderr.
#[test]
fn the_method_follows_from_the_surfaces() {
    let bent = |by: f64| ("/mesh/nodes/6/1", json!(-by));
    let mortar = "mortar, averaged around each node (chosen because the master is a mesh)";
    for by in [0.0, 1e-12, 1e-6, 0.05] {
        let [told, _] = outcome("check", &[bent(by)]);
        assert!(told.contains(mortar), "bent by {by}:\n{told}");
    }
    let plane = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
    let [_, told] = outcome("run", &[bent(0.05), ("/contacts/base/master", plane)]);
    assert!(told.contains("contact `base`: mortar, chosen because surfaces are curved"), "{told}");
    for method in ["node_to_segment", "gauss_to_segment"] {
        let named = [bent(0.05), ("/contacts/base/method", json!(method))];
        let concern = format!("contact `base`: {method} on curved or quadratic surfaces: pressures scatter");
        let [checked, _] = outcome("check", &named);
        let [_, run] = outcome("run", &named);
        assert!(checked.contains(&concern) && run.contains(&format!("warning: {concern}")), "{checked}\n{run}");
        let [checked, _] = outcome("check", &[named[1].clone()]);
        assert!(!checked.contains("curved"), "{checked}");
    }
    let [told, _] = outcome("check", &[bent(0.05), ("/contacts/base/smooth", json!(true))]);
    assert!(told.contains("gauss_to_segment") && told.contains("leave `smooth` out for mortar"), "{told}");
}

/// The block of three edges of length 1 on a ground of two of length 2, and the same moved until one point in three is past the
/// ground's end.
#[test]
fn check_tells_how_far_small_sliding_goes() {
    let small = ("/contacts/base/sliding", json!("small"));
    let line = "small sliding: every point keeps its initial projection, normal and length; valid for slips up to 0.1 \
                and rotations up to 0.02 rad";
    let [told, _] = outcome("check", std::slice::from_ref(&small));
    assert!(told.contains(line), "{told}");
    let plane = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
    let [told, _] = outcome("check", &[small.clone(), ("/contacts/base/master", plane)]);
    assert!(told.contains("length; valid for rotations up to 0.02 rad"), "{told}");
    let moved: Vec<Value> = good()["mesh"]["nodes"]
        .as_array()
        .expect("nodes")
        .iter()
        .enumerate()
        .map(|(k, node)| json!([node[0].as_f64().expect("x") + if k > 5 { 1.5 } else { 0.0 }, node[1]]))
        .collect();
    let [told, _] = outcome("check", &[small, ("/mesh/nodes", json!(moved.clone()))]);
    assert!(
        told.contains("of the slave without a projection on the master, and never come into contact in small sliding"),
        "{told}"
    );
    let [told, _] = outcome("check", &[("/mesh/nodes", json!(moved))]);
    // In finite sliding they do no harm: `check` counts them, and nothing is warned of.
    assert!(told.contains("point without a projection") || told.contains("points without a projection"), "{told}");
    assert!(told.contains("warnings  none"), "{told}");
}

#[test]
fn check_tells_what_was_understood() {
    let folder = TempDir::new().unwrap();
    let mut case = with(&[("/contacts/base/normal", json!({})), ("/mesh/nodes/6/1", json!(-0.01))]);
    case["contacts"]["base"]["friction"].as_object_mut().unwrap().remove("alpha_t");
    write(folder.path(), "case.json", case.to_string());
    let output = fecontact(folder.path(), &["check", "case.json"]);
    let text = String::from_utf8(output.stdout).unwrap();
    for part in [
        "14 nodes, 5 elements (5 Q4), 28 dofs",
        "block_bottom   3 edges, x from 0.5 to 3.5, y from -0.01 to 0",
        "ground_bottom  2 edges, x from 0 to 4, y = -1",
        "neo_hookean: E 1000",
        "mortar, averaged around each node (chosen because the master is a mesh): 4 contact points",
        "alpha_n 4.03183e5 (300 (λ + 2G)/h of the softer body, h the depth of the slave's elements)",
        "alpha_t 6719.72 (5 (λ + 2G)/h): of the law, whose slip is elastic at first",
        "surfaces overlap by up to 0.006667",
        "dt: initial 0.5, min 0.01, max 0.5",
        "support block_top: uy = -0.001",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
    assert!(!folder.path().join("out").exists());

    let mut dynamic = case.clone();
    for body in ["block", "ground"] {
        dynamic["bodies"][body]["material"]["density"] = json!(1e-3);
    }
    dynamic["steps"][0]["scheme"] = json!({"generalized_alpha": {}});
    dynamic["steps"][0]["dt"] = json!({"initial": 0.01, "error": 1e-6});
    write(folder.path(), "dynamic.json", dynamic.to_string());
    let output = fecontact(folder.path(), &["check", "dynamic.json"]);
    let text = String::from_utf8(output.stdout).unwrap();
    for part in [
        "generalized_alpha {\"rho_infinity\":0.8}",
        "dt: initial 0.01, min 1e-8, max 0.1",
        "error per increment at most 1e-6 in any displacement, contact events located within 1e-5",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
}

/// What `check` warns of reaches a run: once on stderr, once in the summary.
#[test]
fn warnings_of_check_reach_the_run() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), "case.json", with(&[("/mesh/nodes/6/1", json!(-0.01))]).to_string());
    let check = fecontact(folder.path(), &["check", "case.json"]);
    let told = "surfaces overlap by up to 0.006667 at the start, at (0.5, -0.01)";
    assert!(String::from_utf8_lossy(&check.stdout).contains(told), "{}", String::from_utf8_lossy(&check.stdout));
    let run = fecontact(folder.path(), &["run", "case.json"]);
    assert_eq!(stderr(&run).matches(told).count(), 1, "{}", stderr(&run));
    let summary: Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("out/case/summary.json")).unwrap()).unwrap();
    let warnings = summary["warnings"].as_array().unwrap();
    assert_eq!(warnings.iter().filter(|warning| warning.as_str().unwrap().contains(told)).count(), 1, "{warnings:?}");
}

/// Overlap that is round-off of the positions is none, near the origin and far from it; that of a shrink fit is told, and no
/// reason to warn.
#[test]
fn overlap_is_told_where_it_means_something() {
    let folder = TempDir::new().unwrap();
    let checked = |case: &Value| {
        write(folder.path(), "case.json", case.to_string());
        String::from_utf8(fecontact(folder.path(), &["check", "case.json"]).stdout).unwrap()
    };
    let text = checked(&with(&[("/mesh/nodes/6/1", json!(-1.2e-18))]));
    assert!(text.contains("initial gap 0 everywhere") && text.contains("warnings  none"), "{text}");
    let mut far = with(&[("/mesh/nodes/6/1", json!(-1e-9))]);
    for node in far["mesh"]["nodes"].as_array_mut().unwrap() {
        *node = json!([node[0], node[1].as_f64().unwrap() + 1e5]);
    }
    let text = checked(&far);
    assert!(text.contains("surfaces overlap by up to"), "1e-9 is seen at 1e5:\n{text}");
    far["mesh"]["nodes"][6][1] = json!(1e5 - 2e-11);
    let text = checked(&far);
    assert!(text.contains("warnings  none"), "one digit of 1e5:\n{text}");
    let text = checked(&with(&[("/mesh/nodes/6/1", json!(-0.01)), ("/contacts/base/shrink_fit", json!(true))]));
    let told = "shrink fit: the surfaces overlap by up to 0.006667, at (0.5, -0.01), brought in over the first";
    assert!(text.contains(told) && text.contains("warnings  none"), "{text}");
}

/// A step inherits the scheme; `check` says which each has, and how what is freed or ended goes.
#[test]
fn check_tells_scheme_and_endings_of_each_step() {
    let folder = TempDir::new().unwrap();
    let mut case = good();
    for body in ["block", "ground"] {
        case["bodies"][body]["material"]["density"] = json!(1e-3);
    }
    case["steps"][0]["scheme"] = json!({"newmark": {}});
    case["steps"][0]["loads"] =
        json!([{"on": "block_top", "traction": {"x": 1}}, {"on": "block_top", "spring": {"kx": 1}}]);
    let free = json!({"name": "free", "duration": 1, "supports": [{"on": "block_top", "uy": null}],
                      "loads": [{"on": "block_top", "traction": null}, {"on": "block_top", "spring": null}]});
    let rest = json!({"name": "rest", "duration": 1, "scheme": "static", "supports": [{"on": "block_top", "ux": null, "uy": 0}]});
    case["steps"].as_array_mut().unwrap().extend([free, rest]);
    write(folder.path(), "case.json", case.to_string());
    let text = String::from_utf8(fecontact(folder.path(), &["check", "case.json"]).stdout).unwrap();
    for part in [
        "time 0 to 1, newmark",
        "time 1 to 2, newmark",
        "support block_top: uy released, at once",
        "load block_top: traction ended, it fades over the step",
        "load block_top: spring ended, at once",
        "time 2 to 3, static",
        "support block_top: ux released, its reaction fades over the step",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
}

proptest::proptest! {
    #[test]
    fn no_text_makes_the_expression_parser_panic(text in "[-+*/^()xyt0-9. a-z{},πé]{0,40}") {
        let _ = fecontact::model::boundary::Expression::parse(&text);
    }

    #[test]
    fn no_slip_of_the_keyboard_makes_the_reader_panic(
        place in 0.0..1.0f64,
        removed in 0..4usize,
        typed in "[-0-9.eE{}\\[\\]\",:a-z]{0,3}",
    ) {
        let mut text = good().to_string();
        let start = (place * text.len() as f64) as usize;
        text.replace_range(start..(start + removed).min(text.len()), &typed);
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("case.json");
        fs::write(&path, text).unwrap();
        let model = fecontact::case::read(&path).and_then(|case| fecontact::case::build(&case, &path));
        let _ = model.map_err(|error| error.to_string());
    }
}

/// The slave's group as its own master is contact of a surface with itself, and told as such.
#[test]
fn a_surface_may_touch_itself() {
    let folder = TempDir::new().expect("a temporary folder");
    write(folder.path(), "own.json", with(&[("/contacts/base/master", json!("block_bottom"))]).to_string());
    let output = fecontact(folder.path(), &["check", "own.json"]);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && told.contains("slave block_bottom against master itself"), "{told}");
}

/// Mass moved off a slave is for implicit steps.
#[test]
fn an_explicit_step_needs_the_mass_of_every_node() {
    refused_edits(
        &[
            ("/contacts/base/massless", json!(true)),
            ("/steps/0/scheme", json!({"explicit": {}})),
            ("/bodies/ground/material/density", json!(1)),
            ("/bodies/block/material/density", json!(1)),
        ],
        &["contacts.base.massless: ", "the explicit step `press` needs the mass of every node: leave it out"],
    );
}

/// What the numbers of a mesh far from the origin cannot say is told, by `check` and by `run`: at 1e8 they have 2e-8 of round-off,
/// a share of 2e-8 of these edges; at 1e7 a tenth of that.
#[test]
fn positions_that_round_off_blurs_are_told() {
    let moved = |shift: f64| {
        let mut case = good();
        let nodes = case["mesh"]["nodes"].as_array_mut().expect("a list");
        nodes.iter_mut().for_each(|node| node[0] = json!(node[0].as_f64().expect("a number") + shift));
        case
    };
    let told = "the round-off of their positions, and of initial gaps and overlaps, is 2e-8";
    let folder = TempDir::new().unwrap();
    write(folder.path(), "far.json", moved(1e8).to_string());
    let text = String::from_utf8(fecontact(folder.path(), &["check", "far.json"]).stdout).unwrap();
    assert!(text.contains(told), "{text}");
    let run = fecontact(folder.path(), &["run", "far.json", "--out", "far"]);
    assert_eq!((run.status.code(), stderr(&run).matches(told).count()), (Some(0), 1), "{}", stderr(&run));
    write(folder.path(), "near.json", moved(1e7).to_string());
    let text = String::from_utf8(fecontact(folder.path(), &["check", "near.json"]).stdout).unwrap();
    assert!(text.contains("warnings  none"), "{text}");
}

/// serde's types would take the values of a list for the keys of an object in their order.
#[test]
fn lists_are_no_objects() {
    for (pointer, value) in [
        ("/contacts/base/normal", json!([4e5, null])),
        ("/steps/0/dt", json!([0.2, null, 0.2, null])),
        ("/bodies/block", json!([{"model": "linear", "E": 1000, "nu": 0.3}])),
        ("/bodies/block/material", json!(["neo_hookean", 1000, 0.3, 0])),
        ("/contacts/base/friction", json!(["coulomb", 0.3, 1e5])),
        ("/output", json!([3])),
        ("/newton", json!([1e-4, 3])),
        ("/steps/0/supports/0", json!(["ground_bottom", 0, 0])),
        ("/steps/0", json!(["press", 1])),
        ("/steps/0/loads", json!([["block", null, null, null, {"y": -1}]])),
        ("/steps/0/scheme", json!({"newmark": [0.25, 0.5]})),
        ("/contacts/base/master", json!({"plane": [[0, 0], [0, 1]]})),
        ("/mesh", json!([[[0, 0]]])),
        ("/steps/0/supports/1/ux", json!({"rate": [1]})),
    ] {
        let place = pointer[1..].replace('/', ".");
        let place = place.replace(".0", "[0]").replace(".1", "[1]");
        refused_edits(&[(pointer, value)], &[&place, "is a list […], but must be "]);
    }
    refused_case("[1, 2]", &["is a list […], but must be an object {…}"]);
}

/// Text that steers a terminal is spelled out, on stdout and on stderr.
#[test]
fn control_characters_are_never_printed() {
    let steering = "\u{1b}[2J\u{1b}]0;x\u{7}\u{202e}";
    let plain = |text: &str| {
        let raw = text.chars().find(|c| (c.is_control() && *c != '\n') || *c == '\u{202e}');
        assert_eq!(raw, None, "{text:?}");
        assert!(text.contains("\\u{1b}[2J") || text.contains("\\u{202e}"), "{text:?}");
    };
    let [printed, _] = outcome("check", &[("/title", json!("\u{202e}turned"))]);
    plain(&printed);
    let folder = TempDir::new().unwrap();
    for edit in [
        (format!("/{steering}"), json!(1)),
        ("/title".into(), json!(steering)),
        ("/units".into(), json!({"length": steering})),
        (format!("/bodies/{steering}"), good()["bodies"]["block"].clone()),
        ("/mesh".into(), json!(format!("{steering}.msh"))),
        ("/watch".into(), json!([steering])),
        ("/steps/0/duration".into(), json!(steering)),
        ("/steps/0/supports/0/on".into(), json!(steering)),
        ("/steps/0/supports/1/uy".into(), json!(format!("t + {steering}"))),
    ] {
        write(folder.path(), "bad.json", with(&[(&edit.0, edit.1)]).to_string());
        let output = fecontact(folder.path(), &["check", "bad.json"]);
        assert_eq!(output.status.code(), Some(2));
        plain(&stderr(&output));
    }
    // A file name with a line break makes no line of its own.
    write(folder.path(), "bad.json", with(&[("/mesh", json!("a\nerror: b.msh"))]).to_string());
    assert_eq!(stderr(&fecontact(folder.path(), &["check", "bad.json"])).lines().count(), 1);
}

/// Names become columns and files, titles and units stand in figures: what could not be written, or not be read again, is refused
/// before anything is.
#[test]
fn names_that_no_file_can_have_are_refused() {
    let long = "n".repeat(200);
    let wide = "接".repeat(40);
    let renamed = |pointer: &str, from: &str, to: &str| {
        let mut case = good();
        let object = case.pointer_mut(pointer).and_then(Value::as_object_mut).expect("an object");
        let value = object.remove(from).expect("it is there");
        object.insert(to.into(), value);
        case
    };
    let body = |name: &str| {
        let text = renamed("/bodies", "block", name).to_string();
        let mut case: Value = serde_json::from_str(&text).expect("JSON");
        let elements = case["mesh"]["elements"].as_object_mut().expect("elements");
        let own = elements.remove("block").expect("a body");
        elements.insert(name.into(), own);
        case
    };
    let with_probe = |name: &str| with(&[("/probes", json!({name: {"at": [0.5, 0.5]}}))]);
    let refused: [(Value, &[&str]); 12] = [
        (
            renamed("/contacts", "base", &long),
            &["contacts: the name \"nnnnnnnnnnnnnnnnnnnn\"… is 200 bytes long", "take at most 100"],
        ),
        (renamed("/contacts", "base", &wide), &["contacts: the name", "is 120 bytes long"]),
        (renamed("/contacts", "base", "a\u{1}b"), &["contacts: the name", "'\\u{1}'"]),
        (renamed("/contacts", "base", "a\u{ffff}"), &["contacts: the name", "'\\u{ffff}'"]),
        (body(&long), &["bodies: the name", "is 200 bytes long"]),
        (body("a,b"), &["bodies: the name \"a,b\" has ',' in it"]),
        (body("a\"b"), &["bodies: the name", "has '\"' in it"]),
        (with(&[("/steps/0/name", json!(long))]), &["steps[0].name: the name", "is 200 bytes long"]),
        (with_probe(&long), &["probes.", "is 200 bytes long"]),
        (with_probe("a\nb"), &["probes.", "'\\n'"]),
        (with(&[("/title", json!("a\u{1}b"))]), &["title: \"a\\u{1}b\" has '\\u{1}' in it"]),
        (with(&[("/units", json!({"length": "m\u{0}"}))]), &["units.length: ", "has '\\0' in it"]),
    ];
    for (case, expected) in refused {
        let folder = TempDir::new().unwrap();
        write(folder.path(), "bad.json", case.to_string());
        for command in [&["check", "bad.json"][..], &["run", "bad.json", "--out", "out"]] {
            let output = fecontact(folder.path(), command);
            let told = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{told}");
            assert!(expected.iter().all(|part| told.contains(part)), "{expected:?}: {told}");
        }
        assert!(!folder.path().join("out").exists());
    }
}

/// Names that look like paths, or differ by case alone, stay in the folder, each with arrays of its own; so does the longest.
#[test]
fn names_of_contacts_never_leave_the_folder() {
    let longest = "n".repeat(100);
    let names = ["a/b", "A/B", "..", "../../up", ".hidden", "a b", "é", longest.as_str(), "con", "a\\b", "<&>'"];
    let mut case = good();
    let base = case["contacts"]["base"].clone();
    case["contacts"] =
        names.iter().map(|name| ((*name).to_string(), base.clone())).collect::<serde_json::Map<_, _>>().into();
    case["title"] = json!("<&> \u{202e}");
    let folder = TempDir::new().unwrap();
    write(folder.path(), "case.json", case.to_string());
    let output = fecontact(folder.path(), &["run", "case.json", "--quiet", "--out", "out"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let beside: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(beside.len(), 2, "{beside:?}");
    let arrays: Vec<String> = fs::read_dir(folder.path().join("out/interface.zarr"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap().to_lowercase())
        .filter(|name| name.ends_with(".slip"))
        .collect();
    let different: std::collections::BTreeSet<&String> = arrays.iter().collect();
    assert_eq!((arrays.len(), different.len()), (names.len(), names.len()), "{arrays:?}");
}

/// "Did you mean" only where it may be true.
#[test]
fn what_is_like_nothing_known_is_not_likened() {
    for key in ["zz", "b0", "xyz", "comment"] {
        let folder = TempDir::new().unwrap();
        write(folder.path(), "bad.json", with(&[(&format!("/{key}"), json!(1))]).to_string());
        let told = stderr(&fecontact(folder.path(), &["check", "bad.json"]));
        assert!(told.contains(&format!("`{key}` is not known here. Known are `title`")), "{told}");
        assert!(!told.contains("did you mean"), "{told}");
    }
    let folder = TempDir::new().unwrap();
    write(folder.path(), "bad.json", with(&[("/watch", json!(["roof"]))]).to_string());
    let told = stderr(&fecontact(folder.path(), &["check", "bad.json"]));
    assert!(told.contains("the mesh has no group `roof`; it has `block`"), "{told}");
}

/// Settings that no solution can meet, or any can.
#[test]
fn tolerances_out_of_reach_or_reason_are_refused() {
    refused_edits(
        &[("/newton", json!({"tolerance": 0.9}))],
        &["newton.tolerance: is 0.9: must be above 0 and at most 0.01"],
    );
    // The box around the nodes of the contact is 4 long and has no height [L].
    let least = 8.0 * f64::EPSILON * 4.0;
    let normal = |penetration: f64| ("/contacts/base/normal", json!({"alpha_n": 1e5, "penetration": penetration}));
    refused_edits(
        &[normal(0.99 * least)],
        &["contacts.base.normal.penetration: is 7.", &format!("gaps of this contact have round-off of {least:.1e}")],
    );
    outcome("check", &[normal(1.01 * least)]);
}

/// The length of a run is foreseen as far as it follows from the case.
#[test]
fn endless_runs_are_refused_and_long_ones_told() {
    let dt = |max: f64| ("/steps/0/dt", json!({"initial": max, "min": 0.5 * max, "max": max}));
    refused_edits(&[dt(1e-9)], &["steps[0].dt: increments of at most 1e-9 make 1.0e9 of them in a step of 1e0"]);
    let [printed, _] = outcome("check", &[dt(1e-7)]);
    assert!(printed.contains("the run takes at least 1.0e7 increments, each a row of history.csv"), "{printed}");
    let [printed, _] = outcome("check", &[dt(1e-5)]);
    assert!(!printed.contains("the run takes at least"), "{printed}");
    let material = json!({"model": "neo_hookean", "E": 1000, "nu": 0.3, "density": 1});
    let explicit = [
        ("/bodies/block/material", material.clone()),
        ("/bodies/ground/material", material),
        ("/steps/0/scheme", json!({"explicit": {"safety": 0.9}})),
        ("/steps/0/duration", json!(1e6)),
        ("/steps/0/dt", json!({"initial": 1})),
        ("/output", json!({"interval": 1e-3})),
    ];
    refused_edits(&explicit, &["output.interval: is 1e-3: that makes 1.0e9 rows of results"]);
    let mut explicit = explicit;
    explicit[5].1 = json!({"interval": 1e4});
    // c_p = √(E (1 − ν)/((1 + ν)(1 − 2ν) ρ)) = √1346.15 along the shortest side, 1 [L].
    let [printed, _] = outcome("check", &explicit);
    assert!(printed.contains("the run takes at least 3.7e7 increments: explicit ones"), "{printed}");
}

/// Meshes that have areas everywhere, and still cannot be computed with, are named by element or line.
#[test]
fn degenerate_meshes_are_named() {
    let node = |k: usize, at: [f64; 2]| {
        let mut nodes = good()["mesh"]["nodes"].clone();
        nodes[k] = json!(at);
        [("/mesh/nodes", nodes)]
    };
    refused_edits(
        &node(8, [1.5, 0.0]),
        &[
            "mesh: element 1 of `block` is degenerate: its side from node 7 to node 8 is 0.000e0 long",
            "merge the two nodes",
        ],
    );
    refused_edits(
        &node(8, [1.5 + 1e-9, 0.0]),
        &["element 1 of `block` is degenerate: its side from node 7 to node 8 is 1.000e-9"],
    );
    outcome("check", &node(8, [1.5 + 1e-6, 0.0]));
    let moved: Vec<Value> = good()["mesh"]["nodes"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|node| json!([node[0].as_f64().expect("x") + 2f64.powi(44), node[1]]))
        .collect();
    refused_edits(
        &[("/mesh/nodes", moved.into())],
        &["element 0 of `block` lies so far from the origin that the positions of its nodes are known to 3.9e-3 only"],
    );
}

/// gmsh's parser gives up without a word on some lines.
#[test]
fn every_reason_says_something() {
    let mesh = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("data/quad4.msh")).unwrap();
    let line = "1 0 0 0 2 1 0 1 1 4 1 2 3 4";
    assert!(mesh.contains(line));
    let folder = TempDir::new().unwrap();
    write(folder.path(), "bad.msh", mesh.replace(line, "1 0 0 0 2 1 0 2 1 4 1 2 3 4"));
    write(folder.path(), "bad.json", with(&[("/mesh", json!("bad.msh"))]).to_string());
    let told = stderr(&fecontact(folder.path(), &["check", "bad.json"]));
    assert!(
        told.contains("bad.msh: the mesh cannot be understood at line ") && told.contains("` has more, fewer or other"),
        "{told}"
    );
    assert!(!told.contains(": ;"), "{told}");
}

/// Where no equilibrium is found, the reason says where, and what is out of proportion there.
#[test]
fn what_does_not_converge_names_a_suspect() {
    let stopped = |edits: &[(&str, Value)], fragments: &[&str]| {
        let folder = TempDir::new().unwrap();
        write(folder.path(), "bad.json", with(edits).to_string());
        let output = fecontact(folder.path(), &["run", "bad.json", "--quiet"]);
        let told = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{told}");
        for fragment in fragments {
            assert!(told.contains(fragment), "`{fragment}` is not in: {told}");
        }
    };
    // One linear solve is never enough for a contact that closes.
    let hasty = ("/newton", json!({"max_iterations": 1}));
    let shove = ("/steps/0/supports/1/uy", json!(-0.05));
    stopped(&[hasty.clone(), shove.clone()], &["no equilibrium within 1 iteration (", "; largest residual at node "]);
    // (λ + 2G)/h = 1346.15: 1e9 is 742 857 times that.
    let stiff = ("/contacts/base/normal/alpha_n", json!(1e9));
    stopped(
        &[hasty.clone(), shove.clone(), stiff],
        &[
            "; alpha_n = 1e9 of contact `base` is 7.42857e5 times the stiffness (λ + 2G)/h",
            "where 10 is common: lower it",
        ],
    );
    let stiff = ("/contacts/base/friction/alpha_t", json!(1e9));
    stopped(&[hasty.clone(), shove.clone(), stiff], &["; alpha_t = 1e9 of contact `base` is 7.42857e5 times"]);
    let soft = ("/bodies/block/material/nu", json!(0.4999));
    stopped(
        &[hasty, shove, soft],
        &["; nu = 0.4999 of body `block` is near 1/2, where its elements lock: give it \"element\": \"f_bar\""],
    );
}

/// A rigid master with its inside out.
#[test]
fn a_slave_that_faces_away_is_told() {
    let checked = |master: Value| outcome("check", &[("/contacts/base/master", master)])[0].clone();
    let plane = |y: f64| json!({"plane": {"point": [0, 0], "normal": [0, y]}});
    let told = "contact `base`: the slave faces away from the rigid master everywhere, as at (";
    let circle = |hole: bool| json!({"circle": {"centre": [2, -100], "radius": 100, "hole": hole}});
    for (right, wrong) in [(plane(1.0), plane(-1.0)), (circle(false), circle(true))] {
        assert!(!checked(right).contains(told));
        let wrong = checked(wrong);
        assert!(wrong.contains(told), "{wrong}");
    }
}
