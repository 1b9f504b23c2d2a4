//! What a contact is warned of: that it never closes, what it does not see, methods that do not suit its meshes, fits whose edges do not
//! follow their curves, and fronts that its mesh does not resolve; and bodies that hardly anything holds. Each beside a case that must not
//! be warned.

mod rest;

use std::sync::Arc;

use fecontact::output::warnings::Warnings;
use serde_json::{Value, json};

use crate::common;

const E: f64 = 1000.0;
const NU: f64 = 0.25;

/// Warnings of a run that ends as it should.
pub fn warnings(case: &Value) -> Vec<String> {
    let (mut warnings, model) = (Warnings::default(), Arc::new(common::model(case)));
    fecontact::run::run(&model, &mut [&mut warnings]).1.unwrap_or_else(|error| panic!("{error}"));
    for told in &warnings.list {
        assert!(common::warnings::is_listed(told), "docs/reference/warnings.md has no entry for: {told}");
    }
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

/// A block sheared by γ(t) between its sides, ∇u = γ everywhere: a linear body is told of its squares, where they were largest in the
/// step, though they are gone at its end; a neo-Hookean one has them.
#[test]
fn linear_bodies_that_strain_far_are_told() {
    let sheared = |model: &str, gamma: &str| {
        let supports =
            ["bottom", "top", "left", "right"].map(|on| json!({"on": on, "ux": format!("y * {gamma}"), "uy": 0}));
        warnings(&json!({
            "mesh": {"blocks": [{"body": "block", "corners": [[0, 0], [2, 0], [2, 1], [0, 1]], "elements": [4, 2],
                                 "sides": ["bottom", "right", "top", "left"]}]},
            "bodies": {"block": {"material": {"model": model, "E": E, "nu": NU}}},
            "steps": [{"name": "shear", "duration": 1, "scheme": "static", "dt": {"initial": 0.25},
                       "supports": supports}]
        }))
    };
    let told = sheared("linear", "0.11 * t");
    assert!(told.len() == 1 && told[0].contains("body `block` at") && told[0].contains("of 11.0 %"), "{told:?}");
    assert_eq!(sheared("linear", "0.09 * t"), Vec::<String>::new());
    assert_eq!(sheared("neo_hookean", "0.11 * t"), Vec::<String>::new());
    let told = sheared("linear", "1.2 * t * (1 - t)");
    assert!(told.len() == 1 && told[0].contains("t = 0.5: strains and rotations of 30.0 %"), "{told:?}");
}

/// One body that strains far does not hide another that does so later, and less far, and is back at the end of its step.
#[test]
fn each_linear_body_is_told() {
    let block = |body: &str, x: f64| {
        let sides = ["bottom", "right", "top", "left"].map(|side| format!("{body}_{side}"));
        let corners = [[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]];
        json!({"body": body, "corners": corners, "elements": [2, 2], "sides": sides})
    };
    let sheared = |body: &str, gamma: &str| {
        ["bottom", "right", "top", "left"]
            .map(|side| json!({"on": format!("{body}_{side}"), "ux": format!("y * {gamma}"), "uy": 0}))
    };
    let step = |name: &str, supports: Vec<Value>| json!({"name": name, "duration": 1, "scheme": "static", "dt": {"initial": 0.25}, "supports": supports});
    let material = json!({"material": {"model": "linear", "E": E, "nu": NU}});
    let steps = [
        step("one", [sheared("first", "0.5 * t"), sheared("second", "0")].concat()),
        step("two", [sheared("first", "0.5"), sheared("second", "1.2 * (t - 1) * (2 - t)")].concat()),
    ];
    let told = warnings(&json!({
        "mesh": {"blocks": [block("first", 0.0), block("second", 5.0)]},
        "bodies": {"first": material, "second": material},
        "steps": steps
    }));
    let said =
        ["body `first`", "body `second`"].map(|body| told.iter().filter(|warning| warning.starts_with(body)).count());
    assert!(
        told.len() == 2 && said == [1, 1] && told[1].contains("t = 1.5: strains and rotations of 30.0 %"),
        "{told:?}"
    );
}

/// The right side runs into a circle of which the bottom knows nothing; one that it has been inside of from the start is meant.
#[test]
fn a_side_that_enters_a_rigid_master_unseen_is_told() {
    let circle = |x: f64| json!({"circle": {"centre": [x, 1.0], "radius": 1.0}});
    let seen = |told: &[String]| told.iter().filter(|warning| warning.contains("outside the slave group")).count();
    let told = warnings(&moved(&circle(5.5), [0.8, 0.0]));
    assert_eq!(seen(&told), 1, "{told:?}");
    assert!(
        told.iter().any(|warning| warning.contains("at (4.56, 1), t = 0.7") && warning.contains("by 6.000e-2;")),
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

/// Rate-and-state friction always slips, and from the first on faster than it heals where θ is large: Λ₀ = 0.49 of b/D_c is told where an
/// edge of 0.5 has slipped by D_c, not where it has crept by half of that.
#[test]
fn what_creeps_needs_no_process_zone() {
    let (shear, pressure, critical) = (0.5 * E, 2.0, 1e-5);
    let b = 2.0 * 9.0 * std::f64::consts::PI / 32.0 * shear / (0.49 * pressure) * critical;
    let crept = |way: f64| {
        let mut case = moved(&json!({"plane": {"point": [0, 0], "normal": [0, 1]}}), [way, 0.0]);
        case["contacts"]["base"]["friction"] = json!({"law": "rate_and_state", "f_0": 0.6, "a": 2.0 * b, "b": b, "D_c": critical, "V_0": 1e-5, "theta": 100, "alpha_t": 1e8});
        case["contacts"]["base"]["initial"] = json!({"pressure": pressure, "traction": 0.0});
        case["bodies"]["block"]["material"]["nu"] = json!(0);
        case["steps"][0]["supports"] = json!([{"on": "top", "ux": way}, {"on": "bottom", "ux": way}]);
        case["steps"][0]["loads"] = json!([{"on": "top", "pressure": format!("{pressure}")}]);
        warnings(&case).iter().filter(|warning| warning.contains("process zone")).count()
    };
    assert_eq!([crept(2.0 * critical), crept(0.5 * critical)], [1, 0]);
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
        sharp.len() == 1 && sharp[0].contains("contact `fault`: bilinear elements next to it have corners of 30°"),
        "{sharp:?}"
    );
    for (degrees, refined, scheme) in [(60.0, false, cycles()), (30.0, true, cycles()), (30.0, false, json!("static"))]
    {
        assert_eq!(told(degrees, refined, scheme), Vec::<String>::new(), "{degrees}");
    }
}

/// Two blocks of E with so many elements along their interface, pressed by p = 1 without friction: the pressure is 1 everywhere.
fn patch([lower, upper]: [usize; 2], contact: &Value) -> Value {
    let block = |body: &str, y: f64, n: usize| {
        let sides = ["bottom", "right", "top", "left"].map(|side| format!("{body}_{side}"));
        json!({"body": body, "corners": [[0, y], [1, y], [1, y + 0.5], [0, y + 0.5]], "elements": [n, 4], "sides": sides})
    };
    let body = json!({"material": {"model": "linear", "E": E, "nu": 0.3}});
    let base = common::with(
        json!({"slave": "upper_bottom", "master": "lower_top", "friction": {"law": "frictionless"}}),
        contact,
    );
    json!({
        "mesh": {"blocks": [block("lower", 0.0, lower), block("upper", 0.5, upper)]},
        "bodies": {"lower": body, "upper": body},
        "contacts": {"base": base},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 1},
                   "supports": [{"on": "lower_bottom", "uy": 0}, {"on": "lower_left", "ux": 0}, {"on": "upper_left", "ux": 0}],
                   "loads": [{"on": "upper_top", "pressure": 1}]}]
    })
}

