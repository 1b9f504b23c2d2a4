//! Laws whose pores hold a fluid that cannot drain: tangents against differences, energy, closed forms.

use crate::common::close;
use crate::random::Random;
use fecontact::laws::bulk::{
    BodyLaw, BulkLaw, BulkResponse, CauchyStress, Material, MaterialFailure, MaterialParameters, PORE_PRESSURE,
    PoreFluid, Straining, Surroundings,
};
use nalgebra::{Matrix2, Matrix5, Vector2, Vector5};
use serde_json::{Value, json};

/// K_w/n, the initial pressure of the fluid, and the pressure at which it cavitates.
const MODULUS: f64 = 400.0;
const P_W0: f64 = 0.2;
const CAVITATION: f64 = -0.5;

fn build(given: Value) -> Box<dyn Material> {
    serde_json::from_value::<MaterialParameters>(given).expect("well formed").build().expect("allowed")
}

/// A law with a fluid in its pores.
fn undrained(law: Box<dyn Material>, modulus: f64, cavitation: Option<f64>) -> Option<BodyLaw> {
    BodyLaw::new(law, Surroundings::default().fluid(PoreFluid { modulus, cavitation }))
}

fn laws() -> Vec<(&'static str, BodyLaw)> {
    let clay =
        json!({"model": "cam_clay", "lambda": 0.1, "kappa": 0.03, "M": 1.1, "G": 20.0, "p_c": 0.4, "p_min": 0.01});
    let skeleton = json!({"model": "sys_cam_clay", "lambda": 0.1, "kappa": 0.03, "M": 1.1, "G": 20.0, "OCR": 1.4, "p_min": 0.01,
                          "structure": 3.0, "m": 2.0, "a": 0.5, "b_r": 0.2, "m_b": 0.8});
    [
        ("hencky", json!({"model": "hencky", "E": 100.0, "nu": 0.3}), None),
        ("neo-Hookean", json!({"model": "neo_hookean", "E": 100.0, "nu": 0.3}), Some(CAVITATION)),
        ("linear", json!({"model": "linear", "E": 100.0, "nu": 0.3}), None),
        ("hexagon", json!({"model": "mohr_coulomb", "E": 100.0, "nu": 0.3, "c": 0.1, "phi": 30, "psi": 10}), None),
        ("clay", clay, Some(CAVITATION)),
        ("skeleton", skeleton, None),
    ]
    .into_iter()
    .map(|(name, given, least)| (name, undrained(build(given), MODULUS, least).expect("every section")))
    .collect()
}

fn start(law: &BodyLaw) -> Vec<f64> {
    let mut variables = vec![0.0; law.description().variables.len()];
    let stress = match law.description().holds_initial_stress {
        true => CauchyStress { xx: -0.3, yy: -0.3, zz: -0.3, xy: 0.0 },
        false => CauchyStress::default(),
    };
    law.begin(Vector2::zeros(), &stress, &mut variables).expect("a stress that it can have");
    law.description().slot(&[PORE_PRESSURE]).expect("it has one").set(&mut variables, P_W0);
    variables
}

fn plane(f: &Vector5<f64>) -> Matrix2<f64> {
    Matrix2::from_column_slice(&f.as_slice()[..4])
}

fn at(law: &BodyLaw, f: &Vector5<f64>, old: &[f64]) -> Result<(BulkResponse, Vec<f64>), MaterialFailure> {
    let mut new = vec![0.0; old.len()];
    let straining = with!(Straining::new(plane(f), old), stretch: f[4], dt: 0.1);
    law.respond(&straining, &mut new).map(|answer| (answer, new))
}

fn pore_pressure(law: &BodyLaw, f: &Vector5<f64>, old: &[f64]) -> f64 {
    let mut values = vec![f64::NAN; law.description().shown.len()];
    assert_eq!(law.description().shown.last(), Some(&"pore_pressure"));
    law.show(&with!(Straining::new(plane(f), old), stretch: f[4]), &mut values).expect("an answer");
    values[values.len() - 1]
}

/// Stress and tangent are the law's and the fluid's, the fluid's stress being −p_w 1, p_w = p_w0 − (K_w/n) ln J ≥ p_cav.
#[test]
fn stress_is_effective_less_the_pressure_and_the_tangent_is_exact() {
    let mut random = Random(3);
    for (name, law) in laws() {
        let (mut cavitated, mut compared) = (0, 0);
        while compared < 100 {
            let old = start(&law);
            let f = Vector5::new(1.0, 0.0, 0.0, 1.0, 1.0) + Vector5::from_fn(|_, _| random.between(-0.004, 0.004));
            let Ok((answer, new)) = at(&law, &f, &old) else { continue };
            let jacobian = plane(&f).determinant() * f[4];
            let expansion = if name == "linear" { f[0] + f[3] + f[4] - 3.0 } else { jacobian.ln() };
            let mut p_w = P_W0 - MODULUS * expansion;
            let least = if ["neo-Hookean", "clay"].contains(&name) { CAVITATION } else { f64::NEG_INFINITY };
            if (p_w - least).abs() < 1e-2 {
                continue; // a difference across the kink says nothing
            }
            cavitated += usize::from(p_w < least);
            p_w = p_w.max(least);
            close(name, pore_pressure(&law, &f, &new), p_w, 1e-11);
            let columns: Vec<Vector5<f64>> = (0..5)
                .map(|column| {
                    let [mut back, mut ahead] = [f; 2];
                    (back[column], ahead[column]) = (f[column] - 1e-6, f[column] + 1e-6);
                    let [back, ahead] = [back, ahead].map(|f| at(&law, &f, &old).expect("near it").0.stress);
                    (ahead - back) / 2e-6
                })
                .collect();
            let error = (answer.tangent - Matrix5::from_columns(&columns)).amax();
            // Of laws that yield, an edge of their surface may lie between.
            if law.description().flow.is_none() || error < 1e-3 {
                assert!(error < 1e-6 * MODULUS, "{name}: {error} at {f}");
                compared += 1;
            }
        }
        assert_eq!(cavitated > 10, ["neo-Hookean", "clay"].contains(&name), "{name}: {cavitated}");
    }
}

