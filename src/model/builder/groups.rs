//! Groups and nodes of the mesh by name.

use std::collections::BTreeSet;
use std::fmt::{Display, Formatter, Result as Written};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error::{Checked, ModelError, check_name, no_body};
use crate::mesh::nearest::{NotOne, nearest as nearest_node};
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
    /// Single node of the undeformed mesh nearest to this point [x, y]. It must be unique, and no farther away than the length
    /// of the elements there [L]
    Near([f64; 2]),
    /// Group of the mesh
    #[serde(skip)]
    #[schemars(!skip, untagged)]
    Group(String),
}

written!(Place, "the name of a group, {\"node\": tag}, or {\"near\": [x, y]}", text: Group);

impl Place {
    /// Replaces a point by the tag of the node nearest to it; by its position where several mesh files use that tag.
    ///
    /// # Errors
    /// Returns a message if the node is not unique or too far away.
    pub fn settled(&self, mesh: &Mesh) -> Result<Self, String> {
        match self {
            Self::Near(point) => nearest(mesh, *point).map(|node| match tagged(mesh, mesh.node_tags[node])[..] {
                [_] => Self::Node(mesh.node_tags[node]),
                _ => Self::Near(mesh.nodes[node].into()),
            }),
            _ => Ok(self.clone()),
        }
    }

    /// Its name in the columns of results.
    pub fn column(&self) -> String {
        match self {
            Self::Group(name) => name.clone(),
            Self::Node(tag) => format!("node_{tag}"),
            Self::Near([x, y]) => format!("near_{x}_{y}"),
        }
    }
}

/// The node nearest to a point, which the adjacent elements must reach.
fn nearest(mesh: &Mesh, point: [f64; 2]) -> Result<usize, String> {
    let [x, y] = point.map(number);
    let elements = mesh.elements.iter().map(|element| element.nodes.as_slice());
    nearest_node(&mesh.nodes[..mesh.own_nodes()], elements, point).map_err(|not_one| match not_one {
        NotOne::NoPlace => format!("near ({x}, {y}) is no place: give finite numbers"),
        NotOne::NoNodes => "the mesh has no nodes".into(),
        NotOne::Several(both) => {
            let [tag, other] = both.map(|node| mesh.node_tags[node]);
            format!("nodes {tag} and {other} are equally near to ({x}, {y}): name one as {{\"node\": {tag}}}")
        }
        NotOne::Far { node, distance } => format!(
            "no node is near ({x}, {y}): the nearest, {}, lies {} away, farther than the size of the elements there",
            mesh.node_tags[node],
            number(distance)
        ),
    })
}

/// Nodes with a tag: one, unless meshes are joined.
fn tagged(mesh: &Mesh, tag: u64) -> Vec<usize> {
    (0..mesh.own_nodes()).filter(|node| mesh.node_tags[*node] == tag).collect()
}

impl From<&str> for Place {
    fn from(group: &str) -> Self {
        Self::Group(group.into())
    }
}

impl From<String> for Place {
    fn from(group: String) -> Self {
        Self::Group(group)
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

/// Returns a group of the mesh.
pub fn group<'m>(mesh: &'m Mesh, name: &str, place: &str) -> Checked<&'m Group> {
    mesh.group(name).map_err(|error| ModelError::new(place, error))
}

/// Kind of the members of a group.
pub fn kind(group: &Group) -> &'static str {
    match group {
        Group::Elements(_) => "solid elements",
        Group::Edges(_) => "edges",
        Group::Nodes(_) => "points",
    }
}

/// Returns the edges of an edge group.
pub fn edges<'m>(mesh: &'m Mesh, name: &str, place: &str) -> Checked<&'m [Edge]> {
    match group(mesh, name, place)? {
        Group::Edges(edges) => Ok(edges),
        group => Err(ModelError::new(place, format!("`{name}` is a group of {}, not of edges", kind(group)))),
    }
}

/// Node lists of edges.
pub fn node_lists(edges: &[Edge]) -> Vec<Vec<usize>> {
    edges.iter().map(|edge| edge.nodes.clone()).collect()
}

/// Nodes at a place.
pub fn nodes_at(mesh: &Mesh, on: &Place, place: &str) -> Checked<Vec<usize>> {
    match on {
        Place::Group(name) => Ok(mesh.nodes_of(group(mesh, name, place)?)),
        Place::Near(point) => Ok(vec![nearest(mesh, *point).map_err(|message| ModelError::new(place, message))?]),
        Place::Node(tag) => match tagged(mesh, *tag)[..] {
            [node] => Ok(vec![node]),
            [] => Err(ModelError::new(place, format!("the mesh has no node {tag}"))),
            [..] => {
                let message = "several of the mesh files have a node";
                Err(ModelError::new(place, format!("{message} {tag}: name it by {{\"near\": [x, y]}}, or by a group")))
            }
        },
    }
}

/// Returns the group of a load that acts on groups only.
pub fn group_at<'p>(on: &'p Place, place: &str) -> Checked<&'p str> {
    match on {
        Place::Group(name) => Ok(name),
        Place::Node(_) | Place::Near(_) => {
            Err(ModelError::new(format!("{place}.on"), format!("{on} cannot carry this load: name a group")))
        }
    }
}

/// Returns the number of a body.
pub fn body(model: &Model, name: &str, place: &str) -> Checked<usize> {
    let names = || model.bodies.iter().map(|body| body.name.as_str());
    names().position(|known| known == name).ok_or_else(|| no_body(name, names(), place))
}

/// Returns the watched groups and nodes, each once, and all rigid bodies.
pub fn watched(places: &[Place], model: &Model) -> Checked<Vec<WatchedSet>> {
    let mut seen = BTreeSet::new();
    let mut sets = Vec::with_capacity(places.len());
    for (k, on) in places.iter().enumerate() {
        let (place, name) = (format!("watch[{k}]"), on.column());
        check_name(&place, &name)?;
        if !seen.insert(name.clone()) {
            return Err(ModelError::new(place, format!("`{name}` is watched already: name it once")));
        }
        sets.push(watched_set(model, on, &place)?);
    }
    for body in model.mesh.rigid_bodies.iter().filter(|body| !seen.contains(&body.name)) {
        sets.push(watched_set(model, &Place::Group(body.name.clone()), "rigid_bodies")?);
    }
    Ok(sets)
}

/// Returns a watched set. Reactions of copies belong to their originals; the displacement of a platen counts with every node.
fn watched_set(model: &Model, on: &Place, place: &str) -> Checked<WatchedSet> {
    let nodes = nodes_at(&model.mesh, on, place)?;
    let edges = match on {
        Place::Group(name) => match group(&model.mesh, name, place)? {
            Group::Edges(edges) => edges.clone(),
            _ => Vec::new(),
        },
        _ => Vec::new(),
    };
    let held = [0, 1].map(|i| model.ties.originals(model.held(&nodes, i)));
    let nodes = if model.plates.is_empty() { model.ties.originals(nodes) } else { nodes };
    Ok(WatchedSet { name: on.column(), nodes, edges, held })
}
