//! Mortar contact: gap and slip averaged around each slave node, integrated segment by segment.
//!
//! The multiplier λ = Σ φ_j t_j is linear from node to node of the slave. (On a quadratic edge the shape functions N_j of the
//! ends are negative in part: the mean gap under them would not be one, and forces would ripple as nodes go by.) Each slave edge
//! is cut where master nodes project on it along its own normal, and at its middle node; between two cuts all functions are
//! smooth, and Gauss's rule integrates
//!
//! ```text
//! A_j = ∫ φ_j ds,   W_ja = ∫ φ_j N_a ds (slave nodes),   −∫ φ_j N_a ds (master nodes)
//! r_j = Σ_a W_ja x_a / A_j            mean of x_slave − x_foot
//! g_j = n_j·r_j,   Δu_t,j = s_j·(r_j with the old weights − r_j)
//! f_a = −Σ_j W_ja t_j
//! ```
//!
//! n_j is the normal of the edges at the node, turned into the slave: s_j is the direction of ∫ φ_j dx. Since Σ_j φ_j = 1, a
//! uniform pressure puts on both sides exactly what it should: the patch test is passed. The nodes at a corner of more than 45°
//! count once a side.
//! All variations come with [`Dual`] numbers.
//!
//! Against a rigid body nothing is cut: g_j and Δu_t,j are the means of what the points of Gauss's rule between two nodes
//! have, each with its own foot, and n_j is the direction of the mean of their normals.

use nalgebra::{DVector, Vector2};
use rayon::prelude::*;

use super::dual::{Dual, DualVector};
use super::force::Meeting;
use super::kinematics::{Kinematics, past_rigid};
use super::projection::{normal_of, tangent_of};
use super::rigid::Rigid;
use super::search::Index;
use super::surface::{CORNER, LengthShare, MasterPoint, Segment, SlavePoint, Surface, Weights, edge_point, lone_point};
use crate::mesh::configuration::Configuration;
use crate::mesh::shape;

/// The slave side: its edges, and which of them meet at each contact point.
#[derive(Clone, Debug, PartialEq)]
pub struct Mortar {
    /// Edges (start, end[, middle]), the body on their left
    edges: Vec<Vec<usize>>,
    /// Edges at each point, with the number of its shape function there
    at: Vec<Vec<(usize, usize)>>,
    /// Points of Gauss's rule around each point, their lengths times φ_j
    around: Vec<Vec<SlavePoint>>,
}

/// The nodes of the slave edges as contact points, each side of a corner a point of its own.
pub fn mortar_points(edges: &[Vec<usize>], positions: &[Vector2<f64>]) -> (Vec<SlavePoint>, Mortar) {
    let direction = |e: usize| (positions[edges[e][1]] - positions[edges[e][0]]).normalize();
    let mut nodes: Vec<usize> = Vec::new();
    let mut at: Vec<Vec<(usize, usize)>> = Vec::new();
    for (e, edge) in edges.iter().enumerate() {
        let local = if edge.len() == 3 { vec![0, 2, 1] } else { vec![0, 1] };
        for a in local {
            let joins = |k: &usize| {
                nodes[*k] == edge[a] && at[*k].iter().all(|&(other, _)| direction(other).dot(&direction(e)) > CORNER)
            };
            match (0..nodes.len()).rev().find(joins) {
                Some(k) => at[k].push((e, a)),
                None => {
                    nodes.push(edge[a]);
                    at.push(vec![(e, a)]);
                }
            }
        }
    }
    let around = |of: &Vec<(usize, usize)>| of.iter().flat_map(|&(e, a)| gauss_around(&edges[e], a)).collect();
    let around: Vec<Vec<SlavePoint>> = at.iter().map(around).collect();
    let shares = |around: &[SlavePoint]| around.iter().flat_map(|point| point.length.clone()).collect();
    let points =
        nodes.iter().zip(&around).map(|(&node, at)| SlavePoint { length: shares(at), ..lone_point(node, 0.0) });
    (points.collect(), Mortar { edges: edges.to_vec(), at, around })
}

/// φ_a at ξ on an edge of n nodes, and its derivative: linear from node to node.
fn hat(n: usize, a: usize, xi: f64) -> (f64, f64) {
    let (place, width) = ([-1.0, 1.0, 0.0][a], if n == 2 { 2.0 } else { 1.0 });
    let away: f64 = xi - place;
    match away.abs() < width {
        true => (1.0 - away.abs() / width, -away.signum() / width),
        false => (0.0, 0.0),
    }
}

