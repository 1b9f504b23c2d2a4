//! Maps of the stability of steady sliding against the linear theory: a spring-slider over stiffness and mass, and two long
//! blocks over wave number and weakening.
//!
//! In steady sliding at V, where R = 1 and q = μ p, the law's μ̇ = −κ (μ/μ_k − 1) λ + ξ (1 − μ/μ_s) takes μ' (and R' by itself,
//! as exp(−r V t)) along
//! ```text
//! μ̇' = −(k_c/p) v' − b μ',   k_c = κ p (μ_ss/μ_k − 1),   b = κ V/μ_k + ξ/μ_s,   μ_ss = (κ V + ξ)/b
//! ```
//! With M v̇' + c v' + K x' = −p μ' that is M s³ + (M b + c) s² + (K − k_c + c b) s + K b = 0 (per area), which by Hurwitz is stable for
//! ```text
//! K/k_c > (1 − ĉ)(1 + m̂/ĉ),   ĉ = c b/k_c,   m̂ = M b²/k_c
//! ```
//! and for K > k_c where motion is slow. Waves cos(k x) of slip on two slabs of height H, the far sides of which are led, feel
//! K(k H) of the theory of elasticity, and radiation damping η for c.

use crate::common::{Blocks, Finished, finish};
use fecontact::laws::friction::{FrictionParameters, Sliding};
use nalgebra::{Complex, DMatrix, DVector, Matrix3, Matrix4, Vector4};
use serde_json::{Value, json};

const MU_S: f64 = 0.4;
const MU_K: f64 = 0.2;
/// b, and κ V/μ_k = ξ/μ_s = b/2: μ_ss = 0.3 [1/T]
const RATE: f64 = 1.0;
/// μ_k/κ [L]
const WAY: f64 = 1e-3;
const STEADY: f64 = 0.3;
/// Deviation of μ at the start, as a share
const OFF: f64 = 1e-7;
/// ĉ
const DAMPING: f64 = 0.1;

fn velocity() -> f64 {
    0.5 * RATE * WAY
}

/// Pressure at which the law has this k_c.
fn pressure(critical: f64) -> f64 {
    critical * WAY / (STEADY - MU_K)
}

fn law(alpha: f64) -> Value {
    json!({"law": "super_subloading", "mu_s": MU_S, "mu_k": MU_K, "kappa": MU_K / WAY, "xi": 0.5 * RATE * MU_S,
        "r": 100.0 / WAY, "alpha_t": alpha})
}

