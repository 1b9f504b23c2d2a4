//! Time integration: order, energy, damping, free motion, the start of dynamics, and two bars that meet.

mod common;

use std::f64::consts::PI;

use common::{Blocks, Finished, close, finish};
use nalgebra::{Matrix3, Vector3};
use serde_json::{Value, json};

/// E/(1 − ν²)-free numbers: ν = 0, so the constrained modulus is E = 3, and with ρ = 1, L = 1 the one-element bar with
/// its consistent mass ρL/3 has ω² = (E/L)/(ρL/3) = 9.
const OMEGA: f64 = 3.0;
const PERIOD: f64 = 2.0 * PI / OMEGA;

fn trapezoidal() -> Value {
    json!({"newmark": {}})
}

fn hht(alpha: f64) -> Value {
    json!({"hht": {"alpha": alpha}})
}

/// A one-element bar pulled out by 1e-3 in a static step, then let go. Returns the run and the free dof.
fn let_go(scheme: Value, dt: f64, steps: usize) -> (Finished, usize) {
    let run = finish(&json!({
        "mesh": Blocks::default().rectangle("bar", [1, 1], [0.0, 0.0], [1.0, 1.0]).json(),
        "bodies": {"bar": {"material": {"model": "linear", "E": 3, "nu": 0, "density": 1}}},
        "steps": [
            {"name": "pull", "duration": 1, "dt": {"initial": 1},
             "supports": [{"on": "bar", "uy": 0}, {"on": "bar_left", "ux": 0}],
             "loads": [{"on": "bar_right", "force": {"x": 1.5e-3}}]},
            {"name": "free", "duration": dt * steps as f64, "dt": {"initial": dt}, "scheme": scheme,
             "loads": [{"on": "bar_right", "force": {"x": "0"}}]},
        ],
    }));
    let free = 2 * run.nodes("bar_right")[0];
    (run, free)
}

/// One step of (u, v Δt, a Δt²) of the oscillator with Ω = ωΔt, from the equations of Hilber, Hughes & Taylor (1977):
///
/// ```text
/// a₁ + Ω² ((1 + α) u₁ − α u₀) = 0,   u₁ = u₀ + v₀ + (½ − β) a₀ + β a₁,   v₁ = v₀ + (1 − γ) a₀ + γ a₁
/// ```
fn amplification(alpha: f64, omega_dt: f64) -> Matrix3<f64> {
    let (gamma, beta) = (0.5 - alpha, 0.25 * (1.0 - alpha).powi(2));
    let w = omega_dt * omega_dt;
    let column = |u: f64, v: f64, a: f64| {
        let predicted = u + v + (0.5 - beta) * a;
        let a1 = -w * ((1.0 + alpha) * predicted - alpha * u) / (1.0 + w * (1.0 + alpha) * beta);
        Vector3::new(predicted + beta * a1, v + (1.0 - gamma) * a + gamma * a1, a1)
    };
    Matrix3::from_columns(&[column(1.0, 0.0, 0.0), column(0.0, 1.0, 0.0), column(0.0, 0.0, 1.0)])
}

fn spectral_radius(matrix: Matrix3<f64>) -> f64 {
    matrix.complex_eigenvalues().iter().fold(0.0, |radius, value| radius.max(value.norm()))
}

/// Closed form u₀ cos ωt of the one free dof; the error falls fourfold when Δt is halved.
#[test]
fn newmark_and_hht_are_of_second_order() {
    for scheme in [trapezoidal(), hht(-0.1), hht(-1.0 / 3.0)] {
        // 2¼ periods: the cosine passes through 0 and shows every error of phase.
        let errors = [20, 40, 80].map(|per_period| {
            let steps = 9 * per_period / 4;
            let (run, dof) = let_go(scheme.clone(), PERIOD / per_period as f64, steps);
            (run.last().displacement[dof] - 1e-3 * (2.25 * 2.0 * PI).cos()).abs()
        });
        let ratios = [errors[0] / errors[1], errors[1] / errors[2]];
        println!("{scheme}: errors {errors:?}, ratios {ratios:?}");
        assert!((3.5..4.5).contains(&ratios[0]) && (3.8..4.2).contains(&ratios[1]), "{scheme}: ratios {ratios:?}");
    }
}

