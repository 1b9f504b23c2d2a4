//! The angle between two segments of a beam, or between a clamped end and its first segment.
//!
//! ```text
//! M = EI (θ − θ₀)/l_m,   θ = α(e₂) − α(e₁)
//! ∂θ/∂e₂ = J e₂/|e₂|²,   ∂θ/∂e₁ = −J e₁/|e₁|²          α: angle of a vector, J: turned by +90°
//! ```
//! l_m is the length that bends: half of both segments, or half of the one next to a clamp.

use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

use super::vectors::{Answer, Measure, Vectors, bending_of_angle, turned};

/// An angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// e₁ and e₂
    pub vectors: Vectors,
    /// its vertex
    pub vertex: usize,
    /// l_m [L]
    pub length: f64,
}

/// State of an angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TurnState {
    /// What it was larger than in the mesh when it came [rad]
    pub natural: f64,
    /// M [F·L]
    pub moment: f64,
}

/// Change of the angle of a vector by a way, accurate for small ones [rad].
fn rotation(before: Vector2<f64>, way: Vector2<f64>) -> f64 {
    before.perp(&way).atan2(before.norm_squared() + before.dot(&way))
}

impl Turn {
    /// θ less that in the mesh, within half a turn [rad].
    fn angle(&self, u: &[f64]) -> f64 {
        let ([first, second], [way, other]) = (self.vectors.at, self.vectors.ways(u));
        let angle = rotation(second, other) - rotation(first, way);
        let whole = std::f64::consts::TAU;
        angle - whole * (angle / whole).round()
    }

    /// State of one that comes without moment at displacements.
    pub fn activated(&self, u: &[f64]) -> TurnState {
        TurnState { natural: self.angle(u), moment: 0.0 }
    }

    /// θ at displacements.
    pub fn bend(&self, u: &[f64]) -> Measure {
        let ways = self.vectors.ways(u);
        let e = [0, 1].map(|i| self.vectors.at[i] + ways[i]);
        let sign = [-1.0, 1.0];
        let slopes = [0, 1].map(|i| turned(e[i]) / e[i].norm_squared() * sign[i]);
        (slopes, [0, 1].map(|i| bending_of_angle(e[i]) * sign[i]))
    }

    /// Evaluates it at displacements, with the energy stored.
    pub fn respond(&self, ei: f64, old: &TurnState, u: &[f64]) -> (Answer, TurnState, f64) {
        let stiffness = ei / self.length;
        let angle = self.angle(u) - old.natural;
        let moment = stiffness * angle;
        let (slopes, curvatures) = self.bend(u);
        let rate = |i: usize, j: usize| -> Matrix2<f64> {
            let both = slopes[i] * slopes[j].transpose() * stiffness;
            if i == j { both + curvatures[i] * moment } else { both }
        };
        let rates = [[rate(0, 0), rate(0, 1)], [rate(1, 0), rate(1, 1)]];
        let answer = Answer { forces: slopes.map(|slope| slope * moment), rates };
        (answer, TurnState { natural: old.natural, moment }, 0.5 * moment * angle)
    }
}
