//! Stability of steady sliding: a mass on a frictional plane, pulled by a spring, against the linear theory.
//!
//! Near steady sliding at V (R = 1, q = μ p) the deviations x of the position, w of the velocity and y of μ obey, with
//! a = κ p S (μ_ss/μ_k − 1), a' = a/(α_t S) and b = κ V/μ_k + ξ/μ_s (m = n = 1),
//! ```text
//! ẋ = w,   M ẇ = −K x − c w − p S y,   (1 − a') ẏ = −κ (μ_ss/μ_k − 1) w − b y
//! ```
//! whose characteristic polynomial is M(1 − a')s³ + (M b + c(1 − a'))s² + (K(1 − a') − a + c b)s + K b.

use crate::common::{Record, close, finish, model};
use fecontact::model::state::State;
use fecontact::run::run;
use nalgebra::{Matrix3, Vector3};
use serde_json::{Value, json};
use std::sync::Arc;

const MU_S: f64 = 0.4;
const MU_K: f64 = 0.2;
const KAPPA: f64 = 10.0;
const XI: f64 = 0.002;
const ALPHA_T: f64 = 1000.0;
const PRESSURE: f64 = 98.1;
/// V: slow enough for μ_ss = 0.3, half-way between μ_k and μ_s [L/T]
const V: f64 = 1e-4;
const MASS: f64 = 10.0;

fn steady_mu() -> f64 {
    (KAPPA * V + XI) / (KAPPA * V / MU_K + XI / MU_S)
}

/// a: steepest weakening at steady sliding [F/L]
fn weakening() -> f64 {
    KAPPA * PRESSURE * (steady_mu() / MU_K - 1.0)
}

/// b: rate at which μ returns to its steady value at constant V [1/T]
fn rate() -> f64 {
    KAPPA * V / MU_K + XI / MU_S
}

/// Steady sliding at V under a spring of stiffness `k` and a damper `c`, with μ off by the factor 1 + `off`.
fn slider(scheme: Value, [k, c]: [f64; 2], off: f64, dt: f64, steps: usize) -> Value {
    let mu = steady_mu() * (1.0 + off);
    let start = (mu * PRESSURE + c * V) / k;
    json!({
        "mesh": {"nodes": [[0, 0]], "points": {"block": [0]}},
        "bodies": {},
        "point_masses": {"block": {"mass": MASS, "velocity": [V, 0]}},
        "contacts": {"base": {
            "slave": "block", "area": 1, "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 1e3},
            "initial": {"pressure": PRESSURE, "traction": mu * PRESSURE, "structure": mu / MU_K},
            "friction": {"law": "super_subloading", "mu_s": MU_S, "mu_k": MU_K, "alpha_t": ALPHA_T, "r": 100,
                         "kappa": KAPPA, "xi": XI, "m": 1, "n": 1},
        }},
        "steps": [{
            "name": "slide", "duration": dt * steps as f64, "dt": {"initial": dt}, "scheme": scheme,
            "loads": [
                {"on": "block", "force": {"y": format!("-{PRESSURE}")}},
                {"on": "block", "spring": {"kx": k, "driver": {"x": format!("{start:?} + {V:?}*t")}}},
                {"on": "block", "dashpot": {"cx": c}},
            ],
        }],
        "newton": {"tolerance": 1e-12},
    })
}

