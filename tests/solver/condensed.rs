//! Linear bodies condensed on the nodes at contacts: the same answers as all equations give, and the same bits whatever is kept.

use std::sync::Arc;

use crate::common::{self, Blocks};
use crate::grids::{Grids, noise};
use crate::simulation::check;
use fecontact::linear::{Condensation, LinearSolver, Pattern, SparseLu, SparseMatrix, norm};
use fecontact::model::Model;
use fecontact::model::state::State;
use fecontact::run::Simulation;
use serde_json::{Value, json};

/// S and the way there and back against the solution of the whole system, for kept nodes at the contact, in corners, and
/// apart from each other.
#[test]
fn a_condensed_matrix_has_the_solutions_of_the_whole() {
    let grids = Grids::new(9, 6, 10.0);
    let lists: [Vec<usize>; 3] = [
        (0..=9).flat_map(|i| [grids.node(1, i, 0), grids.node(0, i, 6)]).collect(),
        vec![grids.node(0, 0, 0)],
        vec![grids.node(0, 3, 3), grids.node(1, 2, 4), grids.node(1, 9, 6)],
    ];
    for mut kept in lists {
        kept.sort_unstable();
        let original = grids.matrix(1.0);
        let neighbours: Vec<Vec<usize>> =
            (0..original.pattern.nodes()).map(|node| original.pattern.neighbours(node).to_vec()).collect();
        let pairs = neighbours.iter().enumerate().flat_map(|(a, list)| list.iter().map(move |&b| [a, b]));
        let pairs: Vec<[usize; 2]> = pairs.collect();
        let groups = pairs.iter().map(|pair| &pair[..]).chain([&kept[..]]);
        let mut matrix = SparseMatrix::zero(Arc::new(Pattern::new(neighbours.len(), groups)));
        for &[row, column] in &pairs {
            let (from, to) = (original.pattern.block(row, column), matrix.pattern.block(row, column));
            let (from, to) = (from.expect("coupled"), to.expect("coupled"));
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                matrix.values[to.value(i, j)] = original.values[from.value(i, j)];
            }
        }
        let b = noise(matrix.size());
        let mut lu = SparseLu::default();
        lu.factorize(&matrix).expect("regular");
        let mut whole = b.clone();
        lu.solve(&mut whole);
        let mut condensation = Condensation::new(matrix.pattern.clone(), &kept).expect("an order");
        let condensed = condensation.condense(&matrix).expect("no pivot vanishes");
        let forwarded = condensed.forward(&b);
        let own: Vec<f64> = kept.iter().flat_map(|&node| [whole[2 * node], whole[2 * node + 1]]).collect();
        // S x = g for the x of the whole.
        let size = own.len();
        let left = |row: usize| -> f64 { (0..size).map(|k| condensed.stiffness[k * size + row] * own[k]).sum() };
        let missed: Vec<f64> = (0..size).map(|row| left(row) - forwarded.right[row]).collect();
        assert!(norm(&missed) < 1e-11 * norm(&forwarded.right), "{} of {}", norm(&missed), norm(&forwarded.right));
        let back = condensed.backward(&forwarded, &own);
        let off: Vec<f64> = back.iter().zip(&whole).map(|(a, b)| a - b).collect();
        assert!(norm(&off) < 1e-11 * norm(&whole), "{}", norm(&off));
    }
}

/// A body that nothing but its kept nodes could hold is left to all equations.
#[test]
fn a_vanished_pivot_condenses_nothing() {
    let pattern = Arc::new(Pattern::new(3, [&[0, 1][..], &[1, 2]].into_iter()));
    let mut matrix = SparseMatrix::zero(pattern);
    matrix.add_diagonal(4, 1.0);
    matrix.add_diagonal(5, 1.0);
    assert!(Condensation::new(matrix.pattern.clone(), &[2]).expect("an order").condense(&matrix).is_none());
}

/// A block dragged over another one, both linear; its top and the side of the ground are supported down to the contact.
fn dragged(contact: Value, step: Value) -> Value {
    let mesh = Blocks::default().rectangle("ground", [14, 5], [0.0, -0.5], [3.0, 0.0]).rectangle(
        "block",
        [7, 5],
        [0.4, 0.001],
        [1.4, 0.501],
    );
    let material = json!({"model": "linear", "E": 100, "nu": 0.3, "density": 1e-2});
    let mut base = json!({
        "slave": "block_bottom", "master": "ground_top",
        "friction": {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 2e3, "r": 100, "kappa": 10, "xi": 0.002,
            "m": 1, "n": 1, "structure": 2.0},
    });
    let mut drag = json!({"name": "drag", "duration": 4, "dt": {"initial": 0.2, "max": 0.2, "min": 1e-4},
        "supports": [{"on": "block_top", "ux": {"rate": 0.1}}]});
    for (target, given) in [(&mut base, contact), (&mut drag, step)] {
        for (key, value) in given.as_object().expect("an object") {
            target[key] = value.clone();
        }
    }
    json!({
        "mesh": mesh.json(),
        "bodies": {"ground": {"material": material}, "block": {"material": material}},
        "contacts": {"base": base},
        "newton": {"tolerance": 1e-11},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.25, "min": 1e-4}, "supports": [
                {"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "ground_left", "ux": 0},
                {"on": "block_top", "ux": 0, "uy": -0.02},
            ]},
            drag,
        ],
    })
}

