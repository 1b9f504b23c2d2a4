//! Cases with every default filled in: `fecontact check --resolved`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use fecontact::case::{self, Opened, Written};
use fecontact::model::Model;
use fecontact::run::Simulation;
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::common::Blocks;

/// Increments of a run that are compared.
const INCREMENTS: usize = 2;

/// Cases larger than this are not run.
const DOFS_TO_RUN: usize = 2500;

/// Cases larger than this are not compared.
const DOFS: usize = 25_000;

fn cases(folder: &Path) -> Vec<PathBuf> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<_>, Vec<_>) = paths.partition(|path| path.is_dir());
    let files = files.into_iter().filter(|path| path.extension() == Some("json".as_ref()));
    let folders = folders.iter().filter(|folder| !folder.ends_with("law"));
    files.chain(folders.flat_map(|folder| cases(folder))).collect()
}

/// The model of a case, and the case with its defaults filled in.
fn built(text: &str, path: &Path) -> (Model, String) {
    let written = Written::from_text(text, path).unwrap_or_else(|error| panic!("{error}"));
    let model = case::build(&written.case, path).unwrap_or_else(|error| panic!("{error}"));
    let resolved = case::resolved(&written.case, &model);
    (model, resolved)
}

/// All of a model but why its methods, and the openings over which bonds fade, were chosen.
fn message(mut model: Model) -> String {
    for pair in &mut model.contacts {
        pair.fades = None;
    }
    format!("{:?}", Model { methods: Vec::new(), ..model })
}

fn bits(model: Model) -> Vec<u64> {
    let mut run = Simulation::new(model);
    for _ in 0..INCREMENTS {
        if !matches!(run.next_increment(), Ok(Some(_))) {
            break;
        }
    }
    let state = run.state();
    let values = state.displacement.iter().chain(&state.velocity).chain(&state.reaction).chain([&state.time]);
    values.map(|value| value.to_bits()).collect()
}

/// Every committed case: what is filled in leaves nothing more to fill in, and makes the same model; small ones run to the same bits.
#[test]
fn a_resolved_case_is_the_same_case() {
    let (mut compared, mut run) = (0, 0);
    for path in cases(&crate::common::repository("cases")) {
        let text = fs::read_to_string(&path).unwrap();
        let Ok(opened) = Written::from_text(&text, &path).and_then(Opened::begin) else { continue };
        if opened.inputs.iter().any(|input| !input.exists()) {
            continue;
        }
        let (model, resolved) = built(&text, &path);
        let dofs = model.dofs();
        if dofs > DOFS {
            continue;
        }
        compared += 1;
        let (again, resolved_again) = built(&resolved, &path);
        assert!(resolved == resolved_again, "{}: resolving twice changes it", path.display());
        if dofs < DOFS_TO_RUN {
            run += 1;
            assert!(bits(model) == bits(again), "{}: other bits", path.display());
        } else {
            assert!(message(model) == message(again), "{}: another model", path.display());
        }
    }
    assert!(compared >= 20 && run >= 5, "{compared} cases were compared, {run} of them run");
}

