//! Which points of the slave have a traction in mortar, and how far each reaches.
//!
//! The multiplier is λ = Σ φ_j t_j, Σ φ_j = 1, with functions that are linear from node to node of the slave:
//!
//! ```text
//! linear edges:     φ_j = 1 at node j, 0 at the others
//! quadratic edges:  φ_e = 1 on edge e but for the hats of its corners;  φ_c = 1 at corner c, 0 from the middle node on
//! ```
//! A corner of a quadratic edge has a hat of its own at an end of the slave, at an angle of more than 45° and next to a linear edge. Two
//! tractions per edge, at corner and middle node, would be all but undetermined in shear against the three nodes of an edge: each
//! point that closes leaves a mismatch of the meshes, which a stiff penalty turns into a zigzag of tractions. Some surfaces
//! have such hats all the same ([`Hats::AtNodes`]). (The shape functions N_j of the
//! ends are partly negative: the gap weighted by them would not be a mean, and forces would oscillate as nodes slide past.)

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::mortar_segments::between_nodes;
use super::point::{SlavePoint, edge_point};
use super::surface::CORNER;
use crate::mesh::shape;

/// Which nodes of quadratic slave edges have a traction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hats {
    /// The middle node, that of its edge
    OfEdges,
    /// All nodes
    AtNodes,
}

/// φ_j on one of the edges of its point.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The edge
    pub edge: usize,
    /// The node of the edge, by its number there, at which the point is
    pub node: usize,
    /// φ_j at start, end and middle node; linear in between
    pub hat: [f64; 3],
}

/// What each point of slave edges has of them: a node of one edge or, where the surface goes on without a corner, of two.
pub fn parts(edges: &[Vec<usize>], hats: Hats, positions: &[Vector2<f64>]) -> Vec<Vec<Part>> {
    let direction = |e: usize| (positions[edges[e][1]] - positions[edges[e][0]]).normalize();
    let goes_on = |e: usize, other: usize| direction(other).dot(&direction(e)) > CORNER;
    let whole = |e: usize| hats == Hats::OfEdges && edges[e].len() == 3;
    let mut meeting: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (e, edge) in edges.iter().enumerate() {
        edge[..2].iter().for_each(|&end| meeting.entry(end).or_default().push(e));
    }
    let mut points: Vec<Vec<Part>> = Vec::new();
    let mut at: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (e, edge) in edges.iter().enumerate() {
        let has_own = |end: usize| {
            let mut others = meeting[&edge[end]].iter().filter(|&&other| other != e);
            !whole(e) || !others.any(|&other| whole(other) && goes_on(e, other))
        };
        for part in of_edge(e, edge, whole(e), [0, 1].map(has_own)) {
            let at_node = at.entry(edge[part.node]).or_default();
            let joins = |k: &&usize| points[**k].iter().all(|other| goes_on(e, other.edge));
            match at_node.iter().rfind(joins) {
                Some(&k) => points[k].push(part),
                None => {
                    at_node.push(points.len());
                    points.push(vec![part]);
                }
            }
        }
    }
    points
}

/// The points of edge e, which stands for one traction as a `whole` but for its `ends` that have their own.
fn of_edge(e: usize, edge: &[usize], whole: bool, ends: [bool; 2]) -> Vec<Part> {
    let of_node = |node: usize| {
        let mut hat = [0.0; 3];
        hat[node] = 1.0;
        Part { edge: e, node, hat }
    };
    let middle = |_: &usize| match whole {
        true => Part { hat: [f64::from(!ends[0]), f64::from(!ends[1]), 1.0], ..of_node(2) },
        false => of_node(2),
    };
    let [start, end] = [0, 1].map(|node| ends[node].then(|| of_node(node)));
    start.into_iter().chain(edge.get(2).map(middle)).chain(end).collect()
}

/// Place of a point, as weights of nodes: the centre of what it has of its one quadratic edge, or its node.
pub fn centre(parts: &[Part], hats: Hats, edges: &[Vec<usize>]) -> Vec<(usize, f64)> {
    let edge = &edges[parts[0].edge];
    match parts {
        [Part { hat: [start, end, middle], .. }] if hats == Hats::OfEdges && edge.len() == 3 => {
            // ∫ φ ξ dξ/∫ φ dξ
            let xi = 2.0 * (end - start) / (3.0 * (start + end + 2.0 * middle));
            edge.iter().copied().zip(shape::edge_values(3, xi)).collect()
        }
        _ => vec![(edge[parts[0].node], 1.0)],
    }
}

/// Gauss points between the nodes of an edge, whose lengths sum to ∫ φ ds.
pub fn gauss_around(edge: &[usize], hat: &[f64; 3]) -> Vec<SlavePoint> {
    let parts: &[[f64; 2]] = if edge.len() == 2 { &[[-1.0, 1.0]] } else { &[[-1.0, 0.0], [0.0, 1.0]] };
    let points = |&[start, end]: &[f64; 2]| {
        let half = 0.5 * (end - start);
        shape::gauss(2).into_iter().map(move |(at, weight)| (start + half * (1.0 + at), half * weight))
    };
    let all = parts.iter().flat_map(points);
    all.map(|(xi, weight)| (xi, weight * between_nodes(edge.len(), hat, xi).0))
        .filter(|(_, weight)| *weight > 0.0)
        .map(|(xi, weight)| edge_point(edge, xi, weight))
        .collect()
}
