//! What a point of a surface may meet of the surface itself (self-contact).
//!
//! A point may meet a segment that faces it and in front of which it lay when the increment began, but none that shares a
//! node with its own edges. The other side of the body faces a point as well, back to back: the point is farther behind it
//! than half the thinnest element of the body. All this is settled when the increment begins, so that nothing flips in it
//! and a penetration of any depth is found.
//!
//! The tree keeps the directions n(θ) in which the segments below a branch look. A branch is passed over where
//!
//! ```text
//! n·n_point ≥ −0.1   or   n·(x_point − x) ≤ −depth      for every θ of the branch and every x of its box
//! ```
//!
//! so a point searches neither its own side nor the other side of the body.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;

use super::boxes::Box2;
use super::projection::{FACING, normal_of};
use super::surface::{Segment, SlavePoint, Surface};
use crate::mesh::configuration::Configuration;

/// A surface as it was when the increment began.
pub struct Sight<'a> {
    surface: &'a Surface,
    before: &'a Configuration<'a>,
    depth: f64,
    /// Level by level as in [`super::boxes::Boxes`]
    levels: Vec<Vec<Branch>>,
}

/// Some segments that follow each other.
#[derive(Clone, Copy, Debug)]
struct Branch {
    bounds: Box2,
    /// Range of the angles of their normals, counted on from segment to segment
    turn: [f64; 2],
}

/// A point or an edge of the surface that looks out.
pub struct Viewer {
    /// Place relative to the surface's origin
    at: Vector2<f64>,
    outward: Vector2<f64>,
    angle: f64,
    own: Vec<usize>,
}

impl<'a> Sight<'a> {
    /// The segments of a surface that touches itself, in the configuration before the increment, O(N); `depth` is how far
    /// a point may lie behind what it touches.
    pub fn new(surface: &'a Surface, depth: f64, before: &'a Configuration<'a>) -> Self {
        let mut angle = 0.0;
        let mut branch = |segment: &Segment| {
            let normal = normal_of(before.between(segment.ends[0], segment.ends[1]));
            angle += turn(normal.y.atan2(normal.x) - angle);
            Branch { bounds: Box2::of(segment, surface.origin(), before), turn: [angle; 2] }
        };
        let mut levels = vec![surface.segments.iter().map(&mut branch).collect::<Vec<_>>()];
        while let Some(last) = levels.last().filter(|last| last.len() > 1) {
            let joined = last.chunks(2).map(|pair| pair.iter().skip(1).fold(pair[0], Branch::joined)).collect();
            levels.push(joined);
        }
        Self { surface, before, depth, levels }
    }

    /// A slave point as a viewer; `None` for a point of no edge.
    pub fn point(&self, slave: &SlavePoint) -> Option<Viewer> {
        let shares = slave.length.iter().flat_map(|share| &share.tangent);
        let own = slave.position.iter().chain(shares).map(|&(node, _)| node).collect();
        slave
            .outward(self.before)
            .map(|outward| Viewer::new(slave.offset(self.surface.origin(), self.before), outward, own))
    }

    /// An edge as a viewer, from its middle; the body is on its left.
    pub fn edge(&self, edge: &[usize]) -> Viewer {
        let along = self.before.between(edge[0], edge[1]);
        let at = |node: usize| self.before.between(self.surface.origin(), node);
        let middle = 0.5 * (at(edge[0]) + at(edge[1]));
        Viewer::new(middle, -normal_of(along.normalize()), edge.to_vec())
    }

    /// Whether a viewer may meet a segment (level 0), or any below a branch: never false where one may be.
    pub fn may_meet(&self, viewer: &Viewer, level: usize, number: usize) -> bool {
        if level > 0 {
            let branch = &self.levels[level][number];
            return branch.faces(viewer) && branch.is_before(viewer, self.depth);
        }
        let segment = &self.surface.segments[number];
        let [start, end] = segment.ends;
        let normal = normal_of(self.before.between(start, end).normalize());
        normal.dot(&viewer.outward) < FACING
            && normal.dot(&(viewer.at - self.before.between(self.surface.origin(), start))) > -self.depth
            && !segment.nodes().any(|node| viewer.own.contains(&node))
    }
}

impl Viewer {
    fn new(at: Vector2<f64>, outward: Vector2<f64>, own: Vec<usize>) -> Self {
        Self { at, outward, angle: outward.y.atan2(outward.x), own }
    }
}

impl Branch {
    fn joined(self, other: &Self) -> Self {
        let turn = [self.turn[0].min(other.turn[0]), self.turn[1].max(other.turn[1])];
        Self { bounds: self.bounds.around(&other.bounds), turn }
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

    /// Whether the viewer is in front of some segment or not deeper behind it than `depth`.
    fn is_before(&self, viewer: &Viewer, depth: f64) -> bool {
        let offset = viewer.at - self.bounds.centre();
        offset.norm() * self.away(offset.y.atan2(offset.x)).cos() + self.bounds.radius() > -depth
    }
}

/// An angle between −π and π.
fn turn(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}
