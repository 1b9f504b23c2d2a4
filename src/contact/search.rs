//! Which part of the master a slave point meets: the nearest segment that faces it.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::Vector2;

use super::projection::{Bound, Projection, at_node, normal_of, on_curve, on_segment};
use super::rigid::Rigid;
use super::sight::Sight;
use super::surface::{Master, MasterPoint, Segment, SlavePoint, Surface};
use crate::mesh::configuration::Configuration;

/// A slave and a segment face each other when the cosine between their outward normals is below this: the sides of a
/// body do not touch what its bottom rests on. A slave point of no edge faces every segment.
pub const FACING: f64 = -0.1;

/// Segments looked at before a point is called free. Nearest come first, so more than a few mean that nothing faces it.
const CANDIDATES: usize = 8;

/// The master in a spatial index at the current positions.
pub enum Index<'a> {
    /// Segments of a mesh surface in a tree of boxes, and what points of a surface that touches itself may meet
    Mesh(&'a Surface, Boxes, Option<Sight<'a>>),
    /// A rigid body needs none
    Rigid(&'a Rigid),
}

impl<'a> Index<'a> {
    /// Index the master in the configuration `x`, O(N).
    pub fn new(master: &'a Master, x: &'a Configuration) -> Self {
        Self::within(master, x, x)
    }

    /// Index the master in the configuration `x` of an increment that began in another, O(N).
    pub fn within(master: &'a Master, before: &'a Configuration, x: &Configuration) -> Self {
        match master {
            Master::Rigid(body) => Self::Rigid(body),
            Master::Mesh(surface) => {
                let sight = surface.own_depth.map(|depth| Sight::new(surface, depth, before));
                Self::Mesh(surface, Boxes::new(surface, x), sight)
            }
        }
    }

    /// The foot of a slave point that had another at the start of the increment, if it had one, and if a part of the master
    /// faces it.
    pub fn project(&self, slave: &SlavePoint, from: Option<MasterPoint>, x: &Configuration) -> Option<Projection> {
        let nearest = self.nearest(slave, x)?;
        match (self, from) {
            (Self::Mesh(surface, _, sight), Some(from))
                if nearest.bound == Bound::Segment && nearest.gap < 0.0 && nearest.foot.segment != from.segment =>
            {
                let outward = slave.outward(x);
                let viewer = sight.as_ref().and_then(|sight| sight.point(slave));
                let meets = |segment: usize| match (sight, &viewer) {
                    (Some(sight), Some(viewer)) => sight.may_meet(viewer, 0, segment),
                    _ => faces(surface, segment, outward, x),
                };
                Some(behind_ridge(slave, surface, nearest, from, meets, x))
            }
            _ => Some(nearest),
        }
    }

    /// The foot presumed for a point that goes to and fro between two segments: their node, if they meet in a valley. The
    /// closest point is the node only in a strip as narrow as the penetration times the turn of the normal, and Newton's
    /// method steps over it from either side for ever.
    pub fn in_valley(&self, slave: &SlavePoint, [a, b]: [usize; 2], x: &Configuration) -> Option<Projection> {
        let Self::Mesh(surface, ..) = self else { return None };
        let [first, second] = if surface.next(a) == Some(b) { [a, b] } else { [b, a] };
        let direction = |segment: usize, xi: f64| x.combine(&surface.segments[segment].slope(xi));
        let is_valley =
            surface.next(first) == Some(second) && direction(first, 1.0).perp(&direction(second, 0.0)) > 0.0;
        is_valley.then(|| at_node(slave, surface, first, second, 1.0, x)).filter(|at| at.gap < 0.0)
    }

