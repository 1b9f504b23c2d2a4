//! Contacts, their fluids and the tractions at their start.

use super::*;

#[test]
fn contacts_are_checked() {
    let friction = |key: &str| format!("/contacts/base/friction/{key}");
    for (key, value, allowed) in [
        ("mu_s", 0.1, "not less than \"mu_k\", which is 0.2"),
        ("mu_k", 0.0, "must be positive"),
        ("alpha_t", 0.0, "must be positive"),
        ("alpha_t", -1e5, "must be positive"),
        ("structure", 2.5, "must lie between 1 and mu_s/mu_k = 2"),
        ("structure", 0.5, "must lie between 1 and mu_s/mu_k = 2"),
        ("r", 0.0, "must be positive"),
        ("kappa", -1.0, "zero or positive"),
        ("elastic_core", 1.0, "less than 1"),
    ] {
        refused_edits(&[(&friction(key), json!(value))], &["contacts.base.friction: ", key, allowed]);
    }
    for (value, allowed) in [(0.0, "must be positive"), (-1.0, "must be positive"), (1e300, "choose other units")] {
        let edits = [("/contacts/base/normal/alpha_n", json!(value))];
        refused_edits(&edits, &["contacts.base.normal", "alpha_n", allowed]);
    }
    refused_edits(&[(&friction("alpha_t"), json!(1e300))], &["contacts.base.friction: ", "alpha_t is 1.000000e300"]);
    refused_edits(&[("/contacts/base/points", json!(7))], &["contacts.base.points: ", "is 7: must be 2, 3 or 4"]);
    for normal in [json!([0, 0]), json!([1e-300, 0])] {
        let plane = json!({"plane": {"point": [0, 0], "normal": normal}});
        refused_edits(&[("/contacts/base/master", plane)], &["contacts.base.master.plane.normal: ", "a direction"]);
    }
    refused_edits(
        &[("/contacts/base/slave", json!("block_botom"))],
        &["contacts.base.slave: ", "no group `block_botom` (did you mean `block_bottom`?); it has `block`, `block_"],
    );
    refused_edits(&[("/contacts/base/slave", json!("block"))], &["contacts.base.slave: ", "not of edges"]);
    refused_edits(
        &[("/mesh/edges/part", json!([[6, 7]])), ("/contacts/base/master", json!("part"))],
        &[
            "contacts.base: ",
            "the edge between nodes 6 and 7 is both slave (`block_bottom`) and master",
            "for contact of a surface with itself name the same group of edges twice",
        ],
    );
}

/// 0.2 − 0.5 t is negative after t = 0.4, of which the hundredth parts of the step see 0.41 first; a step that may end before is not asked.
#[test]
fn fluids_that_would_pull_are_found_before_the_run() {
    let fluid = |pressure: Value| ("/contacts/base/fluid_pressure", pressure);
    for (pressure, message) in [
        (json!("0.2 - 0.5*t"), "t = 0.41: must be a finite number, zero or positive"),
        (json!("1 + 0*sqrt(0.5 - t)"), "is NaN at ("),
        (json!("erfc(x)*(t - 0.7)*(t - 0.9)"), "t = 0.71: "),
        (json!({"x": [[0.8, -1], [0.9, 1]]}), "and t = 0: "),
    ] {
        refused_edits(&[fluid(pressure)], &["contacts.base.fluid_pressure: ", message]);
    }
    outcome("check", &[fluid(json!("0.5*t"))]);
    let until = json!({"on": "block_top", "fy": -0.001});
    outcome("check", &[fluid(json!("0.2 - 0.5*t")), ("/steps/0/until", until)]);
}

/// A run that stops beside an absurd number says so in a few digits, on stderr and in the summary.
#[test]
fn no_number_has_hundreds_of_digits() {
    let folder = TempDir::new().expect("a folder");
    let until = json!({"on": "block_top", "fy": -1e300});
    write(folder.path(), "case.json", with(&[("/steps/0/until", until)]).to_string());
    let output = fecontact(folder.path(), &["run", "case.json"]);
    let summary = fs::read_to_string(folder.path().join("out/case/summary.json")).expect("a summary");
    let summary: Value = serde_json::from_str(&summary).expect("JSON");
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    for said in [stderr(&output), summary["reason"].to_string()] {
        assert!(said.contains("reached -1e300: it is ") && !said.contains("00000000"), "{said}");
    }
}

