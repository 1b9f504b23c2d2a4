//! What a model does not touch has no say in it: neither a body far away, however stiff and large, nor a wider bed.

use crate::common::{Finished, close, finish, model};
use serde_json::{Value, json};

/// A rigid disk on a bed of rubber, pressed in and then drawn along under a force, free to sink and to roll.
fn rolled(stabilize: Option<f64>) -> Value {
    let mut drag = json!({"name": "drag", "duration": 1, "dt": {"initial": 0.1}, "loads": [{"on": "disk", "force": {"y": -2.0}}],
        "supports": [{"on": "disk", "ux": 0.6, "uy": null, "angle": null}]});
    if let Some(share) = stabilize {
        drag["stabilize"] = json!(share);
    }
    json!({
        "mesh": {"blocks": [{"body": "rubber", "corners": [[-4, -2], [4, -2], [4, 0], [-4, 0]], "elements": [16, 4],
            "sides": ["base", null, "top", null]}]},
        "bodies": {"rubber": {"material": {"model": "neo_hookean", "E": 10, "nu": 0.4, "density": 0.01}}},
        "rigid_bodies": {"disk": {"reference": [0, 2], "inertia": 1.5}},
        "point_masses": {"disk": {"mass": 1.0}},
        "contacts": {"c": {"slave": "top", "master": {"circle": {"centre": [0, 2], "radius": 2}}, "rigid_body": "disk", "friction":
            {"law": "super_subloading", "mu_s": 0.5, "mu_k": 0.3, "r": 50, "kappa": 5, "xi": 0}}},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.1},
             "supports": [{"on": "base", "ux": 0, "uy": 0}, {"on": "disk", "ux": 0, "uy": -0.2, "angle": 0}]},
            drag,
        ],
    })
}

/// The disk falls on the bed and spins up under a moment; the error of r θ decides on the increments.
fn spun() -> Value {
    let mut case = rolled(None);
    case["point_masses"]["disk"]["velocity"] = json!([0.5, -1.0]);
    case["steps"] = json!([{"name": "fly", "duration": 0.3, "scheme": {"generalized_alpha": {}},
        "dt": {"initial": 0.001, "error": 1e-4, "max": 0.02}, "supports": [{"on": "base", "ux": 0, "uy": 0}],
        "loads": [{"on": "disk", "moment": "200*t"}]}]);
    case
}

/// The case with a held body a thousand times as far away as the model is large.
fn beside(mut case: Value, young: f64) -> Value {
    let [near, far] = [8e3, 8.1e3];
    let block = json!({"body": "idle", "corners": [[near, 0], [far, 0], [far, 1], [near, 1]], "elements": [2, 1],
        "sides": ["held", null, null, null]});
    case["mesh"]["blocks"].as_array_mut().expect("blocks").push(block);
    case["bodies"]["idle"] = json!({"material": {"model": "linear", "E": young, "nu": 0.3, "density": 0.01}});
    let supports = case["steps"][0]["supports"].as_array_mut().expect("supports");
    supports.push(json!({"on": "held", "ux": 0, "uy": 0}));
    case
}

/// Angle of the disk, and how far it has sunk.
fn course(run: &Finished) -> Vec<[f64; 3]> {
    let body = run.model.mesh.rigid_body("disk").expect("it is there");
    let of = |u: &[f64]| [u[2 * body.turning] / body.radius, u[2 * body.reference + 1]];
    let row = |state: &fecontact::model::state::State| {
        let [angle, sunk] = of(&state.displacement);
        [state.time, angle, sunk]
    };
    run.states.iter().map(row).collect()
}

#[test]
fn a_body_far_away_changes_nothing() {
    for case in [rolled(None), rolled(Some(1e-3)), spun()] {
        let alone = course(&finish(&case));
        for young in [10.0, 2e11] {
            let with = course(&finish(&beside(case.clone(), young)));
            assert_eq!(alone.len(), with.len(), "the same increments");
            for (a, b) in alone.iter().zip(&with) {
                (0..3).for_each(|i| close("the disk", b[i], a[i], 1e-9 * a[i].abs().max(1e-3)));
            }
        }
    }
}

/// A rupture is over when a shear wave has crossed what touches, 8 wide and with the disk 4 high, at √(G/ρ): a body far away, however slow
/// its waves, does not prolong it.
#[test]
fn a_body_far_away_prolongs_no_rupture() {
    let calm = |mut case: Value| {
        case["steps"][1]["rupture"] = json!({"slip_rate": 1.0});
        model(&case).steps[1].rupture.as_ref().expect("a rupture").calm
    };
    let crossed = 8f64.hypot(4.0) / (10.0 / 2.8 / 0.01f64).sqrt();
    close("alone", calm(rolled(None)), crossed, 1e-9);
    close("beside another", calm(beside(rolled(None), 1e-3)), crossed, 1e-9);
}

