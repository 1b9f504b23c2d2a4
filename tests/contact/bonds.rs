//! Strength without pressure: points that open carry shear over their gap, and bonds beside friction pull, soften and are limited.
//!
//! The block of the first tests is 1 long and 0.5 high, of E = 2000 and ν = 0.3; under 5 on its top it is pushed from its left side by
//! 0.02, and its rear lifts. The forces at the end are those of an independent program: plane-strain Q4 condensed on the nodes of the
//! bottom, the return map of the bond point by point, 2 Gauss points an edge.

use std::path::Path;

use fecontact::case;
use fecontact::contact::pair::field_values;
use fecontact::model::{Model, State};
use serde_json::{Value, json};

use crate::common::{self, Finished, built, close};

fn pushed(friction: &Value, bond: &Value, further: &Value) -> Value {
    let mut contact = json!({
        "slave": "bottom",
        "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
        "sliding": "small",
        "friction": friction
    });
    if !bond.is_null() {
        contact["bond"] = bond.clone();
    }
    for (key, value) in further.as_object().into_iter().flatten() {
        contact[key] = value.clone();
    }
    json!({
        "mesh": {"blocks": [{
            "body": "b", "corners": [[0, 0], [1, 0], [1, 0.5], [0, 0.5]], "elements": [10, 5], "sides": ["bottom", null, "top", "left"]
        }]},
        "bodies": {"b": {"material": {"model": "linear", "E": 2000, "nu": 0.3}}},
        "contacts": {"c": contact},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.5},
             "supports": [{"on": "left", "ux": 0}], "loads": [{"on": "top", "dead_pressure": 5}]},
            {"name": "push", "duration": 1, "dt": {"initial": 0.05}, "supports": [{"on": "left", "ux": 0.02}]}
        ]
    })
}

fn adhesion() -> Value {
    json!({"law": "adhesion", "strength": 10})
}

fn frictionless() -> Value {
    json!({"law": "frictionless"})
}

fn shear(state: &State) -> f64 {
    state.contacts[0].iter().map(|point| point.length * point.shear()).sum()
}

/// The shear at the end of a run, whose energies balance to 1 %.
fn force(case: &Value) -> f64 {
    let run = common::finish(case);
    let energy = &run.last().energy;
    assert!(energy.error().abs() < 0.01 * energy.supplied(), "{}", energy.error());
    shear(run.last())
}

/// The force depends on the opening over which strength fades, and not on the method.
#[test]
fn a_block_is_pushed_off_its_adhesion() {
    for (opening, expected) in [(1e9, 10.0), (1e-3, 9.223), (1e-4, 8.183), (1e-5, 8.015)] {
        let bond = json!({"opening": opening});
        close("force", force(&pushed(&adhesion(), &bond, &Value::Null)), expected, 2e-3 * expected);
    }
    let bond = json!({"opening": 1e-3});
    for method in ["node_to_segment", "gauss_to_segment", "mortar"] {
        let plain = force(&pushed(&adhesion(), &bond, &json!({"method": method})));
        close(method, plain, 9.223, 0.01 * 9.223);
        let exact = json!({"method": method, "normal": {"penetration": 1e-8}, "stick": 1e-8});
        close(method, force(&pushed(&adhesion(), &bond, &exact)), plain, 1e-3 * plain);
    }
}

/// Soil with p = 18 z, nothing at the surface, is dragged past a rigid shaft of 8: c L = 256 where nothing fades, and less the sooner it does
/// at the surface, where the soil comes off. The forces are those of the same independent program.
#[test]
fn soil_is_dragged_past_a_shaft() {
    for (opening, expected) in [(1e9, 256.0), (5e-3, 252.6), (1e-4, 248.0)] {
        let case = json!({
            "mesh": {"blocks": [{
                "body": "soil", "corners": [[0, -8], [8, -8], [8, 0], [0, 0]], "elements": [32, 32], "sides": [null, "far", null, "shaft"]
            }]},
            "bodies": {"soil": {"material": {"model": "linear", "E": 5000, "nu": 0.49}}},
            "contacts": {"c": {
                "slave": "shaft", "master": {"plane": {"point": [0, 0], "normal": [1, 0]}}, "sliding": "small",
                "friction": {"law": "adhesion", "strength": 32}, "bond": {"opening": opening},
                "initial": {"pressure": "-18*y", "balanced": true}
            }},
            "steps": [{"name": "drag", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "far", "ux": 0, "uy": 0.4}]}]
        });
        close("force", shear(common::finish(&case).last()).abs(), expected, 1e-3 * expected);
    }
}

