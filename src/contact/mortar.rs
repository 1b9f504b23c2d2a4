//! Mortar contact: gap and slip averaged around each slave node or along each quadratic slave edge, integrated segment by segment.
//!
//! The multiplier is λ = Σ φ_j t_j, Σ φ_j = 1, with the functions of `hats.rs`, linear from node to node of the slave.
//!
//! Each slave edge is divided at the projections of master nodes along its own normal, and at its middle node; in between, all
//! functions are smooth, and Gauss quadrature integrates
//!
//! ```text
//! A_j = ∫ φ_j ds,   W_ja = ∫ φ_j N_a ds (slave nodes),   −∫ φ_j N_a ds (master nodes)
//! r_j = Σ_a W_ja x_a / A_j            mean of x_slave − x_foot
//! g_j = n_j·r_j,   Δu_t,j = s_j·(r_j with the old weights − r_j)
//! f_a = −Σ_j W_ja t_j
//! ```
//!
//! n_j is the normal of the edges at the point, oriented into the slave: s_j is the direction of ∫ φ_j dx. Since Σ_j φ_j = 1, a
//! uniform pressure produces the exact forces on both sides: the patch test is passed. A node at a corner of more than 45°
//! counts as one point per side. All variations are computed with dual numbers.
//!
//! Edges against a rigid body are not divided, see below.
//!
//! Averages around a point define its projection on the master.
//!
//! For a rigid body nothing is divided. g_j and Δu_t,j are means over the Gauss points between two nodes, each with its own
//! projection, and n_j is the direction of the mean of their normals. One function sums all values with their variations.

use nalgebra::Vector2;
use rayon::prelude::*;

use super::averages::{Averages, Extent, Pieces};
use super::dual::{COORDINATES, DualVector, Number, PositionDual};
pub use super::hats::Hats;
use super::hats::{Part, centre, gauss_around, parts};
use super::kinematics::{Kinematics, Lever, Meeting, past_rigid};
use super::master::{Master, Rigid};
pub use super::mortar_segments::Overlaps;
use super::mortar_segments::{CutEdge, Frame, Overlap, between_nodes};
use super::point::{LengthShare, MasterPoint, SlavePoint, Weights, lone_point};
use super::projection::{Projection, tangent_of};
use super::ridges::{self, Corners, Ridges};
use super::search::{Index, KeptSearch};
use super::surface::{Segment, Surface};
use crate::mesh::{Configuration, Section};

/// The slave side: its edges, and the edges at each contact point.
#[derive(Clone, Debug, PartialEq)]
pub struct Mortar {
    /// Edges (start, end[, middle]), the body on their left
    pub edges: Vec<Vec<usize>>,
    /// Largest depth of each behind a master segment that it may be in contact with: half the thickness of its body [L]
    pub depths: Vec<f64>,
    /// What each point has of its edges
    at: Vec<Vec<Part>>,
    /// Gauss points around each point, with their lengths multiplied by φ_j
    around: Vec<Vec<SlavePoint>>,
    /// Corners that may enter first
    pub(super) corners: Corners,
}

/// Weights of all points in the committed configuration; constant during the iterations of an increment.
#[derive(Clone, Debug, Default)]
pub struct Committed {
    section: Section,
    /// X and u of all nodes on both sides
    places: Vec<(usize, [Vector2<f64>; 2])>,
    search: KeptSearch,
    overlaps: Overlaps,
    /// Corners that enter first
    ridges: Ridges,
    /// Buffers, each for several points
    rooms: Vec<Room>,
    /// Weights of each point, empty without a projection on the master
    weights: Vec<Weights>,
}

impl Committed {
    /// Corners that enter first.
    pub fn ridges(&self) -> &Ridges {
        &self.ridges
    }

    /// Weights of a point, if it has a projection on the master.
    pub fn weights(&self, point: usize) -> Option<&Weights> {
        self.weights.get(point).filter(|weights| !weights.is_empty())
    }
}

