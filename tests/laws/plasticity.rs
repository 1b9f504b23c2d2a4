//! Laws that yield at large deformations: tangents against differences over random histories, objectivity, what is committed asked for
//! again, steps of an increment, energies, and closed forms.

mod closed_forms;
mod energy;

use crate::bulk::{admits, cauchy, in_plane, in_plate};
use crate::common::{close, with};
use crate::random::Random;
use fecontact::laws::bulk::{
    BodyLaw, BulkLaw, BulkResponse, CauchyStress, Flow, Material, MaterialFailure, MaterialParameters,
    MaterialResponse, Straining, Surroundings, TEMPERATURE,
};
use nalgebra::{Matrix2, Matrix3, Matrix4, Matrix5, Rotation2, Vector2, Vector3, Vector5};
use serde_json::{Value, json};

const E: f64 = 100.0;
const NU: f64 = 0.3;
const G: f64 = E / (2.0 * (1.0 + NU));
const K: f64 = E / (3.0 * (1.0 - 2.0 * NU));
const SIGMA_Y: f64 = 0.3;

fn build(given: Value) -> Box<dyn Material> {
    serde_json::from_value::<MaterialParameters>(given).expect("well formed").build().expect("allowed")
}

fn with_elasticity(mut given: Value) -> Box<dyn Material> {
    (given["E"], given["nu"]) = (json!(E), json!(NU));
    build(given)
}

/// Every law in each of its forms.
fn laws() -> Vec<(&'static str, Box<dyn Material>)> {
    let af = json!([{"C": 20.0, "gamma": 60.0}, {"C": 5.0}]);
    let given = [
        ("perfect", json!({"model": "von_mises", "sigma_y": SIGMA_Y})),
        ("hardening", json!({"model": "von_mises", "sigma_y": SIGMA_Y, "H": 3.0, "Q": 0.2, "b": 30.0})),
        ("weakening", json!({"model": "von_mises", "sigma_y": SIGMA_Y, "Q": -0.1, "b": 30.0})),
        (
            "back stress",
            json!({"model": "von_mises", "sigma_y": SIGMA_Y, "back_stresses": [{"C": 20.0, "gamma": 60.0}]}),
        ),
        ("two of them", json!({"model": "von_mises", "sigma_y": SIGMA_Y, "Q": 0.2, "b": 9.0, "back_stresses": af})),
        ("viscous", json!({"model": "von_mises", "sigma_y": SIGMA_Y, "H": 3.0, "back_stresses": af, "viscosity": 0.7})),
        ("cone", json!({"model": "drucker_prager", "c": 0.1, "phi": 25, "psi": 25, "matching": "plane_strain"})),
        (
            "cut cone",
            json!({"model": "drucker_prager", "c": 0.1, "phi": 30, "psi": 5, "matching": "compression", "tension": 0.05}),
        ),
        ("cylinder", json!({"model": "drucker_prager", "c": 0.1, "phi": 0, "psi": 0, "matching": "compression"})),
        (
            "viscous cone",
            json!({"model": "drucker_prager", "c": 0.1, "phi": 30, "psi": 5, "matching": "compression", "viscosity": 0.4}),
        ),
        ("hexagon", json!({"model": "mohr_coulomb", "c": 0.1, "phi": 30, "psi": 30})),
        ("not associated", json!({"model": "mohr_coulomb", "c": 0.1, "phi": 35, "psi": 5})),
        ("cut off", json!({"model": "mohr_coulomb", "c": 0.1, "phi": 20, "psi": 10, "tension": 0.06})),
        ("Tresca", json!({"model": "mohr_coulomb", "c": 0.1, "phi": 0, "psi": 0, "tension": 0.2})),
        (
            "softening",
            json!({"model": "mohr_coulomb", "c": 0.1, "phi": 30, "psi": 10, "softening": {"c": 0.02, "phi": 24, "psi": 2, "strain": 0.04}}),
        ),
    ];
    let clay = |more: Value| {
        let given = with(json!({"model": "cam_clay", "lambda": 0.15, "kappa": 0.04, "M": 1.1, "p_min": 0.01}), &more);
        build(given)
    };
    let clays = [
        ("clay", clay(json!({"G": 8.0, "p_c": 0.4}))),
        ("dry clay", clay(json!({"nu": -0.3, "OCR": 3.0, "M": null, "phi": 24}))),
        ("clay by e", clay(json!({"nu": 0.3, "OCR": 1.2, "e": 0.9, "lambda": 0.25}))),
        ("viscous clay", clay(json!({"G": 8.0, "p_c": 0.4, "viscosity": 0.3}))),
    ];
    let skeleton = |more: Value| {
        let given =
            with(json!({"model": "sys_cam_clay", "lambda": 0.15, "kappa": 0.04, "M": 1.1, "p_min": 0.01}), &more);
        build(given)
    };
    let skeletons = [
        ("structured", skeleton(json!({"G": 8.0, "p_c": 0.1, "structure": 4.0, "a": 0.8, "c_s": 0.6}))),
        ("overconsolidated", skeleton(json!({"G": 8.0, "OCR": 2.0, "m": 4.0}))),
        ("natural", skeleton(json!({"nu": 0.2, "OCR": 1.5, "structure": 3.0, "m": 3.0, "a": 0.5, "c_s": 0.7}))),
        ("sand", skeleton(json!({"G": 9.0, "OCR": 1.3, "structure": 1.5, "m": 0.3, "a": 2.0, "b_r": 2.0, "m_b": 0.8}))),
        ("rotating", skeleton(json!({"G": 8.0, "p_c": 0.35, "b_r": 0.5, "m_b": 0.9}))),
        (
            "viscous skeleton",
            skeleton(
                json!({"G": 8.0, "OCR": 1.3, "structure": 2.0, "m": 1.0, "a": 0.5, "b_r": 0.2, "m_b": 0.8, "viscosity": 0.3}),
            ),
        ),
    ];
    let soils = clays.into_iter().chain(skeletons);
    given.into_iter().map(|(name, given)| (name, with_elasticity(given))).chain(soils).collect()
}

