//! Touch: at p = 0 a point may as well be open as closed, and a tangent of one or the other leads to the other, for ever; and
//! a frictional one would slip at once, for the law of friction has no stiffness there. A point whose gap is zero at the
//! start of an increment is closed and sticks, q = q₀ + α_t Δu_t, in the first linear solve. Switch `touch`; `aid_touch` counts the points.
//!
//! Source: sticking is what the law answers to a pressure that comes up with the slip as long as |q| < μ p, and the only one of
//! its branches whose tangent is not singular at p = 0.

use crate::contact::force::{ContactState, touches};
use crate::contact::pair::{ContactPair, Presumption};

/// Whether a closed point sticks because it touches.
pub(super) fn acts(pair: &ContactPair, presumption: &Presumption, state: &ContactState, old: &ContactState) -> bool {
    touches(pair, state.clearance(), old, presumption.presume)
}
