//! What a contact point remembers between increments, and what it says of itself.

use serde::{Deserialize, Serialize};

use super::point::MasterPoint;
use crate::laws::friction::{FrictionState, Regime};

/// Memory of one contact point between increments.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactState {
    /// What friction remembers
    pub friction: FrictionState,
    /// Foot on the master, open or closed; `None` where no part of the master faces the point
    pub foot: Option<MasterPoint>,
    /// Length the point stands for: its own or, by mortar, the part of it that the master faces; once open, the last one
    /// (that of now where a fluid acts) [L]
    pub length: f64,
    /// g at the foot; a contact that starts closed counts it from where its points touch [L]
    pub gap: f64,
    /// Δu_t of the last increment, what came before touch included; 0 while open [L]
    pub slip: f64,
    /// η v of the last increment, what slip radiates; 0 without radiation damping, and in dynamic steps [F/L²]
    pub radiation: f64,
    /// Energy radiated so far per contact area [F/L]
    pub radiated: f64,
    /// p̄: pressure at zero gap, raised until the penetration is small enough; 0 for the plain penalty [F/L²]
    pub multiplier: f64,
    /// p_w: pressure of the fluid where the master faces the point [F/L²]
    pub fluid: f64,
}

impl ContactState {
    /// g − d: what parts the surfaces beyond the opening of the law, negative under the penalty [L]
    pub fn clearance(&self) -> f64 {
        self.gap - self.friction.opening
    }

    /// p and q + η v: what the surfaces put on each other, friction and what slip radiates together [F/L²]
    pub fn tractions(&self) -> [f64; 2] {
        [self.friction.pressure, self.friction.traction + self.radiation]
    }

    /// Whether a point is open at a gap that counts, more than [`ContactPair::touch`](super::pair::ContactPair::touch).
    pub fn apart(&self, touch: f64) -> bool {
        self.friction.pressure == 0.0 && self.clearance() > touch
    }

    /// Open, stick or slip, as the law says; a point that only a promise keeps closed is open.
    pub fn regime(&self) -> Regime {
        if self.friction.pressure > 0.0 { self.friction.regime } else { Regime::Open }
    }
}
