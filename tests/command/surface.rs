//! What a user can hold on to: keys of both inputs, commands and their options, columns and arrays of all results. It stands in the
//! files of `tests/command/surface/`; the public names of the Python package stand in `python/tests/surface.txt`.
//!
//! Whoever changes one of them on purpose renews the files with `SURFACE=renew cargo test --release --test command surface` and
//! tells of each difference in CHANGELOG.md, with what to use instead.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};
use tempfile::TempDir;

/// What the program prints.
fn printed(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_fecontact_tested")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Compare what there is with what the file of this name says, or write it there.
fn compare(name: &str, found: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("command/surface").join(name);
    if std::env::var("SURFACE").is_ok_and(|way| way == "renew") {
        fs::write(&file, found).unwrap();
        return;
    }
    let known = fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let (before, now) = (sections(&known), sections(found));
    let lost: Vec<&String> = before.iter().filter(|line| !now.contains(line)).collect();
    let new: Vec<&String> = now.iter().filter(|line| !before.contains(line)).collect();
    assert!(
        known == found,
        "{}: users lose {lost:#?}, and get {new:#?}{}. If this is meant, tell of it in CHANGELOG.md with what to use instead, and \
         run `SURFACE=renew cargo test --release --test command surface`",
        file.display(),
        if lost.is_empty() && new.is_empty() { " (only the order differs)" } else { "" }
    );
}

/// The lines of a text, those that are set in behind the one above them.
fn sections(text: &str) -> Vec<String> {
    let mut heading = "";
    let line = |line| match str::strip_prefix(line, "  ") {
        Some(inner) => format!("{heading}: {inner}"),
        None => {
            heading = line;
            line.to_owned()
        }
    };
    text.lines().map(line).collect()
}

/// What may stand at a place of an input: whether something must, of which types, which words, and what stands for nothing.
#[derive(Default)]
struct Place {
    required: bool,
    values: BTreeSet<String>,
    default: String,
}

/// Every place of an input by its path, however the types that read it are called: `*` stands for a name of the user's, `[]` for
/// an entry of a list, `(coulomb)` for the choice of that name.
fn places(root: &Value) -> BTreeMap<String, Place> {
    let mut found = BTreeMap::new();
    collect(root, root, "", &mut Vec::new(), &mut found);
    found
}

fn collect<'a>(
    root: &'a Value,
    schema: &'a Value,
    path: &str,
    open: &mut Vec<&'a str>,
    found: &mut BTreeMap<String, Place>,
) {
    if let Some(name) = schema["$ref"].as_str().filter(|name| !open.contains(name)) {
        open.push(name);
        let definition = root.pointer(name.trim_start_matches('#')).unwrap_or_else(|| panic!("no {name}"));
        collect(root, definition, path, open, found);
        open.pop();
    }
    let choices = ["allOf", "anyOf", "oneOf"].iter().filter_map(|key| schema[key].as_array()).flatten();
    for choice in choices {
        collect(root, choice, path, open, found);
    }
    let words = schema["enum"].as_array().into_iter().flatten().chain(schema.get("const"));
    let types = schema["type"].as_array().into_iter().flatten().chain(schema.get("type"));
    let types =
        types.filter_map(Value::as_str).filter(|_| schema.get("const").is_none() && schema.get("enum").is_none());
    let values = words.map(Value::to_string).chain(types.map(String::from));
    found.entry(path.to_owned()).or_default().values.extend(values);

    let properties = || schema["properties"].as_object().into_iter().flatten();
    let tag = properties().find_map(|(_, property)| property["const"].as_str());
    let path = tag.map_or_else(|| path.to_owned(), |tag| format!("{path}({tag})"));
    let required = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect::<Vec<_>>();
    for (key, property) in properties() {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        let place = found.entry(path.clone()).or_default();
        place.required |= required.contains(&key.as_str());
        let default = property.get("default").filter(|default| !default.is_null());
        place.default = default.map_or(String::new(), |default| format!(" = {default}"));
        collect(root, property, &path, open, found);
    }
    if schema["additionalProperties"].is_object() {
        collect(root, &schema["additionalProperties"], &format!("{path}.*"), open, found);
    }
    let entries = schema["prefixItems"].as_array().into_iter().flatten().chain(schema.get("items"));
    for entry in entries.filter(|entry| entry.is_object()) {
        collect(root, entry, &format!("{path}[]"), open, found);
    }
}

