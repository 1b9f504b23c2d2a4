//! Bodies that come and go: excavations, fills and walls.

use std::sync::Arc;

use crate::common::{Blocks, close, column, distance, finish, model, refusal};
use crate::terms::tangent_error;
use fecontact::equations::Trial;
use fecontact::model::{Model, State};
use fecontact::output::warnings::Warnings;
use serde_json::{Value, json};

const WEIGHT: f64 = 20.0;

/// The column at rest under its weight, whose upper third goes in the second step.
fn unloading(n: usize, law: &str, scheme: Value) -> Value {
    let body = json!({"material": {"model": law, "E": 1000, "nu": 0.25, "density": 2},
        "initial_stress": {"geostatic": {"surface": 3, "weight": WEIGHT, "K0": 0.5}}});
    let gravity = |body: &str| json!({"on": body, "gravity": {"y": "-10"}});
    json!({
        "mesh": column(n, 1.0, ["ground", "cut"], None), "bodies": {"ground": body, "cut": body}, "watch": ["bottom"],
        "steps": [
            {"name": "rest", "duration": 1, "dt": {"initial": 1.0}, "loads": [gravity("ground"), gravity("cut")],
             "supports": [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "side", "ux": 0}]},
            {"name": "cut", "duration": 1, "dt": {"initial": 0.25}, "scheme": scheme, "remove": ["cut"]},
        ],
    })
}

/// Displacement of a node at a place of the mesh.
fn at(model: &Model, state: &State, place: [f64; 2]) -> [f64; 2] {
    let near = |node: &usize| (model.mesh.nodes[*node] - nalgebra::Vector2::from(place)).norm() < 1e-9;
    let node = (0..model.mesh.nodes.len()).find(near).expect("a node");
    [state.displacement[2 * node], state.displacement[2 * node + 1]]
}

/// One-dimensional unloading of linear ground by γ h: it heaves by γ h y/M, M = E (1 − ν)/((1 + ν)(1 − 2 ν)) = 1200, in proportion to the
/// elapsed share of the step. Rest, reaction and energies: the work of the fading force is what the ground gives back.
#[test]
fn ground_heaves_by_what_is_taken_away() {
    let run = finish(&unloading(4, "linear", json!("static")));
    for (time, share) in [(1.0, 0.0), (1.25, 0.25), (2.0, 1.0)] {
        let state = run.at(time);
        for y in [0.5, 1.0, 2.0] {
            close("heave", at(&run.model, state, [1.0, y])[1], share * WEIGHT * y / 1200.0, 1e-12);
        }
        close("reaction", run.reaction("bottom", state)[1], WEIGHT * (3.0 - share), 1e-9);
        assert!(
            at(&run.model, state, [0.0, 3.0]) == at(&run.model, run.at(1.0), [0.0, 3.0]),
            "the top waits where it is"
        );
    }
    let energy = run.last().energy;
    close("energy error", energy.error(), 0.0, 1e-12 * energy.strain.abs().max(1.0));
    // W of the rest, ½ ε² M + σ₀ ε with ε = γ h/M and σ₀ of the mean depth.
    let strain = WEIGHT / 1200.0;
    close("strain energy", energy.strain, 2.0 * (0.5 * strain * strain * 1200.0 - 2.0 * WEIGHT * strain), 1e-9);
}

/// The same of neo-Hookean ground, soft enough to heave by several per cent: G (a − 1/a) + λ ln a/a + a σ₀ = −γ (2 − y) with σ₀ = −γ (3 − y)
/// gives the stretch a at every height.
#[test]
fn neo_hookean_ground_heaves_by_its_law() {
    let mut case = unloading(32, "neo_hookean", json!("static"));
    ["ground", "cut"].iter().for_each(|body| case["bodies"][body]["material"]["E"] = json!(300));
    let run = finish(&case);
    let [shear, lame] = [120.0, 120.0];
    let stretch = |y: f64| {
        let excess = |a: f64| shear * (a - 1.0 / a) + lame * a.ln() / a - WEIGHT * (3.0 - y) * a + WEIGHT * (2.0 - y);
        let [mut low, mut high] = [0.9, 1.5];
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if excess(middle) > 0.0 { &mut high } else { &mut low }) = middle;
        }
        low
    };
    let heave: f64 = (0..2000).map(|k| (stretch((k as f64 + 0.5) * 1e-3) - 1.0) * 1e-3).sum();
    assert!(heave > 0.1, "{heave}");
    close("heave", at(&run.model, run.last(), [1.0, 2.0])[1], heave, 1e-4 * heave);
}

