//! Explicit increments: stability, order, energy, impact, and the same bits on any number of threads.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::{Blocks, Finished, Record, close, finish, model, refusal};
use fecontact::run::run;
use nalgebra::DMatrix;
use serde_json::{Value, json};

/// Two bars of length 1 with ρ = 1 and c = 1, in uniaxial strain along x; the left one flies at the right with v = 1e-3.
fn bars(scheme: Value, n: usize) -> Value {
    let h = 1.0 / n as f64;
    let blocks = Blocks::default().rectangle("left", [n, 1], [-1.0, 0.0], [0.0, h]).rectangle(
        "right",
        [n, 1],
        [0.0, 0.0],
        [1.0, h],
    );
    // λ + 2G = 1 with ν = 0.3
    let modulus = 1.3 * 0.4 / 0.7;
    let material = json!({"material": {"model": "linear", "E": modulus, "nu": 0.3, "density": 1.0}});
    json!({
        "mesh": blocks.json(),
        "bodies": {"left": material, "right": material},
        "contacts": {"ends": {
            "slave": "left_right", "master": "right_left", "normal": {"alpha_n": 2.0 / h},
            "friction": {"law": "frictionless"},
        }},
        "initial_velocity": {"left": [1e-3, 0.0]},
        "steps": [{
            "name": "impact", "duration": 2.5, "scheme": scheme, "dt": {"initial": 0.005},
            "supports": [{"on": "left", "uy": 0}, {"on": "right", "uy": 0}],
        }],
        "output": {"interval": 0.005},
    })
}

/// The stress is ρ c v/2 in the middle half of a contact that lasts 2 L/c.
fn check_impact(run: &Finished, n: usize) {
    let pressure = |time: f64| {
        let [normal, _] = run.contact_force(run.at(time));
        normal * n as f64
    };
    let times: Vec<f64> = (1..=500).map(|k| 0.005 * f64::from(k)).collect();
    let closed: Vec<f64> = times.iter().copied().filter(|&time| pressure(time) > 0.0).collect();
    let (first, last) = (closed[0], closed[closed.len() - 1]);
    close("duration", last - first, 2.0, 0.04);
    // By the momentum that the right bar gains: the end nodes swing on the contact spring.
    let momentum = |time: f64| {
        let (model, state) = (&run.model, run.at(time));
        let of = |e: &usize| {
            let masses = model.element_lumped_mass(*e);
            let nodes = model.mesh.elements[*e].nodes.iter().zip(masses.iter());
            nodes.map(|(&node, mass)| mass * state.velocity[2 * node]).sum::<f64>()
        };
        model.bodies[1].elements.iter().map(of).sum::<f64>() * n as f64
    };
    close("mean stress", momentum(1.5) - momentum(0.5), 0.5e-3, 0.02 * 0.5e-3);
    let energy = run.last().energy;
    close("energy", energy.error(), 0.0, 0.01 * energy.initial);
    // The left bar has stopped and the right one flies.
    let velocity = |group: &str| {
        let nodes = run.nodes(group);
        nodes.iter().map(|&node| run.last().velocity[2 * node]).sum::<f64>() / nodes.len() as f64
    };
    close("left velocity", velocity("left"), 0.0, 2e-5);
    close("right velocity", velocity("right"), 1e-3, 2e-5);
}

#[test]
fn two_bars_exchange_their_velocities() {
    check_impact(&finish(&bars(json!({"explicit": {}}), 200)), 200);
}

/// A square of Q4 elements that rests on springs, struck from above.
fn square(kind: &str, safety: f64, duration: f64) -> Value {
    let distorted = |s: f64, t: f64| [s + 0.05 * (3.0 * t).sin() * s, t + 0.04 * (5.0 * s).sin() * t];
    let material = json!({"material": {"model": kind, "E": 100.0, "nu": 0.3, "density": 2.0}});
    json!({
        "mesh": Blocks::default().block("block", [6, 5], distorted).json(),
        "bodies": {"block": material},
        "initial_velocity": {"block": [0.3, -0.2]},
        "steps": [{
            "name": "swing", "duration": duration, "scheme": {"explicit": {"safety": safety}},
            "dt": {"initial": 1.0},
            "loads": [{"on": "block_bottom", "spring": {"kx": 300.0, "ky": 500.0}}, {"on": "block_top", "spring": {"kx": 7.0, "ky": 11.0}}],
        }],
        "output": {"interval": 0.5},
    })
}

