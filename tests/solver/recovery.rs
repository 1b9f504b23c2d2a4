//! Stresses at nodes and probes: a linear field exactly, Lamé's closed forms at surfaces, bodies of one layer, bonded bodies.

use std::f64::consts::FRAC_PI_2;

use crate::common::{self, Blocks, Finished, close, finish, half_way, quadratic};
use fecontact::laws::bulk::CauchyStress;
use fecontact::model::{Model, State};
use fecontact::output::recovery::NodalRecovery;
use serde_json::{Value, json};

const E: f64 = 200.0;
const NU: f64 = 0.3;

/// Cauchy stress at the nodes.
fn nodal_stresses(model: &Model, state: &State) -> Vec<CauchyStress> {
    let fields = NodalRecovery::new(model).fields(model, state);
    fields.tensors.into_iter().map(|(stress, _)| stress).collect()
}

fn linear() -> Value {
    json!({"material": {"model": "linear", "E": E, "nu": NU}})
}

/// A grid of parallelograms of growing width, of one kind of elements; `skew` moves its top.
fn grid(kind: &str, [columns, rows]: [usize; 2], unsymmetric: f64) -> Value {
    let map = |s: f64, t: f64| [1.0 + s * (1.0 + s) + unsymmetric * t, 0.7 * t];
    let mesh = Blocks::default().block("body", [columns, rows], map).json();
    match kind {
        "Q4" | "f_bar" => mesh,
        "Q8" | "reduced" => quadratic(&mesh, half_way),
        _ => {
            let block = json!({"body": "body", "corners": [[1, 0], [3, 0], [3.0 + unsymmetric, 0.7], [1.0 + unsymmetric, 0.7]], "elements": [columns, rows],
                               "sides": ["body_bottom", "body_right", "body_top", "body_left"], "grading": [3, 1], "kind": kind});
            json!({"blocks": [block]})
        }
    }
}

fn case(section: &Value, mesh: Value, body: Value, loads: Value) -> Value {
    let mut case = json!({
        "section": section, "mesh": mesh, "bodies": {"body": body},
        "steps": [{"name": "load", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "body_bottom", "uy": 0}], "loads": loads}]
    });
    if section.is_null() {
        case.as_object_mut().expect("an object").remove("section");
    }
    case
}

/// The strains of these displacements are linear in the place, the hoop strain of rings too: every nodal stress is exact, at
/// surfaces and corners as well, and so is every probe's.
#[test]
fn a_linear_field_is_recovered_to_round_off() {
    let [a, b, c, d, e] = [1e-3, 2e-3, -1.5e-3, 1e-3, 0.7e-3];
    for section in [Value::Null, json!("axisymmetric"), json!({"plane_stress": {"thickness": 0.3}})] {
        for kind in ["Q4", "Q8", "reduced", "T6"] {
            // Q4 has u_r ∝ r z on rectangles alone.
            let unsymmetric = if section.is_string() { 0.0 } else { 0.2 };
            let mut body = linear();
            if kind == "reduced" {
                body["element"] = json!("reduced");
            }
            let mut case = case(&section, grid(kind, [6, 5], unsymmetric), body, json!([]));
            case["steps"][0]["supports"] = json!([{"on": "body", "ux": 0, "uy": 0}]);
            case["probes"] =
                json!({"corner": {"at": [1.0, 0.0]}, "inside": {"at": [2.07, 0.31]}, "side": {"at": [2.0, 0.7]}});
            let model = common::model(&case);
            let mut state = model.initial_state();
            for (node, at) in model.mesh.nodes.iter().enumerate() {
                state.displacement[2 * node] = a * at.x + b * at.x * at.y;
                state.displacement[2 * node + 1] = c * at.x * at.x + d * at.x * at.y + e * at.y * at.y;
            }
            let exact = |x: f64, y: f64| {
                let [xx, yy] = [a + b * y, d * x + 2.0 * e * y];
                let shear = b * x + 2.0 * c * x + d * y;
                let (lambda, g) = (E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), 0.5 * E / (1.0 + NU));
                let zz = match &section {
                    Value::Null => 0.0,
                    Value::String(_) => a + b * y,
                    _ => -lambda / (lambda + 2.0 * g) * (xx + yy),
                };
                let trace = lambda * (xx + yy + zz);
                [trace + 2.0 * g * xx, trace + 2.0 * g * yy, trace + 2.0 * g * zz, g * shear]
            };
            let differ = |found: &CauchyStress, [x, y]: [f64; 2]| {
                let found = [found.xx, found.yy, found.zz, found.xy];
                found.iter().zip(exact(x, y)).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()))
            };
            for (at, stress) in model.mesh.nodes.iter().zip(nodal_stresses(&model, &state)) {
                let error = differ(&stress, (*at).into());
                assert!(error < 1e-10, "{kind} {section} at {at}: {stress:?} is off by {error}");
            }
            for (probe, at) in model.requests.probes.iter().zip([[1.0, 0.0], [2.07, 0.31], [2.0, 0.7]]) {
                let found = fecontact::output::probes::Reading::of(probe, &model, &state);
                let error = differ(&found.stress, at);
                assert!(error < 1e-10, "{kind} {section} {}: {error}", probe.name);
                let strain = [a + b * at[1], d * at[0] + 2.0 * e * at[1], 0.5 * ((b + 2.0 * c) * at[0] + d * at[1])];
                found.strain.iter().zip(strain).for_each(|(own, exact)| close("strain", *own, exact, 1e-13));
            }
        }
    }
}

