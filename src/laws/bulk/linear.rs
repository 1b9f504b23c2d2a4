use nalgebra::{Matrix2, Matrix4, Vector4};

use super::spatial::OutOfPlane;
use super::{
    CauchyStress, ElasticConstants, Lame, Material, MaterialDescription, MaterialFailure, MaterialResponse, Spatial,
    Straining, Stretched,
};
use crate::laws::parameter::InvalidParameter;

/// Linear elasticity: stress proportional to the small strain, whatever the rotation.
///
/// ```text
/// P = λ tr(ε) 1 + 2 G ε,   ε = sym(F) − 1                (1)
/// W = ½ P:ε,   σ_zz = λ tr ε                             (2)
/// ```
///
/// The law does not distinguish the reference from the current configuration: P is reported as the Cauchy stress. A
/// rotation strains it, so it is for small rotations only; it never inverts. In plane stress it is (1) with λ* = 2 λ
/// G/(λ + 2G) in place of λ, and σ_zz = 0.
///
/// # Errors
/// [`MaterialFailure::Inverted`] when F is not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    lame: Lame,
    /// σ_zz/tr ε [F/L²]
    across: f64,
    density: f64,
}

impl Linear {
    /// # Errors
    /// [`InvalidParameter`] when a constant is out of its range.
    pub fn new(constants: &ElasticConstants) -> Result<Self, InvalidParameter> {
        let lame = constants.lame()?;
        Ok(Self { lame, across: lame.lambda, density: constants.density })
    }
}

impl Material for Linear {
    fn description(&self) -> MaterialDescription<'_> {
        MaterialDescription { is_linear: true, ..self.lame.description(self.density) }
    }

    fn plane_stress(&self) -> Option<Box<dyn Material>> {
        let Lame { lambda, shear } = self.lame;
        let lambda = 2.0 * lambda * shear / (lambda + 2.0 * shear);
        Some(Box::new(Self { lame: Lame { lambda, shear }, across: 0.0, ..*self }))
    }

    /// 1 − λ*/(2 G) tr ε in a plate: λ*/(2 G) = λ/(λ + 2 G).
    fn stretch_across(&self, deformation: &Matrix2<f64>, _: &[f64]) -> Result<f64, MaterialFailure> {
        let is_plate = self.across == 0.0;
        let share = if is_plate { self.lame.lambda / (2.0 * self.lame.shear) } else { 0.0 };
        Ok(1.0 - share * (deformation.trace() - 2.0))
    }

    fn spatial(&self) -> Option<&dyn Spatial> {
        Some(self)
    }

    #[inline(always)]
    fn respond(&self, straining: &Straining, _: &mut [f64]) -> Result<MaterialResponse, MaterialFailure> {
        let deformation = &straining.deformation;
        if !deformation.iter().all(|component| component.is_finite()) {
            return Err(MaterialFailure::Inverted { jacobian: f64::NAN });
        }
        let Lame { lambda, shear } = self.lame;
        let displacement_gradient = deformation - Matrix2::identity();
        let strain = 0.5 * (displacement_gradient + displacement_gradient.transpose());
        let trace = strain.trace();
        let stress = Matrix2::from_diagonal_element(lambda * trace) + 2.0 * shear * strain;
        let m = self.lame.constrained_modulus();
        #[rustfmt::skip]
        let tangent = Matrix4::new(
            m,      0.0,   0.0,   lambda,
            0.0,    shear, shear, 0.0,
            0.0,    shear, shear, 0.0,
            lambda, 0.0,   0.0,   m,
        );
        let (energy, stress_zz) = (0.5 * stress.dot(&strain), self.across * trace);
        Ok(MaterialResponse { stress, tangent, energy, stress_zz, dissipation: 0.0 })
    }

    fn viscous_stress(&self, [_, rate]: [&Matrix2<f64>; 2]) -> Matrix2<f64> {
        self.hooke(rate)
    }

    fn viscous_variation(&self, _: [&Matrix2<f64>; 2], [_, varied_rate]: [&Matrix2<f64>; 2]) -> Matrix2<f64> {
        self.hooke(varied_rate)
    }

    fn cauchy_stress(&self, deformation: &Matrix2<f64>, _: &[f64]) -> Result<CauchyStress, MaterialFailure> {
        let MaterialResponse { stress, stress_zz, .. } = self.at_once(deformation)?;
        Ok(CauchyStress { xx: stress.m11, yy: stress.m22, zz: stress_zz, xy: stress.m12 })
    }
}

impl Spatial for Linear {
    fn stretched(&self, straining: &Straining, _: &mut [f64]) -> Result<Stretched, MaterialFailure> {
        let MaterialResponse { stress, tangent, energy, .. } = self.respond(straining, &mut [])?;
        let strain = straining.stretch - 1.0;
        let trace = straining.deformation.m11 - 1.0 + (straining.deformation.m22 - 1.0);
        let Lame { lambda, .. } = self.lame;
        let modulus = self.lame.constrained_modulus();
        let stress = stress + Matrix2::from_diagonal_element(lambda * strain);
        let energy = energy + lambda * trace * strain + 0.5 * modulus * strain * strain;
        let coupling = Vector4::new(lambda, 0.0, 0.0, lambda);
        let across = OutOfPlane { stress: lambda * trace + modulus * strain, coupling, stiffness: modulus };
        Ok(Stretched::new(stress, tangent, across, energy))
    }
}
