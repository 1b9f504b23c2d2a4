//! Rigid masters with corners and small disks: they press on edges between nodes, and what they enter is told.

use std::sync::Arc;

use fecontact::contact::depth::Inside;
use fecontact::contact::surface::{SlavePoint, gauss_points_and_corners, is_corner};
use fecontact::output::warnings::Warnings;
use nalgebra::Vector2;
use serde_json::{Value, json};

use crate::common::{self, close, finish};

/// A block of clay under a rigid box of twice 1 − `gap`, which is pressed by 5 mm and dragged by 6.
fn box_on_clay(kind: &str, gap: f64, friction: &Value) -> Value {
    box_on_finer_clay(kind, 1, gap, friction)
}

/// The same with so many times more elements along either direction.
fn box_on_finer_clay(kind: &str, finer: usize, gap: f64, friction: &Value) -> Value {
    let part = |corners: Value, columns: usize, grading: Value, sides: Value| json!({"body": "soil", "kind": kind, "corners": corners, "elements": [columns * finer, 2 * finer], "grading": grading, "sides": sides});
    let half = 1.0 - gap;
    let corners = json!([[-half, 0.5], [half, 0.5], [half, 0], [-half, 0], [-half, 0.5]]);
    json!({
        "mesh": {"blocks": [
            part(json!([[-4, -3], [-1, -3], [-1, 0], [-4, 0]]), 3, json!([1.0 / 6.0, 1.0 / 6.0]), json!(["bottom", null, "surface", "sides"])),
            part(json!([[-1, -3], [1, -3], [1, 0], [-1, 0]]), 4, json!([1, 1.0 / 6.0]), json!(["bottom", null, "surface", null])),
            part(json!([[1, -3], [4, -3], [4, 0], [1, 0]]), 3, json!([6, 1.0 / 6.0]), json!(["bottom", "sides", "surface", null]))]},
        "bodies": {"soil": {"element": if kind == "Q4" { "f_bar" } else { "reduced" }, "material": {"model": "hencky", "E": 30000, "nu": 0.49}}},
        "rigid_bodies": {"footing": {"reference": [0, 0]}},
        "contacts": {"base": {"slave": "surface", "rigid_body": "footing", "friction": friction, "master": {"polyline": {"points": corners}}}},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.05}, "supports": [{"on": "bottom", "ux": 0, "uy": 0},
                {"on": "sides", "ux": 0}, {"on": "footing", "ux": 0, "uy": -0.005, "angle": 0}]},
            {"name": "drive", "duration": 1, "dt": {"initial": 0.02}, "supports": [{"on": "footing", "ux": 0.006}]}],
    })
}

/// Corners at nodes, beside them and inside an edge: the box presses and slides without a cut-back; without friction nothing holds it back
/// (symmetry), and what lies within the same Gauss points bears the same.
#[test]
fn a_rigid_box_presses_and_drags() {
    for kind in ["Q4", "Q8"] {
        for friction in [json!({"law": "frictionless"}), json!({"law": "coulomb", "mu": 0.5})] {
            let run = |gap: f64| {
                let run = finish(&box_on_clay(kind, gap, &friction));
                assert_eq!(run.report.cutbacks, 0, "{kind}, {gap}: {:?}", run.report.given_up);
                let forces = [1.0, 2.0].map(|time| run.reaction("footing", run.at(time)));
                if friction["law"] == "frictionless" {
                    forces.iter().for_each(|[x, y]| assert!(x.abs() < 1e-9 * y.abs(), "{kind}, {gap}: {x} beside {y}"));
                }
                forces
            };
            let [at_nodes, beside, _] = [0.0, 0.001, 0.03].map(run);
            for (at, beside) in at_nodes.iter().zip(beside) {
                close(kind, at[1], beside[1], 1e-6 * at[1].abs());
            }
        }
    }
}

