//! Laws under constant normal stiffness and constant volume.

use super::*;

/// An interface that dilates with its structure, and heals as it slides.
fn dilating(normal: &Value) -> Value {
    json!({"friction": {"law": "super_subloading", "mu_s": 0.7, "mu_k": 0.5, "alpha_t": 1000, "r": 10, "kappa": 0.25, "xi": 0.002},
           "dilatancy": {"structure": 0.4}, "normal": normal, "initial": {"pressure": 100, "traction": 20},
           "path": [{"duration": 60, "slip": {"rate": 0.1}, "dt": 0.1}]})
}

/// q, μ, p and the opening d of the rate equations at the end, by classical Runge–Kutta steps:
///
/// ```text
/// ṗ = K ḋ,   ḋ = d_S (μ/μ_k − 1) λ̇,   μ̇ = ξ (1 − μ/μ_s) − κ (μ/μ_k − 1) λ̇,   q̇ = α_t (v − λ̇)
/// q = R μ p:   λ̇ = (α_t v − R p ξ (1 − μ/μ_s))/(α_t − r ln R μ p − R p κ (μ/μ_k − 1) + R μ K d_S (μ/μ_k − 1))
/// ```
fn sheared_against(stiffness: f64) -> [f64; 4] {
    let [mu_s, mu_k, alpha_t, r, kappa, xi, v, d] = [0.7, 0.5, 1000.0, 10.0, 0.25, 0.002, 0.1, 0.4];
    let rates = |[q, mu, p, _]: [f64; 4]| -> [f64; 4] {
        let (ratio, recovery, excess): (f64, f64, f64) = (q / (mu * p), xi * (1.0 - mu / mu_s), mu / mu_k - 1.0);
        let resists =
            alpha_t - r * ratio.ln() * mu * p - ratio * p * kappa * excess + ratio * mu * stiffness * d * excess;
        let slip = (alpha_t * v - ratio * p * recovery) / resists;
        [alpha_t * (v - slip), recovery - kappa * excess * slip, stiffness * d * excess * slip, d * excess * slip]
    };
    const STEPS: u32 = 300_000;
    let (mut state, dt) = ([20.0, mu_s, 100.0, 0.0], 60.0 / f64::from(STEPS));
    for _ in 0..STEPS {
        let moved = |by: [f64; 4], share: f64| [0, 1, 2, 3].map(|i| state[i] + share * dt * by[i]);
        let a = rates(state);
        let b = rates(moved(a, 0.5));
        let c = rates(moved(b, 0.5));
        let e = rates(moved(c, 1.0));
        state = [0, 1, 2, 3].map(|i| state[i] + dt / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + e[i]));
    }
    state
}

/// Constant normal load, constant normal stiffness and constant volume are those of the rate equations with K = 0, K_n in series
/// with α_n, and α_n.
#[test]
fn an_interface_opens_against_the_stiffness_around_it() {
    for (normal, stiffness) in [
        (json!({}), 0.0),
        (json!({"stiffness": 160}), 160.0),
        (json!({"stiffness": 160, "alpha_n": 1000}), 160.0 / 1.16),
        (json!({"constant_volume": true, "alpha_n": 1000}), 1000.0),
    ] {
        let [traction, mu, pressure, opening] = sheared_against(stiffness);
        let done = Done::of(&dilating(&normal));
        for (name, value) in [("traction", traction), ("mu", mu), ("pressure", pressure), ("dilation", opening)] {
            close(&format!("{name} of {normal}"), done.last(name), value, 2e-5 * value);
        }
        let compliance = if stiffness == 160.0 || stiffness == 0.0 { 0.0 } else { 1e-3 };
        for row in 0..done.column("gap").len() {
            let gap = done.column("dilation")[row] - compliance * (done.column("pressure")[row] - 100.0);
            close(&format!("gap of {normal}"), done.column("gap")[row], gap, 1e-14);
            let holds = normal["constant_volume"] != true || gap.abs() < 1e-13;
            assert!(holds, "{gap} at constant volume");
        }
    }
}

