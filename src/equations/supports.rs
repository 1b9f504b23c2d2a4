//! Supports and periodic sides: the equations of prescribed dofs and of copies.
//!
//! ```text
//! w (u − ū) = 0,   w (u_copy − u_original) = 0        w: a stiffness for scale
//! ```

use super::trial::Trial;
use crate::equations::failure::TrialFailure;
use crate::linear::SparseMatrix;
use crate::linear::system::System;
use crate::model::Model;

/// w: the largest stiffness of the materials and springs; a model of points alone has that of its contacts [F/L].
pub(super) fn weight(model: &Model) -> f64 {
    let materials = model.bodies.iter().map(|body| body.material.p_wave_modulus());
    let springs = model.steps.iter().flat_map(|step| step.loads.springs.iter().map(|spring| spring.stiffness));
    let contacts = model.contacts.iter().flat_map(|pair| pair.points.iter().map(|point| pair.alpha_n * point.area));
    let largest = |stiffness: &mut dyn Iterator<Item = f64>| stiffness.reduce(f64::max).filter(|w| *w > 0.0);
    largest(&mut materials.chain(springs)).or_else(|| largest(&mut { contacts })).unwrap_or(1.0)
}

/// Replace the equations of prescribed dofs and of copies.
pub(super) fn prescribe(
    model: &Model,
    weight: f64,
    trial: Trial,
    u: &[f64],
    tangent: bool,
    system: &mut System,
) -> Result<(), TrialFailure> {
    for support in &trial.step.supports {
        let dof = support.dof;
        let target = trial.prescribed(support, model);
        if !target.is_finite() {
            return Err(TrialFailure::Undefined { node: model.mesh.node_tags[dof / 2], time: trial.time });
        }
        system.residual[dof] = weight * (u[dof] - target);
        if tangent {
            system.tangent.replace_row(dof, weight);
        }
    }
    for &(copy, original) in model.ties.pairs() {
        for d in 0..2 {
            system.residual[2 * copy + d] = weight * (u[2 * copy + d] - u[2 * original + d]);
        }
    }
    if tangent {
        tie(model, &mut system.tangent, weight);
    }
    Ok(())
}

/// Replace the equations of copies by w (x_copy − x_original) = 0.
pub fn tie(model: &Model, matrix: &mut SparseMatrix, weight: f64) {
    for &(copy, original) in model.ties.pairs() {
        for d in 0..2 {
            matrix.replace_row(2 * copy + d, weight);
            let coupled = matrix.pattern.block(copy, original).expect("the pattern couples copies");
            matrix.values[coupled.value(d, d)] = -weight;
        }
    }
}
