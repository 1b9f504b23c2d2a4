//! Small sliding: every point keeps its projection of the reference configuration.
//!
//! ```text
//! g = g₀ + n·Σ w_a u_a        Δu_t = s·Σ w_a Δu_a        Σ w_a x_a = x_s − x_foot
//! f_a = −w_a (p n − q s) ℓ
//! ```
//!
//! Projection, weights w_a of slave and master, n, s and ℓ are those of the reference configuration: g and Δu_t are linear in
//! the displacements, with the constant rows B_n = w_a n and B_t = w_a s, and the work-conjugate forces are
//! f = −ℓ (p B_nᵀ − q B_tᵀ). With linear bodies only opening and friction are nonlinear.
//!
//! Neglected are the motion of the projection (the forces of the two sides are in balance, but leave the moment p ℓ d after a
//! slip d, in addition to the q ℓ g of finite sliding) and the rotation and stretch of the surfaces: small sliding is objective
//! for small rotations only. All this is of second order in the displacements, except in a contact that starts closed, whose
//! initial traction rotates and stretches to first order in finite sliding and not at all here. (Nor does the initial stress of
//! `linear` bodies, with which it is in equilibrium.) A point without a projection in the reference configuration never comes
//! into contact.
//!
//! [`SmallPoint::departure`] measures the deviation of a point from these assumptions. For a block compressed on another and
//! slid by a tenth of an edge, the pressures agree with finite sliding within 4 to 15 % where they vary from edge to edge, its
//! forces and displacements within 1 %.

use nalgebra::Vector2;

use super::kinematics::{Kinematics, Lever, Meeting};
use super::master::Master;
use super::projection::normal_of;
use super::surface::{MasterPoint, Segment, SlavePoint, Weights};
use crate::mesh::configuration::Configuration;

/// Constant operators of the points of a pair.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallSliding {
    /// Operator of each point, in order; `None` without a projection
    pub points: Vec<Option<SmallPoint>>,
}

impl SmallSliding {
    /// Slip up to which small sliding is accurate, at the smallest node distance; `None` on a rigid body [L].
    pub fn little_slip(&self) -> Option<f64> {
        let little = |point: &SmallPoint| match point.against {
            Against::Mesh { spacing, .. } => Some(LITTLE_SLIP * spacing),
            Against::Rigid { .. } => None,
        };
        self.points.iter().flatten().filter_map(little).min_by(f64::total_cmp)
    }
}

/// Constant operator of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallPoint {
    /// Participating nodes
    pub nodes: Vec<usize>,
    /// w_a of each node; their sum is zero for a master that may move, one for a fixed rigid one
    pub weights: Vec<f64>,
    /// Lever of a rigid master that may rotate
    pub lever: Option<Lever>,
    /// w_a of s J, of a point whose axes turn with the slave: none in small sliding
    turning: Option<Weights>,
    /// n
    pub normal: Vector2<f64>,
    /// s
    pub tangent: Vector2<f64>,
    /// g₀ between the surfaces [L]
    pub gap: f64,
    /// ℓ: tributary length of the point [L]
    pub length: f64,
    /// Closest-point projection on the master
    pub master_point: MasterPoint,
    /// Part of the master on which its projection stays
    against: Against,
}

/// Part of the master on which a projection stays.
#[derive(Clone, Debug, PartialEq)]
enum Against {
    /// A segment with these ends; `spacing` is the smallest distance between nodes of either side [L]
    Mesh { ends: [usize; 2], spacing: f64 },
    /// A rigid body with this normal at the projection of the point's node
    Rigid { normal: Vector2<f64> },
}

/// Deviation of a point from the assumptions of small sliding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure {
    /// Slip since the reference configuration [L]
    pub slid: f64,
    /// Slip as a fraction of the smaller distance between nodes; 0 on a rigid body [-]
    pub share: f64,
    /// Rotation of its edges and the master's, or of the normal of a rigid body at its projection [rad]
    pub turned: f64,
    /// Relative change of length of its edges [-]
    pub stretched: f64,
}

/// Fraction of the distance between nodes (a linear edge, or half a quadratic one) up to which small sliding is accurate.
pub const LITTLE_SLIP: f64 = 0.1;

/// Weights below this are round-off of those of a node opposite another node.
const ROUND_OFF: f64 = 1e-9;

/// Rotation and stretch up to which small sliding is accurate [rad, -].
pub const LITTLE_TURN: f64 = 0.02;

