//! The viscous stress of a damped body.

use nalgebra::{Vector2, Vector5};

use super::ring::At;
use super::{SolidElement, deformation_gradient};
use crate::laws::bulk::Material;
use crate::laws::bulk::components::components;

impl SolidElement {
    /// Nodal forces at displacements `u` and velocities `v` of a viscous stress with the retardation time τ (Kelvin–Voigt),
    /// with the element's own gradients, F-bar or not.
    pub fn viscous_forces(
        &self,
        material: &dyn Material,
        tau: f64,
        [u, v]: [&[Vector2<f64>]; 2],
        forces: &mut [Vector2<f64>],
    ) {
        let u = &*self.since_activation(u);
        let (law, mut all) = (material.description(), [0.0; 18]);
        for (at, volume) in self.everywhere() {
            let [deformation, rate] = self.motion(&at, u, v);
            let stress = tau * volume * law.viscous_stress([&deformation, &rate]);
            at.add_force(&stress, &mut all[..2 * u.len()]);
        }
        forces.iter_mut().zip(all.chunks_exact(2)).for_each(|(force, own)| *force = Vector2::new(own[0], own[1]));
    }

    /// Derivative of the viscous forces with respect to `u`, column by column, where the velocity of each dof varies by the
    /// factor `dvelocity` with its displacement.
    pub fn viscous_tangent(
        &self,
        material: &dyn Material,
        tau: f64,
        [u, v]: [&[Vector2<f64>]; 2],
        dvelocity: &[f64],
        tangent: &mut [f64],
    ) {
        let u = &*self.since_activation(u);
        let law = material.description();
        tangent.fill(0.0);
        for (at, volume) in self.everywhere() {
            let [deformation, rate] = self.motion(&at, u, v);
            for (dof, (column, dvelocity)) in tangent.chunks_exact_mut(2 * u.len()).zip(dvelocity).enumerate() {
                let varied = at.variation(dof);
                let stress = law.viscous_variation([&deformation, &rate], [&varied, &(*dvelocity * varied)]);
                at.add_force(&(tau * volume * stress), column);
            }
        }
    }

    /// F and Ḟ at a point.
    fn motion(&self, at: &At, u: &[Vector2<f64>], v: &[Vector2<f64>]) -> [Vector5<f64>; 2] {
        let deformation = match self.hoop {
            Some(_) => at.deformation(u),
            None => components(&deformation_gradient(at.gradients, u), 1.0),
        };
        [deformation, at.gradient(v)]
    }
}
