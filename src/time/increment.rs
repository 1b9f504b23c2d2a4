//! One increment: old state → new state.

use std::sync::Arc;

use super::accept::{accept, take_stock};
use super::tearing::torn;
use crate::contact::force::ContactState;
use crate::equations::inertia::kinetic_energy;
use crate::equations::{Coupling, Evaluation, Trial, links};
use crate::model::state::{LastIncrement, State};
use crate::model::{Model, Step};
use crate::solve::conduits::receive;
use crate::solve::equilibrium::{Found, equilibrium};
use crate::solve::newton::NewtonFailure;
use crate::solve::passes::Passes;
use crate::solve::{IncrementFailure, IterationRecord, Pass, Workspace};

/// What one increment came to.
#[derive(Debug)]
pub struct Advanced {
    /// The new state
    pub state: Result<State, IncrementFailure>,
    /// Linear solves, of a failed attempt as well
    pub iterations: Vec<IterationRecord>,
    /// Contact states if the motion before the increment had gone on
    pub foreseen: Option<Vec<Vec<ContactState>>>,
    /// Passes of its solution
    pub passes: Vec<Pass>,
    /// Coupling of the nodes at its end, on which the order of elimination depends
    pub coupling: Arc<Coupling>,
}

/// Solves one increment of length `dt` from the state `old`; pure except for the buffers of the workspace.
pub fn advance(model: &Model, step: &Step, old: &State, dt: f64, work: &mut Workspace) -> Advanced {
    // The last increment of a step ends exactly at its end, without round-off.
    let time = if old.time + dt > step.span.end - 1e-9 * dt { step.span.end } else { old.time + dt };
    let increment = Trial::new(old, step, time, time - old.time);
    let mut passes = Passes::new(model, increment.ahead());
    let found = loop {
        if let Some(end) = passes.end.take() {
            break end;
        }
        let start = passes.start.take();
        let solved = equilibrium(model, passes.trial(), start, work);
        passes.take(solved, work);
    };
    let Passes { iterations, foreseen, solutions, .. } = passes;
    let state = found.and_then(|found| arrive(model, increment, found, work));
    let state = state.and_then(|new| torn(model, step, old, &new).map_or(Ok(new), Err));
    Advanced { state, iterations, foreseen, passes: solutions, coupling: work.assembler.coupling() }
}

/// The new state from the equilibrium at the time of the scheme.
///
/// # Errors
/// Returns [`IncrementFailure`] if the equations cannot be evaluated at the end of the increment.
pub(super) fn arrive(
    model: &Model,
    increment: Trial,
    found: Found,
    work: &mut Workspace,
) -> Result<State, IncrementFailure> {
    let Found { displacement, evaluation, water } = reach_end(model, increment, found, work)?;
    let mut state = reached(model, increment, displacement, evaluation, work);
    receive(model, water, &mut state);
    Ok(state)
}

/// What is found at the end of an increment, from what was `beyond` it; that itself unless the scheme looks beyond the end.
fn reach_end(model: &Model, end: Trial, beyond: Found, work: &mut Workspace) -> Result<Found, IncrementFailure> {
    let Trial { old, step, .. } = end;
    let theta = step.scheme.theta();
    let Some(scheme) = end.integration().filter(|_| theta > 1.0) else { return Ok(beyond) };
    let ahead = &beyond.evaluation.acceleration;
    let reach = |dof: usize| {
        let (v, a) = (old.velocity[dof], old.acceleration[dof]);
        old.displacement[dof] + scheme.increment(v, a, a + (ahead[dof] - a) / theta)
    };
    let mut displacement: Vec<f64> = (0..ahead.len()).map(reach).collect();
    for support in &step.supports {
        support.at.set(end.prescribed(support, model), &mut displacement);
    }
    model.ties.spread(2, &mut displacement);
    links::turning_at_end(model, end, [&beyond.displacement, ahead], scheme, &mut displacement);
    let evaluated = work.assembler.residual(end, &displacement, &mut work.system);
    evaluated.map_err(|failure| IncrementFailure::Newton(NewtonFailure::Evaluation(failure)))?;
    Ok(Found { displacement, evaluation: std::mem::take(&mut work.assembler.evaluation), ..beyond })
}

/// The new state at the converged displacement `u`.
fn reached(model: &Model, trial: Trial, mut u: Vec<f64>, mut found: Evaluation, work: &mut Workspace) -> State {
    let Trial { old, step, time, dt, .. } = trial;
    let Evaluation { velocity, acceleration, .. } = &mut found;
    let [velocity, acceleration] = [velocity, acceleration].map(std::mem::take);
    let mut state = State { velocity, acceleration, reaction: vec![0.0; u.len()], ..old.clone() };
    accept(model, step, time, &mut u, &mut found, &mut state);
    let displacement = state.displacement.iter().zip(&old.displacement).map(|(new, old)| new - old).collect();
    state.last_increment = Some(LastIncrement { dt, displacement, ends_in_touch: false });
    let kinetic = kinetic(step, &state, work);
    take_stock(model, kinetic, &mut state);
    state
}

/// ½ vᵀ M v where a step counts inertia [F·L].
pub(super) fn kinetic(step: &Step, state: &State, work: &mut Workspace) -> f64 {
    if step.scheme.is_dynamic() { kinetic_energy(work.assembler.mass(), &state.velocity) } else { 0.0 }
}
