//! Master side of a contact.
//!
//! Rigid masters are given by formulas for the projection of a point and its variation. A moving one is evaluated in its
//! body-fixed frame: projections and paths are those of its undeformed shape.

use nalgebra::Vector2;

use super::point::{MasterPoint, SlavePoint};
use super::projection::{Bound, FACING, Projection, normal_of, tangent_of};
use super::surface::{CORNER, Segment, Surface};
use crate::mesh::configuration::Configuration;
use crate::mesh::rigid::RigidBody;

/// The master side of a contact: mesh edges or a rigid body.
#[derive(Clone, Debug, PartialEq)]
pub enum Master {
    /// A surface of the mesh
    Mesh(Surface),
    /// A rigid body
    Rigid(Rigid),
}

impl Master {
    /// The rigid body of a moving rigid master; `None` for meshes and fixed masters.
    pub fn rigid_body(&self) -> Option<&RigidBody> {
        match self {
            Self::Mesh(_) => None,
            Self::Rigid(rigid) => rigid.body.as_ref(),
        }
    }

    /// Segments of a mesh surface; empty for a rigid body.
    pub fn segments(&self) -> &[Segment] {
        match self {
            Self::Mesh(surface) => &surface.segments,
            Self::Rigid(_) => &[],
        }
    }
}

/// A rigid master.
#[derive(Clone, Debug, PartialEq)]
pub struct Rigid {
    /// Its shape, in the reference configuration
    pub shape: Shape,
    /// Rigid body to which it belongs; `None` if it is fixed
    pub body: Option<RigidBody>,
}

/// Shape of a rigid master, given by a formula.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A half-space
    Plane(Plane),
    /// A disk, or everything but a disk
    Circle(Circle),
    /// A body bounded by straight lines
    Polyline(Polyline),
}

/// A rigid half-space, given by a point of its surface and its unit normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// A point of the surface [L]
    pub point: Vector2<f64>,
    /// Unit normal, outward from the solid
    pub normal: Vector2<f64>,
}

/// A rigid circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Centre [L]
    pub centre: Vector2<f64>,
    /// Radius [L]
    pub radius: f64,
    /// Whether the solid is outside the circle (a hole)
    pub hole: bool,
}

/// A rigid body bounded by straight lines, the solid on their right: they run along s.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline {
    corners: Vec<Vector2<f64>>,
    /// Arc length from the first corner to each [L]
    arcs: Vec<f64>,
}

impl From<Shape> for Rigid {
    /// Creates a fixed rigid master.
    fn from(shape: Shape) -> Self {
        Self { shape, body: None }
    }
}

impl Rigid {
    /// Closest-point projection of a slave point; `None` beyond the ends of a polyline.
    ///
    /// X and u are kept separate: changes by a displacement are accurate however far away a plane's point or a circle's centre
    /// lies.
    pub fn project(&self, slave: &SlavePoint, x: &Configuration) -> Option<Projection> {
        let Some(body) = &self.body else {
            return self.shape.project(|origin| x.split(&slave.position, origin), || slave.outward(x));
        };
        let rotation = body.rotation(x);
        let outward = || slave.outward(x).map(|outward| rotation.inverse() * outward);
        let found = self.shape.project(|origin| body.seen(&slave.position, origin, x), outward)?;
        Some(Projection { normal: rotation * found.normal, ..found })
    }

    /// Path length of the projection of a slave point from one position to another along s [L].
    pub fn way(&self, slave: &SlavePoint, from: MasterPoint, to: MasterPoint, x: &Configuration) -> f64 {
        let way = to.xi - from.xi;
        let round_trip = |way: f64, round: f64| way - round * (way / round).round();
        match &self.shape {
            Shape::Plane(_) => way,
            Shape::Circle(circle) => round_trip(way, 2.0 * std::f64::consts::PI * circle.radius),
            Shape::Polyline(polyline) => {
                let start = |line: usize| {
                    let [reference, _] = x.split(&slave.position, polyline.corners[line]);
                    polyline.arcs[line] + reference.dot(&polyline.direction(line))
                };
                let separation = if from.segment == to.segment { 0.0 } else { start(to.segment) - start(from.segment) };
                match polyline.is_closed() {
                    true => round_trip(way + separation, polyline.arcs[polyline.arcs.len() - 1]),
                    false => way + separation,
                }
            }
        }
    }
}