/// A bond beside every law, also where another one holds on a part of the contact, and with its own stiffness.
#[test]
fn a_bond_beside_each_law_is_the_same_in_the_resolved_case() {
    let mesh = Blocks::default().rectangle("ground", [4, 1], [0.0, -1.0], [2.0, 0.0]).rectangle(
        "block",
        [2, 1],
        [0.5, 0.0],
        [1.5, 1.0],
    );
    let body = json!({"material": {"model": "linear", "E": 100, "nu": 0.3}});
    let case = |friction: &Value, along: Value, bond: Value| {
        json!({
            "mesh": mesh.json(),
            "bodies": {"block": body, "ground": body},
            "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "friction": friction, "bond": bond, "along": along}},
            "steps": [{"name": "drag", "duration": 1, "dt": {"initial": 0.25, "max": 0.25}, "supports": [
                {"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0.01, "uy": -0.01}
            ]}]
        })
    };
    let path = Path::new("case.json");
    let laws = [
        json!({"law": "frictionless"}),
        json!({"law": "coulomb", "mu": 0.3}),
        json!({"law": "coulomb", "mu": 0.3, "alpha_t": 777}),
        json!({"law": "slip_weakening", "mu_s": 0.4, "mu_d": 0.2, "D_c": 0.01}),
        json!({"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "r": 500, "kappa": 20, "xi": 0.1}),
        json!({"law": "rate_and_state", "f_0": 0.4, "V_0": 1e-3, "a": 0.01, "b": 0.015, "D_c": 0.01, "theta": 10}),
    ];
    let elsewhere = |k: usize| json!({"law": [{"where": "1 - x", "friction": laws[k]}]});
    let [plain, soft] =
        [json!({"strength": 0.5, "opening": 0.01}), json!({"strength": 0.5, "opening": 0.01, "alpha_t": 555})];
    for (k, friction) in laws.iter().enumerate() {
        for (along, bond) in [(json!({}), &plain), (json!({}), &soft), (elsewhere((k + 1) % laws.len()), &plain)] {
            let case = case(friction, along, bond.clone());
            let (model, resolved) = built(&case.to_string(), path);
            let (again, resolved_again) = built(&resolved, path);
            assert_eq!(resolved, resolved_again, "{case}: resolving twice changes it");
            let [as_given, as_resolved] = [bits(model), bits(again)];
            assert!(as_given.iter().any(|bits| *bits << 1 != 0), "{case} does not run");
            assert!(as_given == as_resolved, "{case}: other bits");
        }
    }
}

fn fecontact(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fecontact_tested")).args(arguments).current_dir(folder).output().unwrap()
}

/// What is inherited and what the mesh decides is given, and a case that begins with another can still begin there.
#[test]
fn defaults_are_printed_and_run() {
    let folder = TempDir::new().unwrap();
    let mesh = Blocks::default().rectangle("ground", [2, 1], [0.0, -1.0], [2.0, 0.0]).rectangle(
        "block",
        [2, 1],
        [0.5, 0.0],
        [1.5, 1.0],
    );
    let body = json!({"material": {"model": "linear", "E": 100, "nu": 0.3}});
    let write = |name: &str, case: &Value| fs::write(folder.path().join(name), case.to_string()).unwrap();
    let mut first = json!({
        "mesh": mesh.json(),
        "bodies": {"block": body, "ground": body},
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "friction": {"law": "coulomb", "mu": 0.3}}},
        "steps": [
            {"name": "press", "duration": 1, "supports": [
                {"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.01}
            ]},
            {"name": "drag", "duration": 2, "supports": [{"on": "block_top", "ux": {"rate": 0.01}}]},
        ]
    });
    write("first.json", &first);
    let output = fecontact(&["check", "first.json", "--resolved"], folder.path());
    let resolved: Value = serde_json::from_slice(&output.stdout).unwrap();
    let dt = json!({"initial": 0.1, "min": 1e-4, "max": 0.1, "error": null});
    assert_eq!((&resolved["steps"][0]["dt"], &resolved["steps"][0]["scheme"]), (&dt, &json!("static")));
    assert_eq!(resolved["steps"][1]["dt"]["initial"], 0.2);
    assert_eq!(resolved["steps"][1]["supports"], json!([{"on": "block_top", "ux": {"rate": 0.01}}]));
    let base = &resolved["contacts"]["base"];
    assert_eq!((&base["method"], &base["points"]), (&json!("mortar"), &Value::Null));
    let alpha_n = base["normal"]["alpha_n"].as_f64().unwrap();
    let alpha_t = base["friction"]["alpha_t"].as_f64().unwrap();
    assert!((20.0 * alpha_t - alpha_n).abs() < 1e-12 * alpha_n, "300 and 15 (λ + 2G)/h: {alpha_n} {alpha_t}");
    write("resolved.json", &resolved);
    let history = |case: &str, out: &str| {
        let output = fecontact(&["run", case, "--out", out, "--quiet"], folder.path());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        fs::read_to_string(folder.path().join(out).join("history.csv")).unwrap()
    };
    assert_eq!(history("first.json", "first"), history("resolved.json", "resolved"));

    first["begin_with"] = json!("first");
    first["steps"] = json!([{"name": "back", "duration": 1, "supports": [{"on": "block_top", "ux": {"rate": -0.01}}]}]);
    write("second.json", &first);
    let output = fecontact(&["check", "second.json", "--resolved"], folder.path());
    let resolved: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((resolved["steps"].as_array().map(Vec::len), &resolved["begin_with"]), (Some(1), &json!("first")));
    write("second_resolved.json", &resolved);
    assert_eq!(history("second.json", "second"), history("second_resolved.json", "second_resolved"));
}
