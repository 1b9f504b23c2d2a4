//! The bulk laws against their energies, closed forms, differences, and the constants they refuse.

use crate::bulk::{cauchy, in_plane, in_plate};
use fecontact::laws::bulk::{BulkResponse, Material, MaterialFailure, MaterialParameters, MaterialResponse, Straining};
use nalgebra::{Matrix2, Matrix4, Rotation2, Vector4, Vector5};
use serde_json::json;

const MODELS: [&str; 4] = ["linear", "saint_venant_kirchhoff", "neo_hookean", "hencky"];
const E: f64 = 2.0;
const NU: f64 = 0.3;
const LAMBDA: f64 = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU));
const G: f64 = E / (2.0 * (1.0 + NU));

fn material(model: &str) -> Box<dyn Material> {
    let parameters: MaterialParameters = serde_json::from_value(json!({"model": model, "E": E, "nu": NU})).unwrap();
    parameters.build().unwrap()
}

fn rotation(angle: f64) -> Matrix2<f64> {
    Rotation2::new(angle).into_inner()
}

/// F = R(α) diag(λ₁, λ₂) R(β) over stretches from 0.5 to 2: equal, nearly equal and different ones.
fn deformations() -> Vec<Matrix2<f64>> {
    let pairs = [
        (1.0, 1.0),
        (1.0, 1.0 + 1e-10),
        (1.0 + 1e-6, 1.0 - 1e-6),
        (1.02, 0.99),
        (0.7, 0.7),
        (0.7, 0.7 + 1e-8),
        (1.6, 1.6 * 1.1 - 1e-4),
        (1.0, 1.1052),
        (0.5, 2.0),
        (2.0, 2.0),
        (0.5, 0.6),
        (1.3, 0.8),
        (2.0, 1.7),
    ];
    let angles = [0.0, 0.4, 1.9, -2.8];
    let turned =
        |a: f64, b: f64| move |(s, t): (f64, f64)| rotation(a) * Matrix2::from_diagonal(&[s, t].into()) * rotation(b);
    angles.iter().flat_map(|&a| angles.iter().flat_map(move |&b| pairs.map(turned(a, b)))).collect()
}

/// ∂(value)/∂F by central differences, column k + 2L for F_kL.
fn by_difference<const N: usize>(f: &Matrix2<f64>, value: impl Fn(&Matrix2<f64>) -> [f64; N]) -> [[f64; 4]; N] {
    let h = 1e-5;
    let mut derivative = [[0.0; 4]; N];
    for column in 0..4 {
        let (mut hi, mut lo) = (*f, *f);
        hi[column] += h;
        lo[column] -= h;
        for (row, (p, m)) in value(&hi).into_iter().zip(value(&lo)).enumerate() {
            derivative[row][column] = (p - m) / (2.0 * h);
        }
    }
    derivative
}

#[test]
fn stress_is_the_derivative_of_the_energy() {
    for model in MODELS {
        let material = material(model);
        for f in deformations() {
            let [expected] = by_difference(&f, |f| [material.at_once(f).unwrap().energy]);
            let error =
                Vector4::from_column_slice(material.at_once(&f).unwrap().stress.as_slice()) - Vector4::from(expected);
            assert!(error.amax() < 1e-8, "{model} at {f}: {error}");
        }
    }
}

#[test]
fn tangent_is_the_derivative_of_the_stress() {
    for model in MODELS {
        let material = material(model);
        for f in deformations() {
            let rows: [[f64; 4]; 4] =
                by_difference(&f, |f| material.at_once(f).unwrap().stress.as_slice().try_into().unwrap());
            let tangent = material.at_once(&f).unwrap().tangent;
            let error = tangent - Matrix4::from_fn(|i, j| rows[i][j]);
            assert!(error.amax() < 2e-8, "{model} at {f}: {error}");
            assert!((tangent - tangent.transpose()).amax() < 1e-13 * tangent.amax(), "{model}: not symmetric");
        }
    }
}

