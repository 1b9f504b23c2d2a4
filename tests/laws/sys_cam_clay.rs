//! SYS Cam-clay against modified Cam-clay, against its rate equations and a closed form.

use crate::bulk::admits;
use crate::common::{close, with};
use crate::random::Random;
use fecontact::laws::bulk::{BulkResponse, CauchyStress, Material, MaterialParameters, Straining};
use nalgebra::{Matrix2, Vector2, Vector5};
use serde_json::{Value, json};
use std::f64::consts::PI;

const M: f64 = 1.2;
const LAMBDA: f64 = 0.10;
const KAPPA: f64 = 0.02;
const G: f64 = 3000.0;
const P_0: f64 = 100.0;
/// D = (λ̂ − κ̂)/M
const D: f64 = (LAMBDA - KAPPA) / M;

fn build(given: &Value) -> Box<dyn Material> {
    serde_json::from_value::<MaterialParameters>(given.clone()).expect("well formed").build().expect("allowed")
}

/// λ̂ and κ̂ of the Kirchhoff stress are those above.
fn given(model: &str, more: &Value) -> Value {
    let [lambda, kappa] = [LAMBDA, KAPPA].map(|slope| slope / (1.0 + slope));
    with(json!({"model": model, "lambda": lambda, "kappa": kappa, "M": M, "G": G, "p_min": 1.0}), more)
}

fn isotropic() -> CauchyStress {
    CauchyStress { xx: -P_0, yy: -P_0, zz: -P_0, xy: 0.0 }
}

struct Point {
    law: Box<dyn Material>,
    old: Vec<f64>,
}

impl Point {
    fn new(model: &str, more: &Value, stress: CauchyStress) -> Self {
        let law = build(&given(model, more));
        let mut old = vec![0.0; law.description().variables.len()];
        law.begin(Vector2::zeros(), &stress, &mut old).expect("it carries its pressure");
        Self { law, old }
    }

    fn at(&self, f: &Vector5<f64>) -> Option<(BulkResponse, Vec<f64>)> {
        let mut new = self.old.clone();
        let straining = with!(Straining::new(plane(f), &self.old), stretch: f[4], dt: 1.0);
        let answer = self.law.respond(&straining, &mut new);
        answer.ok().map(|answer| (answer, new))
    }

    fn go(&mut self, f: &Vector5<f64>) -> BulkResponse {
        let (answer, new) = self.at(f).expect("an answer");
        self.old = new;
        answer
    }

    fn variable(&self, name: &str) -> f64 {
        self.old[self.law.description().variables.iter().position(|own| *own == name).expect(name)]
    }

    /// p and q of the Kirchhoff stress of the committed state.
    fn invariants(&self) -> [f64; 2] {
        let [xx, yy, zz, xy] = ["tau_xx", "tau_yy", "tau_zz", "tau_xy"].map(|name| self.variable(name));
        let p = -(xx + yy + zz) / 3.0;
        let squares = [xx, yy, zz].iter().map(|part| (part + p).powi(2)).sum::<f64>() + 2.0 * xy * xy;
        [p, (1.5 * squares).sqrt()]
    }
}

fn plane(f: &Vector5<f64>) -> Matrix2<f64> {
    Matrix2::from_column_slice(&f.as_slice()[..4])
}

/// Stretches by logarithmic strains along 1, 2 and 3.
fn principal(strains: [f64; 3]) -> Vector5<f64> {
    let [a, b, c] = strains.map(f64::exp);
    Vector5::new(a, 0.0, 0.0, b, c)
}

/// Triaxial, by the volume and the shear strain, both positive in compression.
fn triaxial(volume: f64, shear: f64) -> Vector5<f64> {
    let radial = -volume / 3.0 + 0.5 * shear;
    principal([radial, -volume / 3.0 - shear, radial])
}

