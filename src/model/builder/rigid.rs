//! Nodes that move as one: periodic sides, loading platens and rigid bodies.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix2, Vector2};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::contact::{self, Contact};
use super::error::{Checked, ModelError, check_place, check_positive, refuse_if};
use super::groups::{Place, group, nodes_at};
use super::load::Change;
use super::load_step::{LoadStep, Support};
use crate::contact::master::Shape;
use crate::mesh::rigid::RigidBody;
use crate::mesh::ties::Ties;
use crate::mesh::{Group, Mesh};
use crate::model::Model;
use crate::model::boundary::Span;
use crate::model::linkage::{Follower, Linkage, alike, rigid};
use crate::model::support::Motion;
use crate::model::written::written;

/// Motion of the nodes of a loading plate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "PlateMotion")]
#[non_exhaustive]
pub enum Plate {
    /// Equal displacements without rotation, the default for a group name
    #[default]
    AsOne,
    /// Equal ux, free uy: a frictionless platen
    UxAlike,
    /// Equal uy, free ux
    UyAlike,
    /// Rigid body that rotates under forces, springs and a `moment`; supports may constrain at most one of its
    /// nodes
    Rigid,
}

/// A loading plate.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum LoadingPlateInput {
    /// Group with equal displacements, without rotation
    Group(String),
    /// Group with another kind of motion
    Moving(MovingPlateInput),
}

written!(
    LoadingPlateInput,
    "the name of a group, or {\"on\": group, \"moves\": \"ux_alike\", \"uy_alike\" or \"rigid\"}",
    text: Group,
    object: MovingPlateInput => Self::Moving
);

/// A loading plate with another kind of motion.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MovingPlateInput {
    /// Group of its nodes
    pub on: String,
    /// Kind of motion
    pub moves: Plate,
}

impl LoadingPlateInput {
    /// Returns its group and kind of motion.
    pub fn parts(&self) -> (&str, Plate) {
        match self {
            Self::Group(name) => (name, Plate::AsOne),
            Self::Moving(MovingPlateInput { on, moves }) => (on, *moves),
        }
    }
}

/// Tolerance of matching positions, relative to the distance between the sides.
const ROUNDED: f64 = 1e-6;

/// Nodes of loading platens with equal displacements.
pub fn plates(given: &[LoadingPlateInput], mesh: &Mesh) -> Checked<Vec<Vec<usize>>> {
    let as_one =
        given.iter().map(LoadingPlateInput::parts).enumerate().filter(|(_, (_, moves))| *moves == Plate::AsOne);
    as_one.map(|(k, (name, _))| Ok(mesh.nodes_of(group(mesh, name, &format!("plates[{k}]"))?))).collect()
}

/// Ties between the nodes of pairs of sides, and of platens.
pub fn ties(periodic: &[[String; 2]], plates: &[Vec<usize>], mesh: &Mesh) -> Checked<Ties> {
    let mut joined = Vec::new();
    for (k, names) in periodic.iter().enumerate() {
        joined.extend(partners(names, mesh, &format!("periodic[{k}]"))?);
    }
    joined.extend(plates.iter().flat_map(|nodes| nodes.windows(2).map(|pair| [pair[0], pair[1]])));
    Ok(Ties::new(mesh.nodes.len(), &joined))
}

/// Pairs each node of one side with the node of the other at the offset of the sides' centers.
fn partners(names: &[String; 2], mesh: &Mesh, place: &str) -> Checked<Vec<[usize; 2]>> {
    let [side, opposite] = names;
    let [first, second] = [group(mesh, side, place)?, group(mesh, opposite, place)?].map(|group| mesh.nodes_of(group));
    let (one, other) = (first.len(), second.len());
    let message =
        format!("`{side}` has {one} nodes and `{opposite}` has {other}: the nodes of periodic sides must match");
    refuse_if(one != other, place, message)?;
    let middle =
        |nodes: &[usize]| nodes.iter().map(|&node| mesh.nodes[node]).sum::<Vector2<f64>>() / nodes.len() as f64;
    let period = middle(&second) - middle(&first);
    let near = ROUNDED * period.norm();
    let message = "axisymmetric bodies can be periodic along y only, the axis";
    refuse_if(mesh.section.is_axisymmetric() && period.x.abs() > near, place, message)?;
    if let Some(shared) = first.iter().find(|node| second.binary_search(node).is_ok()) {
        let tag = mesh.node_tags[*shared];
        let message = format!("node {tag} is on both sides: periodic sides must have nodes of their own");
        return Err(ModelError::new(place, message));
    }
    // Along the sides, the order of partners agrees except for round-off; sorting by one coordinate limits the candidates.
    let mut by_x: Vec<(f64, usize)> = second.iter().map(|&node| (mesh.nodes[node].x, node)).collect();
    by_x.sort_by(|a, b| a.0.total_cmp(&b.0));
    let partner = |node: usize| {
        let expected = mesh.nodes[node] + period;
        let candidates = by_x[by_x.partition_point(|(x, _)| *x < expected.x - near)..].iter();
        let close = |other: &usize| (mesh.nodes[*other] - expected).norm() <= near;
        candidates.take_while(|(x, _)| *x <= expected.x + near).map(|(_, other)| *other).find(close).ok_or(expected)
    };
    let paired = |&node: &usize| {
        partner(node).map(|other| [node, other]).map_err(|expected| {
            let (tag, at) = (mesh.node_tags[node], mesh.nodes[node]);
            let message = format!(
                "node {tag} of `{side}` at ({}, {}) has no partner on `{opposite}`, where one should lie at ({}, {}): the nodes \
                 of periodic sides must match",
                at.x, at.y, expected.x, expected.y
            );
            ModelError::new(place, message)
        })
    };
    first.iter().map(paired).collect()
}

