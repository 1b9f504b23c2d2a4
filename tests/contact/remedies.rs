//! What a warning advises, followed: the warning goes, no other comes in its place, and the answer is nearer to the right one. And right runs
//! beside it, in which there is nothing to tell.

use std::sync::Arc;

use fecontact::model::state::State;
use fecontact::output::warnings::Warnings;
use serde_json::{Value, json};

use crate::common::{self, Finished};

/// All warnings of a run that ends as it should, before and after it.
fn told(case: &Value) -> Vec<String> {
    let (mut warnings, model) = (Warnings::default(), Arc::new(common::model(case)));
    fecontact::run::run(&model, &mut [&mut warnings]).1.unwrap_or_else(|error| panic!("{error}"));
    let all: Vec<String> = model.warnings().into_iter().chain(warnings.list).collect();
    for told in &all {
        assert!(common::warnings::is_listed(told), "docs/reference/warnings.md has no entry for: {told}");
    }
    all
}

fn has(told: &[String], words: &str) -> bool {
    told.iter().any(|told| told.contains(words))
}

fn elastic(model: &str) -> Value {
    json!({"material": {"model": model, "E": 1000, "nu": 0.25, "density": 0.01}})
}

fn rectangle(body: &str, [x, y]: [[f64; 2]; 2], elements: [usize; 2]) -> Value {
    let sides = ["bottom", "right", "top", "left"].map(|side| format!("{body}_{side}"));
    let corners = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
    json!({"body": body, "corners": corners, "elements": elements, "sides": sides})
}

/// A block of 4 × 2 on a rigid base.
fn block(master: &Value, model: &str, step: Value) -> Value {
    json!({
        "mesh": {"blocks": [rectangle("block", [[0.0, 4.0], [0.0, 2.0]], [8, 4])]},
        "bodies": {"block": elastic(model)},
        "contacts": {"base": {"slave": "block_bottom", "master": master, "friction": {"law": "coulomb", "mu": 0.3}}},
        "steps": [step]
    })
}

fn plane() -> Value {
    json!({"plane": {"point": [0, 0], "normal": [0, 1]}})
}

/// Two rings of straight or quadratic edges, of which the outer one is pressed on the inner one by a pressure of 1 on its outside; so many
/// edges along a quarter, and so far apart.
fn rings([inner, outer]: [usize; 2], kind: &str, apart: f64) -> Value {
    let ring = |body: &str, n: usize, [a, b]: [f64; 2]| {
        let sides = ["bottom", "outside", "top", "inside"].map(|side| format!("{body}_{side}"));
        json!({"body": body, "corners": [[a, 0], [b, 0], [0, b], [0, a]], "arcs": [null, [0, 0], null, [0, 0]], "elements": [3, n],
               "kind": kind, "sides": sides})
    };
    let hold = |on: &str, along: &str| json!({"on": on, along: 0});
    json!({
        "mesh": {"blocks": [ring("inner", inner, [1.0, 2.0 - apart]), ring("outer", outer, [2.0, 3.0])]},
        "bodies": {"inner": elastic("linear"), "outer": elastic("linear")},
        "contacts": {"fit": {"slave": "outer_inside", "master": "inner_outside", "friction": {"law": "frictionless"}}},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.05},
                   "supports": [hold("inner_bottom", "uy"), hold("outer_bottom", "uy"), hold("inner_top", "ux"), hold("outer_top", "ux")],
                   "loads": [{"on": "outer_outside", "pressure": 1}]}]
    })
}

/// By how much the outer ring moves inwards, at its outside on the x axis.
fn inwards(run: &Finished) -> f64 {
    let nodes = &run.model.mesh.nodes;
    let at = (0..nodes.len()).find(|&node| (nodes[node].x - 3.0).abs() + nodes[node].y.abs() < 1e-9);
    -run.last().displacement[2 * at.expect("a node on the axis")]
}