/// Adhesion is a bond without friction; cohesion beside friction is a bond beside it.
#[test]
fn cohesion_of_laws_is_a_bond_beside_them() {
    let (opening, bond) = (json!({"opening": 1e-3}), |c: f64| json!({"strength": c, "opening": 1e-3}));
    for further in [
        Value::Null,
        json!({"method": "mortar", "sliding": "finite"}),
        json!({"normal": {"penetration": 1e-8}, "stick": 1e-8}),
    ] {
        let [own, beside] = [pushed(&adhesion(), &opening, &further), pushed(&frictionless(), &bond(10.0), &further)];
        let [own, beside] = [own, beside].map(|case| common::finish(&case));
        close("force", shear(own.last()), shear(beside.last()), 1e-8);
        let [of_own, of_beside] = [&own, &beside].map(|run| run.last().energy.friction_dissipation);
        close("dissipation", of_own, of_beside, 1e-5 * of_beside);
        for name in ["traction", "slip", "elastic_slip"] {
            let [a, b] = [&own, &beside].map(|run| field(run, name));
            assert!(common::distance(&a, &b) < 1e-6, "{name}: {a:?} is not {b:?}");
        }
    }
    let weakening = json!({"law": "slip_weakening", "mu_s": 0.5, "mu_d": 0.5, "D_c": 1, "cohesion": 5});
    let coulomb = json!({"law": "coulomb", "mu": 0.5});
    for case in [pushed(&weakening, &opening, &Value::Null), pushed(&coulomb, &bond(5.0), &Value::Null)] {
        close("c + mu p", force(&case), 7.4885, 2e-3 * 7.4885);
    }
}

fn field(run: &Finished, name: &str) -> Vec<f64> {
    let state = run.last();
    field_values(&run.model.contacts[0], &state.contacts[0], state.time, state.dt, name)
}

/// What softens ends at its residual, τ = c_r; what is limited nowhere exceeds the limit.
#[test]
fn a_bond_softens_and_is_limited() {
    let softens = json!({"strength": 10, "residual": 2, "slip": 1e-2, "opening": 1e-3});
    let run = common::finish(&pushed(&frictionless(), &softens, &Value::Null));
    close("residual", shear(run.last()), 2.0, 1e-6);
    assert!(field(&run, "bond").iter().all(|left| *left == 0.0));
    let limited = json!({"strength": 10, "limit": 12, "opening": 1e-3});
    let run = common::finish(&pushed(&json!({"law": "coulomb", "mu": 0.5}), &limited, &Value::Null));
    let [p, q] = ["pressure", "traction"].map(|name| field(&run, name));
    for (p, q) in p.iter().zip(&q).filter(|(p, _)| **p > 0.0) {
        close("min(c + mu p, limit)", *q, (10.0 + 0.5 * p).min(12.0), 1e-6);
    }
    assert!(q.contains(&12.0) && p.contains(&0.0), "{p:?} {q:?}");
    let energy = &run.last().energy;
    assert!(energy.error().abs() < 0.01 * energy.supplied(), "{}", energy.error());
}

/// A column of ν = 0 is pulled off: σ = E (U − w)/H is t (1 − w/δ), and t δ/2 is dissipated in the end, by any method.
#[test]
fn a_block_is_pulled_off() {
    let bond = json!({"strength": 10, "tension": 3, "opening": 0.01});
    for further in [
        json!({"method": "node_to_segment"}),
        json!({"method": "gauss_to_segment"}),
        json!({"method": "mortar", "sliding": "finite"}),
        json!({"normal": {"penetration": 1e-8}}),
    ] {
        let mut case = pushed(&frictionless(), &bond, &further);
        case["bodies"]["b"]["material"]["nu"] = json!(0);
        case["steps"] = json!([{"name": "pull", "duration": 0.012, "dt": {"initial": 0.0005},
            "supports": [{"on": "top", "ux": 0, "uy": {"rate": 1}}, {"on": "left", "ux": 0}]}]);
        let run = common::finish(&case);
        let force = |time: f64| run.reaction("top", run.at(time))[1];
        close("elastic", force(5e-4), 2000.0 / 0.5 * 5e-4, 2e-3);
        for time in [2e-3, 5e-3, 9e-3] {
            let opening = (4000.0 * time - 3.0) / 3700.0;
            close("softening", force(time), 3.0 * (1.0 - opening / 0.01), 1e-3);
            let state = run.at(time);
            let pull: f64 = state.contacts[0].iter().map(|point| -point.length * point.tractions()[0]).sum();
            close("pull", pull, force(time), 1e-6);
        }
        close("after", force(0.0115), 0.0, 1e-9);
        let energy = &run.last().energy;
        close("work", energy.friction_dissipation, 0.015, 2e-4);
        close("balance", energy.error(), 0.0, 2e-4);
    }
}

