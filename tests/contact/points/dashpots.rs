//! Dashpots and springs at points.

use super::*;

/// M ü + C u̇ + K u = 0 with u̇(0) = v. The trapezoidal rule is the map (1 − Δt A/2)⁻¹ (1 + Δt A/2) of (u, u̇) and tends to
/// the closed form u = v/ω_d exp(−C t/2M) sin ω_d t with the square of Δt. Dissipation is what the oscillator has lost.
#[test]
fn a_damped_oscillator_follows_its_closed_form_and_keeps_account_of_its_energy() {
    let v = 0.7;
    let decay = C / (2.0 * M);
    let omega = (K / M - decay * decay).sqrt();
    let errors = [0.1, 0.05, 0.025].map(|dt| {
        let run = lone_mass([v, 0.0], trapezoidal(), [dt, 5.0], spring_and_dashpot());
        let half = Matrix2::new(0.0, 1.0, -K / M, -C / M) * (0.5 * dt);
        let map = (Matrix2::identity() - half).try_inverse().unwrap() * (Matrix2::identity() + half);
        let mut expected = Vector2::new(0.0, v);
        let start = 0.5 * M * v * v;
        for state in &run.states {
            expected = map * expected;
            close("u", state.displacement[0], expected[0], 1e-12);
            close("v", state.velocity[0], expected[1], 1e-12);
            let stored = 0.5 * K * expected[0].powi(2);
            let energy = &state.energy;
            close("kinetic energy", energy.kinetic, 0.5 * M * expected[1].powi(2), 1e-12);
            close("work of the spring", energy.external_work, -stored, 1e-11);
            close("dissipation", energy.damping_dissipation, start - energy.kinetic - stored, 1e-11);
            close("energy error", energy.error(), 0.0, 1e-11);
            close("uy", state.displacement[1], 0.0, 1e-15);
        }
        let time = run.last().time;
        (run.last().displacement[0] - v / omega * (-decay * time).exp() * (omega * time).sin()).abs()
    });
    let ratios = [errors[0] / errors[1], errors[1] / errors[2]];
    println!("errors {errors:?}, ratios {ratios:?}");
    assert!(ratios.iter().all(|ratio| (3.7..4.3).contains(ratio)), "second order: {ratios:?}");
}

/// Every scheme sees the dashpot where it sees the spring: second order against the closed form.
#[test]
fn every_scheme_is_of_second_order_with_a_dashpot() {
    let (v, decay) = (0.7, C / (2.0 * M));
    let omega = (K / M - decay * decay).sqrt();
    let exact = v / omega * (-decay * 5.0).exp() * (omega * 5.0).sin();
    for scheme in
        [json!({"hht": {"alpha": -0.3}}), json!({"generalized_alpha": {"rho_infinity": 0.3}}), json!({"wilson": {}})]
    {
        let errors = [0.05, 0.025, 0.0125].map(|dt| {
            let run = lone_mass([v, 0.0], scheme.clone(), [dt, 5.0], spring_and_dashpot());
            assert!(run.report.newton_iterations <= run.states.len(), "the tangent of a linear problem is exact");
            (run.last().displacement[0] - exact).abs()
        });
        let ratios = [errors[0] / errors[1], errors[1] / errors[2]];
        println!("{scheme}: errors {errors:?}, ratios {ratios:?}");
        assert!(ratios.iter().all(|ratio| (3.6..4.4).contains(ratio)), "{scheme}: {ratios:?}");
    }
}

