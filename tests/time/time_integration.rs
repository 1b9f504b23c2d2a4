//! Time integration: order, energy, damping, free motion, the start of dynamics, moving supports, and two bars that meet.

use std::f64::consts::PI;

use crate::common::{self, Blocks, Finished, close, finish};
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

fn generalized_alpha(rho: f64) -> Value {
    json!({"generalized_alpha": {"rho_infinity": rho}})
}

fn wilson(theta: f64) -> Value {
    json!({"wilson": {"theta": theta}})
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

/// One step of (u, v Δt, a Δt²) of the oscillator with Ω = ωΔt, from the equations of Newmark (1959), Hilber, Hughes &
/// Taylor (1977) and Chung & Hulbert (1993):
///
/// ```text
/// (1 − α_m) a₁ + α_m a₀ + Ω² ((1 − α_f) u₁ + α_f u₀) = 0
/// u₁ = u₀ + v₀ + (½ − β) a₀ + β a₁,   v₁ = v₀ + (1 − γ) a₀ + γ a₁
/// ```
fn amplification([alpha_m, alpha_f, beta, gamma]: [f64; 4], omega_dt: f64) -> Matrix3<f64> {
    let w = omega_dt * omega_dt;
    of_columns(|u, v, a| {
        let predicted = u + v + (0.5 - beta) * a;
        let a1 = -(alpha_m * a + w * ((1.0 - alpha_f) * predicted + alpha_f * u))
            / (1.0 - alpha_m + w * (1.0 - alpha_f) * beta);
        [predicted + beta * a1, v + (1.0 - gamma) * a + gamma * a1, a1]
    })
}

/// The same of Wilson's scheme: the acceleration goes linearly from a₀ to a_θ = −Ω² u_θ at θ Δt (Bathe & Wilson 1973).
///
/// ```text
/// u_θ = u₀ + θ v₀ + θ²/6 (2 a₀ + a_θ),   a₁ = a₀ + (a_θ − a₀)/θ,   u₁ = u₀ + v₀ + (2 a₀ + a₁)/6,   v₁ = v₀ + (a₀ + a₁)/2
/// ```
fn wilson_amplification(theta: f64, omega_dt: f64) -> Matrix3<f64> {
    let w = omega_dt * omega_dt;
    of_columns(|u, v, a| {
        let ahead = -w * (u + theta * v + theta.powi(2) / 3.0 * a) / (1.0 + w * theta.powi(2) / 6.0);
        let a1 = a + (ahead - a) / theta;
        [u + v + (2.0 * a + a1) / 6.0, v + 0.5 * (a + a1), a1]
    })
}

fn of_columns(step: impl Fn(f64, f64, f64) -> [f64; 3]) -> Matrix3<f64> {
    Matrix3::from_columns(&[step(1.0, 0.0, 0.0), step(0.0, 1.0, 0.0), step(0.0, 0.0, 1.0)].map(Vector3::from))
}

fn newmark_numbers(beta: f64, gamma: f64) -> [f64; 4] {
    [0.0, 0.0, beta, gamma]
}

fn hht_numbers(alpha: f64) -> [f64; 4] {
    [0.0, -alpha, 0.25 * (1.0 - alpha).powi(2), 0.5 - alpha]
}

/// Equations 17, 20 and 25 of Chung & Hulbert.
fn generalized_alpha_numbers(rho: f64) -> [f64; 4] {
    let (m, f) = ((2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0));
    [m, f, 0.25 * (1.0 - m + f).powi(2), 0.5 - m + f]
}

fn spectral_radius(matrix: Matrix3<f64>) -> f64 {
    matrix.complex_eigenvalues().iter().fold(0.0, |radius, value| radius.max(value.norm()))
}

/// A scheme as a case names it, and its amplification matrix at ωΔt.
type Scheme = (Value, Box<dyn Fn(f64) -> Matrix3<f64>>);

/// The second-order schemes.
fn schemes() -> Vec<Scheme> {
    let of = |scheme: Value, numbers: [f64; 4]| -> Scheme { (scheme, Box::new(move |w| amplification(numbers, w))) };
    let mut all = vec![of(trapezoidal(), newmark_numbers(0.25, 0.5))];
    all.extend([-0.1, -1.0 / 3.0].map(|alpha| of(hht(alpha), hht_numbers(alpha))));
    all.extend([0.0, 0.5, 0.8, 1.0].map(|rho| of(generalized_alpha(rho), generalized_alpha_numbers(rho))));
    all.extend(
        [1.4, 2.0].map(|theta| -> Scheme { (wilson(theta), Box::new(move |w| wilson_amplification(theta, w))) }),
    );
    all
}

/// Closed form u₀ cos ωt of the one free dof; the error falls fourfold when Δt is halved.
#[test]
fn schemes_are_of_second_order() {
    for (scheme, _) in schemes() {
        // 2¼ periods: the cosine passes through 0 and shows every error of phase.
        let errors = [40, 80, 160].map(|per_period| {
            let steps = 9 * per_period / 4;
            let (run, dof) = let_go(scheme.clone(), PERIOD / per_period as f64, steps);
            (run.last().displacement[dof] - 1e-3 * (2.25 * 2.0 * PI).cos()).abs()
        });
        let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
        println!("{scheme}: errors {errors:?}, orders {orders:?}");
        assert!((1.8..2.2).contains(&orders[0]) && (1.9..2.1).contains(&orders[1]), "{scheme}: {orders:?}");
    }
}

/// γ ≠ ½ makes Newmark's scheme damp, and of first order.
#[test]
fn newmark_with_damping_is_of_first_order() {
    let scheme = json!({"newmark": {"gamma": 0.6, "beta": 0.3025}});
    let errors = [80, 160, 320].map(|per_period| {
        let (run, dof) = let_go(scheme.clone(), PERIOD / per_period as f64, per_period);
        (run.last().displacement[dof] - 1e-3).abs()
    });
    let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
    println!("errors {errors:?}, orders {orders:?}");
    assert!(orders.iter().all(|order| (0.9..1.1).contains(order)), "{orders:?}");
}

/// Every scheme follows its amplification matrix, from finely resolved motions to those a thousand times too fast.
#[test]
fn schemes_follow_their_amplification_matrices() {
    for (scheme, matrix) in schemes() {
        for (omega_dt, steps) in [(2.0 * PI / 20.0, 100), (3.0, 40), (1e3, 40)] {
            let dt = omega_dt / OMEGA;
            let (run, dof) = let_go(scheme.clone(), dt, steps);
            let matrix = matrix(omega_dt);
            let mut expected = Vector3::new(1.0, 0.0, -omega_dt * omega_dt);
            for state in &run.states[1..] {
                expected = matrix * expected;
                let scale = 1.0 + omega_dt;
                close("u", state.displacement[dof], 1e-3 * expected[0], 1e-10);
                close("v Δt", state.velocity[dof] * dt, 1e-3 * expected[1], 1e-9 * scale);
                close("a Δt²", state.acceleration[dof] * dt * dt, 1e-3 * expected[2], 1e-9 * scale * scale);
            }
        }
    }
}

/// What an increment leaves of the oscillator's amplitude is the spectral radius ρ of the amplification matrix. Two
/// complex roots ρ e^{±iφ} mean u_{n+2} = 2 ρ cos φ u_{n+1} − ρ² u_n, so u²_{n+1} − u_n u_{n+2} falls by ρ² a step,
/// whatever the phase; the third root has died out by then.
#[test]
fn schemes_damp_by_their_spectral_radius() {
    for (scheme, matrix) in schemes() {
        for omega_dt in [2.0 * PI / 20.0, 1.0] {
            let (run, dof) = let_go(scheme.clone(), omega_dt / OMEGA, 120);
            let u: Vec<f64> = run.states.iter().map(|state| state.displacement[dof]).collect();
            let area = |n: usize| u[n + 1].powi(2) - u[n] * u[n + 2];
            let measured = (area(100) / area(60)).powf(1.0 / 80.0);
            let expected = spectral_radius(matrix(omega_dt));
            println!("{scheme}, ωΔt = {omega_dt:.4}: ρ {measured:.8}, expected {expected:.8}");
            close("ρ", measured, expected, 1e-8);
        }
    }
}

/// The limits for motions that the increments do not resolve, from the papers of the schemes; resolved ones, 20
/// increments a period, are hardly damped. Wilson's scheme is stable from θ = (1 + √3)/2 on.
#[test]
fn unresolved_motions_are_damped_as_published() {
    let unresolved = |numbers| spectral_radius(amplification(numbers, 1e4));
    let resolved = |numbers| spectral_radius(amplification(numbers, 2.0 * PI / 20.0));
    for alpha in [-0.1, -0.3] {
        close("HHT", unresolved(hht_numbers(alpha)), (1.0 + alpha) / (1.0 - alpha), 1e-3);
    }
    close("HHT, resolved", resolved(hht_numbers(-0.1)), 1.0, 1e-4);
    for rho in [0.0, 0.5, 0.8, 1.0] {
        close("generalized-α", unresolved(generalized_alpha_numbers(rho)), rho, 3e-3);
    }
    close("generalized-α, resolved", resolved(generalized_alpha_numbers(0.8)), 1.0, 1e-4);
    for omega_dt in [0.1, 1.0, 10.0, 1e3] {
        close("trapezoidal rule", spectral_radius(amplification(newmark_numbers(0.25, 0.5), omega_dt)), 1.0, 1e-7);
    }
    let least = 0.5 * (1.0 + 3f64.sqrt());
    assert!(spectral_radius(wilson_amplification(least - 1e-3, 1e4)) > 1.0);
    for theta in [least + 1e-3, 1.37, 1.4, 2.0] {
        for omega_dt in [0.1, 1.0, 10.0, 100.0, 1e4] {
            let radius = spectral_radius(wilson_amplification(theta, omega_dt));
            assert!(radius < 1.0, "θ = {theta}, ωΔt = {omega_dt}: {radius}");
        }
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
    for scheme in [trapezoidal(), hht(-0.1), generalized_alpha(0.5), wilson(1.4)] {
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
        for scheme in [trapezoidal(), hht(-0.1), generalized_alpha(0.5), wilson(1.4)] {
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
    for scheme in [trapezoidal(), hht(-0.1), generalized_alpha(0.5), wilson(1.4)] {
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

/// A block hangs from its top in a dynamic step; freed, it falls at once: its momentum is −m g t, whatever it swings.
#[test]
fn a_support_freed_in_dynamics_lets_go_at_once() {
    for scheme in [trapezoidal(), hht(-0.3), generalized_alpha(0.5), wilson(1.4)] {
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
        let masses = run.model.mesh.elements.iter().enumerate().flat_map(|(e, element)| {
            element.nodes.iter().copied().zip(run.model.element_lumped_mass(e).iter().copied().collect::<Vec<_>>())
        });
        let masses: Vec<(usize, f64)> = masses.collect();
        for state in run.states.iter().filter(|state| state.time > 1.1) {
            let momentum: f64 = masses.iter().map(|(node, mass)| mass * state.velocity[2 * node + 1]).sum();
            close(&format!("{scheme}: momentum at {}", state.time), momentum, -10.0 * (state.time - 1.1), 1e-6);
        }
    }
}

/// A unit mass is held, or thrown upwards by a support that is moving, and freed after 0.1 under g = 10: it falls by
/// ½ g t² = 5 in 1, thrown 0.3 less. No reaction is left, and the energies balance. A third step inherits the scheme.
#[test]
fn a_mass_falls_as_soon_as_its_support_is_freed() {
    for scheme in [trapezoidal(), hht(-0.1), generalized_alpha(0.8), wilson(1.4), json!({"explicit": {}})] {
        for (held, place, velocity) in [(json!(0), 0.0, 0.0), (json!("1.5*t^2"), 0.015, 0.3)] {
            let run = finish(&json!({
                "mesh": {"nodes": [[3, 2]], "points": {"mass": [0]}},
                "point_masses": {"mass": {"mass": 1}},
                "steps": [
                    {"name": "held", "duration": 0.1, "scheme": scheme, "dt": {"initial": 0.01},
                     "supports": [{"on": "mass", "ux": 0, "uy": held}],
                     "loads": [{"on": "mass", "gravity": {"y": "-10"}}]},
                    {"name": "free", "duration": 0.5, "supports": [{"on": "mass", "uy": null}]},
                    {"name": "goes on", "duration": 0.5},
                ],
            }));
            // Central differences know velocities of parabolas exactly, the supports of Wilson's scheme are cubic.
            let fallen = place + velocity - 5.0;
            close(&format!("{scheme}, {held}: u"), run.last().displacement[1], fallen, 1e-9);
            close(&format!("{scheme}, {held}: v"), run.last().velocity[1], velocity - 10.0, 1e-9);
            for state in run.states.iter().filter(|state| state.time > 0.1 + 1e-9) {
                assert_eq!(state.reaction[1], 0.0, "{scheme}: a reaction at {}", state.time);
            }
            // The audit of central differences counts ½ v₋ M v₊, which jumps by ⅛ Δt² M (a₁² − a₀²) with the acceleration.
            let jump = if scheme["explicit"].is_object() { 0.125 * 0.005f64.powi(2) * 100.0 } else { 0.0 };
            close(&format!("{scheme}, {held}: energy"), run.last().energy.error(), 0.0, jump + 1e-9);
        }
    }
}

/// In statics the reaction of a freed support fades over the step, through explicit increments of a `rupture` as well: a
/// spring of stiffness 2 stretched by 0.1 hands a mass its fading force back, 0.2 (1 − t/T). Explicit steps that follow
/// have no reaction of it.
#[test]
fn a_static_step_lets_go_slowly_and_an_explicit_one_keeps_no_reaction() {
    let run = finish(&json!({
        "mesh": {"nodes": [[0, 0]], "points": {"mass": [0]}},
        "point_masses": {"mass": {"mass": 1}},
        "steps": [
            {"name": "pull", "duration": 1, "dt": {"initial": 0.5},
             "supports": [{"on": "mass", "ux": 0.1, "uy": 0}], "loads": [{"on": "mass", "spring": {"kx": 2}}]},
            {"name": "let go", "duration": 2, "supports": [{"on": "mass", "ux": null}]},
            {"name": "hold", "duration": 1, "supports": [{"on": "mass", "ux": 0.1}]},
            {"name": "swing", "duration": 1, "scheme": {"explicit": {}}, "dt": {"initial": 1e-3},
             "supports": [{"on": "mass", "ux": null}]},
        ],
    }));
    for state in run.states.iter().filter(|state| state.time >= 1.0) {
        let t = state.time;
        let (place, reaction) = match t {
            t if t <= 1.0 => (0.1, 0.2),
            t if t <= 3.0 => (0.1 * (1.0 - (t - 1.0) / 2.0), 0.0),
            t if t <= 4.0 => (0.1 * (t - 3.0), 0.2 * (t - 3.0)),
            t => (0.1 * f64::cos(f64::sqrt(2.0) * (t - 4.0)), 0.0),
        };
        close(&format!("u at {t}"), state.displacement[0], place, 1e-7);
        close(&format!("reaction at {t}"), state.reaction[0], reaction, 1e-9);
    }
}

/// The bar's end is moved by A (1 − cos pt), which starts with an acceleration. With the consistent mass ρL/3 of the free
/// end and ρL/6 between the ends, ω² = 9:
///
/// ```text
/// ü + ω² u = ω² u_s − ½ ü_s   ⇒   u = A + B cos pt − (A + B) cos ωt,   B = −A (ω² + ½p²)/(ω² − p²)
/// ```
/// Displacement and velocity converge with second order and, for the trapezoidal rule, reaction and energy as well.
#[test]
fn moving_supports_keep_the_second_order() {
    let (amplitude, p, end) = (1e-3, 2.0, 2.0);
    let b = -amplitude * (9.0 + 0.5 * p * p) / (9.0 - p * p);
    let exact = |t: f64| amplitude + b * (p * t).cos() - (amplitude + b) * (OMEGA * t).cos();
    let dexact = |t: f64| -p * b * (p * t).sin() + OMEGA * (amplitude + b) * (OMEGA * t).sin();
    let ddexact = |t: f64| -p * p * b * (p * t).cos() + OMEGA * OMEGA * (amplitude + b) * (OMEGA * t).cos();
    for scheme in [trapezoidal(), hht(-0.1), generalized_alpha(0.5), wilson(1.4)] {
        let errors = [20, 40, 80].map(|steps| {
            let run = finish(&json!({
                "mesh": Blocks::default().rectangle("bar", [1, 1], [0.0, 0.0], [1.0, 1.0]).json(),
                "bodies": {"bar": {"material": {"model": "linear", "E": 3, "nu": 0, "density": 1}}},
                "steps": [{"name": "shake", "duration": end, "dt": {"initial": end / steps as f64}, "scheme": scheme,
                           "supports": [{"on": "bar", "uy": 0},
                                        {"on": "bar_left", "ux": format!("{amplitude} * (1 - cos({p} * t))")}]}],
            }));
            let free = 2 * run.nodes("bar_right")[0];
            let support = 2 * run.nodes("bar_left")[0];
            run.states.iter().fold([0.0f64; 5], |largest, state| {
                let t = state.time;
                let [v, a] = [(p * t).sin() * p, (p * t).cos() * p * p].map(|rate| amplitude * rate);
                // K (u_s − u) + M (ü_s/3 + ü/6), both with E A/L = 3 and ρ A L = 1
                let place = amplitude * (1.0 - (p * t).cos());
                let reaction = 3.0 * (place - exact(t)) + a / 3.0 + ddexact(t) / 6.0;
                let errors = [
                    state.displacement[free] - exact(t),
                    state.velocity[free] - dexact(t),
                    state.velocity[support] - v,
                    run.reaction("bar_left", state)[0] - reaction,
                    state.energy.error(),
                ];
                std::array::from_fn(|k| largest[k].max(errors[k].abs()))
            })
        });
        for (k, of) in ["u", "v", "v of the support", "reaction", "energy"].iter().enumerate() {
            let orders = [errors[0][k] / errors[1][k], errors[1][k] / errors[2][k]].map(f64::log2);
            println!("{scheme}, {of}: error {:e}, orders {orders:?}", errors[2][k]);
            // The free accelerations of the α schemes, and with them the reactions and their work, belong to a time
            // (α_m − α_f) Δt off.
            let shifted = matches!(*of, "reaction" | "energy") && scheme != trapezoidal();
            let least = if shifted { 0.8 } else { 1.8 };
            assert!(orders.iter().all(|order| *order > least), "{scheme}, {of}: {orders:?}");
        }
    }
}

/// A support that sets off at once has its velocity from the first increment on, and the jerk does not make it ring.
#[test]
fn a_jerk_of_a_support_does_not_ring() {
    for scheme in [trapezoidal(), generalized_alpha(0.8), wilson(1.4)] {
        let run = finish(&json!({
            "mesh": Blocks::default().rectangle("bar", [1, 1], [0.0, 0.0], [1.0, 1.0]).json(),
            "bodies": {"bar": {"material": {"model": "linear", "E": 3, "nu": 0, "density": 1}}},
            "steps": [{"name": "pull", "duration": 1, "dt": {"initial": 0.05}, "scheme": scheme,
                       "supports": [{"on": "bar", "uy": 0}, {"on": "bar_left", "ux": {"rate": 0.02}}]}],
        }));
        let support = 2 * run.nodes("bar_left")[0];
        for (n, state) in run.states.iter().enumerate() {
            close("v", state.velocity[support], 0.02, 1e-12);
            close("a", state.acceleration[support], if n == 0 { 0.02 / 0.05 } else { 0.0 }, 1e-9);
        }
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