#[test]
fn rotation_causes_no_stress() {
    for model in &MODELS[1..] {
        let material = material(model);
        for step in -20..=20 {
            let response = material.at_once(&rotation(0.157 * f64::from(step))).unwrap();
            assert!(response.stress.amax() < 2e-15 * E, "{model}: {}", response.stress);
            assert!(cauchy(&*material, &rotation(0.157 * f64::from(step)), &[]).zz.abs() < 2e-15 * E);
            assert!(response.energy.abs() < 1e-30 * E, "{model}: {}", response.energy);
        }
    }
    let strained = material("linear").at_once(&rotation(0.5)).unwrap();
    assert!(strained.stress.amax() > 0.1 * E, "the linear law is for small rotations only");
}

#[test]
fn stress_turns_with_the_body() {
    let q = rotation(1.234);
    for model in &MODELS[1..] {
        let material = material(model);
        for f in deformations() {
            let (here, turned) = (material.at_once(&f).unwrap(), material.at_once(&(q * f)).unwrap());
            let error = (turned.stress - q * here.stress).amax();
            assert!(error < 1e-14 * (E + here.stress.amax()), "{model} at {f}: {error}");
            let [across, after] = [f, q * f].map(|f| cauchy(&*material, &f, &[]).zz);
            assert!((after - across).abs() < 1e-14 * (E + across.abs()));

            let moment = here.stress * f.transpose();
            assert!((moment - moment.transpose()).amax() < 1e-14 * (E + moment.amax()), "{model}: P Fᵀ not symmetric");
        }
    }
}

#[test]
fn all_laws_are_linear_at_small_strain_to_the_last_digits() {
    let h = Matrix2::new(0.3, 0.8, -0.4, -0.7);
    let linear = material("linear");
    for model in MODELS {
        let material = material(model);
        let at_rest = material.at_once(&Matrix2::identity()).unwrap();
        assert_eq!(at_rest.stress, Matrix2::zeros(), "{model}");
        assert_eq!(at_rest.energy, 0.0);
        let difference = at_rest.tangent - linear.at_once(&Matrix2::identity()).unwrap().tangent;
        assert!(difference.amax() < 1e-14 * E, "{model}: {difference}");
        assert!((material.description().p_wave_modulus - (LAMBDA + 2.0 * G)).abs() < 1e-14 * E);
        for size in [1e-3, 1e-5, 1e-7] {
            let f = Matrix2::identity() + size * h;
            let (here, expected) = (material.at_once(&f).unwrap(), linear.at_once(&f).unwrap());
            assert!((here.stress - expected.stress).amax() < 4.0 * E * size * size, "{model} at {size}");
            let [across, of_linear] = [&material, &linear].map(|law| cauchy(&**law, &f, &[]).zz);
            assert!((across - of_linear).abs() < 4.0 * E * size * size);
            assert!((here.energy - expected.energy).abs() < 4.0 * E * size.powi(3), "{model} at {size}");
        }
    }
}

/// F = diag(s, 1): (P₁₁, P₂₂, σ_zz, W), each worked out by hand from the law as it is published.
#[test]
fn uniaxial_strain_has_its_closed_form() {
    for s in [0.5, 0.9, 1.0, 1.1, 2.0f64] {
        let (m, ln, green) = (LAMBDA + 2.0 * G, s.ln(), 0.5 * (s * s - 1.0));
        let closed = [
            ("linear", [m * (s - 1.0), LAMBDA * (s - 1.0), LAMBDA * (s - 1.0), 0.5 * m * (s - 1.0).powi(2)]),
            ("saint_venant_kirchhoff", [s * m * green, LAMBDA * green, LAMBDA * green / s, 0.5 * m * green * green]),
            (
                "neo_hookean",
                [
                    G * (s - 1.0 / s) + LAMBDA * ln / s,
                    LAMBDA * ln,
                    LAMBDA * ln / s,
                    0.5 * G * (s * s - 1.0 - 2.0 * ln) + 0.5 * LAMBDA * ln * ln,
                ],
            ),
            ("hencky", [m * ln / s, LAMBDA * ln, LAMBDA * ln / s, 0.5 * m * ln * ln]),
        ];
        for (model, expected) in closed {
            let (law, f) = (material(model), Matrix2::new(s, 0.0, 0.0, 1.0));
            let r = law.at_once(&f).unwrap();
            let actual = [r.stress.m11, r.stress.m22, cauchy(&*law, &f, &[]).zz, r.energy];
            for (a, e) in actual.into_iter().zip(expected) {
                assert!((a - e).abs() < 1e-13 * E, "{model} at {s}: {actual:?} for {expected:?}");
            }
            assert!(r.stress.m12.abs() + r.stress.m21.abs() < 1e-15 * E);
        }
    }
}

