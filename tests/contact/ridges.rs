//! Convex corners of meshes by mortar: they press from their touch on, between nodes as well, and what they press is exact where nothing is open.

use std::sync::Arc;

use fecontact::output::warnings::Warnings;
use nalgebra::Vector2;
use serde_json::{Value, json};

use crate::common::{self, Finished, close, finish};
use crate::self_contact::compare_tangent;

/// A ridge between flanks of 45° goes 0.59 deep into ground twenty times softer, beside the middle of an edge of 0.74 or 0.74/`finer`; one of
/// the two is the slave.
fn ridge(slave: &str, finer: usize) -> Value {
    ridge_of("Q4", slave, finer)
}

/// The same with other elements.
fn ridge_of(kind: &str, slave: &str, finer: usize) -> Value {
    let master = if slave == "flank" { "surface" } else { "flank" };
    json!({
        "mesh": {"blocks": [
            {"body": "ground", "kind": kind, "corners": [[-10, -8], [10, -8], [10, 0], [-10, 0]], "elements": [27 * finer, 10 * finer],
             "sides": ["bottom", null, "surface", null]},
            {"body": "die", "kind": kind, "corners": [[0, 0.01], [4, 4.01], [0, 8.01], [-4, 4.01]], "elements": [8 * finer, 8 * finer],
             "sides": ["flank", "top", "top", "flank"]}]},
        "bodies": {"die": {"material": {"model": "neo_hookean", "E": 2000, "nu": 0.3}},
                   "ground": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}}},
        "contacts": {"c": {"slave": slave, "master": master, "friction": {"law": "coulomb", "mu": 0.3}}},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.05}, "supports": [
            {"on": "bottom", "ux": 0, "uy": 0}, {"on": "top", "ux": 0, "uy": -0.6}]}],
    })
}

/// Force that presses the die down.
fn force(run: &Finished, time: f64) -> f64 {
    -run.reaction("top", run.at(time))[1]
}

/// From its touch on the ridge bears, on either side of the contact, with forces in balance and their exact tangent. By nodes of the flanks,
/// which the tip is one of, this mesh bears 7.89 and 33.5 at t = 0.25 and 1; both methods tend to 3.9 and 20.7 on edges of an eighth.
#[test]
fn a_ridge_bears_from_its_touch_on() {
    for slave in ["flank", "surface"] {
        let run = finish(&ridge(slave, 1));
        close(slave, force(&run, 0.25), 7.89, 0.1 * 7.89);
        close(slave, force(&run, 1.0), 33.5, 0.05 * 33.5);
        let forces: Vec<f64> = run.states.iter().map(|state| -run.reaction("top", state)[1]).collect();
        assert!(forces.windows(2).all(|pair| pair[0] <= pair[1]), "{slave}: {forces:?}");
        assert!(compare_tangent(&run, slave) >= 2, "{slave}");
        let [bottom, top] = ["bottom", "top"].map(|side| run.reaction(side, run.last()));
        (0..2).for_each(|i| close(slave, bottom[i], -top[i], 1e-6 * bottom[1].abs()));
        // Were forces normal to the slave against an inclined master too, 2 % of the work would be missing with the flank as slave.
        let error = run.last().energy.error().abs() / run.last().energy.supplied();
        assert!(error < 2e-3, "{slave}: {error}");
    }
}

/// So it does on quadratic edges. By nodes of the flanks these meshes bear 5.72 and 24.3 (Q8) and 5.92 and 23.8 (T6), and Q8 on edges of a
/// quarter 3.86 and 20.6.
#[test]
fn a_quadratic_ridge_bears_from_its_touch_on() {
    for (kind, slave, quarter, whole) in
        [("Q8", "flank", 5.72, 24.3), ("Q8", "surface", 5.72, 24.3), ("T6", "flank", 5.92, 23.8)]
    {
        let run = finish(&ridge_of(kind, slave, 1));
        let what = format!("{kind}, {slave}");
        let forces: Vec<f64> = run.states.iter().map(|state| -run.reaction("top", state)[1]).collect();
        println!("{what}: {} {}", force(&run, 0.25), force(&run, 1.0));
        close(&what, force(&run, 0.25), quarter, 0.1 * quarter);
        close(&what, force(&run, 1.0), whole, 0.05 * whole);
        assert!(forces.windows(2).all(|pair| pair[0] <= pair[1]), "{what}: {forces:?}");
        // One traction an edge: the tip in the middle of an edge closes one point.
        assert!(compare_tangent(&run, slave) >= 1, "{what}");
        let [bottom, top] = ["bottom", "top"].map(|side| run.reaction(side, run.last()));
        (0..2).for_each(|i| close(&what, bottom[i], -top[i], 1e-6 * bottom[1].abs()));
        let error = run.last().energy.error().abs() / run.last().energy.supplied();
        assert!(error < 3e-3, "{what}: {error}");
    }
}