/// In a dynamic step the force fades as well: nothing jumps, and a slow one ends with the heave of the static one.
#[test]
fn a_dynamic_step_fades_as_well() {
    let mut case = unloading(4, "linear", json!({"newmark": {}}));
    case["steps"][1]["duration"] = json!(40);
    let run = finish(&case);
    let first = &run.states[1];
    let share = 0.25 / 40.0;
    let acceleration = first.acceleration.iter().fold(0.0, |most: f64, a| most.max(a.abs()));
    assert!(acceleration < 3.0 * 10.0 * share, "{acceleration}");
    close("heave", at(&run.model, run.last(), [1.0, 2.0])[1], WEIGHT * 2.0 / 1200.0, 1e-3);
    let energy = run.last().energy;
    close("energy error", energy.error(), 0.0, 1e-9 * energy.external_work.abs().max(1.0));
}

/// A wide `ground` with a `cut` at its top, and a `wall` beside that, of some law, all under their weight; joined.
fn pit(law: &str, names: &[&str], steps: Value) -> Value {
    let block = |body: &str, corners: [[f64; 2]; 2], elements: [usize; 2], names: [Option<&str>; 4]| {
        let [[x, y], [right, top]] = corners;
        json!({"body": body, "corners": [[x, y], [right, y], [right, top], [x, top]], "elements": elements, "sides": names})
    };
    let side = Some("side");
    let mut blocks = vec![
        block("ground", [[0.0, 0.0], [3.0, 2.0]], [3, 2], [Some("bottom"), None, None, side]),
        block("ground", [[3.0, 0.0], [4.0, 2.0]], [1, 2], [Some("bottom"), None, None, None]),
        block("ground", [[4.0, 0.0], [6.0, 2.0]], [2, 2], [Some("bottom"), side, None, None]),
        block("ground", [[4.0, 2.0], [6.0, 4.0]], [2, 2], [None, side, Some("top"), None]),
    ];
    let others = [
        block("cut", [[0.0, 2.0], [3.0, 4.0]], [3, 2], [None, None, None, side]),
        block("wall", [[3.0, 2.0], [4.0, 4.0]], [1, 2], [None; 4]),
    ];
    blocks.extend(others.into_iter().filter(|block| names.contains(&block["body"].as_str().expect("a name"))));
    let body = json!({"material": {"model": law, "E": 300, "nu": 0.3, "density": 1}});
    let bodies: serde_json::Map<String, Value> = names.iter().map(|name| (name.to_string(), body.clone())).collect();
    json!({"mesh": {"blocks": blocks, "joined": if names.len() > 1 { json!([names]) } else { json!([]) }}, "bodies": bodies, "steps": steps})
}

fn gravity(bodies: &[&str]) -> Value {
    bodies.iter().map(|body| json!({"on": body, "gravity": {"y": -10}})).collect()
}

fn held() -> Value {
    json!([{"on": "bottom", "ux": 0, "uy": 0}, {"on": "side", "ux": 0}])
}

/// An excavation of elastic ground does not depend on the sequence: linear or not, what is left deforms as if the rest had never been there.
#[test]
fn staged_is_direct() {
    for (law, tolerance) in [("linear", 1e-11), ("neo_hookean", 1e-7)] {
        let settle = |bodies| json!({"name": "settle", "duration": 1, "dt": {"initial": 0.25}, "supports": held(), "loads": gravity(bodies)});
        let all = ["ground", "cut", "wall"];
        let staged = finish(&pit(
            law,
            &all,
            json!([
                settle(&all),
                {"name": "first", "duration": 1, "remove": ["wall"]},
                {"name": "second", "duration": 1, "remove": ["cut"]},
            ]),
        ));
        let direct = finish(&pit(law, &["ground"], json!([settle(&["ground"])])));
        for (node, place) in direct.model.mesh.nodes.iter().enumerate() {
            let [x, y] = at(&staged.model, staged.last(), (*place).into());
            let [own_x, own_y] = [direct.last().displacement[2 * node], direct.last().displacement[2 * node + 1]];
            close(law, x, own_x, tolerance);
            close(law, y, own_y, tolerance);
        }
        close(
            "reaction",
            staged.reaction("bottom", staged.last())[1],
            direct.reaction("bottom", direct.last())[1],
            1e-5,
        );
        let energy = staged.last().energy;
        let bound = if law == "linear" { 1e-11 } else { 1e-2 };
        close("energy error", energy.error(), 0.0, bound * energy.external_work.abs());
    }
}

