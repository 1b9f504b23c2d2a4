//! What the points of a contact do not tell of themselves: nodes that no point stands for, and how stiff the bodies are.

use std::collections::{BTreeMap, BTreeSet};

use super::contact::{Contact, MasterSide};
use crate::contact::master::{Master, Rigid};
use crate::contact::pair::ContactPair;
use crate::contact::surface::{SlavePoint, lone_point};
use crate::laws::bulk::Material;
use crate::mesh::{Group, Mesh};
use crate::model::Model;

/// Find nodes of the surface of the slave's bodies that are not on the slave and outside a rigid master at the start: inside,
/// they would not be seen.
pub fn unseen(contacts: &[Contact], pairs: &mut [ContactPair], model: &Model) {
    // Many contacts may be of the same bodies.
    let mut surfaces: BTreeMap<BTreeSet<usize>, BTreeSet<usize>> = BTreeMap::new();
    for (contact, pair) in contacts.iter().zip(pairs) {
        let (Master::Rigid(rigid), Ok(Group::Edges(slave))) = (&pair.master, model.mesh.group(&contact.slave)) else {
            continue;
        };
        let bodies: BTreeSet<usize> = slave.iter().map(|edge| model.body_of_element[edge.element]).collect();
        let seen: BTreeSet<usize> = slave.iter().flat_map(|edge| &edge.nodes).copied().collect();
        let surface = surfaces.entry(bodies).or_insert_with_key(|bodies| surface_nodes(model, bodies));
        let others = surface.iter().filter(|node| !seen.contains(node)).map(|&node| lone_point(node, 0.0));
        pair.unseen = others.filter(|point| is_outside(rigid, point, &model.mesh)).collect();
    }
}

fn is_outside(rigid: &Rigid, point: &SlavePoint, mesh: &Mesh) -> bool {
    rigid.project(point, &mesh.undeformed()).is_none_or(|projection| projection.gap > 0.0)
}

/// Nodes on sides that belong to one element only.
fn surface_nodes(model: &Model, bodies: &BTreeSet<usize>) -> BTreeSet<usize> {
    let mut sides: BTreeMap<[usize; 2], Option<Vec<usize>>> = BTreeMap::new();
    for (element, body) in model.mesh.elements.iter().zip(&model.body_of_element) {
        if !bodies.contains(body) {
            continue;
        }
        for side in 0..element.kind.corners() {
            let (corners, middle) = element.kind.edge(side);
            let nodes: Vec<usize> = corners.into_iter().chain(middle).map(|local| element.nodes[local]).collect();
            let ends = [nodes[0].min(nodes[1]), nodes[0].max(nodes[1])];
            sides.entry(ends).and_modify(|known| *known = None).or_insert(Some(nodes));
        }
    }
    sides.into_values().flatten().flatten().collect()
}

/// G*: what slip that varies along the interface is resisted with, 0 for points without bodies [F/L²]
///
/// ```text
/// 1/G* = ½ (1/G₁* + 1/G₂*),   Gᵢ* = Gᵢ/(1 − νᵢ),   a rigid master has 1/G₂* = 0
/// ```
pub fn modulus(contact: &Contact, model: &Model) -> f64 {
    let compliance = |name: &str| match model.mesh.group(name) {
        Ok(Group::Edges(edges)) => {
            let of = |element: usize| 1.0 / plane(&*model.bodies[model.body_of_element[element]].material);
            edges.iter().map(|edge| of(edge.element)).reduce(f64::max)
        }
        _ => None,
    };
    let Some(slave) = compliance(&contact.slave) else { return 0.0 };
    let master = match &contact.master {
        MasterSide::Group(group) => compliance(group).unwrap_or(0.0),
        _ => 0.0,
    };
    2.0 / (slave + master)
}

/// G/(1 − ν) = 2 G (M − G)/M,   M = λ + 2 G
fn plane(material: &dyn Material) -> f64 {
    let (shear, constrained) = (material.shear_modulus(), material.p_wave_modulus());
    2.0 * shear * (constrained - shear) / constrained
}
