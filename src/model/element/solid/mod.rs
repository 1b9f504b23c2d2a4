//! A solid element at large displacements: total Lagrangian, fully integrated, with F-bar for Q4 and reduced integration for Q8.
//!
//! This file contains elements with internal variables or an unsymmetric tangent as well; `viscous.rs` contains the viscous stress of a
//! damped body, `f_bar.rs` F-bar, `ring.rs` axisymmetry, `stress.rs` the stress and the reference geometry of elements, `volume.rs` their mean volume
//! change, `activation.rs` elements that come later.

mod activation;
mod f_bar;
mod ring;
mod stress;
mod viscous;
mod volume;

use std::array;

use nalgebra::{Matrix2, Matrix4, Vector2};
use pulp::{Arch, NullaryFnOnce};

use super::Formulation;
use crate::laws::bulk::components::{components, plane};
use crate::laws::bulk::{Answer, BulkResponse, Material, MaterialResponse, Straining};
use crate::mesh::shape::ElementKind;

/// A solid element: its reference geometry at the quadrature points.
///
/// ```text
/// F = 1 + Σ_a u_a ⊗ ∂N_a/∂X                              deformation gradient              (1)
/// f_ai = ∫ P_iJ N_a,J dV                                 internal force                    (2)
/// K_ai,bk = ∫ N_a,J A_iJkL N_b,L dV,   A = ∂P/∂F         tangent ∂f_ai/∂u_bk               (3)
/// ```
///
/// F-bar (Q4 only) gives every point the mean volume change and the mean pressure, so that nearly incompressible materials, and bodies
/// that yield, do not lock; see `f_bar.rs`. [`Linear`](crate::laws::bulk::Linear) with F-bar is linear only in the limit of small
/// strains.
///
/// Reduced integration takes 2 × 2 points for Q8. One element alone then has a motion besides the three rigid ones that costs
/// nothing; two that share an edge have none. The mass keeps its 3 × 3 points.
///
/// Source: Zienkiewicz, Taylor & Too (1971), Int. J. Numer. Meth. Engng 3, 275, doi:10.1002/nme.1620030211.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidElement {
    kind: ElementKind,
    formulation: Formulation,
    /// ∂N_a/∂X of all nodes at the first quadrature point, then at the second, … [1/L]
    gradients: Vec<Vector2<f64>>,
    /// Reference volume of each quadrature point: weight × det(∂X/∂ξ) × w of the section [L²]
    volumes: Vec<f64>,
    /// Mean of w over the element
    mean_weight: f64,
    /// N_a/R of all nodes at the first quadrature point, then at the second, … of axisymmetric elements [1/L]
    hoop: Option<Vec<f64>>,
    /// Trace of the initial stress at the quadrature points of an F-bar element; empty without one [F/L²]
    initial: Vec<f64>,
    /// Displacements of the nodes when it came; empty for an element that has been there from the start [L]
    activation: Vec<Vector2<f64>>,
}

impl SolidElement {
    /// Computes the internal force (2) at nodal displacements `u` in `force`; returns the stored energy.
    ///
    /// # Errors
    /// Returns the [`MaterialFailure`](crate::laws::bulk::MaterialFailure) of the law at a quadrature point.
    pub fn force(&self, material: &dyn Material, u: &[Vector2<f64>], force: &mut [f64]) -> Answer<f64> {
        if self.hoop.is_some() {
            return self.ring_at_once(material, u, force, None);
        }
        let mut forces = [Vector2::zeros(); 9];
        let energy = self.nodal_forces(material, u, &mut forces[..u.len()])?;
        force.chunks_exact_mut(2).zip(&forces).for_each(|(force, f)| force.copy_from_slice(f.as_slice()));
        Ok(energy)
    }

    /// Computes the internal force (2) on each node in `forces`; returns the stored energy.
    ///
    /// # Errors
    /// Returns the [`MaterialFailure`](crate::laws::bulk::MaterialFailure) of the law at a quadrature point.
    pub fn nodal_forces(
        &self,
        material: &dyn Material,
        u: &[Vector2<f64>],
        forces: &mut [Vector2<f64>],
    ) -> Answer<f64> {
        if self.hoop.is_some() {
            let mut all = [0.0; 18];
            let energy = self.ring_at_once(material, u, &mut all[..2 * u.len()], None)?;
            forces.iter_mut().zip(all.chunks_exact(2)).for_each(|(force, own)| *force = Vector2::new(own[0], own[1]));
            return Ok(energy);
        }
        match self.kind {
            ElementKind::T3 => self.gathered::<3, 1>(material, u, forces),
            ElementKind::T6 => self.gathered::<6, 3>(material, u, forces),
            ElementKind::Q4 => self.gathered::<4, 4>(material, u, forces),
            ElementKind::Q8 => self.gathered::<8, 9>(material, u, forces),
            ElementKind::Q9 => self.gathered::<9, 9>(material, u, forces),
        }
    }