/// Follower nodes of platens.
pub fn linkage(given: &[LoadingPlateInput], steps: &[LoadStep], model: &Model) -> Checked<Linkage> {
    let mesh = &model.mesh;
    let tied: BTreeSet<usize> = model.ties.pairs().iter().flat_map(|&(copy, original)| [copy, original]).collect();
    let mut supported = None;
    let mut linkage = Linkage::default();
    let mut seen: BTreeSet<(usize, usize)> = BTreeSet::new();
    for (k, (name, plate)) in given.iter().map(LoadingPlateInput::parts).enumerate() {
        let components = match plate {
            Plate::AsOne => continue,
            Plate::UxAlike => [true, false],
            Plate::UyAlike => [false, true],
            Plate::Rigid => [true, true],
        };
        let place = format!("plates[{k}]");
        let nodes = mesh.nodes_of(group(mesh, name, &place)?);
        let dofs = || nodes.iter().flat_map(|node| (0..2).filter(|i| components[*i]).map(|i| (*node, i)));
        if let Some((node, _)) = dofs().find(|dof| tied.contains(&dof.0) || seen.contains(dof)) {
            let tag = mesh.node_tags[node];
            let message = format!(
                "node {tag} is tied to others already, by a periodic side or another plate: leave it out of one of the two"
            );
            return Err(ModelError::new(place, message));
        }
        seen.extend(dofs());
        let message = "x is the radius of axisymmetric bodies: plates there have equal uy, or translate together";
        refuse_if(mesh.section.is_axisymmetric() && components[0], &place, message)?;
        match plate {
            Plate::Rigid => {
                let supported = match &supported {
                    Some(supported) => supported,
                    None => supported.insert(supported_nodes(steps, mesh, &place)?),
                };
                let leaders = leaders(&nodes, supported, mesh, &place)?;
                linkage.followers.extend(rigid(&nodes, leaders, |node| mesh.nodes[node]));
                linkage.rigid.push(leaders);
            }
            _ => linkage.followers.extend(alike(&nodes, usize::from(components[1]))),
        }
        linkage.plates.push((nodes, components));
    }
    linkage.followers.sort_by_key(|follower| follower.node);
    linkage.centers = centers(&linkage, model);
    Ok(linkage)
}

/// G of the centers of mass of rigid platens. The weight of a node is the sum of its row of the mass matrix, so that the
/// momentum of a body is that of its nodes.
fn centers(linkage: &Linkage, model: &Model) -> Vec<Matrix2<f64>> {
    let mut mass = vec![0.0; model.mesh.nodes.len()];
    if !linkage.rigid.is_empty() {
        for (e, element) in model.mesh.elements.iter().enumerate() {
            let sums = model.element_mass(e).column_sum();
            element.nodes.iter().zip(&sums).for_each(|(&node, share)| mass[node] += share);
        }
        model.point_masses.iter().for_each(|point| point.nodes.iter().for_each(|&node| mass[node] += point.mass));
    }
    let mut of_leader: BTreeMap<usize, Vec<&Follower>> = BTreeMap::new();
    linkage.turning().for_each(|follower| of_leader.entry(follower.leaders[0].0).or_default().push(follower));
    let center = |&[a, b]: &[usize; 2]| {
        let own = || of_leader.get(&a).into_iter().flatten();
        let moment = own().fold(Matrix2::identity() * mass[b], |sum, f| sum + f.leaders[1].1 * mass[f.node]);
        let total = mass[a] + mass[b] + own().map(|follower| mass[follower.node]).sum::<f64>();
        if total > 0.0 { moment / total } else { Matrix2::zeros() }
    };
    linkage.rigid.iter().map(center).collect()
}

