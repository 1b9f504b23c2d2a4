//! Surfaces of the mesh: chains of segments, straight, curved or smooth.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector2;

pub use super::point::{
    LengthShare, MasterPoint, SlavePoint, Weights, edge_point, gauss_points, gauss_points_and_corners, lone_point,
    nodal_points, nodal_points_of_rings,
};
use crate::mesh::configuration::Configuration;
use crate::mesh::few::Few;
use crate::mesh::shape;

/// One edge of a mesh surface, parametrized along s: straight, a parabola through its middle node, or a part of a smooth
/// curve through the nodes of the surface.
///
/// ```text
/// x(ξ) = h₀₀ x₁ + h₁₀ d₁ + h₀₁ x₂ + h₁₁ d₂        h: Hermite's cubics (Catmull–Rom spline)
/// d₁ = (x₂ − x₀)/2, d₂ = (x₃ − x₁)/2              x₀, x₃: nodes beyond the ends; without one, d = x₂ − x₁
/// ```
///
/// Two adjacent segments share d at their node, and thereby the normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Start and end node
    pub ends: [usize; 2],
    /// Middle node of a quadratic edge
    pub middle: Option<usize>,
    /// Nodes beyond start and end, where the surface continues smoothly
    pub beyond: [Option<usize>; 2],
}

impl Segment {
    /// Nodes: start, end[, middle][, beyond].
    pub fn nodes(&self) -> impl Iterator<Item = usize> {
        self.ends.into_iter().chain(self.middle).chain(self.beyond.into_iter().flatten())
    }

    /// Whether it is a straight line.
    pub fn is_straight(&self) -> bool {
        self.middle.is_none() && !self.is_smooth()
    }

    /// Whether it is a part of a smooth curve.
    fn is_smooth(&self) -> bool {
        self.beyond.iter().any(Option::is_some)
    }

    /// Shape functions of x at ξ, 0 … 1.
    pub fn position(&self, xi: f64) -> SegmentWeights {
        if self.is_smooth() {
            let (square, cube) = (xi * xi, xi * xi * xi);
            return self.hermite([3.0 * square - 2.0 * cube, cube - 2.0 * square + xi, cube - square], 1.0);
        }
        self.with(shape::edge_values(self.nodes().count(), 2.0 * xi - 1.0), 1.0)
    }

    /// Weights of x′ = dx/dξ at ξ.
    pub fn slope(&self, xi: f64) -> SegmentWeights {
        if self.is_smooth() {
            let square = xi * xi;
            return self.hermite([6.0 * (xi - square), 3.0 * square - 4.0 * xi + 1.0, 3.0 * square - 2.0 * xi], 0.0);
        }
        self.with(shape::edge_derivatives(self.nodes().count(), 2.0 * xi - 1.0), 2.0)
    }

    /// Weights of x″ = d²x/dξ² at ξ.
    pub fn bend(&self, xi: f64) -> SegmentWeights {
        if self.is_smooth() {
            return self.hermite([6.0 - 12.0 * xi, 6.0 * xi - 4.0, 6.0 * xi - 2.0], 0.0);
        }
        self.middle.map_or_else(SegmentWeights::default, |_| self.with([1.0, 1.0, -2.0].into(), 4.0))
    }

    /// Weights of h₀₀ x₁ + h₁₀ d₁ + h₀₁ x₂ + h₁₁ d₂, where h₀₀ = `sum` − h₀₁.
    fn hermite(&self, [h01, h10, h11]: [f64; 3], sum: f64) -> SegmentWeights {
        let [start, end] = self.ends;
        let [before, after] = self.beyond;
        let halved = |h: f64, half: bool| if half { 0.5 * h } else { h };
        let (at_start, at_end) = (halved(h10, before.is_some()), halved(h11, after.is_some()));
        [
            (start, sum - h01),
            (end, h01),
            (end, at_start),
            (before.unwrap_or(start), -at_start),
            (after.unwrap_or(end), at_end),
            (start, -at_end),
        ]
        .into()
    }

    /// Coefficients c_k of x(ξ) = Σ c_k ξᵏ for given nodal positions.
    pub fn powers(&self, at: impl Fn(usize) -> Vector2<f64>) -> [Vector2<f64>; 4] {
        let [start, end] = self.ends;
        let [a, b] = [at(start), at(end)];
        if let Some(middle) = self.middle {
            let m = at(middle);
            return [a, 4.0 * (m - a) - (b - a), 2.0 * (b - m) - 2.0 * (m - a), Vector2::zeros()];
        }
        if !self.is_smooth() {
            return [a, b - a, Vector2::zeros(), Vector2::zeros()];
        }
        let [before, after] = self.beyond;
        let slope_at_start = before.map_or(b - a, |before| 0.5 * (b - at(before)));
        let slope_at_end = after.map_or(b - a, |after| 0.5 * (at(after) - a));
        let along = b - a;
        [
            a,
            slope_at_start,
            3.0 * along - 2.0 * slope_at_start - slope_at_end,
            slope_at_start + slope_at_end - 2.0 * along,
        ]
    }