/// Number of points whose committed weights one thread computes at a time.
const TOGETHER: usize = 64;

/// Contact points of slave edges: their nodes, on quadratic edges those that have `hats`; each side of a corner is a separate point.
pub fn mortar_points(edges: &[Vec<usize>], hats: Hats, positions: &[Vector2<f64>]) -> (Vec<SlavePoint>, Mortar) {
    let at = parts(edges, hats, positions);
    let around = |of: &Vec<Part>| of.iter().flat_map(|part| gauss_around(&edges[part.edge], &part.hat)).collect();
    let around: Vec<Vec<SlavePoint>> = at.iter().map(around).collect();
    let shares = |around: &[SlavePoint]| around.iter().flat_map(|point| point.length.clone()).collect();
    let point = |(of, around): (&Vec<Part>, &Vec<SlavePoint>)| SlavePoint {
        length: shares(around),
        position: centre(of, hats, edges),
        ..lone_point(edges[of[0].edge][of[0].node], 0.0)
    };
    let points = at.iter().zip(&around).map(point).collect();
    let (depths, corners) = (vec![f64::INFINITY; edges.len()], Corners::default());
    (points, Mortar { depths, edges: edges.to_vec(), at, around, corners })
}

impl Mortar {
    /// Computes the weights of all points in the configuration `x`, unless they are available already.
    pub fn commit(&self, master: &Master, surface: &Surface, x: &Configuration, committed: &mut Committed) {
        let segments = || surface.segments.iter().flat_map(Segment::nodes);
        let nodes = || self.edges.iter().flatten().copied().chain(segments());
        let places = || nodes().map(|node| (node, x.split(&[(node, 1.0)], Vector2::zeros())));
        let Committed { section, places: kept, search, overlaps, ridges, rooms, weights } = committed;
        if *section == x.section() && weights.len() == self.at.len() && places().eq(kept.iter().copied()) {
            return;
        }
        *section = x.section();
        kept.clear();
        kept.extend(places());
        self.cut(surface, &Index::kept(master, [x, x], search), [x, x], overlaps);
        *ridges = self.ridges(surface, overlaps, x);
        weights.resize_with(self.at.len(), Weights::default);
        rooms.resize_with(self.at.len().div_ceil(TOGETHER), Room::default);
        let parts = weights.par_chunks_mut(TOGETHER).zip(rooms).enumerate();
        parts.for_each(|(part, (weights, room))| {
            let facing = self.facing(surface, overlaps, ridges);
            weights.iter_mut().enumerate().for_each(|(k, weights)| facing.weigh(TOGETHER * part + k, x, room, weights));
        });
    }

    /// Divides all slave edges into mortar segments in the second configuration; the first is the committed one.
    pub fn cut(&self, surface: &Surface, index: &Index, x: [&Configuration; 2], overlaps: &mut Overlaps) {
        overlaps.0.resize_with(self.edges.len(), CutEdge::default);
        let edges = self.edges.par_iter().zip(&self.depths).zip(&mut overlaps.0);
        edges.for_each(|((edge, &depth), cut)| cut.cut(edge, depth, surface, index, x));
    }

    /// Whether either side has corners that may enter first.
    pub fn has_corners(&self) -> bool {
        self.corners != Corners::default()
    }

    /// Whether the master has corners that may enter first.
    pub fn has_corners_of_master(&self) -> bool {
        self.corners.are_of_master()
    }

    /// Corners that enter first, given the slave edges as cut in a configuration.
    pub fn ridges(&self, surface: &Surface, overlaps: &Overlaps, x: &Configuration) -> Ridges {
        self.corners.entering(&self.edges, surface, overlaps, x)
    }