    /// Force (2) of an element of N nodes and at most M quadrature points, known at compile time.
    #[inline(always)]
    fn gathered<const N: usize, const M: usize>(
        &self,
        material: &dyn Material,
        u: &[Vector2<f64>],
        forces: &mut [Vector2<f64>],
    ) -> Answer<f64> {
        let u = &*self.since_activation(u);
        let points = self.volumes.len();
        debug_assert!(points <= M);
        let mut deformations = [Matrix2::zeros(); M];
        let gradients = self.gradients.as_chunks::<N>().0;
        for (deformation, gradients) in deformations.iter_mut().zip(gradients) {
            *deformation = deformation_gradient(gradients, u);
        }
        let (deformations, mut stresses) = (&mut deformations[..points], [Matrix2::zeros(); M]);
        let mean = self.mean(u)?;
        if let Some(mean) = &mean {
            deformations.iter_mut().zip(mean.seen()).for_each(|(deformation, seen)| *deformation = plane(&seen));
        }
        let mut energy = material.stresses(deformations, &self.volumes, &mut stresses[..points])?;
        if let Some(mean) = &mean {
            energy += mean.initial_energy();
            let given = array::from_fn(|k| components(&stresses[k], 0.0));
            stresses.iter_mut().zip(mean.stresses(&given)).for_each(|(stress, own)| *stress = plane(&own));
        }
        let mut sums = [Vector2::zeros(); N];
        for (stress, gradients) in stresses.iter().zip(gradients) {
            for (sum, gradient) in sums.iter_mut().zip(gradients) {
                *sum += stress * gradient;
            }
        }
        forces.copy_from_slice(&sums);
        Ok(energy)
    }

    /// Computes the same as [`SolidElement::force`], and the tangent (3) in `tangent`, column by column.
    ///
    /// # Errors
    /// Returns the [`MaterialFailure`](crate::laws::bulk::MaterialFailure) of the law at a quadrature point.
    pub fn force_and_tangent(
        &self,
        material: &dyn Material,
        u: &[Vector2<f64>],
        force: &mut [f64],
        tangent: &mut [f64],
    ) -> Answer<f64> {
        if self.hoop.is_some() {
            return self.ring_at_once(material, u, force, Some(tangent));
        }
        match self.kind {
            ElementKind::T3 => self.evaluate::<3, 1>(material, u, force, tangent),
            ElementKind::T6 => self.evaluate::<6, 3>(material, u, force, tangent),
            ElementKind::Q4 => self.evaluate::<4, 4>(material, u, force, tangent),
            ElementKind::Q8 => self.evaluate::<8, 9>(material, u, force, tangent),
            ElementKind::Q9 => self.evaluate::<9, 9>(material, u, force, tangent),
        }
    }

    /// Force (2) and tangent (3). The numbers of nodes and, at most, of quadrature points are known at compile time, so that the loops
    /// over them are unrolled.
    fn evaluate<const N: usize, const M: usize>(
        &self,
        material: &dyn Material,
        u: &[Vector2<f64>],
        force: &mut [f64],
        tangent: &mut [f64],
    ) -> Answer<f64> {
        let u = &*self.since_activation(u);
        if let Some(mean) = self.mean(u)? {
            let mut answers = [BulkResponse::default(); 4];
            for (answer, seen) in answers.iter_mut().zip(mean.seen()) {
                *answer = material.at_once(&plane(&seen))?.into();
            }
            let [energy, _] = mean.respond(&answers, force, Some(tangent));
            return Ok(energy);
        }
        let (gradients, volumes) = (self.gradients.as_chunks::<N>().0, &self.volumes);
        let mut responses = [MaterialResponse::default(); M];
        for (response, gradients) in responses.iter_mut().zip(gradients) {
            *response = material.at_once(&deformation_gradient(gradients, u))?;
        }
        let (responses, tangent) = (&responses[..gradients.len()], Some(tangent));
        let [energy, _] = Arch::new().dispatch(Gathered::<N, true> { gradients, volumes, responses, force, tangent });
        Ok(energy)
    }

