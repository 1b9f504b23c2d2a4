use super::components::{ln_stretch, positive_stretch};
use super::isotropic::{Invariants, StrainEnergy};
use super::{Answer, BulkLaw, ElasticConstants, Lame, MaterialDescription, Straining};
use crate::laws::parameter::InvalidParameter;

/// Compressible neo-Hookean law.
///
/// ```text
/// W = G/2 (I₁ − 3 − 2 ln J h) + λ/2 (ln J h)²                                         (1)
///   = G/2 m + G (J − 1 + ½ (h² − 1) − ln J h) + λ/2 (ln J h)²                         (2)
/// P = G (F − F⁻ᵀ) + λ ln(J h) F⁻ᵀ,   P₃₃ = G (h − 1/h) + λ ln(J h)/h                  (3)
/// ```
///
/// with m = (λ₁ − λ₂)² of the principal stretches in plane, J = λ₁ λ₂, and h = F₃₃ out of it; (2) is (1) with I₁ = m + 2J + h².
///
/// # Errors
/// [`MaterialFailure::Inverted`](crate::laws::bulk::MaterialFailure::Inverted) when J = det F is not positive and finite.
///
/// Source: Bonet & Wood (2008), Nonlinear Continuum Mechanics for Finite Element Analysis, §6.4.3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean {
    lame: Lame,
    density: f64,
}

impl NeoHookean {
    /// # Errors
    /// [`InvalidParameter`] when a constant is out of its range.
    pub fn new(constants: &ElasticConstants) -> Result<Self, InvalidParameter> {
        Ok(Self { lame: constants.lame()?, density: constants.density })
    }
}

impl BulkLaw for NeoHookean {
    fn description(&self) -> MaterialDescription<'_> {
        self.lame.description(self.density)
    }

    #[inline(always)]
    fn respond(&self, straining: &Straining, _: &mut [f64]) -> Answer {
        let h = positive_stretch(straining)?;
        let invariants = Invariants::of(&straining.deformation)?;
        let Lame { lambda, shear } = self.lame;
        let (jacobian, j, ln_j) =
            (invariants.jacobian, invariants.volume_strain, invariants.ln_jacobian() + ln_stretch(h));
        let across = 0.5 * (h - 1.0) * (h + 1.0);
        let energy = StrainEnergy {
            w: 0.5 * shear * invariants.distortion + shear * (j + across - ln_j) + 0.5 * lambda * ln_j * ln_j,
            w_m: 0.5 * shear,
            w_j: (shear * j + lambda * ln_j) / jacobian,
            w_h: (shear * (h - 1.0) * (h + 1.0) + lambda * ln_j) / h,
            w_mm: 0.0,
            w_mj: 0.0,
            w_jj: (shear + lambda * (1.0 - ln_j)) / (jacobian * jacobian),
            w_mh: 0.0,
            w_jh: lambda / (jacobian * h),
            w_hh: (shear * (h * h + 1.0) + lambda * (1.0 - ln_j)) / (h * h),
        };
        Ok(invariants.response(&energy))
    }
}
