//! Slave edges and master segments as functions of ξ, in numbers that carry their variations.

use nalgebra::Vector2;

use super::dual::{Dual, DualVector};
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
    pub fn nodes(&self) -> Vec<usize> {
        match self {
            Self::Edge(edge) => edge.to_vec(),
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

    pub fn values(&self, xi: &Dual) -> Vec<Dual> {
        let [values, slopes, _] = self.shapes(xi.value);
        values.into_iter().zip(slopes).map(|(value, slope)| xi.map(value, slope)).collect()
    }

    pub fn slope(&self, xi: &Dual, frame: &Frame) -> DualVector {
        let [_, slopes, bends] = self.shapes(xi.value);
        let slopes: Vec<Dual> = slopes.into_iter().zip(bends).map(|(slope, bend)| xi.map(slope, bend)).collect();
        frame.position(self.nodes().into_iter(), &slopes)
    }

    /// ξ where the line is level with a point, (x(ξ) − point)·along = 0, near `start`. One Newton step from the solution
    /// brings the exact variation.
    pub fn coordinate(&self, point: &DualVector, along: &DualVector, start: f64, frame: &Frame) -> Dual {
        let t = Vector2::new(along.x.value, along.y.value);
        let p = Vector2::new(point.x.value, point.y.value);
        let level = |node: usize| {
            let at = frame.at(node);
            (Vector2::new(at.x.value, at.y.value) - p).dot(&t)
        };
        let levels: Vec<f64> = self.nodes().into_iter().map(level).collect();
        let xi = root(|xi| self.shapes(xi), &levels, start);
        let fixed = Dual::constant(xi);
        let residual = frame.position(self.nodes().into_iter(), &self.values(&fixed)).minus(point).dot(along);
        let slope = self.slope(&fixed, frame).dot(along);
        &fixed - &(&residual / &slope)
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
pub(super) struct Frame {
    pub nodes: Vec<usize>,
    /// x of the first, and the section
    origin: (Vector2<f64>, Section),
    pub positions: Vec<DualVector>,
}

impl Frame {
    pub fn new(nodes: Vec<usize>, variations: bool, x: &Configuration) -> Self {
        let n = if variations { 2 * nodes.len() } else { 0 };
        let position = |(k, &node): (usize, &usize)| {
            let at = x.between(nodes[0], node);
            DualVector { x: Dual::unknown(at.x, 2 * k, n), y: Dual::unknown(at.y, 2 * k + 1, n) }
        };
        let origin = (x.at(nodes[0]), x.section());
        Self { positions: nodes.iter().enumerate().map(position).collect(), origin, nodes }
    }

    /// w of the section at a position; `None` where it is 1 everywhere.
    pub fn depth(&self, position: &DualVector) -> Option<Dual> {
        let (origin, section) = self.origin;
        let at = origin + Vector2::new(position.x.value, position.y.value);
        let slope = section.slope(at)?;
        let mut depth = Dual::constant(section.weight(at));
        for (rate, moved) in [(slope.x, &position.x), (slope.y, &position.y)] {
            depth.accumulate(rate, &Dual { value: 0.0, gradient: moved.gradient.clone() });
        }
        Some(depth)
    }

    pub fn local(&self, node: usize) -> usize {
        self.nodes.iter().position(|&n| n == node).expect("every node of an average is listed when it is built")
    }

    pub fn at(&self, node: usize) -> &DualVector {
        &self.positions[self.local(node)]
    }

    pub fn position(&self, nodes: impl Iterator<Item = usize>, weights: &[Dual]) -> DualVector {
        let mut sum = DualVector::default();
        for (node, weight) in nodes.zip(weights) {
            sum.add_scaled(weight, self.at(node));
        }
        sum
    }

    pub fn combine(&self, weights: &[Dual]) -> DualVector {
        self.position(self.nodes.iter().copied(), weights)
    }
}
