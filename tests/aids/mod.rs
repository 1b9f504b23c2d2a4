//! The aids of the contact iteration.

use std::path::Path;

use fecontact::case;
use fecontact::model::Model;
use fecontact::model::aids::Aids;
use fecontact::run::run;
use serde_json::{Value, json};

use crate::common::{Blocks, Record};

type Case = (&'static str, fn() -> Model);

fn build(case: &Value, path: &Path) -> Model {
    let parsed = serde_json::from_value(case.clone()).unwrap_or_else(|error| panic!("{error}"));
    case::build(&parsed, path).unwrap_or_else(|error| panic!("{error}"))
}

fn committed(name: &str, change: impl Fn(&mut Value)) -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("cases/{name}.json"));
    let mut case: Value = serde_json::from_str(&std::fs::read_to_string(&path).expect("a case")).expect("JSON");
    change(&mut case);
    build(&case, &path)
}

fn as_it_is(_: &mut Value) {}

/// Shorten step `k` to a share.
fn shorten(case: &mut Value, k: usize, share: f64) {
    let duration = case["steps"][k]["duration"].as_f64().expect("a duration");
    case["steps"][k]["duration"] = json!(share * duration);
    for support in case["steps"][k]["supports"].as_array_mut().expect("supports") {
        for u in ["ux", "uy"] {
            if let Some(value) = support[u].as_f64() {
                support[u] = json!(share * value);
            }
        }
    }
}

fn stiff(name: &str, change: impl Fn(&mut Value)) -> Model {
    let base = committed(name, &change);
    let pair = &base.contacts[0];
    let (normal, tangential) = (100.0 * pair.alpha_n, 100.0 * pair.laws[0].stiffness());
    committed(name, |case| {
        change(case);
        let contact = &mut case["contacts"]["base"];
        contact["normal"]["alpha_n"] = json!(normal);
        if tangential > 0.0 {
            contact["friction"]["alpha_t"] = json!(tangential);
        }
    })
}

fn first_tenth(case: &mut Value) {
    shorten(case, 1, 0.1);
}

fn augmented(case: &mut Value, penetration: f64) {
    case["contacts"]["base"]["normal"]["penetration"] = json!(penetration);
}

fn slotted_ring() -> Model {
    use std::f64::consts::PI;
    let [across, around] = [4, 48];
    let map = |s: f64, t: f64| {
        let radius = 1.0 + 0.3 * s.powf(1.0 + 0.3 * t);
        let angle = (2.0 * t - 1.0) * (PI - (0.05 / radius).asin());
        [radius * angle.cos(), radius * angle.sin()]
    };
    let mut mesh = Blocks::default().block("ring", [across, around], map).json();
    let joined = |sides: &[&str]| -> Value {
        sides.iter().flat_map(|side| mesh["edges"][format!("ring_{side}")].as_array().expect("edges").clone()).collect()
    };
    mesh["edges"]["lips"] = joined(&["bottom", "top"]);
    let outside = |quarter: usize| quarter * around / 4 * (across + 1) + across;
    mesh["points"] = json!({"south": [outside(1)], "north": [outside(3)]});
    build(&json!({
        "mesh": mesh,
        "bodies": {"ring": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}}},
        "contacts": {"lips": {"slave": "lips", "master": "lips", "friction": {"law": "coulomb", "mu": 0.2}}},
        "steps": [{"name": "squeeze", "duration": 1, "dt": {"initial": 0.1}, "supports": [
            {"on": "north", "ux": 0, "uy": -0.042}, {"on": "south", "ux": 0, "uy": 0.042}]}],
    }), Path::new("ring.json"))
}

/// A slab, pressed and sheared at once from a gap.
fn slab(gap: f64, dt: f64, m: usize, alpha: f64, mu: f64) -> Model {
    build(&json!({
        "mesh": Blocks::default().rectangle("slab", [2 * m, m], [0.0, gap], [1.0, gap + 0.5]).json(),
        "bodies": {"slab": {"material": {"model": "linear", "E": 1000.0, "nu": 0.3}}},
        "contacts": {"base": {"slave": "slab_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                              "normal": {"alpha_n": alpha}, "friction": {"law": "coulomb", "mu": mu, "alpha_t": alpha}}},
        "steps": [{"name": "in", "duration": 1, "dt": {"initial": dt, "max": dt},
                   "supports": [{"on": "slab_top", "ux": 0.01, "uy": -0.005 - gap}]}],
    }), Path::new("slab.json"))
}

/// Slabs of many kinds, pressed and sheared from touch: all their counts together.
fn ridge(slope: f64, mu: f64) -> Model {
    let top = |x: f64| slope * x.abs();
    let block = |s: f64| -0.75 + 0.3 * s;
    build(&json!({
        "mesh": Blocks::default()
            .block("ground", [20, 3], |s, t| [2.0 * s - 1.0, -0.5 + t * (0.5 + top(2.0 * s - 1.0))])
            .block("block", [5, 3], |s, t| [block(s), top(block(s)) + 0.2 * t]).json(),
        "bodies": {
            "ground": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}},
            "block": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}},
        },
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "friction": {"law": "coulomb", "mu": mu}}},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.25},
             "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0}],
             "loads": [{"on": "block_top", "traction": {"y": -5}}]},
            {"name": "push", "duration": 1, "dt": {"initial": 0.02, "min": 1e-7}, "supports": [{"on": "block_top", "ux": 1.2}]},
        ],
    }), Path::new("ridge.json"))
}

