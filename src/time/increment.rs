//! One increment: old state → new state.

use super::accept::{accept, take_stock};
use super::tearing::torn;
use crate::contact::force::ContactState;
use crate::equations::inertia::kinetic_energy;
use crate::equations::{Evaluation, Trial, links};
use crate::model::state::{LastIncrement, State};
use crate::model::{Model, Step};
use crate::solve::conduits::{receive, settle};
use crate::solve::failure::IncrementFailure;
use crate::solve::newton::NewtonFailure;
use crate::solve::{IterationRecord, Pass, Solved, Workspace};

/// What one increment came to.
#[derive(Debug)]
pub struct Advanced {
    /// Linear solves, of a failed attempt as well
    pub iterations: Vec<IterationRecord>,
    /// The new state
    pub state: Result<State, IncrementFailure>,
    /// Contact states if the motion before the increment had gone on
    pub foreseen: Option<Vec<Vec<ContactState>>>,
    /// Passes of its solution
    pub passes: Vec<Pass>,
}

/// Solves one increment of length `dt` from the state `old`; pure except for the buffers of the workspace.
pub fn advance(model: &Model, step: &Step, old: &State, dt: f64, work: &mut Workspace) -> Advanced {
    // The last increment of a step ends exactly at its end, without round-off.
    let time = if old.time + dt > step.span.end - 1e-9 * dt { step.span.end } else { old.time + dt };
    let increment = Trial::new(old, step, time, time - old.time);
    let (Solved { iterations, displacement, foreseen, passes }, arrived) = settle(model, increment.ahead(), work);
    let state = displacement.and_then(|u| arrive(model, increment, u, work)).map(|mut state| {
        receive(model, arrived, &mut state);
        state
    });
    let state = state.and_then(|new| torn(model, step, old, &new).map_or(Ok(new), Err));
    Advanced { iterations, state, foreseen, passes }
}

/// The new state from the equilibrium `u` at the time of the scheme, where the equations were evaluated last.
///
/// # Errors
/// Returns [`IncrementFailure`] if they cannot be evaluated at the end of the increment.
pub(super) fn arrive(
    model: &Model,
    increment: Trial,
    u: Vec<f64>,
    work: &mut Workspace,
) -> Result<State, IncrementFailure> {
    reach_end(model, increment, u, work).map(|u| reached(model, increment, u, work))
}

/// Displacement at the end of an increment, and everything else evaluated there, from the equilibrium `u` found at the time
/// of the scheme; `u` itself unless the scheme looks beyond the end.
fn reach_end(model: &Model, end: Trial, beyond: Vec<f64>, work: &mut Workspace) -> Result<Vec<f64>, IncrementFailure> {
    let Trial { old, step, dt, .. } = end;
    let theta = step.scheme.theta();
    let Some(scheme) = step.scheme.coefficients().filter(|_| theta > 1.0) else { return Ok(beyond) };
    let ahead = &work.assembler.evaluation.acceleration;
    let reach = |dof: usize| {
        let (v, a) = (old.velocity[dof], old.acceleration[dof]);
        old.displacement[dof] + scheme.increment(v, a, a + (ahead[dof] - a) / theta, dt)
    };
    let mut u: Vec<f64> = (0..beyond.len()).map(reach).collect();
    for support in &step.supports {
        support.at.set(end.prescribed(support, model), &mut u);
    }
    model.ties.spread(2, &mut u);
    links::turning_at_end(model, end, [&beyond, ahead], scheme, &mut u);
    let evaluated = work.assembler.residual(end, &u, &mut work.system);
    evaluated.map_err(|failure| IncrementFailure::Newton(NewtonFailure::Evaluation(failure)))?;
    Ok(u)
}

/// The new state at the converged displacement `u`.
fn reached(model: &Model, trial: Trial, mut u: Vec<f64>, work: &mut Workspace) -> State {
    let Trial { old, step, time, dt, .. } = trial;
    let mut found = std::mem::take(&mut work.assembler.evaluation);
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
