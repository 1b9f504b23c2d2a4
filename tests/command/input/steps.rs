//! Steps, supports, amplitudes, loads and tolerances.

use super::*;

#[test]
fn steps_are_checked() {
    for (pointer, value, fragments) in [
        ("/steps", json!([]), ["steps: ", "at least one step"]),
        ("/steps/0/duration", json!(0), ["steps[0].duration: ", "is 0: must be positive"]),
        ("/steps/0/duration", json!(-1), ["steps[0].duration: ", "is -1: must be positive"]),
        ("/steps/0/duration", json!(1e300), ["steps[0].dt.min: ", "lost in round-off"]),
        ("/steps/0/dt/min", json!(0.6), ["steps[0].dt: ", "min = 0.6 is above max = 0.5"]),
        ("/steps/0/dt/min", json!(0), ["steps[0].dt.min: ", "must be positive"]),
        ("/steps/0/dt/initial", json!(-0.1), ["steps[0].dt.initial: ", "must be positive"]),
        ("/steps/0/dt/max", json!(0.1), ["steps[0].dt: ", "initial = 0.5 must lie between"]),
        ("/steps/0/scheme", json!("newmrk"), ["steps[0].scheme", "did you mean `newmark`?"]),
        (
            "/steps/0/scheme",
            json!({"hht": {"alpha": -0.9}}),
            ["steps[0].scheme: ", "\"alpha\" is -0.9, but it must be between -1/3"],
        ),
        (
            "/steps/0/scheme",
            json!({"newmark": {"gamma": 0.1}}),
            ["steps[0].scheme: ", "\"gamma\" is 0.1, but it must be at least"],
        ),
        (
            "/steps/0/scheme",
            json!({"generalized_alpha": {"rho_infinity": 1.5}}),
            ["steps[0].scheme: ", "\"rho_infinity\" is 1.5, but it must be between 0 (most damping) and 1"],
        ),
        (
            "/steps/0/scheme",
            json!({"wilson": {"theta": 1.3}}),
            ["steps[0].scheme: ", "\"theta\" is 1.3, but it must be between 1.37, below which long increments blow up"],
        ),
        ("/steps/0/scheme", json!({"wilson": {"tetha": 1.4}}), ["steps[0].scheme", "did you mean `theta`?"]),
        ("/steps/0/dt/error", json!(0), ["steps[0].dt.error: ", "is 0: must be positive"]),
        ("/steps/0/dt/error", json!(-1e-3), ["steps[0].dt.error: ", "is -0.001: must be positive"]),
        ("/steps/0/dt/eror", json!(1e-3), ["steps[0].dt.eror: ", "did you mean `error`?"]),
        ("/steps/0/scheme", json!({"hht": {}}), ["steps[0].scheme.hht", "the key `alpha` is missing"]),
        ("/steps/0/scheme", json!({"hht": {"alpha": -0.1}}), ["bodies.block.material.density: ", "needs a mass"]),
        ("/steps/0/stabilize", json!(0), ["steps[0].stabilize: ", "is 0: must be a fraction of the stiffness"]),
        ("/steps/0/stabilize", json!(2), ["steps[0].stabilize: ", "is 2: must be a fraction of the stiffness"]),
        ("/steps/0/name", json!(""), ["steps[0].name: ", "is empty"]),
        ("/steps/0/name", json!("press, drag"), ["steps[0].name: ", "','"]),
        ("/steps/0/name", json!("press\ndrag"), ["steps[0].name: ", "'\\n'"]),
        ("/watch/0", json!("block_tip"), ["watch[0]: ", "did you mean `block_top`?"]),
        ("/watch", json!(["block_top", "block_top"]), ["watch[1]: ", "watched already"]),
        ("/watch/0", json!({"near": [0.5, 7]}), ["watch[0]: ", "no node is near (0.5, 7)"]),
        ("/watch/0", json!({"node": 99}), ["watch[0]: ", "the mesh has no node 99"]),
        ("/watch", json!([{"node": 3}, {"node": 3}]), ["watch[1]: ", "`node_3` is watched already"]),
        ("/output", json!({"every": 0}), ["output.every: ", "must be at least 1"]),
        ("/newton", json!({"tolerance": 0}), ["newton.tolerance: ", "above 0 and at most 0.01"]),
        ("/newton", json!({"max_iterations": 0}), ["newton.max_iterations: ", "1 to 1000"]),
        ("/initial_velocity", json!({"brick": [0, 1]}), ["initial_velocity.brick: ", "the bodies are block, ground"]),
    ] {
        refused_edits(&[(pointer, value)], &fragments);
    }
    for (scheme, fragment) in [
        (json!({"wilson": {}}), "wilson has no error estimate: take newmark, hht or generalized_alpha"),
        (json!({"newmark": {"beta": 0.166}}), "newmark with beta near 1/6 has no error estimate"),
    ] {
        let edits = [("/steps/0/scheme", scheme), ("/steps/0/dt/error", json!(1e-3))];
        refused_edits(&edits, &["steps[0].dt.error: ", fragment]);
    }
    let contact = good()["contacts"]["base"].clone();
    refused_edits(&[("/contacts", json!({"a,b": contact}))], &["contacts: ", "\"a,b\"", "','"]);
}

