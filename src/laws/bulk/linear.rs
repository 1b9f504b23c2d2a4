use nalgebra::{Matrix2, Matrix5};

use super::components::components;
use super::{Answer, BulkLaw, BulkResponse, ElasticConstants, Lame, MaterialDescription, MaterialFailure, Straining};
use crate::laws::parameter::InvalidParameter;

/// Linear elasticity: stress proportional to the small strain, whatever the rotation.
///
/// ```text
/// P = λ tr(ε) 1 + 2 G ε,   ε = sym(F) − 1                (1)
/// W = ½ P:ε                                              (2)
/// ```
///
/// The law does not distinguish the reference from the current configuration: P is reported as the Cauchy stress. A
/// rotation strains it, so it is for small rotations only; it never inverts.
///
/// # Errors
/// [`MaterialFailure::Inverted`] when F is not finite.
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

impl BulkLaw for Linear {
    fn description(&self) -> MaterialDescription<'_> {
        MaterialDescription { is_linear: true, ..self.lame.description(self.density) }
    }

    #[inline(always)]
    fn respond(&self, straining: &Straining, _: &mut [f64]) -> Answer {
        let Straining { deformation, stretch, .. } = straining;
        if !deformation.iter().all(|component| component.is_finite()) {
            return Err(MaterialFailure::Inverted { jacobian: f64::NAN });
        }
        let (Lame { lambda: l, shear: g }, m) = (self.lame, self.lame.constrained_modulus());
        let displacement_gradient = deformation - Matrix2::identity();
        let strain = 0.5 * (displacement_gradient + displacement_gradient.transpose());
        let (trace, across) = (strain.trace(), stretch - 1.0);
        let in_plane = Matrix2::from_diagonal_element(l * trace) + 2.0 * g * strain;
        let energy = 0.5 * in_plane.dot(&strain) + l * trace * across + 0.5 * m * across * across;
        let stress = components(&(in_plane + Matrix2::from_diagonal_element(l * across)), l * trace + m * across);
        #[rustfmt::skip]
        let tangent = Matrix5::new(
            m,   0.0, 0.0, l,   l,
            0.0, g,   g,   0.0, 0.0,
            0.0, g,   g,   0.0, 0.0,
            l,   0.0, 0.0, m,   l,
            l,   0.0, 0.0, l,   m,
        );
        Ok(BulkResponse::new(stress, tangent, energy))
    }
}