/// The disk is drawn by 0.6 over a bed that goes on to both sides, or ends where it has no part in the contact any more.
#[test]
fn a_wider_bed_changes_nothing_that_stabilize_does() {
    let angles = [8.0, 80.0].map(|width: f64| {
        [None, Some(1e-3)].map(|stabilize| {
            let mut case = rolled(stabilize);
            let rest = json!({"body": "rubber", "corners": [[4, -2], [width - 4.0, -2], [width - 4.0, 0], [4, 0]], "elements": [8, 4],
                "grading": [width / 8.0, 1], "sides": ["base", null, null, null]});
            if width > 8.0 {
                case["mesh"]["blocks"].as_array_mut().expect("blocks").push(rest);
            }
            course(&finish(&case)).last().expect("states")[1]
        })
    });
    // It rolls by 0.6 on a radius of about 2; the dashpots are gone at the end of the step.
    for [free, aided] in angles {
        close("the angle", free, -0.6 / 2.0, 0.01);
        close("the angle with dashpots", aided, free, 1e-3);
    }
}

/// A block that is drawn over a bed; the bed's surface goes on, after a gap, on a held body of another stiffness and density, which the block
/// never meets, or the block's group goes on, on a body far above the block: the default penalties, the impedance of radiation and all that moves are as without it.
#[test]
fn a_held_body_that_a_contact_does_not_meet_changes_nothing() {
    let ended = |idle: Option<(&str, f64)>| {
        let block = |body: &str, x: [f64; 2], y: [f64; 2], sides: [&str; 2]| {
            json!({"body": body, "corners": [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]], "elements": [3, 1],
                "sides": [sides[0], null, sides[1], null]})
        };
        let mut case = json!({
            "mesh": {"blocks": [block("bed", [0.0, 4.0], [-1.0, 0.0], ["foot", "ground"]),
                block("slider", [1.1, 2.6], [0.0, 0.5], ["sole", "head"])]},
            "contacts": {"c": {"slave": "sole", "master": "ground", "radiation_damping": true, "friction":
                {"law": "super_subloading", "mu_s": 0.5, "mu_k": 0.3, "r": 50, "kappa": 5, "xi": 0}}},
            "steps": [{"name": "drag", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "foot", "ux": 0, "uy": 0},
                {"on": "head", "ux": "0.02*t", "uy": -0.005}]}],
        });
        let material = |young: f64| json!({"material": {"model": "linear", "E": young, "nu": 0.3, "density": young}});
        case["bodies"] = json!({"bed": material(100.0), "slider": material(50.0)});
        if let Some((side, young)) = idle {
            let further = match side {
                "ground" => block("further", [4.5, 9.0], [-1.0, 0.0], ["held", "ground"]),
                _ => block("further", [1.0, 3.0], [2.0, 5.0], ["sole", "held"]),
            };
            case["mesh"]["blocks"].as_array_mut().expect("blocks").push(further);
            case["bodies"]["further"] = material(young);
            let supports = case["steps"][0]["supports"].as_array_mut().expect("supports");
            supports.push(json!({"on": "held", "ux": 0, "uy": 0}));
        }
        let run = finish(&case);
        let (pair, bed) = (&run.model.contacts[0], 16 * 2);
        ([pair.alpha_n, pair.laws[0].description.stiffness, pair.radiation], run.last().displacement[..bed].to_vec())
    };
    let (stiffnesses, alone) = ended(None);
    // The softer side: λ + 2G of the slider over the depth of its element.
    close("alpha_n", stiffnesses[0], 300.0 * 50.0 * 0.7 / (1.3 * 0.4) / 0.5, 1e-9);
    for idle in [("ground", 1.0), ("ground", 1e4), ("sole", 1.0), ("sole", 1e4)] {
        let (with, displacement) = ended(Some(idle));
        assert_eq!(with, stiffnesses, "stiffnesses and impedance beside {idle:?}");
        let far = alone.iter().zip(&displacement).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(far < 1e-12, "displacements differ by {far:e}");
    }
}

/// A ring with a bore as narrow as a hair is a ring: a body far away does not make its bore part of the axis, which would be held.
#[test]
fn a_narrow_bore_is_no_axis() {
    let widened = |far: bool| {
        let block = |body: &str, x: [f64; 2], y: [f64; 2], sides: Value| json!({"body": body, "corners": [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]], "elements": [4, 1], "sides": sides});
        let mut case = json!({
            "section": "axisymmetric",
            "mesh": {"blocks": [block("ring", [1e-6, 1.0], [0.0, 1.0], json!(["foot", "skin", null, null]))]},
            "bodies": {"ring": {"material": {"model": "linear", "E": 100, "nu": 0.3}}},
            "steps": [{"name": "pull", "duration": 1, "supports": [{"on": "foot", "uy": 0}], "loads": [{"on": "skin", "pressure": -1}]}],
        });
        if far {
            let idle = block("idle", [1.0, 2.0], [1e7, 1e7 + 1.0], json!(["held", null, null, null]));
            case["mesh"]["blocks"].as_array_mut().expect("blocks").push(idle);
            case["bodies"]["idle"] = case["bodies"]["ring"].clone();
            case["steps"][0]["supports"]
                .as_array_mut()
                .expect("supports")
                .push(json!({"on": "held", "ux": 0, "uy": 0}));
        }
        finish(&case).last().displacement[0]
    };
    let alone = widened(false);
    assert!(alone > 1e-9, "it widens by its strain of a hundredth, {alone:e}");
    close("beside another", widened(true), alone, 1e-6 * alone);
}
