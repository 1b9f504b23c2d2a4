//! What `check` says it has understood.

use super::*;

/// The default penalty is that of the softer side, whichever is the slave.
#[test]
fn default_penalty_is_that_of_the_softer_side() {
    let folder = TempDir::new().unwrap();
    let mut case = with(&[("/contacts/base/normal", json!({})), ("/bodies/ground/material/E", json!(100))]);
    case["contacts"]["base"]["friction"].as_object_mut().unwrap().remove("alpha_t");
    write(folder.path(), "case.json", case.to_string());
    let output = fecontact(folder.path(), &["check", "case.json"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("alpha_n 40384.6 "), "a tenth of 300 (λ + 2G)/h = 403846 is not in:\n{text}");
}

/// Parameters of a law with a peak are told in the numbers of a test, in a line: the peak from rest 25.0175/98.1 and its plastic slip
/// 0.040384 − 25.0175/1000 are those of `the_attained_peak_converges_to_25_0175`, the rest is ln 2 μ_k/κ and ln 2 μ_s/ξ.
#[test]
fn check_tells_what_the_numbers_of_a_law_mean() {
    let message = |changes: &[(&str, Value)]| {
        let [message, _] = outcome("check", changes);
        let lines: Vec<String> =
            message.lines().filter(|line| line.contains("q/p")).map(|line| line.trim().into()).collect();
        assert_eq!(lines.len(), 1, "{message}");
        lines.into_iter().next().unwrap()
    };
    let first = "rapid slip after a long hold: peak q/p 0.255 at a plastic slip of 0.0154";
    let falls = "residual q/p 0.2, half of the weakening from mu_s within 0.0139 of slip";
    assert_eq!(message(&[]), format!("{first}, {falls}; no healing"));
    let heals = [("/contacts/base/friction/xi", json!(0.02)), ("/contacts/base/friction/structure", json!(1))];
    assert_eq!(message(&heals), format!("{first} (0.2 at the start of the run), {falls}; half recovers in 13.9"));
    let along = ("/contacts/base/along", json!({"kappa": "5*x"}));
    let varies = message(&[along]);
    // Ranges of the peak, its slip and the slip of half of the fall.
    assert!(varies.matches(" to ").count() == 3 && varies.contains(", residual q/p 0.2, "), "{varies}");
    let coulomb = ("/contacts/base/friction", json!({"law": "coulomb", "mu": 0.3}));
    let [message, _] = outcome("check", &[coulomb]);
    assert!(!message.contains("q/p"), "{message}");
    for (every, words) in [(2, "every 2nd row"), (3, "every 3rd row"), (11, "every 11th row"), (21, "every 21st row")] {
        let [message, _] = outcome("check", &[("/output", json!({"every": every}))]);
        assert!(message.contains(words), "{message}");
    }
}

/// What the case leaves open follows from the surfaces, not from their round-off, and is told with the reason; a method that
/// is named stays, with a warning where pressures are known to suffer, in `check`, in the summary and on stderr.
#[test]
fn the_method_follows_from_the_surfaces() {
    let bent = |by: f64| ("/mesh/nodes/6/1", json!(-by));
    let mortar = "mortar, averaged around each node (chosen because the master is a mesh)";
    for by in [0.0, 1e-12, 1e-6, 0.05] {
        let [message, _] = outcome("check", &[bent(by)]);
        assert!(message.contains(mortar), "bent by {by}:\n{message}");
    }
    let plane = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
    let [_, message] = outcome("run", &[bent(0.05), ("/contacts/base/master", plane)]);
    assert!(message.contains("contact `base`: mortar, chosen because surfaces are curved"), "{message}");
    for method in ["node_to_segment", "gauss_to_segment"] {
        let named = [bent(0.05), ("/contacts/base/method", json!(method))];
        let concern = format!("contact `base`: {method} on curved or quadratic surfaces: pressures scatter");
        let [checked, _] = outcome("check", &named);
        let [_, run] = outcome("run", &named);
        assert!(checked.contains(&concern) && run.contains(&format!("warning: {concern}")), "{checked}\n{run}");
        let [checked, _] = outcome("check", &[named[1].clone()]);
        assert!(!checked.contains("curved"), "{checked}");
    }
    let [message, _] = outcome("check", &[bent(0.05), ("/contacts/base/smooth", json!(true))]);
    assert!(message.contains("gauss_to_segment") && message.contains("leave `smooth` out for mortar"), "{message}");
}

/// The block of three edges of length 1 on a ground of two of length 2, and the same moved until one point in three is past the
/// ground's end.
#[test]
fn check_tells_how_far_small_sliding_goes() {
    let small = ("/contacts/base/sliding", json!("small"));
    let line = "small sliding: every point keeps its initial projection, normal and length; valid for slips up to 0.1 \
                and rotations up to 0.02 rad";
    let [message, _] = outcome("check", std::slice::from_ref(&small));
    assert!(message.contains(line), "{message}");
    let plane = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
    let [message, _] = outcome("check", &[small.clone(), ("/contacts/base/master", plane)]);
    assert!(message.contains("length; valid for rotations up to 0.02 rad"), "{message}");
    let moved: Vec<Value> = good()["mesh"]["nodes"]
        .as_array()
        .expect("nodes")
        .iter()
        .enumerate()
        .map(|(k, node)| json!([node[0].as_f64().expect("x") + if k > 5 { 1.5 } else { 0.0 }, node[1]]))
        .collect();
    let [message, _] = outcome("check", &[small, ("/mesh/nodes", json!(moved.clone()))]);
    assert!(
        message
            .contains("of the slave without a projection on the master, and never come into contact in small sliding"),
        "{message}"
    );
    let [message, _] = outcome("check", &[("/mesh/nodes", json!(moved))]);
    // In finite sliding they do no harm: `check` counts them, and nothing is warned of.
    assert!(
        message.contains("point without a projection") || message.contains("points without a projection"),
        "{message}"
    );
    assert!(message.contains("warnings  none"), "{message}");
}

#[test]
fn check_tells_what_was_understood() {
    let folder = TempDir::new().unwrap();
    let mut case = with(&[("/contacts/base/normal", json!({})), ("/mesh/nodes/6/1", json!(-0.01))]);
    case["contacts"]["base"]["friction"].as_object_mut().unwrap().remove("alpha_t");
    write(folder.path(), "case.json", case.to_string());
    let output = fecontact(folder.path(), &["check", "case.json"]);
    let text = String::from_utf8(output.stdout).unwrap();
    for part in [
        "14 nodes, 5 elements (5 Q4), 28 dofs",
        "block_bottom   3 edges, x from 0.5 to 3.5, y from -0.01 to 0",
        "ground_bottom  2 edges, x from 0 to 4, y = -1",
        "neo_hookean: E 1000",
        "mortar, averaged around each node (chosen because the master is a mesh): 4 contact points",
        "alpha_n 4.03183e5 (300 (λ + 2G)/h of the softer body, h the depth of the slave's elements)",
        "alpha_t 6719.72 (5 (λ + 2G)/h): parameter of the law, whose slip is elastic at first",
        "surfaces overlap by up to 0.006667",
        "dt: initial 0.5, min 0.01, max 0.5",
        "support block_top: uy = -0.001",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
    assert!(!folder.path().join("out").exists());

    let mut dynamic = case.clone();
    for body in ["block", "ground"] {
        dynamic["bodies"][body]["material"]["density"] = json!(1e-3);
    }
    dynamic["steps"][0]["scheme"] = json!({"generalized_alpha": {}});
    dynamic["steps"][0]["dt"] = json!({"initial": 0.01, "error": 1e-6});
    write(folder.path(), "dynamic.json", dynamic.to_string());
    let output = fecontact(folder.path(), &["check", "dynamic.json"]);
    let text = String::from_utf8(output.stdout).unwrap();
    for part in [
        "generalized_alpha {\"rho_infinity\":0.8}",
        "dt: initial 0.01, min 1e-8, max 0.1",
        "error per increment at most 1e-6 in any displacement, contact events located within 1e-5",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
}

/// What `check` warns of reaches a run: once on stderr, once in the summary.
#[test]
fn warnings_of_check_reach_the_run() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), "case.json", with(&[("/mesh/nodes/6/1", json!(-0.01))]).to_string());
    let check = fecontact(folder.path(), &["check", "case.json"]);
    let message = "surfaces overlap by up to 0.006667 at the start, at (0.5, -0.01)";
    assert!(String::from_utf8_lossy(&check.stdout).contains(message), "{}", String::from_utf8_lossy(&check.stdout));
    let run = fecontact(folder.path(), &["run", "case.json"]);
    assert_eq!(stderr(&run).matches(message).count(), 1, "{}", stderr(&run));
    let summary: Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("out/case/summary.json")).unwrap()).unwrap();
    let warnings = summary["warnings"].as_array().unwrap();
    assert_eq!(
        warnings.iter().filter(|warning| warning.as_str().unwrap().contains(message)).count(),
        1,
        "{warnings:?}"
    );
}