/// Points that are asked for where nodes do not face nodes leave an even pressure uneven by 5 % and more; where the slave divides the
/// edges of its master, by mortar, or by Gauss points on the finer side with a soft penalty it is even enough, and nothing is told.
#[test]
fn points_on_edges_that_do_not_match_are_told() {
    let nodes = json!({"method": "node_to_segment"});
    // 300 and 20 (λ + 2G)/h, h = 1/8
    let gauss = json!({"method": "gauss_to_segment", "normal": {"alpha_n": 300.0 * 8.0 * 1346.0}});
    let soft = json!({"method": "gauss_to_segment", "normal": {"alpha_n": 20.0 * 8.0 * 1346.0}});
    let (augmented, open) = (json!({"method": "gauss_to_segment", "normal": {"penetration": 1e-9}}), json!({}));
    for (elements, contact, is_told) in [
        ([10, 13], &gauss, true),
        ([13, 10], &gauss, true),
        ([10, 13], &nodes, true),
        ([10, 13], &augmented, true),
        ([37, 10], &soft, true),
        ([24, 28], &soft, false),
        ([10, 13], &json!({"method": "mortar"}), false),
        ([10, 13], &open, false),
        ([10, 20], &gauss, false),
        ([10, 20], &nodes, false),
        ([10, 10], &nodes, false),
    ] {
        let what = format!("{elements:?}, {contact}");
        let run = common::finish(&patch(elements, contact));
        let told = run.model.warnings();
        let pressures = run.last().contacts[0].iter().map(|state| state.friction.pressure);
        let uneven = pressures.fold(0.0, |most: f64, pressure| most.max((pressure - 1.0).abs()));
        assert_eq!(uneven > 0.05, is_told, "{what}: {uneven}");
        assert_eq!(told.len(), usize::from(is_told), "{what}: {told:?}");
        if is_told {
            let method = contact["method"].as_str().expect("a name");
            assert!(told[0].starts_with(&format!("contact `base`: {method} on nodes that do not match")), "{told:?}");
            assert!(told[0].ends_with("take \"method\": \"mortar\""), "{told:?}");
        }
    }
}