/// What is lost by an opening does not return; what lies apart at the start is bonded if it is said so.
#[test]
fn what_lies_apart_is_bonded_if_it_is_said() {
    let slid = |gap: f64, bonded: bool| {
        let bond = json!({"strength": 10, "residual": 4, "opening": 0.01, "bonded": bonded});
        let mut case = pushed(&frictionless(), &bond, &Value::Null);
        case["contacts"]["c"]["master"]["plane"]["point"] = json!([0, -gap]);
        let on = json!([{"on": "top", "ux": 0, "uy": -gap - 0.02}]);
        let slide = json!([{"on": "top", "ux": 0.02, "uy": -gap - 0.02}]);
        case["steps"] = json!([{"name": "press", "duration": 1, "supports": on},
            {"name": "slide", "duration": 1, "dt": {"initial": 0.1}, "supports": slide}]);
        shear(common::finish(&case).last())
    };
    close("touching", slid(0.0, false), 10.0, 1e-6);
    close("apart", slid(1e-3, false), 4.0, 1e-6);
    close("bonded over a gap of δ/10", slid(1e-3, true), 6.0 * 0.9 + 4.0, 1e-6);
}

/// What is bonded over a gap has no stress until it opens farther: a column of ν = 0 that is raised by u has σ = E (u − x)/H under
/// t (1 − κ(w₀ + x)), with κ by the whole gap w₀ + x.
#[test]
fn a_bond_over_a_gap_pulls_once_it_opens_farther() {
    let bond = json!({"strength": 10, "tension": 3, "opening": 0.01, "bonded": true});
    let mut case = pushed(&frictionless(), &bond, &Value::Null);
    case["bodies"]["b"]["material"]["nu"] = json!(0);
    case["contacts"]["c"]["master"]["plane"]["point"] = json!([0, -2e-3]);
    case["steps"] = json!([
        {"name": "rest", "duration": 1e-3, "supports": [{"on": "top", "ux": 0, "uy": 0}, {"on": "left", "ux": 0}]},
        {"name": "pull", "duration": 6e-3, "dt": {"initial": 5e-4}, "supports": [{"on": "top", "uy": {"rate": 1}}]}
    ]);
    let run = common::finish(&case);
    let force = |time: f64| run.reaction("top", run.at(time))[1];
    close("at rest", force(1e-3), 0.0, 1e-12);
    let (u, stiff) = (5e-3, 2000.0 / 0.5);
    let x = (stiff * u - 3.0 * 0.8) / (stiff - 3.0 / 0.01);
    close("softening", force(6e-3), 3.0 * (1.0 - (2e-3 + x) / 0.01), 2e-3);
    let energy = &run.last().energy;
    close("balance", energy.error(), 0.0, 1e-4);
}

/// The opening is chosen once: the resolved case has it, and a finer mesh keeps it.
#[test]
fn the_opening_is_a_length_of_the_interface() {
    let case = pushed(&adhesion(), &Value::Null, &Value::Null);
    let given = case::from_text(&case.to_string(), Path::new("test.json")).expect("a case");
    let model = case::build(&given, Path::new("test.json")).expect("a model");
    let resolved: Value = serde_json::from_str(&case::resolved(&given, &model)).expect("JSON");
    let opening = |case: &Value| case["contacts"]["c"]["bond"]["opening"].as_f64();
    close("4 c h/E", opening(&resolved).expect("it is kept"), 4.0 * 10.0 * 0.1 / 2000.0, 1e-15);
    let delta = |model: &Model| model.contacts[0].laws[0].cohesion.expect("it has one").bond().opening();
    assert_eq!(delta(&common::model(&resolved)), delta(&model));
    let mut finer = resolved;
    finer["mesh"]["blocks"][0]["elements"] = json!([20, 10]);
    assert_eq!(delta(&common::model(&finer)), delta(&model));
}