/// Overlap that is round-off of the positions is none, near the origin and far from it; that of a shrink fit is told, and no
/// reason to warn.
#[test]
fn overlap_is_reported_where_it_means_something() {
    let folder = TempDir::new().unwrap();
    let checked = |case: &Value| {
        write(folder.path(), "case.json", case.to_string());
        String::from_utf8(fecontact(folder.path(), &["check", "case.json"]).stdout).unwrap()
    };
    let text = checked(&with(&[("/mesh/nodes/6/1", json!(-1.2e-18))]));
    assert!(text.contains("initial gap 0 everywhere") && text.contains("warnings  none"), "{text}");
    let mut far = with(&[("/mesh/nodes/6/1", json!(-1e-9))]);
    for node in far["mesh"]["nodes"].as_array_mut().unwrap() {
        *node = json!([node[0], node[1].as_f64().unwrap() + 1e5]);
    }
    let text = checked(&far);
    assert!(text.contains("surfaces overlap by up to"), "1e-9 is seen at 1e5:\n{text}");
    far["mesh"]["nodes"][6][1] = json!(1e5 - 2e-11);
    let text = checked(&far);
    assert!(text.contains("warnings  none"), "one digit of 1e5:\n{text}");
    let text = checked(&with(&[("/mesh/nodes/6/1", json!(-0.01)), ("/contacts/base/shrink_fit", json!(true))]));
    let message = "shrink fit: the surfaces overlap by up to 0.006667, at (0.5, -0.01), brought in over the first";
    assert!(text.contains(message) && text.contains("warnings  none"), "{text}");
}