/// Explicit steps have no other method, and rigid masters no nodes.
#[test]
fn points_without_a_better_method_are_not_told() {
    let mut explicit = patch([10, 13], &json!({"method": "gauss_to_segment"}));
    for body in ["lower", "upper"] {
        explicit["bodies"][body]["material"]["density"] = json!(1e-6);
    }
    explicit["steps"][0]["scheme"] = json!({"explicit": {}});
    let mut rigid = patch([10, 13], &json!({"method": "gauss_to_segment"}));
    rigid["contacts"]["base"]["master"] = json!({"plane": {"point": [0, 0.5], "normal": [0, 1]}});
    for case in [explicit, rigid] {
        assert_eq!(common::model(&case).warnings(), Vec::<String>::new());
    }
}

/// An element of reduced integration by itself has no stiffness against one motion of its nodes: a pivot is only round-off. Loads that do
/// not excite it are borne, and the run goes on; two such elements have the edge between them, and full integration lacks nothing.
#[test]
fn pivots_that_had_to_be_replaced_are_told() {
    let told = |elements: usize, formulation: &str| {
        let near = |x: f64| json!({"near": [x, 0]});
        warnings(&json!({
            "mesh": {"blocks": [{"body": "block", "corners": [[0, 0], [4, 0], [4, 2], [0, 2]], "elements": [elements, 1], "kind": "Q8",
                                 "sides": ["bottom", "right", "top", "left"]}]},
            "bodies": {"block": {"material": {"model": "linear", "E": E, "nu": NU}, "element": formulation}},
            "steps": [{"name": "press", "duration": 1, "dt": {"initial": 1},
                       "supports": [{"on": near(0.0), "ux": 0, "uy": 0}, {"on": near(4.0), "uy": 0}],
                       "loads": [{"on": "top", "total_force": {"y": -4}}, {"on": "bottom", "total_force": {"y": 4}}]}]
        }))
    };
    let alone = told(1, "reduced");
    assert!(
        alone.len() == 1
            && alone[0].starts_with("step `press`, t = 1: 1 pivots of the tangent were nearly zero and were replaced")
            && alone[0].contains("a body may be barely constrained: support it"),
        "{alone:?}"
    );
    assert_eq!(told(2, "reduced"), Vec::<String>::new());
    assert_eq!(told(1, "displacement"), Vec::<String>::new());
}