/// A box that sticks under a part of its base: drag and normal force fall with the mesh to those of a separate computation in linear elasticity, 177.4 and
/// 375.1 (elements graded to the corners, friction at nodes, 5666 unknowns). What coarse meshes bear beyond that is theirs beside singular corners.
#[test]
fn the_drag_of_a_box_comes_to_that_of_a_separate_computation() {
    let friction = json!({"law": "coulomb", "mu": 0.5});
    for (kind, finest) in [("Q4", 4), ("Q8", 2)] {
        let mut before = [f64::INFINITY; 2];
        for finer in [1, 2, 4].into_iter().filter(|finer| *finer <= finest) {
            let run = finish(&box_on_finer_clay(kind, finer, 0.0, &friction));
            let [drag, normal] = run.reaction("footing", run.last()).map(f64::abs);
            println!("{kind}, {} elements: {drag:.1} {normal:.1}", 4 * finer);
            let off = [drag / 177.4 - 1.0, normal / 375.1 - 1.0];
            (0..2)
                .for_each(|k| assert!((0.0..before[k]).contains(&off[k]), "{kind}, {finer}: {off:?} after {before:?}"));
            before = off;
        }
        before.iter().for_each(|off| assert!(*off < 0.025, "{kind}: {before:?}"));
    }
}

/// A punch with its corners inside quadratic edges. From 40 × 10 elements on the force differs by 2 % (656 to 673).
#[test]
fn a_punch_with_corners_presses_on_quadratic_edges() {
    let case = |[columns, rows]: [usize; 2]| {
        json!({
            "mesh": {"blocks": [{"body": "strip", "corners": [[-10, -5], [10, -5], [10, 0], [-10, 0]], "elements": [columns, rows],
                                 "sides": ["base", null, "surface", null], "kind": "Q8"}]},
            "bodies": {"strip": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}}},
            "rigid_bodies": {"punch": {"reference": [0, 2]}},
            "contacts": {"c": {"slave": "surface", "rigid_body": "punch", "friction": {"law": "coulomb", "mu": 0.3},
                               "master": {"polyline": {"points": [[3.3, 2], [1.9, 0], [-2.6, 0], [-3.1, 2]]}}}},
            "steps": [
                {"name": "press", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "base", "ux": 0, "uy": 0}, {"on": "punch", "ux": 0, "uy": -0.4, "angle": 0}]},
                {"name": "drag", "duration": 2, "dt": {"initial": 0.1}, "supports": [{"on": "punch", "ux": {"rate": 1}}]}],
        })
    };
    let [coarse, fine] = [[20, 5], [40, 10]].map(|elements| finish(&case(elements)));
    let force = |run: &common::Finished| run.reaction("punch", run.at(1.0))[1];
    close("force", force(&coarse), force(&fine), 0.03 * force(&fine).abs());
    // A mean over each edge of the middle; that of the finer mesh lies between 105 and 112.
    let x = coarse.model.configuration(&coarse.at(1.0).displacement);
    let points = coarse.model.contacts[0].points.iter().zip(&coarse.at(1.0).contacts[0]);
    let pressures: Vec<f64> = points
        .filter(|(point, _)| point.at(&x).x.abs() < 1.0 && point.at(&x).x < 0.2)
        .map(|(_, state)| state.friction.pressure)
        .collect();
    for edge in pressures.chunks_exact(4) {
        close("pressure of an edge", edge.iter().sum::<f64>() / 4.0, 107.0, 4.0);
    }
}

/// A strip of edges of 1, into which a tool that is smaller than they are goes by 0.48.
fn entered(kind: &str, tool: &Value) -> Value {
    json!({
        "mesh": {"blocks": [{"body": "strip", "corners": [[-3.5, -3], [3.5, -3], [3.5, 0], [-3.5, 0]], "elements": [7, 3],
                             "sides": ["base", null, "surface", null], "kind": kind}]},
        "bodies": {"strip": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}}},
        "rigid_bodies": {"tool": {"reference": [0, 1]}},
        "contacts": {"c": {"slave": "surface", "master": tool, "rigid_body": "tool", "friction": {"law": "coulomb", "mu": 0.3}}},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "base", "ux": 0, "uy": 0}, {"on": "tool", "ux": 0, "uy": -0.5, "angle": 0}]}],
    })
}

