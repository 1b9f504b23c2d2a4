//! Which part of the master a slave point meets: the nearest segment that faces it.

use rstar::RTree;
use rstar::primitives::{GeomWithData, Line};

use super::projection::{Bound, Projection, normal_of, on_held_segment, on_plane, on_segment};
use super::surface::{Master, Plane, SlavePoint, Surface};
use crate::configuration::Configuration;

/// A slave and a segment face each other when the cosine between their outward normals is below this: the sides of a
/// body do not touch what its bottom rests on. A slave point of no edge faces every segment.
const FACING: f64 = -0.1;

/// Segments looked at before a point is called free. Nearest come first, so more than a few mean that nothing faces it.
const CANDIDATES: usize = 8;

/// The master in a spatial index at the current positions.
pub enum Index<'a> {
    /// Segments of a mesh surface in an R-tree
    Mesh(&'a Surface, RTree<GeomWithData<Line<[f64; 2]>, usize>>),
    /// A plane needs none
    Plane(&'a Plane),
}

impl<'a> Index<'a> {
    /// Index the master in the configuration `x`, O(N log N).
    pub fn new(master: &'a Master, x: &Configuration) -> Self {
        match master {
            Master::Plane(plane) => Self::Plane(plane),
            Master::Mesh(surface) => {
                let line = |[a, b]: [usize; 2]| Line::new(x.at(a).into(), x.at(b).into());
                let lines = surface.segments.iter().enumerate().map(|(k, &ends)| GeomWithData::new(line(ends), k));
                Self::Mesh(surface, RTree::bulk_load(lines.collect()))
            }
        }
    }

    /// The foot of a slave point, if a part of the master faces it, O(log N). `held` is a segment to stay on if the
    /// point is still near it.
    pub fn project(&self, slave: &SlavePoint, held: Option<usize>, x: &Configuration) -> Option<Projection> {
        let point = slave.at(x);
        match self {
            Self::Plane(plane) => Some(on_plane(point, plane)),
            Self::Mesh(surface, tree) => {
                if let Some(held) = held.and_then(|segment| on_held_segment(slave, surface, segment, x)) {
                    return Some(held);
                }
                let outward = slave.outward(x);
                let facing = |segment: usize| {
                    let [a, b] = surface.segments[segment];
                    outward.is_none_or(|outward| normal_of(x.between(a, b).normalize()).dot(&outward) < FACING)
                };
                let nearest = tree.nearest_neighbor_iter([point.x, point.y]).take(CANDIDATES).map(|line| line.data);
                let mut facing = nearest.filter(|&segment| facing(segment)).enumerate();
                // A node is the foot only of a point that nothing nearer faces: past the end of a surface, where the
                // last segment has no foot, each inner node would be one, far away and deep.
                facing.find_map(|(rank, segment)| {
                    let found = on_segment(slave, surface, segment, x)?;
                    (rank == 0 || found.bound == Bound::Segment).then_some(found)
                })
            }
        }
    }
}