/// HHT weighs the dashpot like the spring (Hilber, Hughes & Taylor 1977), here solved for a₁ by hand:
///
/// ```text
/// M a₁ + (1 + α)(C v₁ + K u₁) − α (C v₀ + K u₀) = 0
/// ```
#[test]
fn a_dashpot_is_weighted_like_any_force() {
    let (alpha, dt, v0) = (-0.3, 0.2, 0.7);
    let (beta, gamma) = (0.25 * (1.0 - alpha) * (1.0 - alpha), 0.5 - alpha);
    let run = lone_mass([v0, 0.0], json!({"hht": {"alpha": alpha}}), [dt, 10.0], spring_and_dashpot());
    let (mut u, mut v, mut a) = (0.0, v0, -C * v0 / M);
    for state in &run.states {
        let (predicted_u, predicted_v) = (u + dt * v + (0.5 - beta) * dt * dt * a, v + (1.0 - gamma) * dt * a);
        let old = alpha * (C * v + K * u);
        let new = (1.0 + alpha) * (C * predicted_v + K * predicted_u);
        a = (old - new) / (M + (1.0 + alpha) * (C * gamma * dt + K * beta * dt * dt));
        (u, v) = (predicted_u + beta * dt * dt * a, predicted_v + gamma * dt * a);
        close("u", state.displacement[0], u, 1e-12);
        close("v", state.velocity[0], v, 1e-12);
        close("a", state.acceleration[0], a, 1e-11);
    }
}

/// Drawn by a dashpot whose far end moves with V: v = V (1 − e) with e = exp(−C t/M). The driver puts in
/// ∫ C (V − v) V dt = M V² (1 − e), and ∫ C (V − v)² dt = M V² (1 − e²)/2 is dissipated.
#[test]
fn the_driver_of_a_dashpot_does_work() {
    let speed = 0.8;
    let load = json!([{"on": "block", "dashpot": {"cy": C, "driver": {"y": speed.to_string()}}}]);
    let run = lone_mass([0.0, 0.0], trapezoidal(), [0.01, 3.0], load);
    for state in &run.states {
        let e = (-C * state.time / M).exp();
        let work = M * speed * speed;
        close("v", state.velocity[1], speed * (1.0 - e), 1e-5);
        close("driver", state.energy.external_work, work * (1.0 - e), 1e-5 * work);
        close("dissipation", state.energy.damping_dissipation, 0.5 * work * (1.0 - e * e), 1e-5 * work);
        close("energy error", state.energy.error(), 0.0, 1e-12 * work);
    }
}

/// In statics v is the mean of the increment: a force F on spring and dashpot gives u_n = (1 − (1 + K Δt/C)⁻ⁿ) F/K. A second
/// step keeps the dashpot, a third replaces it, in a fourth it is gone and u jumps to F/K.
#[test]
fn a_dashpot_in_statics_creeps_is_kept_replaced_and_taken_away() {
    let (dt, pull) = (0.05, 3.0);
    let spring = json!({"on": "block", "spring": {"kx": K, "ky": K}});
    let dashpot = |given: Value| json!({"on": "block", "dashpot": given});
    let step = |name: &str, loads: Value| json!({"name": name, "duration": 2, "loads": loads});
    let mut first = step("first", json!([spring, dashpot(json!({"cx": C})), force(0.0, [pull, 0.0])]));
    first["dt"] = json!({"initial": dt});
    let run = finish(&json!({
        "mesh": {"nodes": [[0, 0]], "points": {"block": [0]}},
        "newton": {"tolerance": 1e-13},
        "steps": [first, step("keep", json!([])), step("replace", json!([dashpot(json!({"cx": 3.0 * C}))])),
                  step("none", json!([dashpot(Value::Null)]))],
    }));
    let mut left = 1.0;
    for (n, state) in run.states.iter().enumerate() {
        left /= match n {
            0..80 => 1.0 + K * dt / C,
            80..120 => 1.0 + K * dt / (3.0 * C),
            _ => f64::INFINITY,
        };
        close("u", state.displacement[0], (1.0 - left) * pull / K, 1e-14);
        close("energy error", state.energy.error(), 0.0, 1e-14);
    }
    // ∫ (F − K u) du by the trapezoidal rule, but that a static run starts without forces.
    let first = run.states[0].displacement[0];
    let dissipated = 0.5 * pull * pull / K - 0.5 * pull * first;
    close("dissipation", run.last().energy.damping_dissipation, dissipated, 1e-12);
}