#[test]
fn a_thousand_periods_at_the_limit_of_stability_keep_the_energy() {
    for kind in ["linear", "neo_hookean"] {
        let run = finish(&square(kind, 1.0, 20.0));
        assert!(run.report.increments > 1000, "{}", run.report.increments);
        // Where nothing but springs and linear elements act, the audit closes to round-off.
        let initial = run.last().energy.initial;
        let worst = run.states.iter().fold(0.0f64, |worst, state| worst.max(state.energy.error().abs()));
        let allowed = if kind == "linear" { 1e-9 } else { 0.01 };
        assert!(worst < allowed * initial, "{kind}: {worst} of {initial}");
    }
}

#[test]
fn the_stable_increment_is_a_close_bound_of_the_exact_one() {
    let run = finish(&square("linear", 1.0, 0.5));
    let dt = run.last().dt;
    // M and K of the whole, K from unit displacements.
    let model = &run.model;
    let n = model.dofs();
    let (mut stiffness, mut mass) = (DMatrix::<f64>::zeros(n, n), vec![0.0; n]);
    for (e, element) in model.mesh.elements.iter().enumerate() {
        let (mut force, mut tangent) = (vec![0.0; 8], vec![0.0; 64]);
        let still = [nalgebra::Vector2::zeros(); 4];
        let material = &*model.bodies[0].material;
        model.solids[e].force_and_tangent(material, &still, &mut force, &mut tangent).expect("an answer");
        let lumped = model.element_lumped_mass(e);
        let dofs: Vec<usize> = element.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]).collect();
        for (i, &row) in dofs.iter().enumerate() {
            mass[row] += lumped[i / 2];
            dofs.iter().enumerate().for_each(|(j, &column)| stiffness[(row, column)] += tangent[i + 8 * j]);
        }
    }
    for spring in &model.steps[0].loads.springs {
        stiffness[(spring.dof, spring.dof)] += spring.stiffness;
    }
    let scaled = DMatrix::from_fn(n, n, |i, j| stiffness[(i, j)] / f64::sqrt(mass[i] * mass[j]));
    let exact = 2.0 / scaled.symmetric_eigenvalues().max().sqrt();
    // Equal increments fill the time to the output: one fewer would have been too long for the bound.
    let count = (0.5 / dt).round();
    assert!(dt <= exact && 0.5 / (count - 1.0) > 0.75 * exact, "{dt} of {exact}");
}

#[test]
fn a_mass_on_a_spring_and_dashpot_converges_with_the_square_of_the_increment() {
    let error = |dt: f64| {
        let case = json!({
            "mesh": {"nodes": [[0, 0]], "points": {"mass": [0]}},
            "point_masses": {"mass": {"mass": 2.0, "velocity": [1.0, 0.0]}},
            "steps": [{
                "name": "swing", "duration": 3.0, "scheme": {"explicit": {}}, "dt": {"initial": dt},
                "supports": [{"on": "mass", "uy": 0}],
                "loads": [{"on": "mass", "spring": {"kx": 8.0}}, {"on": "mass", "dashpot": {"cx": 0.8}}],
            }],
            "output": {"interval": 0.1},
        });
        let run = finish(&case);
        let omega = f64::sqrt(4.0 - 0.04);
        let worst = run.states.iter().map(|state| {
            let t = state.time;
            (state.displacement[0] - f64::exp(-0.2 * t) * f64::sin(omega * t) / omega).abs()
        });
        // What the dashpot takes is what is missing.
        let energy = run.last().energy;
        close("energy", energy.error(), 0.0, 0.2 * dt * dt);
        assert!(energy.damping_dissipation > 0.3);
        worst.fold(0.0, f64::max)
    };
    let [coarse, fine] = [error(0.02), error(0.01)];
    assert!(fine < 2e-4, "{fine}");
    assert!((3.8..4.2).contains(&(coarse / fine)), "{coarse} became {fine}");
}