#[test]
fn keys_of_the_inputs() {
    for of in ["case", "law"] {
        let schema: Value = serde_json::from_str(&printed(&["schema", of])).unwrap();
        let mut text = String::new();
        for (path, Place { required, values, default }) in places(&schema).iter().filter(|(path, _)| !path.is_empty()) {
            let values: Vec<&str> = values.iter().map(String::as_str).collect();
            let line = format!("{path} {}{}{default}", if *required { "required " } else { "" }, values.join(" | "));
            writeln!(text, "{}", line.trim_end()).unwrap();
        }
        compare(&format!("schema_{of}.txt"), &text);
    }
}

#[test]
fn commands_and_their_options() {
    let help = printed(&["--help"]);
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let commands: Vec<&str> = commands.filter_map(|line| line.split_whitespace().next()).collect();
    assert!(commands.contains(&"run"), "{help}");
    let mut text = String::new();
    for command in commands.into_iter().filter(|command| *command != "help") {
        writeln!(text, "{command}").unwrap();
        let help = printed(&[command, "--help"]);
        let message = help.lines().map(str::trim_start).filter(|line| line.starts_with(['<', '[', '-']));
        for line in message {
            // What it is for stands behind two spaces, behind a colon for a word of a choice.
            let end = if line.starts_with("- ") { ":" } else { "  " };
            writeln!(text, "  {}", line.split(end).next().unwrap_or_default()).unwrap();
        }
    }
    compare("commands.txt", &text);
}

/// A block of two elements over each other on a ground of one, pressed and dragged.
fn block_on_ground() -> Value {
    let body = |density: f64| json!({"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3, "density": density}});
    json!({
        "units": {"length": "mm", "force": "N", "time": "s"},
        "mesh": {
            "nodes": [[0, 0], [2, 0], [2, 1], [0, 1], [0.5, 1], [1.5, 1], [1.5, 1.5], [0.5, 1.5], [1.5, 2], [0.5, 2]],
            "elements": {"ground": [[0, 1, 2, 3]], "block": [[4, 5, 6, 7], [7, 6, 8, 9]]},
            "edges": {"bottom": [[0, 1]], "ground_top": [[2, 3]], "block_bottom": [[4, 5]], "block_top": [[8, 9]]}
        },
        "bodies": {"block": body(1e-9), "ground": body(1e-9)},
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "friction": {"law": "coulomb", "mu": 0.3}}},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.5, "max": 0.5, "min": 1e-4},
             "supports": [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.02}]},
            {"name": "drag", "duration": 1, "supports": [{"on": "block_top", "ux": {"rate": 0.02}}]}
        ],
        "watch": ["block_top"],
        "probes": {"gauge": {"at": [1, 1.7]}},
        "output": {"fronts": {"slip_rate": 1e-6}, "points": true, "checkpoint": 1e-9}
    })
}

/// Cases that have all that results can show, between them, under their names.
fn cases() -> Vec<(&'static str, Value)> {
    let plain = block_on_ground();
    let mut ring = plain.clone();
    ring["section"] = json!("axisymmetric");
    ring["bodies"]["block"]["material"] =
        json!({"model": "viscoelastic", "E": 1000, "nu": 0.3, "E_1": 500, "tau": 1, "density": 1e-9});
    ring["bodies"]["ground"]["material"] =
        json!({"model": "von_mises", "E": 1000, "nu": 0.3, "sigma_y": 1, "back_stresses": [{"C": 100, "gamma": 20}]});
    let mut wet = plain.clone();
    let contact = &mut wet["contacts"]["base"];
    contact["friction"] = json!({"law": "rate_and_state", "f_0": 0.6, "V_0": 1e-6, "a": 0.01, "b": 0.015, "D_c": 1e-3});
    contact["fluid_pressure"] = json!(0.1);
    contact["dilatancy"] = json!({"rate": 0.05});
    contact["wear"] = json!(1e-6);
    contact["radiation_damping"] = json!(0.1);
    let mass = json!({
        "mesh": {"nodes": [[0, 0]], "points": {"block": [0]}},
        "point_masses": {"block": {"mass": 10}},
        "contacts": {"base": {
            "slave": "block", "area": 1, "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 1000}, "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 1000}}},
        "steps": [{"name": "rest", "duration": 1, "scheme": {"newmark": {}}, "dt": {"initial": 0.5},
            "loads": [{"on": "block", "force": {"y": -98.1}}]}],
        "watch": ["block"]
    });
    let rod = json!({"points": [[0, 0], [2, 0]], "ea": 100, "ei": 1, "limit": 50, "start": {"on": "left"}, "end": {"on": "right"}});
    let bars = json!({
        "mesh": {"nodes": [[0, 0], [2, 0]], "points": {"left": [0], "right": [1]}}, "bars": {"rod": rod},
        "steps": [{"name": "pull", "duration": 1, "dt": {"initial": 0.5},
            "supports": [{"on": "left", "ux": 0, "uy": 0}, {"on": "right", "ux": 0.1, "uy": 0}]}],
    });
    vec![("plain", plain), ("ring", ring), ("wet", wet), ("mass", mass), ("bars", bars)]
}