/// A quarter of a ring shrunk on another by δ = 1e-3 at r = 2, with so many linear or quadratic elements along the arcs.
fn fit([inner, outer]: [usize; 2], kind: &str, shrink_fit: bool) -> Value {
    let ring = |body: &str, n: usize, [a, b]: [f64; 2]| {
        let sides = ["bottom", "outside", "top", "inside"].map(|side| format!("{body}_{side}"));
        json!({"body": body, "corners": [[a, 0], [b, 0], [0, b], [0, a]], "arcs": [null, [0, 0], null, [0, 0]], "elements": [2, n],
               "kind": kind, "sides": sides})
    };
    let body = json!({"material": {"model": "linear", "E": E, "nu": NU}});
    json!({
        "mesh": {"blocks": [ring("inner", inner, [1.0, 2.001]), ring("outer", outer, [2.0, 3.0])]},
        "bodies": {"inner": body, "outer": body},
        "contacts": {"fit": {"slave": "outer_inside", "master": "inner_outside", "method": "mortar", "shrink_fit": shrink_fit,
                             "friction": {"law": "frictionless"}}},
        "steps": [{"name": "fit", "duration": 1, "dt": {"initial": 0.5}, "supports": [
            {"on": "inner_bottom", "uy": 0}, {"on": "inner_top", "ux": 0}, {"on": "outer_bottom", "uy": 0}, {"on": "outer_top", "ux": 0}]}]
    })
}

/// Chords of 20 edges on the hole lie h²/12R = 1.03e-3 inside it in the mean, those of 24 on the shaft 0.71e-3: the overlap is larger by
/// 31 %, and so is the pressure. Equal edges cancel, quadratic ones follow their arcs.
#[test]
fn edges_that_change_a_fit_are_told() {
    let told = |elements, kind| common::model(&fit(elements, kind, true)).warnings();
    let coarse = told([24, 20], "Q4");
    assert!(coarse.len() == 1 && coarse[0].contains("make the overlap of its shrink fit 31 % larger"), "{coarse:?}");
    let pressure = |elements, kind| {
        let run = common::finish(&fit(elements, kind, true));
        run.contact_force(run.last())[0]
    };
    let larger = pressure([24, 20], "Q4") / pressure([24, 20], "Q8");
    common::close("pressure", larger, 1.31, 0.02);
    let other_way = told([20, 24], "Q4");
    assert!(other_way.len() == 1 && other_way[0].contains("31 % smaller"), "{other_way:?}");
    for (elements, kind) in [([24, 24], "Q4"), ([24, 20], "Q8"), ([120, 100], "Q4")] {
        assert_eq!(told(elements, kind), Vec::<String>::new(), "{elements:?}");
    }
    // A node that stands out of a straight side is no curve.
    let mut mesh = common::Blocks::default()
        .rectangle("lower", [4, 1], [0.0, -1.0], [4.0, 0.0])
        .rectangle("upper", [3, 1], [0.5, 0.0], [3.5, 1.0])
        .json();
    mesh["nodes"][11][1] = json!(-0.01);
    let body = json!({"material": {"model": "linear", "E": E, "nu": NU}});
    let straight = common::model(&json!({
        "mesh": mesh, "bodies": {"lower": body, "upper": body},
        "contacts": {"base": {"slave": "upper_bottom", "master": "lower_top", "shrink_fit": true, "friction": {"law": "frictionless"}}},
        "steps": [{"name": "press", "duration": 1, "supports": [
            {"on": "lower_bottom", "ux": 0, "uy": 0}, {"on": "upper_top", "ux": 0, "uy": 0}]}]
    }));
    assert!(straight.contacts[0].points.iter().any(|point| point.overlap > 0.0));
    assert_eq!(straight.warnings(), Vec::<String>::new());
}

/// Surfaces that overlap at once set energy free that nobody supplies, whatever the increments; brought in over the step it is supplied.
#[test]
fn energy_of_an_overlap_is_told_with_its_cause() {
    let told = warnings(&fit([24, 24], "Q4", false));
    let of_energy: Vec<&String> = told.iter().filter(|told| told.contains("energy balance")).collect();
    assert!(
        of_energy.len() == 1
            && of_energy[0].contains("with nothing supplied")
            && of_energy[0].contains("surfaces that overlap at the start set energy free"),
        "{told:?}"
    );
    assert_eq!(warnings(&fit([24, 24], "Q4", true)), Vec::<String>::new());
}