    /// The foot on what is nearest; by the tree, not by going through all.
    fn nearest(&self, slave: &SlavePoint, x: &Configuration) -> Option<Projection> {
        match self {
            Self::Rigid(body) => body.project(slave, x),
            Self::Mesh(surface, boxes, sight) => {
                if let Some(sight) = sight {
                    let viewer = sight.point(slave)?;
                    let may_meet = |level, number| sight.may_meet(&viewer, level, number);
                    let nearest = boxes.nearest_one(slave, surface, x, may_meet)?;
                    // Only between two segments that it may meet can a point lie behind their node: a segment of the far
                    // side of a hole is seen past its end, through the body, by points on the other side of the wall.
                    let beside = |at: &Projection| {
                        if at.foot.xi > 0.0 { surface.next(at.foot.segment) } else { surface.previous(at.foot.segment) }
                    };
                    return on_segment(slave, surface, nearest, x).filter(|at| {
                        at.gap >= 0.0 || at.bound == Bound::Segment || beside(at).is_some_and(|k| may_meet(0, k))
                    });
                }
                let outward = slave.outward(x);
                let facing = |segment: usize| faces(surface, segment, outward, x);
                let first = boxes.nearest_one(slave, surface, x, |_, _| true).filter(|&segment| facing(segment));
                if let Some(found) = first.and_then(|segment| on_segment(slave, surface, segment, x)) {
                    return Some(found);
                }
                let nearest = boxes.nearest(slave, surface, x).take(CANDIDATES);
                let mut facing = nearest.filter(|&segment| facing(segment)).enumerate();
                // A node is the foot only of a point that nothing nearer faces: past the end of a surface, where the
                // last segment has no foot, each inner node would be one, far away and deep.
                facing.find_map(|(rank, segment)| {
                    let found = on_segment(slave, surface, segment, x)?;
                    (rank == 0 || found.bound == Bound::Segment).then_some(found)
                })
            }
        }
    }

    /// Segments of a mesh surface within a distance of a slave edge's bounding box, in order along it.
    pub fn around(&self, edge: &[usize], reach: f64, x: &Configuration) -> Vec<usize> {
        let Self::Mesh(_, boxes, sight) = self else { return Vec::new() };
        let reach = Vector2::new(reach, reach);
        let at = |node: usize| x.between(boxes.origin, node);
        let each = edge.iter().map(|&node| Box2 { low: at(node) - reach, high: at(node) + reach });
        let mut found = each.reduce(|sum, one| sum.around(&one)).map_or_else(Vec::new, |all| boxes.meeting(&all));
        if let Some(sight) = sight {
            let viewer = sight.edge(edge);
            found.retain(|&segment| sight.may_meet(&viewer, 0, segment));
        }
        found
    }
}

/// Whether a segment faces a point whose surface looks `outward`, if it has a surface.
fn faces(surface: &Surface, segment: usize, outward: Option<Vector2<f64>>, x: &Configuration) -> bool {
    let [a, b] = surface.segments[segment].ends;
    outward.is_none_or(|outward| normal_of(x.between(a, b).normalize()).dot(&outward) < FACING)
}

/// Behind a ridge, where a point lies behind several segments, it belongs to the one on the side of its old foot. The
/// nearest one changes at the bisector, and the normal with it, forwards and back as Newton's method goes; its old foot does
/// not change within an increment.
fn behind_ridge(
    slave: &SlavePoint,
    surface: &Surface,
    nearest: Projection,
    from: MasterPoint,
    meets: impl Fn(usize) -> bool,
    x: &Configuration,
) -> Projection {
    let way = surface.path(nearest.foot, from).unwrap_or_default();
    let earlier = way.iter().skip(1).map(|&(segment, ..)| segment).take_while(|&segment| meets(segment));
    let behind = earlier.map(|segment| on_curve(slave, surface, segment, x));
    behind.take_while(|at| at.gap < 0.0 && (0.0..=1.0).contains(&at.foot.xi)).last().unwrap_or(nearest)
}

/// A binary tree of boxes around the segments of a surface. Segments that follow each other are near each other, so the
/// tree simply halves their range: it is built without sorting.
///
/// All places are relative to a node of the surface: which segment is the nearest must not be decided by the round-off of
/// coordinates far from the origin.
pub struct Boxes {
    segments: usize,
    origin: usize,
    /// Level by level from the leaves, one box a segment, to the root; each level has half the boxes of the one before
    levels: Vec<Vec<Box2>>,
}

/// The smallest box that holds something.
#[derive(Clone, Copy, Debug)]
pub struct Box2 {
    low: Vector2<f64>,
    high: Vector2<f64>,
}

