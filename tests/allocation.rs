//! Explicit increments take no memory anew.

mod common;

use std::alloc::System;
use std::sync::Arc;

use common::{Blocks, model};
use fecontact::equations::Assembler;
use fecontact::laws::friction::Regime;
use fecontact::model::state::State;
use fecontact::time::explicit::Explicit;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde_json::{Value, json};
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};

#[global_allocator]
static COUNTED: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Bodies, linear and not, viscous or not, dashpots, absorbing sides, dead loads, springs and supports, constant, by table and
/// by expression; and contacts, at nodes and at Gauss points, on meshes that match and do not, on curved surfaces and rigid
/// ones, of a surface with itself, by mortar, sticking and slipping, in small and finite sliding, also where points go over to
/// other edges, which makes contacts be looked at again: from the tenth increment on none asks for memory, on one thread
/// or two. (Pressures that follow the surface do, and the look at elements that have changed their shape, which the small motion
/// here does not make necessary.)
#[test]
fn explicit_increments_allocate_nothing() {
    let mesh = Blocks::default().rectangle("plain", [24, 24], [0.0, 0.0], [1.0, 1.0]).rectangle(
        "viscous",
        [24, 24],
        [2.0, 0.0],
        [3.0, 1.0],
    );
    let material = |law: &str| json!({"model": law, "E": 100, "nu": 0.3, "density": 1});
    let case = json!({
        "mesh": mesh.json(),
        "bodies": {
            "plain": {"material": material("linear")},
            "viscous": {"material": material("neo_hookean"), "damping": {"mass": 0.1, "stiffness": 1e-4}}
        },
        "initial_velocity": {"plain": [1e-4, 0]},
        "steps": [{
            "name": "shake", "duration": 1, "scheme": {"explicit": {}}, "dt": {"initial": 0.1},
            "supports": [{"on": "plain_bottom", "uy": "1e-5*sin(3*t)*x"}, {"on": "viscous_bottom", "ux": 0, "uy": {"rate": 1e-5}}],
            "loads": [
                {"on": "plain", "gravity": {"y": -1e-3}},
                {"on": "plain_top", "traction": {"x": {"table": [[0, 0], [1, 1e-3]]}}},
                {"on": "plain_left", "spring": {"kx": 2}},
                {"on": "viscous_top", "dashpot": {"cx": 0.1}},
                {"on": "viscous_right", "absorbing": true}
            ]
        }]
    });
    let weakening = json!({"law": "slip_weakening", "mu_s": 0.5, "mu_d": 0.2, "D_c": 1e-4});
    let healing = json!({"law": "super_subloading", "mu_s": 0.5, "mu_k": 0.2, "r": 1e4, "kappa": 1e3, "xi": 0.1});
    let plane = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
    let pool = |threads| ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    let pools = [1, 2].map(|threads| (threads, pool(threads)));
    let small = |method: &str| {
        let mut case = touching(&json!("lower_top"), method, &weakening);
        case["contacts"]["fault"]["sliding"] = json!("small");
        case
    };
    let far = |master: &Value, method: &str| {
        let mut case = touching(master, method, &weakening);
        case["steps"][0]["supports"][1]["ux"]["rate"] = json!(0.2);
        case
    };
    let itself = |method: &str| {
        let mut case = far(&json!("lower_top"), method);
        let edges = |group: &str| case["mesh"]["edges"][group].as_array().expect("edges").clone();
        let both = [edges("lower_top"), edges("upper_bottom")].concat();
        case["mesh"]["edges"]["both"] = json!(both);
        (case["contacts"]["fault"]["slave"], case["contacts"]["fault"]["master"]) = (json!("both"), json!("both"));
        case
    };
    let lower = json!("lower_top");
    for (case, least) in [
        (case, 100),
        (touching(&json!("lower_top"), "node_to_segment", &weakening), 50),
        (touching(&json!("lower_top"), "gauss_to_segment", &healing), 50),
        (touching(&plane, "gauss_to_segment", &weakening), 50),
        (small("node_to_segment"), 50),
        (small("mortar"), 50),
        (touching(&lower, "mortar", &weakening), 50),
        (touching(&plane, "mortar", &weakening), 50),
        (far(&lower, "node_to_segment"), 50),
        (far(&lower, "gauss_to_segment"), 50),
        (far(&lower, "mortar"), 50),
        (itself("node_to_segment"), 50),
        (itself("gauss_to_segment"), 50),
        (itself("mortar"), 50),
    ] {
        count(&case, least, &pools);
    }
}

