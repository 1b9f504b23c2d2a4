//! Surfaces that are tied: uniform stress passes between any elements, pulled and turned; what they hold, and what is refused.

use fecontact::contact::force::ContactState;
use fecontact::laws::friction::Regime;
use fecontact::mesh::configuration::Configuration;
use nalgebra::Vector2;
use serde_json::{Value, json};

use super::small_sliding::answer;
use crate::common::{self, Blocks, Finished, close, finish, half_way, quadratic, refusal};

/// A column of two blocks whose nodes do not face each other, the upper one of n[1] elements along a slanted interface.
fn column(n: [usize; 2], refined: bool) -> Value {
    let interface = |s: f64| 1.0 + 0.2 * (s - 0.5);
    let mesh = Blocks::default()
        .block("lower", [n[0], 4], |s, t| [s, t * interface(s)])
        .block("upper", [n[1], 3], |s, t| [s, interface(s) + t * (2.0 - interface(s))])
        .json();
    if refined { quadratic(&mesh, half_way) } else { mesh }
}

fn tied(mesh: &Value, model: &str, contact: &Value, steps: Value) -> Value {
    let body = json!({"material": {"model": model, "E": 1000, "nu": 0.3, "density": 1}});
    let mut contact = contact.clone();
    let more = json!({"slave": "upper_bottom", "master": "lower_top", "tied": true});
    contact.as_object_mut().expect("keys").extend(more.as_object().expect("keys").clone());
    json!({"mesh": mesh, "bodies": {"lower": body, "upper": body}, "contacts": {"tie": contact},
           "newton": {"tolerance": 1e-12}, "steps": steps})
}

/// The stress of all quadrature points against σ along y, as a share of it.
fn error_of_stress(run: &Finished, sigma: f64) -> f64 {
    let (model, u) = (&run.model, &run.last().displacement);
    let mut worst = 0.0f64;
    for (e, element) in model.mesh.elements.iter().enumerate() {
        let u: Vec<_> = element.nodes.iter().map(|&node| Vector2::new(u[2 * node], u[2 * node + 1])).collect();
        let material = &*model.bodies[model.body_of_element[e]].material;
        for stress in model.solids[e].stresses(material, &[], &u).expect("stresses") {
            worst = worst.max((stress.yy - sigma).abs()).max(stress.xx.abs()).max(stress.xy.abs());
        }
    }
    if sigma == 0.0 { worst } else { worst / sigma }
}

/// The patch test, in tension: σ to round-off in every element, Q4 and Q8, at small strain and at a stretch of a tenth, where
/// the nodes of neither side face nodes. (A contact would open at once.)
#[test]
fn uniform_tension_passes() {
    for (n, refined) in [([5, 7], false), ([7, 5], false), ([3, 4], true)] {
        for (model, sliding, sigma) in
            [("linear", "small", 1.0), ("linear", "finite", 1e-3), ("neo_hookean", "finite", 100.0)]
        {
            // The load of a `linear` body acts on the shape that it had.
            let (load, value) = match model {
                "linear" => ("traction", json!({"y": sigma})),
                _ => ("pressure", json!(-sigma)),
            };
            let steps = json!([{"name": "pull", "duration": 1, "dt": {"initial": 0.5},
                                "supports": [{"on": "lower_bottom", "uy": 0}, {"on": "lower_left", "ux": 0}, {"on": "upper_left", "ux": 0}],
                                "loads": [{"on": "upper_top", load: value}]}]);
            let run = finish(&tied(&column(n, refined), model, &json!({"sliding": sliding}), steps));
            let what = format!("{n:?} {refined} {model} {sliding}");
            // Of `linear`, what turns with the slave is off by the square of its rotation.
            let allowed = if model == "linear" && sliding == "finite" { 1e-5 } else { 1e-10 };
            close(&what, error_of_stress(&run, sigma), 0.0, allowed);
            assert!(
                run.last().contacts[0].iter().all(|state| state.friction.pressure < 0.0 && state.is_closed()),
                "{what}"
            );
        }
    }
}

/// Turned by a quarter of a turn as one, the blocks bear nothing: less than 1e-9 of E.
#[test]
fn what_is_tied_turns_as_one() {
    let turn =
        |group: &str| json!({"on": group, "rotation": {"about": [0.5, 1.0], "angle": std::f64::consts::FRAC_PI_2}});
    let steps = json!([{"name": "turn", "duration": 1, "dt": {"initial": 0.125}, "supports": [turn("lower_bottom"), turn("upper_top")]}]);
    let run = finish(&tied(&column([5, 7], false), "neo_hookean", &json!({}), steps));
    close("turned", error_of_stress(&run, 0.0), 0.0, 1e-6);
    for state in &run.last().contacts[0] {
        close("pressure", state.friction.pressure.hypot(state.friction.traction), 0.0, 1e-6);
    }
}