/// Pure shear diag(s, 1/s): Hencky's Kirchhoff stress is 2 G ln s, whatever the size of s.
#[test]
fn hencky_is_linear_in_logarithmic_strain() {
    for s in [1.0 + 1e-9, 1.01, 1.5, 4.0f64] {
        let stress = cauchy(&*material("hencky"), &Matrix2::new(s, 0.0, 0.0, 1.0 / s), &[]);
        let expected = 2.0 * G * s.ln();
        assert!((stress.xx - expected).abs() < 1e-7 * expected, "{s}: {stress:?}");
        assert!((stress.yy + expected).abs() < 1e-7 * expected);
    }
}

#[test]
fn cauchy_stress_has_its_pressure_and_von_mises() {
    let stress = cauchy(&*material("neo_hookean"), &Matrix2::new(1.2, 0.3, 0.0, 0.9), &[]);
    let (f, j): (_, f64) = (Matrix2::new(1.2, 0.3, 0.0, 0.9), 1.08);
    let expected =
        (G * (f * f.transpose() - Matrix2::identity()) + Matrix2::from_diagonal_element(LAMBDA * j.ln())) / j;
    assert!((stress.xx - expected.m11).abs() < 1e-14 && (stress.yy - expected.m22).abs() < 1e-14);
    assert!((stress.xy - expected.m12).abs() < 1e-14 && (stress.zz - LAMBDA * j.ln() / j).abs() < 1e-14);
    let p = stress.pressure();
    let deviator = [stress.xx + p, stress.yy + p, stress.zz + p];
    let squares: f64 = deviator.iter().map(|s| s * s).sum::<f64>() + 2.0 * stress.xy * stress.xy;
    assert!(deviator.iter().sum::<f64>().abs() < 1e-14);
    assert!((stress.von_mises() - (1.5 * squares).sqrt()).abs() < 1e-14);
}

#[test]
fn no_volume_is_refused() {
    let nan = Matrix2::new(1.0, f64::NAN, 0.0, 1.0);
    for model in &MODELS[1..] {
        let material = material(model);
        let mirrored = Matrix2::new(-1.0, 0.0, 0.0, 2.0);
        assert_eq!(material.at_once(&mirrored), Err(MaterialFailure::Inverted { jacobian: -2.0 }), "{model}");
        assert!(material.at_once(&Matrix2::zeros()).is_err(), "{model}");
        assert!(material.at_once(&nan).is_err(), "{model}");
        assert!(material.at_once(&Matrix2::new(f64::INFINITY, 0.0, 0.0, 1.0)).is_err(), "{model}");
    }
    assert!(material("linear").at_once(&Matrix2::new(-1.0, 0.0, 0.0, 1.0)).is_ok());
    assert!(material("linear").at_once(&nan).is_err());
}

#[test]
fn impossible_constants_are_named() {
    for (constants, message) in [
        (json!({"E": 0.0, "nu": 0.3}), "\"E\" is 0, but it must be positive and finite"),
        (json!({"E": -5.0, "nu": 0.3}), "\"E\" is -5, but it must be positive and finite"),
        (json!({"E": 1.0, "nu": -1.0}), "\"nu\" is -1, but it must be greater than -1 and less than 0.5"),
        (
            json!({"E": 1.0, "nu": 0.5}),
            "\"nu\" is 0.5, but it must be less than 0.5: an incompressible material is not possible in this \
             formulation; use 0.49 with \"element\": \"f_bar\"",
        ),
        (
            json!({"E": 1.0, "nu": 0.2, "density": -1.0}),
            "\"density\" is -1, but it must be zero or positive, and finite",
        ),
    ] {
        for model in MODELS {
            let mut case = constants.clone();
            case["model"] = json!(model);
            let parameters: MaterialParameters = serde_json::from_value(case).unwrap();
            assert_eq!(parameters.build().unwrap_err().to_string(), message);
        }
    }
    for (key, value) in [("E", f64::NAN), ("E", f64::INFINITY), ("nu", f64::NAN), ("density", f64::INFINITY)] {
        let mut constants = fecontact::laws::bulk::ElasticConstants::new(1.0, 0.2).density(1.0);
        match key {
            "E" => constants.young = value,
            "nu" => constants.poisson = value,
            _ => constants.density = value,
        }
        assert_eq!(MaterialParameters::Hencky(constants).build().unwrap_err().name, key);
    }
}