    /// ∂N_a/∂X, N_a/R (none in plane) and the reference volume of each quadrature point.
    pub fn geometry(&self) -> impl Iterator<Item = (&[Vector2<f64>], &[f64], f64)> {
        let n = self.kind.nodes();
        let hoop = move |k: usize| self.hoop.as_ref().map_or(&[][..], |all| &all[k * n..(k + 1) * n]);
        self.points().enumerate().map(move |(k, (gradients, volume))| (gradients, hoop(k), volume))
    }

    /// Gradients and volume of each quadrature point.
    fn points(&self) -> impl Iterator<Item = (&[Vector2<f64>], f64)> {
        self.gradients.chunks_exact(self.kind.nodes()).zip(self.volumes.iter().copied())
    }
}

/// Deformation gradient F by equation (1).
fn deformation_gradient(gradients: &[Vector2<f64>], u: &[Vector2<f64>]) -> Matrix2<f64> {
    u.iter().zip(gradients).fold(Matrix2::identity(), |sum, (u, gradient)| sum + u * gradient.transpose())
}

/// f_ai += P_iJ N_a,J
#[inline(always)]
fn add_force(gradients: &[Vector2<f64>], stress: &Matrix2<f64>, force: &mut [f64]) {
    for (force, gradient) in force.chunks_exact_mut(2).zip(gradients) {
        let f = stress * gradient;
        force[0] += f.x;
        force[1] += f.y;
    }
}

/// K_ai,bk += N_a,J A_iJkL N_b,L in `blocks[b][a][k][i]`, of a symmetric A for a ≥ b alone: the rest follows.
#[inline(always)]
fn add_tangent<const N: usize, const SYMMETRIC: bool>(
    gradients: &[Vector2<f64>; N],
    tangent: &Matrix4<f64>,
    blocks: &mut [[[[f64; 2]; 2]; N]; N],
) {
    for (b, (at_b, columns)) in gradients.iter().zip(blocks).enumerate() {
        // A_iJkL N_b,L for both k
        let stress = [0, 1].map(|k| tangent.column(k) * at_b.x + tangent.column(k + 2) * at_b.y);
        for (at_a, block) in gradients.iter().zip(columns).skip(if SYMMETRIC { b } else { 0 }) {
            for (column, stress) in block.iter_mut().zip(&stress) {
                column[0] += stress[0] * at_a.x + stress[2] * at_a.y;
                column[1] += stress[1] * at_a.x + stress[3] * at_a.y;
            }
        }
    }
}

/// Writes the blocks, and the transposes of symmetric ones, into the tangent, column by column.
#[inline(always)]
fn write_blocks<const N: usize, const SYMMETRIC: bool>(blocks: &[[[[f64; 2]; 2]; N]; N], tangent: &mut [f64]) {
    for (b, columns) in blocks.iter().enumerate() {
        for (a, block) in columns.iter().enumerate().skip(if SYMMETRIC { b } else { 0 }) {
            for (k, column) in block.iter().enumerate() {
                for (i, value) in column.iter().enumerate() {
                    tangent[(2 * b + k) * 2 * N + 2 * a + i] = *value;
                    if SYMMETRIC && a > b {
                        tangent[(2 * a + i) * 2 * N + 2 * b + k] = *value;
                    }
                }
            }
        }
    }
}

/// Internal variables of an element's material over an increment: its variables at the first quadrature point, then at
/// the second, …
#[derive(Debug)]
pub struct Memory<'a> {
    /// Δt [T]
    pub dt: f64,
    /// Committed
    pub old: &'a [f64],
    /// Values of the trial, overwritten
    pub new: &'a mut [f64],
}