/// What enters an edge between its points without a pressure is as deep as it has gone, is told, and once.
#[test]
fn a_tool_inside_an_edge_is_told() {
    let disk = json!({"circle": {"centre": [0.05, 0.12], "radius": 0.1}});
    let wedge = json!({"polyline": {"points": [[0.5, 1], [0, 0.02], [-0.5, 1]]}});
    for (tool, what, found) in [
        (disk, Inside::Disk, "the rigid disk is inside the slave, between its points, by 8.000e-2, 8.0 % of its edge"),
        (
            wedge,
            Inside::Corner,
            "a corner of the rigid master is inside the slave by 8.000e-2, 8.0 % of its edge; sliding past it meets too much resistance",
        ),
    ] {
        let (mut warnings, model) = (Warnings::default(), Arc::new(common::model(&entered("Q4", &tool))));
        fecontact::run::run(&model, &mut [&mut warnings]).1.unwrap_or_else(|error| panic!("{error}"));
        let told: Vec<_> = warnings.list.iter().filter(|told| told.contains(" is inside the slave")).collect();
        assert!(told.len() == 1 && told[0].contains(found), "{:?}", warnings.list);
        assert!(warnings.list.iter().all(|told| common::warnings::is_listed(told)), "{:?}", warnings.list);
        let run = finish(&entered("Q4", &tool));
        let deepest = model.contacts[0].deepest(&model.configuration(&run.last().displacement)).expect("inside");
        assert_eq!(deepest.what, what);
        close("depth", deepest.depth, 0.48, 1e-12);
    }
}

/// A corner of the slave beside its Gauss points: as deep as it lies behind the plane.
#[test]
fn a_corner_of_the_slave_counts_as_deep_as_it_is() {
    let run = finish(&json!({
        "mesh": {"blocks": [{"body": "block", "corners": [[0, 0], [4, -1], [5, 3], [1, 4]], "elements": [4, 4],
                             "sides": ["outline", "outline", "top", "outline"]}]},
        "bodies": {"block": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}}},
        "contacts": {"floor": {"slave": "outline", "master": {"plane": {"point": [0, -1.05], "normal": [0, 1]}}, "method": "gauss_to_segment",
                               "friction": {"law": "frictionless"}}},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "top", "ux": 0, "uy": -0.3}]}],
    }));
    let x = run.model.configuration(&run.last().displacement);
    let lowest = (0..run.model.mesh.nodes.len())
        .map(|node| (x.reference(node) + x.displacement(node)).y)
        .fold(f64::INFINITY, f64::min);
    let deepest = run.model.contacts[0].deepest(&x).expect("inside");
    assert_eq!(deepest.what, Inside::SlaveNode);
    close("depth", deepest.depth, -1.05 - lowest, 1e-12);
    let points = run.last().contacts[0].iter().map(|state| -state.clearance()).fold(0.0, f64::max);
    assert!(deepest.depth > 0.01 && points < 0.3 * deepest.depth, "{deepest:?} {points}");
}

/// The block stands on a rigid block that is wider: its ends and corners have points of their own, and the pressure is even.
#[test]
fn a_wider_rigid_block_presses_evenly() {
    for kind in ["Q4", "Q8"] {
        let run = finish(&json!({
            "mesh": {"blocks": [{"body": "block", "kind": kind, "corners": [[0, 0], [4, 0], [4, 2], [0, 2]], "elements": [5, 2],
                                 "sides": ["bottom", null, "top", "left"]}]},
            "bodies": {"block": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}}},
            "contacts": {"floor": {"slave": "bottom", "friction": {"law": "frictionless"},
                "master": {"polyline": {"points": [[6, -1], [-1, -1], [-1, 0], [6, 0], [6, -1]]}}}},
            "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.5}, "supports": [{"on": "top", "uy": -0.1}, {"on": "left", "ux": 0}]}],
        }));
        let pressures: Vec<f64> = run.last().contacts[0].iter().map(|state| state.friction.pressure).collect();
        assert!(pressures[0] > 1.0);
        pressures.iter().for_each(|pressure| close(kind, *pressure, pressures[0], 1e-10 * pressures[0]));
    }
}

