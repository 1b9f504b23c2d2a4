use super::isotropic::{Across, Invariants, StrainEnergy};
use super::spatial::positive_stretch;
use super::{
    ElasticConstants, Lame, Material, MaterialDescription, MaterialFailure, MaterialResponse, PlaneStress, Spatial,
    Straining, Stretched,
};
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
/// [`MaterialFailure::Inverted`] when J = det F is not positive and finite.
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

    /// W and its derivatives in plane strain, and e.
    #[inline(always)]
    fn energy(&self, invariants: &Invariants) -> (StrainEnergy, f64) {
        let (shear, constrained) = (self.lame.shear, self.lame.constrained_modulus());
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
        (energy, trace)
    }
}

impl Material for SaintVenantKirchhoff {
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
        let invariants = Invariants::of(&straining.deformation)?;
        let (energy, trace) = self.energy(&invariants);
        Ok(invariants.response(&energy, self.lame.lambda * trace / invariants.jacobian))
    }
}

impl Spatial for SaintVenantKirchhoff {
    /// ```text
    /// W(h) = W(1) + λ e E₃₃ + (λ/2 + G) E₃₃²,   E₃₃ = ½ (h² − 1)
    /// ```
    fn stretched(&self, straining: &Straining, _: &mut [f64]) -> Result<Stretched, MaterialFailure> {
        let h = positive_stretch(straining)?;
        let invariants = Invariants::of(&straining.deformation)?;
        let Lame { lambda, shear } = self.lame;
        let (mut energy, trace) = self.energy(&invariants);
        let strain = 0.5 * (h - 1.0) * (h + 1.0);
        energy.w += lambda * trace * strain + (0.5 * lambda + shear) * strain * strain;
        energy.w_m += 0.5 * lambda * strain;
        energy.w_j += lambda * strain;
        let stress = lambda * (trace + strain) + 2.0 * shear * strain;
        let across = Across {
            w_h: h * stress,
            w_mh: 0.5 * lambda * h,
            w_jh: lambda * h,
            w_hh: stress + h * h * self.lame.constrained_modulus(),
        };
        Ok(invariants.stretched(invariants.response(&energy, 0.0), &across))
    }
}
