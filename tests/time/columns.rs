//! Two half-columns in shear, joined by friction: the interface slips at τ = τ₀ − V/2, because the ends absorb the waves.

use crate::common::{Blocks, Finished, close, finish};
use fecontact::model::state::State;
use serde_json::{Value, json};

/// Stresses and displacements are small beside G = 1 and the column: the units of both, in the column's. With 1e-6 the slave slides off a
/// master of one edge by 2e-4 of it, which changes the slip by 0.5 %.
const SMALL: f64 = 1e-7;

/// ρ = 1, c_s = 1, columns of height 0.25 above and below y = 0; p = 10 and, from the start, the shear stress τ₀ = 6.1. The
/// initial traction is balanced by an initial stress; what is missing to τ₀ is a load on both sides of the interface.
fn columns(friction: Value, traction: f64, scheme: Value, dt: f64, duration: f64) -> Value {
    let (h, n) = (0.005, 50);
    let blocks = Blocks::default().rectangle("lower", [1, n], [0.0, -0.25], [h, 0.0]).rectangle(
        "upper",
        [1, n],
        [0.0, 0.0],
        [h, 0.25],
    );
    let material = json!({"material": {"model": "linear", "E": 2.5, "nu": 0.25, "density": 1.0}});
    let missing = |sign: f64| json!({"traction": {"x": format!("{}", sign * (6.1 - traction) * SMALL)}});
    let load = |on: &str, mut load: Value| {
        load["on"] = json!(on);
        load
    };
    let absorbing = |on: &str| load(on, json!({"absorbing": true}));
    json!({
        "mesh": blocks.json(),
        "bodies": {"lower": material, "upper": material},
        "contacts": {"fault": {
            "slave": "upper_bottom", "master": "lower_top", "normal": {"alpha_n": 1000.0}, "friction": friction,
            "initial": {"pressure": 10.0 * SMALL, "traction": traction * SMALL, "balanced": true},
        }},
        "steps": [{
            "name": "slip", "duration": duration, "scheme": scheme, "dt": {"initial": dt},
            "supports": [{"on": "lower", "uy": 0}, {"on": "upper", "uy": 0}],
            "loads": [
                absorbing("lower_bottom"), absorbing("upper_top"),
                load("upper_bottom", missing(1.0)), load("lower_top", missing(-1.0)),
            ],
        }],
        "output": {"interval": 0.01},
    })
}

fn explicit() -> Value {
    json!({"explicit": {}})
}

fn newmark() -> Value {
    json!({"newmark": {}})
}

/// Slip D in units of D_c.
fn slip(state: &State) -> f64 {
    state.contacts[0][0].friction.plastic_slip / SMALL
}

/// Time at which the slip reaches a value, by linear interpolation.
fn time_of(run: &Finished, value: f64) -> f64 {
    let after = run.states.iter().position(|state| slip(state) >= value).expect("it is reached");
    let [a, b] = [&run.states[after - 1], &run.states[after]];
    a.time + (b.time - a.time) * (value - slip(a)) / (slip(b) - slip(a))
}

fn slip_weakening() -> Value {
    json!({"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.5, "D_c": SMALL, "alpha_t": 1000.0})
}

/// D = 0.1 (e²ᵗ − 1) until D = 1 at t = ln(11)/2, from strength 6 − D = 6.1 − V/2; then V = 2 (6.1 − 5).
fn check_weakening(run: &Finished) {
    for t in [0.2, 0.4, 0.6, 0.8, 1.0, 1.1] {
        let expected = 0.1 * (f64::exp(2.0 * t) - 1.0);
        close(&format!("D({t})"), slip(run.at(t)), expected, 0.005 * expected);
    }
    close("time of D = 1", time_of(run, 1.0), 1.198948, 0.005 * 1.198948);
    let [a, b] = [run.at(1.3), run.at(1.4)];
    close("final slip rate", (slip(b) - slip(a)) / 0.1, 2.2, 0.005 * 2.2);
    for state in &run.states {
        let energy = &state.energy;
        let work = energy.external_work.abs().max(energy.friction_dissipation);
        close("energy error", energy.error(), 0.0, 0.01 * work + 1e-3 * energy.initial);
    }
}

#[test]
fn a_weakening_interface_slips_as_the_closed_form_says() {
    check_weakening(&finish(&columns(slip_weakening(), 6.1, newmark(), 0.002, 1.4)));
}

/// Slip of the interface by the rate equations of the super/subloading law and V = 2 (6.1 − q), at multiples of 0.1 in
/// time; Runge–Kutta.
fn rate_equations(kappa: f64, r: f64, xi: f64, q0: f64) -> Vec<f64> {
    let (alpha_t, p, mu_s, mu_k) = (1000.0, 10.0, 0.6, 0.5);
    // y: q, μ, plastic slip
    let rate = |[q, mu, _]: [f64; 3]| {
        let ratio = q / (mu * p);
        let v = 2.0 * (6.1 - q);
        let recovery = xi * (1.0 - mu / mu_s);
        let loss = kappa * (mu / mu_k - 1.0);
        let den = alpha_t - r * ratio.ln() * mu * p - loss * ratio * p;
        let slip = ((alpha_t * v - ratio * recovery * p) / den).max(0.0);
        [alpha_t * (v - slip), -loss * slip + recovery, slip]
    };
    let (mut y, h, mut slips) = ([q0, mu_s, 0.0], 1e-5, vec![0.0]);
    let step = |y: [f64; 3], k: [f64; 3], s: f64| [y[0] + s * k[0], y[1] + s * k[1], y[2] + s * k[2]];
    for k in 1..=140_000 {
        let k1 = rate(y);
        let k2 = rate(step(y, k1, 0.5 * h));
        let k3 = rate(step(y, k2, 0.5 * h));
        let k4 = rate(step(y, k3, h));
        for i in 0..3 {
            y[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
        if k % 10_000 == 0 {
            slips.push(y[2]);
        }
    }
    slips
}

fn super_subloading() -> Value {
    json!({
        "law": "super_subloading", "mu_s": 0.6, "mu_k": 0.5, "alpha_t": 1000.0,
        "r": 100.0 / SMALL, "kappa": 1.0 / SMALL, "xi": 0.02,
    })
}

fn check_super_subloading(run: &Finished) {
    let slips = rate_equations(1.0, 100.0, 0.02, 5.5);
    assert!(slips[14] > 1.5, "the interface has weakened: {slips:?}");
    for (k, expected) in slips.iter().enumerate().skip(2) {
        let t = 0.1 * k as f64;
        close(&format!("D({t})"), slip(run.at(t)), *expected, 0.005 * expected);
    }
}

#[test]
fn a_super_subloading_interface_slips_as_its_rate_equations_say() {
    check_super_subloading(&finish(&columns(super_subloading(), 5.5, newmark(), 0.002, 1.4)));
}

#[test]
fn explicit_increments_say_the_same_of_both_laws() {
    check_weakening(&finish(&columns(slip_weakening(), 6.1, explicit(), 0.002, 1.4)));
    check_super_subloading(&finish(&columns(super_subloading(), 5.5, explicit(), 0.002, 1.4)));
}