    /// The ridge that is nearest to a place in a configuration: its distance [L], and the slope of its flanks.
    pub fn nearest_ridge(
        &self,
        master: &Master,
        surface: &Surface,
        at: Vector2<f64>,
        x: &Configuration,
    ) -> Option<(f64, f64)> {
        if !self.has_corners() {
            return None;
        }
        let mut overlaps = Overlaps::default();
        self.cut(surface, &Index::new(master, x), [x, x], &mut overlaps);
        self.corners.nearest(&self.ridges(surface, &overlaps, x), at, x)
    }

    /// The slave edges as they face a mesh surface, cut in some configuration, with the ridges of the committed one.
    pub fn facing<'a>(&'a self, surface: &'a Surface, overlaps: &'a Overlaps, ridges: &'a Ridges) -> Facing<'a> {
        Facing { mortar: self, surface, overlaps, ridges }
    }
}

/// Slave edges, the mesh surface that they face, and the cuts between the two.
#[derive(Clone, Copy, Debug)]
pub struct Facing<'a> {
    mortar: &'a Mortar,
    surface: &'a Surface,
    overlaps: &'a Overlaps,
    ridges: &'a Ridges,
}

impl Facing<'_> {
    /// Projection of a mortar point on the master and its kinematics; `None` without a projection. `old` are its weights in the
    /// committed configuration.
    pub fn meet(
        &self,
        point: usize,
        old: Option<&Weights>,
        x: &Configuration,
        k: &mut Kinematics,
        room: &mut Room,
    ) -> Option<Meeting> {
        match k.varied {
            true => self.meet_by(point, old, x, k, &mut room.duals),
            false => self.meet_by(point, old, x, k, &mut room.values),
        }
    }

    /// [`Facing::meet`] in numbers with or without variations.
    fn meet_by<N: Number>(
        &self,
        point: usize,
        old: Option<&Weights>,
        x: &Configuration,
        k: &mut Kinematics,
        room: &mut Averaging<N>,
    ) -> Option<Meeting> {
        let master_point = self.master_point(point)?;
        let nodes = &mut room.frame.nodes;
        self.list(point, nodes);
        for &(node, _) in old.into_iter().flatten() {
            if !nodes.contains(&node) {
                nodes.push(node);
            }
        }
        let (unknowns, mut gap) = (if k.varied { 2 * nodes.len() } else { 1 }, 0.0);
        for first in (0..unknowns).step_by(COORDINATES) {
            room.frame.place(x, first);
            let place = self.mean_place(point, old, room)?;
            if first == 0 {
                gap = place.gap.value();
                place.write(k);
            }
            place.write_variations(first, k);
        }
        Some(Meeting { gap, master_point })
    }

    /// Mean projection of a point whose nodes are placed.
    fn mean_place<'a, N: Number>(
        &self,
        point: usize,
        old: Option<&Weights>,
        room: &'a mut Averaging<N>,
    ) -> Option<MeanPlace<'a, N>> {
        let Averaging { frame, averages, relative } = room;
        if !self.average(point, frame, averages) {
            return None;
        }
        let along = self.mortar.along(point, frame);
        let (s, n) = (along.clone(), along.turned());
        relative.clear();
        relative.extend(averages.means());
        let mean = frame.combine(relative);
        let gap = averages.least.clone().unwrap_or_else(|| n.dot(&mean));
        let mut slip = N::constant(0.0);
        if let Some(old) = old {
            let mut moved = DualVector::default();
            for &(node, w) in old {
                moved.add_scaled(&N::constant(w), &frame.positions[frame.local(node)]);
            }
            slip = s.dot(&moved.minus(&mean));
        }
        let length = averages.length().scaled(self.surface.share());
        let lean = averages.lean().filter(|_| self.is_at_ridge(point));
        Some(MeanPlace { nodes: &frame.nodes, relative, gap, slip, length, lean, axes: [s, n] })
    }

    /// Computes the weights of r_j in a configuration in place of `found`; empty without a projection on the master.
    pub fn weigh(&self, point: usize, x: &Configuration, room: &mut Room, found: &mut Weights) {
        let Averaging { frame, averages, .. } = &mut room.values;
        self.list(point, &mut frame.nodes);
        frame.place(x, 0);
        found.clear();
        if self.average(point, frame, averages) {
            found.extend(frame.nodes.iter().copied().zip(averages.means()));
        }
    }

    /// Overlaps of the edges of a point that were no more than an edge's length farther than the nearest when the increment began:
    /// what lies farther behind an end or a step of the master carries nothing, and must not hold the mean gap open.
    fn near(&self, point: usize) -> impl Iterator<Item = (&Part, &Overlap)> {
        let parts = &self.mortar.at[point];
        let all = move || parts.iter().flat_map(|p| self.overlaps.0[p.edge].overlaps.iter().map(move |o| (p, o)));
        let reach = all().map(|(_, overlap)| overlap.reach).fold(f64::INFINITY, f64::min);
        all().filter(move |(_, overlap)| overlap.gap <= reach)
    }

    /// Overlapping segment nearest to a point along its edges.
    fn master_point(&self, point: usize) -> Option<MasterPoint> {
        let all = self.near(point).map(|(part, overlap)| (overlap, NODE_AT[part.node]));
        let away = |o: &Overlap, at: f64| (at - at.clamp(o.ends[0].xi, o.ends[1].xi)).abs();
        let (nearest, at) = all.min_by(|a, b| away(a.0, a.1).total_cmp(&away(b.0, b.1)))?;
        // Master and slave have the same direction along s.
        let [start, end] = nearest.ends.map(|cut| cut.xi);
        let xi = ((at - start) / (end - start)).clamp(0.0, 1.0);
        Some(MasterPoint { segment: nearest.segment, xi })
    }

    /// Lists all nodes that participate in the average at a point.
    fn list(&self, point: usize, nodes: &mut Vec<usize>) {
        nodes.clear();
        let Mortar { edges, at, .. } = self.mortar;
        let parts = || self.near(point).map(|(_, overlap)| overlap);
        let slaves = at[point].iter().flat_map(|part| edges[part.edge].iter().copied());
        let masters = parts().flat_map(|o| self.surface.segments[o.segment].nodes());
        let cuts = parts().flat_map(|o| o.ends.iter().filter_map(|cut| cut.node));
        for node in slaves.chain(masters).chain(cuts) {
            if !nodes.contains(&node) {
                nodes.push(node);
            }
        }
    }

    /// Computes the average at a point in `averages`, next to a ridge over what is closed (`ridges.rs`); returns whether the master overlaps
    /// enough of its edges.
    fn average<N: Number>(&self, point: usize, frame: &Frame<N>, averages: &mut Averages<N>) -> bool {
        let parts = &self.mortar.at[point];
        let chord = |part: &Part| {
            let edge = &self.mortar.edges[part.edge];
            let chord = frame.at(edge[1]).minus(frame.at(edge[0]));
            chord.dot(&chord).value().sqrt()
        };
        let depth = |node: usize| frame.depth(frame.at(node)).map_or(1.0, |depth| depth.value());
        let depths = |part: &Part| self.mortar.edges[part.edge][..2].iter().map(|&node| depth(node)).sum::<f64>();
        let whole: f64 = parts.iter().map(|part| chord(part) * 0.5 * depths(part)).sum();
        let mut least = None;
        if self.has_ridge(point) {
            least = self.integrate(point, Extent::Closed, frame, averages);
            let is_deep = averages.mean_depth() > NEGLIGIBLE * chord(&parts[0]);
            if is_deep && averages.length().value() > NEGLIGIBLE * whole {
                return true;
            }
        }
        self.integrate(point, Extent::All, frame, averages);
        averages.least = least.filter(|gap| gap.value() > 0.0);
        averages.length().value() > NEGLIGIBLE * whole
    }

    /// Whether a point is next to a ridge of the slave.
    fn is_at_ridge(&self, point: usize) -> bool {
        let edges = &self.mortar.edges;
        self.near(point).any(|(part, _)| self.ridges.are_at(part, &edges[part.edge]))
    }

    /// Whether a point is next to a ridge, or faces one.
    fn has_ridge(&self, point: usize) -> bool {
        let Self { mortar: Mortar { edges, .. }, ridges, surface, .. } = self;
        let is_next = |(part, overlap): (&Part, &Overlap)| {
            ridges.are_at(part, &edges[part.edge]) || ridges.are_faced(surface.segments[overlap.segment].ends)
        };
        !ridges.is_empty() && self.near(point).any(is_next)
    }

    /// Sums the integrals at a point in `averages`; returns the least gap of its overlaps if only what is closed counts.
    fn integrate<N: Number>(
        &self,
        point: usize,
        extent: Extent,
        frame: &Frame<N>,
        averages: &mut Averages<N>,
    ) -> Option<N> {
        averages.clear(frame.nodes.len(), extent);
        let mut least: Option<N> = None;
        for &Part { edge: e, ref hat, .. } in &self.mortar.at[point] {
            let edge = &self.mortar.edges[e];
            let along = frame.at(edge[1]).minus(frame.at(edge[0])).normalized();
            for (_, overlap) in self.near(point).filter(|(part, _)| part.edge == e) {
                let facing = Pieces { edge, segment: &self.surface.segments[overlap.segment], along: &along, frame };
                let ends = facing.ends(overlap);
                if extent == Extent::All {
                    averages.integrate(&facing, hat, ends);
                    continue;
                }
                if between_nodes(edge.len(), hat, overlap.middle()).0 == 0.0 {
                    continue;
                }
                let gaps = ends.each_ref().map(|xi| facing.gap(xi));
                let middle = facing.is_curved().then(|| facing.gap(&ends[0].plus(&ends[1]).scaled(0.5)));
                let closed = match &middle {
                    Some(middle) => ridges::closed_parts(ends, [&gaps[0], middle, &gaps[1]]),
                    None => [ridges::closed(ends, &gaps), None],
                };
                let all = gaps.into_iter().chain(middle).chain(least.take());
                least = all.min_by(|a, b| a.value().total_cmp(&b.value()));
                closed.into_iter().flatten().for_each(|ends| averages.integrate(&facing, hat, ends));
            }
        }
        least
    }
}

