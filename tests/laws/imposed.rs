//! Laws under an initial stress and a temperature: energies, derivatives by differences, closed forms.

use fecontact::laws::bulk::{
    BodyLaw, BulkLaw, BulkResponse, Material, MaterialParameters, MaterialResponse, Straining, Surroundings,
    TEMPERATURE,
};
use nalgebra::{Matrix2, Rotation2, Vector5};
use serde_json::json;

const E: f64 = 2.0;
const NU: f64 = 0.3;
const G: f64 = E / (2.0 * (1.0 + NU));
const ALPHA: f64 = 0.01;
const MODELS: [&str; 5] = ["linear", "saint_venant_kirchhoff", "neo_hookean", "hencky", "viscoelastic"];

fn material(model: &str) -> Box<dyn Material> {
    let mut given = json!({"model": model, "E": E, "nu": NU});
    if model == "viscoelastic" {
        (given["E_1"], given["tau"]) = (json!(0.5 * E), json!(1.0));
    }
    serde_json::from_value::<MaterialParameters>(given).unwrap().build().unwrap()
}

/// A law under an initial stress xx, yy, xy, zz, with the variables of a rise of temperature.
struct Under {
    model: &'static str,
    surroundings: Surroundings,
    law: BodyLaw,
    variables: Vec<f64>,
}

impl Under {
    fn new(model: &'static str, stress: Option<[f64; 4]>, heated: bool) -> Self {
        let surroundings = Surroundings::default().stressed(stress.is_some());
        let surroundings = if heated { surroundings.expansion(ALPHA) } else { surroundings };
        let law = BodyLaw::new(material(model), surroundings).expect("every section");
        let count = law.description().variables.len();
        let first = count - if heated { 2 } else { 0 } - if stress.is_some() { 4 } else { 0 };
        let mut variables = vec![0.0; count];
        stress.iter().flatten().zip(&mut variables[first..]).for_each(|(stress, variable)| *variable = *stress);
        Self { model, surroundings, law, variables }
    }

    fn in_plate(self) -> Self {
        Self { law: BodyLaw::new(material(self.model), self.surroundings.plate()).expect("every section"), ..self }
    }

    /// Variables at a rise of temperature.
    fn at(&self, rise: f64) -> Vec<f64> {
        let mut new = self.variables.clone();
        if let Some(heat) = self.law.description().slot(&TEMPERATURE) {
            heat.of_mut(&mut new)[0] = rise;
        }
        new
    }

    /// The answer with F₃₃, and the variables it leaves.
    fn stretched(&self, f: &Vector5<f64>, rise: f64) -> (BulkResponse, Vec<f64>) {
        let deformation = Matrix2::from_column_slice(&f.as_slice()[..4]);
        let mut new = self.at(rise);
        let straining = with!(Straining::new(deformation, &self.variables), stretch: f[4], dt: 0.1);
        (self.law.respond(&straining, &mut new).unwrap(), new)
    }

    /// The answer in plane.
    fn evolve(&self, f: &Matrix2<f64>, rise: f64) -> (MaterialResponse, Vec<f64>) {
        let mut new = self.at(rise);
        let (straining, mut answer) =
            (with!(Straining::new(*f, &self.variables), dt: 0.1), MaterialResponse::default());
        self.law.in_plane(&[straining], &mut new, std::slice::from_mut(&mut answer)).unwrap();
        (answer, new)
    }
}

const STRESS: [f64; 4] = [-0.3, -0.7, 0.2, -0.5];

fn deformations() -> [Vector5<f64>; 4] {
    let turned = Rotation2::new(1.3).into_inner() * Matrix2::new(1.2, 0.3, -0.1, 0.8);
    [
        Vector5::new(1.0, 0.0, 0.0, 1.0, 1.0),
        Vector5::new(1.001, 0.002, -0.001, 0.998, 1.0),
        Vector5::new(1.2, 0.3, -0.1, 0.8, 0.9),
        Vector5::new(turned.m11, turned.m21, turned.m12, turned.m22, 1.15),
    ]
}