/// Without m, structure and rotation it is modified Cam-clay, by the same equations that it solves with them: stress, tangent, energy and
/// dissipation over random histories.
#[test]
fn without_a_skeleton_it_is_cam_clay() {
    let mut random = Random(3);
    let mut compared = 0;
    for size in [0.002, 0.01, 0.03] {
        for start in [json!({"p_c": 130.0}), json!({"OCR": 3.0})] {
            for _ in 0..60 {
                let [mut plain, mut skeleton] =
                    ["cam_clay", "sys_cam_clay"].map(|model| Point::new(model, &start, isotropic()));
                let (mut f, mut h) = (Matrix2::identity(), 1.0);
                for _ in 0..5 {
                    f = (Matrix2::identity() + Matrix2::from_fn(|_, _| random.between(-size, size))) * f;
                    h *= 1.0 + random.between(-size, size);
                    let f = Vector5::new(f.m11, f.m21, f.m12, f.m22, h);
                    let (Some((a, plain_new)), Some((b, new))) = (plain.at(&f), skeleton.at(&f)) else { break };
                    let scale = plain.invariants().iter().sum::<f64>() + 1.0;
                    assert!((a.stress - b.stress).amax() < 1e-10 * scale, "{} {}", a.stress, b.stress);
                    assert!((a.tangent - b.tangent).amax() < 1e-8 * G, "{} {}", a.tangent, b.tangent);
                    close("energy", b.energy, a.energy, 1e-10 * P_0);
                    close("dissipation", b.dissipation, a.dissipation, 1e-10 * P_0);
                    compared += usize::from(a.dissipation > 0.0);
                    (plain.old, skeleton.old) = (plain_new, new);
                }
            }
        }
    }
    assert!(compared > 700, "{compared}");
}

/// m → ∞ is Cam-clay: where soil within its yield surface is loaded, unloaded and loaded again, the difference falls as 1/m.
#[test]
fn a_fast_loss_of_overconsolidation_is_cam_clay() {
    let path = [(0.0, 0.04), (-0.002, 0.034), (0.004, 0.06)];
    let stress = |model: &str, more: Value| {
        let mut point = Point::new(model, &more, isotropic());
        let mut from = (0.0, 0.0);
        for to in path {
            for k in 1..=200 {
                let t = f64::from(k) / 200.0;
                point.go(&triaxial(from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1)));
            }
            from = to;
        }
        Vector2::from(point.invariants())
    };
    let exact = stress("cam_clay", json!({"OCR": 1.8}));
    let errors = [1e3, 1e4, 1e5].map(|m| (stress("sys_cam_clay", json!({"OCR": 1.8, "m": m})) - exact).amax());
    assert!(errors[0] < 0.05 * P_0 && errors[1] < 0.2 * errors[0] && errors[2] < 0.2 * errors[1], "{errors:?}");
}

/// Constants of a soil, as in a case.
#[derive(Clone, Copy)]
struct Soil {
    over: f64,
    structure: f64,
    m: f64,
    a: f64,
    c_s: f64,
    b_r: f64,
    m_b: f64,
}

/// A clay with structure that loses it slowly, one that was preloaded, and a set like that of a sand: illustrations.
const CLAY: Soil = Soil { over: 1.0, structure: 8.0, m: 5.0, a: 0.6, c_s: 1.0, b_r: 0.0, m_b: 1.0 };
const STIFF: Soil = Soil { over: 2.0, structure: 1.0, m: 5.0, a: 0.0, c_s: 1.0, b_r: 0.001, m_b: 1.0 };
const SAND: Soil = Soil { over: 1.5, structure: 4.0, m: 0.08, a: 2.0, c_s: 1.0, b_r: 3.0, m_b: 0.8 };
const NATURAL: Soil = Soil { over: 1.4, structure: 5.0, m: 3.0, a: 0.4, c_s: 0.4, b_r: 0.2, m_b: 0.9 };

impl Soil {
    fn point(&self) -> Point {
        let more = json!({"OCR": self.over, "structure": self.structure, "m": self.m, "a": self.a, "c_s": self.c_s, "b_r": self.b_r,
                          "m_b": self.m_b});
        Point::new("sys_cam_clay", &more, isotropic())
    }

