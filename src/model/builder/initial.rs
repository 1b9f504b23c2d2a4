//! How a run starts: velocities of bodies and point masses, and contacts that are closed from the beginning.

use super::body::GivenMass;
use super::contact::{Contact, InitialTractions};
use super::error::{Checked, ModelError};
use super::friction::{check_profile, defined, position};
use super::limits::check_finite;
use crate::contact::pair::{ContactPair, InitialTraction};
use crate::laws::friction::observables;
use crate::model::Model;

/// An initial traction may pass the strength μ p by this share: numbers are written with a few digits.
const ROUNDED: f64 = 1e-9;

/// Initial velocity of every dof, from those of bodies and of point masses [L/T].
pub fn velocities(of_bodies: &[(String, [f64; 2])], masses: &[GivenMass], model: &Model) -> Checked<Vec<f64>> {
    let mut velocity: Vec<Option<[f64; 2]>> = vec![None; model.mesh.nodes.len()];
    let mut give = |place: String, nodes: &[usize], value: [f64; 2]| {
        check_finite(&place, value)?;
        for &node in nodes {
            let earlier = velocity[node].replace(value).filter(|earlier| *earlier != value);
            if let Some([x, y]) = earlier {
                let tag = model.mesh.node_tags[node];
                let message =
                    format!("node {tag} starts with the velocity [{x}, {y}] already: a node can have one only");
                return Err(ModelError::new(place, message));
            }
        }
        Ok(())
    };
    for (name, value) in of_bodies {
        let place = format!("initial_velocity.{name}");
        let Some(body) = model.bodies.iter().find(|body| body.name == *name) else {
            let known: Vec<&str> = model.bodies.iter().map(|body| body.name.as_str()).collect();
            let message = format!("there is no body `{name}`; the bodies are {}", known.join(", "));
            return Err(ModelError::new(place, message));
        };
        give(place, &body.nodes, *value)?;
    }
    for (point, given) in model.point_masses.iter().zip(masses) {
        if let Some(value) = given.velocity {
            give(format!("point_masses.{}.velocity", point.name), &point.nodes, value)?;
        }
    }
    let velocity: Vec<[f64; 2]> = velocity.into_iter().map(Option::unwrap_or_default).collect();
    let differ = |&&(copy, original): &&(usize, usize)| velocity[copy] != velocity[original];
    if let Some((copy, original)) = model.ties.pairs().iter().find(differ) {
        let [a, b] = [copy, original].map(|node| model.mesh.node_tags[*node]);
        let message =
            format!("nodes {a} and {b} of periodic sides start with different velocities: give them the same");
        return Err(ModelError::new("initial_velocity", message));
    }
    Ok(velocity.into_iter().flatten().collect())
}

/// Start a contact closed, if its tractions and its law allow it.
pub fn close(pair: &mut ContactPair, given: &InitialTractions, model: &Model, place: &str) -> Checked<()> {
    let [at_pressure, at_traction] = ["pressure", "traction"].map(|key| format!("{place}.{key}"));
    let InitialTractions { pressure: pressures, traction: tractions, .. } = given;
    check_profile(pressures, &at_pressure)?;
    check_profile(tractions, &at_traction)?;
    let mut initial = Vec::with_capacity(pair.points.len());
    for point in &pair.points {
        let at = position(point, &model.mesh);
        let (pressure, traction) = (defined(pressures, at, &at_pressure)?, defined(tractions, at, &at_traction)?);
        if pressure < 0.0 {
            let message = format!("is {pressure}: must be zero or positive, which is compression");
            return Err(ModelError::new(at_pressure, message));
        }
        let limit = pair.law(point).starting_limit(pressure);
        if traction.abs() > limit * (1.0 + ROUNDED) {
            let law = pair.law(point);
            let mu = observables::value(law, "mu", &law.initial_state());
            let message = format!(
                "is {traction}: the initial strength is exceeded already, which is mu p = {limit} with mu = {mu} and \
                 p = {pressure}"
            );
            return Err(ModelError::new(at_traction, message));
        }
        initial.push(InitialTraction { pressure, traction });
    }
    let undeformed = model.mesh.undeformed();
    let closed = pair.start_closed(initial, &undeformed);
    closed.map_err(|point| {
        let at = pair.points[point].at(&undeformed);
        let message =
            format!("the slave point at ({}, {}) faces no part of the master: it cannot be pressed", at.x, at.y);
        ModelError::new(place, message)
    })
}

/// Nodal forces with which the initial stress of the bodies meets the initial tractions of balanced contacts; empty if
/// there are none [F].
pub fn prestress(contacts: &[Contact], model: &Model) -> Vec<f64> {
    let balanced = |contact: &Contact| contact.initial.as_ref().is_some_and(|initial| initial.balanced);
    let mut forces = Vec::new();
    let undeformed = model.mesh.undeformed();
    for (pair, _) in model.contacts.iter().zip(contacts).filter(|(_, contact)| balanced(contact)) {
        forces.resize(model.dofs(), 0.0);
        for (node, force) in pair.initial_forces(&undeformed) {
            forces[2 * node] -= force.x;
            forces[2 * node + 1] -= force.y;
        }
    }
    forces
}