/// P = ∂W/∂F and A = ∂P/∂F in all five components, and −∂W/∂ϑ = τ, where W is all that there is; in plane strain the law is the
/// same with F₃₃ = 1.
#[test]
fn stress_tangent_and_expansion_stress_are_derivatives() {
    let step = 1e-5;
    for (model, stress, heated) in MODELS
        .into_iter()
        .flat_map(|model| [(model, Some(STRESS), false), (model, None, true), (model, Some(STRESS), true)])
    {
        let (law, rise) = (Under::new(model, stress, heated), 7.0);
        for f in deformations() {
            let (answer, new) = law.stretched(&f, rise);
            for column in 0..5 {
                let at = |way: f64| law.stretched(&(f + Vector5::ith(column, way)), rise).0;
                let (hi, lo) = (at(step), at(-step));
                let error = ((hi.stress - lo.stress) / (2.0 * step) - answer.tangent.column(column)).amax();
                assert!(error < 2e-8, "{model} {stress:?} {heated} at {f:?}: {error:e}");
                let work = (hi.energy - lo.energy) / (2.0 * step);
                assert!(model == "viscoelastic" || (work - answer.stress[column]).abs() < 1e-8, "{model} at {f:?}");
            }
            if heated && model != "viscoelastic" {
                let [hi, lo] = [1e-3, -1e-3].map(|way| law.stretched(&f, rise + way).0.energy);
                let slope = (hi - lo) / (2e-3 * ALPHA);
                let message = new[new.len() - 1];
                assert!((slope + message).abs() < 1e-7, "{model} at {f:?}: {slope} {message}");
            }
            let flat = Vector5::new(f[0], f[1], f[2], f[3], 1.0);
            let (spatial, known) =
                (law.stretched(&flat, rise).0, law.evolve(&Matrix2::from_column_slice(&flat.as_slice()[..4]), rise).0);
            assert_eq!(known.stress.as_slice(), &spatial.stress.as_slice()[..4]);
            assert_eq!((known.energy, known.dissipation), (spatial.energy, spatial.dissipation));
        }
    }
}

/// The same in a plate, whose stress across the plane stays zero.
#[test]
fn in_a_plate_they_are_as_well() {
    let (step, rise) = (1e-5, 7.0);
    for model in MODELS {
        let law = Under::new(model, Some([-0.3, -0.7, 0.2, 0.0]), true).in_plate();
        for f in deformations().map(|f| Matrix2::from_column_slice(&f.as_slice()[..4])) {
            let (answer, new) = law.evolve(&f, rise);
            for column in 0..4 {
                let at = |way: f64| {
                    let mut varied = f;
                    varied[column] += way;
                    law.evolve(&varied, rise).0
                };
                let (hi, lo) = (at(step), at(-step));
                let difference: Matrix2<f64> = (hi.stress - lo.stress) / (2.0 * step);
                for (row, difference) in difference.iter().enumerate() {
                    let error = difference - answer.tangent[(row, column)];
                    assert!(error.abs() < 2e-8, "{model} at {f}: {error:e}");
                }
                let work = (hi.energy - lo.energy) / (2.0 * step);
                assert!(model == "viscoelastic" || (work - answer.stress[column]).abs() < 1e-8, "{model}");
            }
            if model != "viscoelastic" {
                let [hi, lo] = [1e-3, -1e-3].map(|way| law.evolve(&f, rise + way).0.energy);
                let slope = (hi - lo) / (2e-3 * ALPHA);
                assert!((slope + new[new.len() - 1]).abs() < 1e-7, "{model} at {f}");
            }
            assert_eq!(law.law.cauchy_stress(&Straining::new(f, &new)).unwrap().zz, 0.0);
        }
    }
}

