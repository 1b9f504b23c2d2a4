//! Periodic sides: waves that come back, sliding without end, and sides that do not fit.

use std::f64::consts::PI;
use std::path::Path;

use crate::common::{Blocks, close, finish};
use fecontact::case;
use fecontact::mesh::ties::Ties;
use serde_json::{Value, json};

/// A periodic bar of length 1 along a direction, bent into a sine by forces and let go.
fn ring(angle: f64, scheme: &Value, dt: f64, damping: f64) -> Value {
    let along = format!("({}*x+{}*y)", angle.cos(), angle.sin());
    let force = |size: f64| json!(format!("{size}*sin({}*{along})", 2.0 * PI));
    let free = json!({"x": "0", "y": "0"});
    json!({
        "mesh": Blocks::default().rectangle("bar", [60, 1], [0.0, 0.0], [1.0, 0.05]).turned(angle).json(),
        "bodies": {"bar": {"material": {"model": "linear", "E": 4.0, "nu": 0.0, "density": 1.0}, "damping": {"mass": damping}}},
        "periodic": [["bar_left", "bar_right"]],
        "steps": [
            {"name": "bend", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": {"node": 0}, "ux": 0, "uy": 0}],
             "loads": [{"on": "bar", "force": {"x": force(1e-4 * angle.cos()), "y": force(1e-4 * angle.sin())}}]},
            {"name": "ring", "duration": 2, "scheme": scheme, "dt": {"initial": dt},
             "supports": [{"on": {"node": 0}, "ux": null, "uy": null}],
             "loads": [{"on": "bar", "force": free}]},
        ],
        "output": {"interval": 0.125},
    })
}

#[test]
fn a_standing_wave_returns_after_the_time_round_the_ring() {
    // c = 2: u = A sin(2πx/L) cos(2πct/L) for ever, with the period L/c = 0.5. Free ends would not let it stand.
    for (scheme, dt) in [
        (json!({"explicit": {}}), 1.0),
        (json!({"newmark": {}}), 0.0025),
        (json!({"hht": {"alpha": -0.05}}), 0.0025),
        (json!({"wilson": {}}), 0.0025),
    ] {
        for angle in [0.0, 0.6] {
            let run = finish(&ring(angle, &scheme, dt, 0.0));
            assert_eq!(run.iterations[0], 1, "the bending is linear");
            let start = &run.states[0];
            let size = start.displacement.iter().fold(0.0f64, |size, u| size.max(u.abs()));
            for (t, expected) in [(0.125, 0.0), (0.25, -1.0), (0.5, 1.0), (1.0, 1.0), (2.0, 1.0)] {
                let state = run.at(1.0 + t);
                for (u, u0) in state.displacement.iter().zip(&start.displacement) {
                    close(&format!("{scheme}, {angle}, t = {t}"), *u, expected * u0, 0.02 * size);
                }
                for (left, right) in run.nodes("bar_left").into_iter().zip(run.nodes("bar_right")) {
                    for values in [&state.displacement, &state.velocity, &state.acceleration] {
                        let largest = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                        (0..2).for_each(|i| {
                            close("partners", values[2 * left + i], values[2 * right + i], 1e-9 * largest);
                        });
                    }
                }
            }
            let energy = &run.last().energy;
            close("energy", energy.error(), 0.0, 0.01 * energy.strain.max(energy.external_work));
        }
    }
}

#[test]
fn damping_by_the_masses_counts_partners_once() {
    for (scheme, dt) in [(json!({"explicit": {}}), 1.0), (json!({"newmark": {}}), 0.0025)] {
        let run = finish(&ring(0.0, &scheme, dt, 0.5));
        let (start, end) = (&run.states[0].displacement, &run.last().displacement);
        let expected = f64::exp(-0.25 * 2.0);
        for (u, u0) in end.iter().zip(start) {
            close(&format!("{scheme}"), *u, expected * u0, 1e-2 * start.iter().fold(0.0f64, |m, u| m.max(u.abs())));
        }
    }
}