    /// The triaxial state at the start.
    fn start(&self) -> Triaxial {
        Triaxial {
            p: P_0,
            q: 0.0,
            ratio: 1.0 / self.over,
            structure: 1.0 / self.structure,
            p_c: P_0 * self.over / self.structure,
            beta: 0.0,
        }
    }
}

/// A triaxial state, β being that of the axis: √(3/2) ‖β‖ with its sign.
#[derive(Clone, Copy, Debug)]
struct Triaxial {
    p: f64,
    q: f64,
    ratio: f64,
    structure: f64,
    p_c: f64,
    beta: f64,
}

impl Triaxial {
    fn along(&self, rate: &Self, t: f64) -> Self {
        Self {
            p: self.p + t * rate.p,
            q: self.q + t * rate.q,
            ratio: self.ratio + t * rate.ratio,
            structure: self.structure + t * rate.structure,
            p_c: self.p_c + t * rate.p_c,
            beta: self.beta + t * rate.beta,
        }
    }

    /// Rates with strains of a rate: the consistency of
    /// ln p + ln(1 + η*²/M²) + ln R* − ln R − ln p_c = 0, with signed η − β in the axis.
    fn rate(&self, soil: &Soil, [volume, shear]: [f64; 2]) -> Self {
        let Self { p, q, ratio, structure, p_c, beta } = *self;
        let bulk = p / KAPPA;
        let (eta, apart) = (q / p, q / p - beta);
        let whole = M * M + apart * apart;
        let by_p = (M * M - eta * eta + beta * beta) / (p * whole);
        let by_q = 2.0 * apart / (p * whole);
        let by_beta = -2.0 * apart / whole;
        let length = (by_p * by_p / 3.0 + 1.5 * by_q * by_q).sqrt();
        let turning = soil.b_r / D * by_q.abs() * (soil.m_b * apart - (2.0f64 / 3.0).sqrt() * apart.abs() * beta);
        let decay = soil.a / D * structure * (1.0 - structure) * (soil.c_s * by_q.abs() + (1.0 - soil.c_s) * by_p);
        let loosening = -soil.m / D * ratio.ln() * length;
        let hardening = -by_beta * turning - decay / structure + loosening / ratio + by_p / (LAMBDA - KAPPA);
        let loading = by_p * bulk * volume + by_q * 3.0 * G * shear;
        if loading <= 0.0 {
            let [p_rate, q_rate] = [bulk * volume, 3.0 * G * shear];
            let ratio = ratio * (by_p * p_rate + by_q * q_rate);
            return Self { p: p_rate, q: q_rate, ratio, structure: 0.0, p_c: 0.0, beta: 0.0 };
        }
        let slip = loading / (by_p * by_p * bulk + 3.0 * G * by_q * by_q + hardening);
        Self {
            p: bulk * (volume - slip * by_p),
            q: 3.0 * G * (shear - slip * by_q),
            ratio: slip * loosening,
            structure: slip * decay,
            p_c: p_c * slip * by_p / (LAMBDA - KAPPA),
            beta: slip * turning,
        }
    }

    /// After strains, by the method of Runge and Kutta.
    fn after(mut self, soil: &Soil, strains: [f64; 2], parts: u32) -> Self {
        let h = 1.0 / f64::from(parts);
        for _ in 0..parts {
            let a = self.rate(soil, strains);
            let b = self.along(&a, 0.5 * h).rate(soil, strains);
            let c = self.along(&b, 0.5 * h).rate(soil, strains);
            let d = self.along(&c, h).rate(soil, strains);
            for (rate, share) in [(a, 1.0), (b, 2.0), (c, 2.0), (d, 1.0)] {
                self = self.along(&rate, share * h / 6.0);
            }
        }
        self
    }
}