/// Chords of 16 edges on the bore leave 1.25e-3 to those of 12 on the shaft: of rings that touch along a circle the outer one moves further
/// inwards by a third, and of rings apart by 2e-3 by a fifth. By Lamé's solution with ν = 1/4, rings without a gap between them are one of
/// 1 ≤ r ≤ 3, u = (1 + ν)/E p b²/(b² − a²) ((1 − 2ν) b + a²/b) = 1.25e-3 · 9/8 · (3/2 + 1/3) = 2.578e-3 at its outside.
#[test]
fn edges_that_leave_a_gap_between_curves_are_told() {
    let words = "straight edges that approximate curves";
    let closed_form = 2.578e-3;
    let quadratic = common::finish(&rings([12, 16], "Q8", 0.0));
    common::close("quadratic edges", inwards(&quadratic), closed_form, 0.002 * closed_form);
    for apart in [0.0, 2e-3] {
        let right = inwards(&common::finish(&rings([12, 16], "Q8", apart)));
        let off = |elements| inwards(&common::finish(&rings(elements, "Q4", apart))) / right - 1.0;
        let coarse = told(&rings([12, 16], "Q4", apart));
        assert!(has(&coarse, words) && has(&coarse, "leave a gap of 1.24"), "{coarse:?}");
        assert!(off([12, 16]) > 0.15, "{}", off([12, 16]));
        for (elements, kind) in [([14, 14], "Q4"), ([48, 64], "Q4"), ([12, 16], "Q8")] {
            let better = told(&rings(elements, kind, apart));
            assert!(!has(&better, words), "{elements:?} {kind}: {better:?}");
        }
        assert!(off([14, 14]).abs() < 0.01 && off([48, 64]) < 0.025, "{} {}", off([14, 14]), off([48, 64]));
    }
    // Counted from where the surfaces are, as under any pressure, there is no gap.
    let mut case = rings([12, 16], "Q4", 0.0);
    case["contacts"]["fit"]["initial"] = json!({"pressure": 1e-9});
    assert!(!has(&told(&case), words));
    common::close("from where they are", inwards(&common::finish(&case)), closed_form, 0.01 * closed_form);
}

/// A load that is there at once does its work in one increment, whatever its length: that is told, and where it grows there is nothing to tell.
/// What comes little by little is told with shorter increments alone, and they end it.
#[test]
fn work_of_a_load_that_jumps_is_told_as_such() {
    let pulled = |load: Value, dt: f64| {
        let mut case = block(
            &plane(),
            "neo_hookean",
            json!({"name": "pull", "duration": 1, "dt": {"initial": dt},
                   "loads": [{"on": "block_left", "spring": {"kx": 50}}, {"on": "block_right", "total_force": {"x": load}}]}),
        );
        case["contacts"]["base"]["initial"] = json!({"pressure": 1, "traction": 0, "balanced": true});
        case["contacts"]["base"]["sliding"] = json!("small");
        told(&case)
    };
    for dt in [0.1, 0.02] {
        let at_once = pulled(json!("3"), dt);
        let words = format!(
            "the 100 % that arose in the increment to t = {dt} remain: where a load or support jumps, let it grow"
        );
        assert!(has(&at_once, "energy balance violated") && has(&at_once, &words), "{at_once:?}");
    }
    assert!(!has(&pulled(json!(3), 0.1), "energy balance"));

    let crushed = |dt: f64| {
        let step = json!({"name": "crush", "duration": 1, "dt": {"initial": dt}, "supports": [{"on": "block_top", "ux": 0, "uy": -0.8}]});
        told(&block(&plane(), "neo_hookean", step))
    };
    let coarse = crushed(0.25);
    assert!(has(&coarse, "in step `crush`: take shorter increments (dt.initial, dt.max)"), "{coarse:?}");
    assert!(!has(&coarse, "jumps"), "{coarse:?}");
    assert_eq!(crushed(0.05), Vec::<String>::new());
}

/// Energies of surfaces that close within static increments are told with shorter increments, which end it; where a load that is there at once
/// closes them, these do not, and it is to grow.
#[test]
fn energy_of_touch_is_told_with_what_ends_it() {
    let closed = |load: Value, dt: f64| {
        let spring = json!({"on": "block_top", "spring": {"kx": 1, "ky": 1}});
        let mut case = block(
            &json!({"plane": {"point": [0, -0.05], "normal": [0, 1]}}),
            "neo_hookean",
            json!({"name": "drop", "duration": 1, "dt": {"initial": dt}, "loads": [spring, {"on": "block_top", "total_force": {"y": load}}]}),
        );
        case["contacts"]["base"]["friction"] = json!({"law": "frictionless"});
        told(&case)
    };
    let touch = "surfaces close or part within increments";
    for dt in [0.1, 0.02] {
        let at_once = closed(json!("-2"), dt);
        let words = format!(
            "the 100 % that arose in the increment to t = {dt} remain: where a load or support jumps, let it grow"
        );
        assert!(has(&at_once, touch) && has(&at_once, &words) && !has(&at_once, "energy balance"), "{at_once:?}");
    }
    let coarse = closed(json!(-2), 0.1);
    assert!(
        has(&coarse, touch) && has(&coarse, "take shorter increments as they close (dt.initial, dt.max)"),
        "{coarse:?}"
    );
    assert_eq!(closed(json!(-2), 0.02), Vec::<String>::new());
}

