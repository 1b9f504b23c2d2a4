//! Acceptance of an increment, for every scheme: the quantities evaluated at its end become the new state, and the energy
//! audit is updated.

use crate::equations::evaluation::Flows;
use crate::equations::{Evaluation, bars, contacts};
use crate::model::{Model, State, Step};
use crate::solve::conduits::receive_with_bodies;

/// Sets `state` to `time` and the displacement `u`, with forces, reactions, damping, contacts and internal variables as `found`
/// there. The caller, who knows the scheme, sets velocities and accelerations; see [`take_stock`] for the stored energies. The
/// buffers are exchanged: `u` and `found` are left with the previous values.
pub fn accept(model: &Model, step: &Step, time: f64, u: &mut Vec<f64>, found: &mut Evaluation, state: &mut State) {
    for (support, reaction) in step.supports.iter().zip(&found.reactions) {
        support.at.add(*reaction, &mut found.loads);
        support.at.put(*reaction, &mut state.reaction);
    }
    let flows = Flows::between(model, step, state, time, u, found);
    state.energy.external_work += flows.work + found.heating;
    state.energy.damping_dissipation += flows.damping + found.dissipated;
    state.energy.plastic_dissipation += found.plastic;
    state.energy.stabilization += flows.stabilization;
    state.energy.friction_dissipation += flows.friction;
    state.energy.radiated += flows.radiated;
    state.energy.strain = found.strain_energy;
    std::mem::swap(&mut state.displacement, u);
    std::mem::swap(&mut state.force, &mut found.force);
    std::mem::swap(&mut state.external, &mut found.loads);
    std::mem::swap(&mut state.damping, &mut found.damping);
    std::mem::swap(&mut state.contacts, &mut found.contacts);
    std::mem::swap(&mut state.memory, &mut found.memory);
    std::mem::swap(&mut state.bars, &mut found.bars);
    std::mem::swap(&mut state.water, &mut found.water);
    (state.dt, state.time) = (time - state.time, time);
    model.note_water(state);
    receive_with_bodies(model, step, state.dt, &found.water, state);
    state.increment += 1;
}

/// Applies a temperature jump at the start of a dynamic step, evaluated in `found`: new internal variables and stored energy
/// of the bodies, and the work of the jump.
pub fn heat(step: &Step, found: &Evaluation, state: &mut State) {
    if !step.temperatures.is_empty() {
        state.memory.clone_from(&found.memory);
        state.energy.strain = found.strain_energy;
        state.energy.external_work += found.heating;
    }
}

/// Updates kinetic and contact energy at the end of an increment; at the start of a run the energy balance begins with them.
pub fn take_stock(model: &Model, kinetic: f64, state: &mut State) {
    state.energy.kinetic = kinetic;
    state.energy.contact_elastic = contacts::stored(model, &state.contacts) + bars::bonded(&state.bars);
    if state.increment == 0 {
        state.energy.initial = state.energy.kinetic + state.energy.contact_elastic;
    }
}