impl SolidElement {
    /// Force (2) and, on request, tangent (3) of a material with internal variables or an unsymmetric tangent; returns the
    /// stored and the dissipated energy of the increment.
    ///
    /// # Errors
    /// Returns the [`MaterialFailure`](crate::laws::bulk::MaterialFailure) of the law at a quadrature point.
    pub fn evolve(
        &self,
        material: &dyn Material,
        memory: Memory,
        u: &[Vector2<f64>],
        force: &mut [f64],
        tangent: Option<&mut [f64]>,
    ) -> Answer<[f64; 2]> {
        if self.hoop.is_some() {
            return self.ring(material, memory, u, force, tangent);
        }
        match (self.kind, material.description().is_symmetric) {
            (ElementKind::T3, true) => self.evolve_by::<3, 1, true>(material, memory, u, force, tangent),
            (ElementKind::T3, false) => self.evolve_by::<3, 1, false>(material, memory, u, force, tangent),
            (ElementKind::T6, true) => self.evolve_by::<6, 3, true>(material, memory, u, force, tangent),
            (ElementKind::T6, false) => self.evolve_by::<6, 3, false>(material, memory, u, force, tangent),
            (ElementKind::Q4, true) => self.evolve_by::<4, 4, true>(material, memory, u, force, tangent),
            (ElementKind::Q4, false) => self.evolve_by::<4, 4, false>(material, memory, u, force, tangent),
            (ElementKind::Q8, true) => self.evolve_by::<8, 9, true>(material, memory, u, force, tangent),
            (ElementKind::Q8, false) => self.evolve_by::<8, 9, false>(material, memory, u, force, tangent),
            (ElementKind::Q9, true) => self.evolve_by::<9, 9, true>(material, memory, u, force, tangent),
            (ElementKind::Q9, false) => self.evolve_by::<9, 9, false>(material, memory, u, force, tangent),
        }
    }

    /// The same of an element in plane, whose number of nodes, largest number of quadrature points and symmetry are known at compile
    /// time.
    fn evolve_by<const N: usize, const M: usize, const SYMMETRIC: bool>(
        &self,
        material: &dyn Material,
        memory: Memory,
        u: &[Vector2<f64>],
        force: &mut [f64],
        tangent: Option<&mut [f64]>,
    ) -> Answer<[f64; 2]> {
        let u = &*self.since_activation(u);
        let (Memory { dt, old, new }, wanted) = (memory, tangent.is_some());
        let (points, mean) = (self.quadrature_points(), self.mean(u)?);
        let (count, gradients) = (old.len() / points, self.gradients.as_chunks::<N>().0);
        let mut strainings = [Straining { dt, tangent: wanted, ..Straining::new(Matrix2::identity(), &[]) }; M];
        for (k, (straining, gradients)) in strainings.iter_mut().zip(gradients).enumerate() {
            straining.deformation = deformation_gradient(gradients, u);
            straining.old = &old[k * count..(k + 1) * count];
        }
        if let Some(mean) = &mean {
            strainings.iter_mut().zip(mean.seen()).for_each(|(straining, seen)| straining.deformation = plane(&seen));
        }
        let mut responses = [MaterialResponse::default(); M];
        material.in_plane(&strainings[..points], new, &mut responses[..points])?;
        if let Some(mean) = mean {
            return Ok(mean.respond(&array::from_fn(|k| responses[k].into()), force, tangent));
        }
        let (volumes, responses) = (&self.volumes, &responses[..points]);
        Ok(Arch::new().dispatch(Gathered::<N, SYMMETRIC> { gradients, volumes, responses, force, tangent }))
    }
}

/// Force and tangent of the answers at the quadrature points, compiled for vectors as long as the processor has them; returns the stored
/// and the dissipated energy.
struct Gathered<'a, const N: usize, const SYMMETRIC: bool> {
    gradients: &'a [[Vector2<f64>; N]],
    volumes: &'a [f64],
    responses: &'a [MaterialResponse],
    force: &'a mut [f64],
    tangent: Option<&'a mut [f64]>,
}

impl<const N: usize, const SYMMETRIC: bool> NullaryFnOnce for Gathered<'_, N, SYMMETRIC> {
    type Output = [f64; 2];

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { gradients, volumes, responses, force, tangent } = self;
        force.fill(0.0);
        let [mut energy, mut dissipated] = [0.0; 2];
        let mut blocks = tangent.is_some().then_some([[[[0.0; 2]; 2]; N]; N]);
        for ((gradients, &volume), response) in gradients.iter().zip(volumes).zip(responses) {
            energy += volume * response.energy;
            dissipated += volume * response.dissipation;
            add_force(gradients, &(volume * response.stress), force);
            if let Some(blocks) = &mut blocks {
                add_tangent::<N, SYMMETRIC>(gradients, &(volume * response.tangent), blocks);
            }
        }
        if let (Some(blocks), Some(tangent)) = (blocks, tangent) {
            write_blocks::<N, SYMMETRIC>(&blocks, tangent);
        }
        [energy, dissipated]
    }
}