impl Shape {
    /// Projection of a point, given by X and u relative to any origin, on a surface with normal `outward`.
    fn project(
        &self,
        from: impl Fn(Vector2<f64>) -> [Vector2<f64>; 2],
        outward: impl FnOnce() -> Option<Vector2<f64>>,
    ) -> Option<Projection> {
        match self {
            Self::Plane(plane) => Some(plane.project(from(plane.point))),
            Self::Circle(circle) => circle.project(from(circle.centre)),
            Self::Polyline(polyline) => polyline.project(from, outward()),
        }
    }
}

impl Plane {
    /// Foot of the perpendicular from a position.
    pub fn master_point(&self, at: Vector2<f64>) -> Vector2<f64> {
        at - self.normal * (at - self.point).dot(&self.normal)
    }

    fn project(&self, [reference, displacement]: [Vector2<f64>; 2]) -> Projection {
        let (n, s) = (self.normal, tangent_of(self.normal));
        let master_point = MasterPoint { segment: 0, xi: displacement.dot(&s) };
        let bound = Bound::Rigid { advance: 1.0, turn: 0.0 };
        Projection { master_point, gap: reference.dot(&n) + displacement.dot(&n), normal: n, bound }
    }
}

impl Circle {
    /// Projection in polar coordinates: g = ±(d − r), δ(arc) = r/d s·δx, δθ = ∓1/d s·δx; undefined at the centre.
    ///
    /// d − r = (|X| − r) + (2 X·u + u·u)/(d + |X|), so that a large radius does not cancel what u changes.
    fn project(&self, [reference, displacement]: [Vector2<f64>; 2]) -> Option<Projection> {
        let offset = reference + displacement;
        let (distance, start) = (offset.norm(), reference.norm());
        let sign = if self.hole { -1.0 } else { 1.0 };
        let farther = displacement.dot(&(reference + offset)) / (distance + start);
        let angle = reference.perp(&displacement).atan2(reference.dot(&offset));
        (distance > 0.0).then(|| Projection {
            master_point: MasterPoint { segment: 0, xi: -sign * self.radius * angle },
            gap: sign * ((start - self.radius) + farther),
            normal: offset * (sign / distance),
            bound: Bound::Rigid { advance: self.radius / distance, turn: -sign / distance },
        })
    }
}

impl Polyline {
    /// Creates a polyline through two or more distinct corners.
    pub fn new(corners: Vec<Vector2<f64>>) -> Self {
        let lengths = corners.windows(2).map(|pair| (pair[1] - pair[0]).norm());
        let arcs = std::iter::once(0.0).chain(lengths.scan(0.0, |sum, length| {
            *sum += length;
            Some(*sum)
        }));
        Self { arcs: arcs.collect(), corners }
    }

    /// Corners, in their order.
    pub fn corners(&self) -> &[Vector2<f64>] {
        &self.corners
    }

    /// Whether it has corners of more than 45°, or, as a straight line, nothing but its ends.
    pub fn is_sharp(&self) -> bool {
        let lines = self.corners.len() - 1;
        lines == 1 || (0..=lines).any(|corner| self.turn(corner).is_some_and(|turn| turn <= CORNER))
    }

    /// Convex corners of more than 45°, and the ends of an open line.
    pub fn sharp_corners(&self) -> impl Iterator<Item = Vector2<f64>> {
        let count = self.corners.len() - usize::from(self.is_closed());
        let is_sharp = |corner: &usize| self.turn(*corner).is_none_or(|turn| turn <= CORNER && self.is_convex(*corner));
        (0..count).filter(is_sharp).map(|corner| self.corners[corner])
    }

