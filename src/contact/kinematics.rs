//! Gap, slip and rotation of a contact point, and their exact variations.
//!
//! ```text
//!                      • x_s                the slave point
//!             n  ↑     ┊ g
//!        ●━━━━━━━┷→━━━━•━━━━━━━━━━●         a segment of the master, from ξ = 0 to ξ = 1; its body is below
//!                 s    x(ξ)                 the projection
//!        ├─────────────┤
//!     old projection   Δu_t
//! ```
//!
//! On a segment x(ξ), straight or curved, with x′ = dx/dξ = J s, x″ = d²x/dξ², and δm = Σ N_a(ξ) δx_a:
//!
//! ```text
//! g = (x_s − x)·n         δg = n·(δx_s − δm)
//! (x_s − x)·x′ = 0        δξ (J² − g n·x″) = J s·(δx_s − δm) + g n·δx′
//! θ: rotation of (s, n)   δθ = n·(δx′ + x″ δξ)/J,   δs = n δθ,   δn = −s δθ
//! Δu_t = ∫ J dξ           δΔu_t = ∫ s·δx′ dξ + J δξ        along the surface from the old projection to the new one
//! ```
//!
//! A point without a projection at the start of the increment has no old projection; its slip is measured past the present
//! one, with Σ w_a x_a = x_s − x:
//!
//! ```text
//! Δu_t = s·Σ w_a Δx_a     δΔu_t = s·Σ (w_a δx_a + δw_a Δx_a) + n·Σ w_a Δx_a δθ        Δx_a: motion in the increment
//! ```
//!
//! For a projection fixed at a node x_v: g = ±‖x_s − x_v‖, δg = n·(δx_s − δx_v), δθ = −s·(δx_s − δx_v)/g, δξ = 0.
//!
//! # Moving rigid masters
//!
//! The relevant motion is that of the point in the body-fixed frame, with the displacement u_R and the angle φ of the body:
//!
//! ```text
//! δr = δx_s − δu_R + b rδφ,   b = −J (x_s − x_R)/r             b: the lever;   J: turned by 90°
//! δg = n·δr,   δΔu_t = a s·δr,   δθ = t s·δr + δφ              a, t: advance and turn of the shape
//! Δr = d − Q(Δφ) d_before,   d = x_s − x_R                     motion of a point without an old projection, slip along s
//! ```
//! The body receives the opposite of the slave's force, at the position of the slave: −t ℓ at its reference node and, as its
//! moment, b·t ℓ at the node that carries r φ. The two forces are in balance and do work on δr only.

use nalgebra::Vector2;

use super::between::Between;
use super::master::{Master, Rigid};
use super::projection::{Bound, FACING, Projection, normal_of, tangent_of};
use super::surface::{MasterPoint, Path, PathPart, SlavePoint, Surface};
use crate::mesh::configuration::Configuration;
use crate::mesh::rigid::{RigidBody, turned};
use crate::mesh::shape;

/// Kinematics of one contact point and, on request, the variations with respect to its nodes' displacements.
///
/// It is reused for one point after another, without allocation per point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Kinematics {
    /// Participating nodes: entries of all variations, two dofs per node
    pub nodes: Vec<usize>,
    /// Weights w_a of x_s − x_m = Σ w_a x_a, with x_m the projection, by position in `nodes`
    pub relative: Vec<f64>,
    /// n
    pub normal: Vector2<f64>,
    /// s
    pub tangent: Vector2<f64>,
    /// Δu_t since the old projection [L]
    pub slip: f64,
    /// Current tributary length of the point [L]
    pub length: f64,
    /// κ: pressure acts along n − κ s, the normal of the master next to a ridge of the slave; 0 elsewhere [-]
    pub lean: f64,
    /// Whether the variations are computed; they are empty otherwise
    pub varied: bool,
    /// δg
    pub dgap: Vec<f64>,
    /// δΔu_t [-]
    pub dslip: Vec<f64>,
    /// δθ [1/L]
    pub drotation: Vec<f64>,
    /// δ(length) [-]
    pub dlength: Vec<f64>,
    /// δκ [1/L]
    pub dlean: Vec<f64>,
    /// Positions in `nodes` of the weights that change
    pub changing: Vec<usize>,
    /// δw_a of these, row by row [1/L]
    pub drelative: Vec<f64>,
    /// Contribution of the rotation of a rigid master to Σ w_a x_a; none for other masters
    pub lever: Option<Lever>,
    /// δb of the lever, its two components
    pub dlever: [Vec<f64>; 2],
    /// Nodes of the elements whose pores hold a fluid, behind the point
    pub behind: Vec<usize>,
    /// δp_w of these, two entries per node [F/L³]
    pub dpores: Vec<f64>,
    /// Water of the bodies of both sides, whose pressures then stand behind the point
    pub water: Option<Between>,
    /// δξ of the projection
    dxi: Vec<f64>,
}

