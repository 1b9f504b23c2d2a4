//! Dashpots and absorbing sides: force C (v_driver − v) on a node.
//!
//! In implicit increments v follows from u. In explicit ones it comes last, and the dampers of each node are one matrix, with
//! the share of the lumped masses that the damping of bodies says.

use std::collections::BTreeMap;

use nalgebra::{Matrix2, Vector2};

use super::dependence::Dependence;
use super::rates::{motion, velocity};
use super::sums::Sums;
use super::trial::Trial;
use crate::equations::failure::TrialFailure;
use crate::model::boundary::Absorber;
use crate::model::{Model, Step};

/// C ∂v/∂u.
pub(super) fn dependence(step: &Step) -> Dependence {
    let any = !(step.loads.dashpots.is_empty() && step.loads.absorbers.is_empty());
    if any { Dependence::StepSize } else { Dependence::Nothing }
}

/// Subtract the forces of the dashpots, which count as `damping`.
pub(super) fn add(
    model: &Model,
    trial: Trial,
    u: &[f64],
    damping: &mut [f64],
    sums: &mut Sums,
) -> Result<(), TrialFailure> {
    // Of rigid plates, v of one node follows from those of others.
    let turning = if model.linkage.rigid.is_empty() { None } else { motion(model, trial, u) };
    let velocity = |dof: usize| match &turning {
        Some((velocity, dvelocity)) => (velocity[dof], dvelocity[dof]),
        None => velocity(model, trial, u, dof),
    };
    for dashpot in &trial.step.loads.dashpots {
        let dof = dashpot.dof;
        let driver = dashpot.driver_velocity(model.mesh.nodes[dof / 2], trial.moment());
        let (velocity, dvelocity) = velocity(dof);
        let pull = dashpot.coefficient * (driver - velocity);
        if !pull.is_finite() {
            return Err(TrialFailure::Undefined { node: model.mesh.node_tags[dof / 2], time: trial.time });
        }
        sums.add(dof, -pull);
        damping[dof] += pull;
        sums.stiffen(dof / 2, (dof % 2, dof % 2), dashpot.coefficient * dvelocity);
    }
    for Absorber { node, coefficients } in &trial.step.loads.absorbers {
        let rates = [0, 1].map(|i| velocity(2 * node + i));
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let (velocity, dvelocity) = rates[j];
            let pull = -coefficients[(i, j)] * velocity;
            sums.add(2 * node + i, -pull);
            damping[2 * node + i] += pull;
            sums.stiffen(*node, (i, j), coefficients[(i, j)] * dvelocity);
        }
    }
    Ok(())
}

/// Work of the drivers of dashpots in an increment: mean force × way of the driver [F·L]. `way` is that of the node's dof.
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

/// All dampers of one node: the force −C v.
#[derive(Clone, Copy, Debug)]
pub struct NodeDamper {
    /// the node
    pub node: usize,
    /// C [F T/L]
    pub coefficients: Matrix2<f64>,
}

/// The dampers of a step, a matrix a node, by the number of the node; those of copies at the nodes they move with.
pub fn by_node(model: &Model, step: &Step) -> Vec<NodeDamper> {
    let mut total: BTreeMap<usize, Matrix2<f64>> = BTreeMap::new();
    for (body, damping) in model.bodies.iter().zip(model.dampings(step)).filter(|(_, damping)| damping.mass > 0.0) {
        for &e in &body.elements {
            for (&node, mass) in model.mesh.elements[e].nodes.iter().zip(model.element_lumped_mass(e).iter()) {
                let node = model.ties.original(node);
                *total.entry(node).or_default() += Matrix2::from_diagonal_element(damping.mass * mass);
            }
        }
    }
    for dashpot in &step.loads.dashpots {
        let (node, i) = (model.ties.original(dashpot.dof / 2), dashpot.dof % 2);
        total.entry(node).or_default()[(i, i)] += dashpot.coefficient;
    }
    for absorber in &step.loads.absorbers {
        *total.entry(model.ties.original(absorber.node)).or_default() += absorber.coefficients;
    }
    total.into_iter().map(|(node, coefficients)| NodeDamper { node, coefficients }).collect()
}

/// Write the force of every damper on its node over `pulls` [F].
pub fn pull(
    model: &Model,
    step: &Step,
    dampers: &[NodeDamper],
    time: f64,
    velocity: &[f64],
    pulls: &mut Vec<Vector2<f64>>,
) {
    pulls.clear();
    pulls.extend(dampers.iter().map(|NodeDamper { node, coefficients }| {
        -coefficients * Vector2::new(velocity[2 * node], velocity[2 * node + 1])
    }));
    for dashpot in step.loads.dashpots.iter().filter(|dashpot| dashpot.driver.is_some()) {
        let node = model.ties.original(dashpot.dof / 2);
        if let Ok(k) = dampers.binary_search_by_key(&node, |damper| damper.node) {
            let driver = dashpot.driver_velocity(model.mesh.nodes[dashpot.dof / 2], time);
            pulls[k][dashpot.dof % 2] += dashpot.coefficient * driver;
        }
    }
}
