//! How a run starts: velocities of bodies and point masses, and contacts that are closed from the beginning.

use super::along::{defined, position, profile};
use super::error::Complaint;
use super::file::{Case, InitialInput};
use crate::contact::pair::{ContactPair, InitialTraction};
use crate::laws::friction::observables;
use crate::mesh::configuration::Configuration;
use crate::model::Model;

/// An initial traction may pass the strength μ p by this share: numbers are written with a few digits.
const ROUNDED: f64 = 1e-9;

/// Initial velocity of every dof [L/T].
pub fn velocities(case: &Case, model: &Model) -> Result<Vec<f64>, Complaint> {
    let mut velocity: Vec<Option<[f64; 2]>> = vec![None; model.mesh.nodes.len()];
    let mut give = |place: String, nodes: &[usize], value: [f64; 2]| {
        for &node in nodes {
            let earlier = velocity[node].replace(value).filter(|earlier| *earlier != value);
            if let Some([x, y]) = earlier {
                let tag = model.mesh.node_tags[node];
                let message =
                    format!("node {tag} starts with the velocity [{x}, {y}] already: a node can have one only");
                return Err(Complaint::new(place, message));
            }
        }
        Ok(())
    };
    for (name, value) in &case.initial_velocity {
        let place = format!("initial_velocity.{name}");
        let Some(body) = model.bodies.iter().find(|body| body.name == *name) else {
            let known: Vec<&str> = model.bodies.iter().map(|body| body.name.as_str()).collect();
            let message = format!("there is no body `{name}`; the bodies are {}", known.join(", "));
            return Err(Complaint::new(place, message));
        };
        give(place, &body.nodes, *value)?;
    }
    for point in &model.point_masses {
        if let Some(value) = case.point_masses[&point.name].velocity {
            give(format!("point_masses.{}.velocity", point.name), &point.nodes, value)?;
        }
    }
    let velocity: Vec<[f64; 2]> = velocity.into_iter().map(Option::unwrap_or_default).collect();
    if let Some((copy, original)) =
        model.ties.pairs().iter().find(|(copy, original)| velocity[*copy] != velocity[*original])
    {
        let [a, b] = [copy, original].map(|node| model.mesh.node_tags[*node]);
        let message =
            format!("nodes {a} and {b} of periodic sides start with different velocities: give them the same");
        return Err(Complaint::new("initial_velocity", message));
    }
    Ok(velocity.into_iter().flatten().collect())
}

/// What is wrong with velocities that a static first step takes no notice of.
pub(super) fn lost_velocity(model: &Model) -> Option<String> {
    let first = model.steps.first().filter(|step| !step.scheme.is_dynamic())?;
    let moving = model.initial_velocity.iter().any(|v| *v != 0.0);
    moving.then(|| {
        format!(
            "the initial velocities are lost: the first step, `{}`, is static; give it a dynamic scheme",
            first.name
        )
    })
}

/// Start a contact closed, if its tractions and its law allow it.
pub fn close(pair: &mut ContactPair, input: &InitialInput, model: &Model, place: &str) -> Result<(), Complaint> {
    let [at_pressure, at_traction] = ["pressure", "traction"].map(|key| format!("{place}.{key}"));
    let pressures = profile(&input.pressure, &at_pressure)?;
    let tractions = profile(&input.traction, &at_traction)?;
    let mut initial = Vec::with_capacity(pair.points.len());
    for point in &pair.points {
        let at = position(point, &model.mesh);
        let (pressure, traction) = (defined(&pressures, at, &at_pressure)?, defined(&tractions, at, &at_traction)?);
        if pressure < 0.0 {
            let message = format!("is {pressure}: must be zero or positive, which is compression");
            return Err(Complaint::new(at_pressure, message));
        }
        let limit = pair.law(point).starting_limit(pressure);
        if traction.abs() > limit * (1.0 + ROUNDED) {
            let law = pair.law(point);
            let mu = observables::value(law, "mu", &law.initial_state());
            let message = format!(
                "is {traction}: the initial strength is exceeded already, which is mu p = {limit} with mu = {mu} and \
                 p = {pressure}"
            );
            return Err(Complaint::new(at_traction, message));
        }
        initial.push(InitialTraction { pressure, traction });
    }
    let undeformed = Configuration::undeformed(&model.mesh.nodes);
    let closed = pair.start_closed(initial, &undeformed);
    closed.map_err(|point| {
        let at = pair.points[point].at(&undeformed);
        let message =
            format!("the slave point at ({}, {}) faces no part of the master: it cannot be pressed", at.x, at.y);
        Complaint::new(place, message)
    })
}

/// Nodal forces with which the initial stress of the bodies meets the initial tractions of balanced contacts; empty if
/// there are none [F].
pub fn prestress(case: &Case, model: &Model) -> Vec<f64> {
    let balanced = |pair: &&ContactPair| case.contacts[&pair.name].initial.as_ref().is_some_and(|i| i.balanced);
    let mut forces = Vec::new();
    let undeformed = Configuration::undeformed(&model.mesh.nodes);
    for pair in model.contacts.iter().filter(balanced) {
        forces.resize(model.dofs(), 0.0);
        for (node, force) in pair.initial_forces(&undeformed) {
            forces[2 * node] -= force.x;
            forces[2 * node + 1] -= force.y;
        }
    }
    forces
}
