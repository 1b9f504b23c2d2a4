//! Closest-point projection of a point on one segment: position, gap and normal.

use nalgebra::Vector2;

use super::surface::{MasterPoint, Segment, SlavePoint, Surface};
use crate::mesh::configuration::Configuration;

/// Closest-point projection of a slave point on a master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Projected point of the master
    pub master_point: MasterPoint,
    /// g = (x − x_foot)·n, negative when penetrating [L]
    pub gap: f64,
    /// n: unit normal out of the master
    pub normal: Vector2<f64>,
    /// Dependence on the motion
    pub bound: Bound,
}

/// Dependence of a projection on the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// It slides along a segment
    Segment,
    /// It is fixed at a node between two segments
    Node(usize),
    /// It follows a motion δx of the point on a rigid body
    Rigid {
        /// motion of the projection along s: `advance` s·δx [-]
        advance: f64,
        /// δθ = `turn` s·δx [1/L]
        turn: f64,
    },
}

/// Cosine between the outward normals below which a slave and a segment face each other: the sides of a body are not in
/// contact with the ground below it. A slave point without edges faces every segment.
pub const FACING: f64 = -0.1;

/// Extension of the first and last segment of a surface beyond its end, as a fraction of their length: a slave that ends flush
/// with its master stays in contact when it bulges slightly; farther out it is open.
pub const OVERHANG: f64 = 0.05;

/// s: n turned by −90°.
pub fn tangent_of(normal: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(normal.y, -normal.x)
}

/// n: s turned by +90°.
pub fn normal_of(tangent: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-tangent.y, tangent.x)
}

/// Projection of a slave point on one segment in the configuration `x`; `None` beyond the end of the surface.
pub fn on_segment(slave: &SlavePoint, surface: &Surface, segment: usize, x: &Configuration) -> Option<Projection> {
    let found = on_curve(slave, surface, segment, x);
    let xi = found.master_point.xi;
    let neighbour = if xi < 0.0 { surface.previous(segment) } else { surface.next(segment) };
    let side = if xi < 0.0 { 0 } else { 1 };
    match neighbour {
        Some(neighbour) if !(0.0..=1.0).contains(&xi) => {
            // Smooth segments share the normal at their node: the projection passes from one to the other.
            let smooth = surface.segments[segment].beyond[side].and_then(|_| {
                let found = on_curve(slave, surface, neighbour, x);
                (-OVERHANG..=1.0 + OVERHANG).contains(&found.master_point.xi).then_some(found)
            });
            smooth.or_else(|| Some(at_node(slave, surface, segment, neighbour, xi, x)))
        }
        _ if !(-OVERHANG..=1.0 + OVERHANG).contains(&xi) => None,
        _ => Some(found),
    }
}

/// Projection of a slave point on the line or curve of a segment.
pub fn on_curve(slave: &SlavePoint, surface: &Surface, segment: usize, x: &Configuration) -> Projection {
    let curve = &surface.segments[segment];
    let Nearest { xi, offset, slope, .. } = nearest(slave, curve, x);
    let normal = normal_of(slope.normalize());
    Projection { master_point: MasterPoint { segment, xi }, gap: offset.dot(&normal), normal, bound: Bound::Segment }
}

/// The closest point of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// ξ
    pub xi: f64,
    /// x_s − x(ξ) [L]
    pub offset: Vector2<f64>,
    /// x′ [L]
    pub slope: Vector2<f64>,
    /// Number of Newton steps
    pub steps: usize,
}

/// Maximum number of iterations for the projection on a curve; a few suffice unless the point is near the centre of curvature.
const MOST_STEPS: usize = 60;

/// Range of the projection beyond the ends of a curve, as a fraction of its length; farther out the curve may turn back.
const BEYOND: f64 = 0.2;

/// The closest point, (x_s − x(ξ))·x′ = 0: directly on a straight line, by Newton's method on a curve.
pub fn nearest(slave: &SlavePoint, curve: &Segment, x: &Configuration) -> Nearest {
    let [a, b] = curve.ends;
    let along = x.between(a, b);
    let mut xi = slave.offset(a, x).dot(&along) / along.norm_squared();
    if curve.is_straight() {
        // Interpolated from both ends: relative to the nearer one the offset is more accurate.
        let offset = slave.offset(a, x) * (1.0 - xi) + slave.offset(b, x) * xi;
        return Nearest { xi, offset, slope: along, steps: 0 };
    }
    // x_s − x(ξ) = Σ c_k ξᵏ
    let [c0, c1, c2, c3] = curve.powers(|node| -slave.offset(node, x)).map(|c| -c);
    let offset = |xi: f64| c0 + (c1 + (c2 + c3 * xi) * xi) * xi;
    let slope = |xi: f64| -(c1 + (c2 * 2.0 + c3 * (3.0 * xi)) * xi);
    let bend = |xi: f64| -(c2 * 2.0 + c3 * (6.0 * xi));
    let within = |xi: f64| xi.clamp(-BEYOND, 1.0 + BEYOND);
    xi = within(xi);
    let mut steps = 0;
    while steps < MOST_STEPS {
        let (separation, slope) = (offset(xi), slope(xi));
        let square = slope.norm_squared();
        // Beyond the centre of curvature the second derivative of the distance would change its sign.
        let stiffness = (square - separation.dot(&bend(xi))).max(0.5 * square);
        let before = xi;
        xi = within(xi + separation.dot(&slope) / stiffness);
        steps += 1;
        // A step below the round-off of the offset ends the iteration, as does one against the end of the range.
        if (xi - before).abs() <= 4.0 * f64::EPSILON * (1.0 + (separation.norm_squared() / square).sqrt()) {
            break;
        }
    }
    Nearest { xi, offset: offset(xi), slope: slope(xi), steps }
}

/// Distance from a node, as a fraction of the segment, below which a point coincides with it.
const ON_NODE: f64 = 1e-13;

/// Projection on the node between two segments: outside a convex corner or, penetrating, inside a concave one.
pub fn at_node(
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
    // A point on the node has no direction of its own except round-off.
    let [a, b] = surface.segments[segment].ends;
    let on_node = offset.norm() <= ON_NODE * x.between(a, b).norm();
    let gap = if on_node { 0.0 } else { side * offset.norm() };
    let normal = if gap == 0.0 { mean.normalize() } else { offset / gap };
    Projection { master_point: MasterPoint { segment, xi }, gap, normal, bound: Bound::Node(node) }
}