/// A stiffer penalty is advised where the penalty lets a master node in.
#[test]
fn a_master_node_let_in_by_the_penalty_is_told() {
    let mut case = fit([24, 20], "Q8", true);
    case["mesh"]["blocks"][0]["corners"] = json!([[1, 0], [2.02, 0], [0, 2.02], [0, 1]]);
    let told = |case: &Value| {
        warnings(case).into_iter().filter(|told| told.contains("a master node penetrates")).collect::<Vec<_>>()
    };
    assert_eq!(told(&case), Vec::<String>::new());
    case["contacts"]["fit"]["normal"] = json!({"alpha_n": 500});
    let soft = told(&case);
    assert!(soft.len() == 1 && soft[0].contains("or raise alpha_n"), "{soft:?}");
}

/// A point deep in its master is told, with the penalty as the remedy.
#[test]
fn a_deep_point_is_told() {
    let plane = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
    let deep = |alpha_n: f64| {
        let mut case = moved(&plane, [0.0, -0.02]);
        case["contacts"]["base"]["normal"]["alpha_n"] = json!(alpha_n);
        warnings(&case).into_iter().filter(|told| told.contains("of the slave's edge")).collect::<Vec<_>>()
    };
    let soft = deep(100.0);
    assert!(soft.len() == 1 && soft[0].contains("raise alpha_n"), "{soft:?}");
    assert_eq!(deep(1e5), Vec::<String>::new());
}

/// A block of rough ends under pressure, whose corners are singular: they alone are deep by more than a hundredth, which no penalty mends, and
/// nothing is told. A softer penalty lets all points in.
#[test]
fn singular_corners_are_not_taken_for_a_soft_penalty() {
    let pressed = |alpha_n: f64| {
        let part = |body: &str, corners: Value, columns: usize, sides: Value| json!({"body": body, "corners": corners, "elements": [columns, 12], "sides": sides});
        let case = json!({
            "mesh": {"blocks": [part("ground", json!([[-1, -1], [2, -1], [2, 0], [-1, 0]]), 90, json!(["bottom", null, "top", null])),
                                part("block", json!([[0, 0], [1, 0], [1, 0.4], [0, 0.4]]), 30, json!(["base", null, "upper", null]))]},
            "bodies": {"ground": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}}, "block": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}}},
            "contacts": {"base": {"slave": "base", "master": "top", "method": "node_to_segment", "friction": {"law": "coulomb", "mu": 0.5}, "normal": {"alpha_n": alpha_n}}},
            "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.5}, "supports": [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "upper", "ux": 0, "uy": -0.01}]}],
        });
        let told = warnings(&case).into_iter().filter(|told| told.contains("the penetration")).count();
        let run = crate::common::finish(&case);
        let x = run.model.configuration(&run.last().displacement);
        let points = run.model.contacts[0].points.iter().zip(&run.last().contacts[0]);
        let shares: Vec<f64> =
            points.filter_map(|(point, state)| Some(-state.clearance() / point.edge_length(&x)?)).collect();
        (shares, told)
    };
    let (shares, told) = pressed(6e4);
    assert!(shares[0] > 0.01 && shares[15] < 0.01 && told == 0, "{shares:?}, {told}");
    let (shares, told) = pressed(2e4);
    assert!(shares[15] > 0.01 && shares[0] < 0.05 && told == 1, "{shares:?}, {told}");
}

