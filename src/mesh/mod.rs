//! Nodes, solid elements, and the named groups that a case refers to.
//!
//! A mesh comes from a gmsh file ([`gmsh::read`]), from blocks ([`Blocks`]), or node by node from the case file or from code
//! ([`InlineMesh::build`]); [`Mesh::join`] combines several. Readers only fill in a raw mesh; one check turns it into a
//! [`Mesh`], so that every mesh is consistent whatever its source.

mod check;
mod divided;
mod error;
pub(crate) mod few;
pub mod gmsh;
mod inline;
pub(crate) mod joined;
pub(crate) mod names;
pub(crate) mod nearest;
pub(crate) mod outline;
mod placed;
mod several;
mod transfinite;
mod within;

cfg_if::cfg_if! {
    if #[cfg(feature = "internals")] {
        pub mod boxes;
        pub mod configuration;
        pub mod rigid;
        pub mod section;
        pub mod shape;
        pub mod ties;
    } else {
        pub(crate) mod boxes;
        pub(crate) mod configuration;
        pub(crate) mod rigid;
        pub(crate) mod section;
        pub(crate) mod shape;
        pub(crate) mod ties;
    }
}

use std::collections::BTreeMap;

use nalgebra::Vector2;

use boxes::Box2;

#[doc(hidden)]
pub use configuration::Configuration;
use configuration::vector;
pub use error::MeshError;
pub use inline::InlineMesh;
pub use names::UnknownGroup;
use outline::Line;
pub use placed::{PlacedCircle, PlacedGroup};
use rigid::RigidBody;
pub use section::Section;
pub use shape::ElementKind;
pub use transfinite::{Block, BlockError, BlockKind, Blocks, Grading};

/// Upper bound of the number of elements of a mesh that is made here.
pub(crate) const MOST_ELEMENTS: f64 = 4e6;

/// A solid element: its kind and its nodes, counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Element {
    /// kind
    pub kind: ElementKind,
    /// node numbers, in the order of [`crate::mesh::shape`]
    pub nodes: Vec<usize>,
}

/// A boundary edge of a body, oriented with the body on its left.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Edge {
    /// node numbers: start, end, and the middle node of a quadratic edge
    pub nodes: Vec<usize>,
    /// adjacent solid element
    pub element: usize,
}

/// An edge of a group that lies between two bodies which share its nodes: it is the side of one of them.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct Between {
    /// position in the group
    pub at: usize,
    /// tag of the line, for messages
    pub line: u64,
    /// the edge as a side of the other body
    pub other: Edge,
}

#[doc(hidden)]
impl Between {
    /// Names of the bodies: of that whose side the edge is, and of the other.
    pub fn bodies(&self, mesh: &Mesh, group: &str) -> [String; 2] {
        let own = match mesh.groups.get(group) {
            Some(Group::Edges(edges)) => edges[self.at].element,
            _ => self.other.element,
        };
        [own, self.other.element].map(|element| mesh.body_of(element).unwrap_or_default().into())
    }

    /// Makes it the side of the other body.
    pub fn swap(&mut self, mesh: &mut Mesh, group: &str) {
        if let Some(Group::Edges(edges)) = mesh.groups.get_mut(group) {
            std::mem::swap(&mut edges[self.at], &mut self.other);
        }
    }
}

/// A named set of the mesh.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub enum Group {
    /// Solid elements (a gmsh physical surface), by element number, ascending
    Elements(Vec<usize>),
    /// Boundary edges (a gmsh physical curve)
    Edges(Vec<Edge>),
    /// Single nodes (a gmsh physical point), ascending
    Nodes(Vec<usize>),
    /// Lines that are sides of no element (a gmsh physical curve by itself): the outline of a rigid body
    Lines(Vec<Line>),
}

/// A checked mesh: every node is used, every element is counter-clockwise, has positive area and belongs to one body.
#[derive(Clone, Debug, Default)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Mesh {
    /// X: reference position of each node [L]
    pub nodes: Vec<Vector2<f64>>,
    /// Tag of each node in its mesh file, for messages
    pub node_tags: Vec<u64>,
    /// Solid elements
    pub elements: Vec<Element>,
    /// Tag of each element in the mesh file (inline: its position in its list), for messages
    pub element_tags: Vec<u64>,
    /// Named groups
    pub groups: BTreeMap<String, Group>,
    /// Edges of groups that lie between two bodies, by group
    #[doc(hidden)]
    pub between: BTreeMap<String, Vec<Between>>,
    /// The kind of plane section
    pub section: Section,
    /// Rigid bodies, whose nodes belong to no element
    #[doc(hidden)]
    pub rigid_bodies: Vec<RigidBody>,
    /// Number of nodes of bars that belong to no element: the last ones
    #[doc(hidden)]
    pub bar_nodes: usize,
    /// Number of nodes that stand for a pressure of flowing pore water each, and belong to no element
    #[doc(hidden)]
    pub water_nodes: usize,
}

