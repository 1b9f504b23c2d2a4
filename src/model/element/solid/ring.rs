//! Axisymmetric elements about x = 0, x being the radius.
//!
//! ```text
//! F₃₃ = 1 + Σ_a u_ax N_a/R,   f_ai = ∫ (P_iJ N_a,J + δ_ix P₃₃ N_a/R) dV,   dV = 2π R dA                    (7)
//! ```
//! F-bar in three dimensions, J = det F including F₃₃:
//!
//! ```text
//! F̄ = r F,   r = (J₀/J)^⅓,   P = P(F̄)/r²                                                                    (8)
//! dP = A:dF/r + ⅓ (F₀⁻ᵀ:dF₀ − F⁻ᵀ:dF) (A:F/r − 2P),   A = A(F̄)                                             (9)
//! ```
//! Quadrature points lie off the axis, so that u_r/R is finite for elements at the axis too.

use nalgebra::{Matrix5, Vector2, Vector5};

use super::{Memory, SolidElement};
use crate::laws::bulk::spatial::{components, plane};
use crate::laws::bulk::{
    CauchyStress, Material, MaterialFailure, Spatial, Straining, Stretched, cofactor, positive_jacobian,
};
use crate::mesh::few::Few;

/// Data of an element for the hoop stretch.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hoop {
    /// N_a/R of all nodes at the first quadrature point, then at the second, … [1/L]
    pub values: Vec<f64>,
    /// Hoop values N_a/R at the centre, for F-bar [1/L]
    pub centre: Vec<f64>,
}

/// ∂N_a/∂X and N_a/R at a point.
#[derive(Clone, Copy)]
struct At<'a> {
    gradients: &'a [Vector2<f64>],
    hoop: &'a [f64],
}

/// The centre of an F-bar element.
struct Centre<'a> {
    at: At<'a>,
    jacobian: f64,
    inverse_transpose: Vector5<f64>,
}

/// Deformation gradient F at a point, as given to the law.
struct Seen {
    deformation: Vector5<f64>,
    /// r of (8)
    stretch: f64,
    bar: Vector5<f64>,
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
    ) -> Result<[f64; 2], MaterialFailure> {
        let (law, count) = (spatial(material), material.variables().len());
        let centre = self.ring_centre(u)?;
        force.fill(0.0);
        if let Some(tangent) = tangent.as_deref_mut() {
            tangent.fill(0.0);
        }
        let [mut energy, mut dissipated] = [0.0; 2];
        for (k, (at, volume)) in self.ring_points().enumerate() {
            let seen = at.seen(centre.as_ref(), u)?;
            let own = k * count..(k + 1) * count;
            let Stretched { stress, tangent: slope, energy: stored, dissipation } =
                law.stretched(&seen.straining(dt, &old[own.clone()]), &mut new[own])?;
            let stress = stress / seen.stretch.powi(2);
            energy += volume * stored;
            dissipated += volume * dissipation;
            at.add_force(&(volume * stress), force);
            if let Some(tangent) = tangent.as_deref_mut() {
                at.add_tangent(centre.as_ref(), &seen, volume, (&stress, &slope), tangent);
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
    ) -> Result<f64, MaterialFailure> {
        let old = vec![0.0; material.variables().len() * self.quadrature_points()];
        let memory = Memory { dt: 0.0, old: &old, new: &mut old.clone() };
        self.ring(material, memory, u, force, tangent).map(|[energy, _]| energy)
    }

    /// Cauchy stress at each quadrature point; zz is the hoop stress.
    pub(super) fn ring_stresses(
        &self,
        material: &dyn Material,
        memory: &[f64],
        u: &[Vector2<f64>],
    ) -> Result<Few<CauchyStress, 9>, MaterialFailure> {
        let (law, count) = (spatial(material), material.variables().len());
        let centre = self.ring_centre(u)?;
        let stress = |(k, (at, _)): (usize, (At, f64))| {
            let seen = at.seen(centre.as_ref(), u)?;
            law.cauchy(&seen.straining(0.0, &memory[k * count..(k + 1) * count]))
        };
        self.ring_points().enumerate().map(stress).collect()
    }

    /// F₃₃ at each quadrature point.
    pub(super) fn hoop_stretches(&self, u: &[Vector2<f64>]) -> Vec<f64> {
        self.ring_points().map(|(at, _)| at.deformation(u)[4]).collect()
    }

    /// Forces of a viscous stress with the retardation time τ.
    pub(super) fn ring_viscous_forces(
        &self,
        material: &dyn Material,
        tau: f64,
        [u, v]: [&[Vector2<f64>]; 2],
        forces: &mut [Vector2<f64>],
    ) {
        let law = spatial(material);
        let mut all = [0.0; 18];
        for (at, volume) in self.ring_points() {
            let stress = tau * volume * law.viscous([&at.deformation(u), &at.gradient(v)]);
            at.add_force(&stress, &mut all[..2 * u.len()]);
        }
        forces.iter_mut().zip(all.chunks_exact(2)).for_each(|(force, own)| *force = Vector2::new(own[0], own[1]));
    }

    /// Derivative of the viscous forces with respect to `u`, column by column.
    pub(super) fn ring_viscous_tangent(
        &self,
        material: &dyn Material,
        tau: f64,
        [u, v]: [&[Vector2<f64>]; 2],
        dvelocity: &[f64],
        tangent: &mut [f64],
    ) {
        let law = spatial(material);
        tangent.fill(0.0);
        for (at, volume) in self.ring_points() {
            let (deformation, rate) = (at.deformation(u), at.gradient(v));
            for (dof, (column, dvelocity)) in tangent.chunks_exact_mut(2 * u.len()).zip(dvelocity).enumerate() {
                let varied = at.variation(dof);
                let stress = law.varied_viscous([&deformation, &rate], [&varied, &(*dvelocity * varied)]);
                at.add_force(&(tau * volume * stress), column);
            }
        }
    }

    fn ring_points(&self) -> impl Iterator<Item = (At<'_>, f64)> {
        let n = self.kind.nodes();
        let hoop = self.hoop.as_ref().map_or(&[][..], |hoop| &hoop.values);
        self.points().zip(hoop.chunks_exact(n)).map(|((gradients, volume), hoop)| (At { gradients, hoop }, volume))
    }

    fn ring_centre(&self, u: &[Vector2<f64>]) -> Result<Option<Centre<'_>>, MaterialFailure> {
        let (Some(gradients), Some(hoop)) = (&self.centre, &self.hoop) else { return Ok(None) };
        let at = At { gradients, hoop: &hoop.centre };
        let deformation = at.deformation(u);
        let jacobian = jacobian(&deformation)?;
        Ok(Some(Centre { at, jacobian, inverse_transpose: inverse_transpose(&deformation) }))
    }
}

