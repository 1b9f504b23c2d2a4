//! The foot of a point on one segment: closest point, gap and normal.

use nalgebra::Vector2;

use super::surface::{MasterPoint, Segment, SlavePoint, Surface};
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// It slides on a segment
    Segment,
    /// It stays at a node between two segments
    Node(usize),
    /// It follows a motion δx of the point on a rigid body
    Rigid {
        /// way of the foot along s: `advance` s·δx [-]
        advance: f64,
        /// δθ = `turn` s·δx [1/L]
        turn: f64,
    },
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
    let found = on_curve(slave, surface, segment, x);
    let xi = found.foot.xi;
    let neighbour = if xi < 0.0 { surface.previous(segment) } else { surface.next(segment) };
    let side = if xi < 0.0 { 0 } else { 1 };
    match neighbour {
        Some(neighbour) if !(0.0..=1.0).contains(&xi) => {
            // Smooth segments share the normal at their node: the foot goes over from one to the other.
            let smooth = surface.segments[segment].beyond[side].and_then(|_| {
                let found = on_curve(slave, surface, neighbour, x);
                (-HELD..=1.0 + HELD).contains(&found.foot.xi).then_some(found)
            });
            smooth.or_else(|| Some(at_node(slave, surface, segment, neighbour, xi, x)))
        }
        _ if !(-OVERHANG..=1.0 + OVERHANG).contains(&xi) => None,
        _ => Some(found),
    }
}

/// Foot of a slave point on the line or curve of a segment.
fn on_curve(slave: &SlavePoint, surface: &Surface, segment: usize, x: &Configuration) -> Projection {
    let curve = &surface.segments[segment];
    let xi = nearest(slave, curve, x);
    let normal = normal_of(x.combine(&curve.slope(xi)).normalize());
    let gap = offset(slave, curve, xi, x).dot(&normal);
    Projection { foot: MasterPoint { segment, xi }, gap, normal, bound: Bound::Segment }
}

/// x_s − x(ξ).
fn offset(slave: &SlavePoint, curve: &Segment, xi: f64, x: &Configuration) -> Vector2<f64> {
    curve.position(xi).iter().map(|&(node, w)| slave.offset(node, x) * w).sum()
}

/// Iterations for the foot on a curve; a few suffice unless the point is near the centre of curvature.
const MOST_STEPS: usize = 60;

/// ξ of the closest point, (x_s − x(ξ))·x′ = 0: at once on a straight line, by Newton's method on a curve.
fn nearest(slave: &SlavePoint, curve: &Segment, x: &Configuration) -> f64 {
    let [a, b] = curve.ends;
    let along = x.between(a, b);
    let mut xi = slave.offset(a, x).dot(&along) / along.norm_squared();
    if curve.is_straight() {
        return xi;
    }
    // Beyond the ends the curve is of no interest, and may turn back.
    xi = xi.clamp(-HELD, 1.0 + HELD);
    for _ in 0..MOST_STEPS {
        let (slope, bend) = (x.combine(&curve.slope(xi)), x.combine(&curve.bend(xi)));
        let offset = offset(slave, curve, xi, x);
        // Beyond the centre of curvature the second derivative of the distance would change its sign.
        let stiffness = (slope.norm_squared() - offset.dot(&bend)).max(0.5 * slope.norm_squared());
        let step = offset.dot(&slope) / stiffness;
        xi = (xi + step).clamp(-1.0, 2.0);
        if step.abs() < f64::EPSILON {
            break;
        }
    }
    xi
}

/// A point held on a segment may pass its ends by this share of its length.
const HELD: f64 = 0.1;

/// Foot of a slave point on a segment it is held on, as long as it stays near.
pub fn on_held_segment(slave: &SlavePoint, surface: &Surface, segment: usize, x: &Configuration) -> Option<Projection> {
    let projection = on_curve(slave, surface, segment, x);
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
    let (end, xi) = if xi < 0.0 { (0, 0.0) } else { (1, 1.0) };
    let direction = |segment: usize, xi: f64| x.combine(&surface.segments[segment].slope(xi)).normalize();
    let mean = normal_of(direction(segment, xi) + direction(neighbour, 1.0 - xi));
    let node = surface.segments[segment].ends[end];
    let offset = slave.offset(node, x);
    let side = if offset.dot(&mean) < 0.0 { -1.0 } else { 1.0 };
    let gap = side * offset.norm();
    // A point exactly on the node has no direction of its own.
    let normal = if gap == 0.0 { mean.normalize() } else { offset / gap };
    Projection { foot: MasterPoint { segment, xi }, gap, normal, bound: Bound::Node(node) }
}
