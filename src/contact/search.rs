//! Contact search: the nearest master segment that faces a slave point.

use std::borrow::Cow;

use nalgebra::Vector2;

use super::master::{Master, Rigid};
pub use super::projection::FACING;
use super::projection::{Bound, Projection, at_node, normal_of, on_curve, on_segment};
use super::segment_search::{Branch, SegmentSearch, bounding_box};
use super::segment_tree::SegmentTree;
use super::sight::{NormalTree, Sight};
use super::surface::{MasterPoint, Path, SlavePoint, Surface};
use crate::mesh::boxes::Box2;
use crate::mesh::configuration::Configuration;

/// Number of segments examined before a point counts as free. As the nearest come first, further ones do not face it.
const CANDIDATES: usize = 8;

/// Spatial index of the master at the current positions.
pub enum Index<'a, S: SegmentSearch = SegmentTree> {
    /// Segments of a mesh surface, their search, and the visibility in self-contact
    Mesh(&'a Surface, Cow<'a, S>, Option<Sight<'a>>),
    /// A rigid body, which needs no index
    Rigid(&'a Rigid),
}

/// What the search on a mesh surface keeps from one configuration to the next.
#[derive(Clone, Debug, Default)]
pub struct KeptSearch<S = SegmentTree> {
    segments: S,
    /// Normals of the segments, for self-contact
    normals: NormalTree,
}

impl<S: SegmentSearch> KeptSearch<S> {
    /// Updates it for the configuration `x` of an increment that began in `before`.
    fn update(&mut self, surface: &Surface, [before, x]: [&Configuration; 2]) {
        self.segments.update(surface, x);
        if surface.own_depth.is_some() {
            self.normals.update(surface, before);
        }
    }
}

impl<'a> Index<'a> {
    /// Indexes the master in the configuration `x`, O(N).
    pub fn new(master: &'a Master, x: &'a Configuration) -> Self {
        match master {
            Master::Rigid(body) => Self::Rigid(body),
            Master::Mesh(surface) => {
                let mut search = KeptSearch::default();
                search.update(surface, [x, x]);
                let sight = |depth| Sight::new(surface, depth, x, Cow::Owned(search.normals));
                Self::Mesh(surface, Cow::Owned(search.segments), surface.own_depth.map(sight))
            }
        }
    }
}

impl<'a, S: SegmentSearch> Index<'a, S> {
    /// Indexes the master in the configuration `x` of an increment that began in `before`, with what is kept of the search
    /// renewed only where it is no longer valid.
    pub fn kept(master: &'a Master, [before, x]: [&'a Configuration<'a>; 2], kept: &'a mut KeptSearch<S>) -> Self {
        match master {
            Master::Rigid(body) => Self::Rigid(body),
            Master::Mesh(surface) => {
                kept.update(surface, [before, x]);
                let KeptSearch { segments, normals } = kept;
                let sight = |depth| Sight::new(surface, depth, before, Cow::Borrowed(&*normals));
                Self::Mesh(surface, Cow::Borrowed(&*segments), surface.own_depth.map(sight))
            }
        }
    }

    /// Projection of a slave point, if a part of the master faces it; `from` is its projection at the start of the increment,
    /// if there was one.
    pub fn project(&self, slave: &SlavePoint, from: Option<MasterPoint>, x: &Configuration) -> Option<Projection> {
        let nearest = self.nearest(slave, from.map(|from| from.segment), x)?;
        match (self, from) {
            (Self::Mesh(surface, _, sight), Some(from))
                if nearest.bound == Bound::Segment
                    && nearest.gap < 0.0
                    && nearest.master_point.segment != from.segment =>
            {
                let outward = slave.outward(x);
                let viewer = sight.as_ref().and_then(|sight| sight.point(slave));
                let meets = |segment: usize| match (sight, &viewer) {
                    (Some(sight), Some(viewer)) => sight.may_meet(viewer, Branch::of(segment)),
                    _ => faces(surface, segment, outward, x),
                };
                Some(behind_ridge(slave, surface, nearest, from, meets, x))
            }
            _ => Some(nearest),
        }
    }

    /// Predicted projection of a point that alternates between two segments: their node, if they form a concave corner. The
    /// closest point is the node only in a strip as narrow as the penetration times the change of the normal, which Newton's
    /// method would step over from either side indefinitely.
    pub fn in_valley(&self, slave: &SlavePoint, [a, b]: [usize; 2], x: &Configuration) -> Option<Projection> {
        let Self::Mesh(surface, ..) = self else { return None };
        let [first, second] = if surface.next(a) == Some(b) { [a, b] } else { [b, a] };
        let direction = |segment: usize, xi: f64| x.combine(&surface.segments[segment].slope(xi));
        let is_valley =
            surface.next(first) == Some(second) && direction(first, 1.0).perp(&direction(second, 0.0)) > 0.0;
        is_valley.then(|| at_node(slave, surface, first, second, 1.0, x)).filter(|at| at.gap < 0.0)
    }

    /// Projection on the nearest segment, which may be searched from the segment `near`.
    fn nearest(&self, slave: &SlavePoint, near: Option<usize>, x: &Configuration) -> Option<Projection> {
        match self {
            Self::Rigid(body) => body.project(slave, x),
            Self::Mesh(surface, segments, sight) => {
                if let Some(sight) = sight {
                    let viewer = sight.point(slave)?;
                    let may_meet = |branch| sight.may_meet(&viewer, branch);
                    let nearest = segments.nearest(slave, surface, x, near, may_meet)?;
                    // A point can lie behind the common node of two segments only if it may be in contact with both: points on
                    // the other side of a wall see the far side of a hole beyond its end, through the body.
                    let adjacent = |at: &Projection| {
                        if at.master_point.xi > 0.0 {
                            surface.next(at.master_point.segment)
                        } else {
                            surface.previous(at.master_point.segment)
                        }
                    };
                    return on_segment(slave, surface, nearest, x).filter(|at| {
                        at.gap >= 0.0
                            || at.bound == Bound::Segment
                            || adjacent(at).is_some_and(|k| may_meet(Branch::of(k)))
                    });
                }
                let outward = slave.outward(x);
                let facing = |segment: usize| faces(surface, segment, outward, x);
                let first = segments.nearest(slave, surface, x, near, |_| true).filter(|&segment| facing(segment));
                if let Some(found) = first.and_then(|segment| on_segment(slave, surface, segment, x)) {
                    return Some(found);
                }
                let nearest = segments.by_distance(slave, surface, x).take(CANDIDATES);
                let mut facing = nearest.filter(|&segment| facing(segment)).enumerate();
                // A node is the projection only if no nearer segment faces the point: beyond the end of a surface, where the
                // last segment has no projection, each inner node would be one, far away and deep.
                facing.find_map(|(rank, segment)| {
                    let found = on_segment(slave, surface, segment, x).filter(|found| found.gap >= -slave.depth)?;
                    (rank == 0 || found.bound == Bound::Segment).then_some(found)
                })
            }
        }
    }

    /// Lists the segments of a mesh surface within a distance of a slave edge's bounding box, in order along the surface.
    pub fn around(&self, edge: &[usize], reach: f64, x: &Configuration, found: &mut Vec<usize>) {
        found.clear();
        let Self::Mesh(surface, segments, sight) = self else { return };
        let origin = surface.origin();
        if let Some(own) = Box2::around(edge.iter().map(|&node| x.between(origin, node))) {
            let all = own.wider(reach);
            segments.meeting(surface, x, &all, found);
            found.retain(|&segment| bounding_box(&surface.segments[segment], origin, x).meets(&all));
        }
        if let Some(sight) = sight {
            let viewer = sight.edge(edge);
            found.retain(|&segment| sight.may_meet(&viewer, Branch::of(segment)));
        }
    }
}

/// Whether a segment faces a point with the surface normal `outward`, if it has one.
fn faces(surface: &Surface, segment: usize, outward: Option<Vector2<f64>>, x: &Configuration) -> bool {
    let [a, b] = surface.segments[segment].ends;
    outward.is_none_or(|outward| normal_of(x.between(a, b).normalize()).dot(&outward) < FACING)
}

/// At a convex corner, a point behind several segments belongs to the one on the side of its old projection. The nearest
/// one, and with it the normal, changes at the bisector and may alternate during Newton's iterations; the old projection is
/// fixed within an increment.
fn behind_ridge(
    slave: &SlavePoint,
    surface: &Surface,
    nearest: Projection,
    from: MasterPoint,
    meets: impl Fn(usize) -> bool,
    x: &Configuration,
) -> Projection {
    let way = surface.path(nearest.master_point, from).into_iter().flat_map(Path::parts);
    let earlier = way.skip(1).map(|part| part.segment).take_while(|&segment| meets(segment));
    let behind = earlier.map(|segment| on_curve(slave, surface, segment, x));
    behind.take_while(|at| at.gap < 0.0 && (0.0..=1.0).contains(&at.master_point.xi)).last().unwrap_or(nearest)
}
