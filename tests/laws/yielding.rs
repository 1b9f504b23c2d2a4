//! A bulk law that yields, as a user of the library would write it: what it remembers, dissipates and cannot answer goes through the
//! contract of all laws.

use crate::common::{Blocks, close, finished};
use fecontact::laws::bulk::{
    BulkLaw, BulkResponse, CauchyStress, ElasticConstants, InadmissibleStress, Lame, MaterialDescription,
    MaterialFailure, MaterialResponse, Sections, Slot, Straining,
};
use fecontact::model::Model;
use fecontact::model::boundary::Drive;
use fecontact::model::builder::{LoadStep, Support};
use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};

/// Von Mises' criterion with linear isotropic hardening at small strains, by the radial return.
///
/// ```text
/// f = q − Y(ε̄) ≤ 0,   q = √(3/2) ‖s‖,   Y = Y₀ + H ε̄               s: deviator of σ, ε̄: equivalent plastic strain
/// Δε̄ = f_tr/(3G + H),   s = (1 − 3G Δε̄/q_tr) s_tr
/// D = K 1⊗1 + 2G (1 − 3G Δε̄/q_tr) dev + 6G² (Δε̄/q_tr − 1/(3G + H)) n⊗n,   n = s_tr/‖s_tr‖
/// ```
/// Hardening is stored, ½ H ε̄². Increments of ε̄ above 0.1 are refused.
#[derive(Clone, Copy, Debug)]
struct VonMises {
    lame: Lame,
    strength: f64,
    hardening: f64,
}

const LONGEST: f64 = 0.1;

const VARIABLES: [&str; 5] = ["plastic_xx", "plastic_yy", "plastic_zz", "plastic_xy", "equivalent_plastic"];
const PLASTIC: Slot<4> = Slot::FIRST;
const HARDENED: Slot<1> = Slot::after(PLASTIC);

impl BulkLaw for VonMises {
    fn description(&self) -> MaterialDescription<'_> {
        let own =
            MaterialDescription::new(0.0, self.lame.constrained_modulus(), self.lame.shear).remembering(&VARIABLES);
        with!(own, sections: Sections::PlaneStrain)
    }

    /// What has been loaded up to a stress has hardened for it.
    fn begin(&self, _: Vector2<f64>, stress: &CauchyStress, variables: &mut [f64]) -> Result<(), InadmissibleStress> {
        HARDENED.set(variables, (stress.von_mises() - self.strength).max(0.0) / self.hardening);
        Ok(())
    }

    fn respond(&self, straining: &Straining, new: &mut [f64]) -> Result<BulkResponse, MaterialFailure> {
        let (f, shear, old) = (straining.deformation, self.lame.shear, straining.old);
        let bulk = self.lame.lambda + 2.0 / 3.0 * shear;
        // Components xx, yy, zz, xy
        let strain = Vector4::new(f.m11 - 1.0, f.m22 - 1.0, 0.0, 0.5 * (f.m12 + f.m21));
        let (elastic, one) = (strain - Vector4::from(*PLASTIC.of(old)), Vector4::new(1.0, 1.0, 1.0, 0.0));
        let twice = Vector4::new(1.0, 1.0, 1.0, 2.0);
        let volume = elastic.dot(&one);
        let trial = 2.0 * shear * (elastic - volume / 3.0 * one);
        let norm = trial.component_mul(&twice).dot(&trial).sqrt();
        let (q, before) = (1.5f64.sqrt() * norm, HARDENED.value(old));
        let excess = q - self.strength - self.hardening * before;
        let slope = 3.0 * shear + self.hardening;
        let slip = excess.max(0.0) / slope;
        if slip > LONGEST {
            return Err(MaterialFailure::NotConverged { law: "mine", residual: excess / q });
        }
        let left = if slip > 0.0 { 1.0 - 3.0 * shear * slip / q } else { 1.0 };
        let direction = if norm > 0.0 { trial / norm } else { trial };
        let plastic = 1.5f64.sqrt() * slip * direction;
        *PLASTIC.of_mut(new) = (Vector4::from(*PLASTIC.of(old)) + plastic).into();
        HARDENED.set(new, before + slip);
        let stress = left * trial + bulk * volume * one;
        let part = if slip > 0.0 { 6.0 * shear * shear * (slip / q - 1.0 / slope) } else { 0.0 };
        // ∂σ by the strains of F's columns (11, 21, 12, 22), and back to P's
        let varied = |k: usize| {
            let strain = [
                Vector4::new(1.0, 0.0, 0.0, 0.0),
                Vector4::new(0.0, 0.0, 0.0, 0.5),
                Vector4::new(0.0, 0.0, 0.0, 0.5),
                Vector4::new(0.0, 1.0, 0.0, 0.0),
            ][k];
            let volume = strain.dot(&one);
            let along = part * direction.component_mul(&twice).dot(&strain);
            let d = bulk * volume * one + 2.0 * shear * left * (strain - volume / 3.0 * one) + along * direction;
            Vector4::new(d[0], d[3], d[3], d[1])
        };
        let deviator = left * trial;
        let stored = deviator.component_mul(&twice).dot(&deviator) / (4.0 * shear) + 0.5 * bulk * volume * volume;
        let hardened = |equivalent: f64| 0.5 * self.hardening * equivalent * equivalent;
        let first = Matrix2::new(stress[0], stress[3], stress[3], stress[1]);
        let tangent = Matrix4::from_columns(&[0, 1, 2, 3].map(varied));
        let mut response = MaterialResponse::new(first, tangent, stored + hardened(before + slip));
        response.dissipation = left * q * slip - (hardened(before + slip) - hardened(before));
        let mut response = BulkResponse::from(response);
        response.stress[4] = stress[2] * f.determinant();
        Ok(response)
    }
}