/// Lengths below what an element follows are told before the run; a run tells what open points carry over a length chosen by the mesh.
#[test]
fn short_lengths_and_open_points_are_told() {
    let told = |bond: Value| {
        built(&pushed(&frictionless(), &bond, &Value::Null), Path::new("test.json")).expect("a model").warnings()
    };
    let has = |told: Vec<String>, words: &str| {
        told.iter().any(|told| told.contains(words) && common::warnings::is_listed(told))
    };
    assert!(has(
        told(json!({"strength": 10, "opening": 7e-4})),
        "fades over the opening 7e-4, below 1.5 c h/E = 7.5e-4"
    ));
    assert!(has(told(json!({"strength": 10, "slip": 1.9e-3})), "its bond softens over the slip"));
    assert!(told(json!({"strength": 10, "residual": 1, "opening": 8e-4, "slip": 1.9e-3})).is_empty());
    for (bond, is_told) in [(Value::Null, true), (json!({"opening": 2e-3}), false)] {
        let mut warnings = fecontact::output::warnings::Warnings::default();
        let model = std::sync::Arc::new(common::model(&pushed(&adhesion(), &bond, &Value::Null)));
        fecontact::run::run(&model, &mut [&mut warnings]).1.expect("it comes to its end");
        assert_eq!(has(warnings.list.clone(), "open points carry up to"), is_told, "{:?}", warnings.list);
    }
}

/// What cannot be, or is not done, is refused by its place.
#[test]
fn bonds_that_cannot_be_are_refused() {
    let slave = "contacts.c.";
    let coulomb = json!({"law": "coulomb", "mu": 0.5});
    for (friction, bond, further, place, word) in [
        (adhesion(), json!({"strength": 10}), Value::Null, "bond.strength", "leave one of them out"),
        (adhesion(), json!({"tension": 1}), Value::Null, "bond.tension", "leave one of them out"),
        (adhesion(), json!({"alpha_t": 1e4}), Value::Null, "bond.alpha_t", "leave one of them out"),
        (coulomb.clone(), json!({"strength": 1, "alpha_t": 0}), Value::Null, "bond.alpha_t", "positive"),
        (coulomb.clone(), json!({"opening": 1}), Value::Null, "bond.strength", "is missing"),
        (coulomb.clone(), json!({"strength": 1, "tension": 3}), Value::Null, "bond.tension", "c/mu = 2"),
        (coulomb.clone(), json!({"strength": 1, "slip": 1e-9}), Value::Null, "bond.slip", "faster than alpha_t"),
        (coulomb.clone(), json!({"strength": 1, "limit": 2}), json!({"wear": 1e-3}), "bond.limit", "dilate or wear"),
        (coulomb.clone(), json!({"strength": -1}), Value::Null, "bond.strength", "positive"),
    ] {
        let refusal = common::refusal(&pushed(&friction, &bond, &further));
        assert!(refusal.contains(&format!("{slave}{place}")) && refusal.contains(word), "{refusal}");
    }
    let mut tied = pushed(&coulomb, &json!({"strength": 1}), &Value::Null);
    tied["mesh"]["blocks"] = json!([
        {"body": "b", "corners": [[0, 0], [1, 0], [1, 0.5], [0, 0.5]], "elements": [10, 5], "sides": ["bottom", null, "top", "left"]},
        {"body": "g", "corners": [[0, -1], [1, -1], [1, 0], [0, 0]], "elements": [10, 5], "sides": [null, null, "ground", null]}
    ]);
    tied["bodies"]["g"] = tied["bodies"]["b"].clone();
    let contact = json!({"slave": "bottom", "master": "ground", "tied": true, "bond": {"strength": 1}});
    tied["contacts"]["c"] = contact;
    let refusal = common::refusal(&tied);
    assert!(refusal.contains("contacts.c.bond") && refusal.contains("tied"), "{refusal}");
}