/// Variables before the first increment: clay begins under a pressure.
fn start(law: &dyn Material) -> Vec<f64> {
    let mut variables = vec![0.0; law.description().variables.len()];
    if law.description().variables.contains(&"p_c") {
        let stress = CauchyStress { xx: -0.3, yy: -0.3, zz: -0.3, xy: 0.0 };
        law.begin(Vector2::zeros(), &stress, &mut variables).expect("a stress that it can have");
    }
    variables
}

/// Those, and all others for large deformations.
fn all_laws() -> Vec<(&'static str, Box<dyn Material>)> {
    let others = ["saint_venant_kirchhoff", "neo_hookean", "hencky"].map(|name| (name, json!({"model": name})));
    let viscoelastic = ("viscoelastic", json!({"model": "viscoelastic", "E_1": 50.0, "tau": 3.0}));
    let others = others.into_iter().chain([viscoelastic]);
    laws().into_iter().chain(others.map(|(name, given)| (name, with_elasticity(given)))).collect()
}

fn plane(f: &Vector5<f64>) -> Matrix2<f64> {
    Matrix2::from_column_slice(&f.as_slice()[..4])
}

/// The answer to five components of F, and the variables it leaves.
fn stretched(law: &dyn Material, f: &Vector5<f64>, old: &[f64]) -> Result<(BulkResponse, Vec<f64>), MaterialFailure> {
    let mut new = vec![0.0; old.len()];
    let straining = with!(Straining::new(plane(f), old), stretch: f[4], dt: 0.1);
    law.respond(&straining, &mut new).map(|answer| (answer, new))
}

/// f in a state, and what else it shows.
fn shown(law: &dyn Material, f: &Vector5<f64>, old: &[f64]) -> Vec<f64> {
    let mut values = vec![0.0; law.description().shown.len()];
    law.show(&with!(Straining::new(plane(f), old), stretch: f[4]), &mut values).expect("an answer");
    values
}

