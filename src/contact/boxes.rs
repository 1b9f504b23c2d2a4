//! Tree of bounding boxes of the segments of a surface, for the nearest-segment search.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::Vector2;

use super::surface::{Segment, SlavePoint, Surface};
use crate::mesh::configuration::Configuration;

/// A binary tree of bounding boxes of the segments of a surface. Consecutive segments are adjacent, so the tree halves their
/// range.
///
/// Positions are relative to a node of the surface, so that round-off of coordinates far from the origin does not affect the
/// choice of the nearest segment.
///
/// The boxes are extended by a margin. As long as no node has moved by more than the margin relative to the origin, the boxes
/// still contain their segments, and the tree can be reused. The result is bitwise the same, since the final comparison uses
/// the distances of the segments themselves: the nearest segment is the first by (distance, number) for any valid tree, as the
/// margin far exceeds the round-off of a box's distance.
#[derive(Clone, Debug, Default)]
pub struct Boxes {
    segments: usize,
    pub(super) origin: usize,
    /// [L]
    margin: f64,
    /// Nodes of the segments, and their positions when the tree was built
    places: Vec<(usize, Vector2<f64>)>,
    /// Levels from the leaves, one box per segment, to the root; each level has half the boxes of the previous one
    levels: Vec<Vec<Box2>>,
}

/// A bounding box.
#[derive(Clone, Copy, Debug)]
pub struct Box2 {
    pub(super) low: Vector2<f64>,
    pub(super) high: Vector2<f64>,
}

impl Box2 {
    /// Bounding box of a segment's nodes, relative to the node `origin`.
    pub fn of(segment: &Segment, origin: usize, x: &Configuration) -> Self {
        let point = |node: usize| Self { low: x.between(origin, node), high: x.between(origin, node) };
        segment.nodes().fold(point(segment.ends[0]), |sum, node| sum.around(&point(node)))
    }

    /// Middle of the box.
    pub fn centre(&self) -> Vector2<f64> {
        0.5 * (self.low + self.high)
    }

    /// Half the diagonal of the box.
    pub fn radius(&self) -> f64 {
        0.5 * (self.high - self.low).norm()
    }

    /// Bounding box of two boxes.
    pub fn around(&self, other: &Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    /// The box extended by a margin on all sides.
    fn wider(&self, margin: f64) -> Self {
        let margin = Vector2::new(margin, margin);
        Self { low: self.low - margin, high: self.high + margin }
    }

    /// Whether two boxes intersect.
    pub fn meets(&self, other: &Self) -> bool {
        (0..2).all(|i| self.low[i] <= other.high[i] && other.low[i] <= self.high[i])
    }

    /// Squared distance of a point from the box.
    fn distance(&self, point: Vector2<f64>) -> f64 {
        (self.low - point).sup(&(point - self.high)).sup(&Vector2::zeros()).norm_squared()
    }
}

/// Margin of the boxes, as a fraction of the mean length of the segments.
const MARGIN: f64 = 0.05;

/// Fraction of the margin that the motion of nodes may use before the tree is rebuilt; the rest covers round-off.
const USED: f64 = 0.9;

impl Boxes {
    /// Rebuilds the tree unless it is valid for a surface in the configuration `x`.
    pub(super) fn update(&mut self, surface: &Surface, x: &Configuration) {
        if !self.serves(surface, x) {
            self.build(surface, x);
        }
    }

    /// Whether it was built for this surface, in a configuration that is close enough.
    fn serves(&self, surface: &Surface, x: &Configuration) -> bool {
        let most = USED * self.margin;
        let nodes = || surface.segments.iter().flat_map(Segment::nodes);
        let near = |node: usize, place: &Vector2<f64>| (x.between(self.origin, node) - place).amax() <= most;
        (self.segments, self.origin) == (surface.segments.len(), surface.origin())
            && nodes().eq(self.places.iter().map(|(node, _)| *node))
            && self.places.iter().all(|(node, place)| near(*node, place))
    }

    fn build(&mut self, surface: &Surface, x: &Configuration) {
        let Self { segments, origin, margin, places, levels } = self;
        (*segments, *origin) = (surface.segments.len(), surface.origin());
        places.clear();
        let nodes = surface.segments.iter().flat_map(Segment::nodes);
        places.extend(nodes.map(|node| (node, x.between(*origin, node))));
        let lengths = surface.segments.iter().map(|segment| x.between(segment.ends[0], segment.ends[1]).norm());
        *margin = MARGIN * lengths.sum::<f64>() / surface.segments.len() as f64;
        let count = usize::BITS - surface.segments.len().saturating_sub(1).leading_zeros();
        levels.resize_with(1 + count as usize, Vec::new);
        let (leaves, above) = levels.split_at_mut(1);
        leaves[0].clear();
        leaves[0].extend(surface.segments.iter().map(|segment| Box2::of(segment, *origin, x).wider(*margin)));
        let mut below = &leaves[0];
        for level in above {
            let halved = below.chunks(2).map(|pair| pair.iter().skip(1).fold(pair[0], |sum, one| sum.around(one)));
            level.clear();
            level.extend(halved);
            below = level;
        }
    }

    /// Finds the segments whose boxes intersect a box, in order along the surface.
    pub(super) fn meeting(&self, other: &Box2, found: &mut Vec<usize>) {
        if self.segments > 0 {
            self.collect(other, (self.levels.len() - 1, 0), found);
        }
    }