/// Motion of a slave point relative to a rigid master that rotates: b per displacement of the node that carries the rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lever {
    /// Position of that node in `nodes`
    pub at: usize,
    /// b [-]
    pub arm: Vector2<f64>,
}

/// Closest-point projection of a slave point on the master, with its gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// g [L]
    pub gap: f64,
    /// Projection
    pub master_point: MasterPoint,
}

/// Computes the kinematics of `slave` projected on `master`, with slip relative to the committed projection `from`.
pub fn kinematics(
    slave: &SlavePoint,
    master: &Master,
    projection: &Projection,
    from: Option<MasterPoint>,
    x: &Configuration,
    k: &mut Kinematics,
) {
    match master {
        Master::Rigid(rigid) => past_rigid(slave, rigid, projection, from, x, k),
        Master::Mesh(surface) => on_surface(slave, surface, projection, from, x, k),
    }
}

/// Computes the kinematics of `slave` projected on a rigid master, with slip relative to the committed projection `from`.
pub fn past_rigid(
    slave: &SlavePoint,
    rigid: &Rigid,
    projection: &Projection,
    from: Option<MasterPoint>,
    x: &Configuration,
    k: &mut Kinematics,
) {
    k.begin(projection.normal);
    k.list_slave(slave);
    if let Some(body) = &rigid.body {
        k.list([body.reference, body.turning]);
    }
    k.take_slave(slave, x);
    if let Some(body) = &rigid.body {
        k.take_rigid(slave, body, x);
    }
    let (n, s) = (k.normal, k.tangent);
    let Bound::Rigid { advance, turn } = projection.bound else { return };
    k.vary_past(slave, rigid, n, |k| &mut k.dgap);
    k.vary_past(slave, rigid, s * turn, |k| &mut k.drotation);
    if let (Some(body), Some(Lever { at, .. }), true) = (&rigid.body, k.lever, k.varied) {
        k.drotation[2 * at] += 1.0 / body.radius;
    }
    if let Some(from) = from {
        k.slip = rigid.way(slave, from, projection.master_point, x);
        k.vary_past(slave, rigid, s * advance, |k| &mut k.dslip);
    }
}

fn on_surface(
    slave: &SlavePoint,
    surface: &Surface,
    projection: &Projection,
    from: Option<MasterPoint>,
    x: &Configuration,
    k: &mut Kinematics,
) {
    let MasterPoint { segment, xi } = projection.master_point;
    let curve = &surface.segments[segment];
    let path = from
        .and_then(|from| surface.path(from, projection.master_point))
        .filter(|path| slides(surface, path, projection, x));
    k.begin(projection.normal);
    k.list_slave(slave);
    k.list(curve.nodes());
    let parts = || path.into_iter().flat_map(Path::parts);
    parts().for_each(|part| k.list(surface.segments[part.segment].nodes()));
    k.take_slave(slave, x);
    let master_point = curve.position(xi);
    for &(node, w) in &master_point {
        let at = k.local(node);
        k.relative[at] -= w;
    }
    k.vary_projection(slave, surface, projection, x);
    parts().for_each(|part| k.slide(surface, part, x));
    if k.varied && path.is_some() {
        let length = x.combine(&curve.slope(xi)).norm();
        k.dslip.iter_mut().zip(&k.dxi).for_each(|(dslip, dxi)| *dslip += dxi * length);
    }
}

/// Whether the projection has slid along a path. In self-contact it may also have jumped from one part of the surface to
/// another, over segments that face away.
fn slides(surface: &Surface, path: &Path, projection: &Projection, x: &Configuration) -> bool {
    let looks = |segment: usize| {
        let [a, b] = surface.segments[segment].ends;
        normal_of(x.between(a, b).normalize()).dot(&projection.normal) > -FACING
    };
    surface.own_depth.is_none() || path.parts().all(|part| looks(part.segment))
}

impl Kinematics {
    /// Creates empty kinematics, with or without variations.
    pub fn new(varied: bool) -> Self {
        Self { varied, ..Self::default() }
    }