/// Deformations that go on from one another at random, by some strain each, turned by any angle.
fn walk(random: &mut Random, increments: usize, strain: f64) -> Vec<Vector5<f64>> {
    let (mut f, mut h) = (Matrix2::identity(), 1.0);
    let mut all = Vec::new();
    for _ in 0..increments {
        let size = strain * random.magnitude(-1.0, 0.0);
        let step = Matrix2::from_fn(|_, _| random.between(-size, size));
        f = Rotation2::new(random.between(-0.5, 0.5)).into_inner() * (Matrix2::identity() + step) * f;
        h *= 1.0 + random.between(-size, size);
        all.push(Vector5::new(f.m11, f.m21, f.m12, f.m22, h));
    }
    all
}

/// Committed variables after a walk that the law could follow.
fn followed(law: &dyn Material, path: &[Vector5<f64>]) -> Option<Vec<f64>> {
    let mut old = start(law);
    for f in path {
        old = stretched(law, f, &old).ok()?.1;
    }
    Some(old)
}

/// ∂P/∂F is that of what was computed, over histories of two and three increments: within the yield surface and on each of its parts, at
/// corners and tips. A difference across an edge between two of them says nothing, and is left out.
#[test]
fn the_tangent_equals_differences_over_random_histories() {
    let step = 1e-6;
    for (name, law) in laws() {
        let mut random = Random(11);
        let (mut compared, mut yielded) = (0, 0);
        while compared < 300 {
            let path = walk(&mut random, 2 + compared % 2, 0.04);
            let Some(old) = followed(&*law, &path[..path.len() - 1]) else { continue };
            let f = path[path.len() - 1];
            let Ok((answer, new)) = stretched(&*law, &f, &old) else { continue };
            let at = |column: usize, step: f64| {
                let mut f = f;
                f[column] += step;
                stretched(&*law, &f, &old).map(|found| found.0.stress)
            };
            let mut smooth = true;
            let columns: Vec<Vector5<f64>> = (0..5)
                .map(|column| {
                    let [Ok(back), Ok(ahead)] = [at(column, -step), at(column, step)] else {
                        smooth = false;
                        return Vector5::zeros();
                    };
                    smooth &= (ahead + back - 2.0 * answer.stress).amax() < 1e-3 * step * E;
                    (ahead - back) / (2.0 * step)
                })
                .collect();
            if !smooth {
                continue;
            }
            let error = (answer.tangent - Matrix5::from_columns(&columns)).amax();
            assert!(error < 1e-6 * E, "{name}: {error} at {f} after {old:?}");
            compared += 1;
            let place = law
                .description()
                .variables
                .iter()
                .position(|name| *name == "equivalent_plastic_strain")
                .expect("it is there");
            yielded += usize::from(new[place] > old[place]);
        }
        assert!((100..300).contains(&yielded), "{name}: {yielded} of {compared} yield");
    }
}

/// Within its yield surface a law of linear elasticity is Hencky's, whose stress and moduli come from other equations; at small strains
/// and at those beyond which logarithms are no series.
#[test]
fn without_yielding_it_is_hencky_s() {
    let hencky = with_elasticity(json!({"model": "hencky"}));
    let law = with_elasticity(json!({"model": "von_mises", "sigma_y": 1e3}));
    let mut random = Random(17);
    for strain in [1e-6, 1e-3, 0.08, 0.12, 0.5] {
        for f in walk(&mut random, 20, strain).iter().step_by(7) {
            let [expected, found] =
                [&hencky, &law].map(|law| stretched(&**law, f, &start(&**law)).expect("an answer").0);
            assert!((expected.stress - found.stress).amax() < 1e-12 * E, "{f}: {} {}", found.stress, expected.stress);
            assert!(
                (expected.tangent - found.tangent).amax() < 1e-11 * E,
                "{f}: {} {}",
                found.tangent,
                expected.tangent
            );
            assert!((expected.energy - found.energy).abs() < 1e-12 * E, "{f}: {} {}", found.energy, expected.energy);
        }
    }
}

