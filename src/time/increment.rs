//! One increment: old state → new state.

use crate::equations::Trial;
use crate::equations::energy::{contact_energy, friction_dissipation, work_of_drivers, work_of_fits};
use crate::linear;
use crate::model::scheme::{Scheme, start_acceleration};
use crate::model::state::{LastIncrement, State};
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
    step.released.iter().for_each(|&dof| state.force[dof] -= old.reaction[dof]);
    match step.scheme.is_dynamic() {
        true if rests(old) || frees(step, old) => start_dynamics(model, step, &mut state, work)?,
        true => {}
        false => {
            state.stop();
            if old.increment == 0 && model.contacts.iter().any(|pair| pair.initial.is_some()) {
                start_loaded(step, &mut state, work)?;
            }
        }
    }
    if state.increment == 0 {
        state.energy.kinetic = kinetic_energy(step, &state, work);
        state.energy.contact_elastic = contact_energy(model, &state.contacts);
        state.energy.initial = state.energy.kinetic + state.energy.contact_elastic;
    }
    Ok(state)
}

/// Whether nothing accelerates.
fn rests(state: &State) -> bool {
    state.acceleration.iter().all(|a| *a == 0.0)
}

/// Whether a dof with a reaction is free from now on: without it, accelerations jump.
fn frees(step: &Step, old: &State) -> bool {
    let held = |dof: &usize| step.supports.binary_search_by_key(dof, |support| support.dof).is_ok();
    (0..old.reaction.len()).any(|dof| old.reaction[dof] != 0.0 && !held(&dof))
}

/// Take up a step again after explicit increments within it.
///
/// # Errors
/// [`IncrementFailure`] when the state cannot be evaluated or a body has no mass.
pub fn go_on(model: &Model, step: &Step, old: &State, work: &mut Workspace) -> Result<State, IncrementFailure> {
    let mut state = State { last_increment: None, ..old.clone() };
    if step.scheme.is_dynamic() {
        start_dynamics(model, step, &mut state, work)?;
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
    let force = &state.force;
    let mut right: Vec<f64> = force.iter().map(|f| -f).collect();
    let mut mass = work.assembler.mass().clone();
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
        mass.replace_row(support.dof, scale);
        right[support.dof] = scale * start_acceleration(first.thirds(support, model), dt);
    }
    work.assembler.tie(&mut mass, scale);
    state.acceleration = linear::solve(&mut *work.solver, &mass, &right).map_err(IncrementFailure::Mass)?.x;
    let inertia = work.assembler.mass().multiply(&state.acceleration);
    for support in &step.supports {
        state.external[support.dof] += force[support.dof] + inertia[support.dof];
    }
    Ok(())
}

/// The forces at the start of a static run whose contacts are closed already: loads and reactions balance them.
fn start_loaded(step: &Step, state: &mut State, work: &mut Workspace) -> Result<(), IncrementFailure> {
    evaluate_forces(step, state, work)?;
    step.supports.iter().for_each(|support| state.external[support.dof] += state.force[support.dof]);
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
    let new = equilibrium.and_then(|u| reach_end(model, increment, u, work)).map(|u| accept(model, increment, u, work));
    (iterations, new)
}

/// Displacement at the end of an increment from the equilibrium `u` that was just found ahead of it, and everything
/// else evaluated there; `u` itself unless the scheme looks beyond the end.
fn reach_end(model: &Model, end: Trial, u: Vec<f64>, work: &mut Workspace) -> Result<Vec<f64>, IncrementFailure> {
    let Trial { old, step, dt, .. } = end;
    let theta = step.scheme.theta();
    let Some(scheme) = step.scheme.coefficients().filter(|_| theta > 1.0) else { return Ok(u) };
    let ahead = &work.assembler.evaluation.acceleration;
    let reach = |dof: usize| {
        let (v, a) = (old.velocity[dof], old.acceleration[dof]);
        old.displacement[dof] + scheme.increment((v, a), a + (ahead[dof] - a) / theta, dt)
    };
    let mut u: Vec<f64> = (0..u.len()).map(reach).collect();
    for support in &step.supports {
        u[support.dof] = end.prescribed(support, model);
    }
    let evaluated = work.assembler.residual(end, &u, &mut work.system);
    evaluated.map_err(|failure| IncrementFailure::Newton(NewtonFailure::Evaluation(failure)))?;
    Ok(u)
}

/// The new state at the converged displacement `u`.
fn accept(model: &Model, trial: Trial, u: Vec<f64>, work: &mut Workspace) -> State {
    let Trial { old, step, time, dt, .. } = trial;
    let evaluation = std::mem::take(&mut work.assembler.evaluation);
    let mut reaction = vec![0.0; u.len()];
    for support in &step.supports {
        reaction[support.dof] = evaluation.balance[support.dof];
    }
    let external: Vec<f64> = evaluation.loads.iter().zip(&reaction).map(|(load, reaction)| load + reaction).collect();
    let increment: Vec<f64> = u.iter().zip(&old.displacement).map(|(new, old)| new - old).collect();
    let mean_work = |old: &[f64], new: &[f64]| -> f64 {
        (0..u.len()).map(|dof| 0.5 * (old[dof] + new[dof]) * increment[dof]).sum()
    };
    let work_done = mean_work(&old.external, &external);
    let damped = mean_work(&old.damping, &evaluation.damping);
    let relaxed = relaxation(step, &old.force, &increment);
    let stabilized: f64 = step.stabilization.iter().zip(&increment).map(|(c, du)| c * du * du).sum();
    let driven = work_of_drivers(model, step, [old.time, time], |dof| increment[dof]);
    let fitted = work_of_fits(model, [&old.contacts, &evaluation.contacts], [old.time, time]);
    let contact_elastic = contact_energy(model, &evaluation.contacts);
    let dissipated = friction_dissipation(&old.contacts, &evaluation.contacts);
    let mut state = State {
        time,
        increment: old.increment + 1,
        dt,
        displacement: u,
        velocity: evaluation.velocity,
        acceleration: evaluation.acceleration,
        force: evaluation.force,
        external,
        damping: evaluation.damping,
        reaction,
        contacts: evaluation.contacts,
        last_increment: Some(LastIncrement { dt, displacement: increment, ends_in_touch: false }),
        step_start: old.step_start.clone(),
        energy: old.energy,
    };
    state.energy.external_work += work_done + driven + fitted;
    state.energy.damping_dissipation += driven - damped + relaxed;
    state.energy.stabilization += trial.stabilization_left() * stabilized / dt;
    state.energy.strain = evaluation.strain_energy;
    state.energy.contact_elastic = contact_elastic;
    state.energy.friction_dissipation += dissipated;
    state.energy.kinetic = kinetic_energy(step, &state, work);
    state
}

/// What forces out of balance at the start of a static increment, left by motion before it, would have set in motion.
fn relaxation(step: &Step, force: &[f64], increment: &[f64]) -> f64 {
    if step.scheme.is_dynamic() {
        return 0.0;
    }
    let all: f64 = force.iter().zip(increment).map(|(f, du)| f * du).sum();
    let supported: f64 = step.supports.iter().map(|support| force[support.dof] * increment[support.dof]).sum();
    -0.5 * (all - supported)
}

fn kinetic_energy(step: &Step, state: &State, work: &mut Workspace) -> f64 {
    if !step.scheme.is_dynamic() {
        return 0.0;
    }
    let momentum = work.assembler.mass().multiply(&state.velocity);
    0.5 * momentum.iter().zip(&state.velocity).map(|(p, v)| p * v).sum::<f64>()
}