/// Largest errors of σ_rr and of the hoop stress at the inner, then at the outer surface, as shares of the exact hoop stress inside; the middles
/// of `hoop` say whether it is zz.
fn surface_errors(
    run: &Finished,
    [inside, outside]: [&str; 2],
    exact: impl Fn(f64) -> [f64; 2],
    hoop_is_zz: bool,
) -> [f64; 4] {
    let stresses = nodal_stresses(&run.model, run.last());
    let mut errors = Vec::new();
    let largest = exact(run.model.mesh.nodes[run.nodes(inside)[0]].norm())[1];
    for side in [inside, outside] {
        let mut worst = [0.0f64; 2];
        for node in run.nodes(side) {
            let (at, stress) = (run.model.mesh.nodes[node], stresses[node]);
            let (r, n) = if hoop_is_zz { (at.x, nalgebra::Vector2::x()) } else { (at.norm(), at.normalize()) };
            let radial = n.x * n.x * stress.xx + n.y * n.y * stress.yy + 2.0 * n.x * n.y * stress.xy;
            let hoop = if hoop_is_zz { stress.zz } else { stress.xx + stress.yy - radial };
            let [rr, tt] = exact(r);
            for (worst, error) in worst.iter_mut().zip([radial - rr, hoop - tt]) {
                *worst = worst.max((error / largest).abs());
            }
        }
        errors.extend(worst);
    }
    [errors[0], errors[1], errors[2], errors[3]]
}

/// A quarter of a ring, or of a sphere, of blocks.
fn quarter(kind: &str, [a, b]: [f64; 2], elements: [usize; 2]) -> Value {
    json!({"blocks": [{"body": "body", "corners": [[a, 0], [b, 0], [0, b], [0, a]], "arcs": [null, [0, 0], null, [0, 0]],
                       "elements": elements, "sides": ["body_bottom", "outside", "axis", "inside"], "kind": kind}]})
}

fn ring_case(kind: &str, elements: [usize; 2], p: f64) -> Value {
    let mut case =
        case(&Value::Null, quarter(kind, [1.0, 2.0], elements), linear(), json!([{"on": "inside", "pressure": p}]));
    case["steps"][0]["supports"].as_array_mut().expect("supports").push(json!({"on": "axis", "ux": 0}));
    case
}

/// The same ring of triangles, two to a quadrilateral, their diagonals to and fro, or all one way.
fn ring_of_triangles([columns, rows]: [usize; 2], to_and_fro: bool, p: f64) -> Value {
    let map = |s: f64, t: f64| {
        let angle = FRAC_PI_2 * t;
        [(1.0 + s) * if t == 1.0 { 0.0 } else { angle.cos() }, (1.0 + s) * angle.sin()]
    };
    let mut mesh = Blocks::default().block("body", [columns, rows], map);
    let split = |(k, q): (usize, &Vec<usize>)| {
        if to_and_fro && (k % columns + k / columns) % 2 == 1 {
            [vec![q[0], q[1], q[3]], vec![q[1], q[2], q[3]]]
        } else {
            [vec![q[0], q[1], q[2]], vec![q[0], q[2], q[3]]]
        }
    };
    let triangles: Vec<Vec<usize>> = mesh.elements["body"].iter().enumerate().flat_map(split).collect();
    mesh.elements.insert("body".into(), triangles);
    let loads = json!([{"on": "body_left", "pressure": p}]);
    let mut case = case(&Value::Null, mesh.json(), linear(), loads);
    case["steps"][0]["supports"].as_array_mut().expect("supports").push(json!({"on": "body_top", "ux": 0}));
    case
}

