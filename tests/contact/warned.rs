//! What a contact is warned of: that it never closes, what it does not see, and fronts that its mesh does not resolve.

use std::sync::Arc;

use fecontact::output::warnings::Warnings;
use serde_json::{Value, json};

use crate::common;

const E: f64 = 1000.0;
const NU: f64 = 0.25;

/// Warnings of a run that ends as it should.
fn warnings(case: &Value) -> Vec<String> {
    let (mut warnings, model) = (Warnings::default(), Arc::new(common::model(case)));
    fecontact::run::run(&model, &mut [&mut warnings]).1.unwrap_or_else(|error| panic!("{error}"));
    warnings.list
}

/// A block of 4 × 2 whose bottom is the slave of a rigid master, moved as a whole in ten increments.
fn moved(master: &Value, [x, y]: [f64; 2]) -> Value {
    json!({
        "mesh": {"blocks": [{"body": "block", "corners": [[0, 0], [4, 0], [4, 2], [0, 2]], "elements": [8, 4],
                             "sides": ["bottom", "right", "top", "left"]}]},
        "bodies": {"block": {"material": {"model": "linear", "E": E, "nu": NU}}},
        "contacts": {"base": {"slave": "bottom", "master": master, "normal": {"alpha_n": 1e6}, "friction": {"law": "coulomb", "mu": 0.3}}},
        "steps": [{"name": "move", "duration": 1, "scheme": "static", "dt": {"initial": 0.1},
                   "supports": [{"on": "top", "ux": x, "uy": y}]}]
    })
}

#[test]
fn a_contact_that_never_closes_is_told() {
    let plane = json!({"plane": {"point": [0, -0.5], "normal": [0, 1]}});
    let told = warnings(&moved(&plane, [0.0, -0.3]));
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("contact `base` has never closed: its smallest gap was 2.000e-1"), "{told:?}");
    assert_eq!(warnings(&moved(&plane, [0.0, -0.502])), Vec::<String>::new(), "it closes");
}

/// The right side runs into a circle of which the bottom knows nothing; one that it has been inside of from the start is meant.
#[test]
fn a_side_that_enters_a_rigid_master_unseen_is_told() {
    let circle = |x: f64| json!({"circle": {"centre": [x, 1.0], "radius": 1.0}});
    let seen = |told: &[String]| told.iter().filter(|warning| warning.contains("outside the slave group")).count();
    let told = warnings(&moved(&circle(5.5), [0.8, 0.0]));
    assert_eq!(seen(&told), 1, "{told:?}");
    assert!(
        told.iter()
            .any(|warning| warning.contains("at (4.560000, 1.000000), t = 0.7") && warning.contains("by 6.000e-2;")),
        "{told:?}"
    );
    assert_eq!(seen(&warnings(&moved(&circle(5.5), [0.4, 0.0]))), 0, "0.1 apart");
    assert_eq!(seen(&warnings(&moved(&circle(4.9), [0.05, 0.0]))), 0, "inside from the start");
}

/// Λ₀ = 9π/32 G/((1 − ν) p (μ_s − μ_d)/D_c) of two half-spaces, twice that on a rigid base; edges of 0.5.
#[test]
fn edges_longer_than_the_process_zone_are_told() {
    // ν = 0, so that an evenly loaded block presses evenly.
    let (shear, pressure) = (0.5 * E, 2.0);
    let zone = 2.0 * 9.0 * std::f64::consts::PI / 32.0 * shear;
    let sheared = |critical_slip: f64| {
        let plane = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
        let mut case = moved(&plane, [0.05, 0.0]);
        case["contacts"]["base"]["friction"] =
            json!({"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.2, "D_c": critical_slip, "alpha_t": 1e5});
        case["contacts"]["base"]["initial"] = json!({"pressure": pressure, "traction": 0.0});
        case["bodies"]["block"]["material"]["nu"] = json!(0);
        // What slips is given, and p that of the load.
        case["steps"][0]["supports"] = json!([{"on": "top", "ux": 0.05}, {"on": "bottom", "ux": 0.05}]);
        case["steps"][0]["loads"] = json!([{"on": "top", "pressure": format!("{pressure}")}]);
        warnings(&case).into_iter().filter(|warning| warning.contains("process zone")).collect::<Vec<_>>()
    };
    // Λ₀ = 0.5 at this D_c
    let critical = 0.5 * pressure * 0.4 / zone;
    let told = sheared(0.98 * critical);
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("the edge of 5.00") && told[0].contains("= 4.900e-1"), "{told:?}");
    assert_eq!(sheared(1.02 * critical), Vec::<String>::new());
}

/// Bilinear elements with corners of 30° beside the fault of a cycle are told, those of 60° are not, nor quadratic ones, nor the same in
/// a static step.
#[test]
fn sheared_linear_elements_beside_a_fault_are_told() {
    let told = |degrees: f64, refined: bool, scheme: Value| {
        let lean = 1.0 / f64::to_radians(degrees).tan();
        let mesh = common::Blocks::default()
            .block("lower", [6, 2], |s, t| [6.0 * s + lean * (t - 1.0), t - 1.0])
            .block("upper", [6, 2], |s, t| [6.0 * s + lean * t, t])
            .json();
        let mesh = if refined { common::quadratic(&mesh, common::half_way) } else { mesh };
        let body = json!({"material": {"model": "linear", "E": 200, "nu": 0.25, "density": 1e-6}});
        let model = common::model(&json!({
            "mesh": mesh, "bodies": {"lower": body, "upper": body},
            "contacts": {"fault": {
                "slave": "upper_bottom", "master": "lower_top", "method": "node_to_segment", "sliding": "small", "radiation_damping": 0.02,
                "friction": {"law": "rate_and_state", "f_0": 0.6, "V_0": 1e-3, "a": 0.01, "b": 0.016, "D_c": 2e-3, "theta": 20},
                "initial": {"pressure": 2, "traction": 1.1, "balanced": true}}},
            "steps": [{"name": "shear", "duration": 1, "scheme": scheme, "dt": {"initial": 1e-3}, "supports": [
                {"on": "lower_bottom", "ux": 0, "uy": 0}, {"on": "upper_top", "ux": {"rate": 1e-3}, "uy": 0}]}],
        }));
        model.warnings()
    };
    let cycles = || json!({"quasi_dynamic": {}});
    let sharp = told(30.0, false, cycles());
    assert!(
        sharp.len() == 1 && sharp[0].contains("contact `fault`: bilinear elements beside it have corners of 30°"),
        "{sharp:?}"
    );
    for (degrees, refined, scheme) in [(60.0, false, cycles()), (30.0, true, cycles()), (30.0, false, json!("static"))]
    {
        assert_eq!(told(degrees, refined, scheme), Vec::<String>::new(), "{degrees}");
    }
}
