//! Bond of a bar with the body that it lies in, at a point of a segment.
//!
//! ```text
//! d = x_bar − x_body,   s = d·t − s₀,   v = d·n − v₀          t, n: along and across the segment
//! f = ℓ (q ∂s + k_n v ∂v)                                   q(s): the law of bonds, per length of the bar
//! ∂s = t·∂d + (d·n) ∂α,   ∂v = n·∂d − (d·t) ∂α              α: angle of the segment
//! ```
//! With μ the strength of the bond is c + μ p and c_r + μ p, p: pressure of the body across the bar at the start of an increment, in which
//! it stays.
//! The point of the body is the one where the bar was when it came: slip is small against the elements. s₀ and v₀ are what it was
//! apart then. Points are the ends of segments (trapezoidal rule), which keeps stiff bond from oscillating along the bar.

use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

use super::vectors::{Answer, Vectors, bending_of_angle, turned};
use crate::laws::friction::{Bond, BondParameters, BondState, BondSurfaces};

/// A bonded point.
#[derive(Clone, Debug, PartialEq)]
pub struct Grip {
    /// d and e
    pub vectors: Vectors,
    /// its vertex
    pub vertex: usize,
    /// element of the body that it lies in
    pub element: usize,
    /// ℓ: length of the bar that belongs to it [L]
    pub length: f64,
    /// law along the bar, forces per length of the bar, without pressure
    pub bond: Bond,
    /// μ times the thickness of the body [L]
    pub mu: f64,
    /// k_n [F/L²]
    pub normal: f64,
}

/// State of a bonded point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GripState {
    /// s₀ and v₀ [L]
    pub natural: [f64; 2],
    /// s [L]
    pub slip: f64,
    /// v [L]
    pub across: f64,
    /// state of the law
    pub bond: BondState,
    /// whether it slipped in the last increment
    pub slips: bool,
}

/// What a bonded point has found.
pub struct Gripped {
    /// state
    pub state: GripState,
    /// stored [F·L]
    pub stored: f64,
    /// dissipated [F·L]
    pub dissipated: f64,
}

impl Grip {
    /// State of one that comes without force at displacements.
    pub fn activated(&self, u: &[f64]) -> GripState {
        let [d, edge] = self.vectors.ways(u);
        let t = (self.vectors.at[1] + edge).normalize();
        GripState { natural: [d.dot(&t), d.dot(&turned(t))], bond: self.bond.start(None, 0.0), ..GripState::default() }
    }

    /// The law under a pressure of the body.
    fn under(&self, pressure: f64) -> Bond {
        let friction = self.mu * pressure.max(0.0);
        if friction == 0.0 {
            return self.bond;
        }
        let mut parameters = BondParameters::new(self.bond.strength() + friction);
        parameters.residual = Some(self.bond.residual() + friction);
        parameters.slip = Some(self.bond.slip()).filter(|slip| slip.is_finite());
        let stiffness = self.bond.stiffness();
        // Softening is as steep as without friction, which was checked.
        Bond::new(&parameters, BondSurfaces::new(stiffness, stiffness, 0.0)).unwrap_or(self.bond)
    }

    /// Unit normal of the bar, to its left.
    pub fn normal_direction(&self, u: &[f64]) -> Vector2<f64> {
        turned((self.vectors.at[1] + self.vectors.ways(u)[1]).normalize())
    }

    /// Evaluates it at displacements, under a pressure of the body.
    pub fn respond(&self, old: &GripState, u: &[f64], pressure: f64) -> (Answer, Gripped) {
        let [d, edge] = self.vectors.ways(u);
        let e = self.vectors.at[1] + edge;
        let size = e.norm();
        let t = e / size;
        let n = turned(t);
        let (along, across) = (d.dot(&t), d.dot(&n));
        let (slip, opened) = (along - old.natural[0], across - old.natural[1]);
        let found = self.under(pressure).respond(&old.bond, 0.0, slip - old.slip, false);
        let (q, p) = (self.length * found.state.traction, self.length * self.normal * opened);
        let slope = n / size;
        // ∂s and ∂v by d and e
        let by_slip = [t, slope * across];
        let by_normal = [n, slope * -along];
        let turn = slope * slope.transpose();
        let bent = bending_of_angle(e);
        let crossed = |of: Vector2<f64>| -> Matrix2<f64> { of * slope.transpose() };
        // second derivatives of s and v, by d and e and by e twice
        let of_slip = [crossed(n), bent * across - turn * along];
        let of_normal = [-crossed(t), -bent * along - turn * across];
        let [stiff, tied] = [self.length * found.dtraction[1], self.length * self.normal];
        let rate = |i: usize, j: usize| {
            let first = by_slip[i] * by_slip[j].transpose() * stiff + by_normal[i] * by_normal[j].transpose() * tied;
            let second = match (i, j) {
                (0, 0) => Matrix2::zeros(),
                (0, 1) => of_slip[0] * q + of_normal[0] * p,
                (1, 0) => (of_slip[0] * q + of_normal[0] * p).transpose(),
                _ => of_slip[1] * q + of_normal[1] * p,
            };
            first + second
        };
        let answer = Answer {
            forces: [0, 1].map(|i| by_slip[i] * q + by_normal[i] * p),
            rates: [[rate(0, 0), rate(0, 1)], [rate(1, 0), rate(1, 1)]],
        };
        let traction = found.state.traction;
        let stored = traction * traction / self.bond.stiffness() + self.normal * opened * opened;
        let state =
            GripState { natural: old.natural, slip, across: opened, bond: found.state, slips: found.plastic != 0.0 };
        (answer, Gripped { state, stored: 0.5 * self.length * stored, dissipated: self.length * found.dissipation })
    }
}
