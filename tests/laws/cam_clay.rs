//! Modified Cam-clay against closed forms and against its rate equations, which SciPy integrated.

use crate::bulk::{admits, cauchy};
use crate::common::{close, with};
use crate::random::Random;
use fecontact::laws::bulk::{BulkResponse, CauchyStress, LogarithmicBulk, Material, MaterialParameters, Straining};
use nalgebra::{Matrix2, Vector2, Vector5};
use serde_json::{Value, json};

const M: f64 = 1.2;
const LAMBDA: f64 = 0.10;
const KAPPA: f64 = 0.02;
const G: f64 = 3000.0;
const P_0: f64 = 100.0;

fn build(given: Value) -> Box<dyn Material> {
    serde_json::from_value::<MaterialParameters>(given).expect("well formed").build().expect("allowed")
}

/// λ̂ and κ̂ of the Kirchhoff stress are those above.
fn given(p_c: f64) -> Value {
    let [lambda, kappa] = [LAMBDA, KAPPA].map(|slope| slope / (1.0 + slope));
    json!({"model": "cam_clay", "lambda": lambda, "kappa": kappa, "M": M, "G": G, "p_c": p_c, "p_min": 1.0})
}

/// A point under an isotropic pressure at the start.
struct Point {
    law: Box<dyn Material>,
    old: Vec<f64>,
}

impl Point {
    fn new(law: Box<dyn Material>) -> Self {
        let mut old = vec![0.0; law.description().variables.len()];
        let stress = CauchyStress { xx: -P_0, yy: -P_0, zz: -P_0, xy: 0.0 };
        law.begin(Vector2::zeros(), &stress, &mut old).expect("it carries its pressure");
        Self { law, old }
    }

    fn at(&self, f: &Vector5<f64>) -> (BulkResponse, Vec<f64>) {
        let mut new = self.old.clone();
        let plane = Matrix2::from_column_slice(&f.as_slice()[..4]);
        let straining = with!(Straining::new(plane, &self.old), stretch: f[4], dt: 1.0);
        let answer = self.law.respond(&straining, &mut new).expect("an answer");
        (answer, new)
    }

    /// p, q and p_c of the committed state, of the Kirchhoff stress.
    fn shown(&self, f: &Vector5<f64>) -> [f64; 3] {
        let mut values = vec![0.0; self.law.description().shown.len()];
        let plane = Matrix2::from_column_slice(&f.as_slice()[..4]);
        self.law.show(&with!(Straining::new(plane, &self.old), stretch: f[4]), &mut values).expect("an answer");
        [values[3], values[4], values[5]]
    }
}

/// Stretches by logarithmic strains along 1, 2 and 3.
fn principal(strains: [f64; 3]) -> Vector5<f64> {
    let [a, b, c] = strains.map(f64::exp);
    Vector5::new(a, 0.0, 0.0, b, c)
}

/// Λ
const SPRING: f64 = 1.0 - KAPPA / LAMBDA;