/// Without inertia, K' being the spring in series with the contact: for K' > a a small deviation goes like exp(s t),
/// s = −b/(1 − a/K'); for K' < a steady sliding is lost at once, for there
/// the equations have other answers, or none.
#[test]
fn the_critical_stiffness_parts_stable_from_unstable_sliding() {
    let (a, b) = (weakening(), rate());
    for in_series in [2.0 * a, 1.5 * a, 1.2 * a] {
        let k = in_series / (1.0 - in_series / ALPHA_T);
        let growth = -b / (1.0 - a / in_series);
        let time = 1.0 / growth.abs();
        let run = finish(&slider(json!("static"), [k, 0.0], 1e-5, time / 200.0, 200));
        let measured = (deviation(run.last()) / 1e-5).ln() / time;
        close(&format!("growth at K'/a = {}", in_series / a), measured, growth, 5e-3 * growth.abs());
    }
    for in_series in [0.8 * a, 0.5 * a] {
        let k = in_series / (1.0 - in_series / ALPHA_T);
        let model = model(&slider(json!("static"), [k, 0.0], 1e-5, 0.1 / b, 20));
        let mut record = Record::default();
        let model = Arc::new(model);
        let stopped = run(&model, &mut [&mut record]).1.is_err();
        let left = record.states.iter().any(|state| deviation(state).abs() > 1e-3);
        assert!(stopped || left, "steady sliding goes on at K'/a = {}", in_series / a);
    }
}

/// μ/μ_ss − 1.
fn deviation(state: &State) -> f64 {
    state.contacts[0][0].friction.mu / steady_mu() - 1.0
}

/// The linear equations of motion above: d(x, w, y)/dt = A (x, w, y).
fn motion(k: f64, c: f64) -> Matrix3<f64> {
    let loss = weakening() / PRESSURE;
    let rigid = 1.0 - weakening() / ALPHA_T;
    Matrix3::new(
        0.0,
        1.0,
        0.0, //
        -k / MASS,
        -c / MASS,
        -PRESSURE / MASS, //
        0.0,
        -loss / rigid,
        -rate() / rigid,
    )
}

/// M(1 − a')s³ + (M b + c(1 − a'))s² + (K(1 − a') − a + c b)s + K b at s = λ of A is 0: the page's cubic.
#[test]
fn the_cubic_of_the_damped_slider_is_the_characteristic_polynomial() {
    let (k, c) = (1500.0, 20.0);
    let (a, b, rigid) = (weakening(), rate(), 1.0 - weakening() / ALPHA_T);
    let cubic = [MASS * rigid, MASS * b + c * rigid, k * rigid - a + c * b, k * b];
    let matrix = motion(k, c);
    let trace = matrix.trace();
    let minors = 0.5 * (trace * trace - (matrix * matrix).trace());
    for (what, ours, theirs) in [
        ("s²", -trace, cubic[1] / cubic[0]),
        ("s", minors, cubic[2] / cubic[0]),
        ("1", -matrix.determinant(), cubic[3] / cubic[0]),
    ] {
        close(what, ours, theirs, 1e-9 * (1.0 + theirs.abs()));
    }
}

/// The damped slider follows the linear motion, on either side of stability.
#[test]
fn small_motions_about_steady_sliding_follow_the_linear_theory() {
    for (k, c) in [(1500.0, 0.0), (1500.0, 20.0), (2500.0, 3.0), (600.0, 1e3)] {
        let matrix = motion(k, c);
        let fastest = matrix.complex_eigenvalues().iter().fold(0.0, |most: f64, root| most.max(root.norm()));
        let (dt, steps) = (0.01 / fastest, 2500);
        let off = 1e-5;
        let run = finish(&slider(json!({"newmark": {}}), [k, c], off, dt, steps));
        let time = dt * steps as f64;
        // The spring is as long as the perturbed friction asks: that much ahead of the steady motion's.
        let shift = off * steady_mu() * PRESSURE / k;
        let end = (matrix * time).exp() * Vector3::new(-shift, 0.0, off * steady_mu());
        let state = run.last();
        let found = Vector3::new(
            state.displacement[0] - V * time - shift,
            state.velocity[0] - V,
            state.contacts[0][0].friction.mu - steady_mu(),
        );
        let scale = end[0].abs().max(end[1].abs() / fastest);
        close("position", found[0], end[0], 0.02 * scale);
        close("velocity", found[1], end[1], 0.02 * scale * fastest);
        close("mu", found[2], end[2], 0.02 * end[2].abs());
    }
}
