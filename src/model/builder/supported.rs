//! What nothing holds or carries, found before anything is solved: bodies that float in a static step, bodies and nodes
//! without mass in a dynamic one, and nodes outside all bodies that nothing holds.

use std::collections::BTreeSet;

use nalgebra::{Matrix3, RowVector3, Vector2, Vector3};

use super::error::ModelError;
use super::load_step::LoadStep;
use crate::contact::master::Master;
use crate::contact::surface::Surface;
use crate::model::support::Direction;
use crate::model::{Model, Step};

/// Share of the stiffest rigid motion below which a motion counts as free.
const HELD_BY_NOTHING: f64 = 1e-10;

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

/// Nodes and directions that supports, springs and dashpots hold.
fn holding(step: &Step) -> impl Iterator<Item = (usize, Vector2<f64>)> {
    let springs = step.loads.springs.iter().map(|spring| spring.dof);
    let absorbers = step.loads.absorbers.iter().flat_map(|absorber| [2 * absorber.node, 2 * absorber.node + 1]);
    let dofs = springs.chain(step.loads.dashpots.iter().map(|dashpot| dashpot.dof)).chain(absorbers);
    let supports = step.supports.iter().map(|support| support.at);
    supports.chain(dofs.map(Direction::from)).map(|at| (at.node(), at.vector()))
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

/// Every group of bodies joined by contact must be held against x, y and rotation by supports, springs or dashpots
/// in every static step. A group that touches a rigid plane is left to the solver.
fn check_floating(given: &[LoadStep], model: &Model) -> Result<(), ModelError> {
    for (k, step) in model.steps.iter().enumerate().filter(|(_, step)| !step.scheme.is_dynamic()) {
        for group in joined_bodies(model) {
            let Some(motion) = free_motion(model, step, &group) else { continue };
            let names: Vec<String> = group.iter().map(|&body| format!("`{}`", model.bodies[body].name)).collect();
            let held = if given[k].supports.is_empty() && step.supports.is_empty() {
                "there is no support at all"
            } else {
                "the supports do not hold it"
            };
            let message = format!(
                "{} can move freely {motion}: {held}; a static step needs supports or springs against every rigid motion",
                names.join(" with ")
            );
            return Err(ModelError::new(format!("steps[{k}].supports"), message));
        }
    }
    Ok(())
}

/// Groups of bodies joined by contacts; those that touch a rigid body are left out.
fn joined_bodies(model: &Model) -> Vec<Vec<usize>> {
    let body_at = |node: usize| model.bodies.iter().position(|body| body.nodes.binary_search(&node).is_ok());
    let bodies_of = |nodes: &mut dyn Iterator<Item = usize>| nodes.filter_map(body_at).collect::<BTreeSet<_>>();
    let mut group: Vec<usize> = (0..model.bodies.len()).collect();
    let mut on_rigid = vec![false; model.bodies.len()];
    for pair in &model.contacts {
        let slaves = bodies_of(&mut pair.points.iter().flat_map(|point| point.position.iter().map(|&(node, _)| node)));
        match &pair.master {
            Master::Rigid(_) => slaves.iter().for_each(|&slave| on_rigid[slave] = true),
            Master::Mesh(Surface { segments, .. }) => {
                // A group of edges may run along several bodies.
                let masters = bodies_of(&mut segments.iter().map(|segment| segment.ends[0]));
                let joined: Vec<usize> = slaves.iter().chain(&masters).map(|&body| group[body]).collect();
                group.iter_mut().filter(|g| joined.contains(g)).for_each(|g| *g = joined[0]);
            }
        }
    }
    let members = |g: usize| (0..group.len()).filter(|&body| group[body] == g).collect::<Vec<_>>();
    let groups = (0..group.len()).map(members).filter(|bodies| !bodies.is_empty());
    groups.filter(|bodies| !bodies.iter().any(|&body| on_rigid[body])).collect()
}

/// A rigid motion of the bodies that no prescribed dof, spring or dashpot resists.
fn free_motion(model: &Model, step: &Step, bodies: &[usize]) -> Option<String> {
    let nodes: Vec<usize> = bodies.iter().flat_map(|&body| model.bodies[body].nodes.iter().copied()).collect();
    let centre = nodes.iter().map(|&n| model.mesh.nodes[n]).sum::<Vector2<f64>>() / nodes.len() as f64;
    let radius = nodes.iter().fold(f64::MIN_POSITIVE, |r, &n| r.max((model.mesh.nodes[n] - centre).norm()));
    let mut resistance = Matrix3::zeros();
    if model.mesh.section.is_axisymmetric() {
        // Hoops resist all but the motion along the axis.
        resistance = Matrix3::from_diagonal(&Vector3::new(1.0, 0.0, 1.0));
    }
    for (node, d) in holding(step) {
        if !bodies.iter().any(|&body| model.bodies[body].nodes.binary_search(&node).is_ok()) {
            continue;
        }
        let arm = (model.mesh.nodes[node] - centre) / radius;
        let row = RowVector3::new(d.x, d.y, d.y * arm.x - d.x * arm.y);
        resistance += row.transpose() * row;
    }
    // Periodic sides keep parallel.
    for &(copy, original) in model.ties.pairs() {
        if [copy, original].iter().all(|node| nodes.contains(node)) {
            let apart = (model.mesh.nodes[copy] - model.mesh.nodes[original]).norm() / radius;
            resistance[(2, 2)] += apart * apart;
        }
    }
    // Of plates that are alike in one component, the nodes keep their distance in it.
    for follower in model.linkage.followers.iter().filter(|follower| follower.leaders.len() == 1) {
        let leader = follower.leaders[0].0;
        if [leader, follower.node].iter().all(|node| nodes.contains(node)) {
            let apart = (model.mesh.nodes[follower.node] - model.mesh.nodes[leader]) / radius;
            let turned = if follower.components[0] { apart.y } else { apart.x };
            resistance[(2, 2)] += turned * turned;
        }
    }
    let eigen = resistance.symmetric_eigen();
    let (weakest, value) = eigen.eigenvalues.argmin();
    if value > HELD_BY_NOTHING * eigen.eigenvalues.amax() {
        return None;
    }
    let motion = eigen.eigenvectors.column(weakest);
    let words = ["along x", "along y", "in rotation"];
    let strongest = motion.amax();
    let free: Vec<&str> = (0..3).filter(|&i| motion[i].abs() > 0.1 * strongest).map(|i| words[i]).collect();
    Some(free.join(" with "))
}