/// The undeformed body has the stress that is given, and turns it with itself; a shear of the neo-Hookean law across a tension σ is
/// resisted by G + σ, the stiffness of a string beside its own.
#[test]
fn an_initial_stress_turns_with_the_body_and_stiffens_it() {
    for model in MODELS {
        let law = Under::new(model, Some(STRESS), false);
        let still = law.law.cauchy_stress(&Straining::new(Matrix2::identity(), &law.variables)).unwrap();
        assert_eq!([still.xx, still.yy, still.xy, still.zz], STRESS);
        if model != "linear" {
            let q = Rotation2::new(0.7).into_inner();
            let turned = law.law.cauchy_stress(&Straining::new(q, &law.variables)).unwrap();
            let expected = q * Matrix2::new(STRESS[0], STRESS[2], STRESS[2], STRESS[1]) * q.transpose();
            let error = Matrix2::new(turned.xx, turned.xy, turned.xy, turned.yy) - expected;
            assert!(error.amax() < 1e-15 && (turned.zz - STRESS[3]).abs() < 1e-15, "{model}: {error}");
        }
    }
    let (law, gamma) = (Under::new("neo_hookean", Some([0.4, 0.0, 0.0, 0.0]), false), 0.3);
    let sheared = law.evolve(&Matrix2::new(1.0, 0.0, gamma, 1.0), 0.0).0;
    assert!((sheared.stress.m21 - (G + 0.4) * gamma).abs() < 1e-15, "{}", sheared.stress);
}

/// What expands as it likes has no stress, wherever it turns, and keeps its initial stress; what is held has that of a body
/// squeezed by 1/ϑ: Hencky's is σ = −(3λ + 2G) ϑ³ ln ϑ, the linear one −E α ΔT/(1 − 2ν).
#[test]
fn free_and_held_bodies_have_their_closed_forms() {
    let (rise, theta) = (20.0, 1.0 + 20.0 * ALPHA);
    for model in MODELS {
        let q = if model == "linear" { Matrix2::identity() } else { Rotation2::new(0.7).into_inner() };
        let free = theta * q;
        let f = Vector5::new(free.m11, free.m21, free.m12, free.m22, theta);
        let (answer, new) = Under::new(model, None, true).stretched(&f, rise);
        assert!(answer.stress.amax() < 1e-15 * E, "{model}: {:?}", answer.stress);
        assert!(answer.energy < 1e-15 && new[new.len() - 1].abs() < 1e-15);
        let stressed = Under::new(model, Some(STRESS), true);
        let new = stressed.stretched(&f, rise).1;
        let straining = with!(Straining::new(free, &new), stretch: theta);
        let sigma = stressed.law.cauchy_stress(&straining).unwrap();
        let given = q * Matrix2::new(STRESS[0], STRESS[2], STRESS[2], STRESS[1]) * q.transpose();
        assert!((sigma.xx - given.m11).abs() < 1e-14 && (sigma.zz - STRESS[3]).abs() < 1e-14, "{model}: {sigma:?}");
    }
    let bulk = E / (1.0 - 2.0 * NU);
    for (model, expected) in [("linear", -bulk * (theta - 1.0)), ("hencky", -bulk * theta.powi(3) * theta.ln())] {
        let law = Under::new(model, None, true);
        let new = law.evolve(&Matrix2::identity(), rise).1;
        let sigma = law.law.cauchy_stress(&Straining::new(Matrix2::identity(), &new)).unwrap();
        for stress in [sigma.xx, sigma.yy, sigma.zz] {
            assert!((stress - expected).abs() < 1e-14, "{model}: {stress} {expected}");
        }
    }
    let (held, new) = Under::new("linear", None, true).in_plate().evolve(&Matrix2::identity(), rise);
    assert!((held.stress.m11 + E / (1.0 - NU) * (theta - 1.0)).abs() < 1e-15 && new[0] == rise);
}
