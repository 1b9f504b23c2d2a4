use nalgebra::Matrix2;

use super::isotropic::{Invariants, StrainEnergy};
use super::{ElasticConstants, InvertedElement, Lame, Material, MaterialResponse};
use crate::laws::parameter::InvalidParameter;

/// Saint Venant–Kirchhoff: second Piola–Kirchhoff stress proportional to the Green strain.
///
/// ```text
/// S = λ tr(E) 1 + 2 G E,   E = ½ (FᵀF − 1),   P = F S                           (1)
/// W = λ/2 (tr E)² + G E:E                                                       (2)
///   = (λ + 2G)/2 e² + G/2 (m − j²),   e = tr E = m/2 + j,   j = J − 1           (3)
/// σ_zz = λ tr E / J                                                             (4)
/// ```
///
/// with m = (λ₁ − λ₂)² of the principal stretches; (3) is (2) with E:E = (tr E)² − 2 det E.
/// The law softens in strong compression: it is for large rotations but moderate strains.
///
/// # Errors
/// [`InvertedElement`] when J = det F is not positive and finite.
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

impl Material for SaintVenantKirchhoff {
    fn density(&self) -> f64 {
        self.density
    }

    fn p_wave_modulus(&self) -> f64 {
        self.lame.constrained_modulus()
    }

    fn shear_modulus(&self) -> f64 {
        self.lame.shear
    }

    #[inline(always)]
    fn respond(&self, deformation: &Matrix2<f64>) -> Result<MaterialResponse, InvertedElement> {
        let invariants = Invariants::of(deformation)?;
        let (lambda, shear, constrained) = (self.lame.lambda, self.lame.shear, self.p_wave_modulus());
        let (m, j) = (invariants.distortion, invariants.volume_strain);
        let trace = 0.5 * m + j;
        let energy = StrainEnergy {
            w: 0.5 * (constrained * trace * trace + shear * (m - j * j)),
            w_m: 0.5 * (constrained * trace + shear),
            w_j: constrained * trace - shear * j,
            w_mm: 0.25 * constrained,
            w_mj: 0.5 * constrained,
            w_jj: constrained - shear,
        };
        Ok(invariants.response(&energy, lambda * trace / invariants.jacobian))
    }
}
