//! Promised tractions: a stiff penalty turns every error of a displacement into a pressure far too high, and that into a
//! geometric stiffness which leads the next iterate astray, or opens a point that should be closed. What the last linear
//! solve promised, p + δp, is off by the square of its correction only ([`Closed::promise`]).
//!
//! The first linear solve of an increment has none before it. It goes by the start value, within limits:
//!
//! ```text
//! closed by the start value    its tractions, p ≤ 2 p₀
//! g ≤ p₀ (c + 10/α_n)          p₀, q₀: a point that was closed still is, unless it is farther away than the bodies would
//!                              follow if its pressure went (c: compliance of the bodies), and the penalty would reach
//! ```
//!
//! [`Closed::promise`]: crate::contact::force::Closed::promise

use crate::contact::force::{ContactState, Tractions};
use crate::contact::pair::ContactPair;

/// The first linear solve of an increment takes no pressure for promised that is more than this many times the committed
/// one: a start value extrapolated past the edge of a contact penetrates far too deep.
const MOST_GROWTH: f64 = 2.0;

/// The penalty may have drawn a point that was closed back by this many p/α_n.
const MOST_PULL: f64 = 10.0;

/// What the start of an increment promises, from the state at the start value and the committed one.
pub(super) fn at_start(pair: &ContactPair, state: &ContactState, old: &ContactState) -> Tractions {
    let reach = old.friction.pressure * (pair.compliance + MOST_PULL / pair.alpha_n);
    match state.friction.pressure > 0.0 {
        true => Tractions::of(&state.friction).limited(MOST_GROWTH * old.friction.pressure),
        false if state.gap <= reach => Tractions::of(&old.friction),
        false => Tractions::default(),
    }
}
