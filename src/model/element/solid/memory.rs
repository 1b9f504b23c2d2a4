//! Elements whose material remembers, or whose tangent is not symmetric.

use nalgebra::Vector2;

use super::f_bar::contract;
use super::{SolidElement, add_force, deformation_gradient};
use crate::laws::bulk::{Evolution, InvertedElement, Material, Straining};

/// What an element's material remembers over an increment: its variables at the first quadrature point, then at the second, …
#[derive(Debug)]
pub struct Memory<'a> {
    /// Δt [T]
    pub dt: f64,
    /// Committed
    pub old: &'a [f64],
    /// Of the trial, written over
    pub new: &'a mut [f64],
}

impl SolidElement {
    /// Force (2) and, on request, tangent (3) of a material with memory, or whose tangent is not symmetric; returns the stored
    /// energy, and what the increment dissipated.
    ///
    /// # Errors
    /// [`InvertedElement`] when the material is turned inside out at a quadrature point.
    pub fn evolve(
        &self,
        material: &dyn Material,
        memory: Memory,
        u: &[Vector2<f64>],
        force: &mut [f64],
        mut tangent: Option<&mut [f64]>,
    ) -> Result<[f64; 2], InvertedElement> {
        if self.hoop.is_some() {
            return self.ring(material, memory, u, force, tangent);
        }
        let Memory { dt, old, new } = memory;
        force.fill(0.0);
        if let Some(tangent) = tangent.as_deref_mut() {
            tangent.fill(0.0);
        }
        let (centre, count) = (self.centre(u)?, material.variables().len());
        let [mut energy, mut dissipated] = [0.0; 2];
        for (k, (gradients, volume)) in self.points().enumerate() {
            let deformation = deformation_gradient(gradients, u);
            let r = centre.as_ref().map_or(Ok(1.0), |centre| centre.stretch(&deformation))?;
            let own = k * count..(k + 1) * count;
            let straining = Straining { deformation: r * deformation, stretch: 1.0, dt, old: &old[own.clone()] };
            let Evolution { mut response, dissipation } = material.evolve(&straining, &mut new[own])?;
            response.stress /= r;
            energy += volume * response.energy;
            dissipated += volume * dissipation;
            add_force(gradients, &(volume * response.stress), force);
            let Some(tangent) = tangent.as_deref_mut() else { continue };
            for (dof, column) in tangent.chunks_exact_mut(2 * u.len()).enumerate() {
                let varied = Vector2::ith(dof % 2, 1.0) * gradients[dof / 2].transpose();
                add_force(gradients, &(volume * contract(&response.tangent, &varied)), column);
            }
            if let Some(centre) = &centre {
                centre.add_tangent(gradients, &deformation, volume, &response, tangent);
            }
        }
        Ok([energy, dissipated])
    }
}
