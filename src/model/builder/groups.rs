//! Groups and nodes of the mesh by name.

use std::fmt::{Display, Formatter, Result as Written};

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error::{Checked, ModelError, no_body};
use crate::mesh::{Edge, Group, Mesh};
use crate::model::text::number;
use crate::model::written::written;
use crate::model::{Model, WatchedSet};

/// A group or a single node.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case")]
#[schemars(!remote)]
#[non_exhaustive]
pub enum Place {
    /// Single node: its tag in the mesh file (its number from 0 in a mesh given in place)
    Node(u64),
    /// Single node of the undeformed mesh that is nearest to this point [x, y]. It must be the only one, and no farther away than
    /// the elements there are long [L]
    Near([f64; 2]),
    /// Group of the mesh
    #[serde(skip)]
    #[schemars(!skip, untagged)]
    Group(String),
}

written!(Place, "the name of a group, {\"node\": tag}, or {\"near\": [x, y]}", text: Group);

impl Place {
    /// The same, with the tag of the node that is nearest to a point.
    ///
    /// # Errors
    /// Where it is not one node, or far away.
    pub fn settled(&self, mesh: &Mesh) -> Result<Self, String> {
        match self {
            Self::Near(point) => nearest(mesh, *point).map(|node| Self::Node(mesh.node_tags[node])),
            _ => Ok(self.clone()),
        }
    }
}

/// Two nodes whose distances differ by less than this share of the model's size are equally near.
const EQUALLY_NEAR: f64 = 1e-9;

/// The one node nearest to a point, which the elements there must reach.
fn nearest(mesh: &Mesh, point: [f64; 2]) -> Result<usize, String> {
    let [x, y] = point.map(number);
    if !point.iter().all(|coordinate| coordinate.is_finite()) {
        return Err(format!("near ({x}, {y}) is no place: give finite numbers"));
    }
    let distance = |node: usize| (mesh.nodes[node] - Vector2::from(point)).norm();
    let Some(node) = (0..mesh.own_nodes()).min_by(|a, b| distance(*a).total_cmp(&distance(*b))) else {
        return Err("the mesh has no nodes".into());
    };
    let tag = mesh.node_tags[node];
    let (near, round_off) = (distance(node), EQUALLY_NEAR * mesh.diagonal());
    if let Some(other) = (0..mesh.own_nodes()).find(|other| *other != node && distance(*other) <= near + round_off) {
        let other = mesh.node_tags[other];
        return Err(format!("nodes {tag} and {other} are equally near to ({x}, {y}): name one as {{\"node\": {tag}}}"));
    }
    let beside = mesh.elements.iter().filter(|element| element.nodes.contains(&node));
    let sides =
        beside.flat_map(|element| element.nodes.iter().map(|other| (mesh.nodes[*other] - mesh.nodes[node]).norm()));
    match near <= sides.fold(round_off, f64::max) {
        true => Ok(node),
        false => Err(format!(
            "no node is near ({x}, {y}): the nearest, {tag}, lies {} away, farther than the size of the elements there",
            number(near)
        )),
    }
}

impl From<&str> for Place {
    fn from(group: &str) -> Self {
        Self::Group(group.into())
    }
}

impl Display for Place {
    fn fmt(&self, f: &mut Formatter) -> Written {
        match self {
            Self::Group(name) => f.write_str(name),
            Self::Node(tag) => write!(f, "node {tag}"),
            Self::Near([x, y]) => write!(f, "the node near ({x}, {y})"),
        }
    }
}

/// A group of the mesh.
pub fn group<'m>(mesh: &'m Mesh, name: &str, place: &str) -> Checked<&'m Group> {
    mesh.group(name).map_err(|error| ModelError::new(place, error))
}

/// What a group is made of.
pub fn kind(group: &Group) -> &'static str {
    match group {
        Group::Elements(_) => "solid elements",
        Group::Edges(_) => "edges",
        Group::Nodes(_) => "points",
    }
}

/// The edges of a group, which must be a group of edges.
pub fn edges<'m>(mesh: &'m Mesh, name: &str, place: &str) -> Checked<&'m [Edge]> {
    match group(mesh, name, place)? {
        Group::Edges(edges) => Ok(edges),
        group => Err(ModelError::new(place, format!("`{name}` is a group of {}, not of edges", kind(group)))),
    }
}

/// The nodes of each edge.
pub fn node_lists(edges: &[Edge]) -> Vec<Vec<usize>> {
    edges.iter().map(|edge| edge.nodes.clone()).collect()
}

/// The nodes at a place.
pub fn nodes_at(mesh: &Mesh, on: &Place, place: &str) -> Checked<Vec<usize>> {
    match on {
        Place::Group(name) => Ok(mesh.nodes_of(group(mesh, name, place)?)),
        Place::Near(point) => Ok(vec![nearest(mesh, *point).map_err(|message| ModelError::new(place, message))?]),
        Place::Node(node) => match mesh.node_tags[..mesh.own_nodes()].iter().position(|tag| tag == node) {
            Some(node) => Ok(vec![node]),
            None => Err(ModelError::new(place, format!("the mesh has no node {node}"))),
        },
    }
}

/// The group of a load that acts on groups only.
pub fn group_at<'p>(on: &'p Place, place: &str) -> Checked<&'p str> {
    match on {
        Place::Group(name) => Ok(name),
        Place::Node(_) | Place::Near(_) => {
            Err(ModelError::new(format!("{place}.on"), format!("{on} cannot carry this load: name a group")))
        }
    }
}

/// The number of a body.
pub fn body(model: &Model, name: &str, place: &str) -> Checked<usize> {
    let names = || model.bodies.iter().map(|body| body.name.as_str());
    names().position(|known| known == name).ok_or_else(|| no_body(name, names(), place))
}

/// The watched groups, and all rigid bodies.
pub fn watched(names: &[String], model: &Model) -> Checked<Vec<WatchedSet>> {
    let rigid = model.mesh.rigid_bodies.iter().map(|body| &body.name).filter(|name| !names.contains(name));
    names.iter().chain(rigid).enumerate().map(|(k, name)| watched_set(model, k, name)).collect()
}

/// A watched group. The reactions of copies are with the nodes they move with; the displacement of a plate counts with every node.
fn watched_set(model: &Model, k: usize, name: &str) -> Checked<WatchedSet> {
    let group = group(&model.mesh, name, &format!("watch[{k}]"))?;
    let nodes = model.mesh.nodes_of(group);
    let held = [0, 1].map(|i| model.ties.originals(model.held(&nodes, i)));
    let nodes = if model.plates.is_empty() { model.ties.originals(nodes) } else { nodes };
    Ok(WatchedSet { name: name.into(), nodes, held })
}