/// Undrained, triaxial and in plane strain: p = p₀ (R_oc/(1 + (η/M)²))^Λ at every q once it yields, and with
/// ε_s = (2κ̂Λ/M)(artanh(η/M) − arctan(η/M)) + q/3G its strain; the ends are p_f = p₀ (R_oc/2)^Λ and q = M p_f.
#[test]
fn undrained_shear_is_the_closed_form() {
    for (over, plane_strain) in [(1.0f64, false), (1.0, true), (1.6, false), (3.0, true)] {
        let mut point = Point::new(build(given(over * P_0)));
        let at_yield = M * (over - 1.0).sqrt();
        let strain_of = |eta: f64| {
            let x = eta / M;
            let q = eta * P_0 * (over / (1.0 + x * x)).powf(SPRING);
            let part = |x: f64| x.atanh() - x.atan();
            let plastic = if over > 2.0 { f64::NAN } else { part(x) - part(at_yield / M) };
            2.0 * KAPPA * SPRING / M * plastic + q / (3.0 * G)
        };
        let (parts, mut yielded) = (2000, false);
        for k in 1..=parts {
            // the shear strain ε_s
            let strain = 0.2 * f64::from(k) / f64::from(parts);
            let f = if plane_strain {
                let half = 0.5 * 3f64.sqrt() * strain;
                principal([half, -half, 0.0])
            } else {
                principal([0.5 * strain, -strain, 0.5 * strain])
            };
            point.old = point.at(&f).1;
            let [p, q, _] = point.shown(&f);
            let eta = q / p;
            yielded |= q >= M * P_0 * (over - 1.0).sqrt() * (1.0 - 1e-9);
            if !yielded {
                close("p of elastic shear", p, P_0, 1e-9 * P_0);
            } else if strain > 0.01 {
                let closed = P_0 * (over / (1.0 + (eta / M).powi(2))).powf(SPRING);
                close("p", p, closed, 1e-3 * closed);
            }
            if over < 2.0 && (strain - 0.03).abs() < 1e-9 {
                close("ε_s", strain_of(eta), strain, 5e-3 * strain);
            }
            if k == parts {
                let end = P_0 * (0.5 * over).powf(SPRING);
                close("p_f", p, end, 1e-3 * end);
                close("q_f", q, M * end, 1e-3 * M * end);
            }
        }
    }
}

/// Undrained triaxial compression, normally consolidated: (ε_a, p, q) of the closed form above, solved for the strain.
#[test]
fn undrained_triaxial_numbers() {
    let table = [[0.01, 78.849, 55.646], [0.03, 61.242, 67.588], [0.05, 58.244, 68.671], [0.15, 57.435, 68.922]];
    let mut point = Point::new(build(given(P_0)));
    for k in 1..=1500 {
        let strain = 0.15 * f64::from(k) / 1500.0;
        let f = principal([0.5 * strain, -strain, 0.5 * strain]);
        point.old = point.at(&f).1;
        let [p, q, _] = point.shown(&f);
        for [_, p_exact, q_exact] in table.iter().filter(|row| (row[0] - strain).abs() < 1e-9) {
            close("p", p, *p_exact, 5e-3 * p_exact);
            close("q", q, *q_exact, 5e-3 * q_exact);
        }
    }
}

/// Drained triaxial compression under a constant lateral Cauchy stress: (ε_a, p, q, ln J, p_c), p and q of the Cauchy stress, from
/// dτ = D_ep dε with D_ep = C − C n (C n)ᵀ/(n·C n + p p_c (−tr n)/(λ̂ − κ̂)) and dτ_r = τ_r d ln J, by `scipy.integrate.solve_ivp` to 1e-11.
/// The second is overconsolidated and yields at ε_a = 0.0230545.
#[test]
fn drained_triaxial_is_that_of_the_rate_equations() {
    let normal = [
        [0.02, 116.42000470, 49.26001409, -0.022343918554, 128.00209084],
        [0.05, 129.04582511, 87.13747532, -0.043187368482, 162.72469530],
        [0.10, 142.54218283, 127.62654850, -0.064411812635, 208.05528751],
        [0.20, 156.92959635, 170.78878905, -0.084618477423, 262.80150179],
    ];
    let over = [
        [0.03, 160.84546937, 182.53640810, -0.009772231145, 301.73825813],
        [0.05, 161.85174677, 185.55524030, -0.011041091698, 306.18170933],
        [0.10, 163.68241289, 191.04723866, -0.013319107632, 314.32001802],
        [0.20, 165.53230701, 196.59692103, -0.015581899884, 322.61273744],
    ];
    for (p_c, table) in [(P_0, normal), (3.0 * P_0, over)] {
        let mut point = Point::new(build(given(p_c)));
        let mut radial = 0.0;
        for k in 1..=1000 {
            let strain = 0.2 * f64::from(k) / 1000.0;
            for iteration in 0.. {
                assert!(iteration < 50, "no lateral strain at {strain}");
                let f = principal([radial, -strain, radial]);
                let (answer, new) = point.at(&f);
                // σ_r = P₁₁/(F₂₂ F₃₃)
                let area = f[3] * f[4];
                let rest = answer.stress[0] / area + P_0;
                if rest.abs() < 1e-9 {
                    point.old = new;
                    let sigma_a = answer.stress[3] / (f[0] * f[4]);
                    let (p, q) = ((2.0 * P_0 - sigma_a) / 3.0, -sigma_a - P_0);
                    for row in table.iter().filter(|row| (row[0] - strain).abs() < 1e-9) {
                        close("p", p, row[1], 5e-3 * row[1]);
                        close("q", q, row[2], 5e-3 * row[2]);
                        close("ln J", 2.0 * radial - strain, row[3], 5e-3 * row[3].abs());
                        close("p_c", point.shown(&f)[2], row[4], 5e-3 * row[4]);
                    }
                    break;
                }
                let slope = (answer.tangent[(0, 0)] + answer.tangent[(0, 4)]) * f[0] / area - answer.stress[0] / area;
                radial -= rest / slope;
            }
        }
    }
}

