//! Search of segments in a tree of their bounding boxes, the one that contact uses.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::Vector2;

use super::segment_search::{Branch, SegmentSearch, bounding_box, squared_distance};
use super::surface::{Segment, SlavePoint, Surface};
use crate::mesh::boxes::Box2;
use crate::mesh::configuration::Configuration;

/// A binary tree of bounding boxes of the segments of a surface. Consecutive segments are adjacent, so the tree halves their
/// range.
///
/// The boxes are extended by a margin. As long as no node has moved by more than the margin relative to the origin, the boxes
/// still contain their segments, and the tree can be reused. The result is bitwise the same, since the final comparison uses
/// the distances of the segments themselves: the nearest segment is the first by (distance, number) for any valid tree, as the
/// margin far exceeds the round-off of a box's distance.
#[derive(Clone, Debug, Default)]
pub struct SegmentTree {
    segments: usize,
    origin: usize,
    /// [L]
    margin: f64,
    /// Nodes of the segments, and their positions when the tree was built
    places: Vec<(usize, Vector2<f64>)>,
    /// Levels from the leaves, one box per segment, to the root; each level has half the boxes of the previous one
    levels: Vec<Vec<Box2>>,
}

/// Margin of the boxes, as a fraction of the mean length of the segments.
const MARGIN: f64 = 0.05;

/// Fraction of the margin that the motion of nodes may use before the tree is rebuilt; the rest covers round-off.
const USED: f64 = 0.9;

impl SegmentSearch for SegmentTree {
    /// Rebuilds the tree unless it is valid for a surface in the configuration `x`.
    fn update(&mut self, surface: &Surface, x: &Configuration) {
        if !self.serves(surface, x) {
            self.build(surface, x);
        }
    }

    fn meeting(&self, _: &Surface, _: &Configuration, other: &Box2, found: &mut Vec<usize>) {
        if let Some(root) = self.root() {
            self.collect(other, root, found);
        }
    }

    /// The search starts from the segment `near`, upwards in the tree, or else from the root, without a heap.
    fn nearest(
        &self,
        slave: &SlavePoint,
        surface: &Surface,
        x: &Configuration,
        near: Option<usize>,
        counts: impl Fn(Branch) -> bool,
    ) -> Option<usize> {
        let exact = |number: usize| squared_distance(slave, &surface.segments[number], x);
        let point = slave.offset(self.origin, x);
        let mut nearest = None;
        match near.filter(|&near| near < self.segments) {
            Some(near) => self.climb(point, &exact, &counts, near, &mut nearest),
            None => self.descend(point, &exact, &counts, self.root()?, &mut nearest),
        }
        nearest.map(|nearest| nearest.segment)
    }

    fn by_distance(&self, slave: &SlavePoint, surface: &Surface, x: &Configuration) -> impl Iterator<Item = usize> {
        let point = slave.offset(self.origin, x);
        let root = self.root().map(|branch| Candidate { distance: 0.0, branch, exact: false });
        let mut open: BinaryHeap<Candidate> = root.into_iter().collect();
        std::iter::from_fn(move || {
            while let Some(Candidate { branch, exact, .. }) = open.pop() {
                if exact {
                    return Some(branch.number);
                }
                if branch.level == 0 {
                    let distance = squared_distance(slave, &surface.segments[branch.number], x);
                    open.push(Candidate { distance, branch, exact: true });
                    continue;
                }
                let below = &self.levels[branch.level - 1];
                open.extend(branch.halves().into_iter().filter_map(|half| {
                    let distance = below.get(half.number)?.squared_distance(point);
                    Some(Candidate { distance, branch: half, exact: false })
                }));
            }
            None
        })
    }
}

impl SegmentTree {
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
        leaves[0].extend(surface.segments.iter().map(|segment| bounding_box(segment, *origin, x).wider(*margin)));
        let mut below = &leaves[0];
        for level in above {
            let halved = below.chunks(2).map(|pair| pair.iter().skip(1).fold(pair[0], |sum, one| sum.with(*one)));
            level.clear();
            level.extend(halved);
            below = level;
        }
    }

    /// The whole tree as a branch, if there are segments.
    fn root(&self) -> Option<Branch> {
        (self.segments > 0).then(|| Branch { level: self.levels.len() - 1, number: 0 })
    }

    fn collect(&self, other: &Box2, branch: Branch, found: &mut Vec<usize>) {
        if !self.levels[branch.level][branch.number].meets(other) {
            return;
        }
        if branch.level == 0 {
            found.push(branch.number);
            return;
        }
        let below = self.levels[branch.level - 1].len();
        let halves = branch.halves().into_iter().take_while(|half| half.number < below);
        halves.for_each(|half| self.collect(other, half, found));
    }

    /// Checks a segment, and then the sibling of every box that contains it.
    fn climb(
        &self,
        point: Vector2<f64>,
        exact: &impl Fn(usize) -> f64,
        counts: &impl Fn(Branch) -> bool,
        near: usize,
        nearest: &mut Option<Nearest>,
    ) {
        self.descend(point, exact, counts, Branch::of(near), nearest);
        for (level, boxes) in self.levels.iter().enumerate() {
            let other = Branch { level, number: (near >> level) ^ 1 };
            let Some(half) = boxes.get(other.number) else { continue };
            if nearest.is_none_or(|best| half.squared_distance(point) <= best.distance) {
                self.descend(point, exact, counts, other, nearest);
            }
        }
    }

    /// Searches for a nearer segment in a branch, the nearer half first; `nearest` is the best so far.
    fn descend(
        &self,
        point: Vector2<f64>,
        exact: &impl Fn(usize) -> f64,
        counts: &impl Fn(Branch) -> bool,
        branch: Branch,
        nearest: &mut Option<Nearest>,
    ) {
        if !counts(branch) {
            return;
        }
        if branch.level == 0 {
            let found = Nearest { distance: exact(branch.number), segment: branch.number };
            if nearest.is_none_or(|nearest| found < nearest) {
                *nearest = Some(found);
            }
            return;
        }
        let below = &self.levels[branch.level - 1];
        let distance = |half: Branch| below.get(half.number).map(|bounds| (bounds.squared_distance(point), half));
        let mut halves = branch.halves().map(distance);
        if let [Some((first, _)), Some((second, _))] = halves
            && second < first
        {
            halves.swap(0, 1);
        }
        for (distance, half) in halves.into_iter().flatten() {
            if nearest.is_none_or(|best| distance <= best.distance) {
                self.descend(point, exact, counts, half, nearest);
            }
        }
    }
}

/// The nearest segment so far, by its squared distance, then its number.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
struct Nearest {
    distance: f64,
    segment: usize,
}

/// A branch or segment that may be the nearest; the nearest is at the top of the heap.
struct Candidate {
    /// Squared distance of the box, or, if `exact`, of the segment itself
    distance: f64,
    branch: Branch,
    exact: bool,
}

impl Ord for Candidate {
    /// Boxes precede segments at the same distance: they may contain one that is earlier along the surface.
    fn cmp(&self, other: &Self) -> Ordering {
        let by_distance = other.distance.total_cmp(&self.distance);
        by_distance
            .then_with(|| other.exact.cmp(&self.exact))
            .then_with(|| other.branch.number.cmp(&self.branch.number))
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