/// A block closes in a static increment and is let go in a motion that loses energy: each is told for itself, and the motion by its own step.
/// Where a scheme that damps gains energy as surfaces close, nothing is said of damping, and shorter increments end it.
#[test]
fn energy_of_touch_does_not_hide_another() {
    let below = |y: f64| json!({"plane": {"point": [0, y], "normal": [0, 1]}});
    let touch = json!({"name": "touch", "duration": 1, "dt": {"initial": 0.5}, "supports": [{"on": "block_top", "ux": 0, "uy": -0.08}]});
    let mut case = block(&below(-0.05), "neo_hookean", touch);
    case["contacts"]["base"]["massless"] = json!(true);
    case["contacts"]["base"]["friction"] = json!({"law": "frictionless"});
    case["steps"].as_array_mut().expect("steps").push(json!({
        "name": "swing", "duration": 0.2, "scheme": {"newmark": {"gamma": 0.6, "beta": 0.3025}}, "dt": {"initial": 0.002},
        "supports": [{"on": "block_top", "uy": null}]}));
    let both = told(&case);
    assert!(
        has(&both, "mostly in step `swing`: the scheme damps frequencies") && has(&both, "surfaces close or part"),
        "{both:?}"
    );

    let fallen = |dt: Value| {
        let fall = json!({"name": "fall", "duration": 0.04, "scheme": {"generalized_alpha": {}}, "dt": dt});
        let mut case = block(&below(-0.02), "neo_hookean", fall);
        case["contacts"]["base"]["massless"] = json!(true);
        case["initial_velocity"] = json!({"block": [0, -1]});
        told(&case)
    };
    let gains = fallen(json!({"initial": 1e-3}));
    assert!(has(&gains, "spurious gain") && has(&gains, "or for surfaces that close or part within them"), "{gains:?}");
    assert!(!has(&gains, "damps"), "{gains:?}");
    assert!(!has(&fallen(json!({"initial": 1e-3, "error": 1e-5})), "energy balance"));
}

/// A belt of t/R = 0.0025 on a drum, held by a force at one end and pulled at the other: with the default α_t the run stops, and says how stiff it is
/// beside the bending of the belt; with the one advised it goes on, and the ratio of the forces at which it slides is exp(μ π), to what its bending
/// adds.
#[test]
fn a_stop_of_a_thin_belt_names_an_alpha_t_that_runs() {
    let belt = |alpha_t: Option<f64>| {
        let (inner, outer) = (10.0, 10.025);
        let part = |corners: Value, elements: [usize; 2], arcs: Value, sides: Value| json!({"body": "belt", "kind": "Q8", "corners": corners, "elements": elements, "arcs": arcs, "sides": sides});
        let arcs = json!([[0, 0], null, [0, 0], null]);
        let straight = json!([null, null, null, null]);
        let mut friction = json!({"law": "coulomb", "mu": 0.3});
        if let Some(alpha_t) = alpha_t {
            friction["alpha_t"] = json!(alpha_t);
        }
        json!({
            "mesh": {"blocks": [
                part(json!([[-inner, -10], [-inner, 0], [-outer, 0], [-outer, -10]]), [20, 1], straight.clone(), json!([null, null, null, "left"])),
                part(json!([[-inner, 0], [0, inner], [0, outer], [-outer, 0]]), [32, 1], arcs.clone(), json!(["inner", null, null, null])),
                part(json!([[0, inner], [inner, 0], [outer, 0], [0, outer]]), [32, 1], arcs, json!(["inner", null, null, null])),
                part(json!([[inner, 0], [inner, -10], [outer, -10], [outer, 0]]), [20, 1], straight, json!([null, "right", null, null]))]},
            "bodies": {"belt": {"material": {"model": "neo_hookean", "E": 1e4, "nu": 0.3}}},
            "contacts": {"drum": {"slave": "inner", "master": {"circle": {"centre": [0, 0], "radius": inner}}, "friction": friction}},
            "steps": [
                {"name": "tension", "duration": 1, "loads": [{"on": "left", "total_force": {"y": -0.0625}}],
                 "supports": [{"on": "right", "ux": 0, "uy": 0}, {"on": "left", "ux": 0}]},
                {"name": "pull", "duration": 0.2, "dt": {"initial": 0.02, "min": 5e-3}, "supports": [{"on": "right", "uy": -0.4}]}],
        })
    };
    let model = Arc::new(common::model(&belt(None)));
    let message = fecontact::run::run(&model, &mut []).1.expect_err("it goes round in circles").to_string();
    let words = "of contact `drum` is 24134 times the bending stiffness of a body behind it, which is 0.0219";
    assert!(message.contains(words), "{message}");
    let advised = message
        .split_once("lower it, to ")
        .and_then(|(_, rest)| rest.split_once(" say"))
        .map(|(value, _)| value.parse());
    let Some(Ok(advised)) = advised else { panic!("{message}") };
    let run = common::finish(&belt(Some(advised)));
    let pulled = run.reaction("right", run.last())[1];
    common::close("T₂/T₁", -pulled / 0.0625, (0.3 * std::f64::consts::PI).exp(), 0.05);
}

