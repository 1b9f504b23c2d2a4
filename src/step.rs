//! One increment: old state → new state.

use crate::assembly::{Assembler, ContactCounts, Trial, prescribed_dofs};
use crate::configuration::Configuration;
use crate::contact::force::ContactState;
use crate::error::StepFailure;
use crate::floating::null_motion;
use crate::linear::{self, LinearSolver};
use crate::model::{Model, Step};
use crate::newton::{self, Iteration, Request};
use crate::state::{LastIncrement, State, StepStart};
use crate::system::System;

/// What is kept from one increment to the next to save work; it does not change any answer.
pub struct Workspace<'m> {
    /// assembles the equations
    pub assembler: Assembler<'m>,
    /// solves them
    pub solver: Box<dyn LinearSolver>,
    system: System,
    /// Seconds spent in linear solves
    pub linear_seconds: f64,
}

impl<'m> Workspace<'m> {
    /// A workspace for a model.
    pub fn new(model: &'m Model, solver: Box<dyn LinearSolver>) -> Self {
        let assembler = Assembler::new(model);
        let system = assembler.system();
        Self { assembler, solver, system, linear_seconds: 0.0 }
    }
}

/// One row of the convergence record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IterationRecord {
    /// residual, correction, linear residual
    pub newton: Iteration,
    /// contact states after the correction
    pub contacts: ContactCounts,
}

/// Begin a step: remember displacements and reactions, and find the accelerations if dynamics starts here.
///
/// # Errors
/// [`StepFailure`] when the initial state cannot be evaluated or a body has no mass.
pub fn begin(model: &Model, step: &Step, old: &State, work: &mut Workspace) -> Result<State, StepFailure> {
    let mut state = old.clone();
    state.step_start = StepStart { displacement: old.displacement.clone(), reaction: old.reaction.clone() };
    state.last_increment = None;
    let resting = old.acceleration.iter().all(|a| *a == 0.0);
    match step.scheme.coefficients() {
        Some(_) if resting => start_dynamics(step, &mut state, work)?,
        // The reaction of a freed support has become a load.
        Some(_) => step.released.iter().for_each(|&dof| state.force[dof] -= old.reaction[dof]),
        None => {}
    }
    if state.increment == 0 {
        state.energy.kinetic = kinetic_energy(step, &state, work);
        state.energy.contact_elastic =
            contact_energy(model, &state.contacts, &model.configuration(&state.displacement));
        state.energy.initial = state.energy.kinetic + state.energy.contact_elastic;
    }
    Ok(state)
}

/// Accelerations, and the forces that go with them, at a moment when dynamics begins: loads may set in with a jump.
///
/// ```text
/// a₀ = −M⁻¹ F₀ at the free dofs, 0 at the prescribed ones, whose reaction is F₀ + M a₀
/// ```
fn start_dynamics(step: &Step, state: &mut State, work: &mut Workspace) -> Result<(), StepFailure> {
    let quasi_static = Step { scheme: crate::time::Scheme::Static, ..step.clone() };
    let trial = Trial { old: state, step: &quasi_static, time: state.time, dt: 0.0 };
    work.assembler
        .evaluate(trial, &state.displacement, Request::Residual, &mut work.system)
        .map_err(StepFailure::Start)?;
    let force = work.assembler.evaluation.force.clone();
    state.external.clone_from(&work.assembler.evaluation.loads);
    let prescribed = prescribed_dofs(step, force.len());
    let mut right: Vec<f64> = force.iter().map(|f| -f).collect();
    let mut mass = work.assembler.mass().clone();
    let scale = mass.diagonal().into_iter().fold(0.0, f64::max);
    for (dof, _) in prescribed.iter().enumerate().filter(|(_, held)| **held) {
        mass.replace_row(dof, scale);
        right[dof] = 0.0;
    }
    state.acceleration = linear::solve(&mut *work.solver, &mass, &right).map_err(StepFailure::Mass)?.x;
    let inertia = work.assembler.mass().multiply(&state.acceleration);
    for (dof, _) in prescribed.iter().enumerate().filter(|(_, held)| **held) {
        state.external[dof] += force[dof] + inertia[dof];
    }
    state.force = force;
    Ok(())
}