/// Smallest overlapping fraction of the edges for which a point counts as in contact, and smallest mean depth next to a ridge in lengths of its
/// edge: the mean over a sliver is dominated by round-off.
const NEGLIGIBLE: f64 = 1e-9;

/// ξ of the nodes of an edge: its ends, then its middle.
const NODE_AT: [f64; 3] = [-1.0, 1.0, 0.0];

/// Buffer for the averages at one point after another.
#[derive(Clone, Debug, Default)]
pub struct Room {
    values: Averaging<f64>,
    duals: Averaging<PositionDual>,
    /// Kinematics of a Gauss point against a rigid body, and the variations of the mean normal
    around: Kinematics,
    turns: [Vec<f64>; 2],
}

/// Frame of an average, with its weights.
#[derive(Clone, Debug, Default)]
struct Averaging<N> {
    frame: Frame<N>,
    averages: Averages<N>,
    /// W_ja/A_j
    relative: Vec<N>,
}

/// Mean projection of a slave node on the master.
struct MeanPlace<'a, N> {
    pub nodes: &'a [usize],
    /// W_ja/A_j
    pub relative: &'a [N],
    pub gap: N,
    pub slip: N,
    pub length: N,
    /// κ
    pub lean: Option<N>,
    /// s and n
    pub axes: [DualVector<N>; 2],
}