    /// Sets the normal and clears everything else.
    pub fn begin(&mut self, normal: Vector2<f64>) {
        (self.normal, self.tangent) = (normal, tangent_of(normal));
        (self.slip, self.length, self.lean) = (0.0, 0.0, 0.0);
        self.lever = None;
        self.nodes.clear();
        self.changing.clear();
        self.drelative.clear();
        self.dlever.iter_mut().for_each(Vec::clear);
    }

    /// Sets all weights and variations to zero, once the nodes are listed.
    pub fn clear(&mut self) {
        let dofs = if self.varied { 2 * self.nodes.len() } else { 0 };
        let Self { relative, dgap, dslip, drotation, dlength, dlean, dxi, .. } = self;
        relative.clear();
        relative.resize(self.nodes.len(), 0.0);
        for row in [dgap, dslip, drotation, dlength, dlean, dxi] {
            row.clear();
            row.resize(dofs, 0.0);
        }
    }

    /// Adds participating nodes, each once.
    pub fn list(&mut self, nodes: impl IntoIterator<Item = usize>) {
        for node in nodes {
            if !self.nodes.contains(&node) {
                self.nodes.push(node);
            }
        }
    }

    /// Computes δg, δθ, δξ and δw of a projection on a surface.
    fn vary_projection(&mut self, slave: &SlavePoint, surface: &Surface, projection: &Projection, x: &Configuration) {
        if !self.varied {
            return;
        }
        let MasterPoint { segment, xi } = projection.master_point;
        let (curve, n, s, gap) = (&surface.segments[segment], self.normal, self.tangent, projection.gap);
        let (master_point, slope) = (curve.position(xi), curve.slope(xi));
        let length = x.combine(&slope).norm();
        // Variation of x_s − x_m
        let vary = |k: &mut Self, direction: Vector2<f64>, row: fn(&mut Self) -> &mut Vec<f64>| {
            k.vary(&slave.position, direction, row);
            k.vary(&master_point, -direction, row);
        };
        vary(self, n, |k| &mut k.dgap);
        match projection.bound {
            Bound::Node(_) if gap != 0.0 => vary(self, -s / gap, |k| &mut k.drotation),
            Bound::Node(_) | Bound::Rigid { .. } => {}
            Bound::Segment => {
                let bend = x.combine(&curve.bend(xi)).dot(&n);
                let stiffness = length * length - gap * bend;
                vary(self, s * (length / stiffness), |k| &mut k.dxi);
                self.vary(&slope, n * (gap / stiffness), |k| &mut k.dxi);
                self.vary(&slope, n / length, |k| &mut k.drotation);
                let Self { drotation, dxi, drelative, .. } = self;
                drotation.iter_mut().zip(&*dxi).for_each(|(turn, dxi)| *turn += dxi * (bend / length));
                slope.iter().for_each(|(_, rate)| drelative.extend(dxi.iter().map(|dxi| dxi * -rate)));
                slope.iter().for_each(|&(node, _)| self.changing.push(self.local(node)));
            }
        }
    }

    /// ∫ J dξ along a part of a path, and ∫ s·δx′ dξ.
    fn slide(&mut self, surface: &Surface, part: PathPart, x: &Configuration) {
        let PathPart { segment, start, end } = part;
        let segment = &surface.segments[segment];
        let points = if segment.is_straight() { 1 } else { 4 };
        for (at, weight) in shape::gauss(points) {
            let slope = segment.slope(start + 0.5 * (1.0 + at) * (end - start));
            let along = x.combine(&slope);
            let share = 0.5 * weight * (end - start);
            self.slip += share * along.norm();
            self.vary(&slope, along.normalize() * share, |k| &mut k.dslip);
        }
    }

