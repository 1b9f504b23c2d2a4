//! Viscous forces: damping of bodies and bars, dashpots, absorbing sides, and stabilizing dashpots of static steps.
//!
//! # Bodies
//!
//! Rayleigh damping of bodies has the forces and tangent
//!
//! ```text
//! F += η M v + f_v(u, v),   ∂F/∂u += η M ∂v/∂u + ∂f_v/∂u + ∂f_v/∂v ∂v/∂u
//! ```
//!
//! Dashpots and absorbing sides exert the force C (v_driver − v) on a node.
//!
//! In implicit increments v follows from u. In explicit ones it is computed last, and the dampers of each node form one matrix,
//! including the mass-proportional damping with lumped masses.
//!
//! # Stabilization
//!
//! Stabilizing dashpots act in a static step and decrease to zero at its end:
//!
//! ```text
//! f = −c₀ (1 − elapsed fraction of the step) (u − u₀)/Δt
//! ```

use std::collections::BTreeMap;

use nalgebra::{Matrix2, Vector2};

use super::bars;
use super::coupling::Layout;
use super::inertia::{add_bars, elements, motion, velocity};
use super::solids::{Solids, damps_by_stiffness};
use super::sums::{Dependence, Sums, TrialFailure};
use super::trial::Trial;
use crate::bars::Bar;
use crate::linear::SparseMatrix;
use crate::mesh::configuration::vector;
use crate::model::boundary::Absorber;
use crate::model::{Model, Step};

/// Dependence of the damping forces: for linear materials on the velocity only; none in static steps.
pub(super) fn damping_dependence(model: &Model, step: &Step) -> Dependence {
    if step.scheme.coefficients().is_none() {
        return Dependence::Nothing;
    }
    let dampings = model.dampings(step);
    if has_viscous_bars(model, step) {
        return Dependence::Displacement;
    }
    let has_drag = model.bars_in(step).any(|(_, bar)| bar.drag > 0.0);
    if !has_drag && dampings.iter().all(|damping| damping.mass <= 0.0 && damping.retardation <= 0.0) {
        return Dependence::Nothing;
    }
    let mut viscous = model.bodies.iter().zip(dampings).filter(|(_, damping)| damping.retardation > 0.0);
    match viscous.all(|(body, _)| damps_by_stiffness(body.law_of_elements())) {
        true => Dependence::StepSize,
        false => Dependence::Displacement,
    }
}

/// Nodes of the bodies whose viscous stress is not that of a constant stiffness, and of viscous bars: their tangent is not symmetric.
pub(super) fn unsymmetric(model: &Model, step: &Step) -> Vec<usize> {
    let viscous = model.bodies.iter().zip(model.dampings(step)).filter(|(_, damping)| damping.retardation > 0.0);
    let unsymmetric = viscous.filter(|(body, _)| !damps_by_stiffness(body.law_of_elements()));
    let bars = model.bars_in(step).filter(|(_, bar)| bar.retardation > 0.0).flat_map(|(_, bar)| bar.nodes());
    unsymmetric.flat_map(|(body, _)| body.nodes.iter().copied()).chain(bars).collect()
}

/// Whether a bar that is there damps by its stiffness.
fn has_viscous_bars(model: &Model, step: &Step) -> bool {
    model.bars_in(step).any(|(_, bar)| bar.retardation > 0.0)
}

/// η of the bodies and bars, and η M.
pub(super) type ByMass = (Vec<f64>, SparseMatrix);

/// η M in a step, if bodies or bars have mass-proportional damping; stored or recomputed.
pub(super) fn momentum<'a>(
    model: &Model,
    step: &Step,
    layout: &Layout,
    known: &'a mut Option<ByMass>,
) -> Option<&'a SparseMatrix> {
    let of_bars = |(k, bar): (usize, &Bar)| if step.bars.has(k) { bar.drag } else { 0.0 };
    let bodies = model.dampings(step).into_iter().map(|damping| damping.mass);
    let shares: Vec<f64> = bodies.chain(model.bars.iter().enumerate().map(of_bars)).collect();
    if shares.iter().all(|share| *share == 0.0) {
        return None;
    }
    if known.as_ref().is_some_and(|(known, _)| *known != shares) {
        *known = None;
    }
    let found = || {
        let mut all = elements(model, layout, |body| shares[body]);
        add_bars(&mut all, model, layout, |bar| shares[model.bodies.len() + bar]);
        (shares.clone(), all)
    };
    Some(&known.get_or_insert_with(found).1)
}