impl At<'_> {
    /// Σ_a v_a ⊗ ∂N_a/∂X, and Σ v_ax N_a/R
    fn gradient(&self, v: &[Vector2<f64>]) -> Vector5<f64> {
        let mut sum = Vector5::zeros();
        for ((v, gradient), hoop) in v.iter().zip(self.gradients).zip(self.hoop) {
            sum += Vector5::new(v.x * gradient.x, v.y * gradient.x, v.x * gradient.y, v.y * gradient.y, v.x * hoop);
        }
        sum
    }

    fn deformation(&self, u: &[Vector2<f64>]) -> Vector5<f64> {
        Vector5::new(1.0, 0.0, 0.0, 1.0, 1.0) + self.gradient(u)
    }

    /// ∂F of a dof.
    fn variation(&self, dof: usize) -> Vector5<f64> {
        let (gradient, hoop) = (self.gradients[dof / 2], self.hoop[dof / 2]);
        match dof % 2 {
            0 => Vector5::new(gradient.x, 0.0, gradient.y, 0.0, hoop),
            _ => Vector5::new(0.0, gradient.x, 0.0, gradient.y, 0.0),
        }
    }

    fn seen(&self, centre: Option<&Centre>, u: &[Vector2<f64>]) -> Result<Seen, MaterialFailure> {
        let deformation = self.deformation(u);
        let stretch = match centre {
            Some(centre) => (centre.jacobian / jacobian(&deformation)?).cbrt(),
            None => 1.0,
        };
        Ok(Seen { deformation, stretch, bar: stretch * deformation })
    }

    fn add_force(&self, stress: &Vector5<f64>, force: &mut [f64]) {
        for ((force, gradient), hoop) in force.chunks_exact_mut(2).zip(self.gradients).zip(self.hoop) {
            force[0] += stress[0] * gradient.x + stress[2] * gradient.y + stress[4] * hoop;
            force[1] += stress[1] * gradient.x + stress[3] * gradient.y;
        }
    }

    fn add_tangent(
        &self,
        centre: Option<&Centre>,
        seen: &Seen,
        volume: f64,
        (stress, slope): (&Vector5<f64>, &Matrix5<f64>),
        tangent: &mut [f64],
    ) {
        let r = seen.stretch;
        let inverse = inverse_transpose(&seen.deformation);
        let by_volume = (slope * seen.deformation / r - 2.0 * stress) / 3.0;
        for (dof, column) in tangent.chunks_exact_mut(2 * self.gradients.len()).enumerate() {
            let varied = self.variation(dof);
            let mut dstress = slope * varied / r;
            if let Some(centre) = centre {
                let change = centre.inverse_transpose.dot(&centre.at.variation(dof)) - inverse.dot(&varied);
                dstress += change * by_volume;
            }
            self.add_force(&(volume * dstress), column);
        }
    }
}

impl Seen {
    fn straining<'a>(&self, dt: f64, old: &'a [f64]) -> Straining<'a> {
        Straining { deformation: plane(&self.bar), stretch: self.bar[4], dt, old }
    }
}

/// J = det F in three dimensions, known to be positive.
fn jacobian(f: &Vector5<f64>) -> Result<f64, MaterialFailure> {
    let jacobian = positive_jacobian(&plane(f))? * f[4];
    if jacobian > 0.0 && jacobian.is_finite() { Ok(jacobian) } else { Err(MaterialFailure::Inverted { jacobian }) }
}

/// Inverse transpose F⁻ᵀ.
fn inverse_transpose(f: &Vector5<f64>) -> Vector5<f64> {
    let plane = plane(f);
    components(&(cofactor(&plane) / plane.determinant()), 1.0 / f[4])
}

fn spatial(material: &dyn Material) -> &dyn Spatial {
    material.spatial().expect("bodies are checked when the model is built")
}
