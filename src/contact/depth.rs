//! How deep the surfaces of a contact lie in each other: nodes of both, corners and ends of rigid bodies, rigid disks.
//!
//! Contact is evaluated at points of the slave. What lies between them may enter: a corner of a rigid body or a small disk an edge of the
//! slave, a corner of the slave the master next to Gauss points.
//!
//! ```text
//! node of the slave in a rigid master      −g of its projection
//! corner of a rigid body in the slave      its distance D from the slave's surface, inside the outline of the slave's bodies
//! disk of radius r, centre c               r − D(c) with c outside, r + D(c) with c inside
//! ```

use nalgebra::{Rotation2, Vector2};

use super::master::{Circle, Master, Rigid, Shape};
use super::pair::{BothSurfaces, ContactPair};
use super::projection::normal_of;
use super::search::Index;
use super::surface::{Segment, SlavePoint, Surface};
use crate::mesh::configuration::Configuration;

/// What of one side is inside the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inside {
    /// A node of the slave
    SlaveNode,
    /// A corner, or an end, of a rigid master
    Corner,
    /// A rigid disk
    Disk,
}

/// A place of one surface inside the other body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    /// What is there
    pub what: Inside,
    /// Current place [L]
    pub at: Vector2<f64>,
    /// Distance from the surface [L]
    pub depth: f64,
    /// Length of the slave's edge there [L]
    pub edge: f64,
}

/// Number of chords that stand for a curved edge.
const CHORDS: usize = 8;

/// The point of a surface nearest to a place.
#[derive(Clone, Copy, Debug)]
struct Nearest {
    distance: f64,
    /// Whether the place is behind the surface there
    behind: bool,
    edge: f64,
}

impl ContactPair {
    /// Deepest place of either side in the other, with its depth; none in contacts whose gaps are not those of the surfaces.
    pub fn deepest(&self, x: &Configuration) -> Option<Depth> {
        let BothSurfaces { own, .. } = self.both.as_ref().filter(|_| self.small.is_none() && !self.tied)?;
        if self.is_offset() {
            return None;
        }
        let index = Index::new(&self.master, x);
        let longest = own.iter().filter_map(|node| node.edge_length(x)).fold(0.0, f64::max);
        // What is deeper behind a line than an edge is beyond the other side of its body.
        let most = match &self.master {
            Master::Rigid(Rigid { shape: Shape::Plane(_) | Shape::Circle(_), .. }) => f64::INFINITY,
            _ => longest,
        };
        let node = |point: &SlavePoint| {
            let depth = -index.project(point, None, x)?.gap;
            let edge = point.edge_length(x)?;
            (0.0 < depth && depth < most.min(point.depth)).then(|| Depth {
                what: Inside::SlaveNode,
                at: point.at(x),
                depth,
                edge,
            })
        };
        let nodes = own.iter().filter_map(node);
        nodes.chain(self.deepest_of_tool(x)).max_by(|a, b| a.depth.total_cmp(&b.depth))
    }

    /// Deepest corner, or disk, of a rigid master inside the slave's bodies.
    fn deepest_of_tool(&self, x: &Configuration) -> Option<Depth> {
        let Some(BothSurfaces { slave: Master::Mesh(slave), sides, .. }) = &self.both else { return None };
        let Master::Rigid(rigid) = &self.master else { return None };
        match &rigid.shape {
            Shape::Plane(_) => None,
            Shape::Circle(Circle { hole: true, .. }) => None,
            Shape::Circle(Circle { centre, radius, .. }) => {
                let centre = rigid.place(*centre, x);
                let Nearest { distance, edge, .. } = nearest(slave, centre, x)?;
                let depth = if is_inside(sides, centre, x) { radius + distance } else { radius - distance };
                (depth > 0.0).then_some(Depth { what: Inside::Disk, at: centre, depth, edge })
            }
            Shape::Polyline(line) => {
                let corner = |corner: Vector2<f64>| {
                    let at = rigid.place(corner, x);
                    let Nearest { distance, edge, .. } = nearest(slave, at, x).filter(|nearest| nearest.behind)?;
                    is_inside(sides, at, x).then_some(Depth { what: Inside::Corner, at, depth: distance, edge })
                };
                line.sharp_corners().filter_map(corner).max_by(|a, b| a.depth.total_cmp(&b.depth))
            }
        }
    }