    /// Measures the slip of a point that had no projection in the configuration `before`; `body` is that of a moving rigid
    /// master.
    pub fn count_from(&mut self, body: Option<&RigidBody>, before: &Configuration, x: &Configuration) {
        let motion = |node: usize| x.since(before, node);
        let mut whole: Vector2<f64> = self.nodes.iter().zip(&self.relative).map(|(&node, &w)| w * motion(node)).sum();
        if let Some(body) = body {
            let offset = |(&node, &w): (&usize, &f64)| before.between(body.reference, node) * w;
            let separation =
                self.nodes.iter().zip(&self.relative).filter(|(node, _)| **node != body.turning).map(offset).sum();
            whole -= turned(separation, body.angle(x) - body.angle(before));
        }
        let (n, s) = (self.normal, self.tangent);
        self.slip = s.dot(&whole);
        if !self.varied {
            return;
        }
        let Self { nodes, relative, dslip, drotation, changing, drelative, .. } = self;
        dslip.iter_mut().zip(&*drotation).for_each(|(dslip, turn)| *dslip = turn * n.dot(&whole));
        if let (Some(body), Some(Lever { at, arm })) = (body, self.lever) {
            dslip[2 * at] += s.dot(&arm) - n.dot(&whole) / body.radius;
        }
        for (a, &w) in relative.iter().enumerate() {
            dslip[2 * a] += w * s.x;
            dslip[2 * a + 1] += w * s.y;
        }
        for (&a, dw) in changing.iter().zip(drelative.chunks_exact(2 * nodes.len())) {
            let along = s.dot(&motion(nodes[a]));
            dslip.iter_mut().zip(dw).for_each(|(dslip, dw)| *dslip += dw * along);
        }
    }

    /// Adds the nodes of the slave side.
    fn list_slave(&mut self, slave: &SlavePoint) {
        let shares = slave.length.iter().flat_map(|share| &share.tangent);
        self.list(slave.position.iter().chain(shares).map(|&(node, _)| node));
    }

    /// Sets the slave's weights and its length, once all nodes are listed; everything else is zero.
    fn take_slave(&mut self, slave: &SlavePoint, x: &Configuration) {
        self.clear();
        self.length = slave.current_length(x);
        for &(node, w) in &slave.position {
            let at = self.local(node);
            self.relative[at] += w;
        }
        if !self.varied {
            return;
        }
        for share in &slave.length {
            let along = x.combine(&share.tangent);
            let depth = x.weight(&share.at);
            self.vary(&share.tangent, along * (depth * share.factor / along.norm()), |k| &mut k.dlength);
            if let Some(slope) = x.weight_slope(&share.at) {
                self.vary(&share.at, slope * (share.factor * along.norm()), |k| &mut k.dlength);
            }
        }
    }

    /// Sets the weight of a rigid body, and its lever with its variation, after the slave's weights.
    fn take_rigid(&mut self, slave: &SlavePoint, body: &RigidBody, x: &Configuration) {
        let [reference, at] = [body.reference, body.turning].map(|node| self.local(node));
        self.relative[reference] = -1.0;
        let [separation, moved] = x.split(&slave.position, x.reference(body.reference));
        let arm = -normal_of(separation + moved - x.displacement(body.reference)) / body.radius;
        self.lever = Some(Lever { at, arm });
        if !self.varied {
            return;
        }
        // δb = −J (δx_s − δu_R)/r
        for (i, direction) in [Vector2::y(), -Vector2::x()].into_iter().enumerate() {
            self.dlever[i].resize(2 * self.nodes.len(), 0.0);
            let direction = direction / body.radius;
            self.vary(&slave.position, direction, |k| &mut k.dlever[i]);
            self.vary(&[(body.reference, 1.0)], -direction, |k| &mut k.dlever[i]);
        }
    }

    /// Adds `direction`·δr to a variation: the motion of the slave relative to its rigid master.
    fn vary_past(
        &mut self,
        slave: &SlavePoint,
        rigid: &Rigid,
        direction: Vector2<f64>,
        row: impl Fn(&mut Self) -> &mut Vec<f64>,
    ) {
        self.vary(&slave.position, direction, &row);
        if let (Some(body), Some(Lever { at, arm }), true) = (&rigid.body, self.lever, self.varied) {
            self.vary(&[(body.reference, 1.0)], -direction, &row);
            row(self)[2 * at] += direction.dot(&arm);
        }
    }

    fn local(&self, node: usize) -> usize {
        self.nodes.iter().position(|&n| n == node).expect("every node of a contact point is listed when it is built")
    }

    /// Adds `direction`·Σ w_a δx_a to a variation.
    fn vary(&mut self, weights: &[(usize, f64)], direction: Vector2<f64>, row: impl Fn(&mut Self) -> &mut Vec<f64>) {
        if !self.varied {
            return;
        }
        let mut variation = std::mem::take(row(self));
        for &(node, w) in weights {
            let at = 2 * self.local(node);
            variation[at] += w * direction.x;
            variation[at + 1] += w * direction.y;
        }
        *row(self) = variation;
    }
}