/// Solve one increment of length `dt` from the state `old`; pure but for the workspace's buffers.
///
/// The start value is the last increment extrapolated. The record of the iterations comes back from a failed attempt as well.
pub fn advance(
    model: &Model,
    step: &Step,
    old: &State,
    dt: f64,
    work: &mut Workspace,
) -> (Vec<IterationRecord>, Result<State, StepFailure>) {
    // The last increment of a step ends on its end, not within round-off of it.
    let time = if old.time + dt > step.span.end - 1e-9 * dt { step.span.end } else { old.time + dt };
    let trial = Trial { old, step, time, dt: time - old.time };
    let (mut iterations, mut result) = solve(model, trial, start_value(old, trial.dt), true, work);
    let mut passes = 1;
    while let Ok(u) = &result
        && let Some(multiplied) = augmented(model, old, work)
    {
        if passes == MOST_PASSES {
            result = Err(StepFailure::Penetration { passes });
            break;
        }
        let (more, again) = solve(model, Trial { old: &multiplied, ..trial }, u.clone(), false, work);
        iterations.extend(more);
        result = again;
        passes += 1;
    }
    (iterations, result.map(|u| accept(model, trial, u, work)))
}

/// Solutions with better and better multipliers before an increment of the augmented Lagrangian is given up.
const MOST_PASSES: usize = 100;

/// The committed state with the pressures just found as multipliers, if some pair asks for it.
fn augmented(model: &Model, old: &State, work: &Workspace) -> Option<State> {
    let trial = &work.assembler.evaluation.contacts;
    let pairs = model.contacts.iter().zip(&old.contacts).zip(trial);
    let multiplied: Vec<_> = pairs.map(|((pair, old), trial)| pair.augmented(old, trial)).collect();
    if multiplied.iter().all(Option::is_none) {
        return None;
    }
    // A pair that is content keeps the multipliers of this pass.
    let kept = |old: &[ContactState], trial: &[ContactState]| {
        let keep = |(old, new): (&ContactState, &ContactState)| ContactState { multiplier: new.multiplier, ..*old };
        old.iter().zip(trial).map(keep).collect()
    };
    let pairs = multiplied.into_iter().zip(old.contacts.iter().zip(trial));
    let contacts = pairs.map(|(multiplied, (old, trial))| multiplied.unwrap_or_else(|| kept(old, trial))).collect();
    Some(State { contacts, ..old.clone() })
}

/// Solve the equations of an increment from a start value; `begins` with the first solution of the increment.
fn solve(
    model: &Model,
    trial: Trial,
    start: Vec<f64>,
    begins: bool,
    work: &mut Workspace,
) -> (Vec<IterationRecord>, Result<Vec<f64>, StepFailure>) {
    let old = trial.old;
    let Workspace { assembler, solver, system, linear_seconds } = work;
    if begins {
        assembler.start_increment();
    }
    let mut tangents = 0;
    let mut counts = Vec::new();
    let mut floating = None;
    let spent = assembler.seconds.assembly + assembler.seconds.contact;
    let clock = std::time::Instant::now();
    let (iterations, result) =
        newton::solve(start, model.newton, &mut **solver, system, |u, request, system| {
            assembler.evaluate(trial, u, request, system)?;
            if request == Request::Tangent {
                if begins && tangents == 0 && old.last_increment.is_none() {
                    floating = null_motion(model, u, &system.tangent);
                }
                tangents += 1;
            } else if tangents > 0 {
                counts.push(ContactCounts::of(&assembler.evaluation.contacts));
            }
            Ok(())
        });
    let assembled = assembler.seconds.assembly + assembler.seconds.contact - spent;
    *linear_seconds += clock.elapsed().as_secs_f64() - assembled;
    counts.resize(iterations.len(), ContactCounts::default());
    let iterations =
        iterations.into_iter().zip(counts).map(|(newton, contacts)| IterationRecord { newton, contacts }).collect();
    match (floating, result) {
        (Some(floating), _) => (iterations, Err(StepFailure::Floating(floating))),
        // A trial state may have lost the contact that held a body: worth saying, and worth a smaller increment.
        (None, Err(failure)) => {
            let loose = null_motion(model, &old.displacement, &system.tangent);
            (iterations, Err(loose.map_or(failure.into(), StepFailure::ContactLost)))
        }
        (None, Ok(u)) => (iterations, Ok(u)),
    }
}

