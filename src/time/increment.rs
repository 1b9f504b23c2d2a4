//! One increment: old state → new state.

use super::accept::{accept, heat, take_stock};
use crate::equations::inertia::kinetic_energy;
use crate::equations::supports::{hold, tie, turn};
use crate::equations::{Evaluation, Trial};
use crate::equations::{links, turning};
use crate::linear;
use crate::model::scheme::{Scheme, start_acceleration, start_velocity};
use crate::model::state::{LastIncrement, State};
use crate::model::support::{Direction, Prescribed};
use crate::model::{Model, Step};
use crate::solve::augmented::augment;
use crate::solve::failure::IncrementFailure;
use crate::solve::newton::NewtonFailure;
use crate::solve::{IterationRecord, Workspace};

/// Begin a step: remember displacements and reactions, and find the forces and accelerations that the run or dynamics
/// starts with.
///
/// # Errors
/// [`IncrementFailure`] when the initial state cannot be evaluated or a body has no mass.
pub fn begin(model: &Model, step: &Step, old: &State, work: &mut Workspace) -> Result<State, IncrementFailure> {
    let mut state = old.clone();
    state.begin_step();
    // Explicit increments leave the forces of copies with them.
    model.ties.gather(2, &mut state.force);
    // The reaction of a freed support has become a load.
    step.released.iter().for_each(|at| at.add(-at.of(&old.reaction), &mut state.force));
    launch(model, step, &mut state);
    if step.scheme.is_dynamic() {
        let dt = step.increments.initial;
        keep_to_supports(model, (step, dt), &mut state);
        let is_new = rests(old) || old.is_of_explicit() || !step.launch.is_empty();
        if is_new || frees(step, old) || jumps(step, &state, work)? {
            start_dynamics(model, step, &mut state, work)?;
        }
    } else {
        state.stop();
        if old.increment == 0 && model.starts_loaded() {
            start_loaded(step, &mut state, work)?;
        }
    }
    if state.increment == 0 {
        let kinetic = kinetic(step, &state, work);
        take_stock(model, kinetic, &mut state);
    } else if !step.launch.is_empty() || old.is_of_explicit() {
        moves_anew(step, &mut state, work);
    }
    Ok(state)
}

/// What velocities that are given, or masses that are lumped no longer, change of the kinetic energy counts as work from outside.
fn moves_anew(step: &Step, state: &mut State, work: &mut Workspace) {
    let kinetic = kinetic(step, state, work);
    state.energy.external_work += kinetic - state.energy.kinetic;
    state.energy.kinetic = kinetic;
}

/// New accelerations within a step if whoever leads the run has changed its loads or dampers, or freed a support; none if they go
/// on.
///
/// # Errors
/// As [`begin`].
pub fn led(model: &Model, step: &Step, old: &State, work: &mut Workspace) -> Result<Option<State>, IncrementFailure> {
    if !(step.scheme.is_dynamic() && (frees(step, old) || jumps(step, old, work)?)) {
        return Ok(None);
    }
    let mut state = old.clone();
    start_dynamics(model, step, &mut state, work)?;
    Ok(Some(state))
}

/// Give what supports hold when a run begins, and was given a velocity with its body, that of the support.
pub fn keep_to_supports(model: &Model, (step, dt): (&Step, f64), state: &mut State) {
    if state.increment > 0 {
        return;
    }
    let first = Trial::new(state, step, state.time + dt, dt);
    let own = |support: &Prescribed| {
        let (given, own) = (support.at.of(&state.velocity), start_velocity(first.thirds(support, model), dt));
        (given != 0.0 && (own - given).abs() > ROUNDED * given.abs()).then_some((support.at, own))
    };
    let held: Vec<(Direction, f64)> = step.supports.iter().filter_map(own).collect();
    if !held.is_empty() {
        held.into_iter().for_each(|(at, velocity)| at.set(velocity, &mut state.velocity));
        model.ties.spread(2, &mut state.velocity);
        links::stiffen_velocities(model, &state.displacement, &mut state.velocity);
    }
}