    fn with(&self, values: Few<f64, 3>, factor: f64) -> SegmentWeights {
        self.nodes().zip(values).map(|(node, value)| (node, factor * value)).collect()
    }
}

/// Cosine of the angle between adjacent edges below which their node is a corner: a turn of more than 45°, with a margin
/// against round-off at the corners of an octagon.
pub const CORNER: f64 = 0.7;

/// Segments of a mesh surface, each running along s (the body on its right), chains in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// The segments
    pub segments: Vec<Segment>,
    /// If the surface is also the slave, largest depth of a point behind a segment that it may contact [L]
    pub own_depth: Option<f64>,
    /// Chain of each segment
    chain_of: Vec<usize>,
    chains: Vec<Chain>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Chain {
    first: usize,
    length: usize,
    closed: bool,
}

/// A linear combination of the nodes of a segment.
pub type SegmentWeights = Few<(usize, f64), 6>;

/// A part of a path: from one coordinate of a segment to another.
#[derive(Clone, Copy, Debug)]
pub struct PathPart {
    /// the segment
    pub segment: usize,
    /// ξ where it begins
    pub start: f64,
    /// ξ where it ends
    pub end: f64,
}

/// Path along a surface from one material point to another.
///
/// ```text
///  from                                  to
/// ●━━×━━━━━━━●━━━━━━━━━━━━━━●━━━━━━━━━━━×━━━●
///    ├───────┼──────────────┼───────────┤
///    ξ to 1       0 to 1        0 to ξ          its parts: one of every segment
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Path<'a> {
    surface: &'a Surface,
    from: MasterPoint,
    to: MasterPoint,
    /// Whether it runs along s
    ahead: bool,
}

impl<'a> Path<'a> {
    /// The parts of the path, in order.
    pub fn parts(self) -> impl Iterator<Item = PathPart> + use<'a> {
        let Self { surface, from, to, ahead } = self;
        let (start, end) = if ahead { (0.0, 1.0) } else { (1.0, 0.0) };
        let next = move |at: usize| if ahead { surface.next(at) } else { surface.previous(at) };
        let segments = std::iter::successors(Some(from.segment), move |&at| next(at).filter(|_| at != to.segment));
        segments.map(move |segment| PathPart {
            segment,
            start: if segment == from.segment { from.xi } else { start },
            end: if segment == to.segment { to.xi } else { end },
        })
    }
}

impl Surface {
    /// Creates a surface from edges (start, end[, middle]) with the body on their left.
    pub fn new(edges: &[Vec<usize>]) -> Self {
        let pending: Vec<[usize; 2]> = edges.iter().map(|edge| [edge[1], edge[0]]).collect();
        let middles: BTreeMap<[usize; 2], Option<usize>> =
            pending.iter().copied().zip(edges.iter().map(|edge| edge.get(2).copied())).collect();
        let mut surface = Self::default();
        for chain in chains(&pending) {
            let closed = chain.len() > 1 && chain[chain.len() - 1][1] == chain[0][0];
            surface.chain_of.extend(chain.iter().map(|_| surface.chains.len()));
            surface.chains.push(Chain { first: surface.segments.len(), length: chain.len(), closed });
            surface.segments.extend(chain.into_iter().map(|ends| Segment {
                ends,
                middle: middles[&ends],
                beyond: [None; 2],
            }));
        }
        surface
    }

    /// Returns the surface as a smooth curve through its nodes, with corners only where two edges turn by more than 45° in the
    /// given positions.
    pub fn smoothed(mut self, positions: &[Vector2<f64>]) -> Self {
        let straight = self.segments.clone();
        let direction = |k: usize| {
            let [a, b] = straight[k].ends;
            (positions[b] - positions[a]).normalize()
        };
        let joined =
            |k: usize, other: Option<usize>| other.filter(|&other| direction(k).dot(&direction(other)) > CORNER);
        for k in 0..straight.len() {
            let (before, after) = (joined(k, self.previous(k)), joined(k, self.next(k)));
            self.segments[k].beyond = [before.map(|k| straight[k].ends[0]), after.map(|k| straight[k].ends[1])];
        }
        self
    }

    /// Makes the surface a self-contact master.
    pub fn against_itself(self, depth: f64) -> Self {
        Self { own_depth: Some(depth), ..self }
    }