impl<N: Number> MeanPlace<'_, N> {
    /// Writes it to the kinematics of the point, with room for its variations on request.
    pub fn write(&self, k: &mut Kinematics) {
        let Self { nodes, relative, slip, length, lean, axes: [s, n], .. } = self;
        k.begin(Vector2::new(n.x.value(), n.y.value()));
        k.nodes.extend_from_slice(nodes);
        k.clear();
        k.tangent = Vector2::new(s.x.value(), s.y.value());
        (k.slip, k.length) = (slip.value(), length.value());
        k.lean = lean.as_ref().map_or(0.0, Number::value);
        k.relative.iter_mut().zip(*relative).for_each(|(value, w)| *value = w.value());
        k.changing.extend((0..relative.len()).filter(|_| k.varied));
        k.drelative.resize(k.changing.len() * k.dgap.len(), 0.0);
    }

    /// Writes its variations with the unknowns from number `first` on.
    pub fn write_variations(&self, first: usize, k: &mut Kinematics) {
        let Self { relative, gap, slip, length, lean, axes: [s, _], .. } = self;
        let set = |row: &mut [f64], d: &N| row[first..].iter_mut().zip(d.gradient()).for_each(|(to, by)| *to = *by);
        set(&mut k.dgap, gap);
        set(&mut k.dslip, slip);
        set(&mut k.dlength, length);
        lean.iter().for_each(|lean| set(&mut k.dlean, lean));
        let turns = k.drotation.iter_mut().skip(first).zip(s.x.gradient().iter().zip(s.y.gradient()));
        turns.for_each(|(turn, (dx, dy))| *turn = dx * k.normal.x + dy * k.normal.y);
        let rows = k.drelative.chunks_exact_mut(k.dgap.len().max(1));
        rows.zip(*relative).for_each(|(row, w)| set(row, w));
    }
}

