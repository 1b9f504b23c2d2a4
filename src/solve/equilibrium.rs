//! Equilibrium at the time of a trial, from the start value on.

use super::contact_iteration::cycle::Cycle;
use super::failure::IncrementFailure;
use super::floating::null_motion;
use super::newton;
use super::{IterationRecord, Workspace};
use crate::equations::{ContactCounts, Trial};
use crate::linear::system::Request;
use crate::model::Model;
use crate::model::state::{LastIncrement, State};

/// Equilibrium at the time of a trial, wherever the scheme asks for it; from the start value of a new increment unless
/// another is given.
pub fn equilibrium(
    model: &Model,
    trial: Trial,
    start: Option<Vec<f64>>,
    work: &mut Workspace,
) -> (Vec<IterationRecord>, Result<Vec<f64>, IncrementFailure>) {
    let Trial { old, step, .. } = trial;
    let Workspace { assembler, iteration, solver, system, foreseen, linear_seconds } = work;
    let begins = start.is_none();
    if begins {
        iteration.start_increment();
    }
    let mut tangents = 0;
    let mut seen = Vec::new();
    let mut cycle = Cycle::default();
    let mut floating = None;
    let spent = assembler.seconds.assembly + assembler.seconds.contact;
    let clock = std::time::Instant::now();
    let start = start.unwrap_or_else(|| start_value(trial));
    let (iterations, result) = newton::solve(start, model.newton, &mut **solver, system, |u, request, system| {
        iteration.evaluate(assembler, trial, u, request, system)?;
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
            seen.push((ContactCounts::of(&evaluation.contacts), cycle.count(&evaluation.contacts), share));
        }
        Ok(cycle.share())
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