/// A step inherits the scheme; `check` says which each has, and how what is freed or ended goes.
#[test]
fn check_tells_scheme_and_endings_of_each_step() {
    let folder = TempDir::new().unwrap();
    let mut case = good();
    for body in ["block", "ground"] {
        case["bodies"][body]["material"]["density"] = json!(1e-3);
    }
    case["steps"][0]["scheme"] = json!({"newmark": {}});
    case["steps"][0]["loads"] =
        json!([{"on": "block_top", "traction": {"x": 1}}, {"on": "block_top", "spring": {"kx": 1}}]);
    let free = json!({"name": "free", "duration": 1, "supports": [{"on": "block_top", "uy": null}],
                      "loads": [{"on": "block_top", "traction": null}, {"on": "block_top", "spring": null}]});
    let rest = json!({"name": "rest", "duration": 1, "scheme": "static", "supports": [{"on": "block_top", "ux": null, "uy": 0}]});
    case["steps"].as_array_mut().unwrap().extend([free, rest]);
    write(folder.path(), "case.json", case.to_string());
    let text = String::from_utf8(fecontact(folder.path(), &["check", "case.json"]).stdout).unwrap();
    for part in [
        "time 0 to 1, newmark",
        "time 1 to 2, newmark",
        "support block_top: uy released, at once",
        "load block_top: traction ended, it fades over the step",
        "load block_top: spring ended, at once",
        "time 2 to 3, static",
        "support block_top: ux released, its reaction fades over the step",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
}
