//! Contact and friction term: forces of all contact points, and their stored, dissipated and supplied energies.

use std::time::Instant;

use super::Assembler;
use super::pore_flow;
use super::sums::{Dependence, Sums, add_blocks};
use super::trial::Trial;
use crate::contact::pair::{BadPressure, ContactIncrement, ContactPair, InitialTraction, Prediction};
use crate::contact::response::{LastAnswers, PairResponse};
use crate::contact::{ContactState, SlavePoint};
use crate::equations::sums::TrialFailure;
use crate::laws::friction::Cohesion;
use crate::linear::system::Request;
use crate::model::Model;
use crate::model::state::Water;

/// The tangent of contact depends on the displacements, if there is any contact.
pub(super) fn dependence(model: &Model) -> Dependence {
    if model.contacts.is_empty() { Dependence::Nothing } else { Dependence::Displacement }
}

impl Assembler {
    /// Evaluates the responses of all contact points at the displacement `u`, one a pair, with predictions about each point of a pair for
    /// a tangent only: a residual that may be accepted has none. The result is in `responses`, whose memory is reused. What laws answered
    /// goes from one evaluation to the next, whatever its responses are for.
    ///
    /// # Errors
    /// Returns [`TrialFailure`] if a friction law fails.
    pub fn interfaces(
        &mut self,
        trial: Trial,
        u: &[f64],
        prediction_of: impl Fn(usize, usize) -> Prediction + Sync,
        request: Request,
        responses: &mut Vec<PairResponse>,
    ) -> Result<(), TrialFailure> {
        let Self { model, answered, seconds, .. } = self;
        if model.contacts.is_empty() {
            return Ok(());
        }
        let clock = Instant::now();
        let [before, x] = [&trial.old.displacement, u].map(|u| model.configuration(u));
        let fading = 1.0 - model.steps[0].span.share(trial.time);
        let Trial { time, dt, stiffening, settles, .. } = trial;
        let radiates = !trial.step.scheme.is_dynamic();
        let during =
            ContactIncrement { time, dt, radiates, fading, stiffening, settles, seeps: pore_flow::span(trial) };
        responses.resize_with(model.contacts.len(), PairResponse::default);
        answered.resize_with(model.contacts.len(), LastAnswers::default);
        let pairs = model.contacts.iter().zip(&trial.old.contacts).zip(responses.iter_mut().zip(answered)).enumerate();
        for (number, ((pair, old), (response, answered))) in pairs {
            if !trial.step.joins(pair) {
                response.rest(old);
                continue;
            }
            if let Some(BadPressure { at, pressure }) = pair.bad_fluid_pressure(&x, time) {
                let contact = pair.name.clone();
                return Err(TrialFailure::FluidPressure { contact, at: [at.x, at.y], pressure, time });
            }
            let prediction_of = |point| prediction_of(number, point);
            std::mem::swap(&mut response.answered, answered);
            let answer = pair.respond(old, [&before, &x], during, prediction_of, request, response);
            std::mem::swap(&mut response.answered, answered);
            answer.map_err(|(point, cause)| TrialFailure::Friction { contact: pair.name.clone(), point, cause })?;
        }
        seconds.contact += clock.elapsed().as_secs_f64();
        Ok(())
    }
}

/// Adds the forces of the closed points and, on request, their tangents, for which the pattern has room.
pub(super) fn add(responses: &[PairResponse], sums: &mut Sums) {
    let mut blocks = sums.layout.blocks_of_contacts();
    for (_, closed) in responses.iter().flat_map(PairResponse::all_acting) {
        sums.push(closed.nodes, closed.force);
        if let Some(tangent) = &mut sums.tangent {
            assert_eq!(
                closed.tangent.len(),
                4 * closed.nodes.len().pow(2),
                "responses come with tangents if one is asked for"
            );
            let (own, others) = blocks.split_at(closed.nodes.len().pow(2));
            add_blocks(tangent, own, closed.tangent, closed.nodes.len());
            blocks = others;
        }
    }
}

/// Adds the water between surfaces to what came to the pores of each pressure, and what drains from there to the outlets.
pub(super) fn add_water(model: &Model, trial: Trial, responses: &[PairResponse], water: &mut Water) {
    let Some(flow) = &model.flow else { return };
    let span = pore_flow::span(trial);
    for (pair, response) in model.contacts.iter().zip(responses) {
        if let Some(open) = pair.seam.as_ref().and_then(|seam| seam.open) {
            let drained: f64 = response.all_acting().map(|(_, closed)| closed.drained).sum();
            water.outlets[open.outlet].let_out(drained / span, span);
        }
    }
    for (_, closed) in responses.iter().flat_map(PairResponse::all_acting) {
        let pressures = closed.nodes.iter().zip(closed.taken.iter().step_by(2));
        for (node, taken) in pressures.filter(|(node, _)| **node >= flow.first) {
            // Where the terms are evaluated one by one, bodies may have added nothing yet.
            if let Some(change) = water.change.get_mut(node - flow.first) {
                *change += taken;
                water.between += taken;
            }
        }
    }
}

/// Adds the nodal forces of fluids to the loads, whose work is audited; the forces include them already.
pub(super) fn add_fluids(model: &Model, responses: &[PairResponse], loads: &mut [f64]) {
    let fluids = model.contacts.iter().zip(responses).filter(|(pair, _)| pair.fluid.is_some() || pair.seam.is_some());
    for (_, closed) in fluids.flat_map(|(_, response)| response.all_acting()) {
        for (&node, force) in closed.nodes.iter().zip(closed.fluid.chunks_exact(2)) {
            (0..2).for_each(|i| loads[2 * node + i] += force[i]);
        }
    }
}