/// The trapezoidal rule turns a mode by exactly φ a step, tan(φ/2) = ωΔt/2, and keeps its energy.
#[test]
fn trapezoidal_rule_follows_its_closed_form_and_keeps_energy() {
    let dt = PERIOD / 12.0;
    let (run, dof) = let_go(trapezoidal(), dt, 400);
    let phase = 2.0 * (0.5 * OMEGA * dt).atan();
    let start = &run.states[0];
    let energy = start.energy.strain;
    close("energy of the pulled bar", energy, 0.5 * 3.0 * 1e-6, 1e-18);
    for (n, state) in run.states.iter().enumerate() {
        close("u", state.displacement[dof], 1e-3 * (n as f64 * phase).cos(), 1e-13);
        close("energy error", state.energy.error(), 0.0, 1e-10 * energy);
        if n > 0 {
            close("energy", state.energy.kinetic + state.energy.strain, energy, 1e-10 * energy);
        }
    }
}

/// HHT follows the amplification matrix of Hilber, Hughes & Taylor. Its spectral radius tends to (1 + α)/(1 − α) for
/// large ωΔt and stays within 1e-4 of 1 at 20 steps a period.
#[test]
fn hht_damps_high_frequencies_but_not_low_ones() {
    let alpha = -0.1;
    for (omega_dt, steps) in [(2.0 * PI / 20.0, 100), (3.0, 40), (1e3, 40)] {
        let dt = omega_dt / OMEGA;
        let (run, dof) = let_go(hht(alpha), dt, steps);
        let matrix = amplification(alpha, omega_dt);
        let mut expected = Vector3::new(1.0, 0.0, -omega_dt * omega_dt);
        for state in &run.states[1..] {
            expected = matrix * expected;
            close("u", state.displacement[dof], 1e-3 * expected[0], 1e-10);
            close("v Δt", state.velocity[dof] * dt, 1e-3 * expected[1], 1e-9 * (1.0 + omega_dt));
        }
    }
    close("ρ(∞)", spectral_radius(amplification(alpha, 1e4)), (1.0 + alpha) / (1.0 - alpha), 1e-3);
    close("ρ at 20 steps a period", spectral_radius(amplification(alpha, 2.0 * PI / 20.0)), 1.0, 1e-4);
}

/// A free body of four elements.
fn free_body(velocity: [f64; 2], gravity: Value, scheme: Value, dt: f64, steps: usize) -> Finished {
    finish(&json!({
        "mesh": Blocks::default().rectangle("body", [2, 2], [0.0, 0.0], [1.0, 1.0]).json(),
        "bodies": {"body": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 2}}},
        "initial_velocity": {"body": velocity},
        "steps": [{"name": "fly", "duration": dt * steps as f64, "dt": {"initial": dt}, "scheme": scheme,
                   "loads": [{"on": "body", "gravity": gravity}]}],
    }))
}

/// Constant acceleration is integrated exactly: g t²/2; the energy balance closes from the first increment on.
#[test]
fn a_free_body_falls_with_half_g_t_squared() {
    for scheme in [trapezoidal(), hht(-0.1)] {
        let run = free_body([0.0, 0.0], json!({"y": "-9.81"}), scheme, 0.05, 20);
        for state in &run.states {
            for node in state.displacement.chunks(2) {
                close("ux", node[0], 0.0, 1e-10);
                close("uy", node[1], -0.5 * 9.81 * state.time.powi(2), 1e-9);
            }
            let work = 2.0 * 0.5 * (9.81 * state.time).powi(2);
            close("kinetic energy", state.energy.kinetic, work, 1e-7 * work);
            close("energy error", state.energy.error(), 0.0, 1e-7 * work);
        }
    }
}

/// No force acts, so u = v t for every node, whatever the increment. In the short ones M u/Δt² is far larger than any
/// force: what round-off leaves of it must not be taken for a lack of equilibrium.
#[test]
fn an_initial_velocity_carries_a_free_body() {
    for (speed, dt, steps) in [(1.0, 0.1, 50), (1.0, 1e-4, 200), (1e3, 1e-5, 500)] {
        for scheme in [trapezoidal(), hht(-0.1)] {
            let run = free_body([2.0 * speed, -speed], json!({"y": 0}), scheme, dt, steps);
            assert_eq!(run.report.cutbacks, 0, "free flight needs no cut-back");
            let state = run.last();
            let way = speed * state.time;
            for node in state.displacement.chunks(2) {
                close("ux", node[0], 2.0 * way, 1e-9 * way);
                close("uy", node[1], -way, 1e-9 * way);
            }
            close("energy error", state.energy.error(), 0.0, 1e-8 * state.energy.kinetic);
        }
    }
}

