//! Derivatives by any number of a model are central differences of its complete runs with the same increments.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::process::Command;

use serde_json::{Value, json};
use tempfile::TempDir;

use super::{Base, Outcome, hash, is_explicit};
use crate::model;
use crate::record::{Difference, Ended};

/// ε/θ, that of the program: the error of truncation is the same.
const STEP: f64 = 1e-4;

/// Largest difference of a derivative of a force or displacement, relative to the largest in its column, or a tenth of Q/θ.
const SAME: f64 = 1e-5;

/// The same where water flows along a contact: a complete run chooses the length of its steps anew.
const SAME_BY_FLOW: f64 = 1e-3;

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

/// Where the increments of a run ended, and after how many passes; its rows may be fewer.
fn increments(folder: &TempDir) -> BTreeMap<u64, [f64; 2]> {
    let newton = table(folder, "newton.csv");
    let ends = newton["time"].iter().zip(&newton["pass"]).map(|(&time, &pass)| [time, pass]);
    newton["increment"].iter().map(|number| number.to_bits()).zip(ends).collect()
}

fn run(case: &Value) -> Option<TempDir> {
    let folder = TempDir::new().expect("a folder");
    fs::write(folder.path().join("case.json"), case.to_string()).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_fecontact_tested"));
    command.current_dir(folder.path()).args(["run", "case.json", "--quiet", "--threads", "1", "--out", "out"]);
    command.output().expect("the program runs").status.success().then_some(folder)
}

/// Parts of a case whose numbers act on its run.
const PARTS: [&str; 8] =
    ["section", "bodies", "point_masses", "rigid_bodies", "bars", "contacts", "initial_velocity", "steps"];

/// Keys of numbers by which nothing is differentiated: of increments, and numbers of things.
const NOT_VARIED: [&str; 10] =
    ["segments", "duration", "dt", "until", "points", "seed", "safety", "interval", "penetration", "stick"];

/// Every number of a part that is not 0, as pointers and with its key.
fn numbers(value: &Value, at: &str, key: &str, found: &mut Vec<(String, String, f64)>) {
    match value {
        _ if NOT_VARIED.contains(&key) => {}
        Value::Number(number) => {
            let number = number.as_f64().filter(|number| *number != 0.0);
            found.extend(number.map(|number| (at.to_owned(), key.to_owned(), number)));
        }
        Value::Object(object) => {
            object.iter().for_each(|(key, value)| numbers(value, &format!("{at}/{key}"), key, found))
        }
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(k, value)| numbers(value, &format!("{at}/{k}"), key, found));
        }
        _ => {}
    }
}

/// Any number of the case: first its key, of all that there are, then one of those that it has.
fn place(case: &Value, seed: u64) -> Option<(String, f64)> {
    let mut found = Vec::new();
    PARTS.iter().for_each(|part| numbers(&case[part], &format!("/{part}"), part, &mut found));
    let keys: BTreeSet<&String> = found.iter().map(|(_, key, _)| key).collect();
    let key = keys.iter().nth((hash(seed, "key") % keys.len().max(1) as u64) as usize)?;
    let own: Vec<_> = found.iter().filter(|(_, own, _)| own == *key).collect();
    let (at, _, value) = own.get((hash(seed, "number") % own.len() as u64) as usize)?;
    Some((at.clone(), *value))
}

/// Whether a column is one of forces or displacements.
fn is_main(column: &str) -> bool {
    let name = column.rsplit('.').next().unwrap_or_default();
    column.contains('.')
        && ["normal_force", "tangential_force", "force_x", "force_y", "fx", "fy", "ux", "uy", "mean_ux", "mean_uy"]
            .contains(&name)
}

/// Gives contacts with strength without pressure the opening over which it fades: by default it is chosen from the bodies, anew in every complete
/// run, where derivatives keep that of the run.
fn give_openings(case: &mut Value) {
    for contact in case["contacts"].as_object_mut().into_iter().flat_map(|contacts| contacts.values_mut()) {
        let friction = contact["friction"].to_string();
        let has_strength =
            contact["bond"].is_object() || friction.contains("adhesion") || friction.contains("cohesion");
        if has_strength && contact["bond"]["opening"].is_null() {
            contact["bond"]["opening"] = json!(5e-3);
        }
    }
}

