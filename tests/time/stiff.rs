//! Quasi-dynamic steps of laws without a slip rate that follows from traction and state: implicit, against differential equations.

use crate::common::{Finished, close, finish, refusal};
use serde_json::{Value, json};

const DAMPING: f64 = 10.0;

/// The spring-slider of the paper's case 3, with radiation damping in place of inertia.
fn slider(law: &Value, scheme: &Value, duration: f64) -> Value {
    json!({
        "mesh": {"nodes": [[0, 0]], "points": {"block": [0]}},
        "point_masses": {"block": {"mass": 10}},
        "contacts": {"base": {
            "slave": "block", "area": 1, "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 1000}, "radiation_damping": DAMPING, "sliding": "small", "friction": law,
            "initial": {"pressure": 98.1, "traction": if law["law"] == "frictionless" { 0.0 } else { 1e-6 }},
        }},
        "steps": [{"name": "pull", "duration": duration, "scheme": scheme, "dt": {"initial": 0.01}, "loads": [
            {"on": "block", "force": {"y": "-98.1"}},
            {"on": "block", "spring": {"kx": 10, "driver": {"x": {"rate": 0.001}}}},
        ]}],
    })
}

fn paper() -> Value {
    json!({"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 1000, "r": 100, "kappa": 10, "xi": 0.002})
}

fn quasi_dynamic(tolerance: f64) -> Value {
    json!({"quasi_dynamic": {"tolerance": tolerance, "every": 1}})
}

/// Times at which the slip rate rises and falls through 0.02, its logarithm linear between rows, and the slip in between.
fn events(run: &Finished) -> Vec<[f64; 3]> {
    let mut events: Vec<[f64; 3]> = Vec::new();
    let mut before = [0.0; 3];
    for state in &run.states {
        let point = &state.contacts[0][0];
        let now = [state.time, state.displacement[0], point.radiation / DAMPING];
        let share = f64::ln(0.02 / before[2]) / f64::ln(now[2] / before[2]);
        let at = [0, 1].map(|i| before[i] + share * (now[i] - before[i]));
        if before[2] < 0.02 && now[2] >= 0.02 {
            events.push([at[0], f64::NAN, -at[1]]);
        }
        if before[2] >= 0.02 && now[2] < 0.02 {
            let last = events.last_mut().expect("an event that began");
            (last[1], last[2]) = (at[0] - last[0], last[2] + at[1]);
        }
        before = now;
    }
    events
}

/// Onsets, durations and slips of three cycles, against Radau, BDF and LSODA at 1e-10 of u̇ = V, q̇ = α_t (V − λ sgn q) and (3) of the
/// law with V = (K (v t − u) − q)/η, which agree to 2e-5: 3093.4927, 4189.1328, 5284.7730; 4.02623; 1.064539.
#[test]
fn a_spring_slider_sticks_and_slips_by_its_differential_equation() {
    let mut errors = Vec::new();
    for tolerance in [1e-5, 1e-6, 1e-8] {
        let run = finish(&slider(&paper(), &quasi_dynamic(tolerance), 5400.0));
        let events = events(&run);
        println!("{tolerance:e}: {} steps, {events:?}", run.report.increments);
        assert_eq!(events.len(), 3);
        let off = |(event, onset): (&[f64; 3], f64)| (event[0] / onset - 1.0).abs();
        let onsets = [3_093.492_7, 4_189.132_8, 5_284.773_0];
        errors.push(events.iter().zip(onsets).map(off).fold(0.0, f64::max));
        let last = run.last();
        let contact = &last.contacts[0][0];
        let pulled = 10.0 * (0.001 * last.time - last.displacement[0]);
        close("spring", pulled, contact.friction.traction + contact.radiation, 1e-8);
        close("energy", last.energy.error(), 0.0, 1e-3 * last.energy.friction_dissipation);
    }
    assert!(errors[0] < 5e-4 && errors[1] < 1e-4 && errors[2] < 1e-6, "{errors:?}");
    // Rows as close as the duration and the slip of an event are read from.
    let mut case = slider(&paper(), &quasi_dynamic(1e-6), 3110.0);
    case["steps"][0]["dt"]["max"] = json!(0.05);
    for [_, duration, slip] in events(&finish(&case)) {
        close("duration", duration / 4.026_23, 1.0, 1e-3);
        close("slip", slip / 1.064_539, 1.0, 1e-3);
    }
}

/// Without friction the slider follows its damper, u = v (t − T (1 − e^(−t/T))) with T = η/K.
#[test]
fn without_friction_it_creeps_behind_the_spring() {
    let run = finish(&slider(&json!({"law": "frictionless"}), &quasi_dynamic(1e-6), 5.0));
    let exact = |t: f64| 0.001 * (t - (1.0 - (-t).exp()));
    for state in &run.states {
        // 1e-6 of the pressure is a force of 1e-4, and that of the spring 1e-5 of displacement.
        close("u", state.displacement[0], exact(state.time), 1e-5);
    }
}

/// A sticking Coulomb slider gives way when the spring has reached μ p, and follows it from there: closed form.
#[test]
fn a_coulomb_slider_gives_way() {
    let law = json!({"law": "coulomb", "mu": 0.2, "alpha_t": 1e4});
    let run = finish(&slider(&law, &quasi_dynamic(1e-6), 3000.0));
    // The contact spring has then given way by μ p/α_t.
    let yields = (0.2 * 98.1 / 10.0 + 0.2 * 98.1 / 1e4) / 0.001;
    for state in run.states.iter().filter(|state| state.time > yields) {
        let since = state.time - yields;
        let slip = 0.001 * (since - (1.0 - (-since).exp()));
        close("u", state.displacement[0], slip + 0.2 * 98.1 / 1e4, 2e-5);
    }
}

/// With a direct effect of the rate sliding under a slow spring is steady where that strengthens, and the traction is the law's.
#[test]
fn a_direct_effect_makes_sliding_steady() {
    let law = json!({"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 1000, "r": 100, "kappa": 0, "xi": 0, "a": 0.02, "V_0": 1e-5});
    let run = finish(&slider(&law, &quasi_dynamic(1e-6), 6000.0));
    let last = &run.last().contacts[0][0];
    close("rate", last.radiation / DAMPING, 1e-3, 1e-7);
    close("traction", last.friction.traction / 98.1, 0.4 * (1.0 + 0.02 * f64::ln(101.0)), 1e-5);
}

/// What implicit steps do not have is refused with its place.
#[test]
fn what_implicit_steps_do_not_have_is_refused() {
    let mut case = slider(&json!({"law": "coulomb", "mu": 0.2, "alpha_t": 1e4}), &quasi_dynamic(1e-5), 1.0);
    case["contacts"]["base"]["stick"] = json!(1e-6);
    let message = refusal(&case);
    assert!(message.contains("contacts.base.stick") && message.contains("raise alpha_t"), "{message}");
    let mut case = slider(&paper(), &quasi_dynamic(1e-5), 1.0);
    case["contacts"]["base"]["bond"] = json!({"strength": 5});
    let message = refusal(&case);
    assert!(message.contains("contacts.base.bond") && message.contains("slip rate"), "{message}");
}
