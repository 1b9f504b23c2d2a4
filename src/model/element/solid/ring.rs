//! Axisymmetric elements about x = 0, x being the radius.
//!
//! ```text
//! F₃₃ = 1 + Σ_a u_ax N_a/R,   f_ai = ∫ (P_iJ N_a,J + δ_ix P₃₃ N_a/R) dV,   dV = 2π R dA                    (7)
//! ```
//! Quadrature points lie off the axis, so that u_r/R is finite for elements at the axis too.

use nalgebra::{Vector2, Vector5};

use super::{Memory, SolidElement};
use crate::laws::bulk::components::{components, plane};
use crate::laws::bulk::{Answer, BulkResponse, Material, MaterialFailure, Straining, cofactor, positive_jacobian};

/// ∂N_a/∂X and N_a/R at a point; the latter are 0 in plane.
#[derive(Clone, Copy, Default)]
pub(super) struct At<'a> {
    pub gradients: &'a [Vector2<f64>],
    hoop: &'a [f64],
}

impl SolidElement {
    /// Force (7) and, on request, its tangent; returns the stored and the dissipated energy of the increment.
    pub(super) fn ring(
        &self,
        material: &dyn Material,
        Memory { dt, old, new }: Memory,
        u: &[Vector2<f64>],
        force: &mut [f64],
        mut tangent: Option<&mut [f64]>,
    ) -> Answer<[f64; 2]> {
        let (count, wanted, seen) = (material.description().variables.len(), tangent.is_some(), self.seen(u)?);
        let mut answers = [BulkResponse::default(); 9];
        for ((k, seen), answer) in seen.iter().enumerate().zip(&mut answers) {
            let own = k * count..(k + 1) * count;
            let now = Straining { tangent: wanted, ..straining(seen, dt, &old[own.clone()]) };
            *answer = material.in_space(&now, &mut new[own])?;
        }
        let u = &*self.since_activation(u);
        if let (Some(mean), Some(answers)) = (self.mean(u)?, answers.first_chunk()) {
            return Ok(mean.respond(answers, force, tangent));
        }
        force.fill(0.0);
        if let Some(tangent) = tangent.as_deref_mut() {
            tangent.fill(0.0);
        }
        let [mut energy, mut dissipated] = [0.0; 2];
        for (answer, (at, volume)) in answers.iter().zip(self.everywhere()) {
            energy += volume * answer.energy;
            dissipated += volume * answer.dissipation;
            at.add_force(&(volume * answer.stress), force);
            if let Some(tangent) = tangent.as_deref_mut() {
                for (dof, column) in tangent.chunks_exact_mut(2 * u.len()).enumerate() {
                    at.add_force(&(volume * (answer.tangent * at.variation(dof))), column);
                }
            }
        }
        Ok([energy, dissipated])
    }

    /// Response of a body without history, undeformed before.
    pub(super) fn ring_at_once(
        &self,
        material: &dyn Material,
        u: &[Vector2<f64>],
        force: &mut [f64],
        tangent: Option<&mut [f64]>,
    ) -> Answer<f64> {
        let old = vec![0.0; material.description().variables.len() * self.quadrature_points()];
        let memory = Memory { dt: 0.0, old: &old, new: &mut old.clone() };
        self.ring(material, memory, u, force, tangent).map(|[energy, _]| energy)
    }

    /// F₃₃ at each quadrature point.
    pub(super) fn hoop_stretches(&self, u: &[Vector2<f64>]) -> Vec<f64> {
        let u = &*self.since_activation(u);
        self.everywhere().map(|(at, _)| at.deformation(u)[4]).collect()
    }

    /// Each quadrature point, in any section, and its volume.
    pub(super) fn everywhere(&self) -> impl Iterator<Item = (At<'_>, f64)> {
        let n = self.kind.nodes();
        let hoop = move |k: usize| self.hoop.as_ref().map_or(&[0.0; 9][..n], |hoop| &hoop[k * n..(k + 1) * n]);
        self.points().enumerate().map(move |(k, (gradients, volume))| (At { gradients, hoop: hoop(k) }, volume))
    }
}

impl At<'_> {
    /// Σ_a v_a ⊗ ∂N_a/∂X, and Σ v_ax N_a/R
    pub fn gradient(&self, v: &[Vector2<f64>]) -> Vector5<f64> {
        let mut sum = Vector5::zeros();
        for ((v, gradient), hoop) in v.iter().zip(self.gradients).zip(self.hoop) {
            sum += Vector5::new(v.x * gradient.x, v.y * gradient.x, v.x * gradient.y, v.y * gradient.y, v.x * hoop);
        }
        sum
    }

    pub fn deformation(&self, u: &[Vector2<f64>]) -> Vector5<f64> {
        Vector5::new(1.0, 0.0, 0.0, 1.0, 1.0) + self.gradient(u)
    }

    /// ∂F of a dof.
    pub fn variation(&self, dof: usize) -> Vector5<f64> {
        let (gradient, hoop) = (self.gradients[dof / 2], self.hoop[dof / 2]);
        match dof % 2 {
            0 => Vector5::new(gradient.x, 0.0, gradient.y, 0.0, hoop),
            _ => Vector5::new(0.0, gradient.x, 0.0, gradient.y, 0.0),
        }
    }

    /// δF:X of each dof of a Q4.
    pub fn along(&self, x: &Vector5<f64>) -> [f64; 8] {
        let mut each = [0.0; 8];
        self.add_force(x, &mut each);
        each
    }

    pub fn add_force(&self, stress: &Vector5<f64>, force: &mut [f64]) {
        for ((force, gradient), hoop) in force.chunks_exact_mut(2).zip(self.gradients).zip(self.hoop) {
            force[0] += stress[0] * gradient.x + stress[2] * gradient.y + stress[4] * hoop;
            force[1] += stress[1] * gradient.x + stress[3] * gradient.y;
        }
    }
}

/// Input of a law at F in three dimensions.
pub(super) fn straining<'a>(seen: &Vector5<f64>, dt: f64, old: &'a [f64]) -> Straining<'a> {
    Straining { stretch: seen[4], dt, ..Straining::new(plane(seen), old) }
}

/// J = det F in three dimensions, known to be positive.
pub(super) fn jacobian(f: &Vector5<f64>) -> Answer<f64> {
    let jacobian = positive_jacobian(&plane(f))? * f[4];
    if jacobian > 0.0 && jacobian.is_finite() { Ok(jacobian) } else { Err(MaterialFailure::Inverted { jacobian }) }
}

/// Inverse transpose F⁻ᵀ.
pub(super) fn inverse_transpose(f: &Vector5<f64>) -> Vector5<f64> {
    let plane = plane(f);
    components(&(cofactor(&plane) / plane.determinant()), 1.0 / f[4])
}
