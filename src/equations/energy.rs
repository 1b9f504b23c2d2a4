//! Energies of contacts, and of what acts on the model over an increment.

use crate::contact::force::ContactState;
use crate::model::{Model, Step};

/// What the drivers of dashpots put in over an increment: mean force × way of the driver [F·L].
/// `way` is that of the node's dof.
pub fn work_of_drivers(model: &Model, step: &Step, [t0, t1]: [f64; 2], way: impl Fn(usize) -> f64) -> f64 {
    let driven = step.loads.dashpots.iter().filter(|dashpot| dashpot.driver.is_some());
    driven
        .map(|dashpot| {
            let position = model.mesh.nodes[dashpot.dof / 2];
            let [v0, v1] = [t0, t1].map(|time| dashpot.driver_velocity(position, time));
            let velocity = 0.5 * (v0 + v1);
            dashpot.coefficient * (velocity * (t1 - t0) - way(dashpot.dof)) * velocity
        })
        .sum()
}

/// What bringing in the overlap of shrink fits puts in over an increment: mean force × what of the overlap came in [F·L].
pub fn work_of_fits(model: &Model, [old, new]: [&[Vec<ContactState>]; 2], [t0, t1]: [f64; 2]) -> f64 {
    let [before, after] = [t0, t1].map(|time| model.steps[0].span.share(time));
    let force = |state: &ContactState| state.friction.pressure * state.length;
    let mut work = 0.0;
    for (pair, (old, new)) in model.contacts.iter().zip(old.iter().zip(new)) {
        for (point, (old, new)) in pair.points.iter().zip(old.iter().zip(new)).filter(|(point, _)| point.overlap > 0.0)
        {
            work += 0.5 * (force(old) + force(new)) * point.overlap * (after - before);
        }
    }
    work
}

/// ∫ (α_n (g − d)²/2 + q²/(2 α_t)) ds of the closed points [F·L].
pub fn contact_energy(model: &Model, contacts: &[Vec<ContactState>]) -> f64 {
    let mut energy = 0.0;
    for (pair, states) in model.contacts.iter().zip(contacts) {
        for (point, state) in pair.points.iter().zip(states) {
            let ContactState { friction, length, .. } = state;
            let normal = if friction.pressure > 0.0 { 0.5 * pair.alpha_n * state.clearance().powi(2) } else { 0.0 };
            let stiffness = pair.law(point).stiffness();
            let tangential = if stiffness > 0.0 { 0.5 * friction.traction.powi(2) / stiffness } else { 0.0 };
            energy += length * (normal + tangential);
        }
    }
    energy
}

/// What friction dissipated from `old` to `new` [F·L].
pub fn friction_dissipation(old: &[Vec<ContactState>], new: &[Vec<ContactState>]) -> f64 {
    let points = new.iter().flatten().zip(old.iter().flatten());
    points.map(|(new, old)| new.length * (new.friction.dissipation - old.friction.dissipation)).sum()
}
