//! Fields of a contact by name, point by point: what outputs show and callers ask for.

use super::pair::ContactPair;
use super::state::ContactState;
use super::surface::SlavePoint;
use crate::laws::friction::{Regime, observables};

/// Names of the fields of some contacts: those that all have, and what their laws remember or let observe besides.
pub fn names(pairs: &[ContactPair]) -> Vec<&'static str> {
    let laws = pairs.iter().flat_map(|pair| &pair.laws).map(|law| law.start());
    let always = observables::ALWAYS.iter().map(|(name, _)| *name);
    let of_surfaces = ["gap", "pressure", "traction", "slip", "elastic_slip", "slip_rate"].into_iter();
    let further = observables::further(laws);
    let fluid = pairs.iter().any(|pair| pair.fluid.is_some()).then_some("fluid_pressure");
    of_surfaces.chain(always).chain(["state", "dissipation"]).chain(further).chain(fluid).collect()
}

/// Value of a field at a point, at a time after an increment of length Δt. Where a law has none, `R` and `mu` are 0 and `structure` is
/// 1; any other name that it does not know is NaN.
///
/// | name | meaning |
/// |---|---|
/// | `gap` | g [L] |
/// | `pressure`, `traction` | p, q [F/L²] |
/// | `slip`, `elastic_slip` | total plastic slip, q/α_t [L] |
/// | `slip_rate` | plastic slip of the increment over its length [L/T] |
/// | `state` | 0 open, 1 sticking (or closed without friction), 2 slipping, as the law says |
/// | `dissipation` | work of friction so far per area [F/L] |
/// | `fluid_pressure` | p_w, beside `pressure`, where a contact has a fluid [F/L²] |
/// | any other | what the law observes under this name, such as `R`, `mu`, `structure`, `theta` |
pub fn value(pair: &ContactPair, slave: &SlavePoint, state: &ContactState, (time, dt): (f64, f64), name: &str) -> f64 {
    let friction = &state.friction;
    match name {
        "gap" => state.gap,
        "pressure" => friction.pressure,
        "traction" => friction.traction,
        "slip" => friction.plastic_slip,
        "elastic_slip" => pair.elastic_slip(slave, friction),
        "slip_rate" => friction.plastic_increment * if dt > 0.0 { 1.0 / dt } else { 0.0 },
        "dissipation" => friction.dissipation,
        "fluid_pressure" => state.fluid,
        "state" => match pair.regime(slave, state) {
            Regime::Open => 0.0,
            Regime::Stick => 1.0,
            Regime::Slip => 2.0,
        },
        _ => pair.observed(slave, name, (friction, time)),
    }
}
