//! Which node is meant by a point near it.

use nalgebra::Vector2;

/// Two nodes whose distances differ by less than this share of the model's size are equally near.
const EQUALLY_NEAR: f64 = 1e-9;

/// Why a point does not mean one node; nodes by their numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotOne {
    /// A coordinate is not finite
    NoPlace,
    /// There are no nodes
    NoNodes,
    /// Two are equally near
    Several([usize; 2]),
    /// The nearest is farther away than the elements there are long
    Far {
        /// the nearest
        node: usize,
        /// how far away it is [L]
        distance: f64,
    },
}

/// The one node nearest to a point, which the elements there must reach.
///
/// # Errors
/// [`NotOne`], where it is not one node, or far away.
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
    let corner = |pick: fn(Vector2<f64>, Vector2<f64>) -> Vector2<f64>| nodes.iter().copied().reduce(pick);
    let diagonal =
        corner(|a, b| a.sup(&b)).zip(corner(|a, b| a.inf(&b))).map_or(0.0, |(high, low)| (high - low).norm());
    let (near, round_off) = (distance(node), EQUALLY_NEAR * diagonal);
    if let Some(other) = (0..nodes.len()).find(|other| *other != node && distance(*other) <= near + round_off) {
        return Err(NotOne::Several([node, other]));
    }
    let beside = elements.filter(|element| element.contains(&node));
    let sides = beside.flat_map(|element| element.iter().map(|other| (nodes[*other] - nodes[node]).norm()));
    match near <= sides.fold(round_off, f64::max) {
        true => Ok(node),
        false => Err(NotOne::Far { node, distance: near }),
    }
}
