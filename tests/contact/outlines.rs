//! Whole outlines as surfaces of contacts, and surfaces that start closed where they do not touch.

use serde_json::{Value, json};

use crate::common::{self, Finished, close, finish};

const METHODS: [&str; 3] = ["node_to_segment", "gauss_to_segment", "mortar"];

/// A block on a block, held at corners and pressed by 0.02: with all their sides in contact, or those that face each other.
fn blocks(low: [usize; 2], up: [usize; 2], method: &str, whole: bool) -> Value {
    let sides = |name: &str, facing: usize| -> Vec<Option<String>> {
        (0..4).map(|side| (whole || side == facing).then(|| name.to_string())).collect()
    };
    json!({
        "mesh": {"blocks": [
            {"body": "low", "corners": [[0, 0], [2, 0], [2, 1], [0, 1]], "elements": low, "sides": sides("low_s", 2)},
            {"body": "up", "corners": [[0, 1], [2, 1], [2, 2], [0, 2]], "elements": up, "sides": sides("up_s", 0)}]},
        "bodies": {"low": {"material": {"model": "neo_hookean", "E": 100, "nu": 0}},
                   "up": {"material": {"model": "neo_hookean", "E": 100, "nu": 0}}},
        "contacts": {"c": {"slave": "up_s", "master": "low_s", "friction": {"law": "frictionless"}, "method": method}},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.25}, "supports": [
            {"on": {"near": [0, 0]}, "ux": 0, "uy": 0}, {"on": {"near": [2, 0]}, "uy": 0},
            {"on": {"near": [0, 2]}, "ux": 0, "uy": -0.02}, {"on": {"near": [2, 2]}, "ux": 0, "uy": -0.02}]}],
    })
}

/// Σ p ℓ of the only contact.
fn normal_force(run: &Finished) -> f64 {
    run.last().contacts[0].iter().map(|state| state.friction.pressure * state.length).sum()
}

/// The sides that do not face each other add nothing, by any method: neither the far sides, two blocks apart, of blocks with few edges as
/// well, nor the flanks beside the corners, which lean as the blocks bulge.
#[test]
fn whole_outlines_press_where_they_face() {
    for method in METHODS {
        for [low, up] in [[[6, 3], [8, 4]], [[2, 2], [1, 1]], [[3, 1], [2, 2]]] {
            let [whole, facing] = [true, false].map(|whole| blocks(low, up, method, whole));
            assert_eq!(overlapping(&whole), Vec::<String>::new(), "{method}");
            let [whole, facing] = [whole, facing].map(|case| normal_force(&finish(&case)));
            let tolerance = match method {
                // The node at a corner has a part of the side as well, and a normal between the two.
                "node_to_segment" => 0.03,
                // The penalty, soft there, goes by the mean depth behind the edges of the group.
                "gauss_to_segment" => 0.01,
                _ => 1e-3,
            };
            close(&format!("{method}, {up:?} on {low:?}"), whole, facing, tolerance * facing);
        }
    }
    close("mortar", normal_force(&finish(&blocks([6, 3], [8, 4], "mortar", true))), 0.4669, 5e-5);
}

fn overlapping(case: &Value) -> Vec<String> {
    common::model(case).warnings().into_iter().filter(|message| message.contains("overlap")).collect()
}

/// Disks that are apart do not overlap, whatever their outlines face.
#[test]
fn outlines_of_disks_that_are_apart_face_from_outside() {
    let quarter = |[x, y]: [f64; 2], turn: usize, name: &str| {
        let at = |r: f64, k: usize| {
            let [c, s] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][(turn + k) % 4];
            [x + r * c, y + r * s]
        };
        json!({"body": name, "kind": "Q8", "corners": [at(0.4, 0), at(1.0, 0), at(1.0, 1), at(0.4, 1)], "elements": [5, 6],
               "arcs": [null, [x, y], null, null], "sides": [null, format!("{name}_skin"), null, null]})
    };
    let core = |[x, y]: [f64; 2], name: &str| json!({"body": name, "kind": "Q8", "corners": [[x, y - 0.4], [x + 0.4, y], [x, y + 0.4], [x - 0.4, y]], "elements": [6, 6]});
    let places = [([-1.05, 0.3], "a"), ([1.05, -0.3], "b")];
    let disk = |&(at, name): &([f64; 2], &str)| -> Vec<Value> {
        (0..4).map(|turn| quarter(at, turn, name)).chain([core(at, name)]).collect()
    };
    for method in METHODS {
        let case = json!({
            "mesh": {"blocks": places.iter().flat_map(disk).collect::<Vec<_>>()},
            "bodies": {"a": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 1}},
                       "b": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 1}}},
            "contacts": {"c": {"slave": "b_skin", "master": "a_skin", "friction": {"law": "frictionless"}, "method": method}},
            "initial_velocity": {"a": [0.9, 0], "b": [-0.9, 0]},
            "steps": [{"name": "fly", "duration": 0.05, "dt": {"initial": 0.05}, "scheme": {"newmark": {}}}],
        });
        let model = common::model(&case);
        let gaps = model.initial_state().contacts[0].iter().map(|state| state.gap).fold(f64::INFINITY, f64::min);
        assert!(gaps >= 0.0, "{method}: {gaps}");
        assert_eq!(overlapping(&case), Vec::<String>::new(), "{method}");
    }
}