/// u_n + Δu_last Δt/Δt_last within a step, u_n at its start.
fn start_value(old: &State, dt: f64) -> Vec<f64> {
    let Some(last) = &old.last_increment else { return old.displacement.clone() };
    let share = dt / last.dt;
    old.displacement.iter().zip(&last.displacement).map(|(u, du)| u + share * du).collect()
}

/// The new state at the converged displacement `u`.
fn accept(model: &Model, trial: Trial, u: Vec<f64>, work: &mut Workspace) -> State {
    let Trial { old, step, time, dt } = trial;
    let evaluation = std::mem::take(&mut work.assembler.evaluation);
    let mut reaction = vec![0.0; u.len()];
    for support in &step.supports {
        reaction[support.dof] = evaluation.balance[support.dof];
    }
    let external: Vec<f64> = evaluation.loads.iter().zip(&reaction).map(|(load, reaction)| load + reaction).collect();
    let increment: Vec<f64> = u.iter().zip(&old.displacement).map(|(new, old)| new - old).collect();
    let work_done: f64 = (0..u.len()).map(|dof| 0.5 * (old.external[dof] + external[dof]) * increment[dof]).sum();
    let x = model.configuration(&u);
    let contact_elastic = contact_energy(model, &evaluation.contacts, &x);
    let dissipated = friction_dissipation(model, old, &evaluation.contacts, &x);
    let mut state = State {
        time,
        increment: old.increment + 1,
        dt,
        displacement: u,
        velocity: evaluation.velocity,
        acceleration: evaluation.acceleration,
        force: evaluation.force,
        external,
        reaction,
        contacts: evaluation.contacts,
        last_increment: Some(LastIncrement { dt, displacement: increment }),
        step_start: old.step_start.clone(),
        energy: old.energy,
    };
    state.energy.external_work += work_done;
    state.energy.strain = evaluation.strain_energy;
    state.energy.contact_elastic = contact_elastic;
    state.energy.friction_dissipation += dissipated;
    state.energy.kinetic = kinetic_energy(step, &state, work);
    state
}

fn kinetic_energy(step: &Step, state: &State, work: &mut Workspace) -> f64 {
    if step.scheme.coefficients().is_none() {
        return 0.0;
    }
    let momentum = work.assembler.mass().multiply(&state.velocity);
    0.5 * momentum.iter().zip(&state.velocity).map(|(p, v)| p * v).sum::<f64>()
}

/// ∫ (α_n g²/2 + q²/(2 α_t)) ds of the closed points in the configuration `x`.
fn contact_energy(model: &Model, contacts: &[Vec<ContactState>], x: &Configuration) -> f64 {
    let mut energy = 0.0;
    for (pair, states) in model.contacts.iter().zip(contacts) {
        for (point, ContactState { friction, gap, .. }) in pair.points.iter().zip(states) {
            let normal = if friction.pressure > 0.0 { 0.5 * pair.alpha_n * gap.powi(2) } else { 0.0 };
            let stiffness = pair.law.stiffness();
            let tangential = if stiffness > 0.0 { 0.5 * friction.traction.powi(2) / stiffness } else { 0.0 };
            energy += point.current_length(x) * (normal + tangential);
        }
    }
    energy
}

/// What friction dissipated from `old` to `new`.
fn friction_dissipation(model: &Model, old: &State, new: &[Vec<ContactState>], x: &Configuration) -> f64 {
    let mut dissipated = 0.0;
    for ((pair, new), old) in model.contacts.iter().zip(new).zip(&old.contacts) {
        for ((point, new), old) in pair.points.iter().zip(new).zip(old) {
            dissipated += point.current_length(x) * (new.friction.dissipation - old.friction.dissipation);
        }
    }
    dissipated
}
