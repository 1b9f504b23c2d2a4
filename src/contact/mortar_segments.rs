//! Mortar segments, the integration domains of mortar contact.
//!
//! ```text
//!      ●━━━━━━┿━━━━━━━━━━━━┿━━━━━●         an edge of the slave, cut where nodes of the master are projected on it
//!      ┊  0   ┊     1      ┊  2  ┊         an overlap for every segment that it faces
//!   ●━━━━━━━━━●━━━━━━━━━━━━●━━━━━━━━━●     the master
//! ```
//!
//! Slave edges are divided at the projections of master nodes, which gives the part of an edge overlapped by each master
//! segment.
//!
//! Slave edges and master segments are functions of ξ, in numbers with variations.

use nalgebra::Vector2;

use super::dual::{DualVector, Number};
use super::projection::{FACING, normal_of};
use super::search::Index;
use super::surface::{Segment, Surface};
use crate::mesh::few::Few;
use crate::mesh::shape;
use crate::mesh::{Configuration, Section};

/// Largest distance of a master segment from a slave edge, in lengths of the edge: large enough for the deep penetrations of
/// first iterates, which must not count as lost contact.
const REACH: f64 = 10.0;

/// Cosine between the normal of a slave edge and the opposite of a segment's from which on it counts whole; down to that of
/// [`FACING`] it counts less and less, so that no average jumps as surfaces turn. What is steeper is the flank of an end, which
/// carries nothing of what presses on the edge.
const OBLIQUE: f64 = 0.5;

/// Distance beyond an end of an edge at which a segment with both ends projected there no longer overlaps it [half edge length]
const NEARLY: f64 = 1e-3;

/// Part of a slave edge overlapped by one master segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Overlap {
    pub segment: usize,
    pub ends: [Cut; 2],
    /// Gap of its middle along the edge's normal in the committed configuration, to what it faces now [L]
    pub gap: f64,
    /// Gap beyond which others do not count compared with it [L]
    pub reach: f64,
}

impl Overlap {
    /// ξ of its middle.
    pub(super) fn middle(&self) -> f64 {
        0.5 * (self.ends[0].xi + self.ends[1].xi)
    }

    /// Gap along the edge's normal between the edge at ξ and the place of the segment that it faces in the configuration `x`, as both
    /// were in the configuration `before`. With the committed one there it is all but constant in an increment: a penetration of any
    /// depth is found, and the far side of a body is not taken for one.
    fn gap(&self, edge: &[usize], surface: &Surface, xi: f64, [before, x]: [&Configuration; 2]) -> f64 {
        let segment = &surface.segments[self.segment];
        let along = x.between(edge[0], edge[1]);
        let values = shape::edge_values(edge.len(), xi);
        let offset = |node: usize, x: &Configuration| -> Vector2<f64> {
            edge.iter().zip(&values).map(|(&own, w)| *w * x.between(node, own)).sum()
        };
        let [start, end] = segment.ends.map(|node| offset(node, x).dot(&along));
        let eta = start / (start - end);
        let separation: Vector2<f64> = segment.position(eta).iter().map(|&(node, w)| w * offset(node, before)).sum();
        separation.dot(&normal_of(before.between(edge[0], edge[1]).normalize()))
    }
}

/// A coordinate at which a slave edge is cut into mortar segments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    pub xi: f64,
    /// Master node that projects there; `None` at the ends of the edge
    pub node: Option<usize>,
}

/// Divisions of all slave edges in one configuration, stored in reused memory.
#[derive(Clone, Debug, Default)]
pub struct Overlaps(pub(super) Vec<CutEdge>);

/// A divided slave edge.
#[derive(Clone, Debug, Default)]
pub(super) struct CutEdge {
    /// Its overlapped parts, in order
    pub overlaps: Vec<Overlap>,
    /// Overlap with each segment around it, irrespective of segments in between
    candidates: Vec<Overlap>,
    cuts: Vec<Cut>,
    /// Segments around it
    around: Vec<usize>,
}

