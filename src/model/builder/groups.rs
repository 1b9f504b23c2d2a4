//! Groups and nodes of the mesh by name.

use std::fmt::{Display, Formatter, Result as Written};

use super::error::{Checked, ModelError};
use crate::mesh::{Edge, Group, Mesh};

/// Where a support or load acts: a group or a single node.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// Group of the mesh
    Group(String),
    /// Single node, by its tag in the mesh file
    Node(u64),
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
        Place::Node(node) => match mesh.node_tags.iter().position(|tag| tag == node) {
            Some(node) => Ok(vec![node]),
            None => Err(ModelError::new(place, format!("the mesh has no node {node}"))),
        },
    }
}

/// The group of a load that acts on groups only.
pub fn group_at<'p>(on: &'p Place, place: &str) -> Checked<&'p str> {
    match on {
        Place::Group(name) => Ok(name),
        Place::Node(node) => {
            Err(ModelError::new(format!("{place}.on"), format!("node {node} cannot carry this load: name a group")))
        }
    }
}