/// Triaxial paths of the law, in increments of some 1e-4, against the rate equations: undrained to 10 %, undrained cycles, compression without
/// lateral strain.
#[test]
fn triaxial_paths_are_those_of_the_rate_equations() {
    let undrained = vec![(0.0, 0.01), (0.0, 0.03), (0.0, 0.10)];
    let cycles = vec![(0.0, 0.004), (0.0, -0.004), (0.0, 0.004), (0.0, -0.004), (0.0, 0.02)];
    let compressed = vec![(0.02, 0.04 / 3.0), (0.015, 0.01), (0.08, 0.16 / 3.0)];
    for (name, soil) in [("clay", CLAY), ("stiff", STIFF), ("sand", SAND), ("natural", NATURAL)] {
        for (path, ends) in [("undrained", &undrained), ("cycles", &cycles), ("compressed", &compressed)] {
            let (mut point, mut exact, mut from) = (soil.point(), soil.start(), (0.0, 0.0));
            for to in ends {
                let strains: [f64; 2] = [to.0 - from.0, to.1 - from.1];
                let parts = 40 + (strains[0].abs().max(strains[1].abs()) * 1e4) as u32;
                exact = exact.after(&soil, strains, 40 * parts);
                for k in 1..=parts {
                    let t = f64::from(k) / f64::from(parts);
                    point.go(&triaxial(from.0 + t * strains[0], from.1 + t * strains[1]));
                }
                from = *to;
                let [p, q] = point.invariants();
                let near = |what: &str, value: f64, exact: f64, scale: f64| {
                    close(&format!("{what} of {name}, {path}, at {to:?}"), value, exact, 5e-3 * scale);
                };
                let size = exact.p.hypot(exact.q);
                near("p", p, exact.p, size);
                near("q", q, exact.q.abs(), size);
                near("R", point.variable("R"), exact.ratio, 1.0);
                near("R*", point.variable("R_star"), exact.structure, 1.0);
                near("p_c", point.variable("p_c"), exact.p_c, exact.p_c);
                near("β", -1.5 * point.variable("beta_yy"), exact.beta, 1.0);
            }
        }
    }
}

/// Undrained soil with structure ends at the strength of the remoulded soil, p_f = p₀ (p_c/2p₀)^Λ and q = M p_f, Λ = 1 − κ̂/λ̂, whatever the way
/// there.
#[test]
fn undrained_strength_is_that_of_the_remoulded_soil() {
    for soil in [Soil { structure: 3.0, a: 1.5, ..CLAY }, Soil { over: 1.6, structure: 3.0, a: 1.5, c_s: 0.8, ..CLAY }]
    {
        let mut point = soil.point();
        let mut most = 0.0f64;
        for k in 1..=4000 {
            point.go(&triaxial(0.0, 0.6 * f64::from(k) / 4000.0));
            most = most.max(point.invariants()[1]);
        }
        let p_f = P_0 * (soil.over / soil.structure / 2.0).powf(1.0 - KAPPA / LAMBDA);
        let [p, q] = point.invariants();
        close("p", p, p_f, 2e-3 * p_f);
        close("q", q, M * p_f, 2e-3 * p_f);
        assert!(most > 1.3 * q, "it softens from {most} to {q}");
    }
}

/// Components xx, yy, zz, xy of small strains of a soil of stiffness and slopes such that finite strains do not matter: the rate equations
/// as tensors.
#[derive(Clone, Copy)]
struct Tensors {
    p: f64,
    s: [f64; 4],
    beta: [f64; 4],
    ratio: f64,
    structure: f64,
    p_c: f64,
}

fn dot(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * a[3] * b[3]
}

/// Strains of the soil below are by so much smaller than those of others.
const SMALL: f64 = 0.01;

impl Tensors {
    fn along(&self, rate: &Self, t: f64) -> Self {
        let sum = |a: [f64; 4], b: [f64; 4]| std::array::from_fn(|k| a[k] + t * b[k]);
        Self {
            p: self.p + t * rate.p,
            s: sum(self.s, rate.s),
            beta: sum(self.beta, rate.beta),
            ratio: self.ratio + t * rate.ratio,
            structure: self.structure + t * rate.structure,
            p_c: self.p_c + t * rate.p_c,
        }
    }

