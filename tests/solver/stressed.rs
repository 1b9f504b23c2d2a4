//! Contacts that come in a later step, between ground under stress and what is built into it.

use crate::common::{close, finish, refusal};
use fecontact::model::state::State;
use serde_json::{Value, json};

const WEIGHT: f64 = 18.0;
const REST: f64 = 0.5;

/// Ground of 8 × 10 under K₀ with a wall of 1 × 6 in its middle, which replaces a plug of the ground in the second step.
fn installed(kind: &str, wall: f64, of_bodies: bool) -> Value {
    let block = |body: &str, [x, y]: [f64; 2], [right, top]: [f64; 2], elements: [usize; 2], sides: Value| json!({"body": body, "corners": [[x, y], [right, y], [right, top], [x, top]], "elements": elements, "kind": kind, "sides": sides});
    let ground = json!({"geostatic": {"surface": 0, "weight": WEIGHT, "K0": REST}});
    let sand = json!({"model": "mohr_coulomb", "E": 40000, "nu": 0.3, "c": 1, "phi": 33, "psi": 3, "density": 1.8});
    let contact = |slave: &str, master: &str| {
        let mut contact = json!({"slave": slave, "master": master, "interface": {"reduction": 0.67}});
        if of_bodies {
            contact["initial"] = json!({"of_bodies": true});
        }
        contact
    };
    let gravity = |body: &str| json!({"on": body, "gravity": {"y": "-10"}});
    json!({
        "mesh": {"joined": [["soil", "plug"]], "blocks": [
            block("soil", [0.0, -10.0], [4.0, -6.0], [4, 4], json!(["floor", null, null, "far"])),
            block("soil", [4.0, -10.0], [5.0, -6.0], [2, 4], json!(["floor", null, "below", null])),
            block("soil", [5.0, -10.0], [9.0, -6.0], [4, 4], json!(["floor", "far", null, null])),
            block("soil", [0.0, -6.0], [4.0, 0.0], [4, 6], json!([null, "left", null, "far"])),
            block("soil", [5.0, -6.0], [9.0, 0.0], [4, 6], json!([null, "far", null, "right"])),
            block("plug", [4.0, -6.0], [5.0, 0.0], [2, 6], json!([null, null, null, null])),
            block("wall", [4.0, -6.0], [5.0, 0.0], [2, 6], json!(["tip", "wall_right", "head", "wall_left"])),
        ]},
        "bodies": {
            "soil": {"material": sand, "initial_stress": ground},
            "plug": {"material": sand, "initial_stress": ground},
            "wall": {"material": {"model": "linear", "E": 2e7, "nu": 0.2, "density": wall}, "initial_stress": ground}
        },
        "contacts": {"left": contact("left", "wall_left"), "right": contact("right", "wall_right"), "tip": contact("below", "tip")},
        "steps": [
            {"name": "rest", "duration": 1, "dt": {"initial": 1},
             "supports": [{"on": "floor", "ux": 0, "uy": 0}, {"on": "far", "ux": 0}], "loads": [gravity("soil"), gravity("plug")]},
            {"name": "install", "duration": 1, "dt": {"initial": 0.25}, "remove": ["plug"], "add": ["wall"], "loads": [gravity("wall")]}
        ]
    })
}

fn most(state: &State) -> f64 {
    state.displacement.iter().fold(0.0, |most: f64, u| most.max(u.abs()))
}

/// Force of a contact: of p and of q.
fn force(contact: usize, state: &State) -> [f64; 2] {
    state.contacts[contact].iter().fold([0.0; 2], |sum, point| {
        let [p, q] = point.tractions();
        [sum[0] + p * point.length, sum[1] + q * point.length]
    })
}

/// A wall as heavy as the ground, wished in place of it, changes nothing: no displacement, p = K₀ γ z along its sides and γ z at its toe, q = 0. With
/// Q4, Q8 and triangles.
#[test]
fn a_wall_is_wished_in_place_of_ground_under_stress() {
    for kind in ["Q4", "Q8", "T6"] {
        let run = finish(&installed(kind, 1.8, true));
        for time in [1.25, 2.0] {
            let state = run.at(time);
            assert!(most(state) < 1e-9, "{kind}: {}", most(state));
            for (contact, ratio) in [(0, REST), (1, REST), (2, 1.0)] {
                for (point, own) in run.model.contacts[contact].points.iter().zip(&state.contacts[contact]) {
                    let at = point.mean(|at| -WEIGHT * at.y, &run.model.mesh.undeformed());
                    let [p, q] = own.tractions();
                    // A node at an end stands for the half edge beside it.
                    close(&format!("{kind} p"), p, ratio * at, 1e-6 * WEIGHT * 6.0);
                    close(&format!("{kind} q"), q, 0.0, 1e-6 * WEIGHT * 6.0);
                }
            }
            close("energy error", state.energy.error(), 0.0, 1e-9 * WEIGHT);
        }
    }
}