/// States of a run, and how many tangents were made on contacts and on all equations.
fn run(mut model: Model, condense: bool) -> (Vec<State>, [usize; 2]) {
    model.aids.condense = condense;
    let mut simulation = Simulation::new(model);
    let (mut states, mut iterations) = (Vec::new(), [0; 2]);
    while let Some(increment) = simulation.next_increment().expect("it is solved") {
        for iteration in increment.iterations.iter().filter(|iteration| iteration.newton.factorized) {
            iterations[1 - iteration.acted.condense] += 1;
        }
        states.push(State::clone(&increment.state));
    }
    (states, iterations)
}

/// Displacements, reactions, pressures and tractions of two runs agree to `tolerance` of the largest.
#[track_caller]
fn agree(case: &Value, tolerance: f64) {
    let [(all, by_all), (condensed, by_contacts)] = [false, true].map(|condense| run(common::model(case), condense));
    assert_eq!(by_all[0], 0);
    assert!(by_contacts[0] > 3 * by_contacts[1], "{by_contacts:?} tangents on contacts and on all equations");
    let solves = |[a, b]: [usize; 2]| (a + b) as f64;
    assert!(solves(by_contacts) <= 1.15 * solves(by_all) + 2.0, "{by_contacts:?} tangents instead of {by_all:?}");
    assert_eq!(all.len(), condensed.len());
    let kinds: [fn(&State) -> Vec<f64>; 4] = [
        |state| state.displacement.clone(),
        |state| state.reaction.clone(),
        |state| state.contacts.iter().flatten().map(|point| point.friction.pressure).collect(),
        |state| state.contacts.iter().flatten().map(|point| point.friction.traction).collect(),
    ];
    for values in kinds {
        let largest = all.iter().flat_map(values).fold(0.0f64, |m, x| m.max(x.abs()));
        for (a, b) in all.iter().zip(&condensed) {
            let off = values(a).iter().zip(values(b)).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            assert!(off <= tolerance * largest, "off by {off:e} of {largest:e} at {}", a.time);
        }
    }
}

#[test]
fn every_method_of_contact_gives_the_same_condensed() {
    for method in ["node_to_segment", "gauss_to_segment", "mortar"] {
        agree(&dragged(json!({"method": method}), json!({})), 1e-8);
    }
    agree(&dragged(json!({"normal": {"penetration": 1e-5}}), json!({})), 1e-7);
    agree(&dragged(json!({"friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 2e3}}), json!({})), 1e-8);
}

#[test]
fn every_scheme_gives_the_same_condensed() {
    let damped = json!([{"on": "ground_right", "absorbing": true}]);
    for scheme in [
        json!({"hht": {"alpha": -0.1}}),
        json!({"newmark": {}}),
        json!({"generalized_alpha": {"rho_infinity": 0.8}}),
        json!({"wilson": {}}),
    ] {
        agree(&dragged(json!({}), json!({"scheme": scheme, "loads": damped})), 1e-8);
    }
}

/// Periodic sides end at the contact: copies are among its nodes.
#[test]
fn periodic_bodies_give_the_same_condensed() {
    let mesh = Blocks::default().rectangle("ground", [10, 6], [0.0, -1.0], [2.0, 0.0]).rectangle(
        "block",
        [10, 6],
        [0.0, 0.0],
        [2.0, 1.0],
    );
    let material = json!({"model": "linear", "E": 100, "nu": 0.3, "density": 1e-2});
    let case = json!({
        "mesh": mesh.json(),
        "bodies": {"ground": {"material": material}, "block": {"material": material}},
        "periodic": [["ground_left", "ground_right"], ["block_left", "block_right"]],
        "contacts": {"base": {
            "slave": "block_bottom", "master": "ground_top", "initial": {"pressure": 1.0},
            "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 2e3}}},
        "newton": {"tolerance": 1e-11},
        "steps": [{"name": "shear", "duration": 2, "dt": {"initial": 0.1, "max": 0.1},
            "scheme": {"newmark": {}}, "supports": [
                {"on": "ground_bottom", "ux": 0, "uy": 0},
                {"on": "block_top", "ux": "0.02*t^2", "uy": "-0.01*t*(1+0.2*sin(3.14159265*x))"}]}],
    });
    agree(&case, 1e-8);
}

/// Whatever was condensed before is gone in a resumed run; dropped attempts are found again.
#[test]
fn condensed_increments_can_be_redone_and_resumed() {
    let error = json!({"scheme": {"generalized_alpha": {"rho_infinity": 0.8}},
        "dt": {"initial": 0.01, "min": 1e-5, "max": 0.3, "error": 1e-4}});
    for step in [json!({}), error] {
        check(&dragged(json!({}), step), std::path::Path::new("test.json"));
    }
}

/// Δt/Δt₀ is a power of the fourth root of 2 in a dynamic step but for its end.
#[test]
fn increments_of_dynamics_are_on_a_ladder() {
    let error = json!({"scheme": {"newmark": {}}, "dt": {"initial": 0.01, "min": 1e-7, "max": 10, "error": 1e-5}});
    let (states, _) = run(common::model(&dragged(json!({}), error)), true);
    let lengths: Vec<f64> = states.iter().filter(|state| state.time > 1.0).map(|state| state.dt).collect();
    let rung = |dt: f64| 4.0 * (dt / 0.01).log2();
    let off: Vec<f64> = lengths.iter().map(|dt| (rung(*dt) - rung(*dt).round()).abs()).collect();
    assert!(off[..off.len() - 2].iter().all(|off| *off < 1e-6), "{lengths:?}");
    let distinct = lengths.iter().map(|dt| rung(*dt).round() as i64).collect::<std::collections::BTreeSet<_>>();
    assert!(distinct.len() > 5, "{distinct:?}");
}