/// A test of every friction law that a case may name.
fn laws() -> Vec<(&'static str, Value)> {
    let test = |mut friction: Value| {
        friction["alpha_t"] = json!(1000);
        let path = json!([{"duration": 1, "dt": 0.5, "slip": {"rate": 0.01}}]);
        json!({"friction": friction, "initial": {"pressure": 1}, "path": path})
    };
    vec![
        ("coulomb", test(json!({"law": "coulomb", "mu": 0.3}))),
        (
            "rate_and_state",
            test(json!({"law": "rate_and_state", "f_0": 0.6, "V_0": 1e-6, "a": 0.01, "b": 0.015, "D_c": 1e-3})),
        ),
        ("slip_weakening", test(json!({"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.5, "D_c": 0.1}))),
        (
            "super_subloading",
            test(json!({"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "r": 100, "kappa": 10, "xi": 0.002})),
        ),
    ]
}

/// What is in a folder of results: of each file its columns, arrays or keys.
fn content(folder: &Path) -> String {
    let mut text = String::new();
    let mut paths: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    for path in paths {
        let name = path.file_name().unwrap().to_str().unwrap();
        let inside = match path.extension().and_then(|ending| ending.to_str()) {
            Some("csv") => first_line(&path).split(',').map(String::from).collect(),
            Some("zarr") => stored(&path),
            Some("json") => keys(&path),
            None if path.is_dir() => arrays(&path),
            _ => Vec::new(),
        };
        writeln!(text, "{name}").unwrap();
        inside.iter().for_each(|line| writeln!(text, "  {line}").unwrap());
    }
    text
}

fn first_line(path: &Path) -> String {
    fs::read_to_string(path).unwrap().lines().next().unwrap_or_default().to_owned()
}

/// Arrays of a store with their dimensions.
fn stored(store: &Path) -> Vec<String> {
    let all: Value = serde_json::from_str(&fs::read_to_string(store.join(".zmetadata")).unwrap()).unwrap();
    let all = all["metadata"].as_object().unwrap();
    let dimensions = |name: &str| {
        let list = all[&format!("{name}/.zattrs")]["_ARRAY_DIMENSIONS"].as_array().unwrap();
        list.iter().map(|one| one.as_str().unwrap()).collect::<Vec<_>>().join(", ")
    };
    let names = all.keys().filter_map(|key| key.strip_suffix("/.zarray"));
    names.map(|name| format!("{name} ({})", dimensions(name))).collect()
}

/// Keys of `summary.json` and of what stands there under a fixed name.
fn keys(path: &Path) -> Vec<String> {
    let summary: Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    let inner = ["wall_s", "energy", "peak"];
    let of = |(key, value): (&String, &Value)| match value.as_object().filter(|_| inner.contains(&key.as_str())) {
        Some(object) => object.keys().map(|below| format!("{key}.{below}")).collect(),
        None => vec![key.clone()],
    };
    summary.as_object().unwrap().iter().flat_map(of).collect()
}

/// Arrays of the last frame in a folder, with their numbers of components, as they stand in its XML.
fn arrays(folder: &Path) -> Vec<String> {
    let mut frames: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    frames.sort();
    let text = String::from_utf8_lossy(&fs::read(frames.last().unwrap()).unwrap()).into_owned();
    let mut found = Vec::new();
    for (kind, at) in [("PointData", "point"), ("CellData", "cell")] {
        let Some((_, after)) = text.split_once(&format!("<{kind}")) else { continue };
        let inside = after.split(&format!("</{kind}>")).next().unwrap_or_default();
        for array in inside.split("<DataArray").skip(1) {
            let of = |key: &str| array.split_once(&format!("{key}=\"")).and_then(|(_, rest)| rest.split('"').next());
            found.push(format!("{at} {} {}", of("Name").unwrap(), of("NumberOfComponents").unwrap_or("1")));
        }
    }
    found
}

#[test]
fn columns_and_arrays_of_results() {
    let folder = TempDir::new().unwrap();
    let mut text = String::new();
    let inputs = cases().into_iter().map(|one| ("run", one)).chain(laws().into_iter().map(|one| ("law", one)));
    for (command, (name, input)) in inputs {
        let file = folder.path().join(format!("{name}.json"));
        fs::write(&file, input.to_string()).unwrap();
        let out = folder.path().join(name);
        printed(&[command, file.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        for line in content(&out).lines() {
            let inner = line.starts_with("  ");
            writeln!(text, "{}", if inner { line.into() } else { format!("{command} {name}: {line}") }).unwrap();
        }
    }
    compare("results.txt", &text);
}
