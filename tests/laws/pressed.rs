//! Laws in whose pores the pressure of the fluid is given: stress and tangent against differences, energy, plates.

use crate::common::close;
use crate::random::Random;
use fecontact::laws::bulk::{
    BodyLaw, BulkLaw, BulkResponse, GIVEN_PRESSURE, Material, MaterialParameters, PoreFluid, Straining, Surroundings,
};
use nalgebra::{Matrix2, Matrix5, Vector5};
use serde_json::{Value, json};

const BIOT: f64 = 0.8;

fn build(given: Value) -> Box<dyn Material> {
    serde_json::from_value::<MaterialParameters>(given).expect("well formed").build().expect("allowed")
}

fn pressed(law: Box<dyn Material>, plate: bool) -> Option<BodyLaw> {
    let surroundings = Surroundings::default().biot(BIOT);
    BodyLaw::new(law, if plate { surroundings.plate() } else { surroundings })
}

fn laws() -> Vec<(&'static str, Box<dyn Material>)> {
    vec![
        ("hencky", build(json!({"model": "hencky", "E": 100.0, "nu": 0.3}))),
        ("neo-Hookean", build(json!({"model": "neo_hookean", "E": 100.0, "nu": 0.3}))),
        ("linear", build(json!({"model": "linear", "E": 100.0, "nu": 0.3}))),
        ("hexagon", build(json!({"model": "mohr_coulomb", "E": 100.0, "nu": 0.3, "c": 0.1, "phi": 30, "psi": 10}))),
    ]
}

/// The answer under a pressure, and what the pores have opened by.
fn at(law: &BodyLaw, f: &Vector5<f64>, pressure: f64) -> (BulkResponse, f64) {
    let old = vec![0.0; law.description().variables.len()];
    let mut new = old.clone();
    let slot = law.description().slot(&GIVEN_PRESSURE).expect("it has one");
    slot.of_mut(&mut new)[0] = pressure;
    let plane = Matrix2::from_column_slice(&f.as_slice()[..4]);
    let answer = law.respond(&with!(Straining::new(plane, &old), stretch: f[4], dt: 0.1), &mut new);
    (answer.expect("an answer"), slot.of(&new)[1])
}

/// P is the law's own less b p J F⁻ᵀ, its tangent that of differences, and what the energy falls by per pressure is b (J − 1).
#[test]
fn the_stress_is_effective_less_the_pressure_on_faces_as_they_are() {
    let mut random = Random(5);
    for (name, law) in laws() {
        let (linear, pressed) = (law.description().is_linear, pressed(law, false).expect("every section"));
        for _ in 0..50 {
            let one = Vector5::new(1.0, 0.0, 0.0, 1.0, 1.0);
            let size = if name == "hexagon" { 0.002 } else { 0.2 };
            let f = one + Vector5::from_fn(|_, _| random.between(-size, size));
            let pressure = random.between(-20.0, 20.0);
            let ((dry, _), (wet, opened)) = (at(&pressed, &f, 0.0), at(&pressed, &f, pressure));
            let plane = Matrix2::from_column_slice(&f.as_slice()[..4]);
            let (jacobian, inverse) = (plane.determinant() * f[4], plane.try_inverse().expect("it is").transpose());
            let of =
                |value: Matrix2<f64>, across: f64| Vector5::new(value.m11, value.m21, value.m12, value.m22, across);
            let bears = if linear { one } else { jacobian * of(inverse, 1.0 / f[4]) };
            let gap = wet.stress - (dry.stress - BIOT * pressure * bears);
            close(name, gap.amax(), 0.0, 1e-11 * (1.0 + wet.stress.amax()));
            let volume = if linear { (f - one).dot(&one) } else { jacobian - 1.0 };
            close(name, opened, BIOT * volume, 1e-13);
            close(name, wet.energy - dry.energy, -pressure * opened, 1e-11 * (1.0 + pressure.abs()));
            let mut added = Matrix5::zeros();
            for k in 0..5 {
                let step = 1e-5;
                let along = Vector5::from_fn(|i, _| if i == k { step } else { 0.0 });
                let of = |sign: f64| {
                    at(&pressed, &(f + sign * along), pressure).0.stress
                        - at(&pressed, &(f + sign * along), 0.0).0.stress
                };
                added.set_column(k, &((of(1.0) - of(-1.0)) / (2.0 * step)));
            }
            close(name, (wet.tangent - dry.tangent - added).amax(), 0.0, 1e-7 * (1.0 + pressure.abs()));
        }
    }
}

/// A plate is as thick as its pores make it: free in its plane it swells alike in all directions, and its tangent is that of differences.
#[test]
fn a_plate_swells_alike_in_all_directions() {
    for (name, law) in laws().into_iter().take(3) {
        let (linear, law) = (law.description().is_linear, pressed(law, true).expect("a plate"));
        let pressure = 10.0;
        // σ′ = b p 1 of isotropic swelling: 3 K ε of a linear body
        let by_hand = BIOT * pressure * 0.4 / 100.0;
        let (mut low, mut high) = (1.0, 1.2);
        for _ in 0..60 {
            let stretch: f64 = 0.5 * (low + high);
            let f = Vector5::new(stretch, 0.0, 0.0, stretch, 1.0);
            if at(&law, &f, pressure).0.stress[0] < 0.0 { low = stretch } else { high = stretch }
        }
        let free = at(&law, &Vector5::new(low, 0.0, 0.0, low, 1.0), pressure).0.free_stretch.expect("a plate");
        close(name, free, low, 1e-9);
        close(name, low - 1.0, by_hand, if linear { 1e-9 } else { 0.2 * by_hand });
        let f = Vector5::new(1.1, 0.05, -0.03, 0.95, 1.0);
        for k in 0..4 {
            let along = Vector5::from_fn(|i, _| if i == k { 1e-6 } else { 0.0 });
            let [more, less] = [1.0, -1.0].map(|sign| at(&law, &(f + sign * along), pressure).0.stress);
            let gap = at(&law, &f, pressure).0.tangent.column(k) - (more - less) / 2e-6;
            close(name, gap.rows(0, 4).amax(), 0.0, 1e-5);
        }
    }
}

/// Pores hold one fluid.
#[test]
fn pores_hold_one_fluid() {
    let fluid = PoreFluid { modulus: 100.0, cavitation: None };
    let law = build(json!({"model": "hencky", "E": 100.0, "nu": 0.3}));
    assert!(BodyLaw::new(law, Surroundings::default().fluid(fluid).biot(1.0)).is_none());
}
