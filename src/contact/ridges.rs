//! Ridges in mortar: where a convex corner of either side enters the other one first, averages extend over what it has closed.
//!
//! The mean gap of all that a point φ_j overlaps stays open until a corner between two flanks that both face the other side is deep in it, by a
//! third of an edge between flanks of 45°. Points next to such a corner of the slave, and those that face one of the master, therefore bear what the
//! depth beside it amounts to,
//!
//! ```text
//! p_j A_j = α_n ∫ φ_j ⟨−g⟩ ds                          g: gap along the normal of the edge
//! ```
//! which grows without a jump from the touch of the corner on (`averages.rs`). Its potential ½ α_n ∫ φ_j ⟨−g⟩² ds changes with g, and g along n with the
//! motion d of the slave past a segment that is at an angle to the edge by
//!
//! ```text
//! δg = (n − κ s)·d                                     κ = n·τ/s·τ, τ: direction of the segment
//! ```
//! so that next to a ridge of the slave p acts along n − κ s, the normal of the master, with the mean of κ over what is closed. Under a ridge of the master,
//! where κ jumps from flank to flank, p acts along n, which is in balance as long as the ridge goes along n: past the slave energy is lost. The couple p κ g per length by which the turn of an
//! edge changes g as well is left out; it goes with the penetration. A uniform pressure still is exact, and forces act in pairs.
//! An open point has the least gap of what it overlaps. The corner of a block whose one side faces the other body and whose next does not is
//! no ridge: it rests on its whole side. Which corners are ridges is found where an increment begins, so that no iterate changes it.
//! Along quadratic edges and segments g is taken as quadratic between three places of an overlap, with up to two parts that are closed.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::dual::Number;
use super::hats::Part;
use super::mortar_segments::{Overlap, Overlaps};
use super::surface::{CORNER, Surface};
use crate::mesh::Configuration;

/// Cosine between a flank and what it faces from which on it belongs to a ridge. With a steeper flank the other one is so flat (8.6°) that the
/// corner enters by less than a twentieth of its length before the mean of that closes.
const FLANK: f64 = 0.15;

/// A convex corner of more than 45°.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Corner {
    node: usize,
    /// The edges or segments that meet there, the body on the left
    flanks: [usize; 2],
    /// Tangent of half the angle by which it turns: mean slope of the flanks against what they enter [-]
    slope: f64,
}

/// Convex corners of both sides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Corners {
    slave: Vec<Corner>,
    master: Vec<Corner>,
}

/// Nodes of corners that enter first, ascending.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ridges {
    slave: Vec<usize>,
    master: Vec<usize>,
}

impl Corners {
    /// Finds those of slave and master, with edges (start, end) that have the body on their left.
    pub fn of([slave, master]: [Vec<[usize; 2]>; 2], positions: &[Vector2<f64>]) -> Self {
        Self { slave: convex_corners(&slave, positions), master: convex_corners(&master, positions) }
    }

    /// Whether the master has any.
    pub fn are_of_master(&self) -> bool {
        !self.master.is_empty()
    }

    /// Those whose flanks both face the other side, in the configuration in which edges were cut.
    pub fn entering(&self, edges: &[Vec<usize>], surface: &Surface, overlaps: &Overlaps, x: &Configuration) -> Ridges {
        let is_flank = |edge: usize, overlap: &Overlap| {
            let along = |[start, end]: [usize; 2]| x.between(start, end).normalize();
            along(surface.segments[overlap.segment].ends).dot(&along([edges[edge][0], edges[edge][1]])) > FLANK
        };
        let slave = self.slave.iter().filter(|corner| {
            let [before, after] = corner.flanks;
            let faces = |edge: usize| overlaps.0[edge].overlaps.iter().any(|overlap| is_flank(edge, overlap));
            // What faces a flank may end before the corner, where the other side turns round it.
            let ends = overlaps.0[before].overlaps.last().is_some_and(|overlap| overlap.ends[1].xi > 0.0);
            let begins = overlaps.0[after].overlaps.first().is_some_and(|overlap| overlap.ends[0].xi < 0.0);
            ends && begins && faces(before) && faces(after)
        });
        let mut faced = vec![false; if self.master.is_empty() { 0 } else { surface.segments.len() }];
        if !faced.is_empty() {
            for (edge, cut) in overlaps.0.iter().enumerate() {
                let flanks = cut.overlaps.iter().filter(|overlap| is_flank(edge, overlap));
                flanks.for_each(|overlap| faced[overlap.segment] = true);
            }
        }
        let master = self.master.iter().filter(|corner| corner.flanks.iter().all(|&segment| faced[segment]));
        Ridges { slave: slave.map(|corner| corner.node).collect(), master: master.map(|corner| corner.node).collect() }
    }

