//! Mean volume change of an element, by which the pressure of the fluid in its pores goes.

use nalgebra::{Vector2, Vector5};

use super::SolidElement;
use super::ring::{inverse_transpose, jacobian};
use crate::laws::bulk::Answer;

impl SolidElement {
    /// ⟨ln J⟩ over the reference volume at displacements `u`, or ⟨tr ε⟩ of a linear material; on request its derivatives,
    /// ⟨F⁻ᵀ:δF⟩ or ⟨tr δε⟩, two a node.
    ///
    /// # Errors
    /// [`MaterialFailure::Inverted`](crate::laws::bulk::MaterialFailure::Inverted) when det F is not positive.
    pub fn mean_volume_change(&self, is_linear: bool, u: &[Vector2<f64>], mut by: Option<&mut [f64]>) -> Answer<f64> {
        let u = &*self.since_activation(u);
        let whole: f64 = self.everywhere().map(|(_, volume)| volume).sum();
        if let Some(by) = by.as_deref_mut() {
            by.fill(0.0);
        }
        let mut mean = 0.0;
        for (at, volume) in self.everywhere() {
            let share = volume / whole;
            let f = at.deformation(u);
            let (change, inverse) = match is_linear {
                true => (f[0] + f[3] + f[4] - 3.0, Vector5::new(1.0, 0.0, 0.0, 1.0, 1.0)),
                false => (jacobian(&f)?.ln(), inverse_transpose(&f)),
            };
            mean += share * change;
            let derivatives = by.as_deref_mut().into_iter().flatten().enumerate();
            derivatives.for_each(|(dof, by)| *by += share * inverse.dot(&at.variation(dof)));
        }
        Ok(mean)
    }
}
