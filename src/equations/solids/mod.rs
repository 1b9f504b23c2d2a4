//! Stress of the bodies: nodal forces of every element, and their sums at each node.
//!
//! Elements with constant stiffness use the stored one, block by block (`constant.rs`). Consecutive other elements of one kind
//! and law form a run and are evaluated each time (`runs.rs`). Each node then sums the forces of its elements and blocks in a
//! fixed order: results are bitwise identical for any number of threads, and no two threads write to the same place.

mod constant;
mod runs;

use std::sync::Arc;

use super::coupling::Layout;
use super::sums::{Dependence, Sums};
use crate::equations::sums::TrialFailure;
use crate::linear::SparseMatrix;
use crate::model::element::SolidElement;
use crate::model::{Activated, Model, Step};
pub(super) use constant::damps_by_stiffness;
pub use constant::is_constant;
use constant::{Constant, Pass, is_linear_elastic};
use runs::{Runs, gather, gather_magnitudes};

/// The matrix is constant if all elements are.
pub(super) fn dependence(model: &Model) -> Dependence {
    let is_elastic: Vec<bool> = model.bodies.iter().map(|body| is_linear_elastic(body.law_of_elements())).collect();
    let is_constant = |(solid, &body): (&SolidElement, &usize)| is_elastic[body] && !solid.is_f_bar();
    let all = model.solids.iter().zip(&model.body_of_element).all(is_constant);
    if all { Dependence::Nothing } else { Dependence::Displacement }
}

/// Nodes of the elements whose tangent is not symmetric, as their law's is not.
pub(super) fn unsymmetric(model: &Model) -> Vec<usize> {
    let is_unsymmetric = |e: &usize| !model.bodies[model.body_of_element[*e]].material.description().is_symmetric;
    (0..model.solids.len()).filter(is_unsymmetric).flat_map(|e| model.mesh.elements[e].nodes.iter().copied()).collect()
}

/// Forces of the bodies about a displacement, to first order, and their energy, to second; those of bodies with internal variables or an
/// unsymmetric tangent are not among them.
///
/// ```text
/// f(u) = f₀ + K (u − u₀),   W(u) = W₀ + f₀·(u − u₀) + ½ (u − u₀)·K (u − u₀)
/// ```
pub struct LinearizedSolids {
    /// u₀ [L]
    about: Vec<f64>,
    /// f₀ [F]
    force: Vec<f64>,
    /// W₀ [F·L]
    energy: f64,
    /// K, symmetric [F/L]
    stiffness: SparseMatrix,
}

/// Forces of the bodies and the energy stored in them.
pub struct SolidForces {
    /// f [F]
    force: Vec<f64>,
    /// W [F·L]
    energy: f64,
}

impl LinearizedSolids {
    /// Those with these forces, energy and tangent at `u`.
    pub(super) fn of(u: &[f64], force: &[f64], energy: f64, tangent: &SparseMatrix) -> Self {
        Self { about: u.to_vec(), force: force.to_vec(), energy, stiffness: tangent.clone() }
    }

    /// The forces at several displacements.
    pub fn at(&self, all: &[&[f64]]) -> Vec<SolidForces> {
        let from_about = |u: &&[f64]| u.iter().zip(&self.about).map(|(u, about)| u - about).collect();
        let ways: Vec<Vec<f64>> = all.iter().map(from_about).collect();
        // The values of K are read once for two of them.
        let of_few = |few: &[Vec<f64>]| match few {
            [one, other] => Vec::from(self.stiffness.multiply_symmetric([one, other])),
            _ => few.iter().flat_map(|way| self.stiffness.multiply_symmetric([&way[..]])).collect(),
        };
        ways.iter().zip(ways.chunks(2).flat_map(of_few)).map(|(way, change)| self.changed(way, change)).collect()
    }

    /// The forces at a distance, with their change K (u − u₀).
    fn changed(&self, way: &[f64], change: Vec<f64>) -> SolidForces {
        let both = self.force.iter().zip(&change);
        let more = way.iter().zip(both).map(|(way, (force, change))| way * (force + 0.5 * change)).sum::<f64>();
        let mut force = change;
        force.iter_mut().zip(&self.force).for_each(|(change, force)| *change += force);
        SolidForces { force, energy: self.energy + more }
    }
}

impl SolidForces {
    /// Computes the forces in `sums`; returns the stored energy.
    pub(super) fn add(&self, sums: &mut Sums) -> f64 {
        sums.force.copy_from_slice(&self.force);
        self.energy
    }
}

