//! F-bar, (4) to (6) of [`SolidElement`].

use nalgebra::{Matrix2, Matrix4, Vector2};

use super::{SolidElement, add_force, deformation_gradient};
use crate::laws::bulk::{InvertedElement, Material, MaterialResponse, cofactor, positive_jacobian};

/// The centre of an F-bar element at the current displacements.
pub(super) struct Centre<'a> {
    gradients: &'a [Vector2<f64>],
    jacobian: f64,
    /// F₀⁻ᵀ
    inverse_transpose: Matrix2<f64>,
}

impl SolidElement {
    pub(super) fn centre(&self, u: &[Vector2<f64>]) -> Result<Option<Centre<'_>>, InvertedElement> {
        let Some(gradients) = &self.centre else { return Ok(None) };
        let deformation = deformation_gradient(gradients, u);
        let jacobian = positive_jacobian(&deformation)?;
        Ok(Some(Centre { gradients, jacobian, inverse_transpose: cofactor(&deformation) / jacobian }))
    }
}

impl Centre<'_> {
    /// r = √(J₀/J) of (4)
    pub(super) fn stretch(&self, deformation: &Matrix2<f64>) -> Result<f64, InvertedElement> {
        Ok((self.jacobian / positive_jacobian(deformation)?).sqrt())
    }

    /// The law at F̄, with the stress (5).
    pub(super) fn respond(
        &self,
        material: &dyn Material,
        deformation: &Matrix2<f64>,
    ) -> Result<MaterialResponse, InvertedElement> {
        let stretch = self.stretch(deformation)?;
        let mut response = material.respond(&(stretch * deformation))?;
        response.stress /= stretch;
        Ok(response)
    }

    /// Adds the second term of (6), a dyad of a nodal force and a nodal volume change.
    pub(super) fn add_tangent(
        &self,
        gradients: &[Vector2<f64>],
        deformation: &Matrix2<f64>,
        volume: f64,
        response: &MaterialResponse,
        tangent: &mut [f64],
    ) {
        let inverse_transpose = cofactor(deformation) / deformation.determinant();
        let stress = 0.5 * volume * (contract(&response.tangent, deformation) - response.stress);
        let columns = tangent.chunks_exact_mut(4 * gradients.len());
        for ((columns, at_centre), here) in columns.zip(self.gradients).zip(gradients) {
            let volume_change = self.inverse_transpose * at_centre - inverse_transpose * here;
            for (column, change) in columns.chunks_exact_mut(2 * gradients.len()).zip(&volume_change) {
                add_force(gradients, &(*change * stress), column);
            }
        }
    }
}

/// A_iJkL F_kL
pub(super) fn contract(tangent: &Matrix4<f64>, f: &Matrix2<f64>) -> Matrix2<f64> {
    let stress =
        tangent.column(0) * f.m11 + tangent.column(1) * f.m21 + tangent.column(2) * f.m12 + tangent.column(3) * f.m22;
    Matrix2::new(stress[0], stress[2], stress[1], stress[3])
}