/// Ends and corners of the slave are points, and the rules there integrate powers up to the second on linear edges, and up to the fourth on
/// quadratic ones.
#[test]
fn points_at_corners_integrate_exactly() {
    let at = |x: f64, y: f64| Vector2::new(x, y);
    let nodes = [
        at(0.0, 0.0),
        at(1.0, 0.0),
        at(2.0, 0.0),
        at(2.0, 1.0),
        at(0.5, 0.0),
        at(1.5, 0.0),
        at(2.0, 0.5),
        at(3.0, 0.0),
        at(2.5, 0.0),
    ];
    for (edges, degree, held) in [
        (vec![vec![0, 1], vec![1, 2], vec![2, 3]], 2, vec![0, 2, 2, 3]),
        (vec![vec![0, 1, 4], vec![1, 2, 5], vec![2, 3, 6]], 4, vec![0, 2, 2, 3]),
        (vec![vec![0, 1, 4], vec![1, 2, 5], vec![2, 7, 8]], 4, vec![0, 7]),
    ] {
        let points = gauss_points_and_corners(&edges, |edge, end| is_corner(&edges, &nodes, edge, end));
        let at_node =
            |point: &SlavePoint| point.position.iter().find(|(_, weight)| *weight == 1.0).map(|&(node, _)| node);
        assert_eq!(points.iter().filter_map(at_node).collect::<Vec<_>>(), held);
        for edge in &edges {
            let own = |point: &&SlavePoint| point.length[0].tangent[0].0 == edge[0];
            for power in 0..=degree {
                // N₂ + N_m/2 = (1 + ξ)/2
                let half =
                    |weights: &[(usize, f64)]| weights[1].1 + weights.get(2).map_or(0.0, |middle| 0.5 * middle.1);
                let sum: f64 = points
                    .iter()
                    .filter(own)
                    .map(|point| point.length[0].factor * half(&point.position).powi(power))
                    .sum();
                close("∫ ((1 + ξ)/2)ᵏ dξ", sum, 2.0 / f64::from(power + 1), 1e-14);
            }
        }
    }
}

/// Nodes stop at a corner beside them; the message says where the corner is by then, and what meets it. The largest residual lies there, or at
/// another node of the clay: one that jumps from the base to the side of the box lets go of all others.
#[test]
fn a_stop_names_the_corner() {
    for (gap, penalty) in [(0.001, None), (0.0, None), (0.0, Some(1e9))] {
        let mut case = box_on_clay("Q4", gap, &json!({"law": "coulomb", "mu": 0.5}));
        case["contacts"]["base"]["method"] = json!("node_to_segment");
        case["steps"][1]["dt"]["min"] = json!(2e-4);
        if let Some(alpha_n) = penalty {
            case["contacts"]["base"]["normal"] = json!({"alpha_n": alpha_n});
        }
        let model = Arc::new(common::model(&case));
        let message = fecontact::run::run(&model, &mut []).1.expect_err("a node has no normal there").to_string();
        let named = message.split_once(", at the corner (").unwrap_or_else(|| panic!("{message}")).1;
        let x: f64 = named.split(',').next().and_then(|x| x.parse().ok()).unwrap_or_else(|| panic!("{message}"));
        assert!(message.contains("of contact `base`") && (x.abs() - 1.0).abs() < 0.01, "{message}");
        assert!(named.contains(") of its rigid master: take \"method\": \"gauss_to_segment\" there"), "{message}");
    }
    // What it says is `a_rigid_box_presses_and_drags`.
}
