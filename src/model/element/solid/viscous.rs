//! The viscous stress of a damped body.

use nalgebra::{Matrix2, Vector2};

use super::{SolidElement, add_force, deformation_gradient};
use crate::laws::bulk::Material;

impl SolidElement {
    /// Forces on the nodes at displacements `u` and velocities `v` of a viscous stress of the time τ (Kelvin–Voigt), by
    /// the element's own gradients, F-bar or not.
    pub fn viscous_forces(
        &self,
        (material, tau): (&dyn Material, f64),
        [u, v]: [&[Vector2<f64>]; 2],
        forces: &mut [Vector2<f64>],
    ) {
        if self.hoop.is_some() {
            return self.ring_viscous_forces((material, tau), [u, v], forces);
        }
        forces.fill(Vector2::zeros());
        for (gradients, volume) in self.points() {
            let (deformation, rate) = (deformation_gradient(gradients, u), rate_gradient(gradients, v));
            let stress = tau * volume * material.viscous_stress([&deformation, &rate]);
            forces.iter_mut().zip(gradients).for_each(|(force, gradient)| *force += stress * gradient);
        }
    }

    /// Derivative of the viscous forces with respect to `u`, column by column, where the velocity of each dof varies
    /// `dvelocity` times as much as its displacement.
    pub fn viscous_tangent(
        &self,
        (material, tau): (&dyn Material, f64),
        [u, v]: [&[Vector2<f64>]; 2],
        dvelocity: &[f64],
        tangent: &mut [f64],
    ) {
        if self.hoop.is_some() {
            return self.ring_viscous_tangent((material, tau), [u, v], dvelocity, tangent);
        }
        tangent.fill(0.0);
        let n = 2 * u.len();
        for (gradients, volume) in self.points() {
            let (deformation, rate) = (deformation_gradient(gradients, u), rate_gradient(gradients, v));
            for (dof, (column, dvelocity)) in tangent.chunks_exact_mut(n).zip(dvelocity).enumerate() {
                let varied = Vector2::ith(dof % 2, 1.0) * gradients[dof / 2].transpose();
                let stress = material.viscous_variation([&deformation, &rate], [&varied, &(*dvelocity * varied)]);
                add_force(gradients, &(tau * volume * stress), column);
            }
        }
    }
}

/// Ḟ = Σ_a v_a ⊗ ∂N_a/∂X
fn rate_gradient(gradients: &[Vector2<f64>], v: &[Vector2<f64>]) -> Matrix2<f64> {
    v.iter().zip(gradients).fold(Matrix2::zeros(), |sum, (v, gradient)| sum + v * gradient.transpose())
}