/// The axes of strains so small that their squares vanish turn no stress: that of a body compressed alike on all sides stays.
#[test]
fn strains_that_vanish_leave_an_initial_stress() {
    let law = with_elasticity(json!({"model": "von_mises", "sigma_y": SIGMA_Y}));
    let mut old = vec![0.0; law.description().variables.len()];
    law.begin(Vector2::zeros(), &CauchyStress { xx: -1.0, yy: -1.0, zz: -1.0, xy: 0.0 }, &mut old)
        .expect("a stress that it can have");
    for size in [1e-170, 1.6e-162, 1e-158, 1e-140] {
        let stress = stretched(&*law, &Vector5::new(1.0, 0.0, size, 1.0, 1.0), &old).expect("an answer").0.stress;
        assert!((stress + Vector5::new(1.0, 0.0, 0.0, 1.0, 1.0)).amax() < 1e-14, "{size}: {stress}");
    }
}

/// In plane strain a law answers as with F₃₃ = 1; at several points at once, and without the tangent, to the same bits.
#[test]
fn the_answer_is_the_same_in_plane_and_at_several_points() {
    for (name, law) in laws() {
        let mut random = Random(3);
        let flat = |f: &Vector5<f64>| Vector5::new(f[0], f[1], f[2], f[3], 1.0);
        let states = (0..4).filter_map(|_| {
            let path: Vec<_> = walk(&mut random, 2, 0.03).iter().map(flat).collect();
            Some((path[1], followed(&*law, &path[..1])?))
        });
        let states: Vec<_> = states.filter(|(f, old)| stretched(&*law, f, old).is_ok()).collect();
        assert!(states.len() > 1, "{name}");
        for tangent in [true, false] {
            let strainings: Vec<_> =
                states.iter().map(|(f, old)| with!(Straining::new(plane(f), old), dt: 0.1, tangent: tangent)).collect();
            let mut new = vec![0.0; states.iter().map(|(_, old)| old.len()).sum()];
            let mut responses = vec![MaterialResponse::default(); states.len()];
            law.in_plane(&strainings, &mut new, &mut responses).expect("an answer");
            let all = states.iter().zip(&strainings).zip(&responses).zip(new.chunks_exact(states[0].1.len()));
            for ((((f, old), straining), response), new) in all {
                let mut own = vec![0.0; old.len()];
                assert_eq!(*response, in_plane(&*law, *straining, &mut own).expect("an answer"), "{name}");
                assert_eq!(new, own, "{name}");
                let (expected, variables) = stretched(&*law, f, old).expect("an answer");
                assert!((response.stress - plane(&expected.stress)).amax() < 1e-12 * E, "{name}");
                assert!((response.energy - expected.energy).abs() < 1e-12 * E, "{name}");
                assert!((response.dissipation - expected.dissipation).abs() < 1e-12 * E, "{name}");
                assert!(new.iter().zip(&variables).all(|(a, b)| (a - b).abs() < 1e-12), "{name}");
                let moduli = if tangent { expected.tangent.fixed_view::<4, 4>(0, 0).into() } else { Matrix4::zeros() };
                assert!((response.tangent - moduli).amax() < 1e-10 * E, "{name}");
            }
        }
    }
}