/// A block on a pedestal, whose floor, farther down, belongs to the master as well: the floor holds no mean open beside the edge of the
/// pedestal.
#[test]
fn what_lies_far_below_an_edge_holds_nothing_open() {
    let force = |floor: Option<&str>| {
        let case = json!({
            "mesh": {"blocks": [
                {"body": "floor", "corners": [[-1, -1], [3, -1], [3, 0], [-1, 0]], "elements": [8, 2], "sides": [null, null, floor, null]},
                {"body": "pedestal", "corners": [[0, 0], [1, 0], [1, 0.4], [0, 0.4]], "elements": [2, 1], "sides": [null, null, "base", null]},
                {"body": "up", "corners": [[-0.5, 0.4], [1.5, 0.4], [1.5, 1.4], [-0.5, 1.4]], "elements": [7, 4],
                 "sides": ["bottom", null, "held", null]}]},
            "bodies": {"floor": {"material": {"model": "linear", "E": 1000, "nu": 0.3}},
                       "pedestal": {"material": {"model": "linear", "E": 1000, "nu": 0.3}},
                       "up": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}}},
            "contacts": {"c": {"slave": "bottom", "master": "base", "friction": {"law": "frictionless"}, "method": "mortar"}},
            "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.5}, "supports": [
                {"on": "floor", "ux": 0, "uy": 0}, {"on": "pedestal", "ux": 0, "uy": 0}, {"on": "held", "ux": 0, "uy": -0.02}]}],
        });
        normal_force(&finish(&case))
    };
    let [with, without] = [force(Some("base")), force(None)];
    close("with the floor", with, without, 1e-9 * without);
    assert!(without > 1.0, "{without}");
}

/// A cylinder of radius 25 that overlaps a block by 1e-5 at its lowest point, in halves: by Hertz p₀ = √(P E*/(π R)) = 118.3 under P = 10
/// with E* = E/(2 (1 − ν²)), a = 0.0538. Without a pressure it starts without the overlap, and as round as it is: p₀ in the middle.
#[test]
fn closing_an_overlap_leaves_a_cylinder_round() {
    let case = |initial: Value| {
        json!({
            "mesh": {"blocks": [
                {"body": "cylinder", "corners": [[0, -1e-5], [17.677669529663685, 7.322320470336312], [17.677669529663685, 24.99999], [0, 24.99999]],
                 "elements": [48, 48], "grading": [400, 400], "arcs": [[0, 24.99999], null, null, null],
                 "sides": ["skin", null, "top", "middle"]},
                {"body": "plate", "corners": [[0, 0], [100, 0], [100, -40], [0, -40]], "elements": [48, 48], "grading": [1600, 400],
                 "sides": ["surface", null, "bottom", "below"]}]},
            "bodies": {"cylinder": {"material": {"model": "linear", "E": 2e5, "nu": 0.3}},
                       "plate": {"material": {"model": "linear", "E": 2e5, "nu": 0.3}}},
            "contacts": {"c": {"slave": "skin", "master": "surface", "friction": {"law": "frictionless"}, "method": "mortar", "initial": initial}},
            "plates": ["top"],
            "steps": [{"name": "press", "duration": 1,
                       "supports": [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "middle", "ux": 0}, {"on": "below", "ux": 0}],
                       "loads": [{"on": "top", "total_force": {"y": -5}}]}],
        })
    };
    let message = overlapping(&case(Value::Null));
    assert!(message.len() == 1 && message[0].contains("\"initial\": {\"pressure\": 0}"), "{message:?}");
    let closed = case(json!({"pressure": 0}));
    assert_eq!(overlapping(&closed), Vec::<String>::new());
    let run = finish(&closed);
    let states = &run.last().contacts[0];
    let length: f64 = states.iter().filter(|state| state.is_closed()).map(|state| state.length).sum();
    close("p0", states[0].friction.pressure, 118.3, 3.0);
    close("a", length, 0.0538, 0.005);
}

/// A gap that a pressure is said to act across is told; where no pressure acts it stays, and an overlap deeper than a tenth of an edge is not
/// sent there.
#[test]
fn a_pressure_across_a_gap_is_reported() {
    let case = |at: f64, initial: Value| {
        json!({
            "mesh": {"blocks": [
                {"body": "low", "corners": [[0, 0], [1, 0], [1, 1], [0, 1]], "elements": [2, 2], "sides": [null, null, "low_top", null]},
                {"body": "up", "corners": [[0, at], [1, at], [1, 3], [0, 3]], "elements": [3, 3], "sides": ["up_bottom", null, null, null]}]},
            "bodies": {"low": {"material": {"model": "linear", "E": 100, "nu": 0}}, "up": {"material": {"model": "linear", "E": 100, "nu": 0}}},
            "contacts": {"c": {"slave": "up_bottom", "master": "low_top", "friction": {"law": "frictionless"}, "method": "mortar",
                               "initial": initial}},
            "steps": [{"name": "rest", "duration": 1, "supports": [{"on": "low", "ux": 0, "uy": 0}, {"on": "up", "ux": 0, "uy": 0}]}],
        })
    };
    let message = |at: f64, initial: Value| common::model(&case(at, initial)).warnings();
    let across = message(1.05, json!({"pressure": 3}));
    assert!(across.len() == 1 && across[0].contains("closes a gap of 0.05 at"), "{across:?}");
    assert!(common::warnings::is_listed(&across[0]), "{across:?}");
    assert_eq!(message(1.03, json!({"pressure": 3})), Vec::<String>::new());
    let open = common::model(&case(1.05, json!({"pressure": 0})));
    assert_eq!(open.warnings(), Vec::<String>::new());
    open.initial_state().contacts[0].iter().for_each(|state| close("gap", state.gap, 0.05 - 1e-6 / 3.0, 1e-12));
    let [small, large] = [0.99, 0.9].map(|at| message(at, Value::Null));
    assert!(small.len() == 1 && small[0].contains("\"pressure\": 0"), "{small:?}");
    assert!(
        large.len() == 1 && large[0].contains("overlap by up to 0.1") && !large[0].contains("\"pressure\": 0"),
        "{large:?}"
    );
}
