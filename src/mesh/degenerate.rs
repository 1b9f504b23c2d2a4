//! Elements that have an area and still cannot be computed with: sides of no length, and nodes nearer to each other than their
//! positions are known.

use nalgebra::Vector2;

use super::{Element, MeshError};

/// A side that is shorter than this share of its element is none: a strain over it would be the round-off of others.
const SHORT: f64 = 1e-8;

/// Round-off of the positions as a share of a side beyond which the shape of the element is not known.
const VAGUE: f64 = 1e-3;

/// Refuse an element of a group, and tell by which nodes.
pub(super) fn refuse(
    element: &Element,
    (tag, group): (u64, &str),
    positions: &[Vector2<f64>],
    node_tags: &[u64],
) -> Result<(), MeshError> {
    let corners = &element.nodes[..element.kind.corners()];
    let ends = || corners.iter().zip(corners.iter().cycle().skip(1));
    let length = |(a, b): &(&usize, &usize)| (positions[**b] - positions[**a]).norm();
    let size = ends().map(|side| length(&side)).fold(0.0, f64::max);
    let Some((a, b)) = ends().min_by(|one, other| length(one).total_cmp(&length(other))) else { return Ok(()) };
    let (shortest, group, ends) = (length(&(a, b)), group.to_string(), [*a, *b].map(|node| node_tags[node]));
    if shortest <= SHORT * size {
        return Err(MeshError::ShortSide { element: tag, group, ends, length: shortest, size });
    }
    let known = f64::EPSILON * corners.iter().fold(0.0, |most: f64, &node| most.max(positions[node].amax()));
    match known <= VAGUE * shortest {
        true => Ok(()),
        false => Err(MeshError::Vague { element: tag, group, known, side: shortest }),
    }
}
