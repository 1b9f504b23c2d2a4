//! From a contact as it is given to the pair of surfaces that is evaluated.

use std::collections::BTreeSet;

use super::contact::{Contact, MasterSide};
use super::error::{Checked, ModelError};
use super::groups::{edges, group, node_lists};
use super::limits::check_size;
use super::penalty::{Penalty, depth_behind, penalty};
use super::radiation::radiation;
use super::unseen::{modulus, unseen};
use super::{fluid, initial, rigid};
use crate::contact::master::Master;
use crate::contact::mortar::{Mortar, mortar_points};
use crate::contact::pair::{ContactPair, Reverse};
use crate::contact::surface::{
    SlavePoint, Surface, gauss_points, in_order, lone_point, nodal_points, nodal_points_of_rings,
};
use crate::laws::friction::Offsets;
use crate::mesh::section::Section;
use crate::mesh::{Edge, Group, Mesh};
use crate::model::Model;
use crate::model::method::{Chosen, Method, choose};

/// The pairs of contacts.
pub fn pairs(contacts: &[Contact], model: &Model) -> Checked<Vec<ContactPair>> {
    check_penetrations(contacts, &model.mesh)?;
    let mut pairs = contacts.iter().map(|contact| pair(contact, model)).collect::<Checked<Vec<_>>>()?;
    unseen(contacts, &mut pairs, model);
    Ok(pairs)
}

/// The pair of a contact, but for what its points do not see.
fn pair(contact: &Contact, model: &Model) -> Checked<ContactPair> {
    let place = format!("contacts.{}", contact.name);
    let (mut points, mortar) = slave_points(&place, contact, &model.mesh)?;
    let master = master(&place, contact, &points, model)?;
    if let Master::Mesh(surface) = &master {
        points.iter_mut().flat_map(|point| &mut point.length).for_each(|length| length.factor *= surface.share());
    }
    let Penalty { alpha_n, alpha_t, compliance } = penalty(&place, contact, model)?;
    let offsets = Offsets { dilatancy: contact.dilatancy, wear: contact.wear };
    let laws = contact.friction.laws(&place, &mut points, &model.mesh, alpha_t, offsets)?;
    for stiffness in laws.iter().map(|law| law.start().stiffness()).filter(|stiffness| *stiffness > 0.0) {
        check_size(&format!("{place}.friction"), "alpha_t", stiffness)?;
    }
    let mut pair = ContactPair {
        name: contact.name.clone(),
        body: body(contact, points.first(), model),
        touch: TOUCH * size(&points, model),
        points,
        mortar,
        alpha_n,
        compliance,
        penetration: contact.penetration,
        radiation: radiation(&place, contact, model)?,
        fluid: fluid::fluid(&place, contact)?,
        laws,
        initial: None,
        unseen: Vec::new(),
        modulus: modulus(contact, model),
        reverse: reverse(contact, &model.mesh),
        small: None,
        master,
    };
    if contact.small_sliding {
        if contact.is_own() {
            let message = "a surface meets itself where only its motion brings it, and small sliding keeps what faces a point at \
                           the start: take finite sliding, or name the two parts that touch as slave and master";
            return Err(ModelError::new(format!("{place}.sliding"), message));
        }
        pair.slide_little(&model.mesh.undeformed());
    }
    fluid::check(&pair, &place, model)?;
    start(&mut pair, contact, model, &place)?;
    Ok(pair)
}

/// Share of the shortest edge of the slave within which surfaces touch.
const TOUCH: f64 = 1e-9;

/// The shortest edge that a slave point belongs to; of points of no edge the length of one that has their area [L].
fn size(points: &[SlavePoint], model: &Model) -> f64 {
    let undeformed = model.mesh.undeformed();
    let of = |point: &SlavePoint| {
        point.edge_length(&undeformed).unwrap_or_else(|| match model.mesh.section {
            Section::Axisymmetric => point.area.sqrt(),
            Section::PlaneStress { thickness } => point.area / thickness,
            _ => point.area,
        })
    };
    points.iter().map(of).fold(f64::INFINITY, f64::min)
}