#[test]
fn known_models_with_all_their_constants_are_read() {
    for (case, good) in [
        (json!({"model": "neo_hookean", "E": 1.0, "nu": 0.3, "density": 2.0}), true),
        (json!({"model": "saint_venant_kirchhoff", "E": 1.0, "nu": 0.3}), true),
        (json!({"model": "neohookean", "E": 1.0, "nu": 0.3}), false),
        (json!({"model": "linear", "E": 1.0}), false),
        (json!({"model": "linear", "E": 1.0, "nu": 0.3, "rho": 1.0}), false),
        (json!({"E": 1.0, "nu": 0.3}), false),
    ] {
        assert_eq!(serde_json::from_value::<MaterialParameters>(case.clone()).is_ok(), good, "{case}");
    }
    let dense: MaterialParameters =
        serde_json::from_value(json!({"model": "hencky", "E": 1.0, "nu": 0.3, "density": 2.5})).unwrap();
    assert_eq!(dense.build().unwrap().description().density, 2.5);
}

// Memory

const TAU: f64 = 0.7;
const G_1: f64 = 2.5 * G;
const LAMBDA_1: f64 = 2.5 * LAMBDA;

fn viscoelastic() -> Box<dyn Material> {
    let given = json!({"model": "viscoelastic", "E": E, "nu": NU, "E_1": 2.5 * E, "tau": TAU});
    serde_json::from_value::<MaterialParameters>(given).unwrap().build().unwrap()
}

/// The answer to an increment, and the variables it leaves.
fn evolve(material: &dyn Material, f: &Matrix2<f64>, dt: f64, old: &[f64]) -> (MaterialResponse, Vec<f64>) {
    let mut new = vec![0.0; old.len()];
    let evolution = in_plane(material, with!(Straining::new(*f, old), dt: dt), &mut new).unwrap();
    (evolution, new)
}

/// From rest along a path, in increments of one length.
fn along(
    material: &dyn Material,
    path: impl Fn(f64) -> Matrix2<f64>,
    end: f64,
    parts: u32,
) -> (MaterialResponse, Vec<f64>, f64) {
    let dt = end / f64::from(parts);
    let (mut last, mut old) = evolve(material, &path(0.0), 0.0, &[0.0; 8]);
    let mut dissipated = 0.0;
    for k in 1..=parts {
        (last, old) = evolve(material, &path(f64::from(k) * dt), dt, &old);
        dissipated += last.dissipation;
    }
    (last, old, dissipated)
}

/// A shear γ at once: P_12 = G γ + (G₁ γ + (λ₁/2 + G₁) γ³) e^(−t/τ), whatever the increments; what was stored in the arm
/// is dissipated.
#[test]
fn a_step_of_shear_relaxes_in_closed_form() {
    let (material, gamma) = (viscoelastic(), 0.4);
    let f = Matrix2::new(1.0, gamma, 0.0, 1.0);
    let (first, start) = evolve(&*material, &f, 0.0, &[0.0; 8]);
    assert_eq!(first.dissipation, 0.0, "no time, no heat");
    let behind = self::material("neo_hookean").at_once(&f).unwrap().energy;
    for parts in [1, 3, 100] {
        let (mut old, mut dissipated) = (start.clone(), 0.0);
        for k in 1..=parts {
            let dt = 2.0 / f64::from(parts);
            let (now, new) = evolve(&*material, &f, dt, &old);
            let time = f64::from(k) * dt;
            let arm = G_1 * gamma + (0.5 * LAMBDA_1 + G_1) * gamma.powi(3);
            let expected = G * gamma + arm * (-time / TAU).exp();
            assert!((now.stress.m12 - expected).abs() < 1e-14 * E, "{}, {expected}", now.stress.m12);
            dissipated += now.dissipation;
            let gone = (first.energy - behind) * (1.0 - (-2.0 * time / TAU).exp());
            assert!((dissipated - gone).abs() < 1e-14 * E, "{dissipated}, {gone}");
            old = new;
        }
    }
}