/// A beam in two layers, tied along its middle, of meshes that do not match, bends as the beam of one piece does.
#[test]
fn a_beam_of_two_layers_bends_as_one() {
    let material = json!({"material": {"model": "linear", "E": 1000, "nu": 0.3}});
    let bent = |mesh: Value, bodies: &[&str], contacts: Value| {
        let bodies: serde_json::Map<String, Value> =
            bodies.iter().map(|body| ((*body).to_string(), material.clone())).collect();
        let held: Vec<Value> =
            bodies.keys().map(|body| json!({"on": format!("{body}_left"), "ux": 0, "uy": 0})).collect();
        let loads: Vec<Value> =
            bodies.keys().map(|body| json!({"on": format!("{body}_right"), "traction": {"y": -1e-3}})).collect();
        let ends: Vec<String> = bodies.keys().map(|body| format!("{body}_right")).collect();
        let run = finish(&json!({"mesh": mesh, "bodies": bodies, "contacts": contacts,
            "steps": [{"name": "bend", "duration": 1, "dt": {"initial": 1}, "supports": held, "loads": loads}]}));
        let nodes = run.nodes(&ends[0]);
        nodes.iter().map(|node| run.last().displacement[2 * node + 1]).sum::<f64>() / nodes.len() as f64
    };
    let whole = quadratic(&Blocks::default().rectangle("beam", [20, 4], [0.0, 0.0], [10.0, 1.0]).json(), half_way);
    let layers = Blocks::default().rectangle("lower", [17, 2], [0.0, 0.0], [10.0, 0.5]).rectangle(
        "upper",
        [24, 2],
        [0.0, 0.5],
        [10.0, 1.0],
    );
    let tie = json!({"tie": {"slave": "upper_bottom", "master": "lower_top", "tied": true}});
    let one = bent(whole, &["beam"], json!({}));
    let two = bent(quadratic(&layers.json(), half_way), &["lower", "upper"], tie);
    println!("one piece {one:.6}, two layers {two:.6}");
    close("tip", two / one, 1.0, 1e-3);
}

/// The tangent of a tie, pulled, sheared and turned, equals central differences.
#[test]
fn tangent_of_a_tie_equals_differences() {
    let steps = json!([{"name": "pull", "duration": 1, "supports": [{"on": "lower_bottom", "ux": 0, "uy": 0}]}]);
    for method in ["mortar", "node_to_segment", "gauss_to_segment"] {
        let model =
            common::model(&tied(&column([2, 3], false), "neo_hookean", &json!({"method": method}), steps.clone()));
        let (pair, x) = (&model.contacts[0], &model.mesh.nodes);
        let rest = pair.initial_states(&Configuration::undeformed(x));
        let motion = |size: f64| -> Vec<f64> {
            let turned = |node: &Vector2<f64>| [-size * node.y, size * node.x];
            let wave = |k: usize| 1e-3 * (1.0 + 7.3 * k as f64).sin();
            x.iter().flat_map(turned).enumerate().map(|(k, u)| u + wave(k)).collect()
        };
        let (before, u) = (motion(0.1), motion(0.4));
        let old = answer(pair, x, &rest, [&vec![0.0; 2 * x.len()], &before]).2;
        let (_, tangent, states) = answer(pair, x, &old, [&before, &u]);
        assert!(
            states.iter().any(|state: &ContactState| state.friction.pressure < 0.0 && state.regime() == Regime::Tied)
        );
        let scale = tangent.iter().flatten().fold(0.0f64, |most, k| most.max(k.abs()));
        let h = 1e-6;
        for column in 0..u.len() {
            let moved = |by: f64| {
                let mut u = u.clone();
                u[column] += by;
                answer(pair, x, &old, [&before, &u]).0
            };
            let [up, down] = [moved(h), moved(-h)];
            for row in 0..u.len() {
                close(method, tangent[row][column], (up[row] - down[row]) / (2.0 * h), 1e-6 * scale);
            }
        }
    }
}

/// What has no meaning beside a tie is refused by its name, and so is a contact without friction that is no tie.
#[test]
fn what_has_no_meaning_is_refused() {
    let steps = json!([{"name": "pull", "duration": 1, "supports": [{"on": "lower_bottom", "ux": 0, "uy": 0}]}]);
    let refused = |key: &str, value: Value| {
        let mut case = tied(&column([2, 3], false), "linear", &json!({}), steps.clone());
        case["contacts"]["tie"][key] = value;
        refusal(&case)
    };
    for (key, value, place) in [
        ("friction", json!({"law": "coulomb", "mu": 0.3}), "friction"),
        ("normal", json!({"penetration": 1e-6}), "normal.penetration"),
        ("shrink_fit", json!(true), "shrink_fit"),
        ("clearance", json!(0.1), "clearance"),
        ("stick", json!(1e-6), "stick"),
        ("initial", json!({"pressure": 1}), "initial"),
        ("master", json!({"plane": {"point": [0, 1], "normal": [0, 1]}}), "master"),
        ("tied", json!(false), "friction"),
    ] {
        let message = refused(key, value);
        assert!(message.contains(&format!("contacts.tie.{place}")), "{key}: {message}");
    }
}

/// Softer penalties on the way to a start value are those of contacts: what is tied stays so.
#[test]
fn a_tie_keeps_its_stiffness() {
    let steps = json!([{"name": "rest", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "lower_bottom", "ux": 0, "uy": 0}]}]);
    let case = tied(&column([5, 7], false), "linear", &json!({"sliding": "small"}), steps);
    let pair = &common::model(&case).contacts[0];
    assert_eq!(pair.normal_stiffness(1e-4), pair.alpha_n);
}
