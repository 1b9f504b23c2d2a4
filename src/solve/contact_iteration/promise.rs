//! Promised tractions: a stiff penalty turns every error of a displacement into a pressure far too high, and that into a
//! geometric stiffness p δn ℓ that leads the next iterate astray. What the last linear solve promised, p + δp, is off by the
//! square of its correction only ([`Closed::promise`]), and takes the place of p and q in the geometric part of the tangent.
//! Switch `promise`; `aid_promise` counts the closed points whose own tractions are others.
//!
//! The first linear solve of an increment has none before it and goes by the start value. Extrapolated past the edge of
//! a contact, points penetrate far too deep, so that no pressure is taken for promised which is more than twice the
//! committed one (switch `limit`; `aid_limit` counts the points to which this happens).
//!
//! Source: what p + δp leaves out is the second term of the expansion of the traction in the correction; that it is of
//! second order is tested (`tests/contact/contact.rs`). The limit is a rule of thumb.

use crate::contact::force::{Closed, ContactState, Tractions};
use crate::contact::pair::Presumption;

/// Most growth of a pressure from the committed state to the start value that is believed.
const MOST_GROWTH: f64 = 2.0;

/// What the start value promises a point that it closes.
pub(super) fn at_start(state: &ContactState, old: &ContactState, limit: bool) -> Tractions {
    let tractions = Tractions::of(&state.friction);
    if limit { tractions.limited(MOST_GROWTH * old.friction.pressure) } else { tractions }
}

/// Whether the tangent of a point is made with other tractions than its own.
pub(super) fn acts(presumption: &Presumption, closed: &Closed) -> bool {
    presumption.promised.is_some_and(|promised| promised != closed.tractions)
}
