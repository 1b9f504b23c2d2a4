use nalgebra::{Matrix2, Matrix4};

use super::{CauchyStress, ElasticConstants, InvertedElement, Lame, Material, MaterialResponse};
use crate::laws::parameter::InvalidParameter;

/// Linear elasticity: stress proportional to the small strain, whatever the rotation.
///
/// ```text
/// P = λ tr(ε) 1 + 2 G ε,   ε = sym(F) − 1                (1)
/// W = ½ P:ε,   σ_zz = λ tr ε                             (2)
/// ```
///
/// The law does not tell the reference from the current configuration: P is reported as the Cauchy stress.
/// A rotation strains it, so it is for small rotations only; it never inverts.
///
/// # Errors
/// [`InvertedElement`] when F is not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    lame: Lame,
    density: f64,
}

impl Linear {
    /// # Errors
    /// [`InvalidParameter`] when a constant is out of its range.
    pub fn new(constants: &ElasticConstants) -> Result<Self, InvalidParameter> {
        Ok(Self { lame: constants.lame()?, density: constants.density })
    }
}

impl Material for Linear {
    fn density(&self) -> f64 {
        self.density
    }

    fn p_wave_modulus(&self) -> f64 {
        self.lame.constrained_modulus()
    }

    fn shear_modulus(&self) -> f64 {
        self.lame.shear
    }

    fn is_linear(&self) -> bool {
        true
    }

    #[inline(always)]
    fn respond(&self, deformation: &Matrix2<f64>) -> Result<MaterialResponse, InvertedElement> {
        if !deformation.iter().all(|component| component.is_finite()) {
            return Err(InvertedElement { jacobian: f64::NAN });
        }
        let Lame { lambda, shear } = self.lame;
        let displacement_gradient = deformation - Matrix2::identity();
        let strain = 0.5 * (displacement_gradient + displacement_gradient.transpose());
        let stress_zz = lambda * strain.trace();
        let stress = Matrix2::from_diagonal_element(stress_zz) + 2.0 * shear * strain;
        let m = self.p_wave_modulus();
        #[rustfmt::skip]
        let tangent = Matrix4::new(
            m,      0.0,   0.0,   lambda,
            0.0,    shear, shear, 0.0,
            0.0,    shear, shear, 0.0,
            lambda, 0.0,   0.0,   m,
        );
        Ok(MaterialResponse { stress, tangent, energy: 0.5 * stress.dot(&strain), stress_zz })
    }

    fn viscous_stress(&self, [_, rate]: [&Matrix2<f64>; 2]) -> Matrix2<f64> {
        self.hooke(rate)
    }

    fn viscous_variation(&self, _: [&Matrix2<f64>; 2], [_, varied_rate]: [&Matrix2<f64>; 2]) -> Matrix2<f64> {
        self.hooke(varied_rate)
    }

    fn cauchy_stress(&self, deformation: &Matrix2<f64>, _: &[f64]) -> Result<CauchyStress, InvertedElement> {
        let MaterialResponse { stress, stress_zz, .. } = self.respond(deformation)?;
        Ok(CauchyStress { xx: stress.m11, yy: stress.m22, zz: stress_zz, xy: stress.m12 })
    }
}
