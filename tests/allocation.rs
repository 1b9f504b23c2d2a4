//! Explicit increments take no memory anew.

mod common;

use std::alloc::System;
use std::sync::Arc;

use common::{Blocks, model};
use fecontact::equations::Assembler;
use fecontact::time::explicit::Explicit;
use serde_json::json;
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};

#[global_allocator]
static COUNTED: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Bodies, linear and not, viscous or not, dashpots, absorbing sides, dead loads, springs and supports, constant, by table and
/// by expression: from the tenth increment on none asks for memory, on one thread or two. (Contact and pressures that follow
/// the surface do, for the variations of each point; so does the look at elements that have changed their shape, which the
/// small motion here does not make necessary.)
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
    let model = Arc::new(model(&case));
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let (count, bytes) = pool.install(|| {
            let mut assembler = Assembler::new(&model);
            let (mut state, step) = (model.initial_state(), Arc::new(model.steps[0].clone()));
            state.begin_step();
            let mut explicit = Explicit::begin(&model, &step, &mut state, &mut assembler).expect("a start");
            let mut last = 0.0;
            while state.increment < 10 {
                last += 1e-2;
                explicit.go_to(last, &mut state, &mut assembler).expect("increments");
            }
            let (before, increments) = (COUNTED.stats(), state.increment);
            explicit.go_to(last + 0.5, &mut state, &mut assembler).expect("increments");
            let after = COUNTED.stats();
            assert!(state.increment > increments + 100, "only {} increments", state.increment - increments);
            (after.allocations - before.allocations, after.bytes_allocated - before.bytes_allocated)
        });
        assert_eq!((count, bytes), (0, 0), "on {threads} threads");
    }
}