impl SmallPoint {
    /// Creates the operator of a point with this projection in the reference configuration `x`.
    pub fn new(met: Meeting, k: &Kinematics, slave: &SlavePoint, master: &Master, x: &Configuration) -> Self {
        let Meeting { gap, master_point } = met;
        let Kinematics { normal, tangent, length, .. } = *k;
        let takes_part =
            |k: &Kinematics, at: usize| k.relative[at] != 0.0 || k.lever.is_some_and(|lever| lever.at == at);
        // Where slave and master share the node, as at the tip of a crack, none takes part; one stands for the point.
        let none = !(0..k.nodes.len()).any(|at| takes_part(k, at));
        let part = (0..k.nodes.len()).filter(|&at| takes_part(k, at) || none && at == 0);
        let (nodes, weights): (Vec<usize>, Vec<f64>) = part.map(|at| (k.nodes[at], k.relative[at])).unzip();
        let place = |lever: Lever| nodes.iter().position(|node| *node == k.nodes[lever.at]);
        let lever = k.lever.and_then(|lever| Some(Lever { at: place(lever)?, ..lever }));
        let against = match master {
            Master::Rigid(body) => {
                Against::Rigid { normal: body.project(slave, x).map_or(normal, |projection| projection.normal) }
            }
            Master::Mesh(surface) => {
                let Segment { ends, middle, .. } = surface.segments[master_point.segment];
                let spacing = |(quadratic, [a, b]): (bool, [usize; 2])| {
                    let edge = x.between(a, b).norm();
                    if quadratic { 0.5 * edge } else { edge }
                };
                let own = slave.length.iter().map(|share| share.tangent.len() > 2).zip(edges(slave)).map(spacing);
                Against::Mesh { ends, spacing: own.fold(spacing((middle.is_some(), ends)), f64::min) }
            }
        };
        Self { nodes, weights, lever, turning: None, normal, tangent, gap, length, master_point, against }
    }

    /// Turns the axes with the edges of the slave.
    pub fn turning_with(mut self, slave: &SlavePoint) -> Self {
        let shares = slave.length.iter();
        let along: Weights =
            shares.flat_map(|share| share.tangent.iter().map(|&(node, w)| (node, share.factor * w))).collect();
        for &(node, _) in &along {
            if !self.nodes.contains(&node) {
                self.nodes.push(node);
                self.weights.push(0.0);
            }
        }
        Self { turning: Some(along), ..self }
    }

    /// The slave node and its opposite master node, or the slave node alone on a rigid master; `None` if the point involves
    /// more than one node of either side, or the master may rotate. A node and its copies on a periodic side are one, its `original`.
    pub fn facing(&self, original: impl Fn(usize) -> usize) -> Option<(usize, Option<usize>)> {
        if self.lever.is_some() || self.turning.is_some() {
            return None;
        }
        let mut weights: Vec<(usize, f64)> = Vec::with_capacity(self.nodes.len());
        for (node, weight) in self.nodes.iter().map(|&node| original(node)).zip(&self.weights) {
            match weights.iter_mut().find(|(known, _)| *known == node) {
                Some((_, sum)) => *sum += weight,
                None => weights.push((node, *weight)),
            }
        }
        let mut part = weights.into_iter().filter(|(_, w)| w.abs() > ROUND_OFF);
        let whole = |(node, w): (usize, f64), of: f64| ((w - of).abs() <= ROUND_OFF).then_some(node);
        let (first, second) = (part.next()?, part.next());
        let slave = whole(first, 1.0)?;
        let master = match second {
            Some(second) => Some(whole(second, -1.0)?),
            None => None,
        };
        part.next().is_none().then_some((slave, master))
    }

    /// Deviation of the point from the initial geometry; `None` beyond the end of a rigid body.
    pub fn departure(&self, slave: &SlavePoint, master: &Master, x: &Configuration) -> Option<Departure> {
        let slid = self.tangent.dot(&self.displacement(x)).abs();
        let stretched = edges(slave).map(|[a, b]| x.stretch(a, b).abs()).fold(0.0, f64::max);
        let turn = |[a, b]: [usize; 2]| x.turn(a, b).abs();
        let (share, turned) = match (&self.against, master) {
            (Against::Mesh { ends, spacing }, _) => {
                (slid / spacing, edges(slave).map(turn).fold(turn(*ends), f64::max))
            }
            (Against::Rigid { normal }, Master::Rigid(body)) => (0.0, body.project(slave, x)?.normal.angle(normal)),
            (Against::Rigid { .. }, Master::Mesh(_)) => return None,
        };
        Some(Departure { slid, share, turned, stretched })
    }

    /// B_n: ∂g/∂u of the nodes, two dofs a node.
    pub fn normal_row(&self) -> impl Iterator<Item = f64> {
        self.row(self.normal)
    }