/// A fluid that is in a part of a fault from the very start counts as there before the run, whether one point or more of them have it; one
/// that comes there is told no more, nor one that fades out along the surface. It slips sixteen times as far then.
#[test]
fn a_fluid_that_is_in_a_zone_at_once_is_told() {
    let fault = |fluid: &str, method: &str| {
        json!({
            "mesh": {"blocks": [rectangle("lower", [[-4.0, 4.0], [-2.0, 0.0]], [32, 6]), rectangle("upper", [[-4.0, 4.0], [0.0, 2.0]], [32, 6])]},
            "bodies": {"lower": elastic("linear"), "upper": elastic("linear")},
            "contacts": {"fault": {
                "slave": "upper_bottom", "master": "lower_top", "method": method, "sliding": "small", "fluid_pressure": fluid,
                "friction": {"law": "coulomb", "mu": 0.6}, "initial": {"pressure": 2, "traction": 1, "balanced": true}}},
            "steps": [{"name": "inject", "duration": 1, "dt": {"initial": 0.1},
                       "supports": [{"on": "lower_bottom", "ux": 0, "uy": 0}, {"on": "upper_top", "ux": 0, "uy": 0}]}]
        })
    };
    let zone = "1.2*erfc(max(0, abs(x) - 0.3)/(2*sqrt(0.1*t + 1e-12)))";
    let from_zero = "1.2*erfc((max(0, abs(x) - 0.3) + 1e-9)/(2*sqrt(0.1*t + 1e-30)))";
    let fading = "1.2*max(0, 1 - abs(x)/0.6) + 0.5*t";
    for method in ["node_to_segment", "gauss_to_segment"] {
        let is_told = |fluid: &str| has(&common::model(&fault(fluid, method)).warnings(), "and none next to it");
        assert_eq!([zone, from_zero, fading, "0.5 + 0.5*t"].map(is_told), [true, false, false, false], "{method}");
    }
    let slip = |fluid: &str| {
        let run = common::finish(&fault(fluid, "node_to_segment"));
        run.last().contacts[0].iter().map(|point| point.friction.plastic_slip.abs()).sum::<f64>()
    };
    assert!(slip(from_zero) > 10.0 * slip(zone));
}

/// Of explicit increments only rows of the history are seen: a block that has bounced between them is not said never to have touched.
#[test]
fn a_bounce_between_rows_is_not_denied() {
    let mut case = block(
        &json!({"plane": {"point": [0, -0.05], "normal": [0, 1]}}),
        "neo_hookean",
        json!({"name": "fall", "duration": 0.4, "dt": {"initial": 0.01}, "scheme": {"explicit": {"safety": 0.2}}}),
    );
    case["initial_velocity"] = json!({"block": [0, -1]});
    case["contacts"]["base"]["normal"] = json!({"alpha_n": 4e6});
    let run = common::finish(&case);
    let upwards = |state: &State| state.velocity.iter().skip(1).step_by(2).sum::<f64>();
    let [before, after] = [&run.states[0], run.last()].map(upwards);
    assert!(before < 0.0 && after > 0.0, "it bounces: {before} {after}");
    let told = told(&case);
    assert!(told.iter().all(|told| !told.contains("has never closed:")), "{told:?}");
    assert!(has(&told, "has never closed at any row of the history (output.interval)"), "{told:?}");
}

