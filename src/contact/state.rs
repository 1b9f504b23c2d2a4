//! What a contact point remembers between increments, and what it says of itself.

use serde::{Deserialize, Serialize};

use super::point::MasterPoint;
use crate::laws::friction::FrictionState;

/// Contact closes at a zero gap when it is below this share of the length the point stands for.
pub(super) const TOUCH: f64 = 1e-9;

/// Memory of one contact point between increments.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactState {
    /// What friction remembers
    pub friction: FrictionState,
    /// Foot on the master, open or closed; `None` where no part of the master faces the point
    pub foot: Option<MasterPoint>,
    /// Length the point stands for: its own or, by mortar, the part of it that the master faces; once open, the last one [L]
    pub length: f64,
    /// g at the foot; a contact that starts closed counts it from where its points touch [L]
    pub gap: f64,
    /// Δu_t of the last increment, what came before touch included; 0 while open [L]
    pub slip: f64,
    /// p̄: pressure at zero gap, raised until the penetration is small enough; 0 for the plain penalty [F/L²]
    pub multiplier: f64,
}

/// Whether a point is open, sticks or slips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// No pressure
    Open,
    /// Pressed, and held by friction
    Stick,
    /// Plastic slip in this increment at R ≥ 0.9
    Slip,
}

/// R from which on plastic slip counts as slipping.
pub const SLIPPING: f64 = 0.9;

impl ContactState {
    /// Whether a point that stands for this length is open at a gap that counts.
    pub fn apart(&self, length: f64) -> bool {
        self.friction.pressure == 0.0 && self.gap > TOUCH * length
    }

    /// Open, stick or slip. The super/subloading law slips plastically a little whenever it is loaded, so only plastic
    /// slip near the peak surface counts as slipping.
    pub fn status(&self) -> Status {
        let friction = &self.friction;
        if friction.pressure <= 0.0 {
            Status::Open
        } else if friction.plastic_increment != 0.0 && (friction.mu == 0.0 || friction.ratio() >= SLIPPING) {
            Status::Slip
        } else {
            Status::Stick
        }
    }
}