impl CutEdge {
    /// Divides an edge at the projections of master nodes; where several segments overlap, the nearest one counts. Segments that
    /// were deeper than `depth` in front of it in the first configuration do not count.
    pub fn cut(
        &mut self,
        edge: &[usize],
        depth: f64,
        surface: &Surface,
        index: &Index,
        [before, x]: [&Configuration; 2],
    ) {
        let Self { overlaps, candidates, cuts, around } = self;
        candidates.clear();
        facing(edge, surface, index, x, around, candidates);
        candidates.retain(|overlap| overlap.gap(edge, surface, overlap.middle(), [before, x]) >= -depth);
        cuts.clear();
        cuts.extend(candidates.iter().flat_map(|overlap| overlap.ends));
        if edge.len() == 3 {
            cuts.push(Cut { xi: 0.0, node: None });
        }
        cuts.sort_by(|a, b| a.xi.total_cmp(&b.xi));
        let distance = |overlap: &Overlap, xi: f64| overlap.gap(edge, surface, xi, [x, x]).abs();
        let length = x.between(edge[0], edge[1]).norm();
        overlaps.clear();
        for pair in cuts.windows(2).filter(|pair| pair[0].xi < pair[1].xi) {
            let middle = 0.5 * (pair[0].xi + pair[1].xi);
            let facing = candidates.iter().filter(|overlap| overlap.ends[0].xi < middle && middle < overlap.ends[1].xi);
            let nearest = facing.min_by(|a, b| distance(a, middle).total_cmp(&distance(b, middle)));
            overlaps.extend(nearest.map(|overlap| {
                let gap = overlap.gap(edge, surface, middle, [before, x]);
                Overlap { segment: overlap.segment, ends: [pair[0], pair[1]], gap, reach: gap + length }
            }));
        }
    }
}

/// Adds the overlap of a slave edge with each segment around it, irrespective of segments in between, to the `candidates`.
fn facing(
    edge: &[usize],
    surface: &Surface,
    index: &Index,
    x: &Configuration,
    around: &mut Vec<usize>,
    candidates: &mut Vec<Overlap>,
) {
    let along = x.between(edge[0], edge[1]);
    let reach = REACH * along.norm();
    let normal = -normal_of(along.normalize());
    let levels = |node: usize| -> Few<f64, 3> { edge.iter().map(|&own| x.between(node, own).dot(&along)).collect() };
    let chord = |levels: &[f64]| 2.0 * levels[0] / (levels[0] - levels[1]) - 1.0;
    // At its ends a quadratic edge is where its chord is. Beyond them the parabola may turn back, and pass no node far away.
    let coordinate = |node: usize| {
        let levels = levels(node);
        let along = chord(&levels);
        if along.abs() < 1.0 { root(|xi| Line::Edge(edge).shapes(xi), &levels, along) } else { along }
    };
    index.around(edge, reach, x, around);
    for &segment in &*around {
        let [a, b] = surface.segments[segment].ends;
        let [start, end] = [a, b].map(|node| chord(&levels(node)));
        if start.min(end) > 1.0 + NEARLY || start.max(end) < -1.0 - NEARLY {
            continue;
        }
        if normal_of(x.between(a, b).normalize()).dot(&normal) >= FACING {
            continue;
        }
        // Both run along s, so the start of the segment comes first.
        let [mut first, mut last] = [a, b].map(|node| Cut { xi: coordinate(node), node: Some(node) });
        if first.xi <= -1.0 {
            first = Cut { xi: -1.0, node: None };
        }
        if last.xi >= 1.0 {
            last = Cut { xi: 1.0, node: None };
        }
        if first.xi < last.xi {
            candidates.push(Overlap { segment, ends: [first, last], gap: 0.0, reach: 0.0 });
        }
    }
}

