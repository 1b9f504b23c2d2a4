use super::components::positive_stretch;
use super::isotropic::{Invariants, StrainEnergy};
use super::{Answer, BulkLaw, ElasticConstants, Lame, MaterialDescription, Straining};
use crate::laws::parameter::InvalidParameter;

/// Saint Venant–Kirchhoff: second Piola–Kirchhoff stress proportional to the Green strain.
///
/// ```text
/// S = λ tr(E) 1 + 2 G E,   E = ½ (FᵀF − 1),   P = F S                           (1)
/// W = λ/2 (tr E)² + G E:E                                                       (2)
///   = (λ + 2G)/2 e² + G/2 (m − j²) + λ e E₃₃ + (λ/2 + G) E₃₃²                   (3)
/// e = m/2 + j,   j = J − 1,   E₃₃ = ½ (h² − 1)
/// ```
///
/// with m = (λ₁ − λ₂)² of the principal stretches in plane, J = λ₁ λ₂, and h = F₃₃ out of it; e is tr E in plane, where E:E = e² − 2 det E.
/// The law softens in strong compression: it is for large rotations but moderate strains.
///
/// # Errors
/// [`MaterialFailure::Inverted`](crate::laws::bulk::MaterialFailure::Inverted) when J = det F is not positive and finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaintVenantKirchhoff {
    lame: Lame,
    density: f64,
}

impl SaintVenantKirchhoff {
    /// # Errors
    /// [`InvalidParameter`] when a constant is out of its range.
    pub fn new(constants: &ElasticConstants) -> Result<Self, InvalidParameter> {
        Ok(Self { lame: constants.lame()?, density: constants.density })
    }
}

impl BulkLaw for SaintVenantKirchhoff {
    fn description(&self) -> MaterialDescription<'_> {
        self.lame.description(self.density)
    }

    #[inline(always)]
    fn respond(&self, straining: &Straining, _: &mut [f64]) -> Answer {
        let h = positive_stretch(straining)?;
        let invariants = Invariants::of(&straining.deformation)?;
        let (Lame { lambda, shear }, constrained) = (self.lame, self.lame.constrained_modulus());
        let (m, j) = (invariants.distortion, invariants.volume_strain);
        let (trace, strain) = (0.5 * m + j, 0.5 * (h - 1.0) * (h + 1.0));
        let stress = lambda * (trace + strain) + 2.0 * shear * strain;
        let energy = StrainEnergy {
            w: 0.5 * (constrained * trace * trace + shear * (m - j * j))
                + (lambda * trace * strain + (0.5 * lambda + shear) * strain * strain),
            w_m: 0.5 * (constrained * trace + shear) + 0.5 * lambda * strain,
            w_j: constrained * trace - shear * j + lambda * strain,
            w_h: h * stress,
            w_mm: 0.25 * constrained,
            w_mj: 0.5 * constrained,
            w_jj: constrained - shear,
            w_mh: 0.5 * lambda * h,
            w_jh: lambda * h,
            w_hh: stress + h * h * constrained,
        };
        Ok(invariants.response(&energy))
    }
}