pub(super) fn derivatives(base: &Base) -> Outcome {
    let draft = base.draft;
    if is_explicit(draft) || draft.is("scheme", "quasi_dynamic") || base.record.ended != Ended::Complete {
        return Outcome::Idle;
    }
    let mut case = model::case(draft, &base.ways);
    case["newton"]["tolerance"] = json!(1e-12);
    give_openings(&mut case);
    let Some((at, value)) = place(&case, draft.seed) else { return Outcome::Idle };
    let name = at[1..].replace('/', ".");
    let mut asked = case.clone();
    asked["gradients"] = json!([name]);
    // A place by which nothing can be differentiated is refused.
    let Some(own) = run(&asked) else { return Outcome::Idle };
    let summary = fs::read_to_string(own.path().join("out/summary.json")).expect("a file");
    let account = &serde_json::from_str::<Value>(&summary).expect("JSON")["gradients"][&name];
    if account["one_sided"] != json!(0) || !account["lost_at"].is_null() {
        return Outcome::Idle;
    }
    let (history, made) = (table(&own, "history.csv"), increments(&own));
    let found = table(&own, "gradients.csv");
    let beside = |share: f64| {
        let ends = [1.0 - share, 1.0 + share].map(|share| value * share);
        let with = |value: f64| {
            let mut other = case.clone();
            *other.pointer_mut(&at).expect("a place") = json!(value);
            run(&other).filter(|folder| increments(folder) == made).map(|folder| table(&folder, "history.csv"))
        };
        let [Some(low), Some(high)] = ends.map(with) else { return None };
        Some((low, high, ends[1] - ends[0]))
    };
    let Some(differences) = beside(STEP) else { return Outcome::Idle };
    let worst = worst(&history, &found, &differences, value, &name);
    let same = if draft.is("fluid", "flows") { SAME_BY_FLOW } else { SAME };
    if worst.share <= same {
        return Outcome::Holds;
    }
    // Of several equilibria the neighbours have reached another.
    if !surrounded(&history, &differences, value) {
        return Outcome::Idle;
    }
    // Where differences of half the length are others, the run has no derivative that they tell.
    let Some(halves) = beside(0.5 * STEP) else { return Outcome::Idle };
    let as_found = |column: &str| format!("d({column})/d({name})");
    let told = differences_of(&halves).into_iter().map(|(column, values)| (as_found(&column), values)).collect();
    let uncertain = self::worst(&history, &told, &differences, value, &name);
    if uncertain.share > 0.1 * worst.share { Outcome::Idle } else { Outcome::Broken(worst) }
}

/// Two neighbours and how far they are apart.
type Beside = (Columns, Columns, f64);

fn differences_of((low, high, apart): &Beside) -> Columns {
    let column = |(name, low): (&String, &Vec<f64>)| {
        let pairs = low.iter().zip(&high[name]);
        (name.clone(), pairs.map(|(low, high)| (high - low) / apart).collect())
    };
    low.iter().map(column).collect()
}

/// Whether values lie between those of their neighbours, but for a tenth of how far these are apart, or of the change of what is
/// proportional to θ.
fn surrounded(history: &Columns, (low, high, apart): &Beside, value: f64) -> bool {
    history.iter().filter(|(column, _)| is_main(column)).all(|(column, values)| {
        let change = |(low, high): (&f64, &f64)| (high - low).abs();
        let largest = low[column].iter().zip(&high[column]).map(change).fold(0.0, f64::max);
        let most = values.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        let allowed = 0.1 * largest.max(most * (apart / value).abs());
        let away = |((value, low), high): ((&f64, &f64), &f64)| (value - 0.5 * (low + high)).abs();
        values.iter().zip(&low[column]).zip(&high[column]).map(away).all(|away| away <= allowed)
    })
}

/// The largest value of columns of the same kind, forces or displacements.
fn largest_of_kind(columns: &Columns, column: &str) -> f64 {
    let is_place = |column: &str| column.ends_with("ux") || column.ends_with("uy");
    let alike = columns.iter().filter(|(other, _)| is_main(other) && is_place(other) == is_place(column));
    alike.flat_map(|(_, values)| values).fold(0.0, |most, value| most.max(value.abs()))
}

/// The derivative that is farthest from its difference.
fn worst(history: &Columns, found: &Columns, beside: &Beside, value: f64, name: &str) -> Difference {
    let largest = |values: &[f64]| values.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    let differences = differences_of(beside);
    let mut worst = Difference::default();
    for (column, values) in history.iter().filter(|(column, _)| is_main(column)) {
        let expected = &differences[column];
        // What nothing acts on has round-off of what acts elsewhere.
        let rounded = 1e-3 * largest_of_kind(history, column);
        let scale = largest(expected).max(0.1 * largest(values).max(rounded) / value.abs()).max(f64::MIN_POSITIVE);
        let derivative = format!("d({column})/d({name})");
        for (found, expected) in found[&derivative].iter().zip(expected) {
            let share = (found - expected).abs() / scale;
            let share = if share.is_nan() { f64::INFINITY } else { share };
            if share > worst.share {
                worst = Difference { share, place: derivative.clone(), values: [*found, *expected] };
            }
        }
    }
    worst
}
