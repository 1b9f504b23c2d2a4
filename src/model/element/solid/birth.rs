//! An element that comes into a model that has deformed: its reference geometry is that of its nodes then.
//!
//! ```text
//! x_b = X + u_b,   F = 1 + Σ_a (u_a − u_ba) ⊗ ∂N_a/∂x_b               u_b: displacements when it comes                   (8)
//! ```

use std::borrow::Cow;

use nalgebra::Vector2;

use super::SolidElement;
use crate::mesh::section::Section;
use crate::model::element::ElementError;

impl SolidElement {
    /// The element without strain at displacements `birth`, by (8); `positions` are those of its nodes in the mesh.
    ///
    /// # Errors
    /// [`ElementError::Degenerate`] when it is inverted there.
    pub fn activated(
        &self,
        section: Section,
        positions: &[Vector2<f64>],
        birth: Vec<Vector2<f64>>,
    ) -> Result<Self, ElementError> {
        let then: Vec<Vector2<f64>> = positions.iter().zip(&birth).map(|(x, u)| x + u).collect();
        let initial = self.initial.clone();
        Ok(Self { initial, birth, ..Self::new(self.kind, self.formulation, section, &then)? })
    }

    /// Displacements since it came.
    pub(super) fn since_birth<'u>(&self, u: &'u [Vector2<f64>]) -> Cow<'u, [Vector2<f64>]> {
        match self.birth.is_empty() {
            true => Cow::Borrowed(u),
            false => u.iter().zip(&self.birth).map(|(u, birth)| u - birth).collect(),
        }
    }
}
