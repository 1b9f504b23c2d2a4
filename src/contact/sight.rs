//! Visibility in self-contact: which parts of its own surface a point may come into contact with.
//!
//! ```text
//! ━━━━━━━━━━━━━━━━━ 1     faces the point across a slot: it may meet that
//!         ↑
//! ━━━━━━━━•━━━━━━━━ 2     its own edges and what shares nodes with them: never
//!     its wall
//! ━━━━━━━━━━━━━━━━━ 3     the opposite side of the wall, back to back: never
//! ```
//!
//! A point may contact a segment that faces it and in front of which it lay at the start of the increment, but none that shares
//! a node with its own edges. The opposite side of the body also faces a point, back to back: the point lies farther behind it
//! than half the thinnest element of the body. All this is determined at the start of the increment, so that it is constant
//! within it and a penetration of any depth is found.
//!
//! The tree stores the normal directions n(θ) of the segments below a branch. A branch is skipped where
//!
//! ```text
//! n·n_point ≥ −0.1   or   n·(x_point − x) ≤ −depth      for every θ of the branch and every x of its box
//! ```
//!
//! so that a point searches neither its own side nor the opposite side of the body.

use std::borrow::Cow;
use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;

use super::projection::{FACING, normal_of};
use super::segment_search::{Branch, bounding_box};
use super::surface::{Segment, SlavePoint, Surface};
use crate::mesh::boxes::Box2;
use crate::mesh::configuration::Configuration;

/// A surface at the start of the increment.
pub struct Sight<'a> {
    surface: &'a Surface,
    before: &'a Configuration<'a>,
    depth: f64,
    tree: Cow<'a, NormalTree>,
}

/// Tree of a surface in one configuration; valid as long as no node of the surface moves.
#[derive(Clone, Debug, Default)]
pub struct NormalTree {
    /// X and u of the nodes of the segments
    places: Vec<(usize, [Vector2<f64>; 2])>,
    /// Bounds of every branch, by its level and number
    levels: Vec<Vec<Bounds>>,
}

/// Bounds of the segments of a branch.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    place: Box2,
    /// Range of the angles of their normals, continued from segment to segment
    turn: [f64; 2],
}

/// A point or edge of the surface as an observer.
pub struct Viewer<'a> {
    /// Position relative to the surface's origin
    at: Vector2<f64>,
    outward: Vector2<f64>,
    angle: f64,
    own: Own<'a>,
}

/// Parts excluded from visibility.
enum Own<'a> {
    /// Nodes of a point's edges
    Point(&'a SlavePoint),
    /// Nodes of an edge
    Edge(&'a [usize]),
}

impl Own<'_> {
    fn has(&self, node: usize) -> bool {
        match self {
            Self::Edge(edge) => edge.contains(&node),
            Self::Point(slave) => {
                let shares = slave.length.iter().flat_map(|share| &share.tangent);
                slave.position.iter().chain(shares).any(|&(own, _)| own == node)
            }
        }
    }
}

impl NormalTree {
    /// Rebuilds the tree unless it is that of a surface in the configuration `x`, O(N).
    pub(super) fn update(&mut self, surface: &Surface, x: &Configuration) {
        let nodes = || surface.segments.iter().flat_map(Segment::nodes);
        let places = || nodes().map(|node| (node, x.split(&[(node, 1.0)], Vector2::zeros())));
        if places().eq(self.places.iter().copied()) {
            return;
        }
        self.places.clear();
        self.places.extend(places());
        let mut angle = 0.0;
        let bounds = |segment: &Segment| {
            let normal = normal_of(x.between(segment.ends[0], segment.ends[1]));
            angle += turn(normal.y.atan2(normal.x) - angle);
            Bounds { place: bounding_box(segment, surface.origin(), x), turn: [angle; 2] }
        };
        let count = usize::BITS - surface.segments.len().saturating_sub(1).leading_zeros();
        self.levels.resize_with(1 + count as usize, Vec::new);
        let (leaves, above) = self.levels.split_at_mut(1);
        leaves[0].clear();
        leaves[0].extend(surface.segments.iter().map(bounds));
        let mut below = &leaves[0];
        for level in above {
            level.clear();
            level.extend(below.chunks(2).map(|pair| pair.iter().skip(1).fold(pair[0], Bounds::joined)));
            below = level;
        }
    }
}

impl<'a> Sight<'a> {
    /// Creates the visibility of a self-contact surface in the configuration before the increment, with its tree; `depth` is
    /// the largest depth of a point behind a segment that it may contact.
    pub fn new(surface: &'a Surface, depth: f64, before: &'a Configuration<'a>, tree: Cow<'a, NormalTree>) -> Self {
        Self { surface, before, depth, tree }
    }

    /// A slave point as an observer; `None` without edges.
    pub fn point<'b>(&self, slave: &'b SlavePoint) -> Option<Viewer<'b>> {
        let at = || slave.offset(self.surface.origin(), self.before);
        slave.outward(self.before).map(|outward| Viewer::new(at(), outward, Own::Point(slave)))
    }

    /// An edge as an observer, from its middle; the body is on its left.
    pub fn edge<'b>(&self, edge: &'b [usize]) -> Viewer<'b> {
        let along = self.before.between(edge[0], edge[1]);
        let at = |node: usize| self.before.between(self.surface.origin(), node);
        let middle = 0.5 * (at(edge[0]) + at(edge[1]));
        Viewer::new(middle, -normal_of(along.normalize()), Own::Edge(edge))
    }

    /// Whether an observer may contact any segment of a branch; conservative for more than one.
    pub fn may_meet(&self, viewer: &Viewer, branch: Branch) -> bool {
        if branch.level > 0 {
            let bounds = &self.tree.levels[branch.level][branch.number];
            return bounds.faces(viewer) && bounds.is_before(viewer, self.depth);
        }
        let segment = &self.surface.segments[branch.number];
        let [start, end] = segment.ends;
        let normal = normal_of(self.before.between(start, end).normalize());
        normal.dot(&viewer.outward) < FACING
            && normal.dot(&(viewer.at - self.before.between(self.surface.origin(), start))) > -self.depth
            && !segment.nodes().any(|node| viewer.own.has(node))
    }
}

impl<'a> Viewer<'a> {
    fn new(at: Vector2<f64>, outward: Vector2<f64>, own: Own<'a>) -> Self {
        Self { at, outward, angle: outward.y.atan2(outward.x), own }
    }
}

impl Bounds {
    fn joined(self, other: &Self) -> Self {
        let turn = [self.turn[0].min(other.turn[0]), self.turn[1].max(other.turn[1])];
        Self { place: self.place.with(other.place), turn }
    }

    /// Smallest angle between a direction and those of the branch, 0 to π.
    fn away(&self, angle: f64) -> f64 {
        let [low, high] = self.turn;
        let past = (angle - low).rem_euclid(TAU);
        if past <= high - low { 0.0 } else { (past - (high - low)).min(TAU - past) }
    }

    fn faces(&self, viewer: &Viewer) -> bool {
        self.away(viewer.angle + PI).cos() > -FACING
    }

    /// Whether the observer is in front of some segment or not deeper behind it than `depth`.
    fn is_before(&self, viewer: &Viewer, depth: f64) -> bool {
        let offset = viewer.at - self.place.centre();
        let radius = 0.5 * self.place.size().norm();
        offset.norm() * self.away(offset.y.atan2(offset.x)).cos() + radius > -depth
    }
}

/// Maps an angle to −π … π.
fn turn(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}