/// Compressed without lateral strain: (ε_a, −τ_a, −τ_r) of the same rate equations. K₀ drifts with a constant G.
#[test]
fn oedometer_is_that_of_the_rate_equations() {
    let table =
        [[0.04, 174.65791326, 113.38836823], [0.08, 260.36369137, 170.63270924], [0.16, 576.67405590, 394.54750240]];
    let mut point = Point::new(build(given(P_0)));
    for k in 1..=320 {
        let strain = 0.16 * f64::from(k) / 320.0;
        let f = principal([0.0, -strain, 0.0]);
        let (answer, new) = point.at(&f);
        point.old = new;
        for row in table.iter().filter(|row| (row[0] - strain).abs() < 1e-9) {
            close("τ_a", -answer.stress[3] * f[3], row[1], 5e-3 * row[1]);
            close("τ_r", -answer.stress[0], row[2], 5e-3 * row[2]);
        }
    }
}

/// Isotropic compression by a decade: ln v falls by λ* ln 10 in Cauchy stress, λ* being what was given, or λ/(1 + e) of a slope of e; back
/// by κ*.
#[test]
fn compression_lines_are_those_given() {
    for (e, share) in [(None, 1.0), (Some(1.5), 0.4)] {
        let mut json = given(P_0);
        (json["lambda"], json["kappa"]) = (json!(0.2), json!(0.05));
        if let Some(e) = e {
            json["e"] = json!(e);
        }
        let mut point = Point::new(build(json));
        let mut strain = 0.0;
        let mut volumes = vec![0.0];
        for (target, parts) in [(10.0 * P_0, 200), (2.0 * P_0, 20)] {
            let from = point.shown(&principal([strain; 3]))[0] * (-3.0 * strain).exp();
            for k in 1..=parts {
                let pressure = from * (target / from).powf(f64::from(k) / f64::from(parts));
                for iteration in 0.. {
                    assert!(iteration < 60);
                    let f = principal([strain; 3]);
                    let (answer, new) = point.at(&f);
                    let sigma = -answer.stress[0] / (f[3] * f[4]);
                    if (sigma / pressure - 1.0).abs() < 1e-11 {
                        point.old = new;
                        break;
                    }
                    let tangent = answer.tangent[(0, 0)] + answer.tangent[(0, 3)] + answer.tangent[(0, 4)];
                    let slope = -tangent / f[0] - 2.0 * sigma;
                    strain -= (sigma - pressure) / slope;
                }
            }
            volumes.push(3.0 * strain);
        }
        close("λ*", (volumes[0] - volumes[1]) / 10f64.ln(), 0.2 * share, 1e-4);
        close("κ*", (volumes[2] - volumes[1]) / 5f64.ln(), 0.05 * share, 1e-9);
    }
}

