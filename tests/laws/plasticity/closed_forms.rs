//! Plastic laws against closed forms: bars, the closest point, collapse in plane strain, relaxation.

use super::*;

/// Plane stress with the other in-plane stress zero: λ₁ and the true strain ln λ₂, Kirchhoff stress of a bar.
struct Bar {
    law: Box<dyn Material>,
    old: Vec<f64>,
    lateral: f64,
}

impl Bar {
    fn new(law: Box<dyn Material>) -> Self {
        let law = in_plate(law);
        Self { old: vec![0.0; law.description().variables.len()], law, lateral: 1.0 }
    }

    /// τ₁₁ at a logarithmic strain.
    fn pull(&mut self, strain: f64) -> f64 {
        for _ in 0..50 {
            let mut new = self.old.clone();
            let f = Matrix2::new(strain.exp(), 0.0, 0.0, self.lateral);
            let now = with!(Straining::new(f, &self.old), dt: 1.0);
            let answer = in_plane(&*self.law, now, &mut new).expect("an answer");
            let change = answer.stress.m22 / answer.tangent[(3, 3)];
            if change.abs() < 1e-14 {
                self.old = new;
                return answer.stress.m11 * strain.exp();
            }
            self.lateral -= change;
        }
        panic!("the bar finds no lateral stretch");
    }
}

/// Uniaxial tension: τ = Y(ε̄) and ln λ = τ/E + ε̄ at any size, exact in one increment.
#[test]
fn a_bar_hardens_as_its_curve_says() {
    let law = || with_elasticity(json!({"model": "von_mises", "sigma_y": SIGMA_Y, "H": 3.0, "Q": 0.2, "b": 30.0}));
    for equivalent in [1e-4, 0.01, 0.1, 0.18f64] {
        let strength = SIGMA_Y + 3.0 * equivalent + 0.2 * (1.0 - (-30.0 * equivalent).exp());
        let mut bar = Bar::new(law());
        close("τ", bar.pull(strength / E + equivalent), strength, 1e-12);
        close("ε̄", bar.old[9], equivalent, 1e-13);
    }
}

/// Monotonic and cyclic: X = C/γ (1 − e^(−γ ε_p)), and the stabilised loop X_max = (C/γ) tanh(γ Δε_p/2) of Armstrong and Frederick.
#[test]
fn a_back_stress_saturates_and_loops() {
    let (c, gamma) = (20.0, 60.0);
    let given = json!({"model": "von_mises", "sigma_y": SIGMA_Y, "back_stresses": [{"C": c, "gamma": gamma}]});
    let law = || with_elasticity(given.clone());
    let (mut bar, parts) = (Bar::new(law()), 400);
    let plastic = 0.03;
    let closed = c / gamma * (1.0 - f64::exp(-gamma * plastic));
    let strain = (SIGMA_Y + closed) / E + plastic;
    let mut stress = 0.0;
    (1..=parts).for_each(|k| stress = bar.pull(strain * f64::from(k) / f64::from(parts)));
    close("X", stress - SIGMA_Y, closed, 2e-3 * closed);
    // Between ±ε: the amplitude of the plastic strain follows from that of the stress.
    let amplitude = 0.012;
    let mut bar = Bar::new(law());
    let mut at = 0.0;
    let mut ends = Vec::new();
    for end in [amplitude, -amplitude].repeat(8) {
        for k in 1..=parts {
            stress = bar.pull(at + (end - at) * f64::from(k) / f64::from(parts));
        }
        at = end;
        ends.push(stress);
    }
    let [low, high] = [ends[15], ends[14]];
    close("symmetric", high + low, 0.0, 1e-3);
    let plastic = 2.0 * amplitude - (high - low) / E;
    let closed = c / gamma * (0.5 * gamma * plastic).tanh();
    close("X_max", high - SIGMA_Y, closed, 2e-3 * closed);
}

/// The stress nearest to a trial stress in the metric of C⁻¹ among those that fulfil all six inequalities: Hildreth's method on the dual.
fn nearest(trial: &Vector3<f64>, [c, phi]: [f64; 2], tension: Option<f64>) -> Vector3<f64> {
    let stiffness = Matrix3::repeat(K - 2.0 / 3.0 * G) + Matrix3::from_diagonal_element(2.0 * G);
    let (sin, cos) = phi.to_radians().sin_cos();
    let mut planes: Vec<(Vector3<f64>, f64)> = Vec::new();
    for (i, j) in [(0, 1), (1, 0), (0, 2), (2, 0), (1, 2), (2, 1)] {
        let mut normal = Vector3::zeros();
        (normal[i], normal[j]) = (1.0 + sin, sin - 1.0);
        planes.push((normal, 2.0 * c * cos));
    }
    planes.extend(tension.into_iter().flat_map(|limit| [0, 1, 2].map(|i| (Vector3::ith(i, 1.0), limit))));
    let mut multipliers = vec![0.0; planes.len()];
    let mut stress = *trial;
    for _ in 0..200_000 {
        let mut change = 0.0f64;
        for ((normal, limit), multiplier) in planes.iter().zip(&mut multipliers) {
            let flow = stiffness * normal;
            let next = f64::max(0.0, *multiplier + (normal.dot(&stress) - limit) / normal.dot(&flow));
            stress -= (next - *multiplier) * flow;
            change = change.max((next - *multiplier).abs());
            *multiplier = next;
        }
        if change < 1e-15 {
            break;
        }
    }
    stress
}