/// The points of Gauss's rule between the nodes of an edge, that ∫ φ_a ds is the sum of their lengths.
fn gauss_around(edge: &[usize], a: usize) -> Vec<SlavePoint> {
    let parts: &[[f64; 2]] = if edge.len() == 2 { &[[-1.0, 1.0]] } else { &[[-1.0, 0.0], [0.0, 1.0]] };
    let points = |&[start, end]: &[f64; 2]| {
        let half = 0.5 * (end - start);
        shape::gauss(2).into_iter().map(move |(at, weight)| (start + half * (1.0 + at), half * weight))
    };
    let all = parts.iter().flat_map(points);
    all.map(|(xi, weight)| (xi, weight * hat(edge.len(), a, xi).0))
        .filter(|(_, weight)| *weight > 0.0)
        .map(|(xi, weight)| edge_point(edge, xi, weight))
        .collect()
}

/// A part of a slave edge that one master segment faces.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Overlap {
    segment: usize,
    ends: [Cut; 2],
}

/// Where a slave edge is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cut {
    xi: f64,
    /// The master node that projects there; none at the ends of the edge
    node: Option<usize>,
}

/// The cuts of all slave edges in one configuration.
pub struct Overlaps(Vec<Vec<Overlap>>);

/// Master segments farther from a slave edge than this many of its lengths are not looked at: far enough for the deep
/// penetrations of first iterates, which must not pass for contact lost.
const REACH: f64 = 10.0;

/// A slave edge and a master segment face each other when the cosine between their outward normals is below this.
const EDGE_ON: f64 = -0.01;

impl Mortar {
    /// Cut all slave edges.
    pub fn overlaps(&self, surface: &Surface, index: &Index, x: &Configuration) -> Overlaps {
        Overlaps(self.edges.par_iter().map(|edge| cut(edge, surface, index, x)).collect())
    }

    /// Where a point meets the master; `None` where none faces it. `old` are its weights in the committed
    /// configuration.
    pub fn kinematics(
        &self,
        point: usize,
        surface: &Surface,
        overlaps: &Overlaps,
        old: Option<&Weights>,
        x: &Configuration,
    ) -> Option<Meeting> {
        let foot = self.foot(point, overlaps)?;
        let mut nodes = self.nodes(point, surface, overlaps);
        for &(node, _) in old.into_iter().flatten() {
            if !nodes.contains(&node) {
                nodes.push(node);
            }
        }
        let frame = Frame::new(nodes, true, x);
        let Averages { weights, length } = self.averages(point, surface, overlaps, &frame)?;
        let along = self.along(point, &frame);
        let (s, n) = (along.clone(), along.turned());
        let relative: Vec<Dual> = weights.iter().map(|w| w / &length).collect();
        let mean = frame.combine(&relative);
        let gap = n.dot(&mean);
        let mut slip = Dual::constant(0.0);
        if let Some(old) = old {
            let mut moved = DualVector::default();
            for &(node, w) in old {
                moved.add_scaled(&Dual::constant(w), &frame.positions[frame.local(node)]);
            }
            slip = s.dot(&moved.minus(&mean));
        }
        let vector = |d: &Dual| {
            if d.gradient.is_empty() {
                DVector::zeros(2 * frame.nodes.len())
            } else {
                DVector::from_vec(d.gradient.clone())
            }
        };
        let (normal, tangent) = (Vector2::new(n.x.value, n.y.value), Vector2::new(s.x.value, s.y.value));
        let kinematics = Kinematics {
            relative: relative.iter().map(|w| w.value).collect(),
            normal,
            tangent,
            slip: slip.value,
            length: surface.share() * length.value,
            dgap: vector(&gap),
            dslip: vector(&slip),
            drotation: vector(&s.x) * normal.x + vector(&s.y) * normal.y,
            dlength: vector(&length) * surface.share(),
            drelative: relative.iter().map(vector).enumerate().collect(),
            nodes: frame.nodes,
        };
        Some(Meeting { kinematics, gap: gap.value, foot })
    }