#[test]
fn a_moving_support_drags_its_body() {
    // A bar whose end moves as a sine far below its frequencies follows as a rigid body: a = −A ω² sin ωt.
    let (amplitude, omega) = (1e-3, 0.5);
    let case = json!({
        "mesh": Blocks::default().rectangle("bar", [10, 1], [0.0, 0.0], [1.0, 0.1]).json(),
        "bodies": {"bar": {"material": {"model": "linear", "E": 100.0, "nu": 0.0, "density": 1.0}}},
        "initial_velocity": {"bar": [amplitude * omega, 0.0]},
        "steps": [{
            "name": "shake", "duration": 2.0 * PI, "scheme": {"explicit": {}},
            "supports": [{"on": "bar", "uy": 0}, {"on": "bar_left", "ux": format!("{amplitude}*sin({omega}*t)")}],
        }],
        "watch": ["bar_left"],
    });
    let run = finish(&case);
    let state = run.states.iter().find(|state| (state.time - PI).abs() < 0.05).expect("half way");
    let expected = -amplitude * omega * omega * f64::sin(omega * state.time) * 0.1;
    close("reaction", run.reaction("bar_left", state)[0], expected, 0.03 * expected.abs());
}

/// A bar of ρ = 1, E = 1, ν = 0.3, c_p = 1.16, that hits a rigid wall at the speed `v`; every other node inside is moved by
/// the share `skew` of an element's size.
fn struck(law: &str, v: f64, safety: f64, unsymmetric: f64) -> Value {
    let mut blocks = Blocks::default().rectangle("bar", [4, 20], [0.0, 0.0], [0.1, 0.5]);
    for (k, node) in blocks.nodes.iter_mut().enumerate() {
        let (i, j) = (k % 5, k / 5);
        if (1..4).contains(&i) && (1..20).contains(&j) && (i + j) % 2 == 1 {
            *node = node.map(|x| x + 0.025 * unsymmetric);
        }
    }
    json!({
        "mesh": blocks.json(),
        "bodies": {"bar": {"material": {"model": law, "E": 1, "nu": 0.3, "density": 1}}},
        "contacts": {"wall": {
            "slave": "bar_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 100}, "friction": {"law": "frictionless"},
        }},
        "initial_velocity": {"bar": [0, -v]},
        "steps": [{"name": "hit", "duration": 1, "scheme": {"explicit": {"safety": safety}}, "dt": {"initial": 1}}],
        "output": {"interval": 0.1},
    })
}

/// An impact at 0.43 c_p compresses elements by two fifths within two increments of the undeformed mesh: increments follow.
/// Half of the bar's energy and more comes back as motion, and its momentum is that of the contact force. Slow impacts
/// take no more increments than ever: the bound of the undeformed mesh, but for a few per cent of strain.
#[test]
fn a_fast_impact_is_followed_by_the_increments() {
    for (safety, allowed) in [(1.0, 0.05), (0.9, 0.05), (0.3, 0.02)] {
        let run = finish(&struck("neo_hookean", 0.5, safety, 0.0));
        assert_eq!(run.report.cutbacks, 0);
        let energy = run.states.iter().map(|state| (state.energy.error() / state.energy.initial).abs());
        let worst = energy.fold(0.0, f64::max);
        assert!(worst < allowed, "safety {safety}: {worst}");
        let flies: f64 = run.last().velocity.iter().skip(1).step_by(2).sum();
        assert!(flies > 0.0, "it has come back");
    }
    let increments = |v: f64| finish(&struck("neo_hookean", v, 0.9, 0.0)).report.increments;
    assert!(increments(0.01) <= increments(1e-6) + 10, "{} of {}", increments(0.01), increments(1e-6));
}