    /// B_t: ∂Δu_t/∂u of the nodes, two dofs a node.
    pub fn tangent_row(&self) -> impl Iterator<Item = f64> {
        self.row(self.tangent)
    }

    fn row(&self, direction: Vector2<f64>) -> impl Iterator<Item = f64> {
        let of = move |(at, w): (usize, &f64)| match self.lever {
            Some(lever) if lever.at == at => [lever.arm.dot(&direction), 0.0],
            _ => [w * direction.x, w * direction.y],
        };
        self.weights.iter().enumerate().flat_map(of)
    }

    /// Σ w_a of a motion of the nodes; a common motion of both sides is subtracted first to avoid its round-off.
    fn relative(&self, motion: impl Fn(usize) -> Vector2<f64>) -> Vector2<f64> {
        let common = match self.against {
            Against::Mesh { .. } => motion(self.nodes[0]),
            Against::Rigid { .. } => Vector2::zeros(),
        };
        let turned = self.lever.map(|Lever { at, arm }| arm * motion(self.nodes[at]).x);
        self.nodes.iter().zip(&self.weights).map(|(&node, &w)| (motion(node) - common) * w).chain(turned).sum()
    }

    /// Displacement of the point relative to its projection since the reference configuration [L].
    pub fn displacement(&self, x: &Configuration) -> Vector2<f64> {
        self.relative(|node| x.displacement(node))
    }

    /// Does the same as [`Self::meet`], in axes that turn with the slave:
    ///
    /// ```text
    /// g = n·r,   Δu_t = s·r − (s·r)_before,   r = Σ w_a x_a
    /// δg = n·δr − s·r δθ,   δΔu_t = s·δr + n·r δθ,   δθ = n·δ(J s)/J
    /// ```
    fn meet_turning(&self, along: &Weights, [before, x]: [&Configuration; 2], k: &mut Kinematics) -> Meeting {
        let separation = |x: &Configuration| self.relative(|node| x.between(self.nodes[0], node));
        let ([s, n], length) = axes(along, x);
        let (r, [was_s, _]) = (separation(x), axes(along, before).0);
        (k.normal, k.tangent) = (n, s);
        k.slip = s.dot(&r) - was_s.dot(&separation(before));
        if k.varied {
            let Kinematics { drotation, dgap, dslip, .. } = k;
            for &(node, w) in along {
                let at = self.nodes.iter().position(|own| *own == node).unwrap_or_default();
                (0..2).for_each(|i| drotation[2 * at + i] += w * n[i] / length);
            }
            for (dof, turn) in drotation.iter().enumerate() {
                let w = self.weights[dof / 2];
                dgap[dof] = w * n[dof % 2] - s.dot(&r) * turn;
                dslip[dof] = w * s[dof % 2] + n.dot(&r) * turn;
            }
        }
        Meeting { gap: n.dot(&r), master_point: self.master_point }
    }

    /// Projection of the point on the master, with the slip since the configuration `before`.
    pub fn meet(&self, before: &Configuration, x: &Configuration, k: &mut Kinematics) -> Meeting {
        k.begin(self.normal);
        k.nodes.extend_from_slice(&self.nodes);
        k.clear();
        k.relative.copy_from_slice(&self.weights);
        k.lever = self.lever;
        if k.varied && k.lever.is_some() {
            k.dlever.iter_mut().for_each(|row| row.resize(2 * self.nodes.len(), 0.0));
        }
        (k.tangent, k.length) = (self.tangent, self.length);
        if let Some(along) = &self.turning {
            return self.meet_turning(along, [before, x], k);
        }
        k.slip = self.tangent.dot(&self.relative(|node| x.since(before, node)));
        k.dgap.iter_mut().zip(self.normal_row()).for_each(|(dgap, value)| *dgap = value);
        k.dslip.iter_mut().zip(self.tangent_row()).for_each(|(dslip, value)| *dslip = value);
        Meeting { gap: self.gap + self.normal.dot(&self.displacement(x)), master_point: self.master_point }
    }
}

/// Axes s and n along a direction Σ w_a x_a, and its length.
fn axes(along: &Weights, x: &Configuration) -> ([Vector2<f64>; 2], f64) {
    let direction = x.combine(along);
    let s = direction.normalize();
    ([s, normal_of(s)], direction.norm())
}

/// Ends of the edges that a slave point belongs to.
fn edges(slave: &SlavePoint) -> impl Iterator<Item = [usize; 2]> {
    slave.length.iter().map(|share| [share.tangent[0].0, share.tangent[1].0])
}