/// Factor of what faces the direction of an edge obliquely; `None` for what counts whole.
pub(super) fn oblique<N: Number>(segment: &Segment, along: &DualVector<N>, frame: &Frame<N>) -> Option<N> {
    let [start, end] = segment.ends;
    let cosine = frame.at(end).minus(frame.at(start)).normalized().dot(along);
    let width = OBLIQUE + FACING;
    (cosine.value() < OBLIQUE).then(|| cosine.map(((cosine.value() + FACING) / width).max(0.0), 1.0 / width))
}

/// κ: tangent of the angle from the direction of an edge to that of a segment, up to that from which the segment counts less.
pub(super) fn lean<N: Number>(segment: &Segment, along: &DualVector<N>, frame: &Frame<N>) -> N {
    let [start, end] = segment.ends;
    let direction = frame.at(end).minus(frame.at(start)).normalized();
    let cosine = direction.dot(along);
    let least = if cosine.value() < OBLIQUE { N::constant(OBLIQUE) } else { cosine };
    direction.dot(&along.turned()).over(&least)
}

/// φ at ξ on an edge of n nodes from its values there, and its derivative: linear from node to node.
pub(super) fn between_nodes(n: usize, &[start, end, middle]: &[f64; 3], xi: f64) -> (f64, f64) {
    let (low, left, right, width) = match n {
        2 => (-1.0, start, end, 2.0),
        _ if xi < 0.0 => (-1.0, start, middle, 1.0),
        _ => (0.0, middle, end, 1.0),
    };
    let slope = (right - left) / width;
    (left + slope * (xi - low), slope)
}

/// A slave edge, ξ from −1 to 1, or a master segment, ξ from 0 to 1.
#[derive(Clone, Copy)]
pub(super) enum Line<'a> {
    Edge(&'a [usize]),
    Segment(&'a Segment),
}

impl Line<'_> {
    pub fn nodes(&self) -> Few<usize, 5> {
        match self {
            Self::Edge(edge) => edge.iter().copied().collect(),
            Self::Segment(segment) => segment.nodes().collect(),
        }
    }

    /// Shape functions, their first and second derivatives, as numbers.
    pub fn shapes(&self, xi: f64) -> [Few<f64, 3>; 3] {
        let count = self.nodes().len();
        let (at, rate) = match self {
            Self::Edge(_) => (xi, 1.0),
            Self::Segment(_) => (2.0 * xi - 1.0, 2.0),
        };
        let scaled = |values: Few<f64, 3>, factor: f64| values.into_iter().map(|v| factor * v).collect();
        let bend = if count == 2 { [0.0; 2].into() } else { [1.0, 1.0, -2.0].into() };
        [shape::edge_values(count, at), scaled(shape::edge_derivatives(count, at), rate), scaled(bend, rate * rate)]
    }

    pub fn values<N: Number>(&self, xi: &N) -> [N; 3] {
        let [values, slopes, _] = self.shapes(xi.value());
        let mut values = values.into_iter().zip(slopes).map(|(value, slope)| xi.map(value, slope));
        std::array::from_fn(|_| values.next().unwrap_or_default())
    }

    pub fn slope<N: Number>(&self, xi: &N, frame: &Frame<N>) -> DualVector<N> {
        let [_, slopes, bends] = self.shapes(xi.value());
        let mut slopes = slopes.into_iter().zip(bends).map(|(slope, bend)| xi.map(slope, bend));
        let slopes: [N; 3] = std::array::from_fn(|_| slopes.next().unwrap_or_default());
        frame.position(self.nodes().into_iter(), &slopes)
    }

    /// ξ where the line is level with a point, (x(ξ) − point)·along = 0, near `start`. One Newton step from the solution
    /// gives the exact variation.
    pub fn coordinate<N: Number>(
        &self,
        point: &DualVector<N>,
        along: &DualVector<N>,
        start: f64,
        frame: &Frame<N>,
    ) -> N {
        let vector = |v: &DualVector<N>| Vector2::new(v.x.value(), v.y.value());
        let (t, p) = (vector(along), vector(point));
        let level = |node: usize| {
            let at = frame.at(node);
            (vector(at) - p).dot(&t)
        };
        let levels: Few<f64, 5> = self.nodes().into_iter().map(level).collect();
        let xi = root(|xi| self.shapes(xi), &levels, start);
        let fixed = N::constant(xi);
        let residual = frame.position(self.nodes().into_iter(), &self.values(&fixed)).minus(point).dot(along);
        let slope = self.slope(&fixed, frame).dot(along);
        fixed.minus(&residual.over(&slope))
    }
}