/// A fault under quasi-dynamic steps takes small sliding alone: where it has slid far, no other is advised.
#[test]
fn a_fault_that_slides_far_in_cycles_is_not_sent_to_finite_sliding() {
    let told = |scheme: Value, alpha_t: f64| {
        let body = json!({"material": {"model": "linear", "E": 200, "nu": 0.25, "density": 1e-6}});
        let block = |name: &str, y: f64| {
            json!({"body": name, "corners": [[0, y], [6, y], [6, y + 1.0], [0, y + 1.0]], "elements": [6, 2],
                   "sides": [format!("{name}_bottom"), null, format!("{name}_top"), null]})
        };
        warnings(&json!({
            "mesh": {"blocks": [block("lower", -1.0), block("upper", 0.0)]}, "bodies": {"lower": body, "upper": body},
            "contacts": {"fault": {
                "slave": "upper_bottom", "master": "lower_top", "method": "node_to_segment", "sliding": "small", "radiation_damping": 0.02,
                "friction": {"law": "rate_and_state", "f_0": 0.6, "V_0": 1e-3, "a": 0.02, "b": 0.016, "D_c": 2e-3, "theta": 2, "alpha_t": alpha_t},
                "initial": {"pressure": 2, "traction": 1.1, "balanced": true}}},
            "steps": [{"name": "shear", "duration": 150, "scheme": scheme, "dt": {"initial": 1, "max": 10, "min": 1e-3}, "supports": [
                {"on": "lower_bottom", "ux": 0, "uy": 0}, {"on": "upper_top", "ux": {"rate": 1e-3}, "uy": 0}]}],
        }))
    };
    let cycles = told(json!({"quasi_dynamic": {}}), 1e4);
    assert!(cycles.len() == 1 && cycles[0].contains("quasi_dynamic steps have no other sliding"), "{cycles:?}");
    let statics = told(json!("static"), 1e4);
    assert!(statics.len() == 1 && statics[0].ends_with("take finite sliding"), "{statics:?}");
}

/// Radiation damping that no step has a use for, and times of output that a step may shift.
#[test]
fn what_has_no_effect_is_told() {
    let plane = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
    let told = |scheme: Value, until: Value| {
        let mut case = moved(&plane, [0.0, -0.002]);
        case["bodies"]["block"]["material"]["density"] = json!(1e-6);
        case["contacts"]["base"]["radiation_damping"] = json!(0.1);
        (case["steps"][0]["scheme"], case["steps"][0]["until"]) = (scheme, until);
        case["output"] = json!({"times": [0.5]});
        common::model(&case).warnings()
    };
    let idle = told(json!({"newmark": {}}), json!(null));
    assert!(idle.len() == 1 && idle[0].contains("the radiation damping of contact `base` has no effect"), "{idle:?}");
    let early = told(json!("static"), json!({"on": "top", "fy": -1}));
    assert!(early.len() == 1 && early[0].contains("step `move` may end early (until)"), "{early:?}");
    assert_eq!(told(json!("static"), json!(null)), Vec::<String>::new());
}

/// An increment that may not become shorter is accepted with its error, which is told.
#[test]
fn an_error_in_the_shortest_increment_is_told() {
    let plane = json!({"plane": {"point": [0, -9], "normal": [0, 1]}});
    let told = |error: f64| {
        let mut case = moved(&plane, [0.0, -0.1]);
        case["bodies"]["block"]["material"]["density"] = json!(1);
        case["steps"][0]["scheme"] = json!({"newmark": {}});
        case["steps"][0]["dt"] = json!({"initial": 0.1, "min": 0.1, "max": 0.1, "error": error});
        warnings(&case).into_iter().filter(|told| told.contains("is the shortest allowed")).collect::<Vec<_>>()
    };
    let inexact = told(1e-9);
    assert!(inexact.len() == 1 && inexact[0].ends_with("lower dt.min"), "{inexact:?}");
    assert_eq!(told(1e3), Vec::<String>::new());
}

/// A side that another contact has as its slave is looked after, where that lets it in as well.
#[test]
fn the_slave_of_another_contact_is_not_unseen() {
    let circle = json!({"circle": {"centre": [5.5, 1.0], "radius": 1.0}});
    let mut case = moved(&circle, [0.8, 0.0]);
    case["contacts"]["side"] = case["contacts"]["base"].clone();
    case["contacts"]["side"]["slave"] = json!("right");
    case["contacts"]["side"]["normal"] = json!({"alpha_n": 1e3});
    let told = warnings(&case);
    assert!(told.iter().any(|told| told.contains("contact `side`") && told.contains("the penetration")), "{told:?}");
    assert!(!told.iter().any(|told| told.contains("outside the slave group")), "{told:?}");
}