const STRENGTH: f64 = 0.3;
const HARDENING: f64 = 8.0;

fn law() -> VonMises {
    let lame = ElasticConstants::new(100.0, 0.3).lame().expect("good constants");
    VonMises { lame, strength: STRENGTH, hardening: HARDENING }
}

fn answer(f: Matrix2<f64>, old: &[f64]) -> (MaterialResponse, Vec<f64>) {
    let mut new = vec![0.0; old.len()];
    let response = law().respond(&with!(Straining::new(f, old), dt: 1.0), &mut new);
    (response.expect("an answer").into(), new)
}

/// Elastic, loading further, loading across, unloading: the tangent is that of what was computed, and symmetric.
#[test]
fn the_tangent_of_the_return_equals_differences() {
    let (first, old) = answer(Matrix2::new(1.004, 0.006, -0.001, 0.997), &[0.0; 5]);
    assert!(first.dissipation > 0.0 && old[4] > 1e-3);
    for (f, yields) in [
        (Matrix2::new(1.006, 0.009, -0.002, 0.996), true),
        (Matrix2::new(1.001, -0.009, 0.002, 1.004), true),
        (Matrix2::new(1.0039, 0.0058, -0.001, 0.9971), false),
    ] {
        let (response, new) = answer(f, &old);
        assert_eq!(new[4] > old[4], yields);
        let tangent = Matrix4::from_columns(&[0, 1, 2, 3].map(|k| {
            let at = |step: f64| {
                let mut f = f;
                f[k] += step;
                Vector4::from_column_slice(answer(f, &old).0.stress.as_slice())
            };
            (at(1e-6) - at(-1e-6)) / 2e-6
        }));
        assert!((tangent - response.tangent).amax() < 1e-6 * tangent.amax(), "{tangent} {}", response.tangent);
        assert!((response.tangent - response.tangent.transpose()).amax() < 1e-12 * tangent.amax());
    }
}

/// In shear the return is exact whatever the increments: τ = (Y₀ + H ε̄)/√3, ε̄ = (√3 G γ − Y₀)/(3G + H). What is dissipated is
/// Y₀ ε̄, hardening being stored, and ½ H Δε̄² more an increment by the backward rule, Δε̄ ≤ √3 G Δγ/(3G + H).
#[test]
fn shear_follows_its_closed_form() {
    let gamma = 0.02;
    let equivalent = (3f64.sqrt() * law().lame.shear * gamma - STRENGTH) / (3.0 * law().lame.shear + HARDENING);
    for parts in [1, 7, 100] {
        let (mut old, mut dissipated, mut tau) = (vec![0.0; 5], 0.0, 0.0);
        for k in 1..=parts {
            let (response, new) = answer(Matrix2::new(1.0, gamma * f64::from(k) / f64::from(parts), 0.0, 1.0), &old);
            (old, tau) = (new, response.stress.m12);
            dissipated += response.dissipation;
        }
        close("τ", tau, (STRENGTH + HARDENING * equivalent) / 3f64.sqrt(), 1e-14);
        close("ε̄", old[4], equivalent, 1e-15);
        let longest = (equivalent + STRENGTH / (3.0 * law().lame.shear + HARDENING)) / f64::from(parts);
        let more = dissipated - STRENGTH * equivalent;
        assert!((0.0..=0.5 * HARDENING * equivalent * longest).contains(&more), "{more}");
    }
}

/// A sheared block of such a law has its force, and its energy is balanced; increments that it refuses are cut, which is told.
#[test]
fn a_body_yields_and_what_it_refuses_is_cut() {
    let sheared = |gamma: f64, dt: f64| {
        let mesh = Blocks::default().rectangle("block", [2, 1], [0.0, 0.0], [1.0, 1.0]).mesh();
        let drawn = Support::on("block_top").ux(Drive::Rate(gamma)).uy(0.0);
        let bottom = Support::on("block_bottom").ux(0.0).uy(0.0);
        let builder = Model::builder(mesh).body("block", law());
        let step = LoadStep::new("shear", 1.0).dt(dt).support(bottom).support(drawn);
        finished(builder.step(step).build().expect("a model"))
    };
    let run = sheared(0.02, 0.05);
    let equivalent = (3f64.sqrt() * law().lame.shear * 0.02 - STRENGTH) / (3.0 * law().lame.shear + HARDENING);
    let tau = (STRENGTH + HARDENING * equivalent) / 3f64.sqrt();
    close("force", run.reaction("block_top", run.last())[0], tau, 1e-9 * tau);
    let energy = run.last().energy;
    close("energy error", energy.error(), 0.0, 0.02 * energy.external_work);
    assert_eq!(run.report.cutbacks, 0);
    let refused = sheared(0.4, 1.0);
    let given_up = &refused.report.given_up;
    assert!(given_up.get("material law").is_some_and(|times| *times > 0), "Δε̄ is 0.21 in one increment: {given_up:?}");
    let equivalent = (3f64.sqrt() * law().lame.shear * 0.4 - STRENGTH) / (3.0 * law().lame.shear + HARDENING);
    let memory = &refused.last().memory;
    assert!(memory.chunks_exact(5).all(|point| (point[4] - equivalent).abs() < 1e-9), "{memory:?}");
}

/// A body remembers its initial stress from the start, point by point.
#[test]
fn an_initial_stress_hardens() {
    let mut variables = [0.0; 5];
    let stress = CauchyStress { xx: 0.5, yy: 0.5, zz: 0.5, xy: 0.4 };
    law().begin(Vector2::zeros(), &stress, &mut variables).expect("it hardens for any");
    close("ε̄", variables[4], (3f64.sqrt() * 0.4 - STRENGTH) / HARDENING, 1e-15);
}