/// Simple shear of plane strain under a constant σ_n: τ/σ_n comes to M/√3, where an interface of that friction would slip.
#[test]
fn simple_shear_comes_to_the_slope_of_an_interface() {
    let mut point = Point::new(build(given(P_0)));
    let mut height = 1.0;
    let mut ratio = 0.0;
    for k in 1..=2000 {
        let shear = 1.5 * f64::from(k) / 2000.0;
        for iteration in 0.. {
            assert!(iteration < 50, "no height at {shear}");
            let f = Vector5::new(1.0, 0.0, shear, height, 1.0);
            let (answer, new) = point.at(&f);
            // The top keeps its length: σ_n = P₂₂, τ = P₁₂.
            let rest = answer.stress[3] + P_0;
            if rest.abs() < 1e-9 {
                (point.old, ratio) = (new, answer.stress[2] / P_0);
                break;
            }
            height -= rest / answer.tangent[(3, 3)];
        }
    }
    let exact = M / 3f64.sqrt();
    close("τ/σ_n", ratio, exact, 0.02 * exact);
}

/// What every point is given at the start: G of ν and the pressure there, p_c of OCR, and moduli that are told of a mean pressure.
#[test]
fn moduli_and_strength_come_from_the_initial_stress() {
    let [nu, over] = [0.3, 2.5];
    let mut json = given(P_0);
    json.as_object_mut().expect("keys").retain(|key, _| key != "G" && key != "p_c");
    (json["nu"], json["OCR"]) = (json!(nu), json!(over));
    let law = build(json);
    let mut old = vec![0.0; law.description().variables.len()];
    let stress = CauchyStress { xx: -60.0, yy: -120.0, zz: -60.0, xy: 0.0 };
    law.begin(Vector2::zeros(), &stress, &mut old).expect("OCR makes room for it");
    let here = cauchy(&*law, &Matrix2::identity(), &old);
    close("σ_yy", here.yy, -120.0, 1e-10);
    close("σ_xx", here.xx, -60.0, 1e-10);
    let (p, q, bulk) = (80.0, 60.0, 80.0 / KAPPA);
    let shear = 1.5 * (1.0 - 2.0 * nu) / (1.0 + nu) * bulk;
    let of = |name: &str| old[law.description().variables.iter().position(|own| *own == name).expect(name)];
    close("p_c", of("p_c"), over * (p + q * q / (M * M * p)), 1e-10);
    close("G", of("shear_modulus"), shear, 1e-9);
    let message = law.at_pressure(p).expect("they depend on it");
    close("G told", message.description().shear_modulus, shear, 1e-9);
    close("K + 4G/3", message.description().p_wave_modulus, bulk + 4.0 / 3.0 * shear, 1e-9);
    let given = Matrix2::new(1.0 + 1e-7, 0.0, 0.0, 1.0);
    let answer = law.respond(&Straining::new(given, &old), &mut old.clone()).expect("an answer");
    // dP₁₁ = dτ₁₁ − τ₁₁ dF₁₁
    close("C₁₁", (answer.stress[0] - here.xx) / 1e-7, bulk + 4.0 / 3.0 * shear - here.xx, 1e-4 * bulk);
}

/// A body without pressure, a p_c below its stress, and constants out of range are refused with the reason.
#[test]
fn what_cannot_be_is_refused() {
    let law = build(given(P_0));
    let why = admits(&*law, &CauchyStress::default()).expect_err("no pressure").to_string();
    assert!(why.contains("mean pressure of 0,") && why.contains("surcharge"), "{why}");
    let steep = CauchyStress { xx: -40.0, yy: -120.0, zz: -40.0, xy: 0.0 };
    let why = admits(&*law, &steep).expect_err("q is too large").to_string();
    // p + q²/(M² p) = 66.667 + 6400/(1.44·66.667) = 133.333, rounded up
    assert!(why.contains("133.334"), "{why}");
    for (key, change) in [
        ("lambda", json!({"lambda": 0.01})),
        ("lambda", json!({"lambda": 1.2})),
        ("kappa", json!({"kappa": 0.0})),
        ("M", json!({"M": 0.0})),
        ("M", json!({"phi": 20})),
        ("M", json!({"M": null})),
        ("phi", json!({"M": null, "phi": 90})),
        ("G", json!({"nu": 0.3})),
        ("G", json!({"G": -1.0})),
        ("nu", json!({"G": null, "nu": 0.5})),
        ("p_c", json!({"p_c": 0.5})),
        ("p_c", json!({"OCR": 2.0})),
        ("OCR", json!({"p_c": null, "OCR": 0.9})),
        ("p_min", json!({"p_min": 0.0})),
        ("density", json!({"density": -1.0})),
    ] {
        let json = with(given(P_0), &change);
        let refused = serde_json::from_value::<MaterialParameters>(json).expect("well formed").build();
        assert_eq!(refused.map(drop).expect_err(&change.to_string()).name, key, "{change}");
    }
}