/// A softer block pushed by its top over a faceted ridge.
fn faceted(height: f64, method: &str, mu: f64) -> Model {
    let top = |x: f64| -height * x.abs();
    let block = |s: f64| -0.75 + 0.5 * s;
    build(&json!({
        "mesh": Blocks::default()
            .block("ground", [20, 3], |s, t| [2.0 * s - 1.0, -0.5 + t * (0.5 + top(2.0 * s - 1.0))])
            .block("block", [7, 4], |s, t| [block(s), top(block(s)) * (1.0 - t) + 0.4 * t]).json(),
        "bodies": {
            "ground": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}},
            "block": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}},
        },
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "method": method, "friction": {"law": "coulomb", "mu": mu}}},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.25},
             "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.04}]},
            {"name": "push", "duration": 1, "dt": {"initial": 0.05, "min": 1e-5}, "supports": [{"on": "block_top", "ux": 1}]},
        ],
    }), Path::new("faceted.json"))
}

fn struck_bar(massless: bool, error: Option<f64>) -> Model {
    let h = 0.01;
    let mut dt = json!({"initial": h});
    if let Some(error) = error {
        dt["error"] = json!(error);
        dt["min"] = json!(1e-6);
    }
    build(&json!({
        "mesh": Blocks::default().rectangle("bar", [100, 1], [0.0, 0.0], [1.0, 0.02]).json(),
        "bodies": {"bar": {"material": {"model": "neo_hookean", "E": 1, "nu": 0, "density": 1}}},
        "contacts": {"wall": {"slave": "bar_left", "master": {"plane": {"point": [0, 0], "normal": [1, 0]}},
                              "massless": massless, "normal": {"alpha_n": 10.0 / h}, "friction": {"law": "frictionless"}}},
        "initial_velocity": {"bar": [-1e-3, 0]},
        "steps": [{"name": "hit", "duration": 2.5, "dt": dt, "scheme": {"newmark": {}}, "supports": [{"on": "bar", "uy": 0}]}],
    }), Path::new("bar.json"))
}

/// A slab thrown obliquely on a rough rigid plane.
fn thrown(alpha: f64) -> Model {
    build(&json!({
        "mesh": Blocks::default().rectangle("slab", [16, 8], [0.0, 0.001], [1.0, 0.501]).json(),
        "bodies": {"slab": {"material": {"model": "neo_hookean", "E": 1, "nu": 0.3, "density": 1}}},
        "contacts": {"floor": {"slave": "slab_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                              "massless": true, "normal": {"alpha_n": alpha}, "friction": {"law": "coulomb", "mu": 0.3}}},
        "initial_velocity": {"slab": [0.05, -0.05]},
        "steps": [{"name": "hit", "duration": 3, "dt": {"initial": 0.02}, "scheme": {"hht": {"alpha": -0.1}}}],
    }), Path::new("thrown.json"))
}

fn shrink_fit() -> Model {
    build(&json!({
        "mesh": Blocks::default().ring("inner", [80, 4], [0.5, 1.001]).ring("outer", [94, 4], [1.0, 1.5]).json(),
        "bodies": {"inner": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}}, "outer": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}}},
        "contacts": {"fit": {"slave": "inner_outside", "master": "outer_inside", "shrink_fit": true, "friction": {"law": "coulomb", "mu": 0.2}}},
        "steps": [{"name": "fit", "duration": 1, "dt": {"initial": 0.25}, "supports": [{"on": "outer_outside", "ux": 0, "uy": 0}]}],
    }), Path::new("fit.json"))
}