/// Give nodes the velocities that they take when a step begins, where no support says how they move.
pub fn launch(model: &Model, step: &Step, state: &mut State) {
    let inclined = step.supports.iter().map(|support| support.at).filter(|at| at.inclined.is_some());
    let held: Vec<(Direction, f64)> = inclined.map(|at| (at, at.of(&state.velocity))).collect();
    for (dof, velocity) in step.launch.iter().flat_map(|&(node, [x, y])| [(2 * node, x), (2 * node + 1, y)]) {
        if step.support_at(dof).is_none_or(|support| support.at.inclined.is_some()) {
            state.velocity[dof] = velocity;
        }
    }
    held.into_iter().for_each(|(at, velocity)| at.set(velocity, &mut state.velocity));
    if !step.launch.is_empty() {
        model.ties.spread(2, &mut state.velocity);
        links::stiffen_velocities(model, &state.displacement, &mut state.velocity);
    }
}

/// Whether nothing accelerates.
fn rests(state: &State) -> bool {
    state.acceleration.iter().all(|a| *a == 0.0)
}

/// Share of a value that round-off may leave of it: of a reaction across its direction, of a load that does not jump.
const ROUNDED: f64 = 1e-12;

/// Share of the largest force that round-off may leave of any.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// Whether loads, dampers or temperatures are others at a time than those with which the last increment ended there, whatever
/// their kind: without new accelerations the old ones would go on for half an increment. Where a step is cut in two nothing jumps,
/// and accelerations that belong to another time, as those of generalized-α, are kept.
fn jumps(step: &Step, old: &State, work: &mut Workspace) -> Result<bool, IncrementFailure> {
    let mut now = old.clone();
    evaluate_forces(step, &mut now, work)?;
    let memory = &work.assembler.evaluation.memory;
    // Reactions count as loads in a state.
    let given: Vec<f64> =
        old.external.iter().zip(&old.reaction).map(|(external, reaction)| external - reaction).collect();
    let largest = |values: &[f64]| values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let forces = [&old.force, &old.external, &old.damping, &now.external].map(|forces| largest(forces));
    let differ = |[before, after]: [&[f64]; 2], beside: Option<&[f64]>, least: f64| {
        (0..before.len()).any(|k| {
            let size = before[k].abs().max(after[k].abs()).max(beside.map_or(0.0, |values| values[k].abs()));
            (after[k] - before[k]).abs() > ROUNDED * size + ROUND_OFF * least
        })
    };
    let force = forces.into_iter().fold(0.0, f64::max);
    Ok(differ([&given, &now.external], Some(&old.reaction), force)
        || differ([&old.damping, &now.damping], None, force)
        || differ([&old.memory, memory], None, largest(&old.memory)))
}

/// Whether a dof with a reaction is free from now on: without it, accelerations jump.
fn frees(step: &Step, old: &State) -> bool {
    let reaction = |at: Direction| at.of(&old.reaction).abs();
    let held = |dof: usize| {
        let at = step.support_at(dof)?.at;
        // Along an inclined direction the components are rounded.
        Some(at.across().is_none_or(|across| reaction(across) <= ROUNDED * reaction(at)))
    };
    (0..old.reaction.len()).any(|dof| old.reaction[dof] != 0.0 && !held(dof).unwrap_or(false))
}

/// Take up a step again after explicit increments within it.
///
/// # Errors
/// [`IncrementFailure`] when the state cannot be evaluated or a body has no mass.
pub fn go_on(model: &Model, step: &Step, old: &State, work: &mut Workspace) -> Result<State, IncrementFailure> {
    let mut state = State { last_increment: None, ..old.clone() };
    if step.scheme.is_dynamic() {
        start_dynamics(model, step, &mut state, work)?;
        moves_anew(step, &mut state, work);
        return Ok(state);
    }
    model.ties.gather(2, &mut state.force);
    state.stop();
    Ok(state)
}