/// Nothing in the history turns with the body: P(QF) = Q P(F), and the variables are the same.
#[test]
fn stress_turns_with_the_body() {
    for (name, law) in all_laws() {
        let mut random = Random(5);
        for _ in 0..100 {
            let path = walk(&mut random, 3, 0.04);
            let turn = Rotation2::new(random.between(-3.0, 3.0)).into_inner();
            let Some(old) = followed(&*law, &path[..2]) else { continue };
            let f = path[2];
            let q = turn * plane(&f);
            let turned = Vector5::new(q.m11, q.m21, q.m12, q.m22, f[4]);
            let (Ok((here, new)), Ok((there, also))) = (stretched(&*law, &f, &old), stretched(&*law, &turned, &old))
            else {
                continue;
            };
            let error =
                (plane(&there.stress) - turn * plane(&here.stress)).amax() + (there.stress[4] - here.stress[4]).abs();
            assert!(error < 1e-11 * E, "{name}: {error}");
            let moment = plane(&here.stress) * plane(&f).transpose();
            assert!((moment.m12 - moment.m21).abs() < 1e-12 * E, "{name}");
            for (a, b) in new.iter().zip(&also) {
                assert!((a - b).abs() < 1e-11, "{name}: {new:?} {also:?}");
            }
        }
    }
}

/// What is committed is answered again: the same stress at the same F, at once, and nothing flows. No answer is beyond the yield surface
/// but that of a viscous law.
#[test]
fn a_committed_state_stays_and_is_within_the_yield_surface() {
    for (name, law) in all_laws() {
        let mut random = Random(7);
        for _ in 0..200 {
            let path = walk(&mut random, 3, 0.04);
            let Some(old) = followed(&*law, &path[..2]) else { continue };
            let f = path[2];
            let Ok((first, committed)) = stretched(&*law, &f, &old) else { continue };
            let mut new = committed.clone();
            let again = with!(Straining::new(plane(&f), &committed), stretch: f[4]);
            let second = law.respond(&again, &mut new).expect("an answer");
            assert!((first.stress - second.stress).amax() < 1e-11 * E, "{name}");
            assert!((first.energy - second.energy).abs() < 1e-12 * E && second.dissipation.abs() < 1e-12 * E, "{name}");
            for (a, b) in new.iter().zip(&committed) {
                assert!((a - b).abs() < 1e-12, "{name}: {new:?} {committed:?}");
            }
            if law.description().flow.is_some() && !name.starts_with("viscous") {
                let indicator = shown(&*law, &f, &committed)[2];
                assert!(indicator < 1e-11 * E, "{name}: f = {indicator}");
            }
        }
    }
}

/// Plastic volume is exact: where the flow is isochoric det C_p stays 1.
#[test]
fn isochoric_flow_keeps_the_volume() {
    for (name, law) in laws().into_iter().filter(|(name, _)| *name != "cut off" && *name != "Tresca") {
        let isochoric = law.description().flow == Some(Flow::Isochoric);
        let mut random = Random(3);
        let (mut most, mut flowed) = (0.0f64, 0.0f64);
        for _ in 0..50 {
            let Some(old) = followed(&*law, &walk(&mut random, 6, 0.04)) else { continue };
            let volume_of = |state: &[f64]| {
                let [xx, yy, xy, zz] = [0, 1, 2, 3].map(|k| state[k]);
                ((1.0 + xx) * (1.0 + yy) - xy * xy) * (1.0 + zz)
            };
            let volume = volume_of(&old) / volume_of(&start(&*law)) - 1.0;
            (most, flowed) = (most.max(volume.abs()), flowed.max(old[9]));
            close(name, old[10], -0.5 * volume.ln_1p(), 1e-12);
        }
        assert!(flowed > 0.02, "{name}");
        assert_eq!(isochoric, most < 1e-13, "{name}: {most}");
    }
}

/// A deformation along a path, evenly in so many increments: stress, energy, dissipation and work ∫ P:dF by the mean of both ends.
fn driven(law: &dyn Material, along: impl Fn(f64) -> Vector5<f64>, parts: usize) -> (Vector5<f64>, [f64; 3]) {
    let mut old = start(law);
    let (mut before, mut energies) = (along(0.0), [0.0; 3]);
    let mut stress = stretched(law, &before, &old).expect("an answer").0.stress;
    for k in 1..=parts {
        let f = along(k as f64 / parts as f64);
        let (answer, new) = stretched(law, &f, &old).expect("an answer");
        assert!(answer.dissipation >= -1e-15, "{}", answer.dissipation);
        energies[0] = answer.energy;
        energies[1] += answer.dissipation;
        energies[2] += 0.5 * (stress + answer.stress).dot(&(f - before));
        (before, stress, old) = (f, answer.stress, new);
    }
    (stress, energies)
}

