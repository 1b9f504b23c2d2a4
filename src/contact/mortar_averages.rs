//! What mortar contact averages around a slave node, and what the averages say about its place.

use std::iter::repeat;

use nalgebra::Vector2;

use super::cuts::Overlap;
use super::dual::{Dual, DualVector, Number};
use super::kinematics::Kinematics;
use super::lines::{Frame, Line};
use super::surface::Segment;
use crate::mesh::shape;

/// φ_a at ξ on an edge of n nodes, and its derivative: linear from node to node.
pub fn hat(n: usize, a: usize, xi: f64) -> (f64, f64) {
    let (place, width) = ([-1.0, 1.0, 0.0][a], if n == 2 { 2.0 } else { 1.0 });
    let away: f64 = xi - place;
    match away.abs() < width {
        true => (1.0 - away.abs() / width, -away.signum() / width),
        false => (0.0, 0.0),
    }
}

/// A_j and W_ja.
#[derive(Clone, Debug, Default)]
pub struct Averages<N> {
    pub weights: Vec<N>,
    pub length: N,
}

impl<N: Number> Averages<N> {
    /// Nothing summed up yet for so many nodes.
    pub fn clear(&mut self, nodes: usize) {
        self.weights.clear();
        self.weights.resize(nodes, N::default());
        self.length = N::default();
    }

    /// Add the integrals over one overlap.
    pub fn integrate(
        &mut self,
        edge: &[usize],
        a: usize,
        overlap: &Overlap,
        segment: &Segment,
        along: &DualVector<N>,
        frame: &Frame<N>,
    ) {
        let ends = overlap.ends.map(|cut| match cut.node {
            None => N::constant(cut.xi),
            Some(node) => Line::Edge(edge).coordinate(frame.at(node), along, cut.xi, frame),
        });
        let (half, middle) = (ends[1].minus(&ends[0]).scaled(0.5), ends[0].plus(&ends[1]).scaled(0.5));
        let points = if edge.len() == 2 && segment.middle.is_none() { 2 } else { 4 };
        for (at, weight) in shape::gauss(points) {
            let xi = middle.plus(&half.scaled(at));
            let slave = Line::Edge(edge);
            let values = slave.values(&xi);
            let slope = slave.slope(&xi, frame);
            let (value, rate) = hat(edge.len(), a, xi.value());
            let position = frame.position(edge.iter().copied(), &values);
            let share = slope.dot(&slope).sqrt().times(&half.scaled(weight)).times(&xi.map(value, rate));
            let share = match frame.depth(&position) {
                Some(depth) => share.times(&depth),
                None => share,
            };
            let master = Line::Segment(segment);
            let eta = master.coordinate(&position, along, 0.5, frame);
            self.length.accumulate(1.0, &share);
            for (&node, value) in edge.iter().zip(&values) {
                self.weights[frame.local(node)].accumulate(1.0, &share.times(value));
            }
            for (node, value) in segment.nodes().zip(master.values(&eta)) {
                self.weights[frame.local(node)].accumulate(-1.0, &share.times(&value));
            }
        }
    }
}

/// Memory for the averages around one point after the other.
#[derive(Clone, Debug, Default)]
pub struct Room {
    pub(super) values: Averaging<f64>,
    pub(super) duals: Averaging<Dual>,
    /// What a point of Gauss's rule has against a rigid body, and the variations of the mean normal
    pub(super) around: Kinematics,
    pub(super) turns: [Vec<f64>; 2],
}

/// What an average is taken over, and its parts.
#[derive(Clone, Debug, Default)]
pub struct Averaging<N> {
    pub(super) frame: Frame<N>,
    pub(super) averages: Averages<N>,
    /// W_ja/A_j
    pub(super) relative: Vec<N>,
}

/// The mean place of a slave node on the master.
pub struct MeanPlace<'a, N> {
    pub nodes: &'a [usize],
    /// W_ja/A_j
    pub relative: &'a [N],
    pub gap: N,
    pub slip: N,
    pub length: N,
    /// s and n
    pub axes: [DualVector<N>; 2],
}

impl<N: Number> MeanPlace<'_, N> {
    /// Write it, and how it varies if that is asked for, over the kinematics of the point.
    pub fn write(self, k: &mut Kinematics) {
        let Self { nodes, relative, gap, slip, length, axes: [s, n] } = self;
        k.begin(Vector2::new(n.x.value(), n.y.value()));
        k.nodes.extend_from_slice(nodes);
        k.clear();
        k.tangent = Vector2::new(s.x.value(), s.y.value());
        (k.slip, k.length) = (slip.value(), length.value());
        k.relative.iter_mut().zip(relative).for_each(|(value, w)| *value = w.value());
        if !k.varied {
            return;
        }
        let set = |row: &mut Vec<f64>, d: &N| row[..d.gradient().len()].copy_from_slice(d.gradient());
        set(&mut k.dgap, &gap);
        set(&mut k.dslip, &slip);
        set(&mut k.dlength, &length);
        let [dx, dy] = [&s.x, &s.y].map(|d| d.gradient().iter().copied().chain(repeat(0.0)));
        let turns = k.drotation.iter_mut().zip(dx.zip(dy));
        turns.for_each(|(turn, (dx, dy))| *turn = dx * k.normal.x + dy * k.normal.y);
        for (a, w) in relative.iter().enumerate() {
            k.changing.push(a);
            k.drelative.extend(w.gradient().iter().copied().chain(repeat(0.0)).take(k.dgap.len()));
        }
    }
}
