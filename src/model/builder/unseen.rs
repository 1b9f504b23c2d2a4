//! What lies between the points of a contact, or next to them: nodes of both sides and the outline of the slave's bodies.

use std::collections::{BTreeMap, BTreeSet};

use super::contact::Contact;
use super::groups::node_lists;
use super::thickness::Outline;
use crate::contact::master::{Master, Rigid};
use crate::contact::pair::{BothSurfaces, ContactPair};
use crate::contact::surface::{SlavePoint, Surface, in_order, lone_point, nodal_points};
use crate::mesh::{Group, Mesh};
use crate::model::Model;

/// Finds surface nodes of the slave's bodies that are not on the slave and initially outside a rigid master, whose penetration
/// would not be detected.
pub fn undetected(contacts: &[Contact], pairs: &mut [ContactPair], model: &Model) {
    // What another contact looks after is seen, if it is the same surface of the same tool that this one presses on.
    let rigid = |pair: &&ContactPair| matches!(pair.master, Master::Rigid(_));
    let slave = |pair: &ContactPair| (pair.master.clone(), pair.slave_nodes().collect());
    let slaves: Vec<(Master, BTreeSet<usize>)> = pairs.iter().filter(rigid).map(slave).collect();
    // Several contacts may belong to the same bodies.
    let mut surfaces: BTreeMap<BTreeSet<usize>, BTreeSet<usize>> = BTreeMap::new();
    for (contact, pair) in contacts.iter().zip(pairs) {
        let (Master::Rigid(rigid), Ok(Group::Edges(slave))) = (&pair.master, model.mesh.group(&contact.slave)) else {
            continue;
        };
        let bodies: BTreeSet<usize> = slave.iter().map(|edge| model.body_of_element[edge.element]).collect();
        let seen = |node: &usize| slaves.iter().any(|(of, slave)| *of == pair.master && slave.contains(node));
        let surface = surfaces
            .entry(bodies)
            .or_insert_with_key(|bodies| free_sides(model, bodies).into_iter().flatten().collect());
        let others = surface.iter().filter(|node| !seen(node)).map(|&node| lone_point(node, 0.0));
        pair.unseen = others.filter(|point| is_outside(rigid, point, &model.mesh)).collect();
    }
}

fn is_outside(rigid: &Rigid, point: &SlavePoint, mesh: &Mesh) -> bool {
    rigid.project(point, &mesh.undeformed()).is_none_or(|projection| projection.gap > 0.0)
}

/// Sides of bodies that no two of their elements share, with the body on their left.
fn free_sides(model: &Model, bodies: &BTreeSet<usize>) -> Vec<Vec<usize>> {
    let elements = model.mesh.elements.iter().zip(&model.body_of_element);
    Mesh::free_sides(elements.filter(|(_, body)| bodies.contains(body)).map(|(element, _)| element))
}

/// Nodes of both sides, with the slave edges as a master, and the outline of the slave's bodies if the master is rigid.
pub fn both_surfaces(contact: &Contact, model: &Model, outline: Option<&Outline>) -> Option<BothSurfaces> {
    let of = |name: &str| match model.mesh.group(name) {
        Ok(Group::Edges(edges)) => in_order(&node_lists(edges)),
        _ => Vec::new(),
    };
    let (slave, master) = (of(&contact.slave), contact.master_group());
    if contact.is_own() || slave.is_empty() {
        return None;
    }
    let mut own = nodal_points(&slave);
    let sides = match (master, model.mesh.group(&contact.slave)) {
        (None, Ok(Group::Edges(slave))) => {
            free_sides(model, &slave.iter().map(|edge| model.body_of_element[edge.element]).collect())
        }
        _ => Vec::new(),
    };
    if let (Some(outline), true) = (outline, master.is_some()) {
        outline.limit(&mut own, None);
    }
    let nodes = master.map(|master| nodal_points(&of(master))).unwrap_or_default();
    Some(BothSurfaces { nodes, slave: Master::Mesh(Surface::new(&slave)), own, sides })
}
