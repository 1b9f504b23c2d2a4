//! Newton's method by itself, on equations in one unknown; and what it accepts on whole models.

mod aids;
mod common;

use common::{Blocks, Finished, close, finish};
use fecontact::linear::system::Request;
use fecontact::linear::system::System;
use fecontact::linear::{Multifrontal, Pattern, SparseMatrix};
use fecontact::solve::newton::Settings;
use fecontact::solve::newton::{NewtonFailure, Outcome, solve};
use serde_json::{Value, json};

/// Solve r(u) = 0 from a start value; `equation` gives r and r′, or fails.
fn root(start: f64, equation: impl Fn(f64) -> Result<[f64; 2], ()>) -> Outcome<()> {
    let pattern = std::sync::Arc::new(Pattern::new(1, std::iter::once(&[0usize][..])));
    let tangent = SparseMatrix::zero(pattern);
    let mut system = System { residual: vec![0.0; 2], tangent, forces: 1.0, imbalance: 1.0 };
    let settings = Settings { tolerance: 1e-12, max_iterations: 30, old_tangents: true };
    solve(vec![start, 0.0], settings, &mut Multifrontal::default(), &mut system, |u, request, system| {
        let [r, slope] = equation(u[0])?;
        system.residual = vec![r, 0.0];
        system.imbalance = r.abs();
        if request == Request::Tangent {
            system.tangent.clear();
            system.tangent.add_diagonal(0, slope);
            system.tangent.add_diagonal(1, 1.0);
        }
        Ok(())
    })
}

/// The correction of atan(u) = 0 from u = 1.6 leads to −2.5, which is out of bounds here, and that is told; from u = 1 it
/// leads to the root.
#[test]
fn a_correction_out_of_bounds_is_told() {
    let bounded = |u: f64| if u.abs() < 2.0 { Ok([u.atan(), 1.0 / (1.0 + u * u)]) } else { Err(()) };
    assert_eq!(root(1.6, bounded).1, Err(NewtonFailure::Evaluation(())));
    let (iterations, result) = root(1.0, bounded);
    assert!(result.expect("a root")[0].abs() < 1e-12 && iterations.len() < 8, "{iterations:?}");
}

/// Blocks of foam pressed on a ground of foam and dragged over it by Coulomb's law. `scale` multiplies what is prescribed.
fn foam(blocks: Blocks, tolerance: f64, scale: f64) -> Value {
    let foam = json!({"material": {"model": "neo_hookean", "E": 0.05, "nu": 0.3}});
    json!({
        "mesh": blocks.rectangle("ground", [24, 4], [0.0, -0.6], [4.0, 0.0]).rectangle("foam", [9, 4], [1.0, 0.0], [2.0, 0.6]).json(),
        "bodies": {"ground": foam, "foam": foam},
        "contacts": {"base": {"slave": "foam_bottom", "master": "ground_top", "friction": {"law": "coulomb", "mu": 0.3}}},
        "newton": {"tolerance": tolerance},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.5},
             "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "foam_top", "ux": 0, "uy": -1e-2 * scale}]},
            {"name": "drag", "duration": 1, "dt": {"initial": 0.1, "max": 0.1},
             "supports": [{"on": "foam_top", "ux": 2e-2 * scale}]},
        ],
    })
}

/// Forces on the top of the foam after every increment, over `scale`.
fn forces(run: &Finished, scale: f64) -> Vec<[f64; 2]> {
    run.states.iter().map(|state| run.reaction("foam_top", state).map(|f| f / scale)).collect()
}

/// Largest difference, relative to the largest force.
fn difference(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    assert_eq!(a.len(), b.len());
    common::distance(a.as_flattened(), b.as_flattened()) / a.as_flattened().iter().fold(0.0, |m: f64, f| m.max(f.abs()))
}

/// Steel strained by 1 % beside the foam touches nothing. Its forces, 10⁴ to 10⁹ times larger, are no measure of the foam's.
/// The reference is the foam alone, solved to round-off.
#[test]
fn a_body_that_touches_nothing_hides_no_imbalance() {
    let alone = forces(&finish(&foam(Blocks::default(), 1e-13, 1.0)), 1.0);
    for steel in [50.0, 2e5, 2e7] {
        let mut case = foam(Blocks::default().rectangle("steel", [10, 10], [10.0, 0.0], [11.0, 1.0]), 1e-8, 1.0);
        case["bodies"]["steel"] = json!({"material": {"model": "neo_hookean", "E": steel, "nu": 0.3}});
        let supports = case["steps"][0]["supports"].as_array_mut().expect("a list");
        supports.push(json!({"on": "steel_bottom", "ux": 0, "uy": 0}));
        supports.push(json!({"on": "steel_top", "ux": 0, "uy": -0.01}));
        close(&format!("E = {steel}"), difference(&alone, &forces(&finish(&case), 1.0)), 0.0, 1e-7);
    }
}