/// On finer edges of the ground its nodes go past the tip to the other flank, which then is not what faces the flank beside the tip: the tip stays a
/// ridge, and its force grows without jumps. By nodes these meshes bear 4.36 (Q4) and 4.37 (Q8) at t = 0.25, and tend to 20.7 at the end.
#[test]
fn a_ridge_stays_one_as_the_ground_folds_round_it() {
    for (kind, finer, quarter) in [("Q4", 4, 4.36), ("Q8", 2, 4.37)] {
        let run = finish(&ridge_of(kind, "flank", finer));
        let forces: Vec<f64> = run.states.iter().map(|state| -run.reaction("top", state)[1]).collect();
        close(kind, force(&run, 0.25), quarter, 0.05 * quarter);
        close(kind, force(&run, 1.0), 20.7, 0.04 * 20.7);
        assert!(
            forces.windows(2).all(|pair| pair[1] - pair[0] < 0.1 * 20.7 && pair[0] <= pair[1]),
            "{kind}: {forces:?}"
        );
        assert_eq!(run.report.cutbacks, 0, "{kind}");
    }
}

/// On edges longer than its contact the force of a ridge goes by the edges (33 for 20.7 on edges of an eighth), which is told with edges that do: a
/// wedge with flanks of 45° is in contact over 2 F/E*.
#[test]
fn a_ridge_on_long_edges_is_told() {
    for (slave, edge) in [("flank", 7.4e-2), ("surface", 1.05e-1)] {
        let (mut warnings, model) = (Warnings::default(), Arc::new(common::model(&ridge(slave, 1))));
        fecontact::run::run(&model, &mut [&mut warnings]).1.unwrap_or_else(|error| panic!("{error}"));
        let told: Vec<&String> = warnings.list.iter().filter(|told| told.contains("a corner presses")).collect();
        assert!(told.len() == 1 && common::warnings::is_listed(told[0]), "{slave}: {:?}", warnings.list);
        let (_, advice) = told[0].split_once("take edges of ").expect("an edge");
        let advised: f64 = advice.split_whitespace().next().and_then(|text| text.parse().ok()).expect("a number");
        close(slave, advised, edge, 0.1 * edge);
        assert!(!warnings.list.iter().any(|told| told.contains("energy balance")), "{:?}", warnings.list);
    }
}

/// A finer mesh bears what nodes bear on it, 5.01 and 21.5; the tip is opposite a node there.
#[test]
fn a_ridge_opposite_a_node_bears() {
    let run = finish(&ridge("surface", 2));
    close("at t = 0.25", force(&run, 0.25), 5.01, 0.05 * 5.01);
    close("at the end", force(&run, 1.0), 21.5, 0.03 * 21.5);
    assert_eq!(run.report.cutbacks, 0);
}

