//! Equilibria that lose their stability: long increments keep to the stable branch, and what is unstable is reported.

use crate::common::{Finished, close, finish};
use fecontact::output::warnings::Warnings;
use fecontact::run::{Observer, Simulation};
use serde_json::{Value, json};

/// A beam of 20 × 0.5 whose middle is `raised`, both ends clamped, pushed together by `by`.
fn beam(raised: f64, by: f64, dt: Value) -> Value {
    let half = |x: [f64; 2], y: [f64; 2], sides: Value| {
        json!({"body": "beam", "kind": "Q8", "elements": [15, 1], "sides": sides,
               "corners": [[x[0], y[0]], [x[1], y[1]], [x[1], y[1] + 0.5], [x[0], y[0] + 0.5]]})
    };
    json!({
        "mesh": {"blocks": [half([0.0, 10.0], [0.0, raised], json!([null, null, null, "left"])),
                            half([10.0, 20.0], [raised, 0.0], json!([null, "right", null, null]))]},
        "bodies": {"beam": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}}},
        "steps": [{"name": "crush", "duration": 1, "dt": dt,
                   "supports": [{"on": "left", "ux": 0, "uy": 0}, {"on": "right", "ux": -by, "uy": 0}]}],
    })
}

/// Runs a case with its warnings.
fn message(case: &Value) -> (Finished, Vec<String>) {
    let run = finish(case);
    let mut warnings = Warnings::default();
    let mut simulation = Simulation::new(run.model.clone());
    while let Some(candidate) = simulation.try_increment().expect("an increment") {
        warnings.record(&run.model, &simulation.attempt_of(&candidate)).expect("warnings");
        simulation.apply(candidate).expect("applied");
    }
    warnings.finish().expect("warnings");
    (run, warnings.list)
}

fn is_unstable(warnings: &[String]) -> bool {
    warnings.iter().any(|warning| warning.contains("equilibria are unstable"))
}

/// Pushed together by a tenth, the beam has buckled: 0.1181 by increments of 1e-4 at first (Euler: 4π² E I/((1 − ν²) L²) = 0.113, plus
/// what a deep bend adds). Long increments and error control come to the same branch, where they came to 1.07 and 5.96.
#[test]
fn long_increments_keep_to_the_stable_branch() {
    for dt in [json!({"initial": 0.1}), json!({"initial": 0.05, "error": 1e-3})] {
        let (run, warnings) = message(&beam(0.05, 2.0, dt));
        close("end force", run.reaction("right", run.last())[0], -0.1181, 1e-2);
        assert!(!is_unstable(&warnings), "{warnings:?}");
    }
}

/// Without an imperfection the straight beam stays straight, which is unstable beyond Euler's load: it is reported from there on, at an
/// end displacement near N/(E' A) L, N = 4π² E' I/L². Below it there is nothing to report.
#[test]
fn the_straight_branch_is_reported_from_eulers_load_on() {
    let strain = 4.0 * std::f64::consts::PI.powi(2) / 12.0 * (0.5f64 / 20.0).powi(2);
    let at = |times: f64| message(&beam(0.0, times * strain * 20.0, json!({"initial": 0.1, "max": 0.1}))).1;
    assert!(!is_unstable(&at(0.9)));
    let warnings = at(2.0);
    let warning = warnings.iter().find(|warning| warning.contains("equilibria are unstable")).expect("a warning");
    let since = warning.split("t = ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a time");
    let since: f64 = since.parse().expect("a number");
    close("since", since, 0.5, 0.03);
    assert!(warning.contains("up to 1 negative eigenvalue"), "{warning}");
}