/// Foam on rubber on a steel plate that is stretched by 1 %: in one stack as well every body and every contact is in
/// equilibrium by itself. The reference is the same solved to round-off.
#[test]
fn a_stiff_body_in_a_stack_hides_no_imbalance() {
    let stack = |tolerance: f64| {
        let material = |e: f64| json!({"material": {"model": "neo_hookean", "E": e, "nu": 0.3}});
        let contact = |slave: &str, master: &str| json!({"slave": slave, "master": master, "friction": {"law": "coulomb", "mu": 0.3}});
        let mesh = Blocks::default()
            .rectangle("steel", [12, 3], [0.0, -0.5], [4.0, 0.0])
            .rectangle("rubber", [11, 3], [0.5, 0.0], [3.0, 0.5])
            .rectangle("foam", [9, 3], [1.0, 0.5], [2.0, 1.0]);
        finish(&json!({
            "mesh": mesh.json(),
            "bodies": {"steel": material(2e5), "rubber": material(1.0), "foam": material(0.05)},
            "contacts": {"lower": contact("rubber_bottom", "steel_top"), "upper": contact("foam_bottom", "rubber_top")},
            "newton": {"tolerance": tolerance},
            "steps": [
                {"name": "press", "duration": 1, "dt": {"initial": 0.25},
                 "supports": [{"on": "steel_bottom", "ux": 0, "uy": 0}, {"on": "foam_top", "ux": 0, "uy": -5e-2}]},
                {"name": "stretch", "duration": 1, "dt": {"initial": 0.1},
                 "supports": [{"on": "steel_bottom", "ux": "0.01*(x-1.5)*(t-1)"}]},
                {"name": "drag", "duration": 1, "dt": {"initial": 0.1},
                 "supports": [{"on": "steel_bottom", "ux": "0.01*(x-1.5)"}, {"on": "foam_top", "ux": 2e-2}]},
            ],
        }))
    };
    let [loose, tight] = [1e-8, 1e-13].map(|tolerance| forces(&stack(tolerance), 1.0));
    close("forces on the foam", difference(&tight, &loose), 0.0, 1e-7);
}

/// Supports that move by 10⁻⁷ to 10⁻¹² of an element: the forces are those of a motion a thousand times larger, over
/// a thousand, as far as gaps of that size are known: to ε h in h times the motion.
#[test]
fn no_motion_is_too_small_to_be_solved_for() {
    let reference = forces(&finish(&foam(Blocks::default(), 1e-8, 1e-4)), 1e-4);
    for (scale, allowed) in [(1e-6, 2e-4), (1e-8, 1e-4), (1e-10, 1e-2)] {
        let run = finish(&foam(Blocks::default(), 1e-8, scale));
        close(&format!("{scale:e}"), difference(&reference, &forces(&run, scale)), 0.0, allowed);
        let top = run.nodes("foam_top")[0];
        close("prescribed", run.last().displacement[2 * top], 2e-2 * scale, 1e-12 * scale);
    }
    // Far below what gaps are known to, supports are still met, and no increment is accepted without a solve.
    let run = finish(&foam(Blocks::default(), 1e-8, 1e-14));
    let top = run.nodes("foam_top")[0];
    close("prescribed", run.last().displacement[2 * top], 2e-16, 1e-28);
    assert!(run.iterations.iter().all(|iterations| *iterations > 0));
}

/// A block on a rigid plane pressed by 150 MPa from its left and 50 MPa from above (after the GRECO block of
/// `cases/validation`), 2³⁸ from the origin: all nodes are multiples of 2.5, and so exact. The pressures must not be taken for
/// round-off of the positions.
#[test]
fn loads_far_from_the_origin_are_solved_for() {
    let tractions = |shift: f64| {
        let run = finish(&json!({
            "mesh": Blocks::default().rectangle("block", [16, 16], [shift, 0.0], [shift + 40.0, 40.0]).json(),
            "bodies": {"block": {"material": {"model": "linear", "E": 130000, "nu": 0.2}}},
            "contacts": {"base": {"slave": "block_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                                  "method": "node_to_segment", "friction": {"law": "coulomb", "mu": 1}}},
            "steps": [{"name": "load", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "block_right", "ux": 0}],
                       "loads": [{"on": "block_left", "pressure": 150}, {"on": "block_top", "pressure": 50}]}],
        }));
        let friction = run.last().contacts[0].iter().map(|point| [point.friction.pressure, point.friction.traction]);
        friction.collect::<Vec<_>>()
    };
    let near = tractions(0.0);
    let pressure = near.iter().map(|[p, _]| 2.5 * p).sum::<f64>();
    assert!((pressure / 2000.0 - 1.0).abs() < 0.1, "the bottom carries most of 40 × 50: {pressure}");
    close("tractions", difference(&near, &tractions(2f64.powi(38))), 0.0, 1e-9);
}
