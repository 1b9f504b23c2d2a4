//! The foot of a point on one segment or plane: closest point, gap and normal.

use nalgebra::Vector2;

use super::surface::{MasterPoint, Plane, SlavePoint, Surface};
use crate::configuration::Configuration;

/// Where a slave point meets the master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// The foot
    pub foot: MasterPoint,
    /// g = (x − x_foot)·n, negative when penetrating [L]
    pub gap: f64,
    /// n: unit normal out of the master
    pub normal: Vector2<f64>,
    /// What the foot is bound to
    pub bound: Bound,
}

/// What a foot moves with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// It slides on a straight segment
    Segment,
    /// It stays at a node between two segments
    Node(usize),
    /// It slides on a rigid plane
    Plane,
}

/// The first and last segment of a surface reach beyond its end by this share of their length: a slave that ends flush
/// with its master stays in contact when it bulges by a trifle; farther out it is off the edge, and open.
pub const OVERHANG: f64 = 0.05;

/// s: n turned by −90°.
pub fn tangent_of(normal: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(normal.y, -normal.x)
}

/// n: s turned by +90°.
pub fn normal_of(tangent: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-tangent.y, tangent.x)
}

/// Foot of a slave point on one segment in the configuration `x`; `None` past the end of the surface.
pub fn on_segment(slave: &SlavePoint, surface: &Surface, segment: usize, x: &Configuration) -> Option<Projection> {
    let [a, b] = surface.segments[segment];
    let along = x.between(a, b);
    let xi = slave.offset(a, x).dot(&along) / along.norm_squared();
    let neighbour = if xi < 0.0 { surface.previous(segment) } else { surface.next(segment) };
    match neighbour {
        Some(neighbour) if !(0.0..=1.0).contains(&xi) => Some(at_node(slave, surface, segment, neighbour, xi, x)),
        _ if !(-OVERHANG..=1.0 + OVERHANG).contains(&xi) => None,
        _ => Some(on_line(slave, surface, segment, x)),
    }
}

/// Foot of a slave point on the straight line through a segment.
fn on_line(slave: &SlavePoint, surface: &Surface, segment: usize, x: &Configuration) -> Projection {
    let [a, b] = surface.segments[segment];
    let (along, offset) = (x.between(a, b), slave.offset(a, x));
    let xi = offset.dot(&along) / along.norm_squared();
    let normal = normal_of(along.normalize());
    let gap = offset.dot(&normal);
    Projection { foot: MasterPoint { segment, xi }, gap, normal, bound: Bound::Segment }
}

/// A point held on a segment may pass its ends by this share of its length.
const HELD: f64 = 0.1;

/// Foot of a slave point on a segment it is held on, as long as it stays near.
pub fn on_held_segment(slave: &SlavePoint, surface: &Surface, segment: usize, x: &Configuration) -> Option<Projection> {
    let projection = on_line(slave, surface, segment, x);
    (-HELD..=1.0 + HELD).contains(&projection.foot.xi).then_some(projection)
}

/// Closest point is the node between two segments: outside a convex corner or, penetrating, inside a concave one.
fn at_node(
    slave: &SlavePoint,
    surface: &Surface,
    segment: usize,
    neighbour: usize,
    xi: f64,
    x: &Configuration,
) -> Projection {
    let direction = |segment: usize| {
        let [a, b] = surface.segments[segment];
        x.between(a, b).normalize()
    };
    let mean = normal_of(direction(segment) + direction(neighbour));
    let (end, xi) = if xi < 0.0 { (0, 0.0) } else { (1, 1.0) };
    let node = surface.segments[segment][end];
    let offset = slave.offset(node, x);
    let side = if offset.dot(&mean) < 0.0 { -1.0 } else { 1.0 };
    let gap = side * offset.norm();
    // A point exactly on the node has no direction of its own.
    let normal = if gap == 0.0 { mean.normalize() } else { offset / gap };
    Projection { foot: MasterPoint { segment, xi }, gap, normal, bound: Bound::Node(node) }
}

/// Foot of `point` on a rigid plane.
pub fn on_plane(point: Vector2<f64>, plane: &Plane) -> Projection {
    let offset = point - plane.point;
    let foot = MasterPoint { segment: 0, xi: offset.dot(&tangent_of(plane.normal)) };
    Projection { foot, gap: offset.dot(&plane.normal), normal: plane.normal, bound: Bound::Plane }
}
