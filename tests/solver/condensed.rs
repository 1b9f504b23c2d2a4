//! Linear bodies condensed on the nodes at contacts: the same answers as all equations give, and the same bits whatever is kept.

use std::sync::Arc;

use crate::common::{self, Blocks};
use crate::grids::{Grids, noise};
use crate::simulation::check;
use fecontact::equations::condensed::ContactNodes;
use fecontact::linear::{
    Condensation, DenseLu, Eliminated, HalvedLu, LinearFailure, LinearSolver, Pattern, SparseLu, SparseMatrix, Steady,
    norm,
};
use fecontact::model::{Model, State};
use fecontact::run::Simulation;
use nalgebra::Vector2;
use serde_json::{Value, json};

/// S and the way there and back against the solution of the whole system, for kept nodes at the contact, in corners, and
/// apart from each other.
#[test]
fn a_condensed_matrix_has_the_solutions_of_the_whole() {
    let grids = Grids::new(9, 6, 10.0);
    let lists: [Vec<usize>; 3] = [
        (0..=9).flat_map(|i| [grids.node(1, i, 0), grids.node(0, i, 6)]).collect(),
        vec![grids.node(0, 0, 0)],
        vec![grids.node(1, 9, 6), grids.node(0, 3, 3), grids.node(1, 2, 4)],
    ];
    for kept in lists {
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

/// What varies at every node alone, and there not along its direction, is solved by half of the equations; what varies along it
/// by all. Both solutions are those of LU of the whole.
#[test]
fn equations_that_do_not_vary_are_eliminated_once() {
    const NODES: usize = 12;
    let all: Vec<usize> = (0..NODES).collect();
    let mut matrix = SparseMatrix::zero(Arc::new(Pattern::new(NODES, std::iter::once(&all[..]))));
    let size = matrix.size();
    matrix.values.copy_from_slice(&noise(size * size));
    (0..size).for_each(|k| matrix.values[k * size + k] += 20.0);
    let stiffness = matrix.values.clone();
    let turned = |k: usize| Vector2::new((0.3 * k as f64).cos(), (0.3 * k as f64).sin());
    let steady = |k: usize| Steady { direction: turned(k), stiffness: 50.0 + k as f64 };
    let eliminated = Eliminated::new(&stiffness, (0..NODES).map(steady).collect()).expect("regular");
    let mut lu = HalvedLu::default();
    for open in [None, Some(7)] {
        matrix.values.copy_from_slice(&stiffness);
        for (k, pair) in noise(2 * NODES).chunks_exact(2).enumerate() {
            let Steady { direction: n, stiffness } = steady(k);
            let t = Vector2::new(n.y, -n.x);
            let along = if open == Some(k) { 0.0 } else { stiffness };
            let own =
                n * n.transpose() * along + t * (t.transpose() * (30.0 * pair[0]) + n.transpose() * (10.0 * pair[1]));
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                matrix.values[(2 * k + j) * size + 2 * k + i] += own[(i, j)];
            }
        }
        let b = noise(size);
        let (mut whole, mut halves) = (b.clone(), b);
        let mut dense = DenseLu::default();
        dense.factorize(&matrix).expect("regular");
        dense.solve(&mut whole);
        {
            let mut halving = lu.with(Some(&eliminated), true);
            halving.factorize(&matrix).expect("regular");
            halving.solve(&mut halves);
        }
        assert_eq!(lu.halved(), open.is_none());
        let not_whole = lu.with(Some(&eliminated), false).factorize(&matrix);
        assert_eq!(not_whole, open.map_or(Ok(()), |_| Err(LinearFailure::Varies)));
        let off: Vec<f64> = whole.iter().zip(&halves).map(|(a, b)| a - b).collect();
        assert!(norm(&off) < 1e-13 * norm(&whole), "{:e} of {:e}", norm(&off), norm(&whole));
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
    let base = json!({
        "slave": "block_bottom", "master": "ground_top", "method": "gauss_to_segment", "normal": {"alpha_n": 13462},
        "friction": {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 2e3, "r": 100, "kappa": 10, "xi": 0.002,
            "m": 1, "n": 1, "structure": 2.0},
    });
    let drag = json!({"name": "drag", "duration": 4, "dt": {"initial": 0.2, "max": 0.2, "min": 1e-4},
        "supports": [{"on": "block_top", "ux": {"rate": 0.1}}]});
    let (base, drag) = (common::with(base, &contact), common::with(drag, &step));
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
    agree_with(case, tolerance, 1.15);
}

/// The same, with at most `more` times as many tangents.
#[track_caller]
fn agree_with(case: &Value, tolerance: f64, more: f64) {
    let [(all, by_all), (condensed, by_contacts)] = [false, true].map(|condense| run(common::model(case), condense));
    assert_eq!(by_all[0], 0);
    assert!(by_contacts[0] > 3 * by_contacts[1], "{by_contacts:?} tangents on contacts and on all equations");
    let solves = |[a, b]: [usize; 2]| (a + b) as f64;
    assert!(solves(by_contacts) <= more * solves(by_all) + 2.0, "{by_contacts:?} tangents instead of {by_all:?}");
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

/// A static step with dashpots, which hold the more the shorter an increment is: the condensed matrix is that of its length. Lengths are
/// rounded to eight digits there, and with this tolerance a second round takes up what that leaves.
#[test]
fn dashpots_in_static_increments_of_many_lengths_give_the_same_condensed() {
    let loads = json!([{"on": "ground_right", "dashpot": {"cx": 20, "cy": 20}}, {"on": "block_left", "dashpot": {"cx": 5, "cy": 5}}]);
    let mut case = dragged(json!({}), json!({"loads": loads, "duration": 1}));
    let drag = case["steps"][1].clone();
    for (name, dt) in [("shorter", 0.02), ("longer", 0.1)] {
        let mut step = drag.clone();
        (step["name"], step["duration"], step["dt"]) =
            (json!(name), json!(10.0 * dt), json!({"initial": dt, "max": dt, "min": 1e-4}));
        case["steps"].as_array_mut().expect("steps").push(step);
    }
    agree_with(&case, 1e-8, 1.5);
}

/// Ground that is stressed before anything moves, unevenly and out of balance.
#[test]
fn stressed_bodies_give_the_same_condensed() {
    for scheme in [json!("static"), json!({"newmark": {}})] {
        let mut case = dragged(json!({}), json!({"scheme": scheme}));
        case["bodies"]["ground"]["initial_stress"] =
            json!({"components": {"xx": "-0.5 - 0.1*x", "yy": -0.02, "xy": 0.01, "zz": -0.2}});
        agree(&case, 1e-8);
    }
}

/// A fluid that opens part of the contact.
#[test]
fn contacts_that_hold_water_give_the_same_condensed() {
    agree(&dragged(json!({"fluid_pressure": "2*t*max(0, x - 0.6)"}), json!({})), 1e-8);
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
    // Copies have no jumps in small sliding, the nodes between have.
    let mut small = case;
    small["contacts"]["base"]["method"] = json!("node_to_segment");
    small["contacts"]["base"]["sliding"] = json!("small");
    assert_eq!(ContactNodes::new(&common::model(&small)).nodes.len(), 9 + 4);
    agree(&small, 1e-8);
}

/// Δt/Δt₀ is a power of the fourth root of 2 in a dynamic step but for its end.
#[test]
fn increments_of_dynamics_are_on_a_ladder() {
    let error = json!({"scheme": {"newmark": {}}, "dt": {"initial": 0.01, "min": 1e-7, "max": 10, "error": 1e-4}});
    let (states, _) = run(common::model(&dragged(json!({}), error)), true);
    let end = states.last().expect("increments").time;
    let lengths: Vec<f64> =
        states.iter().filter(|s| s.time > 1.0 && s.time < end - 3.0 * s.dt).map(|state| state.dt).collect();
    let rung = |dt: f64| 4.0 * (dt / 0.01).log2();
    let off = lengths.iter().map(|dt| (rung(*dt) - rung(*dt).round()).abs()).fold(0.0, f64::max);
    assert!(off < 1e-6, "{off} of {} increments", lengths.len());
    let distinct = lengths.iter().map(|dt| rung(*dt).round() as i64).collect::<std::collections::BTreeSet<_>>();
    assert!(distinct.len() > 5, "{distinct:?}");
}

/// Two blocks with equal nodes along the fault between them, in small sliding, pressed and sheared over it; both are supported at
/// one end of the fault. In units of length, force and time.
fn faulted([length, force, time]: [f64; 3], contact: Value, step: Value) -> Value {
    let stress = force / length.powi(2);
    let rectangle = |blocks: Blocks, name: &str, low: f64| {
        blocks.rectangle(name, [16, 6], [0.0, low * length], [2.0 * length, (low + 0.75) * length])
    };
    let mesh = rectangle(rectangle(Blocks::default(), "ground", -0.75), "block", 0.0);
    let material = json!({"model": "linear", "E": 128.0 * stress, "nu": 0.25, "density": 0.0625 * stress * (time / length).powi(2)});
    let fault = json!({
        "slave": "block_bottom", "master": "ground_top", "method": "node_to_segment", "sliding": "small",
        "initial": {"pressure": 0.5 * stress},
        "normal": {"alpha_n": 1024.0 * stress / length},
        "friction": {"law": "coulomb", "mu": 0.375, "alpha_t": 1024.0 * stress / length},
    });
    let shear = json!({"name": "shear", "duration": time, "dt": {"initial": 0.125 * time, "max": 0.125 * time, "min": 1e-4 * time},
    "supports": [
        {"on": "ground_left", "ux": 0, "uy": 0}, {"on": "ground_bottom", "ux": 0, "uy": 0},
        {"on": "block_left", "ux": {"rate": 0.03125 * length / time}, "uy": 0},
        {"on": "block_top", "uy": {"rate": -0.0078125 * length / time}},
    ]});
    let (fault, shear) = (common::with(fault, &contact), common::with(shear, &step));
    json!({
        "mesh": mesh.json(),
        "bodies": {"ground": {"material": material}, "block": {"material": material}},
        "contacts": {"fault": fault},
        "newton": {"tolerance": 1e-11},
        "steps": [shear],
    })
}

/// In small sliding the nodes of the slave are counted from what they face, and the master's are not among those on which
/// bodies are condensed, whether nodes match or not; but where a slave node is supported and what it faces is not.
#[test]
fn bodies_are_condensed_on_the_jumps_of_small_sliding() {
    let kept = |case: &Value| ContactNodes::new(&common::model(case)).nodes.len();
    let one = [1.0; 3];
    assert_eq!(kept(&faulted(one, json!({}), json!({}))), 17);
    assert_eq!(kept(&faulted(one, json!({"sliding": "finite"}), json!({}))), 34);
    let small = json!({"method": "node_to_segment", "sliding": "small"});
    assert_eq!(kept(&dragged(small.clone(), json!({}))), 8);
    // The two ground nodes beside the corner of the block.
    let held = json!([{"on": "block_left", "ux": 0}]);
    assert_eq!(kept(&dragged(small, json!({"supports": held}))), 10);
    // Averages and Gauss points have no node of their own.
    assert_eq!(kept(&faulted(one, json!({"method": "gauss_to_segment"}), json!({}))), 34);
}

/// Static and dynamic, matching or not, with every method and law, where points open, close and slip.
#[test]
fn jumps_give_the_same_as_all_equations() {
    let one = [1.0; 3];
    let dynamic = json!({"scheme": {"generalized_alpha": {"rho_infinity": 0.8}},
        "loads": [{"on": "ground_right", "absorbing": true}, {"on": "block_right", "absorbing": true}]});
    let healing = json!({"friction": {"law": "super_subloading", "mu_s": 0.5, "mu_k": 0.2, "alpha_t": 1024, "r": 1000, "kappa": 50,
        "xi": 0.1}});
    for step in [json!({}), dynamic] {
        for contact in [json!({}), healing.clone(), json!({"normal": {"penetration": 1e-5}})] {
            agree(&faulted(one, contact, step.clone()), 1e-8);
        }
    }
    for method in ["node_to_segment", "gauss_to_segment", "mortar"] {
        let drag = json!({"supports": [{"on": "block_top", "ux": {"rate": 0.003}}]});
        agree(&dragged(json!({"method": method, "sliding": "small"}), drag), 1e-8);
    }
    // The block tilts: its right end lifts off.
    let tilt = json!({"supports": [
        {"on": "ground_left", "ux": 0, "uy": 0}, {"on": "ground_bottom", "ux": 0, "uy": 0},
        {"on": "block_top", "ux": "0.01*t", "uy": "0.05*t*(x-0.7)"}]});
    agree(&faulted(one, json!({}), tilt), 1e-8);
}

/// So many nodes at the contact that LU of all their equations is not worth it, but of half of them: where nothing opens the
/// increment is found on the contact, where points open on all equations, and the same either way.
#[test]
fn many_jumps_are_halved_or_left_to_all_equations() {
    let many = |above: &str| {
        let mesh = Blocks::default().rectangle("ground", [160, 3], [0.0, -0.1], [2.0, 0.0]).rectangle(
            "block",
            [160, 3],
            [0.0, 0.0],
            [2.0, 0.1],
        );
        let mut case = faulted([1.0; 3], json!({}), json!({}));
        case["mesh"] = mesh.json();
        case["steps"][0]["supports"] =
            json!([{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": "0.01*t", "uy": above}]);
        case
    };
    let counts = |above: &str| {
        let runs = [false, true].map(|condense| run(common::model(&many(above)), condense));
        let off = runs[0].0.iter().zip(&runs[1].0).flat_map(|(a, b)| a.displacement.iter().zip(&b.displacement));
        assert!(off.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-10);
        runs[1].1
    };
    let closed = counts("-0.001*t");
    assert!(closed[0] > 0 && closed[1] == 0, "{closed:?} tangents on contacts and on all equations");
    let tilted = counts("0.004*t*(x-0.7)");
    assert!(tilted[1] > 0, "{tilted:?}");
}

/// What contact alone holds is held by the jumps: nothing is left to all equations. The block has loads and no support.
#[test]
fn jumps_hold_a_body_that_contact_alone_holds() {
    let loads = json!({
        "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}],
        "loads": [{"on": "block_top", "traction": {"x": "0.1*t", "y": "-t"}}]
    });
    agree(&faulted([1.0; 3], json!({}), loads), 1e-8);
}

/// A slave node that is supported where what it faces is not.
#[test]
fn a_supported_slave_node_has_no_jump_and_gives_the_same() {
    let held = json!({"supports": [
        {"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_left", "ux": "0.01*t"}, {"on": "block_top", "uy": "-0.01*t"}]});
    agree(&faulted([1.0; 3], json!({}), held), 1e-8);
    // And the other way round.
    let held = json!({"supports": [
        {"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "ground_left", "ux": 0}, {"on": "block_top", "uy": "-0.01*t", "ux": "0.01*t"}]});
    agree(&faulted([1.0; 3], json!({}), held), 1e-8);
}

/// A case of rings, its left end moved from the axis to a radius.
fn beside_the_axis(mut case: Value, radius: f64) -> Value {
    case["section"] = json!("axisymmetric");
    for node in case["mesh"]["nodes"].as_array_mut().expect("nodes") {
        node[0] = json!(node[0].as_f64().expect("a place") + radius);
    }
    case
}

fn in_sections(case: &Value, radius: f64) -> [Value; 2] {
    let mut plate = case.clone();
    plate["section"] = json!({"plane_stress": {"thickness": 0.25}});
    [plate, beside_the_axis(case.clone(), radius)]
}

/// Plates and rings, by every method, in finite and small sliding, static and dynamic.
#[test]
fn every_section_gives_the_same_condensed() {
    let drag = json!({"supports": [{"on": "block_top", "ux": {"rate": 0.02}}]});
    for method in ["node_to_segment", "gauss_to_segment", "mortar"] {
        for case in in_sections(&dragged(json!({"method": method}), drag.clone()), 0.0) {
            agree(&case, 1e-8);
        }
    }
    let dynamic = json!({"scheme": {"generalized_alpha": {"rho_infinity": 0.8}},
        "loads": [{"on": "ground_right", "absorbing": true}, {"on": "block_right", "absorbing": true}]});
    for step in [json!({}), dynamic] {
        for case in in_sections(&faulted([1.0; 3], json!({}), step), 1.0) {
            agree(&case, 1e-8);
            check(&case, std::path::Path::new("test.json"));
        }
    }
}

/// A fluid, dilatancy and wear: dropped, resumed, on two threads and in other units.
#[test]
fn interfaces_that_move_or_hold_water_give_the_same_bits_redone_resumed_on_two_threads_and_in_other_units() {
    let case = |units: [f64; 3], sliding: &str| {
        let [length, force, time] = units;
        let stress = force / length.powi(2);
        let contact = json!({
            "sliding": sliding, "fluid_pressure": format!("{:?}*t", 0.5 * stress / time),
            "dilatancy": {"rate": 0.0625, "limit": 0.001953125 * length}, "wear": 0.0078125 / stress
        });
        faulted(units, contact, json!({}))
    };
    let units = [2f64.powi(10), 2f64.powi(-20), 2f64.powi(6)];
    for sliding in ["small", "finite"] {
        check(&case([1.0; 3], sliding), std::path::Path::new("test.json"));
        let of = |(units, threads): ([f64; 3], usize)| {
            common::on_threads(threads, || run(common::model(&case(units, sliding)), true).0)
        };
        let [states, both, other] = [([1.0; 3], 1), ([1.0; 3], 2), (units, 1)].map(of);
        assert!(both == states);
        assert_eq!(states.len(), other.len());
        for (one, other) in states.iter().zip(&other) {
            let same = |a: f64, b: f64| (a * units[0]).to_bits() == b.to_bits();
            assert!(one.displacement.iter().zip(&other.displacement).all(|(a, b)| same(*a, *b)));
        }
        let last = &states.last().expect("increments").contacts[0];
        assert!(last.iter().any(|point| point.fluid > 0.0));
        assert!(last.iter().any(|point| point.friction.wear > 0.0 && point.friction.opening != 0.0));
    }
}