const CASES: &[Case] = &[
    ("coulomb_drag_5k", || committed("coulomb_drag_5k", as_it_is)),
    ("coulomb_drag_20k", || committed("coulomb_drag_20k", as_it_is)),
    ("block_on_ground", || committed("block_on_ground", |case| shorten(case, 1, 0.4))),
    ("hertz_q4", || committed("validation/hertz_q4", as_it_is)),
    ("hertz_q8_friction", || committed("validation/hertz_q8_friction", as_it_is)),
    ("mindlin", || committed("validation/mindlin", as_it_is)),
    ("mindlin_healing", || committed("validation/mindlin_healing", as_it_is)),
    ("greco", || committed("validation/greco", as_it_is)),
    ("wedge", || committed("validation/wedge", as_it_is)),
    ("ironing_q4", || committed("validation/ironing_q4", first_tenth)),
    ("ironing_q8", || committed("validation/ironing_q8", first_tenth)),
    ("slotted_ring", slotted_ring),
    ("tube", || committed("tube", as_it_is)),
    ("struck_bar", || struck_bar(true, None)),
    ("struck_bar_mass", || struck_bar(false, None)),
    ("struck_bar_error", || struck_bar(true, Some(1e-6))),
    ("thrown", || thrown(1e3)),
    ("thrown_stiff", || thrown(1e5)),
    ("slab_touch_1", || slab(0.0, 1.0, 4, 1e6, 5.0)),
    ("slab_touch_.1", || slab(0.0, 0.1, 8, 1e6, 0.5)),
    ("slab_touch_.25", || slab(0.0, 0.25, 8, 1e5, 0.3)),
    ("slab_gap_1", || slab(0.001, 1.0, 8, 1e6, 5.0)),
    ("slab_gap_.1", || slab(0.001, 0.1, 8, 1e6, 0.5)),
    ("ridge", || ridge(-0.1, 0.2)),
    ("valley", || ridge(0.1, 0.2)),
    ("valley_rough", || ridge(0.1, 0.5)),
    ("valley_smooth", || ridge(0.2, 0.0)),
    ("faceted_g2s", || faceted(0.1, "gauss_to_segment", 0.3)),
    ("faceted_n2s", || faceted(0.1, "node_to_segment", 0.3)),
    ("faceted_n2s_.2", || faceted(0.2, "node_to_segment", 0.3)),
    ("hollow_g2s", || faceted(-0.1, "gauss_to_segment", 0.3)),
    ("hollow_n2s", || faceted(-0.2, "node_to_segment", 0.1)),
    ("shrink_fit", shrink_fit),
    ("stiff greco", || stiff("validation/greco", as_it_is)),
    ("stiff hertz_q8_friction", || stiff("validation/hertz_q8_friction", as_it_is)),
    ("stiff mindlin", || stiff("validation/mindlin", as_it_is)),
    ("stiff ironing_q4", || stiff("validation/ironing_q4", first_tenth)),
    ("stiff drag_5k", || stiff("coulomb_drag_5k", as_it_is)),
    ("augmented greco", || committed("validation/greco", |case| augmented(case, 1e-7))),
    ("augmented soft greco", || committed("validation/greco", |case| {
        case["contacts"]["base"]["normal"]["alpha_n"] = json!(1e5);
        augmented(case, 1e-7);
    })),
    ("augmented ironing_q4", || committed("validation/ironing_q4", |case| { shorten(case, 1, 0.03); augmented(case, 1e-5) })),
];

type Switch = (&'static str, fn(&mut Aids));

const SWITCHES: &[Switch] = &[
    ("stiffness", |aids| aids.stiffness = false),
    ("closure", |aids| aids.closure = false),
    ("pull", |aids| aids.pull = false),
    ("growth", |aids| aids.growth = false),
    ("carried", |aids| aids.carried = false),
    ("touch", |aids| aids.touch = false),
    ("stick", |aids| aids.stick = false),
    ("again", |aids| aids.again = false),
    ("valley", |aids| aids.valley = false),
    ("cycle", |aids| aids.cycle = false),
    ("old_tangents", |aids| aids.old_tangents = false),
    ("parts", |aids| aids.parts = false),
    ("start", |aids| aids.start = false),
    ("stiffening", |aids| aids.stiffening = false),
];

fn counts(model: &Model) -> String {
    let mut record = Record::default();
    let (report, result) = run(model, &mut [&mut record]);
    let stop = result.map_or_else(|e| format!(" STOP {e}"), |_| String::new());
    format!("{} {} {} {} {}{stop}", report.newton_iterations, report.factorizations, report.increments, report.cutbacks, report.rejected)
}

#[test]
#[ignore = "minutes"]
fn ablation() {
    let wanted = std::env::var("CASES").unwrap_or_default();
    for (name, case) in CASES.iter().filter(|(name, _)| wanted.is_empty() || wanted.split(',').any(|w| *name == w)) {
        let mut model = case();
        println!("{name}: {}", counts(&model));
        for (aid, off) in SWITCHES {
            model.aids = Aids::default();
            off(&mut model.aids);
            println!("{name}\t{aid}\t{}", counts(&model));
        }
    }
}