    /// By how much chords lie outside the body of which they stand for the curved side, in the mean: h θ/12 for edges h that turn by θ,
    /// less than 0 where the body is convex [L].
    pub fn by_chords(&self, x: &Configuration) -> f64 {
        let along = |segment: usize| {
            let [a, b] = self.segments[segment].ends;
            x.between(a, b)
        };
        let turn = |before: usize, after: usize| {
            let [before, after] = [along(before), along(after)];
            let smooth = before.dot(&after) > CORNER * before.norm() * after.norm();
            smooth.then(|| before.perp(&after).atan2(before.dot(&after)))
        };
        // A single bend is none, but what bends on alike; the edge at an end bends as its neighbour does.
        let bend = |k: usize| {
            let before = self.previous(k).and_then(|previous| turn(previous, k))?;
            let after = self.next(k).and_then(|next| turn(k, next))?;
            Some(if before * after > 0.0 { before.signum() * before.abs().min(after.abs()) } else { 0.0 })
        };
        let (mut lengths, mut areas) = (0.0, 0.0);
        for (k, segment) in self.segments.iter().enumerate() {
            let length = along(k).norm();
            lengths += length;
            if segment.middle.is_none() {
                let neighbours = [Some(k), self.previous(k), self.next(k)];
                let angle = neighbours.into_iter().flatten().find_map(bend).unwrap_or(0.0);
                areas += length * length * angle / 12.0;
            }
        }
        areas / lengths
    }

    /// A node of the surface as the origin of relative positions; 0 without segments.
    pub fn origin(&self) -> usize {
        self.segments.first().map_or(0, |segment| segment.ends[0])
    }

    /// Fraction of the slave's length that counts: half in self-contact, where every contact is found from both sides.
    pub fn share(&self) -> f64 {
        if self.own_depth.is_some() { 0.5 } else { 1.0 }
    }

    /// The next segment along s, if there is one.
    pub fn next(&self, segment: usize) -> Option<usize> {
        let chain = self.chains[self.chain_of[segment]];
        let k = segment - chain.first + 1;
        if k < chain.length { Some(segment + 1) } else { chain.closed.then_some(chain.first) }
    }

    /// The previous segment along s, if there is one.
    pub fn previous(&self, segment: usize) -> Option<usize> {
        let chain = self.chains[self.chain_of[segment]];
        let last = chain.first + chain.length - 1;
        if segment > chain.first { Some(segment - 1) } else { chain.closed.then_some(last) }
    }

    /// Path from one material point to another, the shorter one around a closed chain; `None` between chains.
    pub fn path(&self, from: MasterPoint, to: MasterPoint) -> Option<Path<'_>> {
        let chain = self.chains[self.chain_of[from.segment]];
        if self.chain_of[to.segment] != self.chain_of[from.segment] {
            return None;
        }
        let forward = (to.segment + chain.length - from.segment) % chain.length;
        let ahead = if chain.closed { forward <= chain.length / 2 } else { to.segment > from.segment };
        Some(Path { surface: self, from, to, ahead })
    }
}

/// Edges of a slave surface in order along the surface, chain after chain.
pub fn in_order(edges: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let by_ends: BTreeMap<[usize; 2], &Vec<usize>> = edges.iter().map(|edge| ([edge[0], edge[1]], edge)).collect();
    let ends: Vec<[usize; 2]> = edges.iter().map(|edge| [edge[0], edge[1]]).collect();
    chains(&ends).concat().iter().filter_map(|pair| by_ends.get(pair).map(|&edge| edge.clone())).collect()
}

/// Whether an end of an edge, 0 or 1, is an end of the surface, or a corner of more than 45° in the given positions.
pub fn is_corner(edges: &[Vec<usize>], positions: &[Vector2<f64>], edge: usize, end: usize) -> bool {
    let direction = |edge: &[usize]| (positions[edge[1]] - positions[edge[0]]).normalize();
    let next = edges.iter().find(|other| other[1 - end] == edges[edge][end]);
    next.is_none_or(|next| direction(next).dot(&direction(&edges[edge])) <= CORNER)
}

/// Joins directed pairs end to start; open chains begin at their start, closed ones anywhere.
fn chains(pairs: &[[usize; 2]]) -> Vec<Vec<[usize; 2]>> {
    let mut by_start: BTreeMap<usize, usize> = pairs.iter().enumerate().map(|(k, p)| (p[0], k)).collect();
    let ends: BTreeSet<usize> = pairs.iter().map(|p| p[1]).collect();
    let heads = pairs.iter().filter(|p| !ends.contains(&p[0])).chain(pairs).map(|p| p[0]);
    let mut result = Vec::new();
    for head in heads {
        let mut chain = Vec::new();
        let mut at = head;
        while let Some(k) = by_start.remove(&at) {
            chain.push(pairs[k]);
            at = pairs[k][1];
        }
        if !chain.is_empty() {
            result.push(chain);
        }
    }
    result
}