/// A small stretch at a steady rate v between walls: σ = M v t + M₁ v τ (1 − e^(−t/τ)), M = λ + 2G, in increments of any length;
/// the standard linear solid.
#[test]
fn a_steady_small_stretch_answers_in_closed_form() {
    let (material, v) = (viscoelastic(), 1e-7);
    for parts in [1, 7, 300] {
        let stretched = |t: f64| Matrix2::new(1.0 + v * t, 0.0, 0.0, 1.0);
        let (last, kept, _) = along(&*material, stretched, 2.0, parts);
        let (m, m_1) = (LAMBDA + 2.0 * G, LAMBDA_1 + 2.0 * G_1);
        let expected = v * (m * 2.0 + m_1 * TAU * (1.0 - (-2.0 / TAU).exp()));
        assert!((last.stress.m11 / expected - 1.0).abs() < 2e-6, "{}, {expected}", last.stress.m11);
        let across = v * (LAMBDA * 2.0 + LAMBDA_1 * TAU * (1.0 - (-2.0 / TAU).exp()));
        let found = cauchy(&*material, &stretched(2.0), &kept).zz;
        assert!((found / across - 1.0).abs() < 2e-6, "{found}");
    }
}

#[test]
fn the_tangent_of_an_increment_is_the_derivative_of_its_stress() {
    let material = viscoelastic();
    for (k, f) in deformations().into_iter().enumerate() {
        let (_, old) = evolve(&*material, &Matrix2::new(1.1, 0.2, -0.1, 0.9), 0.3, &[0.0; 8]);
        let dt = [0.0, 1e-6, 0.1, 3.0, 1e4][k % 5];
        let stress = |f: &Matrix2<f64>| evolve(&*material, f, dt, &old).0.stress;
        let rows: [[f64; 4]; 4] = by_difference(&f, |f| stress(f).as_slice().try_into().unwrap());
        let tangent = evolve(&*material, &f, dt, &old).0.tangent;
        let error = tangent - Matrix4::from_fn(|i, j| rows[i][j]);
        assert!(error.amax() < 1e-7, "at {f}, Δt = {dt}: {error}");
    }
}

/// Turned with the observer, the stress turns and what is remembered does not.
#[test]
fn memory_is_the_same_for_every_observer() {
    let material = viscoelastic();
    let (_, old) = evolve(&*material, &Matrix2::new(1.1, 0.2, -0.1, 0.9), 0.3, &[0.0; 8]);
    for f in deformations() {
        let q = rotation(1.1);
        let ((here, kept), (turned, also)) =
            (evolve(&*material, &f, 0.2, &old), evolve(&*material, &(q * f), 0.2, &old));
        assert!((q * here.stress - turned.stress).amax() < 1e-13 * E * (1.0 + here.stress.amax()));
        assert!(kept.iter().zip(&also).all(|(a, b)| (a - b).abs() < 1e-14), "{kept:?}, {also:?}");
    }
}

/// Along a path that bends in strain the error falls by four when increments are halved, and ∮ P:dF is what is dissipated.
#[test]
fn paths_converge_with_the_square_of_the_increment_and_their_work_is_accounted_for() {
    let material = viscoelastic();
    let path = |t: f64| {
        Matrix2::new(1.0 + 0.2 * (3.0 * t).sin(), 0.3 * (5.0 * t).sin(), -0.1 * t, 1.0 - 0.1 * (4.0 * t).sin())
    };
    let stress = |parts: u32| along(&*material, path, 2.0, parts).0.stress;
    let exact = stress(20_000);
    let [coarse, fine] = [100, 200].map(|parts| (stress(parts) - exact).amax());
    assert!((3.8..4.2).contains(&(coarse / fine)), "{coarse:e} became {fine:e}");

    let parts = 20_000;
    let (mut old, mut work, mut heat) = (vec![0.0; 8], 0.0, 0.0);
    let (mut before, mut p) = (Matrix2::identity(), Matrix2::zeros());
    let mut stored = 0.0;
    for k in 1..=parts {
        let f = path(2.0 * f64::from(k) / f64::from(parts));
        let (now, new) = evolve(&*material, &f, 2.0 / f64::from(parts), &old);
        work += 0.5 * (p + now.stress).dot(&(f - before));
        assert!(now.dissipation >= 0.0, "{}", now.dissipation);
        heat += now.dissipation;
        stored = now.energy;
        (before, p, old) = (f, now.stress, new);
    }
    assert!((work - heat - stored).abs() < 1e-7 * work.abs(), "{work} = {heat} + {stored}");
    assert!(heat > 0.1 * stored, "{heat}");
}

