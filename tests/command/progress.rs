//! What a run tells while it goes on: on a terminal one line that is kept up to date, elsewhere plain lines.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::survive::dragged;

const PROGRAM: &str = env!("CARGO_BIN_EXE_fecontact_tested");

/// A run that is told of by its penetration: the penalty is soft.
fn soft(increments: usize) -> (TempDir, Value) {
    let folder = TempDir::new().expect("a folder");
    let mut case = dragged(json!("static"), increments);
    case["contacts"]["base"]["normal"] = json!({"alpha_n": 200});
    case["output"] = json!({"fields": false});
    std::fs::write(folder.path().join("case.json"), case.to_string()).expect("a file");
    (folder, case)
}

/// What a command writes to a terminal of this kind with 100 columns.
fn on_terminal(folder: &Path, kind: &str, arguments: &str) -> String {
    let command = format!("stty cols 100 rows 30; {PROGRAM} {arguments}");
    let mut script = Command::new("script");
    script.args(["-qec", &command, "/dev/null"]).current_dir(folder).env("TERM", kind);
    let output: Output = script.output().expect("script");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}");
    text
}

#[cfg(unix)]
#[test]
fn a_terminal_shows_one_line_that_is_kept_up_to_date() {
    // Long enough for the time that is left to be told on a machine many times faster than today's.
    let (folder, _) = soft(10_000);
    let text = on_terminal(folder.path(), "xterm", "run case.json --threads 1 --out out");
    let drawn: Vec<&str> = text.split(['\r', '\n']).collect();
    let states: Vec<&&str> = drawn.iter().filter(|line| line.contains(" %") && line.contains(" dt ")).collect();
    assert!(states.len() > 5, "{text}");
    let late = states.iter().rfind(|line| line.contains("drag t ")).expect("a line of the last step");
    for part in [" %, 0:00:", " left  drag t ", " dt ", " iter  open ", " stick ", " slip "] {
        assert!(late.contains(part), "{part} is not in {late}");
    }
    // The time is told so that an increment shows.
    let time = late.split(" t ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a time");
    assert!(time.parse::<f64>().is_ok_and(|time| (1.0..=5.0).contains(&time)), "{late}");
    // The warning comes while the run goes on, once; the line is gone at the end.
    assert_eq!(text.matches("warning: ").count(), text.matches("warning: contact `base`").count(), "{text}");
    assert_eq!(text.matches("% of the slave's edge").count(), 1, "{text}");
    let warned = text.find("% of the slave's edge").expect("a warning");
    assert!(warned < text.rfind(" dt ").expect("a state"), "{text}");
    let last: Vec<&str> = text.trim_end().lines().rev().take(3).collect();
    let [penalties, contact, end] = last[..] else { panic!("{text}") };
    assert!(end.ends_with("results in out") && contact.starts_with("contact `base`: "), "{text}");
    assert!(penalties.starts_with("contact penalties: "), "{text}");
}

/// A terminal on which nothing can be written over has lines.
#[cfg(unix)]
#[test]
fn a_dumb_terminal_shows_lines() {
    let (folder, _) = soft(20);
    let text = on_terminal(folder.path(), "dumb", "run case.json --threads 1 --out out");
    for line in [" 20 %  press  t 1  dt 2.500e-1  ", "% of the slave's edge", "100 %  drag  t 5  "] {
        assert_eq!(text.matches(line).count(), 1, "{text}");
    }
}

/// Without a terminal there is a line every tenth of the run; with `--quiet` there are the warnings, and the line of the end.
#[test]
fn a_line_every_tenth_elsewhere_and_only_warnings_where_it_is_quiet() {
    let (folder, _) = soft(20);
    let run = |more: &[&str]| {
        let output = Command::new(PROGRAM).args(["run", "case.json"]).args(more).current_dir(folder.path()).output();
        let output = output.expect("the program runs");
        assert!(output.status.success());
        String::from_utf8(output.stderr).expect("text")
    };
    let message = run(&["--out", "out"]);
    // The first increment at or after every half of a unit of time: they are 0.25 up to t = 1, and 0.2 up to t = 5.
    let shares: Vec<&str> =
        message.lines().filter_map(|line| line.trim_start().split_once(" %  ")).map(|(n, _)| n).collect();
    assert_eq!(shares, ["10", "20", "32", "40", "52", "60", "72", "80", "92", "100"], "{message}");
    assert_eq!(message.matches("% of the slave's edge").count(), 1, "{message}");
    let [warned, last] = ["% of the slave's edge", "drag  t 5  "].map(|what| message.find(what).expect(what));
    assert!(warned < last, "{message}");
    let quiet = run(&["--out", "quiet", "--quiet"]);
    let (warnings, end): (Vec<&str>, Vec<&str>) = quiet.lines().partition(|line| line.starts_with("warning: "));
    assert_eq!(warnings.iter().filter(|line| line.contains("% of the slave's edge")).count(), 1, "{quiet}");
    assert!(end.len() == 1 && end[0].ends_with("results in quiet"), "{quiet}");
    let summary = std::fs::read_to_string(folder.path().join("quiet/summary.json")).expect("a summary");
    assert!(summary.contains("% of the slave's edge"), "{summary}");
}
