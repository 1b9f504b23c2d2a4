//! Rigid masters at rest, given by formula: the foot of a point, and how it moves with the point.

use nalgebra::Vector2;

use super::projection::{Bound, Projection, normal_of, tangent_of};
use super::search::FACING;
use super::surface::MasterPoint;

/// A rigid body.
#[derive(Clone, Debug, PartialEq)]
pub enum Rigid {
    /// A half-space
    Plane(Plane),
    /// A disk, or everything but a disk
    Circle(Circle),
    /// A body bounded by straight lines
    Polyline(Polyline),
}

/// A rigid half-space: a point of its surface and its unit normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// A point of the surface [L]
    pub point: Vector2<f64>,
    /// Unit normal, out of the solid
    pub normal: Vector2<f64>,
}

/// A rigid circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Centre [L]
    pub centre: Vector2<f64>,
    /// Radius [L]
    pub radius: f64,
    /// Whether the solid is outside: a hole
    pub hole: bool,
}

/// A rigid body bounded by straight lines, the solid on their right: they run along s.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline {
    corners: Vec<Vector2<f64>>,
    /// Arc length from the first corner to each [L]
    arcs: Vec<f64>,
}

impl Rigid {
    /// The foot of `point`, a point of a surface with the normal `outward`, if of any; `None` past the end of a polyline.
    pub fn project(&self, point: Vector2<f64>, outward: Option<Vector2<f64>>) -> Option<Projection> {
        match self {
            Self::Plane(plane) => Some(plane.project(point)),
            Self::Circle(circle) => circle.project(point),
            Self::Polyline(polyline) => polyline.project(point, outward),
        }
    }

    /// The way from one foot to another along s [L].
    pub fn way(&self, from: MasterPoint, to: MasterPoint) -> f64 {
        let way = to.xi - from.xi;
        match self {
            Self::Circle(circle) => {
                let round = 2.0 * std::f64::consts::PI * circle.radius;
                way - round * (way / round).round()
            }
            _ => way,
        }
    }
}

fn foot(arc: f64) -> MasterPoint {
    MasterPoint { segment: 0, xi: arc }
}

impl Plane {
    fn project(&self, point: Vector2<f64>) -> Projection {
        let offset = point - self.point;
        let bound = Bound::Rigid { advance: 1.0, turn: 0.0 };
        let foot = foot(offset.dot(&tangent_of(self.normal)));
        Projection { foot, gap: offset.dot(&self.normal), normal: self.normal, bound }
    }
}

impl Circle {
    /// Polar coordinates: g = ±(d − r), δ(arc) = r/d s·δx, δθ = ∓1/d s·δx. The centre has no foot.
    fn project(&self, point: Vector2<f64>) -> Option<Projection> {
        let offset = point - self.centre;
        let distance = offset.norm();
        let sign = if self.hole { -1.0 } else { 1.0 };
        let angle = offset.y.atan2(offset.x);
        (distance > 0.0).then(|| Projection {
            foot: foot(-sign * self.radius * angle),
            gap: sign * (distance - self.radius),
            normal: offset * (sign / distance),
            bound: Bound::Rigid { advance: self.radius / distance, turn: -sign / distance },
        })
    }
}

impl Polyline {
    /// A polyline through two or more different corners.
    pub fn new(corners: Vec<Vector2<f64>>) -> Self {
        let lengths = corners.windows(2).map(|pair| (pair[1] - pair[0]).norm());
        let arcs = std::iter::once(0.0).chain(lengths.scan(0.0, |sum, length| {
            *sum += length;
            Some(*sum)
        }));
        Self { arcs: arcs.collect(), corners }
    }

    /// The nearest line that faces the point. Between two lines the foot is their corner; past the ends there is none.
    fn project(&self, point: Vector2<f64>, outward: Option<Vector2<f64>>) -> Option<Projection> {
        let closed = self.corners.first() == self.corners.last();
        let last = self.corners.len() - 2;
        let direction = |k: usize| (self.corners[k + 1] - self.corners[k]).normalize();
        let faces = |k: usize| outward.is_none_or(|outward| normal_of(direction(k)).dot(&outward) < FACING);
        let nearest = (0..=last).filter(|&k| faces(k)).map(|k| {
            let (s, offset) = (direction(k), point - self.corners[k]);
            let along = offset.dot(&s).clamp(0.0, self.arcs[k + 1] - self.arcs[k]);
            (k, along, (offset - s * along).norm())
        });
        let (k, along, distance) = nearest.min_by(|a, b| a.2.total_cmp(&b.2))?;
        let (s, offset, length) = (direction(k), point - self.corners[k], self.arcs[k + 1] - self.arcs[k]);
        let (past_start, past_end) = (offset.dot(&s) < 0.0, offset.dot(&s) > length);
        let neighbour = match (past_start, past_end) {
            (true, _) if k > 0 || closed => Some(k.checked_sub(1).unwrap_or(last)),
            (_, true) if k < last || closed => Some(if k < last { k + 1 } else { 0 }),
            (false, false) => None,
            _ => return None,
        };
        let foot = foot(self.arcs[k] + along);
        let Some(neighbour) = neighbour else {
            let normal = normal_of(s);
            let bound = Bound::Rigid { advance: 1.0, turn: 0.0 };
            return Some(Projection { foot, gap: offset.dot(&normal), normal, bound });
        };
        let arm = offset - s * along;
        let mean = normal_of(s + direction(neighbour)).normalize();
        let gap = if arm.dot(&mean) < 0.0 { -distance } else { distance };
        let (normal, turn) = if gap == 0.0 { (mean, 0.0) } else { (arm / gap, -1.0 / gap) };
        Some(Projection { foot, gap, normal, bound: Bound::Rigid { advance: 0.0, turn } })
    }
}
