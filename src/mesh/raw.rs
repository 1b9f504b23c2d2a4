//! A mesh as readers find it, before it is checked.

use std::collections::{BTreeMap, HashMap};

use nalgebra::Vector2;

use super::MeshError;

/// A mesh as it was read. Cells name their nodes by tag; nothing is checked.
#[derive(Debug, Default)]
pub(super) struct RawMesh {
    /// tag and position of each node
    pub nodes: Vec<(u64, Vector2<f64>)>,
    /// elements by body
    pub bodies: BTreeMap<String, Vec<RawCell>>,
    /// lines by name of the curve
    pub edges: BTreeMap<String, Vec<RawCell>>,
    /// points, cells of one node, by name of the set
    pub points: BTreeMap<String, Vec<RawCell>>,
}

/// A solid element, a line or a point: its own tag and those of its nodes.
#[derive(Clone, Debug)]
pub(super) struct RawCell {
    pub tag: u64,
    pub nodes: Vec<u64>,
}

/// From the tag of a node to its number.
pub(super) struct NodeNumbers(HashMap<u64, usize>);

impl NodeNumbers {
    /// Numbers by tag, in the order given.
    pub(super) fn new(nodes: &[(u64, Vector2<f64>)]) -> Result<Self, MeshError> {
        let mut numbers = HashMap::with_capacity(nodes.len());
        for (number, (tag, at)) in nodes.iter().enumerate() {
            if !at.iter().all(|x| x.is_finite()) {
                return Err(MeshError::NotFinite(*tag));
            }
            if numbers.insert(*tag, number).is_some() {
                return Err(MeshError::SameNodeTag(*tag));
            }
        }
        Ok(Self(numbers))
    }

    /// Numbers of the nodes of a cell; `what` ("element", "line", "point") and `group` are for the message.
    pub(super) fn of(&self, what: &str, group: &str, cell: &RawCell) -> Result<Vec<usize>, MeshError> {
        let number = |&node: &u64| {
            self.0.get(&node).copied().ok_or_else(|| MeshError::UnknownNode {
                cell: format!("{what} {}", cell.tag),
                group: group.into(),
                node,
            })
        };
        cell.nodes.iter().map(number).collect()
    }
}
