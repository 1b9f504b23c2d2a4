//! Supports and periodic sides: the equations of prescribed dofs and of copies.
//!
//! ```text
//! w (u − ū) = 0,   w (u_copy − u_original) = 0        w: a stiffness for scale
//! w (d·u − ū) = 0,   t·r = 0                          along an inclined direction d, and across it, t ⊥ d
//! ```

use super::links;
use super::trial::Trial;
use crate::equations::sums::TrialFailure;
use crate::linear::SparseMatrix;
use crate::linear::system::System;
use crate::model::support::Direction;
use crate::model::{Model, Step};

/// w: the largest stiffness of the materials, springs and bars, or of the contacts in a model of points only [F/L].
pub(super) fn weight(model: &Model) -> f64 {
    let solids = std::iter::once(model.stiffness());
    let springs = model.steps.iter().flat_map(|step| step.loads.springs.iter().map(|spring| spring.stiffness));
    let bars = model.bars.iter().flat_map(|bar| bar.segments.iter().map(|segment| bar.ea / segment.length));
    let contacts = model.contacts.iter().flat_map(|pair| pair.points.iter().map(|point| pair.alpha_n * point.area));
    let largest = |stiffness: &mut dyn Iterator<Item = f64>| stiffness.reduce(f64::max).filter(|w| *w > 0.0);
    largest(&mut solids.chain(springs).chain(bars)).or_else(|| largest(&mut { contacts })).unwrap_or(1.0)
}

/// Dofs whose equation in a step is not one of forces: supported ones, copies, followers, and lengths of platens.
pub fn fixed(model: &Model, step: &Step) -> Vec<bool> {
    let mut fixed = vec![false; model.dofs()];
    step.supports.iter().for_each(|support| fixed[support.at.dof] = true);
    model.ties.pairs().iter().for_each(|&(copy, _)| fixed[2 * copy..2 * copy + 2].fill(true));
    model.linkage.followers.iter().flat_map(|follower| follower.dofs()).for_each(|(_, dof)| fixed[dof] = true);
    model.linkage.rigid.iter().for_each(|[_, b]| fixed[2 * b + 1] = true);
    fixed
}

/// Nodes constrained along an inclined direction: their equations are turned, and their columns are not.
pub(super) fn unsymmetric(step: &Step) -> Vec<usize> {
    step.supports.iter().filter(|support| support.at.inclined.is_some()).map(|support| support.at.node()).collect()
}

/// Residual of the equations of forces, 0 at all other dofs.
pub fn free(model: &Model, step: &Step, residual: &[f64]) -> Vec<f64> {
    residual.iter().zip(fixed(model, step)).map(|(&residual, fixed)| if fixed { 0.0 } else { residual }).collect()
}

/// Work of the residual forces at the displacement `u` along a correction; the equations of inclined supports and of rigid
/// platens are not those of their dofs [F·L].
pub fn work(model: &Model, step: &Step, u: &[f64], residual: &[f64], way: &[f64]) -> f64 {
    let inclined = step.supports.iter().filter_map(|support| support.at.across());
    let across = inclined.map(|across| residual[across.dof] * (across.of(way) - way[across.dof]));
    dot(residual, way) + across.chain(links::missing_work(model, u, residual, way)).sum::<f64>()
}

/// The same where every equation belongs to its dof.
pub fn dot(residual: &[f64], way: &[f64]) -> f64 {
    residual.iter().zip(way).map(|(r, x)| r * x).sum()
}

/// Replaces the equations of prescribed dofs and of copies.
pub(super) fn prescribe(
    model: &Model,
    weight: f64,
    trial: Trial,
    u: &[f64],
    tangent: bool,
    system: &mut System,
) -> Result<(), TrialFailure> {
    links::gather_residual(model, &mut system.residual);
    if tangent {
        links::gather_rows(model, &mut system.tangent);
    }
    for support in &trial.step.supports {
        let target = trial.prescribed(support, model);
        if !target.is_finite() {
            return Err(TrialFailure::Undefined { node: model.mesh.node_tags[support.at.node()], time: trial.time });
        }
        turn(support.at, weight * (support.at.of(u) - target), &mut system.residual);
        if tangent {
            constrain(support.at, weight, &mut system.tangent);
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
    links::prescribe(model, weight, trial, u, tangent, system);
    Ok(())
}

/// Sets the right-hand side of a supported direction to `own`, and that of the other component to the projection across it.
pub fn turn(at: Direction, own: f64, values: &mut [f64]) {
    if let Some(across) = at.across() {
        values[across.dof] = across.of(values);
    }
    values[at.dof] = own;
}

/// Replaces the equation of a supported direction by w d·u, and the other of an inclined one by the projection across it.
pub fn constrain(at: Direction, weight: f64, matrix: &mut SparseMatrix) {
    match at.across() {
        None => matrix.constrain(at.dof, weight),
        Some(across) => matrix.turn_rows(at.dof, (at.vector() * weight).into(), across.vector().into()),
    }
}

/// Replaces the equations of copies by w (x_copy − x_original) = 0.
pub fn tie(model: &Model, matrix: &mut SparseMatrix, weight: f64) {
    for &(copy, original) in model.ties.pairs() {
        for d in 0..2 {
            matrix.replace_row(2 * copy + d, weight);
            let block = matrix.pattern.coupled(copy, original);
            matrix.values[block.value(d, d)] = -weight;
        }
    }
}