/// As K_n goes to zero the pressure stays, by as much less as K_n is; as it grows beyond α_n the gap closes, likewise.
#[test]
fn constant_stiffness_tends_to_constant_load_and_to_constant_volume() {
    let of = |normal: Value| Done::of(&dilating(&normal));
    let load = of(json!({"alpha_n": 1000}));
    let raised =
        [1e-2, 1e-4].map(|k| of(json!({"stiffness": k, "alpha_n": 1000})).last("pressure") - load.last("pressure"));
    assert!(raised[1] > 0.0 && (raised[0] / raised[1] - 100.0).abs() < 0.1, "{raised:?}");
    let volume = of(json!({"constant_volume": true, "alpha_n": 1000}));
    let short = [1e6, 1e8].map(|k| {
        let stiff = of(json!({"stiffness": k, "alpha_n": 1000}));
        [volume.last("traction") - stiff.last("traction"), stiff.last("gap")]
    });
    for k in 0..2 {
        let [far, near] = [short[0][k], short[1][k]];
        assert!(near > 0.0 && (far / near - 100.0).abs() < 0.5, "{short:?}");
    }
}

/// Coulomb sliding at constant volume, where hardly any slip is plastic: q = α_t (u − λ) = μ p and p = p₀ + α_n tan ψ λ, so
/// λ = (α_t u − μ p₀)/(α_t + μ α_n tan ψ). One unit in the last place of p is many of the opening's.
#[test]
fn a_stiff_interface_dilates_at_constant_volume() {
    let [mu, alpha_t, psi, start, way] = [0.6, 1000.0, 0.4, 100.0, 0.5];
    for alpha_n in [1e5, 1e6, 1e7, 1e9] {
        let done = Done::of(&json!({
            "friction": {"law": "coulomb", "mu": mu, "alpha_t": alpha_t},
            "dilatancy": {"rate": psi}, "normal": {"constant_volume": true, "alpha_n": alpha_n},
            "initial": {"pressure": start}, "path": [{"duration": 1, "slip": {"rate": way}}]
        }));
        let plastic = (alpha_t * way - mu * start) / (alpha_t + mu * alpha_n * psi);
        let pressure = start + alpha_n * psi * plastic;
        close("pressure", done.last("pressure"), pressure, 1e-9 * pressure);
        close("traction", done.last("traction"), mu * pressure, 1e-9 * pressure);
        // What is split off from the slip is as exact as that.
        close("dilation", done.last("dilation"), psi * plastic, 1e-9 * psi * plastic + 1e-14 * way);
    }
}

/// A spring behind an interface lets go of nothing but what it holds: the load falls away, and the surfaces part where the spring has
/// no force left, p_a + K d ≤ 0.
#[test]
fn a_dilated_interface_parts_below_no_load() {
    let mut test = dilating(&json!({"stiffness": 160}));
    test["path"].as_array_mut().expect("phases").push(json!({"duration": 10, "pressure": -60}));
    let done = Done::of(&test);
    let opening = done.last("dilation");
    assert!(opening * 160.0 < 60.0 && done.last("pressure") <= 0.0 && done.last("traction") == 0.0, "{opening}");
    let row = done.column("pressure").iter().rposition(|pressure| *pressure > 0.0).expect("it was pressed");
    let applied = 100.0 - 16.0 * (done.column("time")[row] - 60.0);
    close("pressure", done.column("pressure")[row], applied + 160.0 * opening, 1e-9);
}

/// What has no meaning is refused by its key.
#[test]
fn bad_normal_conditions_are_named() {
    let refused_with = |normal: Value, fragments: &[&str]| refused(&dilating(&normal), fragments);
    refused_with(json!({"stiffness": -1}), &["normal.stiffness: ", "-1"]);
    refused_with(json!({"alpha_n": 0}), &["normal.alpha_n: "]);
    refused_with(json!({"constant_volume": true}), &["normal.alpha_n: is missing"]);
    refused_with(
        json!({"constant_volume": true, "alpha_n": 1, "stiffness": 1}),
        &["normal.stiffness: ", "leave one of them out"],
    );
    let mut loaded = dilating(&json!({"constant_volume": true, "alpha_n": 1}));
    loaded["path"][0]["pressure"] = json!(120);
    refused(&loaded, &["pressure: is 100", "at constant volume it cannot be applied"]);
    let mut steep = dilating(&json!({}));
    steep["dilatancy"] = json!({"structure": 2});
    refused(&steep, &["dilatancy.structure: is 2", "must be below 0.7"]);
}