/// Sums of ℓ and of ℓ times gap, slip and n.
#[derive(Default)]
struct Sums {
    length: f64,
    gap: f64,
    slip: f64,
    along: Vector2<f64>,
    /// Lever of a moving rigid body
    arm: Vector2<f64>,
    master_point: Option<MasterPoint>,
}

impl Mortar {
    /// s_j: mean direction ∫ φ_j dx of the edges at a point.
    fn along<N: Number>(&self, point: usize, frame: &Frame<N>) -> DualVector<N> {
        let mut sum = DualVector::default();
        for LengthShare { factor, tangent, .. } in self.around[point].iter().flat_map(|at| &at.length) {
            for &(node, slope) in tangent {
                sum.add_scaled(&N::constant(factor * slope), frame.at(node));
            }
        }
        sum.normalized()
    }

    /// Projection of a mortar point on a rigid body and its kinematics; `None` if no Gauss point has a projection. The
    /// configurations are the committed and the trial one.
    pub fn meet_rigid(
        &self,
        point: usize,
        rigid: &Rigid,
        [before, x]: [&Configuration; 2],
        mean: &mut Kinematics,
        room: &mut Room,
    ) -> Option<Meeting> {
        let around = &self.around[point];
        let meet = |slave: &SlavePoint, k: &mut Kinematics| meet(slave, rigid, [before, x], k);
        let Room { around: k, turns, .. } = room;
        k.varied = mean.varied;
        mean.begin(Vector2::zeros());
        for slave in around {
            if meet(slave, k).is_some() {
                mean.list(k.nodes.iter().copied());
            }
        }
        mean.clear();
        let dofs = mean.dgap.len();
        mean.changing.extend((0..mean.nodes.len()).filter(|_| mean.varied));
        mean.drelative.resize(mean.changing.len() * dofs, 0.0);
        mean.dlever.iter_mut().for_each(|row| row.resize(dofs, 0.0));
        let mut sums = Sums::default();
        turns.iter_mut().for_each(|turn| *turn = zeros(std::mem::take(turn), dofs));
        for slave in around {
            if let Some(projection) = meet(slave, k) {
                sums.master_point.get_or_insert(projection.master_point);
                sums.add(k, projection.gap, mean, turns);
            }
        }
        let Sums { length, gap, slip, along, arm, master_point } = sums;
        let master_point = master_point?;
        mean.normal = along.normalize();
        mean.tangent = tangent_of(mean.normal);
        (mean.length, mean.slip) = (length, slip / length);
        let turning = rigid.body.as_ref().and_then(|body| mean.nodes.iter().position(|node| *node == body.turning));
        mean.lever = turning.map(|at| Lever { at, arm: arm / length });
        let Kinematics { relative, dgap, dslip, drotation, dlength, drelative, dlever, tangent, .. } = mean;
        let vary = |row: &mut [f64], mean: f64| {
            row.iter_mut().zip(&*dlength).for_each(|(rate, dlength)| *rate = (*rate - dlength * mean) / length);
        };
        vary(dgap, gap / length);
        vary(dslip, slip / length);
        dlever.iter_mut().zip(arm.iter()).for_each(|(row, arm)| vary(row, arm / length));
        relative.iter_mut().for_each(|w| *w /= length);
        if dofs > 0 {
            drelative.chunks_exact_mut(dofs).zip(&*relative).for_each(|(row, w)| vary(row, *w));
        }
        let rates = drotation.iter_mut().zip(turns[0].iter().zip(&turns[1]));
        rates.for_each(|(turn, (dx, dy))| *turn = -(dx * tangent.x + dy * tangent.y) / along.norm());
        Some(Meeting { gap: gap / length, master_point })
    }
}

