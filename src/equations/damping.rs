//! Damping of bodies: forces of Rayleigh's kind and their tangent.
//!
//! ```text
//! F += η M v + f_v(u, v),   ∂F/∂u += η M ∂v/∂u + ∂f_v/∂u + ∂f_v/∂v ∂v/∂u
//! ```

use super::dependence::Dependence;
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
    let damped = |viscous: bool| {
        move |body: &&crate::model::Body| {
            if viscous {
                body.damping.retardation > 0.0
            } else {
                body.damping.mass > 0.0 || body.damping.retardation > 0.0
            }
        }
    };
    match model.bodies.iter().find(damped(false)) {
        None => Dependence::Nothing,
        Some(_) if model.bodies.iter().filter(damped(true)).all(|body| damps_by_stiffness(&*body.material)) => {
            Dependence::StepSize
        }
        Some(_) => Dependence::Displacement,
    }
}

/// Whether bodies have a damping that is a share of their masses.
pub(super) fn by_mass(model: &Model) -> bool {
    model.bodies.iter().any(|body| body.damping.mass > 0.0)
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
    let damped = momentum.is_some() || model.is_viscous();
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
    if model.is_viscous() {
        let mut resisting = vec![0.0; u.len()];
        solids.viscous([u, &velocity], &mut resisting, sums.magnitudes.as_deref_mut());
        sums.force.iter_mut().zip(&resisting).for_each(|(force, resisting)| *force += resisting);
        damping.iter_mut().zip(&resisting).for_each(|(damping, resisting)| *damping -= resisting);
        if let Some(tangent) = &mut sums.tangent {
            solids.viscous_tangents([u, &velocity], &dvelocity, sums.layout, tangent);
        }
    }
}
