//! A mesh of a few nodes, written in the case file itself.

use std::collections::BTreeMap;

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::check;
use super::raw::{RawCell, RawMesh};
use super::{Mesh, MeshError};

/// A mesh given in the case file. Nodes are numbered from 0 in the order of `nodes`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InlineMesh {
    /// Position [x, y] of each node
    pub nodes: Vec<[f64; 2]>,
    /// Bodies: for each name its elements, an element as the list of its nodes: 3 or 6 for a triangle, 4, 8 or 9 for a
    /// quadrilateral (corners in turn, then mid-side nodes in the same order, then the centre)
    #[serde(default)]
    pub elements: BTreeMap<String, Vec<Vec<usize>>>,
    /// Boundary curves: for each name its edges, an edge as [end, end] or [end, end, middle]
    #[serde(default)]
    pub edges: BTreeMap<String, Vec<Vec<usize>>>,
    /// Sets of single nodes: for each name its nodes
    #[serde(default)]
    pub points: BTreeMap<String, Vec<usize>>,
}

impl InlineMesh {
    /// The mesh, checked like one from a file.
    ///
    /// # Errors
    /// [`MeshError`] when it is not a mesh; tags in the message count from 0.
    pub fn build(&self) -> Result<Mesh, MeshError> {
        check::finish(RawMesh {
            nodes: self.nodes.iter().enumerate().map(|(i, &[x, y])| (i as u64, Vector2::new(x, y))).collect(),
            bodies: named_cells(&self.elements, Clone::clone),
            edges: named_cells(&self.edges, Clone::clone),
            points: named_cells(&self.points, |&node| vec![node]),
        })
    }
}

fn named_cells<T>(
    groups: &BTreeMap<String, Vec<T>>,
    nodes: impl Fn(&T) -> Vec<usize>,
) -> BTreeMap<String, Vec<RawCell>> {
    let cell = |(i, item): (usize, &T)| RawCell {
        tag: i as u64,
        nodes: nodes(item).into_iter().map(|node| node as u64).collect(),
    };
    groups.iter().map(|(name, items)| (name.clone(), items.iter().enumerate().map(cell).collect())).collect()
}
