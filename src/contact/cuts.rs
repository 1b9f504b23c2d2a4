//! Slave edges cut where master nodes project on them: which part of an edge each master segment faces.

use nalgebra::Vector2;

use super::lines::{Line, root};
use super::projection::normal_of;
use super::search::Index;
use super::surface::Surface;
use crate::mesh::configuration::Configuration;
use crate::mesh::few::Few;
use crate::mesh::shape;

/// Master segments farther from a slave edge than this many of its lengths are not looked at: far enough for the deep
/// penetrations of first iterates, which must not pass for contact lost.
const REACH: f64 = 10.0;

/// A slave edge and a master segment face each other when the cosine between their outward normals is below this.
const EDGE_ON: f64 = -0.01;

/// A segment both of whose ends project farther beyond an end of a straight edge than this faces none of it [half an edge]
const BESIDE: f64 = 1e-3;

/// A part of a slave edge that one master segment faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Overlap {
    pub segment: usize,
    pub ends: [Cut; 2],
}

/// Where a slave edge is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    pub xi: f64,
    /// The master node that projects there; none at the ends of the edge
    pub node: Option<usize>,
}

/// The cuts of all slave edges in one configuration, written again and again in the same memory.
#[derive(Clone, Debug, Default)]
pub struct Overlaps(pub(super) Vec<CutEdge>);

/// A slave edge, cut.
#[derive(Clone, Debug, Default)]
pub(super) struct CutEdge {
    /// Its parts that are faced, in order
    pub overlaps: Vec<Overlap>,
    /// What each segment around it faces, whatever lies in between
    candidates: Vec<Overlap>,
    cuts: Vec<Cut>,
    /// Segments around it
    around: Vec<usize>,
}

impl CutEdge {
    /// Cut an edge where master nodes project on it; of several segments that face a part the nearest counts.
    pub fn cut(&mut self, edge: &[usize], surface: &Surface, index: &Index, x: &Configuration) {
        let Self { overlaps, candidates, cuts, around } = self;
        candidates.clear();
        facing(edge, surface, index, x, (around, candidates));
        cuts.clear();
        cuts.extend(candidates.iter().flat_map(|overlap| overlap.ends));
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
        overlaps.clear();
        for pair in cuts.windows(2).filter(|pair| pair[0].xi < pair[1].xi) {
            let middle = 0.5 * (pair[0].xi + pair[1].xi);
            let facing = candidates.iter().filter(|overlap| overlap.ends[0].xi < middle && middle < overlap.ends[1].xi);
            let nearest = facing.min_by(|a, b| distance(a, middle).total_cmp(&distance(b, middle)));
            overlaps.extend(nearest.map(|overlap| Overlap { segment: overlap.segment, ends: [pair[0], pair[1]] }));
        }
    }
}

/// The part of a slave edge that each segment around it faces, whatever lies in between, added to the `candidates`.
fn facing(
    edge: &[usize],
    surface: &Surface,
    index: &Index,
    x: &Configuration,
    (around, candidates): (&mut Vec<usize>, &mut Vec<Overlap>),
) {
    let along = x.between(edge[0], edge[1]);
    let reach = REACH * along.norm();
    let normal = -normal_of(along.normalize());
    let levels = |node: usize| -> Few<f64, 3> { edge.iter().map(|&own| x.between(node, own).dot(&along)).collect() };
    let chord = |levels: &[f64]| 2.0 * levels[0] / (levels[0] - levels[1]) - 1.0;
    let coordinate = |node: usize| {
        let levels = levels(node);
        root(|xi| Line::Edge(edge).shapes(xi), &levels, chord(&levels))
    };
    index.around(edge, reach, x, around);
    for &segment in &*around {
        let [a, b] = surface.segments[segment].ends;
        // On a straight edge the chord is the coordinate, but for round-off.
        let [start, end] = [a, b].map(|node| chord(&levels(node)));
        if edge.len() == 2 && (start.min(end) > 1.0 + BESIDE || start.max(end) < -1.0 - BESIDE) {
            continue;
        }
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
}