fn strained_wall() -> Value {
    let mut case = pit(
        "neo_hookean",
        &["ground", "wall"],
        json!([
            {"name": "settle", "duration": 1, "dt": {"initial": 0.5}, "supports": held(), "loads": [{"on": "ground", "gravity": {"y": -20}}]},
            {"name": "build", "duration": 1, "dt": {"initial": 0.5}, "add": ["wall"]},
            {"name": "load", "duration": 1, "dt": {"initial": 0.5}, "loads": [{"on": "top", "pressure": 30}]},
        ]),
    );
    case["bodies"]["wall"]["material"]["E"] = json!(3000);
    case
}

/// A wall without weight comes where its nodes are: it has no stress there, and nothing moves, to round-off. It bears what comes later.
#[test]
fn a_wall_is_wished_in_place() {
    let run = finish(&strained_wall());
    let wall = run.model.bodies.iter().position(|body| body.name == "wall").expect("a wall");
    let stress = |state: &State| {
        let largest = |&e: &usize| {
            let u = run.model.mesh.vectors(e, &state.displacement);
            let stresses =
                run.model.solid(state, e).stresses(&*run.model.bodies[wall].material, &[], &u).expect("stresses");
            stresses.iter().flat_map(|stress| stress.components()).fold(0.0, |most: f64, s| most.max(s.abs()))
        };
        run.model.bodies[wall].elements.iter().map(largest).fold(0.0, f64::max)
    };
    let [before, born, loaded] = [1.0, 2.0, 3.0].map(|time| run.at(time));
    let moved = before.displacement.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    assert!(moved > 0.2, "{moved}");
    let step = distance(&before.displacement, &born.displacement);
    assert!(step < 1e-8 * moved, "{step:e}");
    assert!(stress(born) < 1e-5, "{}", stress(born));
    assert!(stress(loaded) > 1.0, "{}", stress(loaded));
    let energy = run.last().energy;
    close("energy error", energy.error(), 0.0, 0.01 * energy.external_work.abs());
}

/// What comes into a deformed model is, from then on, as if its mesh had been the one of that moment: a bar on two nodes that have moved, the
/// other two turned away with them and then pulled. Elastic laws of every kind of evaluation, rings and plates.
#[test]
fn what_comes_has_the_mesh_of_that_moment() {
    let frame = |right: [[f64; 2]; 2], bar: bool| {
        let [low, high] = right;
        let mut nodes = vec![[1.0, 0.0], low, high, [1.0, 1.0]];
        let (mut elements, mut points) = (json!({"frame": [[0, 1, 2, 3]]}), json!({"middle": [1, 2], "left": [0, 3]}));
        if bar {
            nodes.extend([[3.0, 0.0], [3.0, 1.0]]);
            elements["bar"] = json!([[1, 4, 5, 2]]);
            points["right"] = json!([4, 5]);
        }
        json!({"nodes": nodes, "elements": elements, "points": points})
    };
    let moved = |x: f64, y: f64| [x + 0.2 + 0.1 * y, y + 0.05 + 0.04 * y];
    let pull = |step: f64| {
        json!([{"on": "left", "ux": 0, "uy": 0}, {"on": "middle", "ux": {"rate": 0.0}, "uy": {"rate": 0.0}},
               {"on": "right", "ux": format!("{} * max(t - {step}, 0) * (1 + y)", 0.3), "uy": format!("0.2 * max(t - {step}, 0) * (1 - y)")}])
    };
    for section in [json!("plane_strain"), json!({"plane_stress": {"thickness": 0.5}}), json!("axisymmetric")] {
        for material in [
            json!({"model": "neo_hookean", "E": 100, "nu": 0.3}),
            json!({"model": "linear", "E": 100, "nu": 0.3}),
            json!({"model": "von_mises", "E": 100, "nu": 0.3, "sigma_y": 10}),
        ] {
            // In a plate nothing locks, and F-bar is refused.
            let elements = if section.is_object() { &["displacement"][..] } else { &["displacement", "f_bar"] };
            for element in elements {
                let body = json!({"material": material, "element": element});
                let mut case = json!({
                    "section": section, "mesh": frame([[2.0, 0.0], [2.0, 1.0]], true), "bodies": {"frame": body, "bar": body},
                    "steps": [
                        {"name": "move", "duration": 1, "dt": {"initial": 1.0}, "supports": [{"on": "left", "ux": 0, "uy": 0},
                            {"on": "middle", "ux": "t * (0.2 + 0.1 * y)", "uy": "t * (0.05 + 0.04 * y)"}]},
                        {"name": "come", "duration": 1, "dt": {"initial": 1.0}, "add": ["bar"], "supports": [{"on": "middle", "ux": {"rate": 0.0}, "uy": {"rate": 0.0}}]},
                        {"name": "pull", "duration": 1, "dt": {"initial": 0.25}, "supports": pull(2.0)},
                    ],
                });
                let staged = finish(&case);
                case["mesh"] = frame([moved(2.0, 0.0), moved(2.0, 1.0)], true);
                case["steps"] =
                    json!([{"name": "pull", "duration": 1, "dt": {"initial": 0.25}, "supports": pull(0.0)}]);
                case["steps"][0]["supports"][1] = json!({"on": "middle", "ux": 0, "uy": 0});
                let own = finish(&case);
                let [a, b] = [&staged, &own].map(|run| run.reaction("right", run.last()));
                assert!(b[0].abs() > 1.0, "{b:?}");
                (0..2).for_each(|i| close(&format!("{section} {material} {element}"), a[i], b[i], 1e-9 * b[0].abs()));
            }
        }
    }
}