/// A and B of the rigid platen on which a moment acts.
pub fn plate_of_moment(model: &Model, on: &Place, place: &str) -> Checked<[usize; 2]> {
    let nodes = nodes_at(&model.mesh, on, &format!("{place}.on"))?;
    let is_plate = model.linkage.plates.iter().any(|(plate, components)| *components == [true; 2] && *plate == nodes);
    let leaders = model.linkage.rigid.iter().find(|plate| plate.iter().all(|node| nodes.contains(node)));
    leaders.filter(|_| is_plate).copied().ok_or_else(|| {
        let message = format!(
            "a moment acts on a rigid body or a plate that rotates, and {on} is neither: list it in plates, with \"moves\": \"rigid\""
        );
        ModelError::new(format!("{place}.on"), message)
    })
}

/// Nodes supported in any step.
fn supported_nodes(steps: &[LoadStep], mesh: &Mesh, place: &str) -> Checked<BTreeSet<usize>> {
    let mut supported = BTreeSet::new();
    for support in steps.iter().flat_map(|step| &step.supports) {
        supported.extend(nodes_at(mesh, &support.on, place)?);
    }
    Ok(supported)
}

/// The supported node of a rigid platen, or its first one, and the one farthest from it.
fn leaders(nodes: &[usize], all_supported: &BTreeSet<usize>, mesh: &Mesh, place: &str) -> Checked<[usize; 2]> {
    let supported: BTreeSet<usize> = nodes.iter().copied().filter(|node| all_supported.contains(node)).collect();
    let tags: Vec<String> = supported.iter().take(2).map(|node| mesh.node_tags[*node].to_string()).collect();
    let message = format!(
        "rotates, but supports constrain more than one of its nodes, {}: constrain one only, load it by forces, springs and a \
         moment, or prescribe the rotation of the side and leave the plate out",
        tags.join(" and ")
    );
    refuse_if(supported.len() > 1, place, message)?;
    let (Some(&first), Some(&last)) = (nodes.first(), nodes.last()) else {
        return Err(ModelError::new(place, "has no nodes"));
    };
    let a = supported.first().copied().unwrap_or(first);
    let distance = |node: usize| (mesh.nodes[node] - mesh.nodes[a]).norm();
    let b = nodes.iter().copied().fold(last, |b, node| if distance(node) > distance(b) { node } else { b });
    match distance(b) > 0.0 {
        true => Ok([a, b]),
        false => Err(ModelError::new(place, "is one point, which cannot rotate: leave it out")),
    }
}

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

/// Adds rigid bodies, whose outlines are masters of the contacts, to a mesh.
pub fn add_bodies(given: &[(String, RigidBodyInput)], contacts: &[Contact], mesh: &mut Mesh) -> Checked<()> {
    for (name, RigidBodyInput { reference, inertia }) in given {
        let place = format!("rigid_bodies.{name}");
        check_place(&format!("{place}.reference"), *reference)?;
        check_positive(&format!("{place}.inertia"), inertia.unwrap_or(1.0), " (leave it out for none)")?;
        let message = "is also the name of a group of the mesh, so supports would be ambiguous: rename it";
        refuse_if(mesh.groups.contains_key(name), place, message)?;
        let point = Vector2::from(*reference);
        let own = contacts.iter().filter(|contact| contact.rigid_body.as_ref() == Some(name));
        let farthest = own.filter_map(|contact| reach(contact, point, mesh)).fold(0.0, f64::max);
        let radius = if farthest.is_normal() { farthest } else { 1.0 };
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

/// Distance of the farthest point of a rigid master from a point: of its outline, and of the projections of the slave's nodes on a plane,
/// which has no end. `None` where the contact has no such shape, which is refused in its turn [L].
fn reach(contact: &Contact, from: Vector2<f64>, mesh: &Mesh) -> Option<f64> {
    let shape = contact::shape(&contact.master, mesh, "").ok()?;
    let slave = mesh.groups.get(&contact.slave).map(|group| mesh.nodes_of(group)).unwrap_or_default();
    Some(match shape {
        Shape::Circle(circle) => (circle.centre - from).norm() + circle.radius,
        Shape::Polyline(polyline) => polyline.corners().iter().map(|corner| (corner - from).norm()).fold(0.0, f64::max),
        Shape::Plane(plane) => {
            let master_point = |&node: &usize| plane.master_point(mesh.nodes[node]);
            slave.iter().map(|node| (master_point(node) - from).norm()).fold(0.0, f64::max)
        }
    })
}

/// Returns the moving rigid body of the rigid master of a contact, if it has one.
pub fn of_contact(contact: &Contact, mesh: &Mesh, place: &str) -> Checked<Option<RigidBody>> {
    let Some(name) = &contact.rigid_body else { return Ok(None) };
    let place = format!("{place}.rigid_body");
    if let Some(group) = contact.master_group() {
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
    let message = "axisymmetric bodies cannot rotate in the plane, and a rigid body there moves along y only: leave it \
                   out";
    refuse_if(model.mesh.section.is_axisymmetric(), &place, message)?;
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
