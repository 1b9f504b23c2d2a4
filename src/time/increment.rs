//! One increment: old state → new state.

use crate::contact::force::ContactState;
use crate::equations::energy::{contact_energy, friction_dissipation, work_of_drivers, work_of_fits};
use crate::equations::{Assembler, ContactCounts, Trial};
use crate::laws::friction::Regime;
use crate::linear::system::Request;
use crate::linear::system::System;
use crate::linear::{self, LinearSolver};
use crate::model::scheme::start_acceleration;
use crate::model::state::{LastIncrement, State};
use crate::model::{Model, Step};
use crate::solve::floating::null_motion;
use crate::solve::newton::{self, Iteration, NewtonFailure};
use crate::time::failure::IncrementFailure;

/// What is kept from one increment to the next to save work; it does not change any answer.
pub struct Workspace<'m> {
    /// assembles the equations
    pub assembler: Assembler<'m>,
    /// solves them
    pub solver: Box<dyn LinearSolver>,
    system: System,
    /// Contact states to which the motion before the last attempt would have led, had it gone on
    pub foreseen: Vec<Vec<ContactState>>,
    /// Seconds spent in linear solves
    pub linear_seconds: f64,
}

impl<'m> Workspace<'m> {
    /// A workspace for a model.
    pub fn new(model: &'m Model, solver: Box<dyn LinearSolver>) -> Self {
        let assembler = Assembler::new(model);
        let system = assembler.system();
        Self { assembler, solver, system, foreseen: Vec::new(), linear_seconds: 0.0 }
    }
}

