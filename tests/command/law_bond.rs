//! `fecontact law`: a bond beside friction along paths of opening, slip and pressure, against the closed forms of `tests/laws/bond.rs`.

use std::fs;
use std::process::Command;

use crate::common::{Columns, close, table};
use serde_json::{Value, json};
use tempfile::TempDir;

/// The columns of a test, or what it is refused with.
fn law(test: &Value) -> Result<Columns, String> {
    let folder = TempDir::new().expect("a temporary folder");
    fs::write(folder.path().join("test.json"), test.to_string()).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_fecontact_tested"));
    let output = command.current_dir(folder.path()).args(["law", "test.json"]).output().expect("the program starts");
    if output.status.code() != Some(0) {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    Ok(table(folder.path().join("out/test/law.csv")))
}

fn test(bond: &Value, path: &[Value]) -> Value {
    json!({
        "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 1e6}, "normal": {"alpha_n": 1e6}, "initial": {"pressure": 0},
        "bond": bond, "path": path
    })
}

/// The value of a column at the end of every phase of duration 1.
fn at_ends(columns: &Columns, name: &str) -> Vec<f64> {
    let ends = columns["time"].iter().zip(&columns[name]).filter(|(time, _)| time.fract() == 0.0 && **time > 0.0);
    ends.map(|(_, value)| *value).collect()
}

fn slide(by: f64) -> Value {
    json!({"duration": 1, "slip": {"rate": by}})
}

fn open(to: f64) -> Value {
    json!({"duration": 1, "opening": to})
}

#[test]
fn shear_fades_over_the_opening_of_the_path() {
    let path = [slide(10.0), open(5.0), slide(10.0), open(20.0), slide(10.0), open(0.0), slide(10.0)];
    let found = law(&test(&json!({"strength": 10, "opening": 10}), &path)).expect("it runs");
    for (found, expected) in at_ends(&found, "traction").into_iter().zip([10.0, 5.0, 5.0, 0.0, 0.0, 0.0, 10.0]) {
        close("q", found, expected, 1e-9);
    }
    let path = [slide(0.1), open(0.5), slide(1.0), open(0.0), slide(1.0), open(2.0), slide(1.0), open(0.0), slide(1.0)];
    let bond = json!({"strength": 10, "residual": 4, "slip": 20, "opening": 1});
    let found = law(&test(&bond, &path)).expect("it runs");
    let traction = at_ends(&found, "traction");
    for (k, expected) in [(0, 9.97), (2, 4.67), (4, 6.37), (6, 0.0), (8, 4.0)] {
        close("q", traction[k], expected, 1e-4);
    }
    let left = at_ends(&found, "bond");
    for (k, expected) in [(0, 1.0 - 0.1 / 20.0), (2, 0.5 - 1.1 / 20.0), (4, 0.5 - 2.1 / 20.0), (8, 0.0)] {
        close("1 − κ", left[k], expected, 1e-5);
    }
}

#[test]
fn the_work_of_fracture_depends_on_the_path() {
    let bond = json!({"strength": 10, "slip": 20, "tension": 3, "opening": 10});
    let work = |path: &[Value]| {
        let found = law(&test(&bond, path)).expect("it runs");
        let most = found["pressure"].iter().fold(0.0f64, |most, p| most.max(-p));
        (*found["dissipation"].last().expect("rows"), most)
    };
    let (pulled, most) = work(&[open(3e-6), open(12.0)]);
    close("pull-off", pulled, 15.0, 1e-3);
    close("peak", most, 3.0, 1e-9);
    close("shear", work(&[slide(30.0)]).0, 100.0, 0.01);
    close("open 5, then slip", work(&[open(5.0), slide(30.0), open(12.0)]).0, 34.0, 0.05);
    close("slip 10, then open", work(&[slide(10.0), open(12.0), slide(20.0)]).0, 78.75, 0.1);
    let both = json!({"duration": 1, "opening": 12, "slip": 30, "dt": 0.001});
    close("straight", work(&[both]).0, 10.3 / 0.18, 0.1);
}

#[test]
fn one_line_of_strength_and_its_limit() {
    let bond = json!({"strength": 10, "tension": 3, "opening": 10});
    let found = law(&test(&bond, &[open(2e-6), slide(1.0)])).expect("it runs");
    close("T", -at_ends(&found, "pressure")[1], 2.0, 1e-9);
    close("c − μ T", at_ends(&found, "traction")[1], 9.4, 1e-9);
    let pressed = json!({"duration": 1, "pressure": 50});
    let found = law(&test(&bond, &[pressed, slide(1.0)])).expect("it runs");
    close("c + μ p", at_ends(&found, "traction")[1], 25.0, 1e-9);
    for (p, expected) in [(0.0, 10.0), (10.0, 15.0), (20.0, 20.0), (30.0, 20.0), (100.0, 20.0)] {
        let mut test = test(&json!({"strength": 10, "opening": 10, "limit": 20}), &[slide(1.0)]);
        test["friction"]["mu"] = json!(0.5);
        test["initial"]["pressure"] = json!(p);
        close("min(c + μ p, τ_max)", at_ends(&law(&test).expect("it runs"), "traction")[0], expected, 1e-9);
    }
    // A traction at the start is shared.
    let mut shared = test(&json!({"strength": 6, "opening": 10}), &[slide(0.0)]);
    shared["initial"] = json!({"pressure": 20, "traction": 9});
    close("q", law(&shared).expect("it runs")["traction"][0], 9.0, 1e-12);
}

#[test]
fn what_a_bond_alone_cannot_be_is_refused() {
    let bond = json!({"strength": 10, "opening": 10});
    let good = test(&bond, &[slide(1.0)]);
    let with = |pointer: &str, value: Value| {
        let mut test = good.clone();
        match test.pointer_mut(pointer) {
            Some(place) => *place = value,
            None => test[pointer.trim_start_matches('/')] = value,
        }
        law(&test).expect_err("it is refused")
    };
    for (refused, words) in [
        (with("/bond/opening", Value::Null), "bond.opening: is missing"),
        (with("/bond/strength", Value::Null), "bond.strength: is missing"),
        (with("/friction", json!({"law": "adhesion", "strength": 1, "alpha_t": 1})), "bond.strength: is given by the friction law"),
        (with("/wear", json!(1e-3)), "bond: follows the opening given by the path"),
        (with("/initial", json!({"pressure": 0, "traction": 11})), "initial.traction: is 10 for the bond"),
        (with("/path/0", json!({"duration": 1, "opening": "1+t"})), "path[0].opening: jumps from 0 to 1"),
        (law(&json!({"friction": {"law": "frictionless"}, "initial": {"pressure": 1}, "bond": bond, "path": [slide(1.0)]})).expect_err("refused"), "normal.alpha_n: is missing"),
    ] {
        assert!(refused.contains(words), "{refused}");
    }
    let mut without = test(&bond, &[open(1.0)]);
    without.as_object_mut().expect("keys").remove("bond");
    let refused = law(&without).expect_err("it is refused");
    assert!(refused.contains("path[0].opening: belongs to a `bond`"), "{refused}");
}
