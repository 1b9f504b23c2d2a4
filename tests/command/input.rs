//! Bad input, and runs that cannot go on: every failure has a face.
//!
//! Bad input ends with exit code 2, a message that names file, key and value, and nothing written. A run that stops
//! ends with exit code 1, says when and why, and keeps what it computed.

mod contacts;
mod documents;
mod files;
mod steps;
mod stops;
mod understood;

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output};
use stops::history_rows;

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
    // 300 and 10 (λ + 2G)/h of the elements there, of size 1: λ + 2G = E (1 − ν)/((1 + ν)(1 − 2ν)) = 1346.15.
    for (scheme, number) in [(json!("static"), "give 4.03846e5,"), (json!({"hht": {"alpha": -0.1}}), "give 13461.5,")] {
        refused_edits(
            &[
                ("/mesh/points", json!({"corner": [6]})),
                ("/contacts/base/slave", json!("corner")),
                ("/contacts/base/area", json!(1)),
                ("/contacts/base/normal", json!({})),
                ("/bodies/ground/material/density", json!(1)),
                ("/bodies/block/material/density", json!(1)),
                ("/steps/0/scheme", scheme),
            ],
            &["contacts.base.normal.alpha_n: ", number, "the default of element sides there"],
        );
    }
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
            ["contacts.base.normal.alpha_n: ", "get a spring of alpha_n × area each; give 100 times"],
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