/// Accelerations, and the forces that go with them, at a moment when dynamics begins: loads may set in with a jump.
///
/// ```text
/// M a₀ = −F₀ at the free dofs; a₀ of the supports at the prescribed ones, whose reaction is F₀ + M a₀
/// ```
fn start_dynamics(model: &Model, step: &Step, state: &mut State, work: &mut Workspace) -> Result<(), IncrementFailure> {
    evaluate_forces(step, state, work)?;
    heat(step, &work.assembler.evaluation, state);
    let force = &state.force;
    let mut right: Vec<f64> = force.iter().map(|f| -f).collect();
    let mut mass = work.assembler.mass().clone();
    links::gather_rows(model, &mut mass);
    links::gather_residual(model, &mut right);
    let scale = mass.diagonal().into_iter().fold(0.0, f64::max);
    let dt = step.increments.initial;
    let first = Trial::new(state, step, state.time + dt, dt);
    // Nodes without mass are in equilibrium from the first increment on.
    let without = |dof: &usize| model.massless[dof / 2] && mass.diagonal()[*dof] == 0.0;
    for dof in (0..model.dofs()).filter(without).collect::<Vec<_>>() {
        mass.replace_row(dof, scale);
        right[dof] = 0.0;
    }
    for support in &step.supports {
        hold(support.at, scale, &mut mass);
        turn(support.at, scale * start_acceleration(first.thirds(support, model), dt), &mut right);
    }
    tie(model, &mut mass, scale);
    links::begin(model, scale, state, &mut mass, &mut right);
    state.acceleration = linear::solve(&mut *work.solver, &mass, &right).map_err(IncrementFailure::Mass)?.x;
    let mut inertia = work.assembler.mass().multiply(&state.acceleration);
    model.linkage.gather(&mut inertia);
    let [force, inertia] = [force, &inertia].map(|forces| links::relieved(model, &state.displacement, forces));
    for support in &step.supports {
        support.at.add(support.at.of(&force) + support.at.of(&inertia), &mut state.external);
    }
    Ok(())
}

/// The forces at the start of a static run whose bodies are stressed or contacts closed already: loads and reactions balance
/// them.
fn start_loaded(step: &Step, state: &mut State, work: &mut Workspace) -> Result<(), IncrementFailure> {
    // Statics bring temperatures in with the first increment.
    evaluate_forces(&Step { temperatures: Vec::new(), ..step.clone() }, state, work)?;
    let force = links::relieved(work.assembler.model(), &state.displacement, &state.force);
    step.supports.iter().for_each(|support| support.at.add(support.at.of(&force), &mut state.external));
    Ok(())
}

/// Forces of the state as it is, under the loads that the step puts on it at this time.
fn evaluate_forces(step: &Step, state: &mut State, work: &mut Workspace) -> Result<(), IncrementFailure> {
    let quasi_static = Step { scheme: Scheme::Static, ..step.clone() };
    let trial = Trial::new(state, &quasi_static, state.time, 0.0);
    work.assembler.residual(trial, &state.displacement, &mut work.system).map_err(IncrementFailure::Start)?;
    let evaluation = &work.assembler.evaluation;
    state.force.clone_from(&evaluation.force);
    state.external.clone_from(&evaluation.loads);
    state.damping.clone_from(&evaluation.damping);
    Ok(())
}

/// Solve one increment of length `dt` from the state `old`; pure but for the workspace's buffers.
///
/// The record of the iterations comes back from a failed attempt as well.
pub fn advance(
    model: &Model,
    step: &Step,
    old: &State,
    dt: f64,
    work: &mut Workspace,
) -> (Vec<IterationRecord>, Result<State, IncrementFailure>) {
    // The last increment of a step ends on its end, not within round-off of it.
    let time = if old.time + dt > step.span.end - 1e-9 * dt { step.span.end } else { old.time + dt };
    let increment = Trial::new(old, step, time, time - old.time);
    let (iterations, equilibrium) = augment(model, increment.ahead(), work);
    let new =
        equilibrium.and_then(|u| reach_end(model, increment, u, work)).map(|u| reached(model, increment, u, work));
    (iterations, new)
}

/// Displacement at the end of an increment from the equilibrium `u` that was just found ahead of it, and everything
/// else evaluated there; `u` itself unless the scheme looks beyond the end.
fn reach_end(model: &Model, end: Trial, beyond: Vec<f64>, work: &mut Workspace) -> Result<Vec<f64>, IncrementFailure> {
    let Trial { old, step, dt, .. } = end;
    let theta = step.scheme.theta();
    let Some(scheme) = step.scheme.coefficients().filter(|_| theta > 1.0) else { return Ok(beyond) };
    let ahead = &work.assembler.evaluation.acceleration;
    let reach = |dof: usize| {
        let (v, a) = (old.velocity[dof], old.acceleration[dof]);
        old.displacement[dof] + scheme.increment((v, a), a + (ahead[dof] - a) / theta, dt)
    };
    let mut u: Vec<f64> = (0..beyond.len()).map(reach).collect();
    for support in &step.supports {
        support.at.set(end.prescribed(support, model), &mut u);
    }
    model.ties.spread(2, &mut u);
    turning::reach_end(model, end, [&beyond, ahead], scheme, &mut u);
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

fn kinetic(step: &Step, state: &State, work: &mut Workspace) -> f64 {
    if step.scheme.is_dynamic() { kinetic_energy(work.assembler.mass(), &state.velocity) } else { 0.0 }
}