/// Whole outlines of blocks whose corners meet, pressed evenly: the pressure is that of uniaxial compression everywhere, with either block
/// as the slave.
#[test]
fn corners_that_are_closed_press_evenly() {
    for kind in ["Q4", "Q8"] {
        for [slave, master] in [["low", "up"], ["up", "low"]] {
            let block = |body: &str, y: f64, elements: [usize; 2], held: usize| {
                let sides: Vec<&str> = (0..4).map(|side| if side == held { "held" } else { body }).collect();
                json!({"body": body, "kind": kind, "corners": [[0, y], [2, y], [2, y + 1.0], [0, y + 1.0]], "elements": elements,
                       "sides": sides.iter().map(|side| if *side == "held" { format!("{body}_held") } else { format!("{body}_outline") }).collect::<Vec<_>>()})
            };
            let material = json!({"material": {"model": "neo_hookean", "E": 100, "nu": 0}});
            let run = finish(&json!({
                "mesh": {"blocks": [block("low", 0.0, [6, 3], 0), block("up", 1.0, [8, 4], 2)]},
                "bodies": {"low": material, "up": material},
                "contacts": {"c": {"slave": format!("{slave}_outline"), "master": format!("{master}_outline"), "friction": {"law": "frictionless"}}},
                "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.5}, "supports": [
                    {"on": "low_held", "ux": 0, "uy": 0}, {"on": "up_held", "ux": 0, "uy": -0.02}]}],
            }));
            let pressures = run.last().contacts[0].iter().map(|state| state.friction.pressure);
            let pressures: Vec<f64> = pressures.filter(|pressure| *pressure > 0.0).collect();
            assert!(pressures.len() >= 7 && pressures[0] > 0.9, "{pressures:?}");
            pressures.iter().for_each(|pressure| close(kind, *pressure, pressures[0], 1e-10 * pressures[0]));
        }
    }
}

/// A ridge that is dragged over long edges loses energy, the more with the surface that it enters as slave; the warning names the other way round.
#[test]
fn the_energy_of_a_dragged_ridge_names_the_other_role() {
    let told = |slave: &str| {
        let mut case = ridge(slave, 1);
        let mut drag = case["steps"][0].clone();
        (drag["name"], drag["supports"][1]["ux"]) = (json!("drag"), json!(1.5));
        drag["supports"][1]["uy"] = json!(-0.6);
        case["steps"].as_array_mut().expect("steps").push(drag);
        let (mut warnings, model) = (Warnings::default(), Arc::new(common::model(&case)));
        fecontact::run::run(&model, &mut [&mut warnings]).1.unwrap_or_else(|error| panic!("{error}"));
        warnings.list.into_iter().find(|told| told.starts_with("energy balance")).expect("a warning")
    };
    let [surface, flank] = [told("surface"), told("flank")];
    println!("{surface}\n{flank}");
    let share = |told: &str| -> f64 {
        let (before, _) = told.split_once(" % of").expect("a share");
        before.rsplit(' ').next().and_then(|text| text.parse().ok()).expect("a number")
    };
    assert!(surface.contains("with slave and master exchanged") && !flank.contains("exchanged"));
    assert!(share(&surface) > 1.3 * share(&flank), "{surface}, {flank}");
}

/// The resultant that a run tells is what the supports bear, also in increments at whose end a corner stops or begins to be a ridge, as the trailing one
/// of a dragged punch does.
#[test]
fn resultants_are_what_supports_bear() {
    let run = finish(&json!({
        "mesh": {"blocks": [
            {"body": "ground", "kind": "Q8", "corners": [[-4, -3], [4, -3], [4, 0], [-4, 0]], "elements": [32, 10], "sides": ["low", null, "top", null]},
            {"body": "punch", "kind": "Q8", "corners": [[-0.5, 0.005], [0.5, 0.005], [0.5, 1.005], [-0.5, 1.005]], "elements": [5, 5],
             "sides": ["die", "die", "held", "die"]}]},
        "bodies": {"ground": {"material": {"model": "neo_hookean", "E": 10, "nu": 0.3}},
                   "punch": {"material": {"model": "neo_hookean", "E": 200, "nu": 0.3}}},
        "contacts": {"c": {"slave": "top", "master": "die", "friction": {"law": "coulomb", "mu": 0.2}}},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.1},
             "supports": [{"on": "low", "ux": 0, "uy": 0}, {"on": "held", "ux": 0, "uy": -0.25}]},
            {"name": "drag", "duration": 0.3, "dt": {"initial": 0.05}, "supports": [{"on": "held", "ux": 0.3}]}],
    }));
    for state in &run.states {
        let x = run.model.configuration(&state.displacement);
        let found = run.model.contacts[0].resultant(&state.contacts[0], &x, Vector2::zeros()).force;
        let borne = run.reaction("low", state);
        (0..2).for_each(|i| close(&format!("t = {}", state.time), found[i], -borne[i], 0.02 * borne[1].abs()));
    }
}
