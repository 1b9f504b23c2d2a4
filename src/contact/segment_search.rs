//! How segments of a surface are found by their place: what a search answers.

use super::surface::{Segment, SlavePoint, Surface};
use crate::mesh::boxes::Box2;
use crate::mesh::configuration::Configuration;

/// A search of segments by their place. Every one gives the same answers for finite positions, to the bit: the distances compared are those of the
/// segments themselves, and of two equally near segments the one of lower number comes first.
///
/// Positions are relative to the surface's origin, so that round-off of coordinates far from (0, 0) does not affect the choice.
pub trait SegmentSearch: Clone + Default {
    /// Prepares the search on a surface in the configuration `x`; what still serves from before is kept.
    fn update(&mut self, surface: &Surface, x: &Configuration);

    /// Adds the segments that may intersect a box to an empty list, ascending: every one whose bounding box does, and perhaps
    /// others.
    fn meeting(&self, surface: &Surface, x: &Configuration, other: &Box2, found: &mut Vec<usize>);

    /// Segments by their distance from a point, nearest first.
    fn by_distance(&self, slave: &SlavePoint, surface: &Surface, x: &Configuration) -> impl Iterator<Item = usize>;

    /// The nearest of the segments that count. A branch that does not count has no segment that does; `near` is a segment
    /// that may be near.
    fn nearest(
        &self,
        slave: &SlavePoint,
        surface: &Surface,
        x: &Configuration,
        _near: Option<usize>,
        counts: impl Fn(Branch) -> bool,
    ) -> Option<usize> {
        self.by_distance(slave, surface, x).find(|&segment| counts(Branch::of(segment)))
    }
}

/// Consecutive segments, number · 2^level and the 2^level − 1 after it: a branch of a binary tree. Consecutive segments are
/// adjacent, so that those of a branch lie together.
#[derive(Clone, Copy, Debug)]
pub struct Branch {
    /// Number of times that it can be halved
    pub level: usize,
    /// Its number among those of its level
    pub number: usize,
}

impl Branch {
    /// A single segment.
    pub fn of(segment: usize) -> Self {
        Self { level: 0, number: segment }
    }

    /// The two halves of a branch of more than one segment.
    pub fn halves(self) -> [Self; 2] {
        [0, 1].map(|half| Self { level: self.level - 1, number: 2 * self.number + half })
    }
}

/// Bounding box of the nodes of a segment, relative to the node `origin`.
pub fn bounding_box(segment: &Segment, origin: usize, x: &Configuration) -> Box2 {
    let point = |node: usize| Box2 { low: x.between(origin, node), high: x.between(origin, node) };
    segment.nodes().fold(point(segment.ends[0]), |sum, node| sum.with(point(node)))
}

/// Squared distance of a point from a segment; for a parabola, from the two chords on either side of its middle node.
pub fn squared_distance(slave: &SlavePoint, segment: &Segment, x: &Configuration) -> f64 {
    let from_chord = |[a, b]: [usize; 2]| {
        let (along, offset) = (x.between(a, b), slave.offset(a, x));
        let xi = (offset.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (offset - along * xi).norm_squared()
    };
    let [a, b] = segment.ends;
    segment.middle.map_or_else(|| from_chord([a, b]), |m| from_chord([a, m]).min(from_chord([m, b])))
}