/// One row of the convergence record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IterationRecord {
    /// residual, correction, linear residual
    pub newton: Iteration,
    /// contact states after the correction
    pub contacts: ContactCounts,
    /// points that the correction brought back to the status which the one before it had changed
    pub flips: usize,
    /// number of the pass of the augmented Lagrangian; 1 for the plain penalty
    pub pass: usize,
    /// ‖forces that stabilize‖/‖forces at work‖ after the correction [-]
    pub stabilization: f64,
}

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
pub fn go_on(model: &Model, step: &Step, state: &mut State, work: &mut Workspace) -> Result<(), IncrementFailure> {
    state.last_increment = None;
    if step.scheme.is_dynamic() {
        return start_dynamics(model, step, state, work);
    }
    model.ties.gather(2, &mut state.force);
    state.stop();
    Ok(())
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
    let quasi_static = Step { scheme: crate::model::scheme::Scheme::Static, ..step.clone() };
    let trial = Trial::new(state, &quasi_static, state.time, 0.0);
    work.assembler
        .evaluate(trial, &state.displacement, Request::Residual, &mut work.system)
        .map_err(IncrementFailure::Start)?;
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

/// Solutions with better and better multipliers before an increment of the augmented Lagrangian is given up.
const MOST_PASSES: usize = 100;

/// A pass that leaves more than this share of the penetration is slow: the next one is stiffer.
const SLOW: f64 = 0.25;

/// How much stiffer.
const STIFFER: f64 = 10.0;

/// α_n is not raised to more than this many times the given one.
const STIFFEST: f64 = 1e4;

/// Equilibrium at the time of a trial; where a contact asks for the augmented Lagrangian, with multipliers that leave no
/// more penetration than allowed: Uzawa's method, with a penalty that is raised for the increment while passes gain little.
///
/// Source of the rule and its factors: Bertsekas (1982), Constrained Optimization and Lagrange Multiplier Methods, 2.2.
fn augment(
    model: &Model,
    trial: Trial,
    work: &mut Workspace,
) -> (Vec<IterationRecord>, Result<Vec<f64>, IncrementFailure>) {
    let (mut iterations, mut result) = solve(model, trial, None, work);
    let (mut stiffening, mut before) = (1.0, f64::INFINITY);
    for pass in 1.. {
        let Ok(u) = &result else { break };
        let found = &work.assembler.evaluation.contacts;
        let excess = model.contacts.iter().zip(found).map(|(pair, found)| pair.excess(found)).fold(0.0, f64::max);
        if excess <= 1.0 {
            break;
        }
        if pass == MOST_PASSES {
            result = Err(IncrementFailure::Penetration { passes: pass });
            break;
        }
        if excess > SLOW * before {
            stiffening = (STIFFER * stiffening).min(STIFFEST);
        }
        before = excess;
        let multiplied = model.contacts.iter().zip(trial.old.contacts.iter().zip(found));
        let contacts = multiplied.map(|(pair, (old, found))| pair.multiplied(old, found)).collect();
        let old = State { contacts, ..trial.old.clone() };
        let (more, again) = solve(model, Trial { old: &old, stiffening, ..trial }, Some(u.clone()), work);
        iterations.extend(more.into_iter().map(|iteration| IterationRecord { pass: pass + 1, ..iteration }));
        result = again;
    }
    (iterations, result)
}

/// Equilibrium at the time of a trial, wherever the scheme asks for it; from the start value of a new increment unless
/// another is given.
fn solve(
    model: &Model,
    trial: Trial,
    start: Option<Vec<f64>>,
    work: &mut Workspace,
) -> (Vec<IterationRecord>, Result<Vec<f64>, IncrementFailure>) {
    let Trial { old, step, .. } = trial;
    let Workspace { assembler, solver, system, foreseen, linear_seconds } = work;
    let begins = start.is_none();
    if begins {
        assembler.start_increment();
    }
    let mut tangents = 0;
    let mut seen = Vec::new();
    let mut flips = Flips::default();
    let mut floating = None;
    let spent = assembler.seconds.assembly + assembler.seconds.contact;
    let clock = std::time::Instant::now();
    let start = start.unwrap_or_else(|| start_value(trial));
    let (iterations, result) = newton::solve(start, model.newton, &mut **solver, system, |u, request, system| {
        assembler.evaluate(trial, u, request, system)?;
        // The start value goes on with the last increment; where there is none, the first linear solve tells.
        let foresight = if goes_on(old).is_some() { 0 } else { 1 };
        if begins && request == Request::Residual && tangents == foresight {
            foreseen.clone_from(&assembler.evaluation.contacts);
        }
        if request == Request::Tangent {
            // A step begins, or its stabilization has just gone.
            let unaided =
                old.last_increment.is_none() || (!step.stabilization.is_empty() && trial.stabilization_left() == 0.0);
            if begins && tangents == 0 && unaided {
                floating = null_motion(model, u, &system.tangent);
            }
            tangents += 1;
        } else if tangents > 0 {
            let evaluation = &assembler.evaluation;
            let share = evaluation.stabilization / system.forces.max(f64::MIN_POSITIVE);
            seen.push((ContactCounts::of(&evaluation.contacts), flips.count(&evaluation.contacts), share));
        }
        Ok(flips.share())
    });
    let assembled = assembler.seconds.assembly + assembler.seconds.contact - spent;
    *linear_seconds += clock.elapsed().as_secs_f64() - assembled;
    // The last state may not have been evaluated.
    seen.resize(iterations.len(), (ContactCounts::default(), 0, 0.0));
    let record = |(newton, (contacts, flips, stabilization))| IterationRecord {
        newton,
        contacts,
        flips,
        pass: 1,
        stabilization,
    };
    let iterations = iterations.into_iter().zip(seen).map(record).collect();
    let result = match (floating, result) {
        (Some(floating), _) if old.last_increment.is_none() => Err(IncrementFailure::Floating(floating)),
        (Some(floating), _) => Err(IncrementFailure::ContactLost(floating)),
        // A trial state may have lost the contact that held a body: worth saying, and worth a smaller increment.
        (None, Err(failure)) => {
            let loose = null_motion(model, &old.displacement, &system.tangent);
            Err(loose.map_or(failure.into(), IncrementFailure::ContactLost))
        }
        (None, Ok(u)) => Ok(u),
    };
    (iterations, result)
}

/// Watches the contact states go to and fro between iterations.
#[derive(Default)]
struct Flips {
    /// Regime of every point at the last two iterates
    last: [Vec<Regime>; 2],
    /// Iterations in a row in which each point came back
    returns: Vec<usize>,
}

/// Returns in a row that are taken for a cycle. The edge of a contact that is finding its place comes back once or twice.
const CYCLE: usize = 3;

impl Flips {
    /// Number of points that are as they were before the last iterate, and were not in it.
    fn count(&mut self, contacts: &[Vec<ContactState>]) -> usize {
        let now: Vec<Regime> = contacts.iter().flatten().map(ContactState::regime).collect();
        let [last, before] = std::mem::take(&mut self.last);
        self.returns.resize(now.len(), 0);
        for (returns, ((now, last), before)) in self.returns.iter_mut().zip(now.iter().zip(&last).zip(&before)) {
            *returns = if now == before && now != last { *returns + 1 } else { 0 };
        }
        self.last = [now, last];
        self.returns.iter().filter(|returns| **returns > 0).count()
    }

    /// Share of the next correction to take: half of it ends between the two states of a cycle.
    fn share(&self) -> f64 {
        if self.returns.iter().any(|returns| *returns >= CYCLE) { 0.5 } else { 1.0 }
    }
}

/// Where Newton's method starts: the last increment of the step goes on at its pace. In dynamics under error control it is
/// u₀ + Δt v₀ + ½ Δt² a₀, which no accepted increment leaves by much more than the allowed error; where increments do not
/// resolve the motion it would be far off.
fn start_value(Trial { old, step, dt, .. }: Trial) -> Vec<f64> {
    let State { displacement, velocity, acceleration, .. } = old;
    if step.scheme.is_dynamic() && step.increments.error.is_some() {
        let rates = velocity.iter().zip(acceleration);
        return displacement.iter().zip(rates).map(|(u, (v, a))| u + dt * (v + 0.5 * dt * a)).collect();
    }
    let Some(last) = goes_on(old) else { return displacement.clone() };
    let share = dt / last.dt;
    displacement.iter().zip(&last.displacement).map(|(u, du)| u + share * du).collect()
}

/// The last increment of the step, if the next one is expected to be like it.
fn goes_on(old: &State) -> Option<&LastIncrement> {
    old.last_increment.as_ref().filter(|last| !last.ends_in_touch)
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
    let evaluated = work.assembler.evaluate(end, &u, Request::Residual, &mut work.system);
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
        memory: evaluation.memory,
        last_increment: Some(LastIncrement { dt, displacement: increment, ends_in_touch: false }),
        step_start: old.step_start.clone(),
        energy: old.energy,
    };
    state.energy.external_work += work_done + driven + fitted;
    state.energy.damping_dissipation += driven - damped + relaxed + evaluation.dissipated;
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