/// A path that turns its direction while it is compressed.
fn winding(t: f64) -> Vector5<f64> {
    let (sin, cos) = (1.5 * t).sin_cos();
    let f = Rotation2::new(0.8 * t).into_inner()
        * Matrix2::new(1.0 + 0.02 * t, 0.03 * sin, 0.0, 1.0 - 0.03 * t + 0.01 * (1.0 - cos));
    Vector5::new(f.m11, f.m21, f.m12, f.m22, 1.0 - 0.005 * t)
}

/// One increment against a thousand: the error falls as their length. (Time runs along, so that viscous laws have another history.)
#[test]
fn increments_converge_at_first_order() {
    for (name, law) in laws().into_iter().filter(|(name, _)| !name.starts_with("viscous")) {
        let [exact, one, ten, hundred] = [4000, 1, 10, 100].map(|parts| driven(&*law, winding, parts).0);
        let [one, ten, hundred] = [one, ten, hundred].map(|stress| (stress - exact).amax());
        assert!(one < 0.3, "{name}: {one}");
        assert!(hundred < 0.2 * ten + 1e-9 && hundred < 0.02 * one.max(0.02) + 1e-9, "{name}: {one} {ten} {hundred}");
    }
}

/// Logarithmic strains along 1, 2 and 3.
fn principal(strains: [f64; 3]) -> Vector5<f64> {
    let [x, y, z] = strains.map(f64::exp);
    Vector5::new(x, 0.0, 0.0, y, z)
}

/// Splitting an elastic increment changes nothing.
#[test]
fn elastic_increments_may_be_split() {
    for (name, law) in laws() {
        // Within a yield surface that follows the stress, unloading is elastic.
        let sign = if law.description().variables.contains(&"R") { -1.0 } else { 1.0 };
        let along = |t: f64| Vector5::new(1.0 - 1e-4 * sign * t, 2e-4 * t, 3e-4 * t, 1.0 - 2e-4 * sign * t, 1.0);
        let [one, many] = [1, 50].map(|parts| driven(&*law, along, parts));
        assert_eq!(one.0, many.0, "{name}");
        assert_eq!(many.1[1], 0.0, "{name}");
    }
}

/// An initial stress is the law's own: it is there at F = 1, nothing is stored beyond it, and it counts for yielding.
#[test]
fn an_initial_stress_is_inside_the_law() {
    let law = with_elasticity(json!({"model": "mohr_coulomb", "c": 0.0, "phi": 30, "psi": 0}));
    let stress = CauchyStress { xx: -0.4, yy: -1.0, zz: -0.4, xy: 0.1 };
    let mut old = vec![0.0; law.description().variables.len()];
    law.begin(Vector2::zeros(), &stress, &mut old).expect("it is within");
    let here = cauchy(&*law, &Matrix2::identity(), &old);
    for (found, given) in [(here.xx, stress.xx), (here.yy, stress.yy), (here.zz, stress.zz), (here.xy, stress.xy)] {
        close("σ₀", found, given, 1e-14);
    }
    let one = Vector5::new(1.0, 0.0, 0.0, 1.0, 1.0);
    close("W", stretched(&*law, &one, &old).expect("an answer").0.energy, 0.0, 1e-17);
    // Compressed laterally by what takes it to passive failure, σ_xx/σ_yy = 3.
    let f = Vector5::new(0.95, 0.0, 0.0, 1.06, 1.0);
    let indicator = shown(&*law, &f, &stretched(&*law, &f, &old).expect("an answer").1)[2];
    close("f", indicator, 0.0, 1e-10);
    let low = CauchyStress { xx: -0.3, yy: -1.0, zz: -0.3, xy: 0.0 };
    let why = admits(&*law, &low).expect_err("K0 = 0.3 is below 1/3").to_string();
    assert!(why.contains("0.3333") && why.contains("f = "), "{why}");
    assert!(admits(&*law, &CauchyStress { xx: -1.0 / 3.0, yy: -1.0, zz: -1.0 / 3.0, xy: 0.0 }).is_ok());
}

