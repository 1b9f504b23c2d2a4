//! Derivatives of drawn models are central differences of their complete runs with the same increments.
//!
//! `GRADIENTS=300 cargo test --release --test crossings -- derivatives --nocapture` tries as many seeds (20 unless given).

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use rayon::prelude::*;
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::features::Draft;
use crate::model::{self, Ways, is_explicit};

/// ε/θ, that of the program: the error of truncation is the same.
const STEP: f64 = 1e-4;

/// Largest difference of a derivative of a force or displacement, relative to the largest in its column, or a tenth of Q/θ.
const SAME: f64 = 1e-5;

/// What came of a model.
enum Outcome {
    /// It has no derivatives, or none that differences have: at a kink, with other increments
    Idle(&'static str),
    Holds,
    Broken(String),
}

/// Columns of a table by name.
type Columns = BTreeMap<String, Vec<f64>>;

fn table(folder: &TempDir, file: &str) -> Columns {
    let text = fs::read_to_string(folder.path().join("out").join(file)).expect("a table");
    let names: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
    let column = |(k, name): (usize, &&str)| {
        let cells = text.lines().skip(1).map(|line| line.split(',').nth(k).and_then(|cell| cell.parse().ok()));
        ((*name).to_string(), cells.map(|cell| cell.unwrap_or(f64::NAN)).collect())
    };
    names.iter().enumerate().map(column).collect()
}

fn run(case: &Value) -> Option<TempDir> {
    let folder = TempDir::new().expect("a folder");
    fs::write(folder.path().join("case.json"), case.to_string()).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_fecontact_tested"));
    command.current_dir(folder.path()).args(["run", "case.json", "--quiet", "--threads", "1", "--out", "out"]);
    command.output().expect("the program runs").status.success().then_some(folder)
}

/// A place of the case with a number: one of the friction, or a stiffness.
fn place(case: &Value, seed: u64) -> Option<(String, f64)> {
    let friction = ["mu_k", "mu", "mu_d", "f_0", "mu_s"].map(|name| format!("/contacts/c/friction/{name}"));
    let stiffness = ["block", "ground"].map(|name| format!("/bodies/{name}/material/E"));
    let (first, others) =
        if seed.is_multiple_of(3) { (&stiffness[..], &friction[..]) } else { (&friction[..], &stiffness[..]) };
    let value = |at: &String| Some((at.clone(), case.pointer(at)?.as_f64().filter(|value| *value != 0.0)?));
    first.iter().chain(others).find_map(value)
}

/// Whether a column is one of forces or displacements.
fn is_main(column: &str) -> bool {
    let name = column.rsplit('.').next().unwrap_or_default();
    column.contains('.')
        && ["normal_force", "tangential_force", "force_x", "force_y", "fx", "fy", "ux", "uy", "mean_ux", "mean_uy"]
            .contains(&name)
}

fn checked(seed: u64) -> Outcome {
    let draft = Draft::new(seed);
    if is_explicit(&draft) {
        return Outcome::Idle("explicit");
    }
    let mut case = model::case(&draft, &Ways::plain(&draft));
    let Some((at, value)) = place(&case, seed) else { return Outcome::Idle("no place") };
    case["newton"]["tolerance"] = json!(1e-12);
    for (key, value) in [("fields", json!(false)), ("report", json!(false)), ("checkpoint", Value::Null)] {
        case["output"][key] = value;
    }
    let name = at[1..].replace('/', ".");
    let mut asked = case.clone();
    asked["gradients"] = json!([name]);
    let Some(own) = run(&asked) else { return Outcome::Idle("refused or stopped") };
    let with = |value: f64| {
        let mut other = case.clone();
        *other.pointer_mut(&at).expect("a place") = json!(value);
        run(&other)
    };
    let ends = [1.0 - STEP, 1.0 + STEP].map(|share| value * share);
    let [Some(low), Some(high)] = ends.map(with) else { return Outcome::Idle("a neighbour is refused or stopped") };
    let summary = fs::read_to_string(own.path().join("out/summary.json")).expect("a file");
    let account = &serde_json::from_str::<Value>(&summary).expect("JSON")["gradients"][&name];
    if account["one_sided"] != json!(0) || !account["lost_at"].is_null() {
        return Outcome::Idle("at a kink");
    }
    let [history, low, high] = [&own, &low, &high].map(|folder| table(folder, "history.csv"));
    if [&low, &high].iter().any(|other| other["time"] != history["time"]) {
        return Outcome::Idle("other increments");
    }
    let found = table(&own, "gradients.csv");
    for (column, values) in history.iter().filter(|(column, _)| is_main(column)) {
        let pairs = low[column].iter().zip(&high[column]);
        let expected: Vec<f64> = pairs.map(|(low, high)| (high - low) / (ends[1] - ends[0])).collect();
        let largest = |values: &[f64]| values.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        let scale = largest(&expected).max(0.1 * largest(values) / value.abs()).max(f64::MIN_POSITIVE);
        let derivative = format!("d({column})/d({name})");
        for (found, expected) in found[&derivative].iter().zip(&expected) {
            let share = (found - expected).abs() / scale;
            if share.is_nan() || share > SAME {
                return Outcome::Broken(format!(
                    "{seed}: {derivative} {found:e} for {expected:e}, {share:.1e} of {scale:e}; {}",
                    draft.told()
                ));
            }
        }
    }
    Outcome::Holds
}

#[test]
fn derivatives_are_those_of_differences() {
    let count = std::env::var("GRADIENTS").map_or(20, |text| text.parse().expect("a number"));
    let outcomes: Vec<Outcome> = (0..count).into_par_iter().map(checked).collect();
    let mut idle: BTreeMap<&str, usize> = BTreeMap::new();
    let (mut held, mut broken) = (0, Vec::new());
    for outcome in outcomes {
        match outcome {
            Outcome::Idle(why) => *idle.entry(why).or_default() += 1,
            Outcome::Holds => held += 1,
            Outcome::Broken(what) => broken.push(what),
        }
    }
    println!("{held} of {count} models hold; idle: {idle:?}");
    assert!(broken.is_empty(), "{}", broken.join("\n"));
    assert!(4 * held >= count as usize, "only {held} of {count} models are compared");
}