impl Mesh {
    /// Returns the configuration x = X + u.
    #[doc(hidden)]
    pub fn displaced<'a>(&'a self, displacement: &'a [f64]) -> Configuration<'a> {
        Configuration::new(&self.nodes, displacement).within(self.section)
    }

    /// Returns the reference configuration, without displacements.
    #[doc(hidden)]
    pub fn undeformed(&self) -> Configuration<'_> {
        Configuration::undeformed(&self.nodes).within(self.section)
    }

    /// Reference positions of the nodes of an element [L].
    pub fn places(&self, element: usize) -> Vec<Vector2<f64>> {
        self.elements[element].nodes.iter().map(|&node| self.nodes[node]).collect()
    }

    /// Vectors of the nodes of an element, taken from a nodal array.
    pub fn vectors(&self, element: usize, values: &[f64]) -> Vec<Vector2<f64>> {
        self.elements[element].nodes.iter().map(|&node| vector(values, node)).collect()
    }

    /// Returns the group of this name.
    ///
    /// # Errors
    /// Returns [`UnknownGroup`] with a list of the groups if there is none of this name.
    pub fn group(&self, name: &str) -> Result<&Group, UnknownGroup> {
        self.groups.get(name).ok_or_else(|| UnknownGroup {
            name: name.into(),
            nearest: names::nearest(name, self.groups.keys().map(String::as_str)).map(String::from),
            groups: self.groups.keys().cloned().collect(),
        })
    }

    /// Returns the nodes of a group, ascending, each once; lines that are sides of no element have none.
    pub fn nodes_of(&self, group: &Group) -> Vec<usize> {
        let mut nodes: Vec<usize> = match group {
            Group::Elements(elements) => elements.iter().flat_map(|&e| &self.elements[e].nodes).copied().collect(),
            Group::Edges(edges) => edges.iter().flat_map(|edge| &edge.nodes).copied().collect(),
            Group::Nodes(nodes) => nodes.clone(),
            Group::Lines(_) => Vec::new(),
        };
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Number of nodes excluding those of rigid bodies, of bars and of flowing water, which come last.
    #[doc(hidden)]
    pub fn own_nodes(&self) -> usize {
        let rigid = self.rigid_bodies.iter().map(|body| body.nodes().len()).sum::<usize>();
        self.nodes.len() - self.bar_nodes - self.water_nodes - rigid
    }

    /// Returns the rigid body of this name.
    #[doc(hidden)]
    pub fn rigid_body(&self, name: &str) -> Option<&RigidBody> {
        self.rigid_bodies.iter().find(|body| body.name == name)
    }

    /// Returns the body (the group of elements) of an element.
    pub fn body_of(&self, element: usize) -> Option<&str> {
        let holds = |group: &Group| matches!(group, Group::Elements(list) if list.binary_search(&element).is_ok());
        self.groups.iter().find(|(_, group)| holds(group)).map(|(name, _)| name.as_str())
    }

    /// Sides of some elements that belong to one of them only, the element on their left: (start, end[, middle]).
    #[doc(hidden)]
    pub fn free_sides<'a>(elements: impl IntoIterator<Item = &'a Element>) -> Vec<Vec<usize>> {
        let mut sides: BTreeMap<[usize; 2], Option<Vec<usize>>> = BTreeMap::new();
        for element in elements {
            for side in 0..element.kind.corners() {
                let (corners, middle) = element.kind.edge(side);
                let nodes: Vec<usize> = corners.into_iter().chain(middle).map(|local| element.nodes[local]).collect();
                let ends = [nodes[0].min(nodes[1]), nodes[0].max(nodes[1])];
                sides.entry(ends).and_modify(|known| *known = None).or_insert(Some(nodes));
            }
        }
        sides.into_values().flatten().collect()
    }

    /// Lower left and upper right corner of the bounding box of all nodes [L].
    pub fn bounding_box(&self) -> [Vector2<f64>; 2] {
        let corner = |pick: fn(Vector2<f64>, Vector2<f64>) -> Vector2<f64>| {
            self.nodes.iter().copied().reduce(pick).unwrap_or_default()
        };
        [corner(|a, b| a.inf(&b)), corner(|a, b| a.sup(&b))]
    }

    /// Diagonal of the bounding box of some nodes [L].
    #[doc(hidden)]
    pub fn size_of(&self, nodes: impl IntoIterator<Item = usize>) -> f64 {
        Box2::around(nodes.into_iter().map(|node| self.nodes[node])).map_or(0.0, |around| around.size().norm())
    }
}