    /// Where a point meets a rigid body; `None` where that faces none of its surroundings. `before` is the committed
    /// configuration.
    pub fn on_rigid(&self, point: usize, body: &Rigid, before: &Configuration, x: &Configuration) -> Option<Meeting> {
        let met = self.around[point].iter().filter_map(|slave| {
            let projection = body.project(slave, x)?;
            let from = body.project(slave, before).map(|was| was.foot);
            let mut kinematics = past_rigid(slave, body, &projection, from, x);
            if from.is_none() {
                kinematics.count_from(before, x);
            }
            Some((projection, kinematics))
        });
        let met: Vec<_> = met.collect();
        let foot = met.first()?.0.foot;
        let mut nodes: Vec<usize> = Vec::new();
        for node in met.iter().flat_map(|(_, k)| &k.nodes) {
            if !nodes.contains(node) {
                nodes.push(*node);
            }
        }
        let zero = DVector::zeros(2 * nodes.len());
        // Sums of ℓ times gap, slip, n and weights, and their variations.
        let (mut length, mut gap, mut slip, mut along) = (0.0, 0.0, 0.0, Vector2::zeros());
        let [mut dlength, mut dgap, mut dslip, mut dx, mut dy] = [(); 5].map(|()| zero.clone());
        let mut weights = vec![0.0; nodes.len()];
        let mut dweights = vec![zero.clone(); nodes.len()];
        for (projection, k) in &met {
            let local: Vec<usize> =
                k.nodes.iter().filter_map(|node| nodes.iter().position(|other| other == node)).collect();
            let add = |sum: &mut DVector<f64>, factor: f64, row: &DVector<f64>| {
                for (dof, value) in row.iter().enumerate() {
                    sum[2 * local[dof / 2] + dof % 2] += factor * value;
                }
            };
            length += k.length;
            gap += k.length * projection.gap;
            slip += k.length * k.slip;
            along += k.length * k.normal;
            add(&mut dlength, 1.0, &k.dlength);
            for (sum, value, row) in [(&mut dgap, projection.gap, &k.dgap), (&mut dslip, k.slip, &k.dslip)] {
                add(sum, value, &k.dlength);
                add(sum, k.length, row);
            }
            for (sum, n, s) in [(&mut dx, k.normal.x, k.tangent.x), (&mut dy, k.normal.y, k.tangent.y)] {
                add(sum, n, &k.dlength);
                add(sum, -k.length * s, &k.drotation);
            }
            for (&at, &w) in local.iter().zip(&k.relative) {
                weights[at] += k.length * w;
                add(&mut dweights[at], w, &k.dlength);
            }
        }
        let normal = along.normalize();
        let tangent = tangent_of(normal);
        let mean = |value: f64, row: DVector<f64>| (value / length, (row - &dlength * (value / length)) / length);
        let ((gap, dgap), (slip, dslip)) = (mean(gap, dgap), mean(slip, dslip));
        let (relative, drelative): (Vec<f64>, Vec<_>) =
            weights.into_iter().zip(dweights).map(|(w, dw)| mean(w, dw)).unzip();
        let drotation = -(dx * tangent.x + dy * tangent.y) / along.norm();
        let drelative = drelative.into_iter().enumerate().collect();
        let kinematics =
            Kinematics { nodes, relative, normal, tangent, slip, length, dgap, dslip, drotation, dlength, drelative };
        Some(Meeting { kinematics, gap, foot })
    }

    /// Weights of r_j in a configuration; `None` where no master faces the point.
    pub fn weights(&self, point: usize, surface: &Surface, overlaps: &Overlaps, x: &Configuration) -> Option<Weights> {
        let frame = Frame::new(self.nodes(point, surface, overlaps), false, x);
        let Averages { weights, length } = self.averages(point, surface, overlaps, &frame)?;
        Some(frame.nodes.iter().zip(weights).map(|(&node, w)| (node, w.value / length.value)).collect())
    }

    /// The facing segment nearest to a point along its edges.
    fn foot(&self, point: usize, overlaps: &Overlaps) -> Option<MasterPoint> {
        let station = [-1.0, 1.0, 0.0];
        let all = self.at[point].iter().flat_map(|&(e, a)| overlaps.0[e].iter().map(move |o| (o, station[a])));
        let away = |o: &Overlap, at: f64| (at - at.clamp(o.ends[0].xi, o.ends[1].xi)).abs();
        let (nearest, at) = all.min_by(|a, b| away(a.0, a.1).total_cmp(&away(b.0, b.1)))?;
        // Master and slave run along s alike.
        let [start, end] = nearest.ends.map(|cut| cut.xi);
        let xi = ((at - start) / (end - start)).clamp(0.0, 1.0);
        Some(MasterPoint { segment: nearest.segment, xi })
    }

    /// All nodes that take part in the average at a point.
    fn nodes(&self, point: usize, surface: &Surface, overlaps: &Overlaps) -> Vec<usize> {
        let mut nodes = Vec::new();
        let edges = || self.at[point].iter().map(|&(e, _)| e);
        let slaves = edges().flat_map(|e| self.edges[e].iter().copied());
        let masters = edges().flat_map(|e| overlaps.0[e].iter().flat_map(|o| surface.segments[o.segment].nodes()));
        let cuts = edges().flat_map(|e| overlaps.0[e].iter().flat_map(|o| o.ends.iter().filter_map(|cut| cut.node)));
        for node in slaves.chain(masters).chain(cuts) {
            if !nodes.contains(&node) {
                nodes.push(node);
            }
        }
        nodes
    }