#[test]
fn a_periodic_block_slides_for_ever_under_uniform_tractions() {
    // In dynamics the block goes on swinging a little from its start.
    for (scheme, allowed) in [(json!("static"), 1e-9), (json!({"newmark": {}}), 1e-3)] {
        let run = finish(&json!({
            "mesh": Blocks::default().rectangle("block", [4, 2], [0.0, 0.0], [1.0, 0.5]).json(),
            "bodies": {"block": {"material": {"model": "neo_hookean", "E": 100.0, "nu": 0.3, "density": 1e-6}}},
            "periodic": [["block_left", "block_right"]],
            "contacts": {"base": {
                "slave": "block_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                "normal": {"alpha_n": 1e5}, "friction": {"law": "coulomb", "mu": 0.4, "alpha_t": 1e5},
            }},
            "steps": [
                {"name": "press", "duration": 1, "dt": {"initial": 0.25}, "supports": [{"on": "block_top", "ux": 0, "uy": -0.002}]},
                {"name": "drag", "duration": 50, "dt": {"initial": 2.5}, "scheme": scheme,
                 "supports": [{"on": "block_top", "ux": {"rate": 2.0}}]},
            ],
            "watch": ["block_top"],
        }));
        let state = run.last();
        close("way", state.contacts[0][0].friction.plastic_slip, 100.0, 0.1);
        // Uniaxial strain: p = −P₂₂ of the law at F = diag(1, 1 − e), the spring of the contact in line with it.
        let first = state.contacts[0][0].friction;
        assert!(first.pressure > 0.4, "{first:?}");
        for contact in &state.contacts[0] {
            close("pressure", contact.friction.pressure, first.pressure, allowed);
            close("traction", contact.friction.traction, 0.4 * first.pressure, allowed);
        }
        let [fx, fy] = run.reaction("block_top", state);
        close("drag", fx, 0.4 * first.pressure, 10.0 * allowed);
        close("press", fy, -first.pressure, 10.0 * allowed);
    }
}

#[test]
fn corners_of_a_model_periodic_both_ways_move_as_one() {
    // 2 3
    // 0 1
    let ties = Ties::new(6, &[[0, 1], [2, 3], [0, 2], [1, 3]]);
    assert_eq!([0, 1, 2, 3, 4].map(|node| ties.original(node)), [0, 0, 0, 0, 4]);
    let mut values = vec![1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
    ties.gather(1, &mut values);
    assert_eq!(values, [15.0, 0.0, 0.0, 0.0, 16.0, 32.0]);
    ties.spread(1, &mut values);
    assert_eq!(values, [15.0, 15.0, 15.0, 15.0, 16.0, 32.0]);
    // A body that can do nothing but fly: no waves, no rotation, two motions left.
    let case = json!({
        "mesh": Blocks::default().rectangle("cell", [3, 2], [0.0, 0.0], [1.0, 1.0]).json(),
        "bodies": {"cell": {"material": {"model": "linear", "E": 1.0, "nu": 0.3, "density": 1.0}}},
        "periodic": [["cell_left", "cell_right"], ["cell_bottom", "cell_top"]],
        "initial_velocity": {"cell": [0.1, 0.2]},
        "steps": [{"name": "fly", "duration": 1, "scheme": {"explicit": {}}}],
    });
    let run = finish(&case);
    run.last().displacement.chunks(2).for_each(|u| close("flight", u[0] + u[1], 0.3, 1e-12));
    close("kinetic energy", run.last().energy.kinetic, 0.5 * 0.05, 1e-12);
}

#[test]
fn sides_that_do_not_lie_alike_are_refused() {
    let refused = |blocks: &Blocks, periodic: Value, extra: Value, words: &str| {
        let mut case = json!({
            "mesh": blocks.json(),
            "bodies": {"bar": {"material": {"model": "linear", "E": 1.0, "nu": 0.0, "density": 1.0}}},
            "periodic": periodic,
            "steps": [{"name": "fly", "duration": 1, "scheme": {"newmark": {}}}],
        });
        extra.as_object().into_iter().flatten().for_each(|(key, value)| case[key] = value.clone());
        let parsed = serde_json::from_value(case).expect("well formed");
        let error = case::build(&parsed, Path::new("test.json")).map(drop).expect_err("refused").to_string();
        assert!(error.contains(words), "{error}");
    };
    let good = Blocks::default().rectangle("bar", [4, 2], [0.0, 0.0], [1.0, 0.5]);
    let none = json!({});
    refused(&good, json!([["bar_left", "bar_rigth"]]), none.clone(), "periodic[0]");
    refused(&good, json!([["bar_left", "bar_top"]]), none.clone(), "`bar_left` has 3 nodes and `bar_top` has 5");
    refused(&good, json!([["bar_left", "bar_left"]]), none.clone(), "is on both sides");
    let skew = Blocks::default().block("bar", [4, 2], |s, t| [s, 0.5 * (t + 0.2 * s * t * (1.0 - t))]);
    refused(&skew, json!([["bar_left", "bar_right"]]), none.clone(), "has no partner on `bar_right`");
    // A static step needs supports against translation, but none against rotation.
    let hold = |supports: Value| json!({"steps": [{"name": "hold", "duration": 1, "supports": supports}]});
    refused(&good, json!([["bar_left", "bar_right"]]), hold(json!([])), "`bar` can move freely along");
    let held = hold(json!([{"on": {"node": 0}, "ux": 0, "uy": 0}]));
    refused(&good, json!([]), held.clone(), "in rotation");
    let mut case = ring(0.0, &json!({"newmark": {}}), 0.1, 0.0);
    case["steps"] = held["steps"].clone();
    finish(&case);
}