/// Times of output before a step that may end early are as sure as any; lines that a slave looks at from their solid are to be turned; and of
/// two sides the one with fluid in its pores is to be the slave.
#[test]
fn what_is_told_before_the_run_says_what_helps() {
    let press = |y: f64, until: Value| {
        json!({"name": format!("to {y}"), "duration": 1, "dt": {"initial": 0.25},
        "supports": [{"on": "block_top", "ux": 0, "uy": y}], "until": until})
    };
    let mut case = block(&plane(), "linear", press(-0.002, json!(null)));
    case["steps"].as_array_mut().expect("steps").push(press(-0.004, json!({"on": "block_top", "fy": -6})));
    for (time, is_told) in [(0.5, false), (1.0, false), (1.5, true)] {
        case["output"] = json!({"times": [time]});
        assert_eq!(has(&common::model(&case).warnings(), "may end early"), is_told, "{time}");
    }
    let line = |points: Value| {
        common::model(&block(&json!({"polyline": {"points": points}}), "linear", press(-0.002, json!(null)))).warnings()
    };
    assert!(has(&line(json!([[5, 0], [-1, 0]])), "and that the solid is on the right of the lines"));
    assert_eq!(line(json!([[-1, 0], [5, 0]])), Vec::<String>::new());

    let mut wet = json!({
        "mesh": {"blocks": [rectangle("ground", [[0.0, 8.0], [-2.0, 0.0]], [8, 4]), rectangle("block", [[2.0, 6.0], [0.0, 2.0]], [8, 4])]},
        "bodies": {"ground": elastic("linear"), "block": elastic("linear")},
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "friction": {"law": "coulomb", "mu": 0.3}}},
        "steps": [press(-0.002, json!(null))]
    });
    wet["bodies"]["ground"]["pore_fluid"] = json!({"bulk_modulus": 2e5, "porosity": 0.4});
    wet["bodies"]["ground"]["element"] = json!("f_bar");
    let words = "carried by the fluid in the pores of body `ground`: make it the slave and take that part from the pores of the slave";
    assert!(has(&common::model(&wet).warnings(), words));
    let base = &mut wet["contacts"]["base"];
    (base["slave"], base["master"], base["fluid_pressure"]) =
        (json!("ground_top"), json!("block_bottom"), json!("of_bodies"));
    assert_eq!(common::model(&wet).warnings(), Vec::<String>::new());
}

/// Under rate-and-state friction strength grows with the slip rate by a/Δλ and falls with slip by b/D_c at most: up to Δλ = D_c a/b an increment
/// has one response, however soft the contact. A stiff block that creeps at the rate of its top, in increments whose slip is controlled, is not
/// told of several, and slips all the way; one in increments of 10 D_c is.
#[test]
fn creep_in_short_increments_has_one_response() {
    let crept = |dt: Value| {
        let step = json!({"name": "creep", "duration": 10, "dt": dt, "supports": [{"on": "block_top", "ux": {"rate": 1e-3}, "uy": 0}]});
        let mut case = block(&plane(), "linear", step);
        let contact = &mut case["contacts"]["base"];
        contact["friction"] = json!({"law": "rate_and_state", "f_0": 0.6, "a": 0.015, "b": 0.01, "D_c": 1e-4, "V_0": 1e-3, "alpha_t": 200});
        contact["initial"] = json!({"pressure": 5, "traction": 3, "balanced": true});
        contact["sliding"] = json!("small");
        let run = common::finish(&case);
        let slips: Vec<f64> = run.last().contacts[0].iter().map(|point| point.friction.plastic_slip.abs()).collect();
        (slips.iter().sum::<f64>() / slips.len() as f64, has(&told(&case), "the response is not unique"))
    };
    let (slip, is_told) = crept(json!({"initial": 0.05}));
    common::close("slip at the rate of the top", slip, 1e-2, 1e-4);
    assert!(!is_told);
    assert!(crept(json!({"initial": 1, "error": null})).1);
}

/// A slope finds its stress in a first static step: the advice is to let it. Before a motion it is a step before.
#[test]
fn what_may_settle_is_told_where() {
    let slope = |scheme: Value| {
        let mut block = rectangle("soil", [[0.0, 10.0], [-10.0, 0.0]], [5, 5]);
        block["corners"][2] = json!([5, 0]);
        let material = json!({"model": "linear", "E": 5000, "nu": 0.3, "density": 1});
        common::model(&json!({
            "mesh": {"blocks": [block]},
            "bodies": {"soil": {"material": material, "initial_stress": {"geostatic": {"surface": 0, "weight": 18, "K0": 0.5}}}},
            "steps": [{"name": "rest", "duration": 1, "scheme": scheme, "loads": [{"on": "soil", "gravity": {"y": "-18"}}],
                       "supports": [{"on": "soil_bottom", "ux": 0, "uy": 0}, {"on": "soil_left", "ux": 0}]}]
        }))
        .warnings()
    };
    let [first, moving] = [json!("static"), json!({"newmark": {}})].map(slope);
    assert!(
        first[0].ends_with("or let it settle in step `rest`, at the end of which displacements begin to count"),
        "{first:?}"
    );
    assert!(moving[0].ends_with("or let it settle in a static step before"), "{moving:?}");
}