impl Sums {
    /// Adds a Gauss point; its weights and variations to those of the `mean`, those of n to the `turns`.
    fn add(&mut self, k: &Kinematics, gap: f64, mean: &mut Kinematics, turns: &mut [Vec<f64>; 2]) {
        let Kinematics { nodes, relative, dgap, dslip, dlength, drelative, dlever, .. } = mean;
        let local = |node: usize| nodes.iter().position(|other| *other == node).unwrap_or_default();
        let add = |sum: &mut [f64], factor: f64, row: &[f64]| {
            for (dof, value) in row.iter().enumerate() {
                sum[2 * local(k.nodes[dof / 2]) + dof % 2] += factor * value;
            }
        };
        self.length += k.length;
        self.gap += k.length * gap;
        self.slip += k.length * k.slip;
        self.along += k.length * k.normal;
        add(dlength, 1.0, &k.dlength);
        for (sum, value, row) in [(&mut *dgap, gap, &k.dgap), (&mut *dslip, k.slip, &k.dslip)] {
            add(sum, value, &k.dlength);
            add(sum, k.length, row);
        }
        for (sum, n, s) in [(0, k.normal.x, k.tangent.x), (1, k.normal.y, k.tangent.y)] {
            add(&mut turns[sum], n, &k.dlength);
            add(&mut turns[sum], -k.length * s, &k.drotation);
        }
        if let Some(Lever { arm, .. }) = k.lever {
            self.arm += k.length * arm;
            for (i, row) in dlever.iter_mut().enumerate() {
                add(row, arm[i], &k.dlength);
                add(row, k.length, &k.dlever[i]);
            }
        }
        let dofs = dgap.len();
        for (&node, &w) in k.nodes.iter().zip(&k.relative) {
            let at = local(node);
            relative[at] += k.length * w;
            if k.varied {
                add(&mut drelative[dofs * at..dofs * (at + 1)], w, &k.dlength);
            }
        }
    }
}

/// `count` zeros in the memory of another list.
fn zeros(mut values: Vec<f64>, count: usize) -> Vec<f64> {
    values.clear();
    values.resize(count, 0.0);
    values
}

/// Projection of one Gauss point on the body.
fn meet(slave: &SlavePoint, rigid: &Rigid, [before, x]: [&Configuration; 2], k: &mut Kinematics) -> Option<Projection> {
    let projection = rigid.project(slave, x)?;
    let from = rigid.project(slave, before).map(|was| was.master_point);
    past_rigid(slave, rigid, &projection, from, x, k);
    if from.is_none() {
        k.count_from(rigid.body.as_ref(), before, x);
    }
    Some(projection)
}