    fn collect(&self, other: &Box2, (level, number): (usize, usize), found: &mut Vec<usize>) {
        if !self.levels[level][number].meets(other) {
            return;
        }
        if level == 0 {
            found.push(number);
            return;
        }
        let below = self.levels[level - 1].len();
        let halves = (2 * number..2 * number + 2).take_while(|&half| half < below);
        halves.for_each(|half| self.collect(other, (level - 1, half), found));
    }

    /// First of the segments by their distance from a point, which most points need, without a heap. Boxes and segments
    /// (level 0) excluded by `counts` are skipped. The search starts from a segment that may be near, upwards in the tree, or else
    /// from the root; the result is the same.
    pub(super) fn nearest_one(
        &self,
        slave: &SlavePoint,
        surface: &Surface,
        x: &Configuration,
        near: Option<usize>,
        counts: impl Fn(usize, usize) -> bool,
    ) -> Option<usize> {
        let exact = |number: usize| distance_from_segment(slave, &surface.segments[number], x);
        let point = slave.offset(self.origin, x);
        let mut nearest = None;
        match near.filter(|&near| near < self.segments) {
            Some(near) => self.climb(point, &exact, &counts, near, &mut nearest),
            None if self.segments > 0 => {
                self.descend(point, &exact, &counts, (self.levels.len() - 1, 0), &mut nearest);
            }
            None => {}
        }
        nearest.map(|(_, number)| number)
    }

    /// Checks a segment, and then the sibling of every box that contains it.
    fn climb(
        &self,
        point: Vector2<f64>,
        exact: &impl Fn(usize) -> f64,
        counts: &impl Fn(usize, usize) -> bool,
        near: usize,
        nearest: &mut Option<(f64, usize)>,
    ) {
        self.descend(point, exact, counts, (0, near), nearest);
        for (level, boxes) in self.levels.iter().enumerate() {
            let other = (near >> level) ^ 1;
            let Some(half) = boxes.get(other) else { continue };
            if nearest.is_none_or(|(best, _)| half.distance(point) <= best) {
                self.descend(point, exact, counts, (level, other), nearest);
            }
        }
    }

    /// Searches for a nearer segment in a box, the nearer half first; `nearest` is the best so far and its distance.
    fn descend(
        &self,
        point: Vector2<f64>,
        exact: &impl Fn(usize) -> f64,
        counts: &impl Fn(usize, usize) -> bool,
        (level, number): (usize, usize),
        nearest: &mut Option<(f64, usize)>,
    ) {
        if !counts(level, number) {
            return;
        }
        if level == 0 {
            let found = (exact(number), number);
            if nearest.is_none_or(|nearest| found < nearest) {
                *nearest = Some(found);
            }
            return;
        }
        let below = &self.levels[level - 1];
        let first = (below[2 * number].distance(point), 2 * number);
        let second = below.get(2 * number + 1).map_or(f64::INFINITY, |half| half.distance(point));
        let second = (second, 2 * number + 1);
        let halves = if second < first { [second, first] } else { [first, second] };
        for (distance, half) in halves {
            if half < below.len() && nearest.is_none_or(|(best, _)| distance <= best) {
                self.descend(point, exact, counts, (level - 1, half), nearest);
            }
        }
    }

    /// Segments by their distance from a point, nearest first; equally near ones in order along the surface.
    pub(super) fn nearest(
        &self,
        slave: &SlavePoint,
        surface: &Surface,
        x: &Configuration,
    ) -> impl Iterator<Item = usize> {
        let point = slave.offset(self.origin, x);
        let mut open = BinaryHeap::new();
        if self.segments > 0 {
            open.push(Candidate { distance: 0.0, level: self.levels.len() - 1, number: 0, exact: false });
        }
        std::iter::from_fn(move || {
            while let Some(Candidate { level, number, exact, .. }) = open.pop() {
                if exact {
                    return Some(number);
                }
                if level == 0 {
                    let distance = distance_from_segment(slave, &surface.segments[number], x);
                    open.push(Candidate { distance, level, number, exact: true });
                    continue;
                }
                let below = &self.levels[level - 1];
                for number in (2 * number..2 * number + 2).take_while(|&number| number < below.len()) {
                    let distance = below[number].distance(point);
                    open.push(Candidate { distance, level: level - 1, number, exact: false });
                }
            }
            None
        })
    }
}

/// Squared distance of a point from a segment; for a parabola, from the two chords on either side of its middle node.
fn distance_from_segment(slave: &SlavePoint, segment: &Segment, x: &Configuration) -> f64 {
    let from_chord = |[a, b]: [usize; 2]| {
        let (along, offset) = (x.between(a, b), slave.offset(a, x));
        let xi = (offset.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (offset - along * xi).norm_squared()
    };
    let [a, b] = segment.ends;
    segment.middle.map_or_else(|| from_chord([a, b]), |m| from_chord([a, m]).min(from_chord([m, b])))
}

/// A box or segment that may be the nearest; the nearest is at the top of the heap.
struct Candidate {
    /// Squared distance of the box, or, if `exact`, of the segment itself
    distance: f64,
    level: usize,
    number: usize,
    exact: bool,
}

impl Ord for Candidate {
    /// Boxes precede segments at the same distance: they may contain one that is earlier along the surface.
    fn cmp(&self, other: &Self) -> Ordering {
        let by_distance = other.distance.total_cmp(&self.distance);
        by_distance.then_with(|| other.exact.cmp(&self.exact)).then_with(|| other.number.cmp(&self.number))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}