#[test]
fn supports_are_checked() {
    refused_edits(
        &[("/steps/0/supports", json!([]))],
        &["steps[0].supports: ", "`block` with `ground`", "there is no support at all"],
    );
    let alone = [("/contacts", json!({}))];
    let floating = json!([{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0}]);
    refused_edits(
        &[&alone[..], &[("/steps/0/supports", floating)]].concat(),
        &["steps[0].supports: ", "`block` can move freely along y", "supports do not constrain it"],
    );
    let turning = json!([{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": {"node": 10}, "ux": 0, "uy": 0}]);
    refused_edits(
        &[&alone[..], &[("/steps/0/supports", turning)]].concat(),
        &["steps[0].supports: ", "`block` can move freely", "in rotation"],
    );
    for (support, fragments) in [
        (json!({"on": "top", "ux": 0}), ["steps[0].supports[1].on: ", "no group `top`"]),
        (json!({"on": {"node": 99}, "ux": 0}), ["steps[0].supports[1].on: ", "the mesh has no node 99"]),
        (
            json!({"on": "block_top"}),
            ["steps[0].supports[1]: ", "prescribes nothing: give ux, uy, along with u, un or rotation"],
        ),
        (json!({"on": "block_top", "ux": null}), ["steps[0].supports[1].ux: ", "null ends what an earlier step gave"]),
        (json!({"on": "block_top", "rotation": null}), ["supports[1].rotation: ", "null ends what an earlier step"]),
        (
            json!({"on": "block_top", "ux": 0, "rotation": {"about": [0, 0], "angle": 1}}),
            ["steps[0].supports[1]: ", "gives rotation and ux"],
        ),
    ] {
        refused_edits(&[("/steps/0/supports/1", support)], &fragments);
    }
    let mut nodes = good()["mesh"]["nodes"].clone();
    nodes.as_array_mut().expect("a list").push(json!([9, 9]));
    refused_edits(
        &[("/mesh/nodes", nodes), ("/mesh/points", json!({"lone": [14]}))],
        &["steps[0].supports: ", "node 14 belongs to no element and is free along x"],
    );
}

#[test]
fn amplitudes_are_checked() {
    for (value, fragment) in [
        (json!("0.01*z"), "`z` is not one of the variables x, y, t"),
        (json!("sin("), "\"sin(\" cannot be read: a number, a name or a bracket is missing here\n    sin(\n        ^"),
        (json!("2 + SIN(t)"), "`SIN` is not one of the variables x, y, t (did you mean `sin`?)"),
        (json!("2 + SIN(t)"), "    2 + SIN(t)\n        ^"),
        (json!("z"), "nor a function: abs, acos,"),
        (json!("2t"), "an operator is missing here: a product is written 2*t\n    2t\n     ^"),
        (json!("0,01*t"), "decimals have a point\n    0,01*t\n     ^"),
        (json!("t**2"), "a power is written with ^\n    t**2\n      ^"),
        (json!("sin t"), "`sin` needs its value in brackets: sin(…)"),
        (json!("atan2(t)"), "a comma and another value are missing: atan2(…, …)"),
        (json!("(t > 2)*3"), "`>` is not an operator: there are + - * / ^ and brackets\n    (t > 2)*3\n       ^"),
        (json!("1 + (t*2"), "this bracket is not closed\n    1 + (t*2\n        ^"),
        (json!("t)"), "this bracket was not opened"),
        (json!(format!("{}z", "t + ".repeat(200))), "\"…+ t + t + t"),
        (json!(format!("{}t{}", "1+(".repeat(80), ")".repeat(80))), "more than 32 levels of brackets"),
        (json!("1e-3*ln(t-0.5)"), "has no finite value at t = 0.01, (x, y) = (0.5, 1): check the expression"),
        (json!("0.001/(x-2.5)"), "has no finite value at t = 0.01, (x, y) = (2.5, 1)"),
        (json!("1/(t-0.25)"), "has no finite value at t = 0.25"),
        (json!(""), "cannot be read"),
        (json!("1 +"), "cannot be read"),
        (json!("(".repeat(2000)), "longer than 1000 characters"),
        (json!({"table": []}), "the table is empty"),
        (json!({"table": [[1, 0], [0, 1]]}), "times of the table must increase: 0 follows 1"),
        (json!({"table": [[0, 0], [0, 1]]}), "times of the table must increase"),
    ] {
        refused_edits(&[("/steps/0/supports/1/uy", value)], &["steps[0].supports[1].uy", fragment]);
    }
}

#[test]
fn loads_are_checked() {
    for (load, fragments) in [
        (json!({"on": "block", "pressure": 1}), ["steps[0].loads[0].on: ", "of solid elements, not of edges"]),
        (json!({"on": "block", "gravity": {"y": -9.81}}), ["loads[0].on: ", "give bodies.block.material.density"]),
        (
            json!({"on": "block_top", "gravity": {"y": 1}}),
            ["loads[0].on: ", "no body or point mass `block_top`, on which gravity acts; there are block, ground"],
        ),
        (json!({"on": "block_top", "pressure": 1, "force": {"x": 1}}), ["loads[0]: ", "exactly one of pressure"]),
        (json!({"on": "block_top"}), ["loads[0]: ", "exactly one of pressure"]),
        (json!({"on": {"node": 3}, "pressure": 1}), ["loads[0].on: ", "node 3 cannot carry this load"]),
        (json!({"on": {"near": [1]}, "force": {"x": 1}}), ["loads[0].on.near: ", "must have 2 numbers"]),
        (
            json!({"on": {"nod": 3}, "force": {"x": 1}}),
            ["loads[0].on", "`nod` is not known here; did you mean `node`?"],
        ),
        (
            json!({"on": {"near": [1e3, 0]}, "force": {"x": 1}}),
            ["loads[0].on: ", "no node is near (1000, 0): the nearest, "],
        ),
        (
            json!({"on": "block_top", "total_force": {"x": "x"}}),
            ["loads[0].total_force.x: ", "is the force on the whole group"],
        ),
        (json!({"on": "block_top", "dead_pressure": null}), ["loads[0]: ", "null ends what an earlier step gave"]),
        (json!({"on": "block_top", "spring": {"kx": -1}}), ["loads[0].spring.kx: ", "must be zero or positive"]),
        (json!({"on": "block_top", "traction": {"z": 1}}), ["loads[0].traction.z: ", "is not known here"]),
        (json!({"on": "block_top", "pressure": null}), ["loads[0]: ", "null ends what an earlier step gave"]),
    ] {
        refused_edits(&[("/steps/0/loads", json!([load]))], &fragments);
    }
}

/// Settings that no solution can meet, or any can.
#[test]
fn tolerances_out_of_reach_or_reason_are_refused() {
    refused_edits(
        &[("/newton", json!({"tolerance": 0.9}))],
        &["newton.tolerance: is 0.9: must be above 0 and at most 0.01"],
    );
    // The box around the nodes of the contact is 4 long and has no height [L].
    let least = 8.0 * f64::EPSILON * 4.0;
    let normal = |penetration: f64| ("/contacts/base/normal", json!({"alpha_n": 1e5, "penetration": penetration}));
    refused_edits(
        &[normal(0.99 * least)],
        &["contacts.base.normal.penetration: is 7.", &format!("gaps of this contact have round-off of {least:.1e}")],
    );
    outcome("check", &[normal(1.01 * least)]);
}

/// The length of a run is foreseen as far as it follows from the case.
#[test]
fn endless_runs_are_refused_and_long_ones_told() {
    let dt = |max: f64| ("/steps/0/dt", json!({"initial": max, "min": 0.5 * max, "max": max}));
    refused_edits(&[dt(1e-9)], &["steps[0].dt: increments of at most 1e-9 make 1.0e9 of them in a step of 1e0"]);
    let [printed, _] = outcome("check", &[dt(1e-7)]);
    assert!(printed.contains("the run takes at least 1.0e7 increments, each a row of history.csv"), "{printed}");
    let [printed, _] = outcome("check", &[dt(1e-5)]);
    assert!(!printed.contains("the run takes at least"), "{printed}");
    let material = json!({"model": "neo_hookean", "E": 1000, "nu": 0.3, "density": 1});
    let explicit = [
        ("/bodies/block/material", material.clone()),
        ("/bodies/ground/material", material),
        ("/steps/0/scheme", json!({"explicit": {"safety": 0.9}})),
        ("/steps/0/duration", json!(1e6)),
        ("/steps/0/dt", json!({"initial": 1})),
        ("/output", json!({"interval": 1e-3})),
    ];
    refused_edits(&explicit, &["output.interval: is 1e-3: this makes 1.0e9 rows of results"]);
    let mut explicit = explicit;
    explicit[5].1 = json!({"interval": 1e4});
    // c_p = √(E (1 − ν)/((1 + ν)(1 − 2ν) ρ)) = √1346.15 along the shortest side, 1 [L].
    let [printed, _] = outcome("check", &explicit);
    assert!(printed.contains("the run takes at least 3.7e7 increments: explicit ones"), "{printed}");
}
