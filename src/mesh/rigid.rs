//! Rigid bodies: masters of contacts that move as a whole.
//!
//! Two nodes without elements carry the motion of a rigid body, one its displacement and the other its rotation:
//!
//! ```text
//! x = x_R + Q(θ)(X − X_R)          x_R = X_R + u_R     dofs of the reference node: u_R        forces on it: F
//!                                                      first dof of the turning node: r θ     force on it: M/r, M about x_R
//! ```
//!
//! A freely moving rigid body has a point mass at the reference node, its centre of mass; its moment of inertia I is
//! represented by a mass I/r² at the turning node: m a = F, I θ̈ = M.
//!
//! r is the distance of the farthest point of the body's own outline from its reference, so that r θ is how far a rotation moves
//! that point: all dofs are displacements and their conjugates forces, and what is said of a displacement, such as an allowed
//! error or the coefficient of a dashpot, is said of it. What a body does not touch has no part in r. The second dof of the
//! turning node is unused and 0. Supports, reactions, energies, time schemes and checkpoints therefore need no special treatment
//! of rigid bodies.

use nalgebra::{Rotation2, Vector2};

use super::configuration::Configuration;

/// A rigid body, given by the nodes that carry its motion.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidBody {
    /// Name, also that of a group with its reference node
    pub name: String,
    /// The node at its reference point
    pub reference: usize,
    /// Node that carries its rotation
    pub turning: usize,
    /// r: the farthest point of its outline from the reference; displacement of the turning node per angle [L]
    pub radius: f64,
    /// Moment of inertia about the reference point, 0 if none is given [M L²]
    pub inertia: f64,
}

impl RigidBody {
    /// Returns the two nodes.
    pub fn nodes(&self) -> [usize; 2] {
        [self.reference, self.turning]
    }

    /// Mass of the turning node [M].
    pub fn turning_mass(&self) -> f64 {
        self.inertia / self.radius.powi(2)
    }

    /// θ, counter-clockwise [rad].
    pub fn angle(&self, x: &Configuration) -> f64 {
        x.displacement(self.turning).x / self.radius
    }

    /// Q(θ).
    pub fn rotation(&self, x: &Configuration) -> Rotation2<f64> {
        Rotation2::new(self.angle(x))
    }

    /// A point in the body-fixed frame: X − origin, and its displacement Qᵀ(u − u_R) + (Qᵀ − I)(X − X_R).
    pub fn seen(&self, weights: &[(usize, f64)], origin: Vector2<f64>, x: &Configuration) -> [Vector2<f64>; 2] {
        let [separation, u] = x.split(weights, origin);
        let [arm, moved] = [x.split(weights, x.reference(self.reference))[0], u - x.displacement(self.reference)];
        [separation, self.rotation(x).inverse() * moved + turned(arm, -self.angle(x))]
    }
}

/// (Q − I) a, accurate for small angles.
pub fn turned(a: Vector2<f64>, angle: f64) -> Vector2<f64> {
    let (sine, versed) = (angle.sin(), 2.0 * (0.5 * angle).sin().powi(2));
    Vector2::new(-versed * a.x - sine * a.y, sine * a.x - versed * a.y)
}