    /// Rates while it yields.
    fn rate(&self, soil: &Soil, strain: &[f64; 4]) -> Self {
        let Self { p, s, beta, ratio, structure, p_c } = *self;
        let (bulk, shear, plastic, d) = (p / (SMALL * KAPPA), G / SMALL, SMALL * (LAMBDA - KAPPA), SMALL * D);
        let third = (strain[0] + strain[1] + strain[2]) / 3.0;
        let shape: [f64; 4] = std::array::from_fn(|k| if k < 3 { strain[k] - third } else { strain[k] });
        let apart: [f64; 4] = std::array::from_fn(|k| s[k] / p - beta[k]);
        let size = dot(&apart, &apart).sqrt();
        let whole = M * M + 1.5 * size * size;
        let by_p = (M * M - 1.5 * size * size - 3.0 * dot(&apart, &beta)) / (p * whole);
        let by_s = apart.map(|part| 3.0 * part / (p * whole));
        let sheared = (2.0 / 3.0 * dot(&by_s, &by_s)).sqrt();
        let length = (by_p * by_p / 3.0 + dot(&by_s, &by_s)).sqrt();
        let turning: [f64; 4] =
            std::array::from_fn(|k| soil.b_r / d * sheared * (soil.m_b * apart[k] - size * beta[k]));
        let decay = soil.a / d * structure * (1.0 - structure) * (soil.c_s * sheared + (1.0 - soil.c_s) * by_p);
        let loosening = -soil.m / d * ratio.ln() * length;
        let hardening = 3.0 * dot(&apart, &turning) / whole - decay / structure + loosening / ratio + by_p / plastic;
        let loading = -3.0 * third * bulk * by_p + 2.0 * shear * dot(&by_s, &shape);
        assert!(loading > 0.0, "the path loads");
        let slip = loading / (bulk * by_p * by_p + 2.0 * shear * dot(&by_s, &by_s) + hardening);
        Self {
            p: bulk * (-3.0 * third - slip * by_p),
            s: std::array::from_fn(|k| 2.0 * shear * (shape[k] - slip * by_s[k])),
            beta: turning.map(|part| slip * part),
            ratio: slip * loosening,
            structure: slip * decay,
            p_c: p_c * slip * by_p / plastic,
        }
    }
}

/// A path whose principal axes turn, while the soil has a rotation of its own: stress and β, which are not coaxial, against the rate equations of
/// tensors at small strains.
#[test]
fn a_path_that_turns_is_that_of_the_rate_equations() {
    let soil = Soil { b_r: 1.5, ..NATURAL };
    let mut json = given(
        "sys_cam_clay",
        &json!({"G": G / SMALL, "OCR": soil.over, "structure": soil.structure, "m": soil.m, "a": soil.a, "c_s": soil.c_s,
                "b_r": soil.b_r, "m_b": soil.m_b, "zeta": 0.3}),
    );
    for (key, slope) in [("lambda", SMALL * LAMBDA), ("kappa", SMALL * KAPPA)] {
        json[key] = json!(slope / (1.0 + slope));
    }
    let law = build(&json);
    let stress = CauchyStress { xx: -80.0, yy: -130.0, zz: -90.0, xy: 0.0 };
    let mut old = vec![0.0; law.description().variables.len()];
    law.begin(Vector2::zeros(), &stress, &mut old).expect("a stress that it can have");
    let mut point = Point { law, old };
    let start = |name: &str| point.variable(name);
    let beta = ["beta_xx", "beta_yy", "beta_zz", "beta_xy"].map(start);
    let ([ratio, structure, p_c], p) = (["R", "R_star", "p_c"].map(start), 100.0);
    close("ζ", (1.5 * dot(&beta, &beta)).sqrt(), 0.3, 1e-12);
    close("R", ratio, 1.0 / soil.over, 1e-12);
    let mut exact = Tensors { p, s: [20.0, -30.0, 10.0, 0.0], beta, ratio, structure, p_c };
    // First pressed, then sheared: rates of strain per leg
    let legs = [[0.2, -1.0, 0.0, 0.3], [0.1, -0.3, 0.0, 1.0]].map(|leg| leg.map(|part| 0.03 * SMALL * part));
    let (mut from, parts) = ([0.0; 4], 400);
    for leg in legs {
        for k in 1..=parts {
            let h = 1.0 / f64::from(parts);
            let strain: [f64; 4] = std::array::from_fn(|i| from[i] + leg[i] * f64::from(k) * h);
            let small = Matrix2::new(strain[0], strain[3], strain[3], strain[1]);
            let f = Matrix2::identity() + small + small * small / 2.0;
            point.go(&Vector5::new(f.m11, f.m21, f.m12, f.m22, strain[2].exp()));
            for _ in 0..20 {
                let h = h / 20.0;
                let a = exact.rate(&soil, &leg);
                let b = exact.along(&a, 0.5 * h).rate(&soil, &leg);
                exact = exact.along(&b, h);
            }
        }
        from = std::array::from_fn(|i| from[i] + leg[i]);
        for (k, name) in ["xx", "yy", "zz", "xy"].into_iter().enumerate() {
            let whole = exact.s[k] - if k < 3 { exact.p } else { 0.0 };
            close(&format!("τ_{name}"), point.variable(&format!("tau_{name}")), whole, 5e-3 * exact.p);
            close(&format!("β_{name}"), point.variable(&format!("beta_{name}")), exact.beta[k], 5e-3);
        }
        close("R", point.variable("R"), exact.ratio, 5e-3);
        close("R*", point.variable("R_star"), exact.structure, 5e-3);
        close("p_c", point.variable("p_c"), exact.p_c, 5e-3 * exact.p_c);
    }
    let off = exact.s[3] * (exact.beta[0] - exact.beta[1]) - exact.beta[3] * (exact.s[0] - exact.s[1]);
    assert!(off.abs() > 0.05 * exact.p, "s and β have different axes: {off}");
}