    /// Lines before and after a corner; `None` at an end.
    fn around(&self, corner: usize) -> Option<[usize; 2]> {
        let lines = self.corners.len() - 1;
        match corner {
            0 => self.is_closed().then_some([lines - 1, 0]),
            _ if corner == lines => self.is_closed().then_some([lines - 1, 0]),
            _ => Some([corner - 1, corner]),
        }
    }

    /// Cosine of the angle between the lines at a corner; `None` at an end.
    fn turn(&self, corner: usize) -> Option<f64> {
        let [before, after] = self.around(corner)?.map(|line| self.direction(line));
        Some(before.dot(&after))
    }

    /// Whether the solid, on the right of the lines, has less than a straight angle at a corner.
    fn is_convex(&self, corner: usize) -> bool {
        self.around(corner).is_some_and(|[before, after]| self.direction(before).perp(&self.direction(after)) < 0.0)
    }

    fn is_closed(&self) -> bool {
        self.corners.first() == self.corners.last()
    }

    /// s of a line.
    fn direction(&self, line: usize) -> Vector2<f64> {
        (self.corners[line + 1] - self.corners[line]).normalize()
    }

    /// Projection on the nearest line that faces a point, given by X and u relative to any corner. Between two lines it is
    /// their corner; beyond the ends there is none.
    fn project(
        &self,
        from: impl Fn(Vector2<f64>) -> [Vector2<f64>; 2],
        outward: Option<Vector2<f64>>,
    ) -> Option<Projection> {
        let last = self.corners.len() - 2;
        let faces = |k: usize| outward.is_none_or(|outward| normal_of(self.direction(k)).dot(&outward) < FACING);
        let nearest = (0..=last).filter(|&k| faces(k)).map(|k| {
            let [reference, displacement] = from(self.corners[k]);
            let (s, offset) = (self.direction(k), reference + displacement);
            let along = offset.dot(&s).clamp(0.0, self.arcs[k + 1] - self.arcs[k]);
            (k, along, (offset - s * along).norm())
        });
        let (k, along, distance) = nearest.min_by(|a, b| a.2.total_cmp(&b.2))?;
        let [reference, displacement] = from(self.corners[k]);
        let (s, offset, length) = (self.direction(k), reference + displacement, self.arcs[k + 1] - self.arcs[k]);
        let (past_start, past_end) = (offset.dot(&s) < 0.0, offset.dot(&s) > length);
        let neighbour = match (past_start, past_end) {
            (true, _) if k > 0 || self.is_closed() => Some(k.checked_sub(1).unwrap_or(last)),
            (_, true) if k < last || self.is_closed() => Some(if k < last { k + 1 } else { 0 }),
            (false, false) => None,
            _ => return None,
        };
        let Some(neighbour) = neighbour else {
            let normal = normal_of(s);
            let gap = reference.dot(&normal) + displacement.dot(&normal);
            let master_point = MasterPoint { segment: k, xi: displacement.dot(&s) };
            return Some(Projection { master_point, gap, normal, bound: Bound::Rigid { advance: 1.0, turn: 0.0 } });
        };
        let arm = offset - s * along;
        let mean = normal_of(s + self.direction(neighbour)).normalize();
        // Past the end of a line at a convex corner the solid ends, but for what is behind the other line too.
        let first_after = if past_start { k } else { neighbour };
        let adjacent = self.is_convex(first_after) && arm.dot(&normal_of(self.direction(neighbour))) >= 0.0;
        let gap = if arm.dot(&mean) < 0.0 && !adjacent { -distance } else { distance };
        let (normal, turn) = if gap == 0.0 { (mean, 0.0) } else { (arm / gap, -1.0 / gap) };
        let master_point = MasterPoint { segment: k, xi: along - reference.dot(&s) };
        Some(Projection { master_point, gap, normal, bound: Bound::Rigid { advance: 0.0, turn } })
    }
}