/// A static run that stops where a bond falls faster than an element follows names the bond, with what it lacks.
#[test]
fn a_stop_names_the_bond_that_snaps() {
    let stop = |friction: Value, bond: Value| {
        let case = pushed(&friction, &bond, &Value::Null);
        let model = std::sync::Arc::new(common::model(&case));
        let error = fecontact::run::run(&model, &mut []).1.expect_err("it stops");
        error.to_string()
    };
    let told = stop(frictionless(), json!({"strength": 10, "slip": 5e-4, "opening": 2e-3}));
    assert!(told.contains("contact `c`: its bond softens over the slip 5e-4, below 4 (c − c_r) h/E = 0.002"), "{told}");
}

/// A strip that is glued by a tension over an opening but for its end, with so many elements along the glue.
fn strip(elements: usize, [tension, opening]: [f64; 2], step: Value) -> Value {
    let block = |left: f64, right: f64, n: usize, sides: Value| json!({"body": "b", "corners": [[left, 0], [right, 0], [right, 0.1], [left, 0.1]], "elements": [n, 2], "kind": "Q8", "sides": sides});
    let mut blocks = vec![
        block(0.0, 0.5, 8, json!([null, null, null, null])),
        block(0.5, 2.0, elements, json!(["bottom", "far", null, null])),
    ];
    blocks[0]["points"] = json!({"end": [0, 0]});
    json!({
        "section": {"plane_stress": {"thickness": 1}},
        "mesh": {"blocks": blocks},
        "bodies": {"b": {"material": {"model": "linear", "E": 2000, "nu": 0}, "element": "reduced"}},
        "contacts": {"c": {"slave": "bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "sliding": "small",
            "friction": {"law": "frictionless"}, "bond": {"strength": 1e-6, "tension": tension, "opening": opening}}},
        "steps": [step]
    })
}

/// A strip whose glue is strong over a short opening: Newton's method comes to the strip that has torn off everywhere, without any force.
/// That is not accepted: the force goes on as G = t δ/2 has it, P² = √(2 E I G)³/(3 E I u), or the run stops and names the bond.
#[test]
fn a_strip_does_not_come_off_all_at_once() {
    for (elements, step) in [(75, 0.025), (50, 0.025)] {
        let case = strip(
            elements,
            [5.0, 2e-3],
            json!({"name": "peel", "duration": 1, "dt": {"initial": step, "max": step},
            "supports": [{"on": "end", "uy": 0.06}, {"on": "far", "ux": 0}]}),
        );
        let model = std::sync::Arc::new(common::model(&case));
        let mut run = fecontact::run::Simulation::new(model);
        let bending = 2000.0 * 1e-3 / 12.0;
        let tough = (2.0 * bending * 0.5 * 5.0 * 2e-3f64).sqrt();
        loop {
            match run.next_increment() {
                Ok(None) => break,
                Ok(Some(increment)) => {
                    let time = increment.state.time;
                    let force = run.reaction("end").expect("a group").y;
                    let expected = (tough.powi(3) / (3.0 * bending * 0.06 * time)).sqrt();
                    assert!(time < 0.7 || (force / expected - 1.0).abs() < 0.06, "{force} for {expected} at {time}");
                }
                Err(stop) => {
                    let told = stop.to_string();
                    assert!(told.contains("tears over") || told.contains("its bond"), "{told}");
                    break;
                }
            }
        }
    }
}

/// The same strip under a force that grows, with brittle glue: more than the glue bears has no equilibrium, and the stop says what had been reached and
/// what to do.
#[test]
fn a_stop_under_force_says_what_to_do() {
    let case = strip(
        50,
        [2.5, 4e-3],
        json!({"name": "pull", "duration": 1, "dt": {"initial": 0.05},
        "supports": [{"on": "far", "ux": 0}], "loads": [{"on": "end", "force": {"y": 0.2}}]}),
    );
    let model = std::sync::Arc::new(common::model(&case));
    let told = fecontact::run::run(&model, &mut []).1.expect_err("it stops").to_string();
    assert!(told.contains("has reached its tensile strength under growing loads (load along y 0."), "{told}");
    assert!(told.contains("prescribe the displacement of the loaded side"), "{told}");
}