    /// s_j: mean direction ∫ φ_j dx of the edges at a point.
    fn along(&self, point: usize, frame: &Frame) -> DualVector {
        let mut sum = DualVector::default();
        for LengthShare { factor, tangent } in self.around[point].iter().flat_map(|at| &at.length) {
            for &(node, slope) in tangent {
                sum.add_scaled(&Dual::constant(factor * slope), frame.at(node));
            }
        }
        sum.normalized()
    }

    fn averages(&self, point: usize, surface: &Surface, overlaps: &Overlaps, frame: &Frame) -> Option<Averages> {
        let mut averages = Averages { weights: vec![Dual::default(); frame.nodes.len()], length: Dual::default() };
        let mut whole = 0.0;
        for &(e, a) in &self.at[point] {
            let edge = &self.edges[e];
            let chord = frame.at(edge[1]).minus(frame.at(edge[0]));
            whole += chord.dot(&chord).value.sqrt();
            let along = chord.normalized();
            for overlap in &overlaps.0[e] {
                averages.integrate(edge, a, overlap, &surface.segments[overlap.segment], &along, frame);
            }
        }
        (averages.length.value > NEGLIGIBLE * whole).then_some(averages)
    }
}

/// A point whose average is taken over less than this share of its edges is not in contact: the mean over a sliver is
/// lost in round-off.
const NEGLIGIBLE: f64 = 1e-9;

/// A_j and W_ja.
struct Averages {
    weights: Vec<Dual>,
    length: Dual,
}

impl Averages {
    /// Add the integrals over one overlap.
    fn integrate(
        &mut self,
        edge: &[usize],
        a: usize,
        overlap: &Overlap,
        segment: &Segment,
        along: &DualVector,
        frame: &Frame,
    ) {
        let ends = overlap.ends.map(|cut| match cut.node {
            None => Dual::constant(cut.xi),
            Some(node) => Line::Edge(edge).coordinate(frame.at(node), along, cut.xi, frame),
        });
        let (half, middle) = ((&ends[1] - &ends[0]).scaled(0.5), (&ends[0] + &ends[1]).scaled(0.5));
        let points = if edge.len() == 2 && segment.middle.is_none() { 2 } else { 4 };
        for (at, weight) in shape::gauss(points) {
            let xi = &middle + &half.scaled(at);
            let slave = Line::Edge(edge);
            let values = slave.values(&xi);
            let slope = slave.slope(&xi, frame);
            let (value, rate) = hat(edge.len(), a, xi.value);
            let share = &(&slope.dot(&slope).sqrt() * &half.scaled(weight)) * &xi.map(value, rate);
            let position = frame.position(edge.iter().copied(), &values);
            let master = Line::Segment(segment);
            let eta = master.coordinate(&position, along, 0.5, frame);
            self.length.accumulate(1.0, &share);
            for (&node, value) in edge.iter().zip(&values) {
                self.weights[frame.local(node)].accumulate(1.0, &(&share * value));
            }
            for (node, value) in segment.nodes().zip(master.values(&eta)) {
                self.weights[frame.local(node)].accumulate(-1.0, &(&share * &value));
            }
        }
    }
}

