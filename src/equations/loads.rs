//! Loads: dead loads, follower pressures, springs, initial stress, the reactions of released supports, and what fades after bodies
//! have come or gone. Their work is part
//! of that of all external forces, see [`super::evaluation`].

use super::links;
use super::sums::{Dependence, Sums};
use super::trial::Trial;
use crate::equations::sums::TrialFailure;
use crate::model::element::follower_pressure;
use crate::model::{Model, Step};

/// A pressure is linear in the displacements and varies with time; springs are constant.
pub(super) fn dependence(step: &Step) -> Dependence {
    match step.loads.pressures.is_empty() {
        _ if !step.loads.moments.is_empty() => Dependence::Displacement,
        true => Dependence::Nothing,
        false => Dependence::Time,
    }
}

/// Nodes of the pressures, whose tangent is not symmetric: that of an edge by itself.
pub(super) fn unsymmetric(step: &Step) -> Vec<usize> {
    step.loads.pressures.iter().flat_map(|load| load.edges.iter().flatten().copied()).collect()
}

/// Whether a step has any loads.
fn any(model: &Model, step: &Step) -> bool {
    let loads = &step.loads;
    !(model.prestress.is_empty()
        && loads.dead.is_empty()
        && loads.pressures.is_empty()
        && loads.springs.is_empty()
        && loads.moments.is_empty()
        && step.released.is_empty()
        && !step.changes_anything())
}

/// Sums all loads in `loads`, and subtracts them from the forces.
pub(super) fn add(
    model: &Model,
    trial: Trial,
    u: &[f64],
    loads: &mut Vec<f64>,
    sums: &mut Sums,
) -> Result<(), TrialFailure> {
    loads.clear();
    loads.extend(model.prestress.iter().map(|prestress| 0.0 + prestress));
    loads.resize(u.len(), 0.0);
    if !any(model, trial.step) {
        return Ok(());
    }
    collect(model, trial, u, loads, sums);
    let mut are_finite = true;
    for (force, load) in sums.force.iter_mut().zip(&*loads) {
        *force -= load;
        are_finite &= load.is_finite();
    }
    if let Some(dof) = (0..loads.len()).find(|&dof| !are_finite && !loads[dof].is_finite()) {
        return Err(TrialFailure::Undefined { node: model.mesh.node_tags[dof / 2], time: trial.time });
    }
    if let Some(magnitudes) = &mut sums.magnitudes {
        magnitudes.iter_mut().zip(&*loads).for_each(|(magnitude, load)| *magnitude += load.abs());
    }
    Ok(())
}

/// Add all loads but the initial stress to `loads`, and their tangents.
fn collect(model: &Model, trial: Trial, u: &[f64], loads: &mut [f64], sums: &mut Sums) {
    let (Trial { old, step, time, .. }, at) = (trial, trial.moment());
    for load in &step.loads.dead {
        load.forces(at).for_each(|(node, force)| loads[2 * node + load.component] += force);
    }
    if !step.loads.pressures.is_empty() {
        let x = model.configuration(u);
        for load in &step.loads.pressures {
            for edge in &load.edges {
                let pressure = follower_pressure(edge, |position| load.amplitude.value(position, at), &x);
                for (a, &node) in edge.iter().enumerate() {
                    (0..2).for_each(|i| loads[2 * node + i] -= pressure.force[2 * a + i]);
                }
                sums.couple(&pressure.nodes, pressure.tangent.as_slice());
            }
        }
    }
    for moment in &step.loads.moments {
        let [a, b] = moment.plate;
        let size = moment.amplitude.value(model.mesh.nodes[a], at);
        let (force, rates) = links::couple(model, moment.plate, u, size);
        (0..2).for_each(|i| {
            (loads[2 * a + i], loads[2 * b + i]) = (loads[2 * a + i] - force[i], loads[2 * b + i] + force[i])
        });
        sums.couple(&[a, b], rates.as_slice());
    }
    for spring in &step.loads.springs {
        let position = model.mesh.nodes[spring.dof / 2];
        let driver = spring.driver.as_ref().map_or(0.0, |driver| driver.value(position, at));
        loads[spring.dof] += spring.stiffness * (driver - u[spring.dof]);
        sums.stiffen(spring.dof, spring.dof, spring.stiffness);
    }
    let left = 1.0 - step.span.share(time);
    step.released.iter().for_each(|at| at.add(at.of(&old.step_start.reaction) * left, loads));
    loads.iter_mut().zip(&old.step_start.fading).for_each(|(load, fading)| *load += fading * left);
}