/// The body of the slave's edge at its first point. Where two bodies meet a node is one of both: the edge tells, not the node.
fn body(contact: &Contact, first: Option<&SlavePoint>, model: &Model) -> Option<usize> {
    let (node, _) = *first?.position.first()?;
    match model.mesh.group(&contact.slave) {
        Ok(Group::Edges(edges)) => {
            let edge = edges.iter().find(|edge| edge.nodes.contains(&node))?;
            Some(model.body_of_element[edge.element])
        }
        _ => {
            let mut there = (0..model.bodies.len()).filter(|&k| model.bodies[k].nodes.binary_search(&node).is_ok());
            there.next().filter(|_| there.next().is_none())
        }
    }
}

/// How the surfaces lie at the start: as they are, closed, or to be fitted.
fn start(pair: &mut ContactPair, contact: &Contact, model: &Model, place: &str) -> Checked<()> {
    if let Some(initial) = &contact.initial {
        initial::close(pair, (initial, &contact.slave), model, &format!("{place}.initial"))?;
    }
    if contact.shrink_fit {
        if contact.initial.is_some() {
            let message = "has no meaning together with `initial`, which closes every gap and overlap: leave one out";
            return Err(ModelError::new(format!("{place}.shrink_fit"), message));
        }
        pair.start_fitting(&model.mesh.undeformed());
    }
    Ok(())
}

/// Gaps are differences of positions and displacements; of these, round-off of the size of the model is left.
const OF_SIZE: f64 = 8.0 * f64::EPSILON;

/// A penetration must be one that gaps can tell.
fn check_penetrations(contacts: &[Contact], mesh: &Mesh) -> Checked<()> {
    let least = OF_SIZE * mesh.diagonal();
    contacts.iter().try_for_each(|contact| check_penetration(contact, least))
}

fn check_penetration(contact: &Contact, least: f64) -> Checked<()> {
    let Some(penetration) = contact.penetration else { return Ok(()) };
    let message = if !(penetration > 0.0 && penetration.is_finite()) {
        format!("is {penetration}: must be positive (leave it out for the plain penalty)")
    } else if penetration < least {
        format!("is {penetration:e}: gaps of this model have round-off of {least:.1e}; allow more than that")
    } else {
        return Ok(());
    };
    Err(ModelError::new(format!("contacts.{}.normal.penetration", contact.name), message))
}

/// Where a contact of edges is evaluated; that of a group of points is at the points.
pub fn evaluation(contact: &Contact, mesh: &Mesh) -> Option<Chosen> {
    let master = match &contact.master {
        MasterSide::Group(group) => Some(group.as_str()),
        _ => None,
    };
    let chosen = || choose(&contact.slave, master, contact.method, contact.points, contact.smooth, mesh);
    contact.area.is_none().then(chosen)
}

/// Nodes of the slaves whose mass is to be moved away.
pub fn massless(contacts: &[Contact], mesh: &Mesh) -> Checked<Vec<bool>> {
    let mut massless = vec![false; mesh.nodes.len()];
    for contact in contacts.iter().filter(|contact| contact.massless) {
        let place = format!("contacts.{}", contact.name);
        if contact.area.is_some() {
            let message = "is for a slave group of edges, whose elements have the mass: leave it out";
            return Err(ModelError::new(format!("{place}.massless"), message));
        }
        let slave = edges(mesh, &contact.slave, &format!("{place}.slave"))?;
        slave.iter().flat_map(|edge| &edge.nodes).for_each(|&node| massless[node] = true);
    }
    Ok(massless)
}

/// The nodes of a mesh master against the edges of the slave.
fn reverse(contact: &Contact, mesh: &Mesh) -> Option<Reverse> {
    let MasterSide::Group(master) = &contact.master else { return None };
    let [master, slave] = [master, &contact.slave].map(|name| match mesh.group(name) {
        Ok(Group::Edges(edges)) => in_order(&node_lists(edges)),
        _ => Vec::new(),
    });
    let seen = !contact.is_own() && !slave.is_empty();
    seen.then(|| Reverse { nodes: nodal_points(&master), slave: Master::Mesh(Surface::new(&slave)) })
}