/// Adds the damping of bodies and bars, with `momentum` = η M if there is any, and subtracts it from the `damping` on the nodes. Static
/// steps have none.
pub(super) fn add_damping(
    model: &Model,
    solids: &mut Solids,
    momentum: Option<&SparseMatrix>,
    trial: Trial,
    u: &[f64],
    damping: &mut [f64],
    sums: &mut Sums,
) {
    let is_viscous = model.is_viscous(trial.step);
    let damped = momentum.is_some() || is_viscous || has_viscous_bars(model, trial.step);
    let Some((velocity, dvelocity)) = motion(model, trial, u).filter(|_| damped) else { return };
    if let Some(momentum) = momentum {
        let [forces] = momentum.multiply_symmetric([&velocity]);
        for (dof, force) in forces.into_iter().enumerate() {
            sums.add(dof, force);
            damping[dof] -= force;
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
    bars::resist(model, trial, [u, &velocity, &dvelocity], damping, sums);
}

/// Dependence of the dashpot tangent C ∂v/∂u.
pub(super) fn damper_dependence(step: &Step) -> Dependence {
    let any = !(step.loads.dashpots.is_empty() && step.loads.absorbers.is_empty());
    if any { Dependence::StepSize } else { Dependence::Nothing }
}

/// Subtracts the forces of the dashpots, which count as `damping`.
pub(super) fn add_dampers(
    model: &Model,
    trial: Trial,
    u: &[f64],
    damping: &mut [f64],
    sums: &mut Sums,
) -> Result<(), TrialFailure> {
    // In rigid platens, v of one node follows from those of others.
    let turning = if model.linkage.rigid.is_empty() { None } else { motion(model, trial, u) };
    let velocity = |dof: usize| match &turning {
        Some((velocity, dvelocity)) => (velocity[dof], dvelocity[dof]),
        None => velocity(model, trial, u, dof),
    };
    for dashpot in &trial.step.loads.dashpots {
        let dof = dashpot.dof;
        let driver = dashpot.driver_velocity(model.mesh.nodes[dof / 2], trial.moment());
        let (velocity, dvelocity) = velocity(dof);
        let force = dashpot.coefficient * (driver - velocity);
        if !force.is_finite() {
            return Err(TrialFailure::Undefined { node: model.mesh.node_tags[dof / 2], time: trial.time });
        }
        sums.add(dof, -force);
        damping[dof] += force;
        sums.stiffen(dof, dof, dashpot.coefficient * dvelocity);
    }
    for Absorber { node, coefficients } in &trial.step.loads.absorbers {
        let rates = [0, 1].map(|i| velocity(2 * node + i));
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let (velocity, dvelocity) = rates[j];
            let force = -coefficients[(i, j)] * velocity;
            sums.add(2 * node + i, -force);
            damping[2 * node + i] += force;
            sums.stiffen(2 * node + i, 2 * node + j, coefficients[(i, j)] * dvelocity);
        }
    }
    Ok(())
}

/// Work of the drivers of dashpots in an increment: mean force × displacement increment of the driver [F·L]. `way` is that of
/// the node's dof.
pub fn driven(model: &Model, step: &Step, [t0, t1]: [f64; 2], way: impl Fn(usize) -> f64) -> f64 {
    let driven = step.loads.dashpots.iter().filter(|dashpot| dashpot.driver.is_some());
    driven
        .map(|dashpot| {
            let position = model.mesh.nodes[dashpot.dof / 2];
            let [v0, v1] = [t0, t1].map(|time| dashpot.driver_velocity(position, time));
            let velocity = 0.5 * (v0 + v1);
            dashpot.coefficient * (velocity * (t1 - t0) - way(dashpot.dof)) * velocity
        })
        .sum()
}

/// Dampers of a step, one matrix per node, by node number; those of copies at their originals.
pub fn by_node(model: &Model, step: &Step) -> Vec<Absorber> {
    let mut total: BTreeMap<usize, Matrix2<f64>> = BTreeMap::new();
    for (body, damping) in model.bodies.iter().zip(model.dampings(step)).filter(|(_, damping)| damping.mass > 0.0) {
        for &e in &body.elements {
            for (&node, mass) in model.mesh.elements[e].nodes.iter().zip(model.element_lumped_mass(e).iter()) {
                let node = model.ties.original(node);
                *total.entry(node).or_default() += Matrix2::from_diagonal_element(damping.mass * mass);
            }
        }
    }
    for (_, bar) in model.bars_in(step).filter(|(_, bar)| bar.drag > 0.0) {
        for (node, mass) in bar.nodal_masses(&model.massless) {
            *total.entry(model.ties.original(node)).or_default() += Matrix2::from_diagonal_element(bar.drag * mass);
        }
    }
    for dashpot in &step.loads.dashpots {
        let (node, i) = (model.ties.original(dashpot.dof / 2), dashpot.dof % 2);
        total.entry(node).or_default()[(i, i)] += dashpot.coefficient;
    }
    for absorber in &step.loads.absorbers {
        *total.entry(model.ties.original(absorber.node)).or_default() += absorber.coefficients;
    }
    total.into_iter().map(|(node, coefficients)| Absorber { node, coefficients }).collect()
}

/// Computes the force of every damper on its node in `forces` [F].
pub fn damper_forces(
    model: &Model,
    step: &Step,
    dampers: &[Absorber],
    time: f64,
    velocity: &[f64],
    forces: &mut Vec<Vector2<f64>>,
) {
    forces.clear();
    forces.extend(dampers.iter().map(|Absorber { node, coefficients }| -coefficients * vector(velocity, *node)));
    for dashpot in step.loads.dashpots.iter().filter(|dashpot| dashpot.driver.is_some()) {
        let node = model.ties.original(dashpot.dof / 2);
        if let Ok(k) = dampers.binary_search_by_key(&node, |damper| damper.node) {
            let driver = dashpot.driver_velocity(model.mesh.nodes[dashpot.dof / 2], time);
            forces[k][dashpot.dof % 2] += dashpot.coefficient * driver;
        }
    }
}

/// The stabilizing dashpots decrease with time.
pub(super) fn stabilization_dependence(step: &Step) -> Dependence {
    if step.stabilization.is_empty() { Dependence::Nothing } else { Dependence::Time }
}

/// Subtracts their forces, which count as `damping`; returns their norm.
pub(super) fn add_stabilization(trial: Trial, u: &[f64], damping: &mut [f64], sums: &mut Sums) -> f64 {
    if trial.is_instant() || trial.stabilization_left() == 0.0 {
        return 0.0;
    }
    let mut squares = 0.0;
    for (dof, start) in trial.step.stabilization.iter().enumerate() {
        let coefficient = trial.stabilizing(*start);
        let force = -coefficient * (u[dof] - trial.old.displacement[dof]);
        sums.add(dof, -force);
        damping[dof] += force;
        squares += force * force;
        sums.stiffen(dof, dof, coefficient);
    }
    squares.sqrt()
}

/// Energy dissipated by them in an increment, a part of that of all dashpots: ∫ c v² dt [F·L].
pub fn stabilization_dissipated(step: &Step, [t0, t1]: [f64; 2], way: impl Fn(usize) -> f64) -> f64 {
    let left = 1.0 - step.span.share(t1);
    let work: f64 = step.stabilization.iter().enumerate().map(|(dof, c)| c * way(dof) * way(dof)).sum();
    if work == 0.0 { 0.0 } else { left * work / (t1 - t0) }
}