/// A reversal of shear in one increment, and in more, elastic up to where R is least: stress near that of the rate equations (backward
/// Euler is of first order), and no energy from nothing.
#[test]
fn a_reversal_in_one_increment_finds_where_it_yields() {
    for soil in [STIFF, NATURAL] {
        let exact = soil.start().after(&soil, [0.0, 0.004], 4000).after(&soil, [0.0, -0.008], 8000);
        for (parts, share) in [(1, 0.06), (8, 0.02), (64, 0.004)] {
            let mut point = soil.point();
            for k in 1..=200 {
                point.go(&triaxial(0.0, 0.004 * f64::from(k) / 200.0));
            }
            for k in 1..=parts {
                let answer = point.go(&triaxial(0.0, 0.004 - 0.008 * f64::from(k) / f64::from(parts)));
                assert!(answer.dissipation >= 0.0, "{}", answer.dissipation);
            }
            close("q", point.invariants()[1], -exact.q, share * exact.q.abs());
            close("R", point.variable("R"), exact.ratio, 0.01);
        }
    }
}

/// However far an increment goes, its answer has 0 < R ≤ 1 and 0 < R* ≤ 1 and is within the superloading surface, or it is refused.
#[test]
fn a_large_increment_is_answered_or_refused() {
    let mut random = Random(5);
    let (mut answered, mut refused) = (0, 0);
    for walk in 0..600 {
        let soil = [CLAY, STIFF, SAND, NATURAL][walk % 4];
        let mut point = soil.point();
        let (mut f, size) = (Matrix2::identity(), random.magnitude(-3.0, -0.5));
        for _ in 0..15 {
            f = (Matrix2::identity() + Matrix2::from_fn(|_, _| random.between(-size, size))) * f;
            let whole = Vector5::new(f.m11, f.m21, f.m12, f.m22, 1.0);
            let Some((_, new)) = point.at(&whole) else {
                refused += 1;
                break;
            };
            (point.old, answered) = (new, answered + 1);
            let mut values = vec![0.0; point.law.description().shown.len()];
            point.law.show(&Straining::new(f, &point.old), &mut values).expect("an answer");
            let [indicator, p_c, ratio, structure] = [values[2], values[5], values[6], values[7]];
            assert!(ratio > 0.0 && ratio <= 1.0 && structure > 0.0 && structure <= 1.0, "{values:?}");
            assert!(indicator < 1e-9 * p_c / structure + 1e-9, "{values:?} at {f}");
        }
    }
    assert!(answered > 5000 && (10..250).contains(&refused), "{answered} {refused}");
}