/// The roots with M, c, K and k_c, largest real part first.
fn roots(mass: f64, damping: f64, stiffness: f64, critical: f64) -> Vec<(f64, f64)> {
    let linear = stiffness - critical + damping * RATE;
    let mut roots: Vec<(f64, f64)> = if mass == 0.0 {
        of_quadratic(damping, linear, stiffness * RATE)
    } else {
        let [c2, c1, c0] = [mass * RATE + damping, linear, stiffness * RATE].map(|c| c / mass);
        let companion = Matrix3::new(-c2, -c1, -c0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
        companion.complex_eigenvalues().iter().map(|root| (root.re, root.im)).collect()
    };
    roots.sort_by(|a, b| b.0.total_cmp(&a.0));
    roots
}

fn of_quadratic(a: f64, b: f64, c: f64) -> Vec<(f64, f64)> {
    let (half, inside) = (-0.5 * b / a, (0.25 * b * b - a * c) / (a * a));
    let root = inside.abs().sqrt();
    if inside >= 0.0 { vec![(half + root, 0.0), (half - root, 0.0)] } else { vec![(half, root), (half, -root)] }
}

/// Samples of a run of a linear system: increments, and how many of them between two samples.
struct Sampling {
    dt: f64,
    increments: usize,
}

const SAMPLES: usize = 60;

impl Sampling {
    /// So that increments resolve the leading root, and the fastest ten times less; the leading one neither grows too much
    /// nor is lost, in a limited time.
    fn of(roots: &[(f64, f64)], resolution: f64, limit: f64) -> Self {
        let size = |root: &(f64, f64)| root.0.hypot(root.1);
        let (leading, fastest) = (&roots[0], roots.iter().map(size).fold(0.0, f64::max));
        let time = (15.0 / size(leading)).min(4.0 / leading.0.abs()).min(limit);
        let step = time / SAMPLES as f64;
        let increments = (step * size(leading).max(0.1 * fastest) / resolution).ceil() as usize;
        Self { dt: step / increments as f64, increments }
    }

    /// Root s of the leading mode exp(s t) of samples with `order` modes (Prony's method).
    fn leading(&self, samples: &[f64], order: usize) -> (f64, f64) {
        let rows = samples.len() - order;
        let scale = samples.iter().fold(0.0f64, |most, y| most.max(y.abs()));
        let before = DMatrix::from_fn(rows, order, |i, j| samples[i + order - 1 - j] / scale);
        let next = DVector::from_fn(rows, |i, _| samples[i + order] / scale);
        let recurrence = before.svd(true, true).solve(&next, 1e-7).expect("a solution");
        let companion = DMatrix::from_fn(order, order, |i, j| match i {
            0 => recurrence[j],
            _ => f64::from(u8::from(i == j + 1)),
        });
        let factors = companion.complex_eigenvalues();
        let leading = factors.iter().max_by(|a, b| a.norm().total_cmp(&b.norm())).expect("modes");
        let step = self.dt * self.increments as f64;
        (leading.norm().ln() / step, leading.arg() / step)
    }
}

/// Deviations of μ/μ_ss, weighted by a function of place, at the samples.
fn deviations(run: &Finished, sampling: &Sampling, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    let x = run.model.mesh.undeformed();
    let weights: Vec<f64> = run.model.contacts[0].points.iter().map(|point| weight(point.at(&x).x)).collect();
    let of = |state: &fecontact::model::state::State| {
        let mu = state.contacts[0].iter().map(|point| point.friction.variables[0] / STEADY - 1.0);
        mu.zip(&weights).map(|(deviation, weight)| deviation * weight).sum::<f64>()
    };
    run.states.iter().skip(sampling.increments - 1).step_by(sampling.increments).map(of).collect()
}

/// Leading root of a slider of mass m̂ on a spring K/k_c, with k_c = b = 1.
fn slider(mass: f64, stiffness: f64) -> (f64, f64) {
    let (p, v, mu) = (pressure(1.0), velocity(), STEADY * (1.0 + OFF));
    let sampling = Sampling::of(&roots(mass, DAMPING, stiffness, 1.0), 0.02, f64::INFINITY);
    let ahead = (mu * p + DAMPING * v) / stiffness;
    let run = finish(&json!({
        "mesh": {"nodes": [[0, 0]], "points": {"block": [0]}},
        "point_masses": {"block": {"mass": mass, "velocity": [v, 0]}},
        "contacts": {"base": {
            "slave": "block", "area": 1, "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 1e3}, "friction": law(1e5),
            "initial": {"pressure": p, "traction": mu * p, "structure": mu / MU_K}}},
        "steps": [{"name": "slide", "duration": sampling.dt * (sampling.increments * SAMPLES) as f64,
            "scheme": {"newmark": {}}, "dt": {"initial": sampling.dt}, "loads": [
                {"on": "block", "force": {"y": format!("-{p:?}")}},
                {"on": "block", "spring": {"kx": stiffness, "driver": {"x": format!("{ahead:?} + {v:?}*t")}}},
                {"on": "block", "dashpot": {"cx": DAMPING}}]}],
        "newton": {"tolerance": 1e-13},
    }));
    sampling.leading(&deviations(&run, &sampling, |_| 1.0), 3)
}

/// G, H and ν of the slabs, and η b H/G
const SHEAR: f64 = 1.0;
const NU: f64 = 0.25;
const RADIATION: f64 = 0.05;

/// K(k) of slip cos(k x) between two slabs of height 1 whose far sides are held, without change of pressure.
///
/// ```text
/// u = (U cos kx, W sin kx):   (U, W) = (k, s) e^(sy)  and  (k y, s y − (3 − 4ν)) e^(sy),   s = ±k
/// τ_xy/G = 2 k s e^(sy)  and  2 k (s y − (1 − 2ν)) e^(sy),   σ_yy/G = 2 k² e^(sy)  and  (2 k² y − 4 (1 − ν) s) e^(sy)
/// ```
fn stiffness_of_slabs(k: f64) -> f64 {
    let columns = [k, -k].map(|s| {
        let far = s.exp();
        [
            Vector4::new(2.0 * k * k, 2.0 * k * s, k * far, s * far),
            Vector4::new(-4.0 * (1.0 - NU) * s, -2.0 * k * (1.0 - 2.0 * NU), k * far, (s - (3.0 - 4.0 * NU)) * far),
        ]
    });
    let matrix = Matrix4::from_columns(&columns.concat());
    // Rows: σ_yy and τ_xy at y = 0, U and W at y = 1.
    let parts = matrix.lu().solve(&Vector4::new(0.0, -1.0, 0.0, 0.0)).expect("regular");
    let slip = 2.0 * k * (parts[0] + parts[2]);
    SHEAR / slip
}

/// Leading root of waves of number k on two slabs, where the law has the given k_c.
fn slabs(k: f64, critical: f64) -> (f64, f64) {
    let (p, v) = (pressure(critical), velocity());
    // Uniform slip, on K(0) = G/(2H), grows from round-off like exp((k_c − K) t/η), and may not become large.
    let limit = 8.0 * RADIATION / (critical - 0.5 * SHEAR).max(1e-3);
    let sampling = Sampling::of(&roots(0.0, RADIATION, stiffness_of_slabs(k), critical), 0.01, limit);
    let length = std::f64::consts::TAU / k;
    let columns = 40;
    let rows = ((columns as f64 / length).ceil() as usize).clamp(8, 40);
    let graded = |t: f64| if length < 1.0 { (3.0 * t).exp_m1() / 3f64.exp_m1() } else { t };
    let mesh = Blocks::default().block("lower", [columns, rows], |s, t| [length * s, -graded(1.0 - t)]).block(
        "upper",
        [columns, rows],
        |s, t| [length * s, graded(t)],
    );
    let body = json!({"material": {"model": "linear", "E": 2.0 * SHEAR * (1.0 + NU), "nu": NU}});
    let mu = format!("{STEADY:?}*(1 + {OFF:?}*cos({k:?}*x))");
    let dragged = RADIATION * v;
    let run = finish(&json!({
        "mesh": mesh.json(),
        "bodies": {"lower": body, "upper": body},
        "periodic": [["lower_left", "lower_right"], ["upper_left", "upper_right"]],
        "contacts": {"fault": {
            "slave": "upper_bottom", "master": "lower_top", "method": "node_to_segment", "sliding": "small",
            "normal": {"alpha_n": 1e5}, "friction": law(1e5), "radiation_damping": RADIATION,
            "initial": {"pressure": p, "traction": format!("{p:?}*{mu}"), "structure": format!("{mu}/{MU_K:?}"),
                "balanced": true}}},
        "steps": [{"name": "slide", "duration": sampling.dt * (sampling.increments * SAMPLES) as f64,
            "scheme": "static", "dt": {"initial": sampling.dt},
            "supports": [{"on": "lower_bottom", "ux": {"rate": -0.5 * v}, "uy": 0},
                {"on": "upper_top", "ux": {"rate": 0.5 * v}, "uy": 0}],
            // Radiation damping of steady sliding is in equilibrium from the start.
            "loads": [{"on": "upper_bottom", "traction": {"x": format!("{dragged:?}")}},
                {"on": "lower_top", "traction": {"x": format!("-{dragged:?}")}}]}],
        "newton": {"tolerance": 1e-13},
    }));
    sampling.leading(&deviations(&run, &sampling, |x| (k * x).cos()), 2)
}

/// A row of a map. The root found has to obey the equation of the theory to 2 % of its terms (roots that are nearly double
/// move by much more than what they are computed from).
fn compare(map: &str, at: [f64; 2], [mass, damping, stiffness, critical]: [f64; 4], found: (f64, f64)) {
    let theory = roots(mass, damping, stiffness, critical)[0].0;
    println!("| {map} | {:.4} | {:.4} | {theory:.4} | {:.4} |", at[0], at[1], found.0);
    let s = Complex::new(found.0, found.1);
    let linear = [stiffness, -critical, damping * RATE];
    let terms =
        [s * s * s * mass, s * s * (mass * RATE + damping), s * linear.iter().sum::<f64>(), (stiffness * RATE).into()];
    let sizes = terms.map(|term| term.norm()).iter().sum::<f64>() + s.norm() * linear[1].abs();
    let off = terms.iter().sum::<Complex<f64>>().norm() / sizes;
    assert!(off < 0.02, "{map} at {at:?}: {s} misses the equation by {off}");
    let scale = s.norm();
    assert!(theory.abs() < 0.05 * scale || theory * found.0 > 0.0, "{map} at {at:?}: {s}, expected {theory}");
}

fn map_slider(masses: &[f64], stiffnesses: &[f64]) {
    for &mass in masses {
        println!("| boundary of slider | {:.4} | {mass:.4} | | |", (1.0 - DAMPING) * (1.0 + mass / DAMPING));
        for &stiffness in stiffnesses {
            compare("slider", [stiffness, mass], [mass, DAMPING, stiffness, 1.0], slider(mass, stiffness));
        }
    }
}

fn map_slabs(waves: &[f64], criticals: &[f64]) {
    for &k in waves {
        let stiffness = stiffness_of_slabs(k);
        println!("| boundary of slabs | {k:.4} | {:.4} | | |", stiffness + RADIATION * RATE);
        for &critical in criticals {
            compare("slabs", [k, critical], [0.0, RADIATION, stiffness, critical], slabs(k, critical));
        }
    }
}

/// The law itself, asked for its rates at points around steady sliding on an elastic contact: the eigenvalues of the
/// differentiated equations of motion are the roots of the cubic, with K in series with the contact.
#[test]
fn the_linear_theory_is_the_derivative_of_the_law() {
    let (mass, damping, stiffness, alpha) = (0.05, DAMPING, 1.3, 20.0);
    let (p, v, dt) = (pressure(1.0), velocity(), 1e-7);
    let mut parameters = law(alpha);
    parameters["tolerance"] = json!(1e-12);
    let law = serde_json::from_value::<FrictionParameters>(parameters).expect("a law").build(1.0).expect("in range");
    // Position of the steady motion, velocity, q and μ, and their rates
    let rates = |y: &Vector4<f64>| {
        let mut state = law.initial_state(0.0, 0.0);
        (state.traction, state.pressure, state.variables[0]) = (y[2], p, y[3]);
        let new = law.respond(&state, Sliding { slip: y[1] * dt, pressure: p, dt }).expect("an answer").state;
        let force = STEADY * p + damping * v - stiffness * y[0] - damping * y[1] - y[2];
        Vector4::new(y[1] - v, force / mass, (new.traction - y[2]) / dt, (new.variables[0] - y[3]) / dt)
    };
    let steady = Vector4::new(0.0, v, STEADY * p, STEADY);
    let steps = [1e-4 * WAY, 1e-4 * v, 1e-4 * STEADY * p, 1e-4 * STEADY];
    let columns = [0, 1, 2, 3].map(|i| {
        let step = Vector4::ith(i, steps[i]);
        (rates(&(steady + step)) - rates(&(steady - step))) / (2.0 * steps[i])
    });
    let found = Matrix4::from_columns(&columns).complex_eigenvalues();
    let rigid = 1.0 - 1.0 / alpha;
    let cubic = [mass * RATE + damping * rigid, stiffness * rigid - 1.0 + damping * RATE, stiffness * RATE];
    let [c2, c1, c0] = cubic.map(|c| c / (mass * rigid));
    for root in Matrix3::new(-c2, -c1, -c0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0).complex_eigenvalues().iter() {
        let nearest = found.iter().map(|other| (other - root).norm()).fold(f64::INFINITY, f64::min);
        println!("{root}: off by {nearest:e}");
        assert!(nearest < 1e-3 * root.norm(), "{root} is none of {found}");
    }
}

#[test]
fn some_of_both_maps() {
    map_slider(&[0.02], &[0.7, 1.0, 1.3]);
    map_slabs(&[1.0, 4.0], &[0.4, 1.5]);
}

/// docs/figures/stability.svg
#[test]
#[ignore = "docs/figures/stability.svg; a minute"]
fn maps_of_stability() {
    println!("docs/figures/stability.svg\n\n| map | x | y | growth, theory | growth |\n|---|---|---|---|---|");
    map_slider(&[0.005, 0.01, 0.02, 0.04, 0.08], &[0.6, 0.8, 0.88, 0.98, 1.1, 1.25, 1.5, 2.0]);
    map_slabs(&[0.5, 1.0, 2.0, 4.0], &[0.3, 0.5, 0.8, 1.3, 2.2, 4.0, 8.0]);
}