    /// The ridge that is nearest to a place: its distance [L], and the slope of its flanks.
    pub fn nearest(&self, ridges: &Ridges, at: Vector2<f64>, x: &Configuration) -> Option<(f64, f64)> {
        let among = |corners: &'_ [Corner], nodes: &'_ [usize]| -> Option<(f64, f64)> {
            let entering = corners.iter().filter(|corner| nodes.binary_search(&corner.node).is_ok());
            let found = entering.map(|corner| ((x.at(corner.node) - at).norm(), corner.slope));
            found.min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let sides = [among(&self.slave, &ridges.slave), among(&self.master, &ridges.master)];
        sides.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

impl Ridges {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.slave.is_empty() && self.master.is_empty()
    }

    /// Whether a part of a point is next to a ridge of the slave.
    pub(super) fn are_at(&self, part: &Part, edge: &[usize]) -> bool {
        let [start, end, _] = part.hat;
        let has = |(hat, node): (f64, &usize)| hat > 0.0 && self.slave.binary_search(node).is_ok();
        [start, end].into_iter().zip(edge).any(has)
    }

    /// Whether a ridge of the master is an end of a segment.
    pub fn are_faced(&self, ends: [usize; 2]) -> bool {
        ends.iter().any(|node| self.master.binary_search(node).is_ok())
    }
}

/// Nodes at which edges (start, end), the body on their left, turn to the left by more than 45°; ascending.
fn convex_corners(edges: &[[usize; 2]], positions: &[Vector2<f64>]) -> Vec<Corner> {
    let along = |edge: usize| (positions[edges[edge][1]] - positions[edges[edge][0]]).normalize();
    let by_end: BTreeMap<usize, usize> = edges.iter().enumerate().map(|(k, edge)| (edge[1], k)).collect();
    let corner = |after: usize| {
        let node = edges[after][0];
        let before = *by_end.get(&node)?;
        let cosine = along(before).dot(&along(after));
        let turns = cosine <= CORNER && along(before).perp(&along(after)) > 0.0;
        turns.then(|| Corner { node, flanks: [before, after], slope: ((1.0 - cosine) / (1.0 + cosine)).sqrt() })
    };
    let mut corners: Vec<Corner> = (0..edges.len()).filter_map(corner).collect();
    corners.sort_by_key(|corner| corner.node);
    corners
}

/// The part of an overlap in which the surfaces overlap, given g at both ends and linear in between; `None` where they do not.
pub(super) fn closed<N: Number>([start, end]: [N; 2], gaps: &[N; 2]) -> Option<[N; 2]> {
    let zero = || {
        let share = gaps[0].over(&gaps[0].minus(&gaps[1]));
        start.plus(&share.times(&end.minus(&start)))
    };
    match gaps.each_ref().map(|gap| gap.value() < 0.0) {
        [true, true] => Some([start, end]),
        [true, false] => Some([start.clone(), zero()]),
        [false, true] => Some([zero(), end.clone()]),
        [false, false] => None,
    }
}

/// Discriminant over the square of the largest gap below which a quadratic gap touches zero, and does not cross it.
const TANGENT: f64 = 1e-12;

/// The parts of an overlap in which the surfaces overlap, given g at its start, middle and end, and quadratic in between:
/// g = c + b t + a t², 0 ≤ t ≤ 1.
pub(super) fn closed_parts<N: Number>([start, end]: [N; 2], [first, middle, last]: [&N; 3]) -> [Option<[N; 2]>; 2] {
    let c = first;
    let b = middle.scaled(4.0).minus(&first.scaled(3.0)).minus(last);
    let a = first.plus(last).minus(&middle.scaled(2.0)).scaled(2.0);
    let size = [first, middle, last].map(|gap| gap.value().abs()).into_iter().fold(0.0, f64::max);
    let discriminant = b.times(&b).minus(&a.times(c).scaled(4.0));
    let mut roots: Vec<N> = Vec::new();
    if discriminant.value() > TANGENT * size * size {
        // q/a and c/q, without cancellation
        let q = b.plus(&discriminant.sqrt().scaled(1f64.copysign(b.value()))).scaled(-0.5);
        let quotients = [(&q, &a), (c, &q)].into_iter().filter(|(_, divisor)| divisor.value() != 0.0);
        roots.extend(quotients.map(|(part, divisor)| part.over(divisor)));
    }
    roots.retain(|t| t.value() > 0.0 && t.value() < 1.0);
    roots.sort_by(|one, other| one.value().total_cmp(&other.value()));
    let cuts: Vec<f64> = [0.0].into_iter().chain(roots.iter().map(Number::value)).chain([1.0]).collect();
    let places = roots.iter().map(|t| start.plus(&t.times(&end.minus(&start))));
    let places: Vec<N> = [start.clone()].into_iter().chain(places).chain([end.clone()]).collect();
    let is_closed = |part: &usize| {
        let t = 0.5 * (cuts[*part] + cuts[part + 1]);
        c.value() + t * (b.value() + t * a.value()) < 0.0
    };
    let mut parts = (0..=roots.len()).filter(is_closed).map(|part| [places[part].clone(), places[part + 1].clone()]);
    [parts.next(), parts.next()]
}