/// A column that stands under its weight stands still when dynamics begins.
#[test]
fn dynamics_after_statics_starts_from_rest() {
    for scheme in [trapezoidal(), hht(-0.1)] {
        let run = finish(&json!({
            "mesh": Blocks::default().rectangle("column", [2, 4], [0.0, 0.0], [1.0, 2.0]).json(),
            "bodies": {"column": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3, "density": 1}}},
            "newton": {"tolerance": 1e-12},
            "steps": [
                {"name": "settle", "duration": 1, "dt": {"initial": 0.5},
                 "supports": [{"on": "column_bottom", "ux": 0, "uy": 0}],
                 "loads": [{"on": "column", "gravity": {"y": -10}}]},
                {"name": "stand", "duration": 1, "dt": {"initial": 0.05}, "scheme": scheme},
            ],
        }));
        let settled = run.at(1.0).clone();
        assert!(settled.displacement.iter().any(|u| u.abs() > 1e-2), "the column sags");
        for state in run.states.iter().filter(|state| state.time > 1.0) {
            close("motion", common::distance(&state.displacement, &settled.displacement), 0.0, 1e-10);
            close("velocity", common::distance(&state.velocity, &[0.0; 30]), 0.0, 1e-9);
            close("energy error", state.energy.error(), settled.energy.error(), 1e-9);
        }
    }
}

/// A block hangs from its top in a dynamic step; freed, it sinks as the reaction m g fades: v = −g t²/(2 T).
#[test]
fn a_support_freed_in_dynamics_lets_go_without_a_kick() {
    for scheme in [trapezoidal(), hht(-0.3)] {
        let run = finish(&json!({
            "mesh": Blocks::default().rectangle("block", [2, 2], [0.0, 0.0], [1.0, 1.0]).json(),
            "bodies": {"block": {"material": {"model": "neo_hookean", "E": 1e5, "nu": 0.3, "density": 1}}},
            "newton": {"tolerance": 1e-10},
            "steps": [
                {"name": "settle", "duration": 1, "dt": {"initial": 1},
                 "supports": [{"on": "block_top", "uy": 0}, {"on": "block_left", "ux": 0}],
                 "loads": [{"on": "block", "gravity": {"y": -10}}]},
                {"name": "hang", "duration": 0.1, "dt": {"initial": 0.05}, "scheme": scheme},
                {"name": "fall", "duration": 2, "dt": {"initial": 0.05}, "scheme": scheme,
                 "supports": [{"on": "block_top", "uy": null}]},
            ],
        }));
        let state = run.last();
        let mean = state.velocity.chunks(2).map(|v| v[1]).sum::<f64>() / 9.0;
        println!("{scheme}: v = {mean}");
        close("v", mean, -10.0, 0.01);
    }
}

/// Two equal bars, L = 1, c = 1, ρ = 1, meet at relative speed v: they press each other with ρ c v/2 until the waves have
/// gone to the free ends and back, 2 L/c. Between h/c and 2 h/c of either time is the width of a discrete front.
#[test]
fn two_equal_bars_meet() {
    let (n, v) = (200, 1e-3);
    let run = finish(&json!({
        "mesh": Blocks::default()
            .rectangle("left", [n, 1], [-1.0, 0.0], [0.0, 0.02])
            .rectangle("right", [n, 1], [0.0, 0.0], [1.0, 0.02]).json(),
        "bodies": {
            "left": {"material": {"model": "neo_hookean", "E": 1, "nu": 0, "density": 1}},
            "right": {"material": {"model": "neo_hookean", "E": 1, "nu": 0, "density": 1}},
        },
        "contacts": {"ends": {"slave": "left_right", "master": "right_left", "friction": {"law": "frictionless"}}},
        "initial_velocity": {"left": [v / 2.0, 0], "right": [-v / 2.0, 0]},
        "steps": [{"name": "meet", "duration": 2.5, "dt": {"initial": 0.5 / n as f64}, "scheme": hht(-0.2),
                   "supports": [{"on": "left", "uy": 0}, {"on": "right", "uy": 0}]}],
    }));
    let stress = |state| run.contact_force(state)[0] / 0.02;
    let pressed: Vec<_> = run.states.iter().filter(|state| stress(state) > 0.0).map(|state| state.time).collect();
    let duration = pressed[pressed.len() - 1] - pressed[0];
    let middle: Vec<f64> = run.states.iter().filter(|s| (0.5..1.5).contains(&s.time)).map(stress).collect();
    let mean = middle.iter().sum::<f64>() / middle.len() as f64;
    println!("duration {duration} from {} to {}, mean {}", pressed[0], pressed[pressed.len() - 1], mean / (0.5 * v));
    close("mean stress", mean, 0.5 * v, 0.02 * 0.5 * v);
    close("duration", duration, 2.0, 0.04);
}