/// A beam one element thick is bent: what the integration points know is seen at both surfaces; and bodies that share nodes
/// do not look into each other.
#[test]
fn bending_of_one_layer_and_the_jump_between_materials_are_seen() {
    let mesh = Blocks::default().rectangle("body", [12, 1], [0.0, -0.5], [12.0, 0.5]).json();
    let (kappa, modulus) = (1e-3, E * (1.0 - NU) / ((1.0 + NU) * (1.0 - 2.0 * NU)));
    for mesh in [mesh.clone(), quadratic(&mesh, half_way)] {
        let mut case = case(&Value::Null, mesh, linear(), json!([]));
        case["steps"][0]["supports"] = json!([{"on": "body", "ux": 0, "uy": 0}]);
        let model = common::model(&case);
        let mut state = model.initial_state();
        for (node, at) in model.mesh.nodes.iter().enumerate() {
            state.displacement[2 * node] = -kappa * at.x * at.y;
            state.displacement[2 * node + 1] = 0.5 * kappa * at.x * at.x;
        }
        for (at, stress) in model.mesh.nodes.iter().zip(nodal_stresses(&model, &state)) {
            close("bending", stress.xx, -modulus * kappa * at.y, 1e-12);
        }
    }

    // Stretched side by side, the strain is the same and the stress jumps.
    let block = |body: &str, y: f64| json!({"body": body, "corners": [[0, y], [3, y], [3, y + 1.0], [0, y + 1.0]], "elements": [6, 4]});
    let material = |young: f64| json!({"material": {"model": "linear", "E": young, "nu": 0}});
    let bonded = json!({
        "mesh": {"blocks": [block("soft", 0.0), block("stiff", 1.0)], "joined": [["soft", "stiff"]]},
        "bodies": {"soft": material(10.0), "stiff": material(30.0)},
        "steps": [{"name": "hold", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "soft", "ux": 0, "uy": 0}, {"on": "stiff", "ux": 0, "uy": 0}]}]
    });
    let model = common::model(&bonded);
    let mut state = model.initial_state();
    for (node, at) in model.mesh.nodes.iter().enumerate() {
        state.displacement[2 * node] = 1e-3 * at.x;
    }
    for (at, stress) in model.mesh.nodes.iter().zip(nodal_stresses(&model, &state)) {
        let young = match at.y {
            y if y < 1.0 => 10.0,
            y if y > 1.0 => 30.0,
            _ => 20.0,
        };
        close("side by side", stress.xx, 1e-3 * young, 1e-14);
    }
}

