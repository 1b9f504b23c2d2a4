//! Runs that cannot go on.

use super::*;

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
pub fn history_rows(results: &Path) -> usize {
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

/// Where no equilibrium is found, the reason says where, and what is out of proportion there.
#[test]
fn what_does_not_converge_names_a_suspect() {
    let stopped = |edits: &[(&str, Value)], fragments: &[&str]| {
        let folder = TempDir::new().unwrap();
        write(folder.path(), "bad.json", with(edits).to_string());
        let output = fecontact(folder.path(), &["run", "bad.json", "--quiet"]);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{said}");
        for fragment in fragments {
            assert!(said.contains(fragment), "`{fragment}` is not in: {said}");
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
