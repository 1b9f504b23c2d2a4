//! Damping of bodies: forces of Rayleigh's kind and their tangent.
//!
//! ```text
//! F += η M v + f_v(u, v),   ∂F/∂u += η M ∂v/∂u + ∂f_v/∂u + ∂f_v/∂v ∂v/∂u
//! ```

use super::coupling::Layout;
use super::dependence::Dependence;
use super::inertia::elements;
use super::rates::motion;
use super::solids::{Solids, damps_by_stiffness};
use super::sums::Sums;
use super::trial::Trial;
use crate::linear::SparseMatrix;
use crate::model::{Model, Step};

/// Of a linear material the viscous stress knows the velocity alone. Statics know none.
pub(super) fn dependence(model: &Model, step: &Step) -> Dependence {
    if step.scheme.coefficients().is_none() {
        return Dependence::Nothing;
    }
    let dampings = model.dampings(step);
    if dampings.iter().all(|damping| damping.mass <= 0.0 && damping.retardation <= 0.0) {
        return Dependence::Nothing;
    }
    let mut viscous = model.bodies.iter().zip(dampings).filter(|(_, damping)| damping.retardation > 0.0);
    match viscous.all(|(body, _)| damps_by_stiffness(&*body.material)) {
        true => Dependence::StepSize,
        false => Dependence::Displacement,
    }
}

/// η of the bodies, and η M.
pub(super) type ByMass = (Vec<f64>, SparseMatrix);

/// η M in a step, if bodies have a damping that is a share of their masses: as it was found, or anew.
pub(super) fn momentum<'a>(
    model: &Model,
    step: &Step,
    layout: &Layout,
    known: &'a mut Option<ByMass>,
) -> Option<&'a SparseMatrix> {
    let shares: Vec<f64> = model.dampings(step).iter().map(|damping| damping.mass).collect();
    if shares.iter().all(|share| *share == 0.0) {
        return None;
    }
    if known.as_ref().is_some_and(|(known, _)| *known != shares) {
        *known = None;
    }
    let found = || (shares.clone(), elements(model, layout, |body| shares[body]));
    Some(&known.get_or_insert_with(found).1)
}

/// Add the damping of bodies, `momentum` being η M if there is any; take it from the `damping` that acts on the nodes.
/// Statics know none.
pub(super) fn add(
    model: &Model,
    solids: &mut Solids,
    momentum: Option<&SparseMatrix>,
    (trial, u): (Trial, &[f64]),
    damping: &mut [f64],
    sums: &mut Sums,
) {
    let is_viscous = model.is_viscous(trial.step);
    let damped = momentum.is_some() || is_viscous;
    let Some((velocity, dvelocity)) = motion(model, trial, u).filter(|_| damped) else { return };
    if let Some(momentum) = momentum {
        for (dof, pull) in momentum.multiply(&velocity).into_iter().enumerate() {
            sums.add(dof, pull);
            damping[dof] -= pull;
        }
        if let Some(tangent) = &mut sums.tangent {
            tangent.add_columns(momentum, &dvelocity);
        }
    }
    if is_viscous {
        solids.retard(trial.step);
        let mut resisting = vec![0.0; u.len()];
        solids.viscous([u, &velocity], &mut resisting, sums.magnitudes.as_deref_mut());
        sums.force.iter_mut().zip(&resisting).for_each(|(force, resisting)| *force += resisting);
        damping.iter_mut().zip(&resisting).for_each(|(damping, resisting)| *damping -= resisting);
        if let Some(tangent) = &mut sums.tangent {
            solids.viscous_tangents([u, &velocity], &dvelocity, sums.layout, tangent);
        }
    }
}
