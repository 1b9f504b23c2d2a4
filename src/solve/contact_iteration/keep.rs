//! Kept contact: where a correction lifts a point off its stiff penalty by a hair, the point would open, carry nothing in the
//! next linear solve, and fall back in. It is closed in that solve as long as the last one promised it a pressure; its
//! spring then pulls it back. Switch `keep`; `aid_keep` counts the points that are closed for it.
//!
//! The first linear solve of an increment goes by the committed state: a point that was closed still is, unless the start
//! value takes it farther away than the bodies would follow if its pressure went, and the penalty would reach,
//!
//! ```text
//! g ≤ p₀ (c + 10/α_n)                                 c: compliance of the bodies
//! ```
//!
//! Switch `pull`, for those points that are open by the start value, and needs `keep`; `aid_pull` counts them.
//!
//! Source: as the choice of the active set from p + δp rather than from the gap in primal–dual active set methods (Hintermüller,
//! Ito & Kunisch 2002, doi:10.1137/S1052623401383558), where it is Newton's method for the kink of ⟨p⟩. The reach is the
//! displacement over which p₀ goes to zero; its factor 10 is a rule of thumb.

use crate::contact::force::{Closed, ContactState, Tractions};
use crate::contact::pair::{ContactPair, Presumption};

/// The penalty may have drawn a point that was closed back by this many p/α_n.
const MOST_PULL: f64 = 10.0;

/// What the committed state promises a point that is open by the start value.
pub(super) fn at_start(pair: &ContactPair, state: &ContactState, old: &ContactState) -> Tractions {
    let reach = old.friction.pressure * (pair.compliance + MOST_PULL / pair.alpha_n);
    if state.clearance() <= reach { Tractions::of(&old.friction) } else { Tractions::default() }
}

/// Whether a point is closed for a promise alone.
pub(super) fn acts(presumption: &Presumption, closed: &Closed) -> bool {
    presumption.kept > 0.0 && closed.tractions.pressure <= 0.0
}