/// Points of the edges, or the points themselves, each with the given area; and the edges if contact is averaged over them.
fn slave_points(place: &str, contact: &Contact, mesh: &Mesh) -> Checked<(Vec<SlavePoint>, Option<Mortar>)> {
    let name = &contact.slave;
    let slave = format!("{place}.slave");
    if let Group::Nodes(nodes) = group(mesh, name, &slave)? {
        return Ok((lone_points(place, contact, nodes)?, None));
    }
    let edges = in_order(&node_lists(edges(mesh, name, &slave)?));
    let Some(Chosen { method, points, .. }) = evaluation(contact, mesh) else {
        let message = format!("`{name}` is a group of edges, which have lengths of their own: leave the area out");
        return Err(ModelError::new(format!("{place}.area"), message));
    };
    if !(2..=4).contains(&points) {
        return Err(ModelError::new(format!("{place}.points"), format!("is {points}: must be 2, 3 or 4")));
    }
    Ok(match method {
        Method::NodeToSegment if mesh.section.is_axisymmetric() => (nodal_points_of_rings(&edges), None),
        Method::NodeToSegment => (nodal_points(&edges), None),
        Method::GaussToSegment => (gauss_points(&edges, points), None),
        Method::Mortar => {
            let (points, mortar) = mortar_points(&edges, &mesh.nodes);
            (points, Some(mortar))
        }
    })
}

fn lone_points(place: &str, contact: &Contact, nodes: &[usize]) -> Checked<Vec<SlavePoint>> {
    let at = format!("{place}.area");
    let Some(area) = contact.area else {
        let message =
            format!("is missing: `{}` is a group of points, and each needs the area it stands for", contact.slave);
        return Err(ModelError::new(at, message));
    };
    if area <= 0.0 {
        return Err(ModelError::new(at, format!("is {area}: must be positive")));
    }
    check_size(place, "area", area)?;
    Ok(nodes.iter().map(|&node| lone_point(node, area)).collect())
}

fn master(place: &str, contact: &Contact, points: &[SlavePoint], model: &Model) -> Checked<Master> {
    let mesh = &model.mesh;
    let refused = |why: &str| Err(ModelError::new(format!("{place}.smooth"), why));
    let MasterSide::Group(group) = &contact.master else {
        if contact.smooth {
            return refused("is for a master of mesh edges, and a rigid body needs none: leave it out");
        }
        return rigid::rigid(&contact.master, &format!("{place}.master")).map(Master::Rigid);
    };
    let master = edges(mesh, group, &format!("{place}.master"))?;
    let mut surface = Surface::new(&node_lists(master));
    if contact.is_own() {
        let thinnest = master.iter().map(|edge| depth_behind(edge, model)).fold(f64::INFINITY, f64::min);
        surface = surface.against_itself(0.5 * thinnest);
    } else {
        check_disjoint(place, [&contact.slave, group], points, master, mesh)?;
    }
    if !contact.smooth {
        return Ok(Master::Mesh(surface));
    }
    if contact.method == Some(Method::Mortar) {
        return refused("is not for mortar, which averages the gap: leave it out, or take gauss_to_segment");
    }
    if master.iter().any(|edge| edge.nodes.len() > 2) {
        return refused("is for straight edges, and the master has quadratic ones: leave it out");
    }
    Ok(Master::Mesh(surface.smoothed(&mesh.nodes)))
}

/// Two groups in contact must be different edges, and a slave point of no edge must not be on the master.
fn check_disjoint(
    place: &str,
    [slave, master]: [&String; 2],
    points: &[SlavePoint],
    other: &[Edge],
    mesh: &Mesh,
) -> Checked<()> {
    let nodes: BTreeSet<usize> = points.iter().flat_map(|point| point.position.iter().map(|&(node, _)| node)).collect();
    let own = |node: &usize| nodes.contains(node);
    let lone = points.iter().all(|point| point.length.is_empty());
    let shared = match lone {
        true => other.iter().flat_map(|edge| &edge.nodes).find(|node| own(node)).map(|node| vec![*node]),
        false => other.iter().map(|edge| &edge.nodes[..2]).find(|ends| ends.iter().all(own)).map(<[usize]>::to_vec),
    };
    let Some(shared) = shared else { return Ok(()) };
    let tags: Vec<String> = shared.iter().map(|&node| mesh.node_tags[node].to_string()).collect();
    let what = if lone { "node" } else { "the edge between nodes" };
    let message = format!(
        "{what} {} is both slave (`{slave}`) and master (`{master}`): the two sides of a contact need edges and nodes of \
         their own; for contact of a surface with itself name the same group of edges twice",
        tags.join(" and ")
    );
    Err(ModelError::new(place, message))
}