/// The same in ground with water, of which 10 kN/m³ are the water's: in its pores, or given. What bodies carry is total, K₀ γ′ z + u = 252 on each side,
/// what the contact has is that, or the part that the water leaves, K₀ γ′ z = 72, also where friction knows the water by an expression.
#[test]
fn a_wall_is_wished_in_place_of_ground_with_water() {
    let water = "-10*y";
    let [kept, given] = [
        ("pore_fluid", json!({"bulk_modulus": 2.2e6, "porosity": 0.4, "pressure": water})),
        ("pore_pressure", json!({"pressure": water})),
    ];
    for (pores, fluid, side) in [
        (&kept, Value::Null, 252.0),
        (&kept, json!(water), 72.0),
        (&given, Value::Null, 252.0),
        (&given, json!("of_bodies"), 72.0),
    ] {
        let mut case = installed("T6", 1.8, true);
        for body in ["soil", "plug"] {
            case["bodies"][body]["initial_stress"]["geostatic"]["weight"] = json!(WEIGHT - 10.0);
            case["bodies"][body][pores.0] = pores.1.clone();
        }
        case["bodies"]["wall"]["initial_stress"]["geostatic"]["K0"] = json!((REST * (WEIGHT - 10.0) + 10.0) / WEIGHT);
        for contact in ["left", "right", "tip"] {
            case["contacts"][contact]["fluid_pressure"] = fluid.clone();
        }
        let run = finish(&case);
        assert!(most(run.last()) < 1e-9, "{}: {}", pores.0, most(run.last()));
        for contact in [0, 1] {
            close("side", force(contact, run.last())[0], side, 1e-6 * 252.0);
        }
    }
    let mut case = installed("T6", 1.8, true);
    case["bodies"]["soil"][kept.0] = kept.1.clone();
    case["bodies"]["plug"][kept.0] = kept.1.clone();
    case["contacts"]["left"]["fluid_pressure"] = json!("of_bodies");
    let said = refusal(&case);
    assert!(said.contains("contacts.left.fluid_pressure") && said.contains("an expression"), "{said}");
}

/// A heavier wall goes down by its excess alone, under which its toe and its sides bear more: 6 (25 − 18) in all.
#[test]
fn a_heavier_wall_adds_its_excess() {
    let run = finish(&installed("Q8", 2.5, true));
    let state = run.last();
    let [left, right, tip] = [0, 1, 2].map(|contact| force(contact, state));
    // q resists the slip of the slave along s = n turned by −90°, n out of the master: up on both sides of the wall.
    let borne = tip[0] + left[1].abs() + right[1].abs();
    close("excess", borne - WEIGHT * 6.0, 6.0 * 7.0, 1e-4 * 42.0);
    assert!(most(state) < 3e-3 && most(state) > 1e-5, "{}", most(state));
    let sides = 0.5 * REST * WEIGHT * 36.0;
    close("left", left[0], sides, 0.05 * sides);
}

/// Without it the ground comes to bear on the wall over the step, and moves on its way: by what the penalty and the wall give.
#[test]
fn otherwise_the_forces_of_the_plug_pass_over() {
    let run = finish(&installed("Q8", 1.8, false));
    let [left, _, _] = [0, 1, 2].map(|contact| force(contact, run.last()));
    let sides = 0.5 * REST * WEIGHT * 36.0;
    close("left", left[0], sides, 0.05 * sides);
    assert!(most(run.last()) > 1e-6);
}

/// Ground that has settled before: the wall fits it there, and bears what the ground bore.
#[test]
fn ground_may_have_moved_before() {
    let mut case = installed("Q8", 1.8, true);
    for body in ["soil", "plug"] {
        case["bodies"][body].as_object_mut().expect("keys").remove("initial_stress");
        case["bodies"][body]["material"] = json!({"model": "linear", "E": 10000, "nu": 1.0 / 3.0, "density": 1.8});
    }
    for contact in ["left", "right", "tip"] {
        case["contacts"][contact]["interface"] = json!({"cohesion": 1, "friction_angle": 20});
    }
    case["steps"][0]["loads"] =
        ["soil", "plug"].iter().map(|body| json!({"on": body, "gravity": {"y": -10}})).collect();
    let run = finish(&case);
    let [before, after] = [run.at(1.0), run.last()];
    // γ (H² − y²)/2 M of the surface, M = 15000.
    close("settled", most(before), WEIGHT * 100.0 / 2.0 / 15000.0, 1e-9);
    let soil = run.model.bodies.iter().find(|body| body.name == "soil").expect("soil");
    let moved = soil.nodes.iter().map(|&node| {
        (0..2).map(|i| (after.displacement[2 * node + i] - before.displacement[2 * node + i]).abs()).fold(0.0, f64::max)
    });
    let moved = moved.fold(0.0, f64::max);
    assert!(moved < 1e-3 * most(before), "{moved:e}");
    let sides = 0.5 * 0.5 * WEIGHT * 36.0;
    for contact in [0, 1] {
        close("side", force(contact, after)[0], sides, 5e-3 * sides);
    }
}

/// A side between two bodies that both stay, and a contact while both are there, are refused.
#[test]
fn what_cannot_part_is_refused() {
    let mut case = installed("Q4", 1.8, true);
    case["steps"][1]["remove"] = json!([]);
    let said = refusal(&case);
    assert!(said.contains("lies between") && said.contains("only if a step removes the other"), "{said}");
    let mut case = installed("Q4", 1.8, true);
    case["steps"][1]["remove"] = json!([]);
    let later = json!({"name": "later", "duration": 1, "remove": ["plug"]});
    case["steps"].as_array_mut().expect("steps").push(later);
    let said = refusal(&case);
    assert!(said.contains("that two present bodies share"), "{said}");
    let mut case = installed("Q4", 1.8, true);
    case["contacts"]["left"]["initial"] = json!({"pressure": 10});
    let said = refusal(&case);
    assert!(said.contains("\"initial\": {\"of_bodies\": true}"), "{said}");
}