/// Random increments never dissipate less than nothing.
#[test]
fn dissipation_is_never_negative() {
    let material = viscoelastic();
    let mut old = vec![0.0; 8];
    let all = deformations();
    for k in 0..4000 {
        let f = all[(7 * k + k * k) % all.len()];
        let dt = 10f64.powi((k % 9) as i32 - 5);
        let (now, new) = evolve(&*material, &f, dt, &old);
        assert!(now.dissipation >= -1e-14 * now.energy.abs(), "{}", now.dissipation);
        old = new;
    }
}

/// The answer of a law with a stretch h across the plane to an increment from what it remembers.
fn stretched(material: &dyn Material, f: &Vector5<f64>, dt: f64, old: &[f64]) -> BulkResponse {
    let deformation = Matrix2::from_column_slice(&f.as_slice()[..4]);
    let straining = with!(Straining::new(deformation, old), stretch: f[4], dt: dt);
    material.respond(&straining, &mut old.to_vec()).unwrap()
}

fn all_laws() -> impl Iterator<Item = Box<dyn Material>> {
    MODELS.into_iter().map(material).chain([viscoelastic()])
}

/// P = ∂W/∂F and A = ∂P/∂F in all five components, over an increment for the law that remembers; without a stretch the law is
/// that of plane strain.
#[test]
fn across_the_plane_stress_and_tangent_are_derivatives() {
    for material in all_laws() {
        let count = material.description().variables.len();
        let old = match count {
            0 => Vec::new(),
            _ => evolve(&*material, &Matrix2::new(1.1, 0.2, -0.1, 0.9), 0.3, &vec![0.0; count]).1,
        };
        for (k, plane) in deformations().into_iter().enumerate() {
            let (h, dt) = ([1.0, 0.7, 1.0 + 1e-7, 1.6, 0.98][k % 5], if k % 2 == 0 { 0.1 } else { 0.0 });
            let f = Vector5::from_iterator(plane.iter().copied().chain([h]));
            let answer = stretched(&*material, &f, dt, &old);
            for column in 0..5 {
                let step = 1e-5;
                let at = |way: f64| stretched(&*material, &(f + Vector5::ith(column, way)), dt, &old);
                let (hi, lo) = (at(step), at(-step));
                let difference = (hi.stress - lo.stress) / (2.0 * step);
                let error = (difference - answer.tangent.column(column)).amax();
                assert!(error < 2e-7, "{material:?} at {f:?}: {error:e}");
                if count == 0 {
                    let work = (hi.energy - lo.energy) / (2.0 * step);
                    assert!((work - answer.stress[column]).abs() < 2e-8, "{material:?} at {f:?}");
                }
            }
            let flat = stretched(&*material, &Vector5::from_iterator(plane.iter().copied().chain([1.0])), dt, &old);
            let mut new = vec![0.0; count];
            let known = in_plane(&*material, with!(Straining::new(plane, &old), dt: dt), &mut new).unwrap();
            assert!(
                (Vector4::from_column_slice(known.stress.as_slice()) - flat.stress.fixed_rows::<4>(0)).amax() < 1e-13
            );
            assert!((flat.energy - known.energy).abs() < 1e-13);
        }
    }
}

