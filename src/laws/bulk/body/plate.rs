//! Plates: F₃₃ is what leaves no out-of-plane stress.
//!
//! ```text
//! τ₃₃ = h P₃₃(F, h) = 0,   h = F₃₃                                            solved for ln h               (1)
//! A = ∂P/∂F − (∂P/∂h)(∂P/∂h)ᵀ / (∂P₃₃/∂h)                                     consistent tangent            (2)
//! ```
//! (1) is solved by Newton's method from h = J^(−λ/(λ + 2G)), which is its solution for Hencky's law, or what a law that yields
//! [remembers](BulkLaw::ln_free_stretch); of a linear law h = 1 − P₃₃/(∂P₃₃/∂h) of the answer at h = 1. Moduli of small strains are those
//! of a plate: the P-wave modulus is E/(1 − ν²) = 4 G (λ + G)/(λ + 2G), so that waves, absorbing sides, penalties and damping are a
//! plate's.

use nalgebra::{Vector4, Vector5};

use super::BodyLaw;
use crate::laws::bulk::components::{moduli, plane_moduli};
use crate::laws::bulk::{Answer, BulkLaw, BulkResponse, MaterialFailure, Straining};

/// Most iterations for (1).
const ITERATIONS: usize = 60;

/// Name of the search for the stretch in messages.
const PLATE: &str = "plane_stress";

/// ln h is known to so much; the rest is brought in by the tangent.
const KNOWN: f64 = 1e-13;

/// E/(1 − ν²) of λ + 2G and G.
pub(super) fn modulus(modulus: f64, shear: f64) -> f64 {
    4.0 * shear * (modulus - shear) / modulus
}

impl BodyLaw {
    /// The answer where nothing is pressed across the plane.
    pub(super) fn free(&self, straining: &Straining, new: &mut [f64]) -> Answer {
        let (h, answer) = match self.linear {
            true => self.opened(straining, new)?,
            false => self.solved(straining, new)?,
        };
        let (stress, tangent) = (answer.stress, answer.tangent);
        let [by_h, of_33]: [Vector4<f64>; 2] =
            [tangent.fixed_view::<4, 1>(0, 4).into(), tangent.fixed_view::<1, 4>(4, 0).transpose()];
        let stiffness = tangent[(4, 4)];
        let rest = by_h * (stress[4] / stiffness);
        let plane = plane_moduli(&tangent) - by_h * of_33.transpose() / stiffness;
        let none = Vector4::zeros();
        Ok(BulkResponse {
            stress: Vector5::new(
                stress[0] - rest[0],
                stress[1] - rest[1],
                stress[2] - rest[2],
                stress[3] - rest[3],
                0.0,
            ),
            tangent: moduli(&plane, &none, &none, 0.0),
            free_stretch: Some(h),
            ..answer
        })
    }

    /// h of a linear law, and the answer there.
    fn opened(&self, straining: &Straining, new: &mut [f64]) -> Answer<(f64, BulkResponse)> {
        let at = Straining { tangent: true, stretch: 1.0, ..*straining };
        let answer = self.stretched(&at, new)?;
        let h = 1.0 - answer.stress[4] / answer.tangent[(4, 4)];
        self.stretched(&Straining { stretch: h, ..at }, new).map(|answer| (h, answer))
    }

    /// h of (1), and the answer there.
    fn solved(&self, straining: &Straining, new: &mut [f64]) -> Answer<(f64, BulkResponse)> {
        let left = |stress: f64| {
            let residual = stress / self.law.description().p_wave_modulus;
            MaterialFailure::NotConverged { law: PLATE, residual }
        };
        let mut ln_h = self.ln_free_stretch(straining)?;
        let mut rest = 0.0;
        for _ in 0..ITERATIONS {
            let h = 1.0 + ln_h.exp_m1();
            let answer = self.stretched(&Straining { stretch: h, tangent: true, ..*straining }, new)?;
            let stress = h * answer.stress[4];
            let slope = stress + h * h * answer.tangent[(4, 4)];
            if !(slope > 0.0 && slope.is_finite() && answer.tangent[(4, 4)] > 0.0) {
                return Err(left(stress));
            }
            let change = -stress / slope;
            if change.abs() <= KNOWN {
                return Ok((h, answer));
            }
            (ln_h, rest) = (ln_h + change.clamp(-1.0, 1.0), stress);
        }
        Err(left(rest))
    }
}
