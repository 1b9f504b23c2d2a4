//! Small sliding: every point keeps meeting what it met in the reference configuration.
//!
//! ```text
//! g = g₀ + n·Σ w_a u_a        Δu_t = s·Σ w_a Δu_a        Σ w_a x_a = x_s − x_foot
//! f_a = −w_a (p n − q s) ℓ
//! ```
//!
//! The foot, the weights w_a of slave and master, n, s and ℓ are those of the reference configuration: g and Δu_t are linear in
//! the displacements, by the constant rows B_n = w_a n and B_t = w_a s, and the forces are what does work on them,
//! f = −ℓ (p B_nᵀ − q B_tᵀ). With linear bodies nothing but opening and friction is nonlinear.
//!
//! What is left out: that the foot moves on (forces of the pair are in balance, but their moments are short of p ℓ times the way slid, besides
//! q ℓ g, which finite sliding leaves as well), that the surfaces turn (objective for small rotations only) and stretch. The
//! traction with which a contact starts closed turns and stretches by the first order of the displacements in finite sliding, and not at
//! all here. A point that nothing faces in the reference configuration never touches.
//!
//! [`SmallPoint::departure`] says how far a point has left all this behind.

use nalgebra::Vector2;

use super::kinematics::{Kinematics, Meeting};
use super::master::Master;
use super::point::MasterPoint;
use crate::mesh::configuration::Configuration;

/// The constant operators of a pair's points.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallSliding {
    /// Operator of each point, in their order; `None` where nothing faces it
    pub points: Vec<Option<SmallPoint>>,
}

/// The constant operator of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallPoint {
    /// Nodes that take part
    pub nodes: Vec<usize>,
    /// w_a of each; they sum to zero on a master of the mesh, to one on a rigid one
    pub weights: Vec<f64>,
    /// n
    pub normal: Vector2<f64>,
    /// s
    pub tangent: Vector2<f64>,
    /// g₀ between the surfaces [L]
    pub gap: f64,
    /// ℓ: length the point stands for [L]
    pub length: f64,
    /// The foot
    pub foot: MasterPoint,
    /// Whether the master is rigid
    rigid: bool,
}

impl SmallPoint {
    /// The operator of a point that meets the master so in the reference configuration.
    pub fn new(Meeting { gap, foot }: Meeting, kinematics: &Kinematics, master: &Master) -> Self {
        let Kinematics { nodes, relative, normal, tangent, length, .. } = kinematics;
        let (normal, tangent, length) = (*normal, *tangent, *length);
        let entries = nodes.iter().copied().zip(relative.iter().copied()).filter(|(_, w)| *w != 0.0);
        let (nodes, weights) = entries.unzip();
        Self { nodes, weights, normal, tangent, gap, length, foot, rigid: matches!(master, Master::Rigid(_)) }
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
        self.weights.iter().flat_map(move |w| [w * direction.x, w * direction.y])
    }

    /// Σ w_a of some motion of the nodes; a common motion of both sides is taken out before it can leave its round-off.
    fn relative(&self, motion: impl Fn(usize) -> Vector2<f64>) -> Vector2<f64> {
        let common = if self.rigid { Vector2::zeros() } else { motion(self.nodes[0]) };
        self.nodes.iter().zip(&self.weights).map(|(&node, &w)| (motion(node) - common) * w).sum()
    }

    /// Motion of the point against its foot since the reference configuration [L].
    pub fn displacement(&self, x: &Configuration) -> Vector2<f64> {
        self.relative(|node| x.displacement(node))
    }

    /// Where the point meets the master, its slip counted from the configuration `before`.
    pub fn meet(&self, before: &Configuration, x: &Configuration, k: &mut Kinematics) -> Meeting {
        k.begin(self.normal);
        k.nodes.extend_from_slice(&self.nodes);
        k.clear();
        k.relative.copy_from_slice(&self.weights);
        (k.tangent, k.length) = (self.tangent, self.length);
        k.slip = self.tangent.dot(&self.relative(|node| x.since(before, node)));
        k.dgap.iter_mut().zip(self.normal_row()).for_each(|(dgap, value)| *dgap = value);
        k.dslip.iter_mut().zip(self.tangent_row()).for_each(|(dslip, value)| *dslip = value);
        Meeting { gap: self.gap + self.normal.dot(&self.displacement(x)), foot: self.foot }
    }
}
