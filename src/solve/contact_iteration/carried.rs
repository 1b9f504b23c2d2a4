//! Carried pressure: a point that goes too deep in one iterate would be pressed far too hard by a stiff penalty, and stick
//! where it is to slip. Friction answers to what is left of the pressure once the bodies have taken their share of the
//! penetration, p/(1 + α_n c), and goes on in a straight line from there.

use crate::contact::force::ContactState;
use crate::contact::pair::ContactPair;

/// The pressure that friction answers to at a point that has just closed; `None` at any other.
pub(super) fn carried(pair: &ContactPair, was_closed: bool, state: &ContactState, stiffening: f64) -> Option<f64> {
    let closes = !was_closed && state.friction.pressure > 0.0;
    closes.then(|| pair.shared(state.friction.pressure, stiffening))
}
