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
    /// The element without strain at displacements `activation`, by (8); `positions` are those of its nodes in the mesh.
    ///
    /// # Errors
    /// [`ElementError::Degenerate`] when it is inverted there.
    pub fn activated(
        &self,
        section: Section,
        positions: &[Vector2<f64>],
        activation: Vec<Vector2<f64>>,
    ) -> Result<Self, ElementError> {
        let then: Vec<Vector2<f64>> = positions.iter().zip(&activation).map(|(x, u)| x + u).collect();
        let initial = self.initial.clone();
        Ok(Self { initial, activation, ..Self::new(self.kind, self.formulation, section, &then)? })
    }

    /// Displacements since it came.
    pub(super) fn since_activation<'u>(&self, u: &'u [Vector2<f64>]) -> Cow<'u, [Vector2<f64>]> {
        match self.activation.is_empty() {
            true => Cow::Borrowed(u),
            false => u.iter().zip(&self.activation).map(|(u, activation)| u - activation).collect(),
        }
    }
}