/// A side that another contact keeps from another surface is not looked after by it: it runs into the circle of the bottom.
#[test]
fn the_slave_of_a_contact_with_another_surface_is_not_seen_here() {
    let mut case = moved(&json!({"circle": {"centre": [5.5, 1.0], "radius": 1.0}}), [0.8, 0.0]);
    case["contacts"]["side"] = case["contacts"]["base"].clone();
    case["contacts"]["side"]["slave"] = json!("right");
    case["contacts"]["side"]["master"] = json!({"plane": {"point": [9, 0], "normal": [-1, 0]}});
    let told = warnings(&case);
    assert_eq!(told.iter().filter(|told| told.contains("outside the slave group")).count(), 1, "{told:?}");
}

/// The edge of a die enters the ground: where multipliers close the mean gaps, the means over its flanks, whose hats are a third of an edge high,
/// are open until it is ℓ sin 45°/3 or less deep on quadratic edges, which is told from 0.05 ℓ on: at 0.065 after half of the way. By nodes,
/// and by the penalty alone, it is pressed on.
#[test]
fn a_ridge_between_means_is_told() {
    let told = |kind: &str, method: &str, normal: Value| {
        let case = json!({
            "mesh": {"blocks": [
                {"body": "ground", "kind": kind, "corners": [[-10, -8], [10, -8], [10, 0], [-10, 0]], "elements": [27, 10], "sides": ["low", null, "top", null]},
                {"body": "die", "kind": kind, "corners": [[0, 0.01], [4, 4.01], [0, 8.01], [-4, 4.01]], "elements": [8, 8],
                 "sides": ["flank", "held", "held", "flank"]}]},
            "bodies": {"die": {"material": {"model": "neo_hookean", "E": 2000, "nu": 0.3}},
                       "ground": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}}},
            "contacts": {"c": {"slave": "flank", "master": "top", "friction": {"law": "coulomb", "mu": 0.3}, "method": method,
                               "normal": normal}},
            "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.25},
                       "supports": [{"on": "low", "ux": 0, "uy": 0}, {"on": "held", "ux": 0, "uy": -0.15}]}],
        });
        warnings(&case)
            .into_iter()
            .filter(|told| told.contains("a slave node is inside the master"))
            .collect::<Vec<_>>()
    };
    let of_means = told("Q8", "mortar", json!({"penetration": 1e-4}));
    assert!(of_means.len() == 1 && of_means[0].contains("by 6.500e-2"), "{of_means:?}");
    for [kind, method] in [["Q4", "mortar"], ["Q8", "mortar"], ["Q4", "node_to_segment"]] {
        assert_eq!(told(kind, method, json!({})), Vec::<String>::new());
    }
}

/// Elements that lock are told as their bodies flow: Cam-clay contracts unless it is heavily overconsolidated; an element alone does not lock.
#[test]
fn what_locks_is_told_by_how_it_flows() {
    let told = |elements: [usize; 2], start: Value| {
        let clay = common::with(
            json!({"model": "cam_clay", "lambda": 0.1, "kappa": 0.02, "M": 1.0, "nu": 0.3, "p_min": 1.0}),
            &start,
        );
        let model = common::model(&json!({
            "mesh": {"blocks": [{"body": "soil", "corners": [[0, 0], [1, 0], [1, 1], [0, 1]], "elements": elements,
                                 "sides": ["bottom", "right", "top", "left"]}]},
            "bodies": {"soil": {"material": clay, "initial_stress": {"components": {"xx": -100, "yy": -100, "zz": -100}}}},
            "steps": [{"name": "press", "duration": 1,
                       "supports": [{"on": "bottom", "uy": 0}, {"on": "top", "uy": -0.01}, {"on": "left", "ux": 0}, {"on": "right", "ux": 0}]}]
        }));
        model.warnings().into_iter().filter(|told| told.contains("limit loads")).collect::<Vec<_>>()
    };
    for wet in [json!({"OCR": 1}), json!({"p_c": 100}), json!({"p_c": 199})] {
        let said = told([2, 2], wet);
        assert!(said.len() == 1 && said[0].contains("up to a third") && !said[0].contains("dilates"), "{said:?}");
    }
    for dry in [json!({"OCR": 4}), json!({"p_c": 400})] {
        let said = told([2, 2], dry.clone());
        assert!(said.len() == 1 && said[0].contains("yields and dilates"), "{said:?}");
        assert_eq!(told([1, 1], dry), Vec::<String>::new());
    }
}
