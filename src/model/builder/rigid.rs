//! Input of rigid bodies: their nodes, supports of their motion, and their free components.

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::contact::{Contact, MasterSide};
use super::error::{Checked, ModelError, check_finite, check_positive};
use super::groups::Place;
use super::load::Change;
use super::load_step::Support;
use crate::mesh::rigid::RigidBody;
use crate::mesh::{Group, Mesh};
use crate::model::Model;
use crate::model::boundary::Span;
use crate::model::support::Motion;

/// A moving rigid body: contacts with a rigid master refer to it; supports, forces and a moment `on` its name act on it. Its
/// mass is given as a point mass with its name, located at the reference point
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "RigidBody")]
pub struct RigidBodyInput {
    /// Reference point [x, y]: `ux` and `uy` of a support are its displacement, `angle` is the rotation about it, and the
    /// moment in the history refers to it [L]
    pub reference: [f64; 2],
    /// Moment of inertia about the reference point, which is then the centre of mass; required in dynamic steps unless supports
    /// prescribe the `angle` [M L²]
    pub inertia: Option<f64>,
}

/// Adds rigid bodies to a mesh.
pub fn add(given: &[(String, RigidBodyInput)], mesh: &mut Mesh) -> Checked<()> {
    for (name, RigidBodyInput { reference, inertia }) in given {
        let place = format!("rigid_bodies.{name}");
        check_finite(&format!("{place}.reference"), *reference)?;
        check_positive(&format!("{place}.inertia"), inertia.unwrap_or(1.0), " (leave it out for none)")?;
        if mesh.groups.contains_key(name) {
            return Err(ModelError::new(
                place,
                "is a group of the mesh as well, and supports would not know which: rename it",
            ));
        }
        let point = Vector2::from(*reference);
        let farthest = mesh.nodes.iter().map(|node| (node - point).norm()).fold(0.0, f64::max);
        let radius = if farthest > 0.0 { farthest } else { 1.0 };
        let (node, tag) = (mesh.nodes.len(), mesh.node_tags.iter().max().map_or(0, |tag| tag.saturating_add(1)));
        mesh.nodes.extend([point; 2]);
        mesh.node_tags.extend([tag, tag.saturating_add(1)]);
        mesh.groups.insert(name.clone(), Group::Nodes(vec![node]));
        mesh.rigid_bodies.push(RigidBody {
            name: name.clone(),
            reference: node,
            turning: node + 1,
            radius,
            inertia: inertia.unwrap_or(0.0),
        });
    }
    Ok(())
}

/// Returns the moving rigid body of the rigid master of a contact, if it has one.
pub fn of_contact(contact: &Contact, mesh: &Mesh, place: &str) -> Checked<Option<RigidBody>> {
    let Some(name) = &contact.rigid_body else { return Ok(None) };
    let place = format!("{place}.rigid_body");
    if let MasterSide::Group(group) = &contact.master {
        let message =
            format!("is for a rigid master, and `{group}` is a group of edges, which move by themselves: leave it out");
        return Err(ModelError::new(place, message));
    }
    match mesh.rigid_body(name) {
        Some(body) => Ok(Some(body.clone())),
        None => Err(ModelError::new(place, unknown(name, mesh))),
    }
}

fn unknown(name: &str, mesh: &Mesh) -> String {
    let known: Vec<&str> = mesh.rigid_bodies.iter().map(|body| body.name.as_str()).collect();
    match known.is_empty() {
        true => format!("there is no rigid body `{name}`: give it, with its reference point, in rigid_bodies"),
        false => format!("there is no rigid body `{name}`; there are {}", known.join(", ")),
    }
}

/// Returns the dof of the rotation of a rigid body that a support prescribes, with its motion, or `None` if it is released.
pub fn angle(support: &Support, place: &str, span: Span, model: &Model) -> Checked<Option<(usize, Option<Motion>)>> {
    let Some(change) = &support.angle else { return Ok(None) };
    let place = format!("{place}.angle");
    let body = match &support.on {
        Place::Group(name) => model.mesh.rigid_body(name).ok_or_else(|| unknown(name, &model.mesh)),
        on => Err(format!("is for a rigid body, and {on} is a node: name the body")),
    };
    let body = body.map_err(|message| ModelError::new(&place, message))?;
    if model.mesh.section.is_axisymmetric() {
        let message = "a rotation in the plane is no motion of axisymmetric bodies, and a rigid body there moves along y alone: \
                       leave it out";
        return Err(ModelError::new(place, message));
    }
    let Some(drive) = change.given() else { return Ok(Some((2 * body.turning, None))) };
    drive.check().map_err(|message| ModelError::new(&place, message))?;
    Ok(Some((2 * body.turning, Some(Motion::Displacement(drive.times(body.radius), span)))))
}

/// Checks that a support of a rigid body uses the keys of rigid bodies.
pub fn check_support(support: &Support, place: &str, mesh: &Mesh) -> Checked<()> {
    let Place::Group(name) = &support.on else { return Ok(()) };
    match (&support.rotation, mesh.rigid_body(name)) {
        (Some(Change::To(_)), Some(_)) => {
            let message =
                "is for a group of nodes: give a rigid body ux, uy and angle, which turns it about its reference point";
            Err(ModelError::new(format!("{place}.rotation"), message))
        }
        _ => Ok(()),
    }
}

/// Dofs of rigid bodies that are always zero: the second of their turning nodes, and in axisymmetry all but uy.
pub fn still(model: &Model) -> impl Iterator<Item = usize> {
    let of_rings = model.mesh.section.is_axisymmetric();
    model.mesh.rigid_bodies.iter().flat_map(move |RigidBody { reference, turning, .. }| {
        let aside = of_rings.then_some([2 * reference, 2 * turning]);
        aside.into_iter().flatten().chain([2 * turning + 1])
    })
}

/// The rigid body on which a moment acts, if it is one.
pub fn of_moment<'m>(on: &Place, model: &'m Model) -> Option<&'m RigidBody> {
    match on {
        Place::Group(name) => model.mesh.rigid_body(name),
        Place::Node(_) | Place::Near(_) => None,
    }
}

/// Rigid body and name of its motion for a dof without support or mass; `None` for any other node.
pub fn free_motion(mesh: &Mesh, dof: usize) -> Option<(&RigidBody, &'static str)> {
    let body = mesh.rigid_bodies.iter().find(|body| body.nodes().contains(&(dof / 2)))?;
    let along = if dof == 2 * body.turning { "angle" } else { ["ux", "uy"][dof % 2] };
    Some((body, along))
}
