//! The balance of energy of plastic laws.

use super::*;

/// Work is stored or dissipated, all of it as increments become short.
#[test]
fn energy_is_balanced() {
    for (name, law) in all_laws().into_iter().filter(|(name, _)| !name.starts_with("viscous")) {
        let [coarse, fine] = [100, 1000].map(|parts| {
            let (_, [stored, dissipated, work]) = driven(&*law, winding, parts);
            assert_eq!(
                dissipated > 0.01 * work,
                !law.description().variables.is_empty(),
                "{name}: {dissipated} of {work}"
            );
            (work - stored - dissipated).abs() / work
        });
        assert!(coarse < 3e-3 && fine < 0.02 * coarse + 1e-9, "{name}: {coarse} {fine}");
    }
}

/// A deformation by its size.
type Way<'a> = &'a dyn Fn(f64) -> Vector5<f64>;

/// From one side of the yield surface through the inside to another, in one increment: what is dissipated is the work of the stress there
/// on the plastic strain, a ε̄ + b ε_v of what yields at a constant stress. Y ε̄; ξ c Δγ with ε̄ = Δγ/√3 on the associated cone, and
/// c cos φ Δγ with ε_v = sin φ Δγ on the associated hexagon; at a tip its tension times ε_v, 0 of clay, which was pressed to its cap.
#[test]
fn a_reversal_in_one_increment_dissipates_what_its_stress_does() {
    let (sin, cos) = 30f64.to_radians().sin_cos();
    let cone = 6.0 * 0.1 * cos / (3.0 - sin);
    let clay =
        json!({"model": "cam_clay", "lambda": 0.15, "kappa": 0.04, "M": 1.1, "p_min": 0.01, "G": 8.0, "p_c": 0.4});
    let (shear, pressed) = (|e: f64| principal([e, -e, 0.0]), |e: f64| principal([-e; 3]));
    let given: [(Value, Way, [f64; 2]); 6] = [
        (json!({"model": "von_mises", "sigma_y": SIGMA_Y}), &shear, [SIGMA_Y, 0.0]),
        (
            json!({"model": "drucker_prager", "c": 0.1, "phi": 30, "psi": 30, "matching": "compression"}),
            &shear,
            [cone, 0.0],
        ),
        (json!({"model": "mohr_coulomb", "c": 0.1, "phi": 30, "psi": 30}), &shear, [0.0, 0.1 * cos / sin]),
        (
            json!({"model": "drucker_prager", "c": 0.1, "phi": 30, "psi": 5, "matching": "compression"}),
            &pressed,
            [0.0, 0.1 * cos / sin],
        ),
        (json!({"model": "mohr_coulomb", "c": 0.1, "phi": 30, "psi": 30, "tension": 0.05}), &pressed, [0.0, 0.05]),
        (clay.clone(), &pressed, [0.0, 0.0]),
    ];
    for (given, along, [by_shear, by_volume]) in given {
        let law = if given["model"] == "cam_clay" { build(given.clone()) } else { with_elasticity(given.clone()) };
        let (mut old, most) = (start(&*law), 0.02);
        for k in 1..=100 {
            old = stretched(&*law, &along(most * f64::from(k) / 100.0), &old).expect("an answer").1;
        }
        let before = shown(&*law, &along(most), &old);
        let (answer, new) = stretched(&*law, &along(-3.0 * most), &old).expect("an answer");
        let after = shown(&*law, &along(-3.0 * most), &new);
        let [equivalent, volume] = [0, 1].map(|k| after[k] - before[k]);
        assert!(equivalent + volume > 0.01, "{given}: {equivalent} {volume}");
        close(&given.to_string(), answer.dissipation, by_shear * equivalent + by_volume * volume, 1e-10);
    }
}

/// Strains to and fro, from compression through zero pressure and into tension, sheared all the while.
fn torn(t: f64) -> Vector5<f64> {
    let (sin, cos) = (3.0 * std::f64::consts::PI * t).sin_cos();
    principal([0.01 * sin + 0.005 * (1.0 - cos), -0.02 * sin, 0.002 * sin])
}

/// The same where bodies lose their pressure and are pressed again, again and again.
#[test]
fn energy_is_balanced_through_zero_pressure() {
    for (name, law) in laws().into_iter().filter(|(name, _)| !name.starts_with("viscous")) {
        let errors = [100, 1000, 10_000].map(|parts| {
            let (_, [stored, dissipated, work]) = driven(&*law, torn, parts);
            (work - stored - dissipated) / (stored.abs() + dissipated)
        });
        assert!(
            errors[1].abs() < 0.2 * errors[0].abs() + 1e-9 && errors[2].abs() < 0.2 * errors[1].abs() + 1e-9,
            "{name}: {errors:?}"
        );
    }
}
