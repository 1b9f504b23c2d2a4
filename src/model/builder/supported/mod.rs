//! What nothing holds or carries, found before anything is solved: bodies that float in a static step, bodies and nodes
//! without mass in a dynamic one, and nodes outside all bodies that nothing holds.

mod floating;
mod parts;
mod resisted;

use super::error::ModelError;
use super::load_step::LoadStep;
use crate::model::{Model, Step};
use floating::{check_floating, holding};

/// Every motion must meet stiffness or, in a dynamic step, mass.
pub fn check(given: &[LoadStep], model: &Model) -> Result<(), ModelError> {
    for (k, step) in model.steps.iter().enumerate() {
        if step.scheme.is_dynamic() || step.rupture.is_some() {
            check_mass(k, step, model)?;
        }
        if !step.scheme.is_dynamic() {
            check_lone_nodes(k, step, model)?;
        }
    }
    check_floating(given, model)
}

/// A node of no body meets nothing but its supports, springs, dashpots and contact.
fn check_lone_nodes(k: usize, step: &Step, model: &Model) -> Result<(), ModelError> {
    let mut held = vec![false; model.dofs()];
    let nodes = model.bodies.iter().flat_map(|body| &body.nodes);
    nodes.for_each(|&node| held[2 * node..2 * node + 2].fill(true));
    // Whether contact holds a node that may part is left to the solver.
    let points = model.contacts.iter().flat_map(|pair| pair.points.iter().flat_map(|point| &point.position));
    points.for_each(|&(node, _)| held[2 * node..2 * node + 2].fill(true));
    let follow = model.linkage.followers.iter().flat_map(|follower| follower.dofs());
    follow.for_each(|(_, dof)| held[dof] = true);
    for (node, d) in holding(step) {
        // An inclined direction and what is across it are counted as the dofs that have their equations.
        held[2 * node + usize::from(d.x.abs() < d.y.abs())] = true;
    }
    match held.iter().position(|held| !held) {
        Some(dof) => Err(ModelError::new(
            format!("steps[{k}].supports"),
            format!(
                "node {} belongs to no element and is free along {}: hold it by a support, a spring or contact",
                model.mesh.node_tags[dof / 2],
                ["x", "y"][dof % 2]
            ),
        )),
        None => Ok(()),
    }
}

/// Accelerations follow from masses, so a node that may move needs one.
fn check_mass(k: usize, step: &Step, model: &Model) -> Result<(), ModelError> {
    let mut carried = vec![false; model.mesh.nodes.len()];
    let dense = model.bodies.iter().filter(|body| body.material.density() > 0.0).flat_map(|body| &body.nodes);
    let points = model.point_masses.iter().flat_map(|point| &point.nodes);
    dense.chain(points).for_each(|&node| carried[node] = true);
    let prescribed = |dof: usize| step.supports.binary_search_by_key(&dof, |support| support.at.dof).is_ok();
    let held = |node: usize| prescribed(2 * node) && prescribed(2 * node + 1);
    let massless = |node: &usize| !(carried[*node] || held(*node));
    let why = format!("the dynamic step `{}` (steps[{k}]) needs a mass", step.name);
    if let Some(body) = model.bodies.iter().find(|body| body.nodes.iter().any(massless)) {
        let message = format!("is 0, but {why}: give a density");
        return Err(ModelError::new(format!("bodies.{}.material.density", body.name), message));
    }
    match (0..model.mesh.nodes.len()).find(massless) {
        Some(node) => Err(ModelError::new(
            "point_masses",
            format!("node {} belongs to no element, and {why}: give one to its group", model.mesh.node_tags[node]),
        )),
        None => Ok(()),
    }
}
