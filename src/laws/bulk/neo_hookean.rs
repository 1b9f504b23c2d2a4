use nalgebra::Matrix2;

use super::isotropic::{Across, Invariants, StrainEnergy};
use super::spatial::{ln_stretch, positive_stretch};
use super::{
    ElasticConstants, Lame, Material, MaterialDescription, MaterialFailure, MaterialResponse, PlaneStress, Spatial,
    Straining, Stretched,
};
use crate::laws::parameter::InvalidParameter;

/// Compressible neo-Hookean law.
///
/// ```text
/// W = G/2 (I₁ − 3 − 2 ln J) + λ/2 (ln J)²                             (1)
///   = G/2 m + G (J − 1 − ln J) + λ/2 (ln J)²                          (2)
/// P = G (F − F⁻ᵀ) + λ ln J F⁻ᵀ,   σ_zz = λ ln J / J                   (3)
/// ```
///
/// with m = (λ₁ − λ₂)² of the principal stretches; (2) is (1) with I₁ = m + 2J + 1 in plane strain.
///
/// # Errors
/// [`MaterialFailure::Inverted`] when J = det F is not positive and finite.
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

    /// The answer with a stretch h out of plane, J being that in plane and σ_zz = (G (h − 1/h) + λ/h ln(J h))/J.
    ///
    /// ```text
    /// W = G/2 m + G (J − 1 + (h² − 1)/2 − ln J h) + λ/2 (ln J h)²
    /// ```
    #[inline(always)]
    pub(super) fn at_stretch(&self, deformation: &Matrix2<f64>, h: f64) -> Result<MaterialResponse, MaterialFailure> {
        let invariants = Invariants::of(deformation)?;
        let Lame { lambda, shear } = self.lame;
        let (jacobian, j, ln_j) = (invariants.jacobian, invariants.volume_strain, invariants.ln_jacobian() + h.ln());
        let out_of_plane = 0.5 * (h - 1.0) * (h + 1.0);
        let energy = StrainEnergy {
            w: 0.5 * shear * invariants.distortion + shear * (j + out_of_plane - ln_j) + 0.5 * lambda * ln_j * ln_j,
            w_m: 0.5 * shear,
            w_j: (shear * j + lambda * ln_j) / jacobian,
            w_mm: 0.0,
            w_mj: 0.0,
            w_jj: (shear + lambda * (1.0 - ln_j)) / (jacobian * jacobian),
        };
        Ok(invariants.response(&energy, (shear * (h - 1.0 / h) + lambda * ln_j / h) / jacobian))
    }
}

impl Material for NeoHookean {
    fn description(&self) -> MaterialDescription<'_> {
        self.lame.description(self.density)
    }

    fn plane_stress(&self) -> Option<Box<dyn Material>> {
        Some(Box::new(PlaneStress::new(*self)))
    }

    fn spatial(&self) -> Option<&dyn Spatial> {
        Some(self)
    }

    #[inline(always)]
    fn respond(&self, straining: &Straining, _: &mut [f64]) -> Result<MaterialResponse, MaterialFailure> {
        self.at_stretch(&straining.deformation, 1.0)
    }
}

impl Spatial for NeoHookean {
    /// ```text
    /// ∂W/∂h = G (h − 1/h) + λ ln(J h)/h
    /// ```
    fn stretched(&self, straining: &Straining, _: &mut [f64]) -> Result<Stretched, MaterialFailure> {
        let h = positive_stretch(straining)?;
        let invariants = Invariants::of(&straining.deformation)?;
        let Lame { lambda, shear } = self.lame;
        let (jacobian, ln_j) = (invariants.jacobian, invariants.ln_jacobian() + ln_stretch(h));
        let across = Across {
            w_h: (shear * (h - 1.0) * (h + 1.0) + lambda * ln_j) / h,
            w_mh: 0.0,
            w_jh: lambda / (jacobian * h),
            w_hh: (shear * (h * h + 1.0) + lambda * (1.0 - ln_j)) / (h * h),
        };
        Ok(invariants.stretched(self.at_stretch(&straining.deformation, h)?, &across))
    }
}