/// A slave edge, ξ from −1 to 1, or a master segment, ξ from 0 to 1.
#[derive(Clone, Copy)]
enum Line<'a> {
    Edge(&'a [usize]),
    Segment(&'a Segment),
}

impl Line<'_> {
    fn nodes(&self) -> Vec<usize> {
        match self {
            Self::Edge(edge) => edge.to_vec(),
            Self::Segment(segment) => segment.nodes().collect(),
        }
    }

    /// Shape functions, first and second derivatives, as numbers.
    fn shapes(&self, xi: f64) -> [Vec<f64>; 3] {
        let count = self.nodes().len();
        let (at, rate) = match self {
            Self::Edge(_) => (xi, 1.0),
            Self::Segment(_) => (2.0 * xi - 1.0, 2.0),
        };
        let scaled = |values: Vec<f64>, factor: f64| values.into_iter().map(|v| factor * v).collect::<Vec<_>>();
        let bend = if count == 2 { vec![0.0; 2] } else { vec![1.0, 1.0, -2.0] };
        [shape::edge_values(count, at), scaled(shape::edge_derivatives(count, at), rate), scaled(bend, rate * rate)]
    }

    fn values(&self, xi: &Dual) -> Vec<Dual> {
        let [values, slopes, _] = self.shapes(xi.value);
        values.into_iter().zip(slopes).map(|(value, slope)| xi.map(value, slope)).collect()
    }

    fn slope(&self, xi: &Dual, frame: &Frame) -> DualVector {
        let [_, slopes, bends] = self.shapes(xi.value);
        let slopes: Vec<Dual> = slopes.into_iter().zip(bends).map(|(slope, bend)| xi.map(slope, bend)).collect();
        frame.position(self.nodes().into_iter(), &slopes)
    }

    /// ξ where the line is level with a point, (x(ξ) − point)·along = 0, near `start`. One Newton step from the solution
    /// brings the exact variation.
    fn coordinate(&self, point: &DualVector, along: &DualVector, start: f64, frame: &Frame) -> Dual {
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
fn root(shapes: impl Fn(f64) -> [Vec<f64>; 3], levels: &[f64], start: f64) -> f64 {
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
struct Frame {
    nodes: Vec<usize>,
    positions: Vec<DualVector>,
}

impl Frame {
    fn new(nodes: Vec<usize>, variations: bool, x: &Configuration) -> Self {
        let n = if variations { 2 * nodes.len() } else { 0 };
        let position = |(k, &node): (usize, &usize)| {
            let at = x.between(nodes[0], node);
            DualVector { x: Dual::unknown(at.x, 2 * k, n), y: Dual::unknown(at.y, 2 * k + 1, n) }
        };
        Self { positions: nodes.iter().enumerate().map(position).collect(), nodes }
    }

    fn local(&self, node: usize) -> usize {
        self.nodes.iter().position(|&n| n == node).expect("every node of an average is listed when it is built")
    }

    fn at(&self, node: usize) -> &DualVector {
        &self.positions[self.local(node)]
    }

    fn position(&self, nodes: impl Iterator<Item = usize>, weights: &[Dual]) -> DualVector {
        let mut sum = DualVector::default();
        for (node, weight) in nodes.zip(weights) {
            sum.add_scaled(weight, self.at(node));
        }
        sum
    }

    fn combine(&self, weights: &[Dual]) -> DualVector {
        self.position(self.nodes.iter().copied(), weights)
    }
}

/// Cut one slave edge where master nodes project on it; of several segments that face a part the nearest counts.
fn cut(edge: &[usize], surface: &Surface, index: &Index, x: &Configuration) -> Vec<Overlap> {
    let along = x.between(edge[0], edge[1]);
    let reach = REACH * along.norm();
    let normal = -normal_of(along.normalize());
    let coordinate = |node: usize| {
        let levels: Vec<f64> = edge.iter().map(|&own| x.between(node, own).dot(&along)).collect();
        let chord = 2.0 * levels[0] / (levels[0] - levels[1]) - 1.0;
        root(|xi| Line::Edge(edge).shapes(xi), &levels, chord)
    };
    let mut candidates = Vec::new();
    for segment in index.around(edge, reach, x) {
        let [a, b] = surface.segments[segment].ends;
        // A segment is taken in nearly edge-on, where it faces next to nothing: the average must not jump as it turns.
        if normal_of(x.between(a, b).normalize()).dot(&normal) >= EDGE_ON {
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
            candidates.push(Overlap { segment, ends: [first, last] });
        }
    }
    let mut cuts: Vec<Cut> = candidates.iter().flat_map(|overlap| overlap.ends).collect();
    if edge.len() == 3 {
        cuts.push(Cut { xi: 0.0, node: None });
    }
    cuts.sort_by(|a, b| a.xi.total_cmp(&b.xi));
    let distance = |overlap: &Overlap, xi: f64| {
        let values = shape::edge_values(edge.len(), xi);
        let [a, b] = surface.segments[overlap.segment].ends;
        edge.iter()
            .zip(values)
            .map(|(&node, w)| w * x.between(a, node))
            .sum::<Vector2<f64>>()
            .dot(&normal_of(x.between(a, b).normalize()))
            .abs()
    };
    let mut overlaps: Vec<Overlap> = Vec::new();
    for pair in cuts.windows(2).filter(|pair| pair[0].xi < pair[1].xi) {
        let middle = 0.5 * (pair[0].xi + pair[1].xi);
        let facing = candidates.iter().filter(|overlap| overlap.ends[0].xi < middle && middle < overlap.ends[1].xi);
        let nearest = facing.min_by(|a, b| distance(a, middle).total_cmp(&distance(b, middle)));
        overlaps.extend(nearest.map(|overlap| Overlap { segment: overlap.segment, ends: [pair[0], pair[1]] }));
    }
    overlaps
}
