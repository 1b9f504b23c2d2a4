//! Sticking: a point that slips one way and then the other has passed the narrow and stiff range of sticking that lies
//! between. The tangents on both sides are soft, and Newton's method would jump to and fro for ever; presumed to stick, it
//! finds the range. Switch `stick`; `aid_stick` counts the points.
//!
//! A point that was presumed to stick and slips all the same may have missed the range for the error of its neighbours only.
//! It sticks once more if the tractions that its linear solve promised would have held it. Switch `stick_again`, and needs
//! `stick`; `aid_stick_again` counts them.
//!
//! Source: sticking is linear, so that one solve of it tells whether the range is where the point ends: the predictor of
//! return mapping (Simo & Hughes 1998, Computational Inelasticity, ch. 3), taken between iterates instead of within one.

use crate::contact::force::Tractions;
use crate::laws::friction::{FrictionState, Regime};

/// Slip that is below this share of what it was at the last solve comes to rest.
const ABATES: f64 = 0.5;

/// Tractions below this share of the friction that a point slips with would hold it.
const FAR_LOWER: f64 = 0.9;

/// How a point has slipped at the linear solves of the increment.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slipping {
    /// Plastic slip of the increment at the last solve [L]
    slip: f64,
    /// Whether the last solve presumed it to stick
    pub(super) stuck: bool,
}

impl Slipping {
    /// Watch the slip that the next linear solve starts from. A point sticks where it slips the other way than at the last
    /// solve, or was presumed to stick and slips, but would not with the tractions that this promised: it missed the narrow
    /// range of sticking only for its own error.
    pub(super) fn sticks(&mut self, friction: &FrictionState, promised: Tractions) -> bool {
        let slip = friction.plastic_increment;
        let slips = friction.regime == Regime::Slip;
        // A point that only a promise keeps closed has a negative pressure.
        let strength = (friction.traction / friction.pressure).abs() * promised.pressure;
        // A point that slips below its strength does so with these tractions as well, unless they are far lower or the slip
        // abates.
        let held = if slip.abs() < ABATES * self.slip.abs() { strength } else { FAR_LOWER * strength };
        let sticks = match self.stuck {
            true => slips && promised.traction.abs() < held,
            false => self.slip * slip < 0.0,
        };
        self.slip = slip;
        sticks
    }
}