/// ξ where Σ N_a(ξ) level_a = 0, by Newton's method: one step for a straight line, a few for a parabola.
fn root(shapes: impl Fn(f64) -> [Few<f64, 3>; 3], levels: &[f64], start: f64) -> f64 {
    let sum = |values: &[f64]| values.iter().zip(levels).map(|(v, l)| v * l).sum::<f64>();
    let mut xi = start;
    for _ in 0..20 {
        let [values, slopes, _] = shapes(xi);
        let step = sum(&values) / sum(&slopes);
        xi -= step;
        if step.abs() < f64::EPSILON * (1.0 + xi.abs()) {
            break;
        }
    }
    xi
}

/// Positions of some nodes relative to the first, as unknowns.
#[derive(Clone, Debug)]
pub(super) struct Frame<N> {
    pub nodes: Vec<usize>,
    /// x of the first node, and the section
    origin: (Vector2<f64>, Section),
    pub positions: Vec<DualVector<N>>,
}

impl<N> Default for Frame<N> {
    fn default() -> Self {
        Self { nodes: Vec::new(), origin: (Vector2::zeros(), Section::default()), positions: Vec::new() }
    }
}

impl<N: Number> Frame<N> {
    /// Computes the positions of its nodes, for derivatives by the unknowns from number `first` on.
    pub fn place(&mut self, x: &Configuration, first: usize) {
        let Self { nodes, origin, positions } = self;
        *origin = (x.at(nodes[0]), x.section());
        positions.clear();
        positions.extend(nodes.iter().enumerate().map(|(k, &node)| {
            let at = x.between(nodes[0], node);
            let unknown = |value: f64, k: usize| N::unknown(value, k.wrapping_sub(first));
            DualVector { x: unknown(at.x, 2 * k), y: unknown(at.y, 2 * k + 1) }
        }));
    }

    /// w of the section at a position; `None` in plane strain, where it is 1 everywhere.
    pub fn depth(&self, position: &DualVector<N>) -> Option<N> {
        let (origin, section) = self.origin;
        if section == Section::PlaneStrain {
            return None;
        }
        let at = origin + Vector2::new(position.x.value(), position.y.value());
        let mut depth = N::constant(section.weight(at));
        let slope = section.slope(at).unwrap_or_default();
        for (rate, moved) in [(slope.x, &position.x), (slope.y, &position.y)] {
            depth.accumulate(rate, &moved.map(0.0, 1.0));
        }
        Some(depth)
    }

    pub fn local(&self, node: usize) -> usize {
        self.nodes.iter().position(|&n| n == node).expect("every node of an average is listed when it is built")
    }

    pub fn at(&self, node: usize) -> &DualVector<N> {
        &self.positions[self.local(node)]
    }

    pub fn position(&self, nodes: impl Iterator<Item = usize>, weights: &[N]) -> DualVector<N> {
        let mut sum = DualVector::default();
        for (node, weight) in nodes.zip(weights) {
            sum.add_scaled(weight, self.at(node));
        }
        sum
    }

    pub fn combine(&self, weights: &[N]) -> DualVector<N> {
        self.position(self.nodes.iter().copied(), weights)
    }
}