/// Standard output of `check` of the good case with edits.
fn checked(edits: &[(&str, Value)]) -> String {
    let folder = TempDir::new().expect("a folder");
    write(folder.path(), "case.json", with(edits).to_string());
    let output = fecontact(folder.path(), &["check", "case.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    String::from_utf8(output.stdout).expect("text")
}

/// Edges of the block's bottom begin at x = 0.5, 1.5, 2.5: a pressure at x = 1.5 alone is an isolated one.
#[test]
fn a_fluid_that_starts_at_one_point_is_reported_and_round_off_is_no_suction() {
    let initial = ("/contacts/base/initial", json!({"pressure": 1.0}));
    let nodal = ("/contacts/base/method", json!("node_to_segment"));
    let at_start =
        |text: &str| checked(&[initial.clone(), nodal.clone(), ("/contacts/base/fluid_pressure", json!(text))]);
    let message = "its fluid_pressure is 0.1 at (1.5, 0) at t = 0 and none next to it";
    let diffusing = at_start("0.1*erfc(abs(x - 1.5)/(2*sqrt(0.1*t + 1e-12)))");
    assert!(diffusing.contains(message), "{diffusing}");
    for right in [
        "0.1*erfc((abs(x - 1.5) + 1e-9)/(2*sqrt(0.1*t + 1e-30)))", // begins with 0
        "0.1*erfc(abs(x - 1.5)/(2*sqrt(0.1*t + 0.1)))",            // begins everywhere
        "0.1*(1 + t)*max(0, 1 - abs(x - 1.5))",                    // stays there
        "0.1*t*erfc(x) - 1e-306",
        "-1e-306",
    ] {
        let text = at_start(right);
        assert!(!text.contains("none next to it"), "{right}: {text}");
    }
    refused_edits(
        &[("/contacts/base/fluid_pressure", json!("-1e-3"))],
        &["fluid_pressure: is -0.001 at (", "zero or positive"],
    );
    refused_edits(&[("/contacts/base/fluid_pressure", json!("-1e300"))], &["fluid_pressure: is -1e300 at ("]);
}

#[test]
fn numbers_that_cannot_be_squared_are_refused_with_their_place() {
    for far in [1e200, 1.797e308] {
        refused_edits(
            &[("/contacts/base/master", json!({"polyline": {"points": [[far, 0.8], [2.4, 0.0], [2.1, 0.8]]}}))],
            &["contacts.base.master.polyline.points: is 1", "places must lie between -1e100 and 1e100"],
        );
        refused_edits(
            &[("/contacts/base/master", json!({"circle": {"centre": [0, far], "radius": 1}}))],
            &["contacts.base.master.circle.centre: is 1"],
        );
        refused_edits(
            &[("/contacts/base/master", json!({"circle": {"centre": [0, 0], "radius": far}}))],
            &["contacts.base.master.circle.radius: is 1"],
        );
        refused_edits(
            &[("/contacts/base/master", json!({"plane": {"point": [0, far], "normal": [0, 1]}}))],
            &["contacts.base.master.plane.point: is 1"],
        );
        refused_edits(&[("/mesh/nodes/0/1", json!(far))], &["mesh: node 0 has the coordinate 1", "choose other units"]);
    }
    // Less than the smallest length that is positive when squared
    refused_edits(
        &[("/contacts/base/master", json!({"polyline": {"points": [[0, 0], [1e-200, 0], [4, 0]]}}))],
        &["contacts.base.master.polyline.points: points 0 and 1 are the same"],
    );
    refused_edits(&[("/bodies/block/material/nu", json!(-1e300))], &["is -1e300, but"]);
}

#[test]
fn a_static_step_cannot_start_above_the_strength_of_any_law() {
    let laws = [
        (json!({"law": "coulomb", "mu": 0.6}), "0.6"),
        (json!({"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.5, "D_c": 0.1}), "0.6"),
        (json!({"law": "slip_weakening", "mu_s": 0.5, "mu_d": 0.4, "D_c": 0.1, "cohesion": 0.1}), "0.6"),
        (json!({"law": "adhesion", "strength": 0.6}), "0.6"),
    ];
    for (law, strength) in laws {
        let of = |traction: f64| {
            [
                ("/contacts/base/friction", law.clone()),
                ("/contacts/base/initial", json!({"pressure": 1.0, "traction": traction, "balanced": true})),
            ]
        };
        refused_edits(
            &of(0.601),
            &["contacts.base.initial.traction: is 0.601 at (", "exceeds the initial strength", strength],
        );
        checked(&of(0.599));
    }
}

/// The tip of a crack, whose node is on both sides: it neither opens nor slips. The crack is closed along y = 0 and pressed.
#[test]
fn a_crack_whose_sides_share_a_node_runs_with_every_method() {
    let block = |corners: Value, sides: Value| json!({"body": "b", "corners": corners, "elements": [2, 1], "kind": "Q4", "sides": sides});
    for method in ["node_to_segment", "gauss_to_segment", "mortar"] {
        for sliding in ["small", "finite"] {
            let case = json!({
                "mesh": {"separated": ["low", "up"], "blocks": [
                    block(json!([[0, -1], [1, -1], [1, 0], [0, 0]]), json!(["bottom", null, "low", null])),
                    block(json!([[1, -1], [2, -1], [2, 0], [1, 0]]), json!(["bottom", null, null, null])),
                    block(json!([[0, 0], [1, 0], [1, 1], [0, 1]]), json!(["up", null, "top", null])),
                    block(json!([[1, 0], [2, 0], [2, 1], [1, 1]]), json!([null, null, "top", null])),
                ]},
                "bodies": {"b": {"material": {"model": "linear", "E": 500, "nu": 0.3}}},
                "contacts": {"crack": {"slave": "up", "master": "low", "method": method, "sliding": sliding,
                    "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 1e4}, "normal": {"alpha_n": 4e4}}},
                "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.5}, "supports": [
                    {"on": "bottom", "ux": 0, "uy": 0}, {"on": "top", "ux": 0.001, "uy": -0.01}]}],
                "output": {"fields": false, "report": false}
            });
            let folder = TempDir::new().expect("a folder");
            write(folder.path(), "case.json", case.to_string());
            for command in ["check", "run"] {
                let output = fecontact(folder.path(), &[command, "case.json"]);
                assert_eq!(output.status.code(), Some(0), "{method}, {sliding}: {}", stderr(&output));
            }
        }
    }
}