/// In plane stress the answer has no stress across the plane, and the tangent is that of the stress.
#[test]
fn a_plate_has_no_stress_across_and_its_tangent_is_the_derivative() {
    for law in all_laws() {
        let plate = in_plate(law);
        let count = plate.description().variables.len();
        let old = vec![0.0; count];
        let (bulk, shear) = (plate.description().p_wave_modulus, plate.description().shear_modulus);
        if count == 0 {
            assert!((bulk - E / (1.0 - NU * NU)).abs() < 1e-14, "{bulk}");
            assert_eq!(shear, G);
        }
        for f in [
            Matrix2::new(1.0, 0.0, 0.0, 1.0),
            Matrix2::new(1.0 + 1e-9, 2e-9, 0.0, 1.0),
            Matrix2::new(1.2, 0.3, -0.1, 0.8),
            rotation(2.0) * Matrix2::new(1.3, 0.2, 0.1, 0.7),
        ] {
            let at = |f: &Matrix2<f64>| evolve(&*plate, f, 0.2, &old).0;
            let rows: [[f64; 4]; 4] = by_difference(&f, |f| at(f).stress.as_slice().try_into().unwrap());
            let error = at(&f).tangent - Matrix4::from_fn(|i, j| rows[i][j]);
            assert!(error.amax() < 1e-8, "{plate:?} at {f}: {error}");
            let sigma = cauchy(&*plate, &f, &evolve(&*plate, &f, 0.2, &old).1);
            assert_eq!(sigma.zz, 0.0);
        }
        assert!(plate.at_once(&Matrix2::identity()).unwrap().stress.iter().all(|stress| *stress == 0.0));
    }
}

/// A bar pulled to the stretch a in a plate, free at its sides: lateral stretch and thickness are the same b. Hencky's law
/// has b = a^(−ν) and P = E ln a/a; of the neo-Hookean law b is the root of G (b² − 1) + λ ln(a b²), found here by bisection, and
/// P = (G (a² − 1) + λ ln(a b²))/a.
#[test]
fn a_bar_in_plane_stress_has_its_closed_form() {
    for a in [0.6, 0.99, 1.0 + 1e-8, 1.5, 2.5f64] {
        let (mut low, mut high) = (0.1f64, 10.0f64);
        for _ in 0..200 {
            let b = 0.5 * (low + high);
            let stress = G * (b * b - 1.0) + LAMBDA * (a * b * b).ln();
            if stress > 0.0 { high = b } else { low = b }
        }
        let root = 0.5 * (low + high);
        let neo = (G * (a * a - 1.0) + LAMBDA * (a * root * root).ln()) / a;
        for (model, b, pull) in [("hencky", a.powf(-NU), E * a.ln() / a), ("neo_hookean", root, neo)] {
            let plate = in_plate(material(model));
            let response = plate.at_once(&Matrix2::new(a, 0.0, 0.0, b)).unwrap();
            assert!((response.stress.m11 - pull).abs() < 1e-13, "{model} at {a}: {} for {pull}", response.stress.m11);
            assert!(response.stress.m22.abs() < 1e-13, "{model} at {a}: {}", response.stress.m22);
            // Of a plate the whole work is done in the plane.
            let sigma = cauchy(&*plate, &Matrix2::new(a, 0.0, 0.0, b), &[]);
            assert!((sigma.xx - pull / (b * b)).abs() < 1e-13 / (b * b), "{model}: {}", sigma.xx);
        }
    }
}

/// A linear plate, against the closed form E/(1 − ν²) (ε_xx + ν ε_yy) and G γ.
#[test]
fn a_linear_plate_has_its_closed_form() {
    let (plate, f) = (in_plate(material("linear")), Matrix2::new(1.01, 0.004, 0.002, 0.98));
    let response = plate.at_once(&f).unwrap();
    let modulus = E / (1.0 - NU * NU);
    for (found, expected) in [
        (response.stress.m11, modulus * (0.01 - NU * 0.02)),
        (response.stress.m22, modulus * (-0.02 + NU * 0.01)),
        (response.stress.m12, G * 0.006),
        (cauchy(&*plate, &f, &[]).zz, 0.0),
    ] {
        assert!((found - expected).abs() < 1e-15, "{found} for {expected}");
    }
    assert!(plate.description().is_linear);
}

/// Saint Venant and Kirchhoff's plate cannot be stretched to e > (λ + 2G)/(2λ): its thickness would vanish.
#[test]
fn a_plate_without_a_thickness_is_refused() {
    let plate = in_plate(material("saint_venant_kirchhoff"));
    assert!(plate.at_once(&Matrix2::new(1.3, 0.0, 0.0, 1.3)).is_ok());
    assert!(plate.at_once(&Matrix2::new(1.8, 0.0, 0.0, 1.8)).is_err());
}
