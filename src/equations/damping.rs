//! Damping of bodies: forces of Rayleigh's kind and their tangent in implicit increments.
//!
//! ```text
//! F += η M v + f_v(u, v),   ∂F/∂u += η M ∂v/∂u + ∂f_v/∂u + ∂f_v/∂v ∂v/∂u
//! ```

use nalgebra::{DMatrix, DVector, Vector2};
use rayon::prelude::*;

use super::{Assembler, BATCH, Trial};
use crate::linear::SparseMatrix;
use crate::linear::system::Contribution;
use crate::model::Model;

impl Assembler {
    /// Add the damping of bodies to the forces, and take it from the `damping` that acts on the nodes. Statics know none.
    pub(super) fn add_damping(
        &mut self,
        trial: Trial,
        u: &[f64],
        force: &mut [f64],
        mut tangent: Option<&mut SparseMatrix>,
        damping: &mut [f64],
    ) {
        let (mass, viscous) = (self.model.bodies.iter().any(|body| body.damping.mass > 0.0), self.model.is_viscous());
        let Some((velocity, dvelocity)) = self.motion(trial, u).filter(|_| mass || viscous) else { return };
        let undamped = force.to_vec();
        if mass {
            let momentum = self.damping_mass();
            let pull = momentum.multiply(&velocity);
            if let Some(tangent) = tangent.as_deref_mut() {
                tangent.add_columns(momentum, &dvelocity);
            }
            for (dof, pull) in pull.into_iter().enumerate() {
                force[dof] += pull;
                self.magnitudes[dof] += pull.abs();
            }
        }
        if viscous {
            self.add_viscous(u, [&velocity, &dvelocity], force, tangent);
        }
        damping.iter_mut().zip(force).zip(undamped).for_each(|((damping, f), before)| *damping -= *f - before);
    }

    /// v and ∂v/∂u of every dof in a dynamic increment; v alone at the start of dynamics, and nothing in statics.
    fn motion(&self, trial: Trial, u: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let Trial { old, step, dt, .. } = trial;
        if dt == 0.0 {
            return Some((old.velocity.clone(), vec![0.0; u.len()]));
        }
        let scheme = step.scheme.coefficients()?;
        let mut dvelocity = vec![scheme.dvelocity(dt); u.len()];
        step.supports.iter().for_each(|support| dvelocity[support.dof] = 0.0);
        self.model.ties.spread(2, &mut dvelocity);
        Some((self.rates(trial, u, scheme).0, dvelocity))
    }

    /// Add the viscous stresses of all bodies that have them.
    fn add_viscous(
        &mut self,
        u: &[f64],
        [velocity, dvelocity]: [&[f64]; 2],
        force: &mut [f64],
        mut tangent: Option<&mut SparseMatrix>,
    ) {
        let model = &*self.model.clone();
        let damped: Vec<usize> = (0..model.mesh.elements.len()).filter(|&e| damping_time(model, e) > 0.0).collect();
        for batch in damped.chunks(BATCH) {
            let wanted = tangent.is_some();
            let one = |&e: &usize| viscous(model, e, [u, velocity], wanted.then_some(dvelocity));
            let contributions: Vec<Contribution> = batch.par_iter().map(one).collect();
            contributions.iter().for_each(|one| self.add(one, force, tangent.as_deref_mut()));
        }
    }

    /// η M of all bodies on the current pattern.
    fn damping_mass(&mut self) -> &SparseMatrix {
        let Self { model, pattern, blocks, block_starts, damping_mass, .. } = self;
        damping_mass.get_or_insert_with(|| {
            let mut total = SparseMatrix::zero(pattern.clone());
            for (e, element) in model.mesh.elements.iter().enumerate() {
                let share = model.bodies[model.body_of_element[e]].damping.mass;
                let both = (share * model.element_mass(e)).kronecker(&DMatrix::identity(2, 2));
                let blocks = &blocks[block_starts[e]..block_starts[e + 1]];
                super::add_blocks(&mut total, blocks, both.as_slice(), element.nodes.len());
            }
            total
        })
    }
}

/// τ of the body that an element belongs to [T].
pub(super) fn damping_time(model: &Model, e: usize) -> f64 {
    model.bodies[model.body_of_element[e]].damping.stiffness
}

/// Viscous forces of an element at displacements and velocities, and their tangent if ∂v/∂u is given.
fn viscous(model: &Model, e: usize, motion: [&[f64]; 2], dvelocity: Option<&[f64]>) -> Contribution {
    let nodes = &model.mesh.elements[e].nodes;
    let body = &model.bodies[model.body_of_element[e]];
    let law = (&*body.material, body.damping.stiffness);
    let [u, v] = motion.map(|all| -> Vec<Vector2<f64>> {
        nodes.iter().map(|&node| Vector2::new(all[2 * node], all[2 * node + 1])).collect()
    });
    let mut forces = vec![Vector2::zeros(); nodes.len()];
    model.solids[e].viscous_forces(law, [&u, &v], &mut forces);
    let mut contribution = Contribution::zero(nodes.clone());
    contribution.force = DVector::from_iterator(2 * nodes.len(), forces.iter().flat_map(|f| [f.x, f.y]));
    if let Some(dvelocity) = dvelocity {
        let own: Vec<f64> = nodes.iter().flat_map(|&node| [dvelocity[2 * node], dvelocity[2 * node + 1]]).collect();
        model.solids[e].viscous_tangent(law, [&u, &v], &own, contribution.tangent.as_mut_slice());
    }
    contribution
}
