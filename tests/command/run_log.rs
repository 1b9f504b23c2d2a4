//! `run.log` in the folder of results: what a run printed.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};
use tempfile::TempDir;

fn fecontact(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fecontact_tested"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the program runs")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn case() -> Value {
    json!({
        "mesh": {"blocks": [{"body": "block", "corners": [[0, 0], [1, 0], [1, 1], [0, 1]], "elements": [2, 2], "sides": ["base", null, "top", null]}]},
        "bodies": {"block": {"material": {"model": "linear", "E": 1, "nu": 0.3}}},
        "steps": [{"name": "stretch", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "base", "ux": 0, "uy": 0}, {"on": "top", "uy": 0.01}]}],
        "output": {"fields": false}
    })
}

#[test]
fn what_a_run_prints_is_kept_in_its_folder() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("case.json"), case().to_string()).unwrap();
    let log = folder.path().join("out/case/run.log");
    let told = fecontact(folder.path(), &["run", "case.json"]);
    let kept = fs::read_to_string(&log).unwrap();
    let (head, rest) = kept.split_once('\n').unwrap();
    assert!(head.starts_with("fecontact log, version "), "{head}");
    assert_eq!(rest, stderr(&told));
    assert!(rest.contains("50 %") && rest.contains("10 increments"), "{rest}");
    // A quiet run keeps its last line as well, and begins the log anew.
    let told = fecontact(folder.path(), &["run", "case.json", "--quiet"]);
    let kept = fs::read_to_string(&log).unwrap();
    assert_eq!(kept.lines().skip(1).collect::<Vec<_>>(), stderr(&told).lines().collect::<Vec<_>>());
    // A run that is resumed continues it.
    let mut longer = case();
    longer["steps"].as_array_mut().unwrap().push(json!({"name": "further", "duration": 1, "dt": {"initial": 0.5}}));
    fs::write(folder.path().join("case.json"), longer.to_string()).unwrap();
    let told = fecontact(folder.path(), &["run", "case.json", "--resume"]);
    let continued = fs::read_to_string(&log).unwrap();
    assert_eq!(continued, format!("{kept}{}", stderr(&told)));
    assert!(continued.contains("resuming at t = 1"), "{continued}");
}

#[test]
fn an_error_is_the_last_line_of_the_log_and_a_file_of_a_user_is_left_alone() {
    let folder = TempDir::new().unwrap();
    let mut stopping = case();
    stopping["steps"][0]["supports"][1] = json!({"on": "top", "uy": -2});
    stopping["bodies"]["block"]["material"] = json!({"model": "neo_hookean", "E": 1, "nu": 0.3});
    fs::write(folder.path().join("case.json"), stopping.to_string()).unwrap();
    let told = fecontact(folder.path(), &["run", "case.json", "--quiet"]);
    assert_eq!(told.status.code(), Some(1), "{}", stderr(&told));
    let kept = fs::read_to_string(folder.path().join("out/case/run.log")).unwrap();
    assert_eq!(kept.lines().last(), stderr(&told).lines().last());
    let mine = folder.path().join("out/case/run.log");
    fs::write(&mine, "my own notes").unwrap();
    let told = fecontact(folder.path(), &["run", "case.json", "--quiet"]);
    assert!(stderr(&told).contains("run.log: is not a log of this program"), "{}", stderr(&told));
    assert_eq!(fs::read_to_string(&mine).unwrap(), "my own notes");
}
