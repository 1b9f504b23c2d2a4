//! Water that flows through the pores of bodies.
//!
//! ```text
//! Δm_a = ∫ (b (J − J_n) + (p − p_n)/Q) N_a dV + Σ_b (projection)_ab (p − p_n)_b          what comes to the pores of a corner           (1)
//! β Δm − Δm_n ω²/(1 + ω) = −Δt (∫ v·∇N dV + ∫ q N ds),   β = (1 + 2ω)/(1 + ω),   ω = Δt/Δt_n                                  BDF2     (2)
//! v = J_n F_n⁻¹ k/γ_w (F_n⁻ᵀ ∇p − γ_w g)                                                  flow in the body as it was                   (3)
//! r_a = −s_a (Δm_a − Δm_n,a ω²/(1 + 2ω) + Δt/β (∫ v·∇N_a dV + ∫ q N_a ds))                                                             (4)
//! f = −∫ b p ∂J/∂u dV                                                      on a body that is elastic; others have it in their law               (5)
//! ```
//! The geometry and the permeability of (3) are those of the accepted state: with b p J F⁻ᵀ in the stress of the bodies, and (4) divided by β, the tangent is symmetric, and
//! has as many negative eigenvalues as pressures. After a jump, at the start of a step or in an increment that is much shorter than the next, (2) begins with ω = 0: backward Euler. Where
//! only a rate jumps, at a corner of a table, the increment ends, and (2) goes on: its error there is a third of that of backward Euler. The integral of q over an outlet is taken by the same formula, so that what is stored and what has left add up to nothing.
//!
//! Source: M. A. Biot (1941), J. Appl. Phys. 12, 155; the projection: Dohrmann & Bochev (2004), Int. J. Numer. Meth. Fluids 46, 183; White & Borja
//! (2008), Comput. Methods Appl. Mech. Eng. 197, 4353.

use super::channels;
use super::sums::{Dependence, Sums, TrialFailure};
use super::trial::Trial;
use super::water_balances::{Balances, Times};
use super::wet_elements::{Beginning, Increment, Pressed};
use crate::model::Model;
use crate::model::state::{Outflow, Water};

/// The flow goes by the state at the start of the increment, and the volume by the displacement.
pub(super) fn dependence(model: &Model) -> Dependence {
    if model.flow.is_some() { Dependence::Displacement } else { Dependence::Nothing }
}

/// Δt/β of an increment [T].
pub(super) fn span(trial: Trial) -> f64 {
    Times::of(trial).span
}

/// Adds the equations of the pressures, and what the bodies' forces change by with them to the tangent, the forces (5) of elastic bodies; stores the
/// water at the end of the trial, and what such bodies remember of it in `memory`.
pub(super) fn add(
    model: &Model,
    beginning: &mut Beginning,
    trial: Trial,
    u: &[f64],
    water: &mut Water,
    memory: &mut Vec<f64>,
    sums: &mut Sums,
) -> Result<Pressed, TrialFailure> {
    let Some(flow) = &model.flow else { return Ok(Pressed::default()) };
    if memory.len() != trial.old.memory.len() {
        memory.clone_from(&trial.old.memory);
    }
    let (times, old) = (Times::of(trial), &trial.old.water);
    let mut balances = Balances::new(flow);
    let increment = Increment { model, flow, trial, times, u };
    let pressed = increment.add_elements(beginning, memory, &mut balances, sums)?;
    for (k, before) in old.change.iter().enumerate() {
        balances.let_out(k, -times.memory * before, (times.memory * before).abs());
    }
    water.outlets.clone_from(&old.outlets);
    water.between = old.between;
    // A case that goes on from the end of another may have further ones.
    water.outlets.resize(flow.outlets.len(), Outflow::default());
    water.outlets.iter_mut().for_each(|outlet| outlet.go_on(times.memory));
    for drain in &trial.step.drains {
        let outlet = &mut water.outlets[drain.outlet];
        for &(k, at, area) in &drain.corners {
            let [q, slope] = drain.flow(flow.pressure(k, Some(u)), at, trial.time);
            if !q.is_finite() {
                return Err(TrialFailure::Undefined { node: model.mesh.node_tags[flow.corners[k]], time: trial.time });
            }
            outlet.let_out(area * q, times.span);
            balances.let_out(k, times.span * area * q, times.span * area * q.abs());
            let (scale, dof) = (flow.scales[k], flow.dof(k));
            sums.stiffen(dof, dof, -scale * scale * times.span * area * slope);
        }
    }
    channels::add(model, trial, u, times, water, &mut balances, sums)?;
    water.change = balances.end(flow, u, sums);
    water.peaks.clone_from(&old.peaks);
    water.excess.clone_from(&old.excess);
    water.taken.clone_from(&old.taken);
    water.brought.clone_from(&old.brought);
    Ok(pressed)
}

/// Flow out of where a pressure is prescribed, were that 0, as a force at its dof: so large are the parts of its balance, which cancel [F].
pub(super) fn prescribed(model: &Model, trial: Trial, u: &[f64]) -> Vec<(usize, f64)> {
    let (Some(flow), span) = (&model.flow, span(trial)) else { return Vec::new() };
    let outlets = trial.step.drains.iter().flat_map(|drain| {
        let conductance = drain.kind.conductance();
        drain.corners.iter().map(move |&(k, _, area)| (k, area * conductance))
    });
    let all = outlets.chain(channels::prescribed(model, trial, u));
    all.map(|(k, passes)| (flow.dof(k), flow.scales[k] * span * passes * flow.pressure(k, Some(u)).abs())).collect()
}
