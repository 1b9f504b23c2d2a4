//! Cases to begin with, and completions.

use std::process::{Command, Output};

use tempfile::TempDir;

use crate::common;

fn fecontact(folder: &TempDir, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fecontact_tested")).args(arguments).current_dir(folder.path()).output().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Each is written under its name, but not over a file, and runs to its end without a warning.
#[test]
fn a_case_to_begin_with_runs() {
    let folder = TempDir::new().unwrap();
    for kind in ["tribology", "fault", "wall"] {
        let file = format!("{kind}.json");
        let written = fecontact(&folder, &["init", kind]);
        assert!(
            written.status.success() && stderr(&written).contains(&format!("run it: fecontact run {file}")),
            "{}",
            stderr(&written)
        );
        let committed = common::repository(format!("cases/templates/{file}"));
        assert_eq!(std::fs::read(folder.path().join(&file)).unwrap(), std::fs::read(committed).unwrap());
        let again = fecontact(&folder, &["init", kind]);
        assert_eq!(again.status.code(), Some(2));
        assert!(stderr(&again).contains(&format!("{file}: exists already")), "{}", stderr(&again));
        let run = fecontact(&folder, &["run", &file, "-q"]);
        assert!(run.status.success(), "{kind}: {}", stderr(&run));
        assert_eq!(stderr(&run).lines().count(), 1, "{kind}: {}", stderr(&run));
    }
    // The fault breaks twice, under its header.
    let events = std::fs::read_to_string(folder.path().join("out/fault/events.csv")).unwrap();
    assert_eq!(events.lines().count(), 3, "{events}");
    let elsewhere = fecontact(&folder, &["init", "wall", "nowhere/wall.json"]);
    assert_eq!(elsewhere.status.code(), Some(2));
    assert!(stderr(&elsewhere).contains("nowhere/wall.json: cannot be written"), "{}", stderr(&elsewhere));
}

/// Completions know the commands and their options.
#[test]
fn completions_know_the_commands() {
    let folder = TempDir::new().unwrap();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = fecontact(&folder, &["completions", shell]);
        let script = String::from_utf8(script.stdout).unwrap();
        for word in ["converge", "completions", "resolved", "measure"] {
            assert!(script.contains(word), "{shell}: no {word}");
        }
    }
}