/// A case with a body far away that slides on another.
fn beside_what_slides(mut case: Value) -> Value {
    let block = |body: &str, x: [f64; 2], y: f64, sides: [&str; 2]| {
        json!({"body": body, "kind": "Q4", "elements": [3, 1], "sides": [sides[0], null, sides[1], null],
               "corners": [[x[0], y], [x[1], y], [x[1], y + 1.0], [x[0], y + 1.0]]})
    };
    let others =
        [block("bed", [100.0, 104.0], 0.0, ["foot", "ground"]), block("slider", [101.0, 103.0], 1.0, ["sole", "head"])];
    case["mesh"]["blocks"].as_array_mut().expect("blocks").extend(others);
    let material = case["bodies"]["beam"].clone();
    (case["bodies"]["bed"], case["bodies"]["slider"]) = (material.clone(), material);
    case["contacts"] = json!({"far": {"slave": "sole", "master": "ground", "friction": {"law": "coulomb", "mu": 0.3}}});
    let held = [json!({"on": "foot", "ux": 0, "uy": 0}), json!({"on": "head", "ux": 0.05, "uy": -0.02})];
    case["steps"][0]["supports"].as_array_mut().expect("supports").extend(held);
    case
}

/// A body far away that slides on another says nothing of the beam, whose own eigenvalues are counted as before, although the tangent as
/// a whole is not symmetric: the stable branch, where it was 1.07; and the straight beam is reported beside it.
#[test]
fn what_slides_elsewhere_hides_no_instability() {
    let (run, warnings) = message(&beside_what_slides(beam(0.05, 2.0, json!({"initial": 0.1}))));
    close("end force", run.reaction("right", run.last())[0], -0.1181, 1e-2);
    assert!(!is_unstable(&warnings), "{warnings:?}");
    assert!(is_unstable(&message(&beside_what_slides(beam(0.0, 0.1, json!({"initial": 0.1, "max": 0.1})))).1));
}

/// Nor does water that flows freely through all of them: each pressure gives the tangent a negative eigenvalue, and those beyond are told, with and
/// without something that slides.
#[test]
fn water_hides_no_instability() {
    let strain = 4.0 * std::f64::consts::PI.powi(2) / 12.0 * (0.5f64 / 20.0).powi(2);
    let wet = |times: f64, slides: bool| {
        let mut case = beam(0.0, times * strain * 20.0, json!({"initial": 0.1, "max": 0.1}));
        case["bodies"]["beam"]["pore_fluid"] =
            json!({"bulk_modulus": 1e4, "porosity": 0.5, "permeability": 1e6, "unit_weight": 1});
        case["steps"][0]["drainage"] = json!([{"on": "left", "pressure": 0}]);
        if slides {
            case = beside_what_slides(case);
            case["steps"][0]["drainage"].as_array_mut().expect("entries").push(json!({"on": "foot", "pressure": 0}));
        }
        message(&case).1
    };
    for slides in [false, true] {
        assert!(!is_unstable(&wet(0.9, slides)), "{slides}");
        let warnings = wet(2.0, slides);
        let warning = warnings.iter().find(|warning| warning.contains("equilibria are unstable")).expect("a warning");
        let since = warning.split("t = ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a time");
        close("since", since.parse().expect("a number"), 0.5, 0.03);
        assert!(warning.contains("up to 1 negative eigenvalue"), "{warning}");
    }
}

/// A straight column, clamped at one end, at the other held across only and pressed by a pressure, which follows the surface: the tangent
/// is not symmetric there, and the sign of its determinant tells. The force across that comes by the rotation of the end is borne by the
/// support, so that the load is that of a dead force, N = 20.19 E' I/L² (tan x = x, x² = 20.19).
#[test]
fn the_sign_of_the_determinant_tells_where_the_tangent_is_not_symmetric() {
    let critical = 20.19 * 100.0 / (1.0 - 0.09) / 12.0 * (0.5f64 / 20.0).powi(2);
    let at = |times: f64| {
        let mut case = beam(0.0, 0.0, json!({"initial": 0.1, "max": 0.1}));
        case["steps"][0]["supports"] = json!([{"on": "left", "ux": 0, "uy": 0}, {"on": "right", "uy": 0}]);
        case["steps"][0]["loads"] = json!([{"on": "right", "pressure": format!("{}*t", times * critical)}]);
        message(&case).1
    };
    assert!(!is_unstable(&at(0.9)));
    let warnings = at(1.8);
    let warning = warnings.iter().find(|warning| warning.contains("equilibria are unstable")).expect("a warning");
    let since: f64 = warning
        .split("t = ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next())
        .and_then(|t| t.parse().ok())
        .expect("a time");
    close("since", since, 1.0 / 1.8, 0.03);
}