/// Energy stored in the springs of a contact: ∫ (α_n (g − d)²/2 + q²/(2 α_t)) ds of its closed points.
///
/// What penalties give way by in a contact that starts closed under tractions p₀ and q₀ is what these have changed by.
#[derive(Clone, Copy, Debug, Default)]
pub struct Springs {
    /// total [F·L]
    pub stored: f64,
    /// What is numerical, along the normal and the tangent: an exact contact would not give way there [F·L]
    pub numerical: [f64; 2],
    /// What has changed since a start under tractions; otherwise all [F·L]
    pub changed: f64,
}

impl Springs {
    /// Energy of a contact in some state.
    pub fn of(pair: &ContactPair, states: &[ContactState]) -> Self {
        let mut springs = Self::default();
        for (k, (point, state)) in pair.points.iter().zip(states).enumerate() {
            let length = state.length;
            // Zero where it did not come under stress
            let came = InitialTraction { pressure: state.came.pressure, traction: state.came.traction };
            let start = pair.initial.as_ref().map_or(came, |initial| initial[k]);
            let law = pair.law(point);
            let (stiffness, stiffness_is_penalty) = (law.stiffness, law.description.stiffness_is_penalty);
            let clearance = if state.is_closed() { state.clearance() } else { 0.0 };
            let normal = |clearance: f64| 0.5 * pair.alpha_n * clearance.powi(2);
            let tangential = |slip: f64| 0.5 * stiffness * slip.powi(2);
            let slip = pair.elastic_slip(point, state);
            let stored_in_bond = of_bond(pair, point, state, 0.0);
            springs.stored += length * (normal(clearance) + tangential(slip) + stored_in_bond);
            if !state.is_closed() {
                springs.changed += length * (tangential(slip) + stored_in_bond);
                continue;
            }
            let [given, by_penalty] = [pair.penetration, pair.stick].map(|allowed| allowed.is_none());
            let bonded = if by_penalty { law.share_of_bond(start.pressure, start.traction) } else { 0.0 };
            let [pressure, traction] = [start.pressure, start.traction - bonded];
            let clearance = clearance + if given { pressure / pair.alpha_n } else { 0.0 };
            let slip = slip - if by_penalty && stiffness > 0.0 { traction / stiffness } else { 0.0 };
            let changed = [normal(clearance), tangential(slip)].map(|energy| length * energy);
            springs.changed += changed[0] + changed[1];
            springs.numerical[0] += changed[0];
            if stiffness_is_penalty {
                springs.numerical[1] += changed[1];
            }
            let of_bond = length * of_bond(pair, point, state, bonded);
            springs.changed += of_bond;
            springs.numerical[1] += of_bond;
        }
        if pair.initial.is_none() && !pair.comes_stressed {
            springs.changed = springs.stored;
        }
        springs
    }
}

/// Energy stored in a bond in parallel with friction, q_b²/2α_c + T w/2, with the traction since some start [F/L].
fn of_bond(pair: &ContactPair, point: &SlavePoint, state: &ContactState, start: f64) -> f64 {
    match (&pair.law(point).cohesion, state.bond) {
        (Some(Cohesion::Parallel(law)), Some(bond)) => {
            let slip = pair.elastic_slip_of_bond(point, state) - start / law.stiffness();
            0.5 * (law.stiffness() * slip * slip + bond.tension * (bond.opening - bond.rest))
        }
        _ => 0.0,
    }
}

/// Energy stored in the springs of all contacts [F·L].
pub fn stored(model: &Model, contacts: &[Vec<ContactState>]) -> f64 {
    model.contacts.iter().zip(contacts).map(|(pair, states)| Springs::of(pair, states).stored).sum()
}

/// Energy dissipated by friction from `old` to `new` [F·L].
pub fn dissipated(old: &[Vec<ContactState>], new: &[Vec<ContactState>]) -> f64 {
    let points = new.iter().flatten().zip(old.iter().flatten());
    points.map(|(new, old)| new.length * (new.friction.dissipation - old.friction.dissipation)).sum()
}

/// Energy radiated by slip from `old` to `new` [F·L].
pub fn radiated(old: &[Vec<ContactState>], new: &[Vec<ContactState>]) -> f64 {
    let points = new.iter().flatten().zip(old.iter().flatten());
    points.map(|(new, old)| new.length * (new.radiated - old.radiated)).sum()
}

/// Work of applying the overlap of shrink fits: mean force × applied increment of the overlap [F·L].
pub fn fitted(model: &Model, [old, new]: [&[Vec<ContactState>]; 2], [t0, t1]: [f64; 2]) -> f64 {
    let [before, after] = [t0, t1].map(|time| model.steps[0].span.share(time));
    let force = |state: &ContactState| state.contact_pressure() * state.length;
    let mut work = 0.0;
    for (pair, (old, new)) in model.contacts.iter().zip(old.iter().zip(new)) {
        for (point, (old, new)) in pair.points.iter().zip(old.iter().zip(new)).filter(|(point, _)| point.overlap > 0.0)
        {
            work += 0.5 * (force(old) + force(new)) * point.overlap * (after - before);
        }
    }
    work
}
