//! Averages of mortar contact around a point: integrals over parts of slave edges, with their variations.
//!
//! ```text
//! A = ∫ φ ds,   W_a = ∫ φ N_a ds (slave nodes),   −∫ φ N_a ds (master nodes),   r = Σ W_a x_a/A
//! ```
//! and of what is closed next to a ridge, weighted by its depth −g:
//!
//! ```text
//! D = ∫_{g < 0} φ (−g) ds,   W_a = ∫_{g < 0} φ (−g) N_a ds (slave nodes),   r = Σ W_a x_a/D,   A = D²/∫_{g < 0} φ g² ds
//! ```
//! With g = n·r, the force α_n ⟨−g⟩ A of a point is α_n D, and its energy ½ α_n g² A is ½ α_n ∫ φ ⟨−g⟩² ds. Where g is uniform, both are the same.
//! κ is the mean of that of the segments with the same weights (`ridges.rs`).

use super::dual::{DualVector, Number};
use super::mortar_segments::{Frame, Line, Overlap, between_nodes, lean, oblique};
use super::surface::Segment;
use crate::mesh::shape;

/// What of the overlaps of a point integrals are taken over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Extent {
    #[default]
    All,
    Closed,
}

/// A slave edge and a master segment that it faces, along the normal of the edge.
#[derive(Clone, Copy)]
pub(super) struct Pieces<'a, N> {
    pub edge: &'a [usize],
    pub segment: &'a Segment,
    /// Direction of the edge
    pub along: &'a DualVector<N>,
    pub frame: &'a Frame<N>,
}

impl<N: Number> Pieces<'_, N> {
    /// ξ at the ends of an overlap.
    pub fn ends(&self, overlap: &Overlap) -> [N; 2] {
        let Self { edge, along, frame, .. } = *self;
        overlap.ends.map(|cut| match cut.node {
            None => N::constant(cut.xi),
            Some(node) => Line::Edge(edge).coordinate(frame.at(node), along, cut.xi, frame),
        })
    }

    /// Whether g is not linear along the edge.
    pub fn is_curved(&self) -> bool {
        self.edge.len() > 2 || self.segment.middle.is_some()
    }

    /// g at ξ.
    pub fn gap(&self, xi: &N) -> N {
        let Self { edge, segment, along, frame } = *self;
        let slave = frame.position(edge.iter().copied(), &Line::Edge(edge).values(xi));
        let master = Line::Segment(segment);
        let eta = master.coordinate(&slave, along, 0.5, frame);
        slave.minus(&frame.position(segment.nodes(), &master.values(&eta))).dot(&along.turned())
    }
}

/// Tributary length A_j and mortar weights W_ja of a point.
#[derive(Clone, Debug, Default)]
pub(super) struct Averages<N> {
    extent: Extent,
    weights: Vec<N>,
    /// ∫ φ ds [L]
    share: N,
    /// D [L²]
    depth: N,
    /// ∫ φ g² ds of what is closed [L³]
    squares: N,
    /// ∫ φ (−g) κ ds of what is closed [L²]
    leaning: N,
    /// Least gap of what a point next to a ridge overlaps, if nothing of it is closed [L]
    pub least: Option<N>,
}

impl<N: Number> Averages<N> {
    /// Resets the sums, for `nodes` nodes.
    pub fn clear(&mut self, nodes: usize, extent: Extent) {
        self.extent = extent;
        self.weights.clear();
        self.weights.resize(nodes, N::default());
        (self.share, self.depth, self.squares) = (N::default(), N::default(), N::default());
        (self.leaning, self.least) = (N::default(), None);
    }

    /// Weights of r.
    pub fn means(&self) -> impl Iterator<Item = N> {
        let size = match self.extent {
            Extent::All => &self.share,
            Extent::Closed => &self.depth,
        };
        self.weights.iter().map(|w| w.over(size))
    }

    /// A.
    pub fn length(&self) -> N {
        match self.extent {
            Extent::All => self.share.clone(),
            Extent::Closed if self.squares.value() > 0.0 => self.depth.times(&self.depth).over(&self.squares),
            Extent::Closed => N::default(),
        }
    }

    /// κ; none where everything counts
    pub fn lean(&self) -> Option<N> {
        (self.extent == Extent::Closed).then(|| self.leaning.over(&self.depth))
    }

    /// D/∫ φ ds of what is closed [L]
    pub fn mean_depth(&self) -> f64 {
        self.depth.value() / self.share.value()
    }

    /// Adds the integrals over a part of an edge that faces one segment.
    pub fn integrate(&mut self, facing: &Pieces<N>, hat: &[f64; 3], ends: [N; 2]) {
        let Pieces { edge, segment, along, frame } = *facing;
        let (half, middle) = (ends[1].minus(&ends[0]).scaled(0.5), ends[0].plus(&ends[1]).scaled(0.5));
        let points = match self.extent {
            _ if facing.is_curved() => 4,
            Extent::All => 2,
            // One more function is multiplied.
            Extent::Closed => 3,
        };
        let lean = (self.extent == Extent::Closed).then(|| lean(segment, along, frame));
        for (at, weight) in shape::gauss(points) {
            let xi = middle.plus(&half.scaled(at));
            let slave = Line::Edge(edge);
            let values = slave.values(&xi);
            let slope = slave.slope(&xi, frame);
            let (value, rate) = between_nodes(edge.len(), hat, xi.value());
            let position = frame.position(edge.iter().copied(), &values);
            let share = slope.dot(&slope).sqrt().times(&half.scaled(weight)).times(&xi.map(value, rate));
            let share = match frame.depth(&position) {
                Some(depth) => share.times(&depth),
                None => share,
            };
            let mut share = match oblique(segment, along, frame) {
                Some(factor) => share.times(&factor),
                None => share,
            };
            let master = Line::Segment(segment);
            let eta = master.coordinate(&position, along, 0.5, frame);
            let others = master.values(&eta);
            self.share.accumulate(1.0, &share);
            if let Some(lean) = &lean {
                let depth = frame.position(segment.nodes(), &others).minus(&position).dot(&along.turned());
                share = share.times(&depth);
                self.depth.accumulate(1.0, &share);
                self.squares.accumulate(1.0, &share.times(&depth));
                self.leaning.accumulate(1.0, &share.times(lean));
            }
            for (&node, value) in edge.iter().zip(&values) {
                self.weights[frame.local(node)].accumulate(1.0, &share.times(value));
            }
            for (node, value) in segment.nodes().zip(others) {
                self.weights[frame.local(node)].accumulate(-1.0, &share.times(&value));
            }
        }
    }
}