/// Lamé's tube and sphere under a pressure inside, b = 2 a: both stresses at both surfaces, as shares of the hoop stress inside.
#[test]
fn surfaces_of_lames_tube_and_sphere_have_their_stresses() {
    let p = 1e-5;
    let tube = |r: f64| [p / 3.0 * (1.0 - 4.0 / (r * r)), p / 3.0 * (1.0 + 4.0 / (r * r))];
    let sphere = |r: f64| [p / 7.0 * (1.0 - 8.0 / r.powi(3)), p / 7.0 * (1.0 + 4.0 / r.powi(3))];
    let message = |what: &str, errors: [f64; 4], bound: f64| {
        println!(
            "{what}: inside rr {:.3} %, hoop {:.3} %; outside rr {:.3} %, hoop {:.3} %",
            100.0 * errors[0],
            100.0 * errors[1],
            100.0 * errors[2],
            100.0 * errors[3]
        );
        assert!(errors.iter().all(|error| *error < bound), "{what}: {errors:?}");
    };
    // The meshes of docs/validation/sections.md.
    let mesh = Blocks::default().rectangle("body", [16, 2], [1.0, 0.0], [2.0, 0.5]).json();
    let loads = json!([{"on": "body_left", "traction": {"x": p}}]);
    let mut case_of_rings = case(&json!("axisymmetric"), quadratic(&mesh, half_way), linear(), loads);
    case_of_rings["steps"][0]["supports"].as_array_mut().expect("supports").push(json!({"on": "body_top", "uy": 0}));
    message(
        "tube of rings, Q8 16 x 2",
        surface_errors(&finish(&case_of_rings), ["body_left", "body_right"], tube, true),
        0.003,
    );
    let mut ball = case(
        &json!("axisymmetric"),
        quarter("Q8", [1.0, 2.0], [10, 16]),
        linear(),
        json!([{"on": "inside", "pressure": p}]),
    );
    message("sphere, Q8 10 x 16", surface_errors(&finish(&ball), ["inside", "outside"], sphere, false), 0.01);
    ball["mesh"] = quarter("Q4", [1.0, 2.0], [20, 32]);
    message("sphere, Q4 20 x 32", surface_errors(&finish(&ball), ["inside", "outside"], sphere, false), 0.01);
    for (kind, element, elements, bound) in [
        ("Q4", "displacement", [9, 16], 0.03),
        ("Q4", "f_bar", [9, 16], 0.03),
        ("Q4", "displacement", [18, 32], 0.01),
        ("Q8", "displacement", [9, 16], 0.01),
        ("Q8", "reduced", [9, 16], 0.01),
        ("T6", "displacement", [9, 16], 0.01),
    ] {
        let mut ring = ring_case(kind, elements, p);
        ring["bodies"]["body"]["element"] = json!(element);
        if element == "f_bar" {
            ring["bodies"]["body"]["material"]["model"] = json!("hencky");
        }
        message(
            &format!("tube, {kind} {element} {elements:?}"),
            surface_errors(&finish(&ring), ["inside", "outside"], tube, false),
            bound,
        );
    }
    for (elements, to_and_fro, bound) in [([9, 16], true, 0.03), ([18, 32], true, 0.006), ([18, 32], false, 0.05)] {
        let run = finish(&ring_of_triangles(elements, to_and_fro, p));
        let what = format!("tube, T3 {elements:?}, to and fro {to_and_fro}");
        message(&what, surface_errors(&run, ["body_left", "body_right"], tube, false), bound);
    }
}

/// Stresses recovered of squares, whose patches extend alike along both axes, turn with the body: no term is left out by round-off.
#[test]
fn recovered_stresses_turn_with_squares() {
    let stresses = |columns: usize, refined: bool, angle: f64| {
        let mesh = Blocks::default().block("body", [columns; 2], |s, t| common::turned([s, t], angle)).json();
        let mesh = if refined { quadratic(&mesh, half_way) } else { mesh };
        let mut case = case(&Value::Null, mesh, linear(), json!([]));
        case["steps"][0]["supports"] = json!([{"on": "body", "ux": 0, "uy": 0}]);
        let model = common::model(&case);
        let mut state = model.initial_state();
        for (node, at) in model.mesh.nodes.iter().enumerate() {
            let [x, y] = common::turned([at.x, at.y], -angle);
            let u = common::turned([1e-3 * (3.0 * x).sin() * y, 1e-3 * (2.0 * y).cos() * x], angle);
            state.displacement[2 * node..][..2].copy_from_slice(&u);
        }
        let invariants =
            |stress: &CauchyStress| [stress.xx + stress.yy, (0.5 * (stress.xx - stress.yy)).hypot(stress.xy)];
        nodal_stresses(&model, &state).iter().map(invariants).collect::<Vec<_>>()
    };
    for (columns, refined) in [(1, false), (2, false), (3, false), (1, true), (2, true)] {
        for angle in [0.3, 0.785, 1.234, 2.9] {
            let pairs = stresses(columns, refined, 0.0).into_iter().zip(stresses(columns, refined, angle));
            for (k, (stress, turned)) in pairs.enumerate() {
                for i in 0..2 {
                    close(&format!("node {k} of {columns}, {refined}, {angle}"), turned[i], stress[i], 1e-10);
                }
            }
        }
    }
}