impl Box2 {
    /// The box of a segment's nodes, their places relative to a node `origin`.
    pub fn of(segment: &Segment, origin: usize, x: &Configuration) -> Self {
        let point = |node: usize| Self { low: x.between(origin, node), high: x.between(origin, node) };
        segment.nodes().fold(point(segment.ends[0]), |sum, node| sum.around(&point(node)))
    }

    /// Middle of the box.
    pub fn centre(&self) -> Vector2<f64> {
        0.5 * (self.low + self.high)
    }

    /// Half its diagonal.
    pub fn radius(&self) -> f64 {
        0.5 * (self.high - self.low).norm()
    }

    /// The smallest box that holds another as well.
    pub fn around(&self, other: &Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    fn meets(&self, other: &Self) -> bool {
        (0..2).all(|i| self.low[i] <= other.high[i] && other.low[i] <= self.high[i])
    }

    /// Squared distance of a point from the box.
    fn distance(&self, point: Vector2<f64>) -> f64 {
        (self.low - point).sup(&(point - self.high)).sup(&Vector2::zeros()).norm_squared()
    }
}

impl Boxes {
    fn new(surface: &Surface, x: &Configuration) -> Self {
        let origin = surface.origin();
        let mut levels: Vec<Vec<Box2>> =
            vec![surface.segments.iter().map(|segment| Box2::of(segment, origin, x)).collect()];
        while let Some(last) = levels.last().filter(|last| last.len() > 1) {
            let halved = last.chunks(2).map(|pair| pair.iter().skip(1).fold(pair[0], |sum, one| sum.around(one)));
            let halved = halved.collect();
            levels.push(halved);
        }
        Self { segments: surface.segments.len(), origin, levels }
    }

    /// The segments whose boxes meet another, in order along the surface.
    fn meeting(&self, other: &Box2) -> Vec<usize> {
        let mut found = Vec::new();
        let mut open = Vec::from_iter((self.segments > 0).then(|| (self.levels.len() - 1, 0)));
        while let Some((level, number)) = open.pop() {
            match self.levels[level][number].meets(other) {
                true if level == 0 => found.push(number),
                true => {
                    let below = self.levels[level - 1].len();
                    let halves = [2 * number + 1, 2 * number].into_iter().filter(|&number| number < below);
                    open.extend(halves.map(|number| (level - 1, number)));
                }
                false => {}
            }
        }
        found
    }

    /// The first of the segments by their distance from a point: what most points need, and found without a heap. Boxes
    /// and segments (level 0) that do not count are passed over.
    fn nearest_one(
        &self,
        slave: &SlavePoint,
        surface: &Surface,
        x: &Configuration,
        counts: impl Fn(usize, usize) -> bool,
    ) -> Option<usize> {
        let exact = |number: usize| distance_from_segment(slave, &surface.segments[number], x);
        let point = slave.offset(self.origin, x);
        let mut nearest = None;
        if self.segments > 0 {
            self.descend(point, &exact, &counts, (self.levels.len() - 1, 0), &mut nearest);
        }
        nearest.map(|(_, number)| number)
    }

    /// Look for a nearer segment in a box, in the nearer half first; `nearest` is the best so far and its distance.
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

    /// The segments by their distance from a point, the nearest first; of equally near ones the first along the surface.
    fn nearest(&self, slave: &SlavePoint, surface: &Surface, x: &Configuration) -> impl Iterator<Item = usize> {
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

/// Squared distance of a point from a segment; of a parabola from the two chords on either side of its middle.
fn distance_from_segment(slave: &SlavePoint, segment: &Segment, x: &Configuration) -> f64 {
    let from_chord = |[a, b]: [usize; 2]| {
        let (along, offset) = (x.between(a, b), slave.offset(a, x));
        let xi = (offset.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (offset - along * xi).norm_squared()
    };
    let [a, b] = segment.ends;
    segment.middle.map_or_else(|| from_chord([a, b]), |m| from_chord([a, m]).min(from_chord([m, b])))
}

/// A box or segment that may be the nearest; the heap has the nearest on top.
struct Candidate {
    /// Squared distance of the box, or, if `exact`, of the segment itself
    distance: f64,
    level: usize,
    number: usize,
    exact: bool,
}

impl Ord for Candidate {
    /// Boxes come before segments at the same distance: one of theirs may be the first along the surface.
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
