//! Nodes, solid elements, and the named groups that a case refers to.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use crate::shape::ElementKind;

/// A solid element: its kind and its nodes, counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// kind
    pub kind: ElementKind,
    /// node numbers, in the order of [`crate::shape`]
    pub nodes: Vec<usize>,
}

/// An edge of the boundary of a body, oriented so that the body lies on its left.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// node numbers: start, end, and the middle node of a quadratic edge
    pub nodes: Vec<usize>,
    /// the solid element that it bounds
    pub element: usize,
}

/// A named set of the mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum Group {
    /// Solid elements (a gmsh physical surface), by element number
    Elements(Vec<usize>),
    /// Boundary edges (a gmsh physical curve)
    Edges(Vec<Edge>),
    /// Single nodes (a gmsh physical point)
    Nodes(Vec<usize>),
}

/// A checked mesh: every node is used, every element is counter-clockwise and has positive area.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// X: reference position of each node [L]
    pub nodes: Vec<Vector2<f64>>,
    /// The tag each node has in the mesh file, for messages
    pub node_tags: Vec<u64>,
    /// Solid elements
    pub elements: Vec<Element>,
    /// Named groups
    pub groups: BTreeMap<String, Group>,
}
