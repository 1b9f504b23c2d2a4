//! Slave edges and master segments as functions of ξ, in numbers that carry their variations.

use nalgebra::Vector2;

use super::dual::{DualVector, Number};
use super::surface::Segment;
use crate::mesh::configuration::Configuration;
use crate::mesh::few::Few;
use crate::mesh::section::Section;
use crate::mesh::shape;

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

    /// Shape functions, first and second derivatives, as numbers.
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
    /// brings the exact variation.
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

/// ξ where Σ N_a(ξ) level_a = 0, by Newton's method: one step on a straight line, a few on a parabola.
pub(super) fn root(shapes: impl Fn(f64) -> [Few<f64, 3>; 3], levels: &[f64], start: f64) -> f64 {
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
    /// x of the first, and the section
    origin: (Vector2<f64>, Section),
    pub positions: Vec<DualVector<N>>,
}

impl<N> Default for Frame<N> {
    fn default() -> Self {
        Self { nodes: Vec::new(), origin: (Vector2::zeros(), Section::default()), positions: Vec::new() }
    }
}

impl<N: Number> Frame<N> {
    /// Find the positions of its nodes.
    pub fn place(&mut self, x: &Configuration) {
        let Self { nodes, origin, positions } = self;
        let n = 2 * nodes.len();
        *origin = (x.at(nodes[0]), x.section());
        positions.clear();
        positions.extend(nodes.iter().enumerate().map(|(k, &node)| {
            let at = x.between(nodes[0], node);
            DualVector { x: N::unknown(at.x, 2 * k, n), y: N::unknown(at.y, 2 * k + 1, n) }
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