    /// The sharp corner of a rigid master nearest to a node of the slave, if it is within an edge of the node: its current place.
    pub fn corner_at(&self, node: usize, x: &Configuration) -> Option<Vector2<f64>> {
        let Master::Rigid(rigid) = &self.master else { return None };
        let Shape::Polyline(line) = &rigid.shape else { return None };
        let own = self.both.as_ref()?.own.iter().filter(|point| point.position.iter().any(|&(own, _)| own == node));
        let (at, edge) = own.filter_map(|point| Some((point.at(x), point.edge_length(x)?))).next()?;
        let corners = line.sharp_corners().map(|corner| rigid.place(corner, x));
        let nearest = corners.min_by(|a, b| (a - at).norm().total_cmp(&(b - at).norm()))?;
        ((nearest - at).norm() < edge).then_some(nearest)
    }
}

impl Rigid {
    /// Current place of a point that moves with it: x_R + Q (X − X_R).
    pub fn place(&self, reference: Vector2<f64>, x: &Configuration) -> Vector2<f64> {
        let Some(body) = &self.body else { return reference };
        let rotation: Rotation2<f64> = body.rotation(x);
        let origin = x.reference(body.reference);
        origin + x.displacement(body.reference) + rotation * (reference - origin)
    }
}

/// The point of a surface nearest to a place; `None` if it is an end of the surface.
fn nearest(surface: &Surface, at: Vector2<f64>, x: &Configuration) -> Option<Nearest> {
    let mut found: Option<(f64, bool, Nearest)> = None;
    for (number, segment) in surface.segments.iter().enumerate() {
        let ends = [surface.previous(number).is_none(), surface.next(number).is_none()];
        let edge = x.between(segment.ends[0], segment.ends[1]).norm();
        let places = chords(segment, x);
        for (k, pair) in places.windows(2).enumerate() {
            let (offset, along) = (at - pair[0], pair[1] - pair[0]);
            let xi = offset.dot(&along) / along.norm_squared();
            let past = (ends[0] && k == 0 && xi < 0.0) || (ends[1] && k + 2 == places.len() && xi > 1.0);
            let distance = (offset - along * xi.clamp(0.0, 1.0)).norm();
            let behind = offset.dot(&normal_of(along)) < 0.0;
            let now = Nearest { distance, behind, edge };
            match &mut found {
                // At a corner of the surface two chords are as near. Beside a notch the body is in front of the line of one of them, and
                // beyond a corner behind the line of one there is no body, as its sides tell.
                Some((least, _, nearest)) if (distance - *least).abs() <= f64::EPSILON * edge => {
                    nearest.behind |= behind
                }
                Some((least, ..)) if distance > *least => {}
                _ => found = Some((distance, past, now)),
            }
        }
    }
    found.filter(|(_, past, _)| !past).map(|(.., nearest)| nearest)
}

/// Places along a segment: its ends, or those of the chords of a curved one.
fn chords(segment: &Segment, x: &Configuration) -> Vec<Vector2<f64>> {
    let place = |xi: f64| -> Vector2<f64> {
        let weights: Vec<(usize, f64)> = segment.position(xi).iter().copied().collect();
        let [reference, displacement] = x.split(&weights, Vector2::zeros());
        reference + displacement
    };
    let count = if segment.is_straight() { 1 } else { CHORDS };
    (0..=count).map(|k| place(k as f64 / count as f64)).collect()
}

/// Whether a place is inside bodies with these sides, the bodies on their left: it is encircled once.
fn is_inside(sides: &[Vec<usize>], at: Vector2<f64>, x: &Configuration) -> bool {
    let to = |node: usize| x.reference(node) + x.displacement(node) - at;
    let turn = |[a, b]: [usize; 2]| {
        let (a, b) = (to(a), to(b));
        a.perp(&b).atan2(a.dot(&b))
    };
    let turns = sides.iter().map(|side| match side[..] {
        [start, end, middle] => turn([start, middle]) + turn([middle, end]),
        [start, end, ..] => turn([start, end]),
        _ => 0.0,
    });
    turns.sum::<f64>() > std::f64::consts::PI
}
