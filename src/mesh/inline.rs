//! Small meshes from code (blocks of Q4 elements) and meshes of a few nodes written in the case file.

use std::collections::BTreeMap;

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::check::{RawCell, RawMesh};
use super::{Mesh, MeshError, check};

/// A mesh given in the case file. Nodes are numbered from 0 in the order of `nodes`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct InlineMesh {
    /// Position [x, y] of each node
    pub nodes: Vec<[f64; 2]>,
    /// Bodies: list of elements by name, each element being a list of nodes: 3 or 6 for a triangle, 4, 8 or 9 for a
    /// quadrilateral (corners in order, then mid-side nodes in the same order, then the centre)
    #[serde(default)]
    pub elements: BTreeMap<String, Vec<Vec<usize>>>,
    /// Boundary curves, and outlines of rigid masters, which are sides of no element: list of edges by name, each edge given as
    /// [end, end] or [end, end, middle]
    #[serde(default)]
    pub edges: BTreeMap<String, Vec<Vec<usize>>>,
    /// Node sets: list of nodes by name
    #[serde(default)]
    pub points: BTreeMap<String, Vec<usize>>,
}

impl InlineMesh {
    /// Returns the mesh, checked like one from a file.
    ///
    /// # Errors
    /// Returns [`MeshError`] if the mesh is invalid; tags in the message count from 0.
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

impl InlineMesh {
    /// Adds a rectangle of n × m elements, given by its lower left and upper right corner [L]. A rectangle named `b` adds the
    /// group `b` of its elements and the groups `b_bottom`, `b_right`, `b_top` and `b_left` of its edges. It shares no nodes
    /// with other rectangles; if its name exists already, it extends those groups.
    ///
    /// ```
    /// use fecontact::mesh::InlineMesh;
    ///
    /// let mesh = InlineMesh::default().rectangle("block", [4, 2], [0.0, 0.0], [2.0, 1.0]).build()?;
    /// assert_eq!((mesh.nodes.len(), mesh.elements.len()), (15, 8));
    /// # Ok::<(), fecontact::mesh::MeshError>(())
    /// ```
    pub fn rectangle(self, name: &str, divisions: [usize; 2], low: [f64; 2], high: [f64; 2]) -> Self {
        self.block(name, divisions, |s, t| [low[0] + s * (high[0] - low[0]), low[1] + t * (high[1] - low[1])])
    }

    /// Adds a block like [`InlineMesh::rectangle`], placed by a map from the unit square to the plane, which must preserve
    /// orientation.
    pub fn block(mut self, name: &str, [n, m]: [usize; 2], map: impl Fn(f64, f64) -> [f64; 2]) -> Self {
        let first = self.nodes.len();
        let node = |i: usize, j: usize| first + j * (n + 1) + i;
        for j in 0..=m {
            self.nodes.extend((0..=n).map(|i| map(i as f64 / n as f64, j as f64 / m as f64)));
        }
        let element = |e: usize| {
            let (i, j) = (e % n, e / n);
            vec![node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]
        };
        let row = |j: usize| (0..n).map(|i| vec![node(i, j), node(i + 1, j)]).collect::<Vec<_>>();
        let column = |i: usize| (0..m).map(|j| vec![node(i, j), node(i, j + 1)]).collect::<Vec<_>>();
        self.elements.entry(name.into()).or_default().extend((0..n * m).map(element));
        for (side, edges) in [("bottom", row(0)), ("right", column(n)), ("top", row(m)), ("left", column(0))] {
            self.edges.entry(format!("{name}_{side}")).or_default().extend(edges);
        }
        self
    }
}