/// Twice as fast the mesh collapses all the same: from the last row the increments are made shorter, and the run goes on. A
/// law that gives way when crushed ends the run with what, where and why.
#[test]
fn a_collapse_is_repeated_more_carefully_and_told_if_that_does_not_help() {
    let run_of = |case: &Value| {
        let mut record = Record::default();
        let (report, result) = run(&Arc::new(model(case)), &mut [&mut record]);
        (report, result.map(drop).map_err(|error| error.to_string()), record)
    };
    let (report, result, record) = run_of(&struck("neo_hookean", 1.0, 1.0, 0.3));
    assert_eq!(result, Ok(()));
    assert!(report.cutbacks > 0 && record.failed == report.cutbacks && record.states.len() == 10, "{report:?}");
    let (report, result, record) = run_of(&struck("saint_venant_kirchhoff", 0.5, 0.9, 0.0));
    let text = result.expect_err("it is crushed");
    assert!(report.cutbacks == 4 && record.states.len() < 10, "{report:?}");
    for part in [
        "step `hit` stopped at time 0.0",
        "element 0 of body `bar`",
        "with shorter increments as well: the mesh collapses there",
        "damping.stiffness",
    ] {
        assert!(text.contains(part), "`{part}` is not in: {text}");
    }
    // A support that drives a block flat leaves nothing to hope for, and is told before increments shrink for ever.
    let mut flat = struck("neo_hookean", 0.0, 0.9, 0.0);
    flat["mesh"] = Blocks::default().rectangle("bar", [1, 4], [0.0, 0.0], [0.1, 0.5]).json();
    flat["steps"][0]["supports"] = json!([
        {"on": "bar", "ux": 0}, {"on": "bar_bottom", "uy": 0}, {"on": "bar_top", "uy": {"rate": -0.6}}
    ]);
    let text = run_of(&flat).1.expect_err("it is crushed");
    assert!(text.contains("the mesh collapses there"), "{text}");
}

#[test]
fn what_explicit_steps_cannot_do_is_refused() {
    let refused = |case: &Value, words: &str| {
        let error = refusal(case);
        assert!(error.contains(words), "{error}");
    };
    let good = bars(json!({"explicit": {}}), 2);
    model(&good);
    for (pointer, key, value, words) in [
        ("/contacts/ends/normal", "penetration", json!(1e-9), "takes the plain penalty"),
        ("/steps/0/dt", "error", json!(1e-6), "leave error out"),
        ("/steps/0", "scheme", json!({"explicit": {"safety": 1.5}}), "at most 1"),
        ("/output", "interval", json!(0.0), "output.interval"),
        ("/bodies/left/material", "density", json!(0.0), "give a density"),
    ] {
        let mut bad = good.clone();
        bad.pointer_mut(pointer).expect("an object")[key] = value;
        refused(&bad, words);
    }
}

#[test]
fn an_absorbing_side_swallows_a_bar_s_motion() {
    // A bar in flight along its axis, at any angle: half its velocity is taken at once, a wave takes the news to the free end
    // and brings back rest, which the side does not reflect: all is still after 2 L/c.
    for scheme in [json!({"explicit": {}}), json!({"newmark": {}})] {
        let angle = 0.5f64;
        let case = json!({
            "mesh": Blocks::default().rectangle("bar", [100, 4], [0.0, 0.0], [1.0, 0.1]).turned(angle).json(),
            "bodies": {"bar": {"material": {"model": "linear", "E": 4.0, "nu": 0.0, "density": 1.0}}},
            "initial_velocity": {"bar": [1e-3 * angle.cos(), 1e-3 * angle.sin()]},
            "steps": [{
                "name": "fly", "duration": 1.2, "scheme": scheme, "dt": {"initial": 0.002},
                "loads": [{"on": "bar_right", "absorbing": true}],
            }],
        });
        let run = finish(&case);
        let half = &run.states.iter().find(|state| (state.time - 0.48).abs() < 1e-3).expect("before the return").energy;
        // The stress ρ c v/2 works on the way of the end: half the energy is gone at L/c = 0.5.
        close("taken at L/c", half.damping_dissipation, 0.48 * half.initial, 0.03 * half.initial);
        let end = &run.last().energy;
        let left = end.kinetic + end.strain;
        assert!(left < 0.01 * end.initial, "{scheme}: {left} of {}", end.initial);
        close("energy", end.error(), 0.0, 0.005 * end.initial);
    }
}