/// Torn apart to one side it stays a law, and can be pressed again.
#[test]
fn tension_leaves_no_stress() {
    for soil in [CLAY, STIFF, SAND, NATURAL] {
        let mut point = soil.point();
        for k in 1..=600 {
            point.go(&principal([0.001 * f64::from(k), 0.0, 0.0]));
        }
        let [p, q] = point.invariants();
        assert!(p > 0.0 && p < 5.0 && q < 5.0, "{p} {q}");
        for k in 1..=700 {
            point.go(&principal([0.6 - 0.001 * f64::from(k), 0.0, 0.0]));
        }
        assert!(point.invariants()[0] > 10.0);
    }
}

/// Torn apart while it is sheared a little, and pressed again, in increments of any size: every one has an answer, however near to zero its
/// pressure, on or within the superloading surface, and dissipates; finer ones do not fail sooner.
#[test]
fn pressure_may_vanish_in_increments_of_any_size() {
    for soil in [CLAY, STIFF, SAND, NATURAL] {
        for parts in [20, 200, 2000] {
            let mut point = soil.point();
            let mut least = f64::INFINITY;
            for k in 1..=parts {
                let t = f64::from(k) / f64::from(parts);
                let (opened, sheared) = (0.3 * (4.0 * PI * t).sin(), 0.002 * (1.0 - (6.0 * PI * t).cos()));
                let answer = point.go(&triaxial(-opened, sheared));
                assert!(parts < 2000 || answer.dissipation >= -1e-6 * P_0, "{}", answer.dissipation);
                least = least.min(point.invariants()[0]);
            }
            assert!(least > 0.0 && least < 0.1, "{least}");
        }
    }
}

/// What cannot be is refused with the key, and an initial stress with the reason.
#[test]
fn what_cannot_be_is_refused() {
    let refused = |more: Value| {
        let given = given("sys_cam_clay", &more);
        let law = serde_json::from_value::<MaterialParameters>(given).expect("well formed").build();
        law.map(drop).expect_err(&more.to_string()).name
    };
    for (key, change) in [
        ("m", json!({"m": 0.0})),
        ("structure", json!({"structure": 0.9})),
        ("a", json!({"a": -1.0})),
        ("c_s", json!({"c_s": 1.1})),
        ("b_r", json!({"b_r": -1.0})),
        ("m_b", json!({"b_r": 1.0})),
        ("m_b", json!({"m_b": -1.0})),
        ("zeta", json!({"zeta": 1.2})),
        ("OCR", json!({"OCR": 0.5})),
        ("p_c", json!({"p_c": 0.5, "OCR": null})),
        ("lambda", json!({"lambda": 0.01})),
    ] {
        let more = with(json!({"OCR": 1.0}), &change);
        assert_eq!(refused(more), key, "{change}");
    }
    let law = build(&given("sys_cam_clay", &json!({"p_c": 50.0, "structure": 1.5})));
    // P of this stress is p = 100, and p_c/R* = 75: p_c must be 100/1.5
    let why = admits(&*law, &isotropic()).expect_err("p_c is too small").to_string();
    assert!(why.contains("p_c of 66.66"), "{why}");
    let law = build(&given("sys_cam_clay", &json!({"OCR": 1.0, "zeta": 0.2})));
    let why = admits(&*law, &isotropic()).expect_err("no direction").to_string();
    assert!(why.contains("zeta"), "{why}");
    let softens = |more: Value| build(&given("sys_cam_clay", &more)).description().concern.map(String::from);
    assert!(softens(json!({"OCR": 1.0, "structure": 2.0, "a": 0.5})).is_some_and(|why| why.contains("structure")));
    assert!(softens(json!({"OCR": 3.0, "m": 1.0})).is_some());
    assert!(softens(json!({"OCR": 1.0, "m": 1.0})).is_none());
}