/// A block pressed and dragged over another, or over a rigid plane, its nodes over the middles of edges: no point goes over to
/// another edge.
fn touching(master: &Value, method: &str, friction: &Value) -> Value {
    let mesh = Blocks::default().rectangle("lower", [80, 3], [-0.5, -0.2], [1.5, 0.0]).rectangle(
        "upper",
        [40, 3],
        [0.0125, 0.0],
        [1.0125, 0.2],
    );
    let material = json!({"material": {"model": "linear", "E": 100, "nu": 0.3, "density": 1}});
    json!({
        "mesh": mesh.json(),
        "bodies": {"lower": material, "upper": material},
        "contacts": {"fault": {"slave": "upper_bottom", "master": master, "method": method, "friction": friction}},
        "steps": [{
            "name": "drag", "duration": 1, "scheme": {"explicit": {}}, "dt": {"initial": 0.1},
            "supports": [{"on": "lower_bottom", "ux": 0, "uy": 0}, {"on": "upper_top", "ux": {"rate": 0.02}, "uy": {"rate": -0.01}}]
        }]
    })
}

/// Whether points go over to other edges.
fn goes_far(case: &Value) -> bool {
    case["steps"][0]["supports"][1]["ux"]["rate"] == json!(0.2)
}

/// Memory that increments after the tenth ask for; the pools are there before, as their threads ask for some. Their queues
/// clear up now and then, which takes memory and has nothing to do with the increments: of three times the least counts.
fn count(case: &Value, least: usize, pools: &[(usize, ThreadPool)]) {
    let model = Arc::new(model(case));
    for (threads, pool) in pools {
        let counted = (0..3).map(|_| {
            pool.install(|| {
                let mut assembler = Assembler::new(&model);
                let (mut state, step) = (model.initial_state(), Arc::new(model.steps[0].clone()));
                state.begin_step(&[]);
                let mut explicit = Explicit::begin(&model, &step, &mut state, &mut assembler).expect("a start");
                let mut last = 0.0;
                while state.increment < 10 {
                    last += 1e-2;
                    explicit.go_to(last, &mut state, &mut assembler, &|| false).expect("increments");
                }
                let master_points = |state: &State| -> Vec<Option<usize>> {
                    state
                        .contacts
                        .iter()
                        .flatten()
                        .map(|point| point.master_point.map(|master_point| master_point.segment))
                        .collect()
                };
                let met = master_points(&state);
                let (before, increments) = (COUNTED.stats(), state.increment);
                let end = if model.contacts.is_empty() { 0.5 } else { 0.15 };
                explicit.go_to(last + end, &mut state, &mut assembler, &|| false).expect("increments");
                let after = COUNTED.stats();
                let done = state.increment - increments;
                if goes_far(case) {
                    assert!(
                        master_points(&state).iter().zip(&met).filter(|(now, met)| now != met).count() > 10,
                        "points go on"
                    );
                }
                assert!(done > least && (model.contacts.is_empty() || done < 180), "{done} increments");
                let slips = state.contacts.iter().flatten().filter(|point| point.regime() == Regime::Slip).count();
                assert!(model.contacts.is_empty() || slips > 10, "{slips} points slip");
                (after.allocations - before.allocations, after.bytes_allocated - before.bytes_allocated)
            })
        });
        let (count, bytes) = counted.min().expect("three");
        // Points between two edges have more nodes, and edges begin to face others: each list grows once.
        let (lists, grown) = if goes_far(case) { (10, 16384) } else { (0, 0) };
        assert!(count <= lists && bytes <= grown, "{count}, {bytes} bytes, on {threads} threads: {}", case["contacts"]);
    }
}