/// Associated Mohr–Coulomb is the closest-point projection onto its planes: faces, corners, tips, with tension cut-off or not.
#[test]
fn mohr_coulomb_is_the_closest_point() {
    let mut random = Random(29);
    for (phi, tension) in [(30.0, None), (20.0, Some(0.05)), (0.0, None), (0.0, Some(0.08)), (35.0, Some(1.0))] {
        let mut given = json!({"model": "mohr_coulomb", "c": 0.1, "phi": phi, "psi": phi});
        if let Some(tension) = tension {
            given["tension"] = json!(tension);
        }
        let law = with_elasticity(given);
        for _ in 0..60 {
            let strain = Vector3::from_fn(|_, _| random.between(-0.01, 0.01));
            let trial = (K - 2.0 / 3.0 * G) * strain.sum() * Vector3::repeat(1.0) + 2.0 * G * strain;
            let f = strain.map(f64::exp);
            let old = vec![0.0; law.description().variables.len()];
            let (answer, _) = stretched(&*law, &Vector5::new(f.x, 0.0, 0.0, f.y, f.z), &old).expect("an answer");
            let found = Vector3::new(answer.stress[0] * f.x, answer.stress[3] * f.y, answer.stress[4] * f.z);
            let expected = nearest(&trial, [0.1, phi], tension);
            assert!((found - expected).amax() < 1e-7, "φ = {phi}, {tension:?}: {found} for {expected} from {trial}");
        }
    }
}

/// Compressed along y in plane strain under a constant lateral pressure p: σ_yy = −(p N + 2c √N/J), N = (1 + sin φ)/(1 − sin φ), at the
/// limit (strength is that of τ = J σ), of Mohr–Coulomb and of the cone that is matched to plane strain.
#[test]
fn cone_and_hexagon_collapse_alike_in_plane_strain() {
    let (c, phi, lateral) = (0.1, 25.0f64, 0.2);
    let sin = phi.to_radians().sin();
    let n = (1.0 + sin) / (1.0 - sin);
    for given in [
        json!({"model": "mohr_coulomb", "c": c, "phi": phi, "psi": phi}),
        json!({"model": "mohr_coulomb", "c": c, "phi": phi, "psi": 3}),
        json!({"model": "drucker_prager", "c": c, "phi": phi, "psi": phi, "matching": "plane_strain"}),
    ] {
        let law = with_elasticity(given.clone());
        let (mut old, mut wide, mut sigma, mut expected) =
            (vec![0.0; law.description().variables.len()], 1.0, 0.0, 0.0);
        for k in 1..=200 {
            let high = 1.0 - 0.05 * f64::from(k) / 200.0;
            for iteration in 0.. {
                assert!(iteration < 50, "{given}");
                let (answer, new) =
                    stretched(&*law, &Vector5::new(wide, 0.0, 0.0, high, 1.0), &old).expect("an answer");
                // σ_xx = P₁₁/F₂₂
                let rest = answer.stress[0] + lateral * high;
                if rest.abs() < 1e-13 {
                    (old, sigma) = (new, answer.stress[3] / wide);
                    expected = lateral * n + 2.0 * c * n.sqrt() / (wide * high);
                    break;
                }
                wide -= rest / answer.tangent[(0, 0)];
            }
        }
        close(&given.to_string(), -sigma, expected, 2e-3 * expected);
    }
}

/// Stress relaxes towards the yield surface as e^(−t/τ_v) at a held strain; at once a viscous law is elastic, after long times inviscid.
#[test]
fn overstress_relaxes_in_its_time() {
    let given = |viscosity: f64| json!({"model": "von_mises", "sigma_y": SIGMA_Y, "viscosity": viscosity});
    let [viscous, inviscid] = [given(2.0), given(0.0)].map(with_elasticity);
    let hencky = with_elasticity(json!({"model": "hencky"}));
    let f = Matrix2::new(1.0, 0.02, 0.0, 1.0);
    let zeros = vec![0.0; viscous.description().variables.len()];
    let respond = |law: &dyn Material, old: &[f64], dt: f64| {
        let mut new = vec![0.0; old.len()];
        (in_plane(law, with!(Straining::new(f, old), dt: dt), &mut new).expect("an answer").stress, new)
    };
    let [at_once, last] = [respond(&*viscous, &zeros, 0.0), respond(&*viscous, &zeros, 1e12)];
    let elastic = hencky.at_once(&f).expect("an answer").stress;
    assert!((at_once.0 - elastic).amax() < 1e-13);
    let limit = respond(&*inviscid, &zeros, 1.0).0;
    assert!((last.0 - limit).amax() < 1e-9);
    let (mut old, dt) = (at_once.1, 1e-3);
    let mut stress = at_once.0;
    for _ in 0..3000 {
        (stress, old) = respond(&*viscous, &old, dt);
    }
    let left = (stress.m12 - limit.m12) / (elastic.m12 - limit.m12);
    close("left", left, (-1.5f64).exp(), 1e-3);
}
