//! A step that goes on explicitly while a contact slips fast: stuck for a second, broken within milliseconds, and slow again.

use crate::common::{Blocks, Finished, close, finish, refusal};
use serde_json::{Value, json};

/// A slab of 1 × 0.2 on a rigid plane, sheared slowly by its top, with G = 1 and c_s = 1000; the interface weakens by slip and
/// is weakest at its left end. `steps` are given their supports, which the first one brings.
fn slab(steps: Value, interval: f64) -> Value {
    let mut steps = steps;
    steps[0]["supports"] = json!([{"on": "slab_top", "ux": {"rate": 1.2e-4}, "uy": 0}]);
    json!({
        "mesh": Blocks::default().rectangle("slab", [80, 16], [0.0, 0.0], [1.0, 0.2]).json(),
        "bodies": {"slab": {
            "material": {"model": "linear", "E": 2.5, "nu": 0.25, "density": 1e-6}, "damping": {"stiffness": 2e-6},
        }},
        "contacts": {"base": {
            "slave": "slab_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 800.0},
            "friction": {"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.4, "D_c": 8e-6, "alpha_t": 800.0},
            "along": {"mu_s": {"x": [[0.2, 0.57], [0.3, 0.6]]}},
            "initial": {"pressure": 1e-3, "balanced": true},
        }},
        "steps": steps,
        "output": {"interval": interval},
    })
}

/// When the slip of the point nearest to x passes a value, linear between the records.
fn arrival(run: &Finished, x: f64) -> f64 {
    const SLIP: f64 = 4e-6;
    let undeformed = fecontact::mesh::configuration::Configuration::undeformed(&run.model.mesh.nodes);
    let points = &run.model.contacts[0].points;
    let off = |k: &usize| (points[*k].at(&undeformed).x - x).abs();
    let k = (0..points.len()).min_by(|a, b| off(a).total_cmp(&off(b))).expect("points");
    let slip = |n: usize| run.states[n].contacts[0][k].friction.plastic_slip.abs();
    let after = (0..run.states.len()).find(|&n| slip(n) > SLIP).expect("it slips");
    let [t0, t1] = [after - 1, after].map(|n| run.states[n].time);
    t0 + (t1 - t0) * (SLIP - slip(after - 1)) / (slip(after) - slip(after - 1))
}

fn slow(scheme: Value) -> Value {
    json!([{
        "name": "shear", "duration": 1.5, "scheme": scheme, "dt": {"initial": 0.005, "min": 1e-4},
        "rupture": {"slip_rate": 1e-3},
    }])
}

/// The audit closes all the time, where the scheme changes as well.
fn check_energy(run: &Finished) {
    let end = &run.last().energy;
    assert!(end.friction_dissipation > 0.5 * end.external_work, "{end:?}");
    for state in &run.states {
        close(&format!("energy at {}", state.time), state.energy.error(), 0.0, 0.01 * end.external_work);
    }
}

#[test]
fn a_slow_step_breaks_explicitly_and_goes_on_slowly() {
    let run = finish(&slab(slow(json!("static")), 1e-5));
    println!(
        "{} increments, {} ruptures, {:.1} s",
        run.report.increments, run.report.ruptures, run.report.wall_s.total
    );
    assert!((1..=3).contains(&run.report.ruptures), "{}", run.report.ruptures);
    let [near, far] = [0.4, 0.9].map(|x| arrival(&run, x));
    println!("the front passes x = 0.4 at {near}, x = 0.9 at {far}");
    assert!(far - near < 0.001, "it took {}", far - near);
    // Stuck before and slow after: long increments with few iterations, and sliding at the rate of the top.
    let slow = |from: f64, to: f64| run.states.iter().filter(|s| (from..to).contains(&s.time)).count();
    assert!(slow(0.0, near - 0.05) < 400 && slow(near + 0.05, 1.5) < 400);
    let [a, b] = [&run.states[run.states.len() - 2], run.last()];
    let [before, after] = [a, b].map(|state| state.contacts[0][80].friction.clone());
    let rate = (after.plastic_slip - before.plastic_slip) / (b.time - a.time);
    close("slip rate at the end", rate.abs(), 1.2e-4, 2e-6);
    close("friction at the end", after.traction.abs() / after.pressure, 0.4, 1e-6);
    check_energy(&run);

    // Explicitly from two milliseconds before, without any switch.
    let before = near - 0.002;
    let explicit = finish(&slab(
        json!([
            {"name": "load", "duration": before, "dt": {"initial": 0.005, "min": 1e-6}},
            {"name": "break", "duration": 0.008, "scheme": {"explicit": {}}, "dt": {"initial": 1.0}},
        ]),
        1e-5,
    ));
    let expected = [0.4, 0.9].map(|x| arrival(&explicit, x));
    println!("explicit alone: {expected:?}");
    let travel = expected[1] - expected[0];
    close("travel of the front", far - near, travel, 0.02 * travel);
    // When it sets out hangs on how the last of the load comes: at the pace of the top, or from rest two milliseconds before.
    close("its arrival", far, expected[1], 1e-4);
}

#[test]
fn an_implicit_step_hands_its_motion_over() {
    let run = finish(&slab(slow(json!({"generalized_alpha": {"rho_infinity": 0.5}})), 1e-5));
    println!("{} increments, {} ruptures", run.report.increments, run.report.ruptures);
    assert!((1..=3).contains(&run.report.ruptures), "{}", run.report.ruptures);
    let [near, far] = [0.4, 0.9].map(|x| arrival(&run, x));
    assert!(far - near < 0.001, "it took {}", far - near);
    check_energy(&run);
}

#[test]
fn a_step_that_never_slips_fast_never_switches() {
    let mut steps = slow(json!("static"));
    steps[0]["duration"] = json!(0.5);
    let run = finish(&slab(steps, 1e-5));
    assert_eq!((run.report.ruptures, run.states.len()), (0, 100));
}

#[test]
fn ruptures_are_checked() {
    let refused = |change: &dyn Fn(&mut Value), words: &str| {
        let mut case = slab(slow(json!("static")), 1e-5);
        change(&mut case);
        let error = refusal(&case);
        assert!(error.contains(words), "{error}");
    };
    refused(&|case| case["steps"][0]["rupture"] = json!({"slip_rate": 0.0}), "steps[0].rupture.slip_rate: is 0");
    refused(&|case| case["steps"][0]["rupture"] = json!({"slip_rate": 1.0, "safety": 2.0}), "at most 1");
    refused(&|case| case["steps"][0]["scheme"] = json!({"explicit": {}}), "explicit throughout");
    // A mass on a plane: no wave crosses it.
    let massive = |case: &mut Value| {
        case["mesh"] = json!({"nodes": [[0, 0]], "points": {"mass": [0]}});
        case["bodies"] = json!({});
        case["point_masses"] = json!({"mass": {"mass": 1}});
        case["contacts"] = json!({"base": {"slave": "mass", "area": 1, "normal": {"alpha_n": 1e3},
            "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 1e3}}});
        case["steps"][0]["supports"] = json!([{"on": "mass", "uy": 0}]);
    };
    refused(&massive, "needs a body");
    refused(&|case| case["bodies"]["slab"]["material"]["density"] = json!(0.0), "give a density");
    refused(&|case| case["contacts"]["base"]["normal"]["penetration"] = json!(1e-9), "takes the plain penalty");
}

#[test]
fn a_static_step_stops_a_motion_and_tells_what_it_took() {
    // A pulled bar is let go and stopped in full swing: what it had of motion and of stress out of balance counts as damped.
    for scheme in [json!({"newmark": {}}), json!({"explicit": {}})] {
        let run = finish(&json!({
            "mesh": Blocks::default().rectangle("bar", [10, 1], [0.0, 0.0], [1.0, 0.1]).json(),
            "bodies": {"bar": {"material": {"model": "linear", "E": 4.0, "nu": 0.0, "density": 1.0}}},
            "steps": [
                {"name": "pull", "duration": 1, "dt": {"initial": 1},
                 "supports": [{"on": "bar_left", "ux": 0, "uy": 0}], "loads": [{"on": "bar_right", "force": {"x": 1e-3}}]},
                {"name": "free", "duration": 0.35, "dt": {"initial": 0.005}, "scheme": scheme,
                 "loads": [{"on": "bar_right", "force": {"x": "0"}}]},
                {"name": "stop", "duration": 1, "dt": {"initial": 0.5}, "scheme": "static"},
            ],
        }));
        let energy = &run.last().energy;
        close("strain", energy.strain, 0.0, 1e-9 * energy.external_work);
        close("damped", energy.damping_dissipation, energy.external_work, 0.01 * energy.external_work);
        close("energy", energy.error(), 0.0, 0.01 * energy.external_work);
    }
}

/// A box of mass m, drawn by a spring k whose end moves with v, breaks away when k v t = μ p A at t = 6, and then moves as
/// x = v t' − (v/ω) sin ωt', ω² = k/m: slowly at first, so that it seems to be over, while no static state is near. The motion goes on.
#[test]
fn a_rupture_that_begins_slowly_is_not_stopped() {
    let (k, v) = (10.0, 0.1);
    let mut case = json!({
        "mesh": Blocks::default().rectangle("box", [2, 1], [0.0, 0.0], [2.0, 1.0]).json(),
        "bodies": {"box": {"material": {"model": "linear", "E": 1e6, "nu": 0.0, "density": 1}}},
        "plates": ["box_top"],
        "contacts": {"base": {
            "slave": "box_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "method": "node_to_segment",
            "sliding": "small", "normal": {"alpha_n": 1e5},
            "friction": {"law": "coulomb", "mu": 0.6, "alpha_t": 1e5}, "initial": {"pressure": 5},
        }},
        "steps": [{
            "name": "draw", "duration": 8, "dt": {"initial": 0.01, "min": 1e-3}, "rupture": {"slip_rate": 0.01},
            "loads": [{"on": "box_top", "total_force": {"y": "-10"}},
                {"on": {"near": [0, 1]}, "spring": {"kx": k, "driver": {"x": {"rate": v}}}}],
        }],
    });
    for slip_rate in [0.001, 0.01, 0.03] {
        case["steps"][0]["rupture"]["slip_rate"] = json!(slip_rate);
        let run = finish(&case);
        let omega = (k / 2.0f64).sqrt();
        for state in run.states.iter().filter(|state| state.time > 6.3) {
            let after = state.time - 6.0;
            let expected = v * after - v / omega * (omega * after).sin();
            close(&format!("x at {}", state.time), state.displacement[0], expected, 0.01 * v * after);
        }
        assert_eq!(run.report.ruptures, 1, "by {slip_rate}");
        let energy = &run.last().energy;
        close("energy", energy.error(), 0.0, 0.01 * energy.external_work);
    }
}

/// A slab that slides on a guide without friction, faster than a rupture would: there is nothing to break. The ten
/// increments stay ten.
#[test]
fn frictionless_sliding_is_no_rupture() {
    let run = finish(&json!({
        "mesh": Blocks::default().rectangle("slab", [8, 4], [0.0, 0.0], [1.0, 0.5]).json(),
        "bodies": {"slab": {"material": {"model": "linear", "E": 1000, "nu": 0.3, "density": 1e-3}}},
        "contacts": {"guide": {
            "slave": "slab_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "friction": {"law": "frictionless"}, "initial": {"pressure": 1},
        }},
        "steps": [{
            "name": "slide", "duration": 1, "dt": {"initial": 0.1}, "rupture": {"slip_rate": 0.01},
            "supports": [{"on": "slab_top", "ux": {"rate": 0.1}, "uy": 0}],
        }],
    }));
    let slid = run.last().contacts[0][0].friction.plastic_slip.abs();
    // But for the strain across of the pressed slab, ν(1 + ν) p/E at half its length.
    close("slip", slid, 0.1, 2e-4);
    assert_eq!((run.report.increments, run.report.ruptures, run.report.rejected), (10, 0, 0));
}
