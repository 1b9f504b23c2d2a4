//! Carried pressure: a point that goes too deep in one iterate would be pressed far too hard by a stiff penalty, and stick
//! where it is to slip. Friction answers to what is left of the pressure once the bodies have taken their share of the
//! penetration, p/(1 + α_n c), and goes on in a straight line from there. Switch `carried`; `aid_carried` counts the points.
//!
//! Source: body and penalty are springs in series, 1/c and α_n, and the penetration of an iterate is what both will
//! share. (The compliance d/p by which slip counts from touch, [`crate::contact::force`], is no aid but a law: it is the same
//! in every iterate, and answers depend on it.)

use crate::contact::force::ContactState;
use crate::contact::pair::ContactPair;

/// The pressure that friction answers to at a point that has just closed; `None` at any other.
pub(super) fn carried(pair: &ContactPair, was_closed: bool, state: &ContactState, stiffening: f64) -> Option<f64> {
    let closes = !was_closed && state.friction.pressure > 0.0;
    closes.then(|| pair.shared(state.friction.pressure, stiffening))
}