/// Work is stored or dissipated; what the fluid stores comes back, cavitated or not.
#[test]
fn energy_is_balanced() {
    for (name, law) in laws() {
        let along =
            |t: f64| Vector5::new(1.0 + 0.012 * t * (1.0 - 1.4 * t), 0.0, 0.006 * t, 1.0 - 0.008 * t, 1.0 + 0.002 * t);
        let errors = [200, 2000].map(|parts| {
            let mut old = start(&law);
            let (mut before, mut work, mut dissipated, mut energy) = (along(0.0), 0.0, 0.0, f64::NAN);
            let mut stress = at(&law, &before, &old).expect("an answer").0.stress;
            for k in 1..=parts {
                let f = along(f64::from(k) / f64::from(parts));
                let (answer, new) = at(&law, &f, &old).expect("an answer");
                work += 0.5 * (stress + answer.stress).dot(&(f - before));
                (before, stress, old, energy) = (f, answer.stress, new, answer.energy);
                dissipated += answer.dissipation;
            }
            (work - energy - dissipated).abs()
        });
        assert!(errors[0] < 1e-3 && errors[1] < 0.1 * errors[0] + 1e-8, "{name}: {errors:?}");
    }
}

/// Waves of pressure feel the fluid, those of shear do not; damping is the law's own.
#[test]
fn moduli_and_damping() {
    let own = build(json!({"model": "hencky", "E": 100.0, "nu": 0.3, "density": 2.0}));
    let law = build(json!({"model": "hencky", "E": 100.0, "nu": 0.3, "density": 2.0}));
    let law = undrained(law, MODULUS, None).expect("every section");
    close("λ + 2G", law.description().p_wave_modulus, own.description().p_wave_modulus + MODULUS, 1e-12);
    assert_eq!([law.description().shear_modulus, law.description().density], [own.description().shear_modulus, 2.0]);
    let motion = [&Vector5::new(1.0, 0.0, 0.0, 1.0, 1.0), &Vector5::new(0.1, 0.0, 0.2, 0.3, 0.1)];
    assert_eq!(law.description().viscous_stress(motion), own.description().viscous_stress(motion));
    let soft = build(json!({"model": "linear", "E": 100.0, "nu": 0.3}));
    assert!(undrained(soft, MODULUS, Some(0.0)).is_none());
}

/// Triaxial compression of clay under a constant total lateral stress, K_w/n → ∞: p follows the closed form of undrained Cam-clay at every
/// q, and p_w − p_w0 = p₀ + q/3 − p.
#[test]
fn clay_under_a_constant_lateral_stress() {
    let [lambda, kappa, m, p_0] = [0.1f64, 0.02, 1.2, 100.0];
    let of_cauchy = |slope: f64| slope / (1.0 + slope);
    let given = json!({"model": "cam_clay", "lambda": of_cauchy(lambda), "kappa": of_cauchy(kappa), "M": m, "G": 3000.0,
                       "p_c": p_0, "p_min": 1.0});
    let law = undrained(build(given), 2.2e6 / 0.5, None).expect("every section");
    let mut old = vec![0.0; law.description().variables.len()];
    law.begin(Vector2::zeros(), &CauchyStress { xx: -p_0, yy: -p_0, zz: -p_0, xy: 0.0 }, &mut old)
        .expect("a stress that it can have");
    law.description().slot(&[PORE_PRESSURE]).expect("it has one").set(&mut old, 30.0);
    let total = p_0 + 30.0;
    let mut radial = 0.0f64;
    for k in 1..=1000 {
        let axial = -0.1 * f64::from(k) / 1000.0;
        let mut f = Vector5::zeros();
        for iteration in 0.. {
            assert!(iteration < 50, "no lateral strain at {axial}");
            f = Vector5::new(radial.exp(), 0.0, 0.0, axial.exp(), radial.exp());
            let (answer, new) = at(&law, &f, &old).expect("an answer");
            let rest = answer.stress[0] / (f[3] * f[4]) + total;
            if rest.abs() < 1e-7 {
                old = new;
                break;
            }
            radial -= rest / ((answer.tangent[(0, 0)] + answer.tangent[(0, 4)]) * f[0] / (f[3] * f[4]));
        }
        if k % 100 == 0 {
            let mut values = vec![0.0; law.description().shown.len()];
            law.show(&with!(Straining::new(plane(&f), &old), stretch: f[4]), &mut values).expect("an answer");
            let [p, q, p_w] = [values[3], values[4], values[6]];
            let closed = p_0 * (1.0 + (q / p / m).powi(2)).powf(kappa / lambda - 1.0);
            close("p", p, closed, 5e-3 * closed);
            close("p_w", p_w, 30.0 + p_0 + q / 3.0 - p, 0.01);
        }
    }
}
