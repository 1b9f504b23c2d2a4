//! Selection of the node nearest to a point.

use nalgebra::Vector2;

/// Difference of distances, as a fraction of the size of the elements adjacent to the nearest node, below which two nodes are equally
/// near.
const EQUALLY_NEAR: f64 = 1e-9;

/// Round-off of a position, relative to its distance from the origin.
const OF_POSITION: f64 = 8.0 * f64::EPSILON;

/// Reason why a point does not identify one node; nodes by number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotOne {
    /// A coordinate is not finite
    NoPlace,
    /// There are no nodes
    NoNodes,
    /// Two nodes are equally near
    Several([usize; 2]),
    /// The nearest node is farther away than the adjacent elements are long
    Far {
        /// nearest node
        node: usize,
        /// its distance [L]
        distance: f64,
    },
}

/// Returns the node nearest to a point; adjacent elements must reach the point.
///
/// # Errors
/// Returns [`NotOne`] if no single node is nearest, or it is too far away.
pub fn nearest<'e>(
    nodes: &[Vector2<f64>],
    elements: impl Iterator<Item = &'e [usize]>,
    point: [f64; 2],
) -> Result<usize, NotOne> {
    if !point.iter().all(|coordinate| coordinate.is_finite()) {
        return Err(NotOne::NoPlace);
    }
    let distance = |node: usize| (nodes[node] - Vector2::from(point)).norm();
    let node = (0..nodes.len()).min_by(|a, b| distance(*a).total_cmp(&distance(*b))).ok_or(NotOne::NoNodes)?;
    let adjacent = elements.filter(|element| element.contains(&node));
    let sides = adjacent.flat_map(|element| element.iter().map(|other| (nodes[*other] - nodes[node]).norm()));
    let (near, size) = (distance(node), sides.fold(0.0, f64::max));
    // A node next to no element is found where it is, to the round-off of its position.
    let round_off = (EQUALLY_NEAR * size).max(OF_POSITION * nodes[node].amax());
    if let Some(other) = (0..nodes.len()).find(|other| *other != node && distance(*other) <= near + round_off) {
        return Err(NotOne::Several([node, other]));
    }
    match near <= size.max(round_off) {
        true => Ok(node),
        false => Err(NotOne::Far { node, distance: near }),
    }
}