/// The weight of what comes grows over the step, and so does its initial stress.
#[test]
fn weight_grows_over_the_step() {
    let mut case = unloading(2, "linear", json!("static"));
    case["steps"][0]["loads"] =
        json!([{"on": "ground", "gravity": {"y": "-10"}}, {"on": "cut", "gravity": {"y": "-10"}}]);
    case["steps"][1].as_object_mut().expect("keys").remove("remove");
    case["steps"][1]["add"] = json!(["cut"]);
    case["bodies"]["ground"]["initial_stress"]["geostatic"]["surface"] = json!(2);
    let run = finish(&case);
    for (time, share) in [(1.0, 0.0), (1.5, 0.5), (2.0, 1.0)] {
        let state = run.at(time);
        close("reaction", run.reaction("bottom", state)[1], WEIGHT * (2.0 + share), 1e-9);
        close("settlement", at(&run.model, state, [0.0, 2.0])[1], -share * WEIGHT * 2.0 / 1200.0, 1e-12);
    }
    // The fill is at rest under its own initial stress: it moves with what it lies on, without strain.
    close("top", at(&run.model, run.last(), [0.0, 3.0])[1], at(&run.model, run.last(), [0.0, 2.0])[1], 1e-12);
    let energy = run.last().energy;
    close("energy error", energy.error(), 0.0, 1e-11);
}