/// Elements of a model and their nodal forces.
pub(super) struct Solids {
    model: Arc<Model>,
    constant: Constant,
    others: Runs,
    /// τ of every body in the current step [T]
    retardation: Vec<f64>,
}

impl Solids {
    /// The elements that are there; `activated` came into a deformed model.
    pub fn new(model: &Arc<Model>, are_there: impl Fn(usize) -> bool + Clone, activated: &Arc<Activated>) -> Self {
        let constant = Constant::new(model, |e| are_there(e) && !activated.contains(e));
        let others = Runs::new(model, |e| !constant.is[e] && are_there(e), activated);
        let retardation = model.bodies.iter().map(|body| body.damping.retardation).collect();
        Self { model: model.clone(), constant, others, retardation }
    }

    /// Sets the viscous stress of the bodies in a step.
    pub fn retard(&mut self, step: &Step) {
        let model = &self.model;
        let times = || (0..model.bodies.len()).map(|body| model.damping(step, body).retardation);
        if !self.retardation.iter().copied().eq(times()) {
            self.retardation = times().collect();
            self.constant.forget_viscous();
        }
    }

    /// Flags of the elements with a constant tangent.
    pub fn constant(&self) -> &[bool] {
        &self.constant.is
    }

    /// Number of distinct matrices of the constant elements.
    pub fn matrices(&self) -> usize {
        self.constant.matrices()
    }

    /// Σ K_e of the constant elements on the current pattern; `None` if there are none.
    pub fn constant_stiffness(&mut self, layout: &Layout) -> Option<&SparseMatrix> {
        self.constant.total(&self.model, layout)
    }

    /// Computes the forces in `sums`, and adds the tangents of all elements that are not constant; returns the stored energy.
    /// With velocities `v` the viscous forces of the constant elements are computed in the same pass, for
    /// [`Solids::other_viscous`].
    pub fn add(&mut self, u: &[f64], v: Option<&[f64]>, sums: &mut Sums) -> Result<f64, TrialFailure> {
        let Self { model, constant, others, retardation } = self;
        match &mut sums.tangent {
            None => others.evaluate(model, u),
            Some(tangent) => others.evaluate_with_tangents(model, u, sums.layout, tangent),
        }
        let scaled = sums.magnitudes.is_some();
        constant.evaluate(retardation, v.map_or(Pass::Elastic { u, scaled }, |v| Pass::Both { u, v }));
        let energy = others.stored(model)? + constant.stored(model, u)?;
        self.write(sums.force, sums.magnitudes.as_deref_mut());
        Ok(energy)
    }

    /// Computes the viscous forces of the bodies at displacements `u` and velocities `v` in `force`; they resist motion.
    pub fn viscous(&mut self, [u, v]: [&[f64]; 2], force: &mut [f64], magnitudes: Option<&mut [f64]>) {
        let Self { model, constant, others, retardation } = self;
        constant.evaluate(retardation, Pass::Viscous { v, scaled: magnitudes.is_some() });
        others.evaluate_viscous(model, retardation, [u, v]);
        self.write(force, magnitudes);
    }

    /// Computes viscous forces after [`Solids::add`] has evaluated those of the constant elements.
    pub fn other_viscous(&mut self, motion: [&[f64]; 2], force: &mut [f64]) {
        let Self { model, constant, others, retardation } = self;
        others.evaluate_viscous(model, retardation, motion);
        gather([(&others.places, &others.forces), (&constant.places, &constant.others)], force);
    }

    /// Writes the sums of the forces at the nodes, and adds those of their magnitudes.
    fn write(&self, force: &mut [f64], magnitudes: Option<&mut [f64]>) {
        let Self { constant, others, .. } = self;
        let elements = (&others.places, &others.forces[..]);
        gather([elements, (&constant.places, &constant.forces)], force);
        if let Some(magnitudes) = magnitudes {
            gather_magnitudes([elements, (&constant.places, &constant.others)], magnitudes);
        }
    }

    /// Adds the tangents of the viscous forces, where the velocity of each dof varies by the factor `dvelocity` with its
    /// displacement.
    pub fn viscous_tangents(
        &mut self,
        motion: [&[f64]; 2],
        dvelocity: &[f64],
        layout: &Layout,
        total: &mut SparseMatrix,
    ) {
        let Self { model, constant, others, retardation } = self;
        if let Some(viscous) = constant.viscous(model, retardation, layout) {
            total.add_columns(viscous, dvelocity);
        }
        others.viscous_tangents(model, retardation, motion, dvelocity, layout, total);
    }
}