/// A stress beyond the yield surface by what a number of seven digits leaves out is within; one beyond that is refused, and numbers that are
/// compared differ in what is told. A p_c that is asked for is enough. Where p alone acts, p_c = p is needed; where q = 2 p alone, p_c =
/// p + q²/(M² p) (Cam-clay); σ_y is the difference of the principal stresses of uniaxial stress; √J₂ is |xy| in pure shear, and c the limit at φ = 0.
#[test]
fn what_is_needed_is_reported_with_digits_that_tell() {
    let pressed = CauchyStress { xx: -50.0, yy: -50.0, zz: -50.0, xy: 0.0 };
    let steep = CauchyStress { xx: -20.0 / 3.0, yy: -20.0 / 3.0, zz: -50.0 / 3.0, xy: 0.0 };
    let (p, q, critical) = (10.0, 10.0, 1.1f64);
    for (model, stress, needed) in [
        ("cam_clay", pressed, 50.0),
        ("cam_clay", steep, p + q * q / (critical * critical * p)),
        ("sys_cam_clay", pressed, 50.0),
    ] {
        let of = |p_c: f64| {
            build(
                json!({"model": model, "lambda": 0.15, "kappa": 0.04, "M": critical, "p_min": 0.01, "G": 8.0, "p_c": p_c}),
            )
        };
        assert!(admits(&*of(needed * (1.0 - 1e-8)), &stress).is_ok(), "{model}: {needed}");
        let given = needed * (1.0 - 1e-5);
        let why = admits(&*of(given), &stress).expect_err("too small").to_string();
        let message = why.split("p_c of ").nth(1).and_then(|rest| rest.split(' ').next()).expect("what is needed");
        let message: f64 = message.parse().expect("a number");
        assert!(message >= needed && message < needed * (1.0 + 1e-5), "{why}");
        admits(&*of(message), &stress).expect("as told");
    }
    let uniaxial = CauchyStress { xx: SIGMA_Y * (1.0 + 3e-6), yy: 0.0, zz: 0.0, xy: 0.0 };
    let sheared = CauchyStress { xx: 0.0, yy: 0.0, zz: 0.0, xy: 0.1 * (1.0 + 3e-6) };
    let cylinder = json!({"model": "drucker_prager", "c": 0.1, "phi": 0, "psi": 0, "matching": "plane_strain"});
    for (given, stress, [before, between]) in [
        (json!({"model": "von_mises", "sigma_y": SIGMA_Y}), uniaxial, ["von Mises stress is ", ", and sigma_y is "]),
        (cylinder, sheared, ["√J₂ is ", "where the cone carries "]),
    ] {
        let why = admits(&*with_elasticity(given), &stress).expect_err("beyond").to_string();
        let after = |words: &str| -> f64 {
            let rest = why.split(words).nth(1).expect(words);
            let end = rest.find(|c: char| c != '.' && !c.is_ascii_digit()).expect("words");
            rest[..end].trim_end_matches('.').parse().expect("a number")
        };
        assert!(after(before) > after(between), "{why}");
    }
}