/// A block pressed on the ground and dragged, that goes, and another one that comes to its place in the mesh and is pressed down.
fn visitor() -> Value {
    let body = json!({"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}});
    let contact = |slave: &str| {
        json!({"slave": slave, "master": "ground_top",
            "friction": {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "r": 100, "kappa": 10, "xi": 0.002, "structure": 2}})
    };
    let mesh = Blocks::default()
        .rectangle("ground", [8, 3], [0.0, -1.0], [4.0, 0.0])
        .rectangle("block", [4, 2], [1.0, 0.0], [3.0, 1.0])
        .rectangle("guest", [4, 2], [1.0, 0.0], [3.0, 1.0]);
    json!({
        "mesh": mesh.json(),
        "bodies": {"ground": body, "block": body, "guest": body},
        "contacts": {"base": contact("block_bottom"), "other": contact("guest_bottom")},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.25}, "supports": [
                {"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.05}]},
            {"name": "drag", "duration": 1, "supports": [{"on": "block_top", "ux": 0.05}]},
            {"name": "go", "duration": 1, "remove": ["block"]},
            {"name": "wait", "duration": 1},
            {"name": "come", "duration": 1, "add": ["guest"], "supports": [{"on": "guest_top", "ux": 0, "uy": -0.05}]},
        ],
    })
}

#[test]
fn contacts_come_and_go_with_their_bodies() {
    let run = finish(&visitor());
    let pressed = run.contact_force(run.at(2.0));
    assert!(pressed[0] > 1.0 && pressed[1].abs() > 0.1, "{pressed:?}");
    let ground = run.nodes("ground");
    let moved = |state: &State| ground.iter().map(|node| state.displacement[2 * node + 1].abs()).fold(0.0, f64::max);
    // Half way, half of the pressure is left: the ground is elastic.
    let ratio = moved(run.at(2.5)) / moved(run.at(2.0));
    assert!((0.4..0.6).contains(&ratio), "{ratio}");
    for time in [2.25, 3.0, 4.0] {
        assert!(run.at(time).contacts[0].iter().all(|point| !point.is_closed()), "at {time}");
    }
    assert!(moved(run.at(4.0)) < 1e-12, "{}", moved(run.at(4.0)));
    // What comes is pressed as the one before was, in the same place of the mesh.
    let normal = |state: &State, contact: usize| -> f64 {
        state.contacts[contact].iter().map(|point| point.length * point.friction.pressure).sum()
    };
    close("pressed again", normal(run.last(), 1), normal(run.at(1.0), 0), 1e-6);
    assert!(normal(run.at(4.0), 1) == 0.0 && normal(run.last(), 0) == 0.0);
    let energy = run.last().energy;
    close("energy error", energy.error(), 0.0, 1e-3 * energy.external_work);
}

/// Bodies that have come, gone or stayed, in the residual of a step that changes them.
#[test]
fn the_tangent_is_that_of_the_residual() {
    // At the axis of a guest that is only pressed there is no shear, where the tangent of the law is that at a yield ratio of zero and
    // any slip, however small, has another.
    let mut visitor = visitor();
    visitor["steps"][4]["supports"][0]["ux"] = json!(0.02);
    for (case, step) in [(strained_wall(), 1), (strained_wall(), 2), (visitor.clone(), 2), (visitor, 4)] {
        let run = finish(&case);
        let (step, span) = (&run.model.steps[step], run.model.steps[step].span);
        let old =
            run.states.iter().rfind(|state| state.time < span.end && state.time > span.start).expect("an increment");
        let new = run.at(span.end);
        let error =
            tangent_error(&run.model, Trial::new(old, step, span.end, span.end - old.time), &new.displacement, 1e-6);
        assert!(error < 1e-6, "{}: {error:e}", step.name);
    }
}

#[test]
fn what_makes_no_sense_is_refused() {
    let refused = |told: &str, change: &dyn Fn(&mut Value)| {
        let mut case = visitor();
        change(&mut case);
        let said = refusal(&case);
        assert!(said.contains(told), "{said}\nlacks: {told}");
    };
    refused("steps[2].remove[1]", &|case| case["steps"][2]["remove"] = json!(["block", "rock"]));
    refused("`block` is not there in this step", &|case| case["steps"][3]["remove"] = json!(["block"]));
    refused("steps[4].add[0]: `guest` is there already", &|case| case["steps"][3]["add"] = json!(["guest"]));
    refused("`block` comes or goes twice", &|case| case["steps"][2]["remove"] = json!(["block", "block"]));
    refused("bodies cannot be added or removed in the first step", &|case| {
        case["steps"][0]["remove"] = json!(["block"])
    });
    refused("steps[3].loads: the pressure on block_top acts on `block`", &|case| {
        case["steps"][3]["loads"] = json!([{"on": "block_top", "pressure": 1}]);
    });
    refused("steps[2].loads: the force on block_right acts on `block`", &|case| {
        case["steps"][1]["loads"] = json!([{"on": "block_right", "force": {"x": 1}}]);
    });
    refused("block_top belongs to bodies that are not there", &|case| {
        case["steps"][3]["supports"] = json!([{"on": "block_top", "ux": 0}]);
    });
    refused("explicit and quasi-dynamic", &|case| {
        ["ground", "block"].iter().for_each(|body| case["bodies"][body]["material"]["density"] = json!(1));
        case["steps"][3]["scheme"] = json!({"explicit": {}});
    });
    refused("is tied", &|case| {
        case["contacts"]["other"]["tied"] = json!(true);
        case["contacts"]["other"].as_object_mut().expect("keys").remove("friction");
    });
    refused("`ground` can move freely", &|case| {
        case["steps"][0]["supports"] = json!([{"on": "block_top", "ux": 0, "uy": 0}]);
    });
    refused("the contact `base` has a side on several bodies, some of which are absent", &|case| {
        let edges = &case["mesh"]["edges"];
        let both =
            [&edges["block_bottom"], &edges["guest_bottom"]].map(|edges| edges.as_array().expect("edges").clone());
        case["mesh"]["edges"]["block_bottom"] = json!(both.concat());
    });
    refused("`balanced` initial tractions", &|case| {
        case["contacts"]["base"]["initial"] = json!({"pressure": 1, "balanced": true});
    });
    refused("loading platen", &|case| case["plates"] = json!(["block_top"]));
}

/// What holds a body may go: on a smooth plane, without what it hung on, it is free, and it alone is named.
#[test]
fn what_has_gone_holds_nothing_and_is_not_named() {
    let body = json!({"material": {"model": "linear", "E": 100, "nu": 0.3}});
    let block = |body: &str, low: f64, high: f64, rows: usize| {
        let is_joined = |side: &str| [("block", "top"), ("cut", "bottom")].contains(&(body, side));
        let sides = ["bottom", "right", "top", "left"].map(|side| (!is_joined(side)).then(|| format!("{body}_{side}")));
        json!({"body": body, "corners": [[0, low], [1, low], [1, high], [0, high]], "elements": [2, rows], "sides": sides})
    };
    let case = json!({
        "mesh": {"joined": [["block", "cut"]],
            "blocks": [block("block", 0.0, 1.0, 2), block("cut", 1.0, 2.0, 2)]},
        "bodies": {"block": body, "cut": body},
        "contacts": {"base": {"slave": "block_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "friction": {"law": "frictionless"}}},
        "steps": [
            {"name": "press", "duration": 1, "supports": [{"on": "cut_top", "ux": 0, "uy": -0.01}]},
            {"name": "go", "duration": 1, "remove": ["cut"]},
        ],
    });
    let (_, result) = fecontact::run::run(&Arc::new(model(&case)), &mut []);
    let said = result.expect_err("it slides").to_string();
    assert!(said.contains("nothing resists the motion of body `block` along x"), "{said}");
}

/// A column of `ground` with a warm `cut` on it that goes and comes back warm, to the place that it has by then, and is heated on; a feather
/// on top goes with the first change. Whatever the temperature does, at constant displacement its work is what the bodies store: linear
/// bodies balance to round-off, in static steps and by the trapezoidal rule.
#[test]
fn bodies_come_and_go_with_their_heat() {
    for (scheme, dt) in [(json!("static"), 0.25), (json!({"newmark": {}}), 0.05)] {
        for [warm, jump, back] in [["1", "0", "1 + 0*t"], ["-1", "2", "0.5 + t"], ["0", "1 + 0*t", "2"]] {
            let mut mesh = column(2, 1.0, ["ground", "cut"], None);
            let feather = json!({"body": "feather", "corners": [[0, 3], [1, 3], [1, 3.5], [0, 3.5]], "elements": [1, 1], "sides": [null, null, null, null]});
            mesh["blocks"].as_array_mut().expect("blocks").push(feather);
            mesh["blocks"][1]["sides"][2] = Value::Null;
            mesh["joined"][0] = json!(["ground", "cut", "feather"]);
            let body = |stiffness: f64, expansion: f64| json!({"material": {"model": "linear", "E": stiffness, "nu": 0.25, "density": 2}, "thermal": {"expansion": expansion}});
            let case = json!({
                "mesh": mesh,
                "bodies": {"ground": body(1000.0, 0.01), "cut": body(1000.0, 0.02), "feather": body(0.001, 0.0)},
                "steps": [
                    {"name": "rest", "duration": 1, "scheme": scheme, "dt": {"initial": dt}, "loads": gravity(&["ground", "cut"]),
                     "temperature": {"ground": warm, "cut": warm},
                     "supports": [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "side", "ux": 0}]},
                    {"name": "jump", "duration": 1, "remove": ["feather"], "temperature": {"ground": jump, "cut": jump}},
                    {"name": "go", "duration": 1, "remove": ["cut"]},
                    {"name": "come", "duration": 1, "add": ["cut"], "temperature": {"cut": back}, "loads": gravity(&["cut"])},
                ],
            });
            let run = finish(&case);
            let most = run.states.iter().map(|state| state.energy.strain).fold(0.0, f64::max);
            for state in &run.states {
                close("energy error", state.energy.error(), 0.0, 1e-11 * most.max(1.0));
            }
        }
    }
}

/// Ground that heaves by more than a tenth where it is relieved takes nodes of what has gone with it: the absent body is not named.
#[test]
fn what_is_absent_is_not_strained() {
    let mut case = unloading(2, "linear", json!("static"));
    for body in ["ground", "cut"] {
        case["bodies"][body]["material"]["E"] = json!(50);
    }
    let (mut warnings, model) = (Warnings::default(), Arc::new(model(&case)));
    fecontact::run::run(&model, &mut [&mut warnings]).1.unwrap_or_else(|error| panic!("{error}"));
    let strained: Vec<&String> = warnings.list.iter().filter(|warning| warning.contains("whose squares")).collect();
    assert!(strained.len() == 1 && strained[0].contains("body `ground`"), "{:?}", warnings.list);
}

/// A place that has become too narrow for what comes is told, with element and place.
#[test]
fn a_narrow_place_is_told() {
    let body = json!({"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}});
    let case = json!({
        "mesh": {"nodes": [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1]], "elements": {"frame": [[0, 1, 2, 3]], "bar": [[1, 4, 5, 2]]},
                 "points": {"middle": [1, 2], "left": [0, 3]}},
        "bodies": {"frame": body, "bar": body},
        "steps": [
            {"name": "move", "duration": 1, "supports": [{"on": "left", "ux": 0, "uy": 0}, {"on": "middle", "ux": 0.6, "uy": 0}]},
            {"name": "come", "duration": 1, "add": ["bar"]},
        ],
    });
    let (_, result) = fecontact::run::run(&Arc::new(model(&case)), &mut []);
    let said = result.expect_err("no place").to_string();
    assert!(said.contains("of body `bar` at (1.5, 0.5) would be added with 40 % of its size"), "{said}");
}

/// The excavation of the gallery. Nothing moves before, and little while the wall is installed, which is heavier than the ground; then it leans into
/// the pit, whose bottom heaves, and the ground behind the wall yields and settles. Numbers are those of the gallery, to what a finer mesh
/// changes. The wall's moment is that of the tractions on its faces above a section.
#[test]
fn an_excavation_beside_a_wall() {
    let path = crate::common::repository("cases/excavation.json");
    let case: Value = serde_json::from_str(&std::fs::read_to_string(&path).expect("the case")).expect("JSON");
    let run = finish(&case);
    assert!(run.at(1.0).displacement.iter().all(|u| u.abs() < 1e-12));
    let most = run.at(101.0).displacement.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    assert!(most < 0.5e-3, "{most}");
    let head = run.nodes("head")[0];
    for (time, lean) in [(301.0, 0.5e-3), (401.0, 2.7e-3), (501.0, 8.8e-3)] {
        close("head", run.at(time).displacement[2 * head], -lean, 0.05 * lean + 0.05e-3);
    }
    close("heave", at(&run.model, run.last(), [-6.0, -4.0])[1], 14.4e-3, 0.1e-3);
    let sections = fecontact::output::sections::along(&run.model.requests.sections[0], &run.model, run.last());
    let [deepest, _] = sections.iter().fold([0.0, 0.0], |most: [f64; 2], of| match of.moment < most[0] {
        true => [of.moment, of.place.y],
        false => most,
    });
    close("moment", deepest, -53.0, 2.0);
    let middle = sections.iter().find(|of| of.place.y == -3.0).expect("a section");
    let outside = run.model.contacts.iter().position(|pair| pair.name == "outside").expect("a contact");
    let (pair, states) = (&run.model.contacts[outside], &run.last().contacts[outside]);
    let above = pair.points.iter().zip(states).filter_map(|(point, state)| {
        let y = point.at(&run.model.mesh.undeformed()).y;
        let [p, q] = state.tractions();
        // p on the face at x = t pushes to the left, q along it, half the thickness from the axis.
        let half = if (y + 3.0).abs() < 1e-9 { 0.5 } else { 1.0 };
        (y > -3.0 - 1e-9).then(|| half * state.length * (p * (y + 3.0) - 0.2 * q.abs()))
    });
    close("M of the tractions", -above.sum::<f64>(), middle.moment, 0.1 * middle.moment.abs() + 0.5);
    let energy = run.last().energy;
    assert!(energy.plastic_dissipation > 0.1 && energy.error().abs() < 1e-3 * energy.external_work.abs());
}