/// p = p_m ε_v/κ̂ below p_m, to all digits.
#[test]
fn small_pressures_are_exact() {
    let law = LogarithmicBulk { kappa: KAPPA, floor: 3.0, shear: G };
    for share in [1e-18, 1e-9, 0.3, 1.0] {
        close("p", law.pressure(share * KAPPA)[0], 3.0 * share, 1e-15 * 3.0 * share);
    }
}

/// Torn apart, it has no strength left but stays a law: stress tends to zero, and it can be pressed again.
#[test]
fn tension_leaves_no_stress() {
    let mut point = Point::new(build(given(P_0)));
    let mut f = principal([0.0; 3]);
    for k in 1..=300 {
        f = principal([0.002 * f64::from(k), 0.0, 0.0]);
        point.old = point.at(&f).1;
    }
    let [p, q, _] = point.shown(&f);
    assert!((0.0..1.0).contains(&p) && q < 1.0, "{p} {q}");
    for k in 1..=400 {
        f = principal([0.6 - 0.002 * f64::from(k), 0.0, 0.0]);
        point.old = point.at(&f).1;
    }
    assert!(point.shown(&f)[0] > 10.0);
}

/// However far an increment goes, its answer is on the yield surface, or it is refused: under a stiffness that grows with pressure the
/// trial stress of a few tens of per cent is beyond all bounds.
#[test]
fn a_large_increment_is_answered_or_refused() {
    let law = build(
        json!({"model": "cam_clay", "lambda": 0.1, "kappa": 0.005, "M": M, "G": 320.0, "p_c": 9.0, "p_min": 3.0}),
    );
    let mut random = Random(5);
    let (mut answered, mut refused) = (0, 0);
    for walk in 0..600 {
        let mut old = vec![0.0; law.description().variables.len()];
        law.begin(Vector2::zeros(), &CauchyStress { xx: -1.0, yy: -4.0, zz: -2.0, xy: 0.0 }, &mut old)
            .expect("a stress that it can have");
        let (mut f, size) = (Matrix2::identity(), random.magnitude(-3.0, -0.5));
        let growth = if walk % 3 == 0 { 1.05 } else { 1.0 };
        for _ in 0..15 {
            f = (Matrix2::from_diagonal_element(growth) + Matrix2::from_fn(|_, _| random.between(-size, size))) * f;
            let mut new = old.clone();
            if law.respond(&Straining::new(f, &old), &mut new).is_err() {
                refused += 1;
                break;
            }
            (old, answered) = (new, answered + 1);
            let mut values = vec![0.0; law.description().shown.len()];
            law.show(&Straining::new(f, &old), &mut values).expect("an answer");
            let [indicator, p_c] = [values[2], values[5]];
            assert!(indicator < 1e-9 * p_c + 1e-9, "{values:?} at {f}");
        }
    }
    assert!(answered > 5000 && (10..200).contains(&refused), "{answered} {refused}");
}

/// M = 6 sin φ/(3 − sin φ) is 1.2 for an angle of friction of 30°.
#[test]
fn the_angle_of_friction_is_that_of_compression() {
    let mut by_angle = given(P_0);
    by_angle.as_object_mut().expect("keys").remove("M");
    by_angle["phi"] = json!(30);
    let f = principal([-0.02, 0.01, 0.005]);
    let [by_slope, by_angle] = [given(P_0), by_angle].map(|given| Point::new(build(given)).at(&f).0.stress);
    assert!((by_slope - by_angle).amax() < 1e-12 * by_slope.amax(), "{by_slope} {by_angle}");
}