/// A heated body that yields expands as another: F = ϑ F_e without stress, and its tangent is that of what it answers.
#[test]
fn a_heated_body_yields() {
    for (name, law) in laws() {
        let imposed = BodyLaw::new(law, Surroundings::default().expansion(0.01)).expect("every section");
        let old = start(&imposed);
        let heat = imposed.description().slot(&TEMPERATURE).expect("it is heated");
        let count = old.len() - heat.of(&old).len();
        let (_, law) = laws().into_iter().find(|(other, _)| other == &name).expect("it is there");
        let before = stretched(&*law, &Vector5::new(1.0, 0.0, 0.0, 1.0, 1.0), &old[..count]);
        let before = before.expect("an answer").0.stress;
        let at = |f: &Vector5<f64>| {
            let mut new = old.clone();
            heat.of_mut(&mut new)[0] = 2.0;
            let straining = with!(Straining::new(plane(f), &old), stretch: f[4], dt: 0.1);
            imposed.respond(&straining, &mut new).expect("an answer")
        };
        let free = 1.02 * Vector5::new(1.0, 0.0, 0.0, 1.0, 1.0);
        assert!((at(&free).stress - 1.02f64.powi(2) * before).amax() < 1e-13, "{name}");
        let f = free + Vector5::new(-0.02, 0.004, 0.03, 0.015, 0.001);
        let (answer, step) = (at(&f), 1e-6);
        assert!(answer.dissipation > 0.0, "{name}");
        for column in 0..5 {
            let [mut ahead, mut back] = [f; 2];
            (ahead[column], back[column]) = (f[column] + step, f[column] - step);
            let slope = (at(&ahead).stress - at(&back).stress) / (2.0 * step);
            assert!((slope - answer.tangent.column(column)).amax() < 1e-6 * E, "{name}");
        }
    }
}

/// Failures say which law, and why; soils are no plates.
#[test]
fn what_cannot_be_answered_is_reported() {
    let law = with_elasticity(json!({"model": "von_mises", "sigma_y": SIGMA_Y}));
    let old = vec![0.0; law.description().variables.len()];
    let far = stretched(&*law, &Vector5::new(1.0, 0.0, 2.0, 1.0, 1.0), &old).expect_err("too far");
    assert!(matches!(far, MaterialFailure::OutOfRange { law: "von_mises", .. }), "{far}");
    assert!(far.to_string().contains("in one increment"), "{far}");
    let inverted = stretched(&*law, &Vector5::new(-1.0, 0.0, 0.0, 1.0, 1.0), &old).expect_err("inverted");
    assert!(matches!(inverted, MaterialFailure::Inverted { .. }));
    let soil = with_elasticity(json!({"model": "mohr_coulomb", "c": 0.1, "phi": 30, "psi": 0}));
    assert!(soil.description().concern.expect("it is not associated").contains("psi < phi"));
    assert!(BodyLaw::new(soil, Surroundings::default().plate()).is_none());
    assert!(law.description().concern.is_none());
}

/// Constants out of range are refused with their name.
#[test]
fn bad_constants_are_refused() {
    let soil = |c: f64, phi: f64, psi: f64| json!({"model": "mohr_coulomb", "c": c, "phi": phi, "psi": psi});
    let mut snaps = soil(0.1, 30.0, 0.0);
    snaps["softening"] = json!({"c": 0.0, "phi": 30, "psi": 0, "strain": 1e-4});
    for (key, mut given) in [
        ("sigma_y", json!({"model": "von_mises", "sigma_y": 0.0})),
        ("Q", json!({"model": "von_mises", "sigma_y": 1.0, "Q": -1.0, "b": 1.0})),
        ("b", json!({"model": "von_mises", "sigma_y": 1.0, "Q": 1.0})),
        ("b", json!({"model": "von_mises", "sigma_y": 1.0, "Q": -0.9, "b": 1000.0})),
        ("C", json!({"model": "von_mises", "sigma_y": 1.0, "back_stresses": [{"C": 0.0}]})),
        ("phi", soil(0.1, 90.0, 0.0)),
        ("psi", soil(0.1, 20.0, 21.0)),
        ("c", soil(0.0, 0.0, 0.0)),
        ("softening.strain", snaps),
        ("psi", json!({"model": "drucker_prager", "c": 1.0, "phi": 20, "psi": 5, "matching": "plane_strain"})),
    ] {
        (given["E"], given["nu"]) = (json!(E), json!(NU));
        let refused = serde_json::from_value::<MaterialParameters>(given.clone()).expect("well formed").build();
        assert_eq!(refused.map(drop).expect_err(&given.to_string()).name, key, "{given}");
    }
}
