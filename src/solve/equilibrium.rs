//! Equilibrium at the time of a trial, from the start value on.

use super::acted::Acted;
use super::contact_iteration::flips::Flips;
use super::failure::IncrementFailure;
use super::floating::null_motion;
use super::newton;
use super::start::start_value;
use super::{IterationRecord, Workspace};
use crate::equations::failure::TrialFailure;
use crate::equations::{ContactCounts, Evaluation, Trial};
use crate::linear::SparseMatrix;
use crate::linear::system::Request;
use crate::model::Model;
use crate::model::state::State;

/// Equilibrium at the time of a trial, wherever the scheme asks for it; from the start value of a new increment unless
/// another is given.
pub fn equilibrium(
    model: &Model,
    trial: Trial,
    start: Option<Vec<f64>>,
    work: &mut Workspace,
) -> (Vec<IterationRecord>, Result<Vec<f64>, IncrementFailure>) {
    let Workspace { assembler, iteration, solver, system, foreseen, linear_seconds } = work;
    let begins = start.is_none();
    if begins {
        iteration.start_increment();
    }
    let mut tangents = 0;
    let mut seen = Vec::new();
    let mut flips = Flips::default();
    let mut floating = None;
    let spent = assembler.seconds.assembly + assembler.seconds.contact;
    let clock = std::time::Instant::now();
    let (start, extrapolated) = start.map_or_else(|| start_value(model, trial), |start| (start, false));
    // What acted in the tangent since the last correction
    let mut acted = Acted::default();
    let (iterations, result) = newton::solve(start, settings(model), &mut **solver, system, |u, request, system| {
        iteration.evaluate(assembler, trial, u, request, system)?;
        // The start value goes on with the last increment; where there is none, the first linear solve tells.
        let foresight = if extrapolated { 0 } else { 1 };
        if begins && request == Request::Residual && tangents == foresight {
            foreseen.clone_from(&assembler.evaluation.contacts);
        }
        if request == Request::Tangent {
            if begins && tangents == 0 && is_unaided(trial) {
                floating = null_motion(model, u, &system.tangent);
            }
            acted = iteration.acted;
            acted.start = usize::from(extrapolated && tangents == 0);
            acted.stiffening = usize::from(trial.stiffening > 1.0);
            tangents += 1;
        } else if tangents > 0 && request == Request::Residual {
            seen.push(look(&assembler.evaluation, &mut flips, system.forces, std::mem::take(&mut acted)));
        }
        Ok(())
    });
    let assembled = assembler.seconds.assembly + assembler.seconds.contact - spent;
    *linear_seconds += clock.elapsed().as_secs_f64() - assembled;
    let result = told(model, trial.old, floating, result, &system.tangent);
    (records(iterations, seen), result)
}

/// The solution, or why there is none: bodies that move freely say more than the equations.
fn told(
    model: &Model,
    old: &State,
    floating: Option<String>,
    result: Result<Vec<f64>, newton::NewtonFailure<TrialFailure>>,
    tangent: &SparseMatrix,
) -> Result<Vec<f64>, IncrementFailure> {
    match (floating, result) {
        (Some(floating), _) if old.last_increment.is_none() => Err(IncrementFailure::Floating(floating)),
        (Some(floating), _) => Err(IncrementFailure::ContactLost(floating)),
        // A trial state may have lost the contact that held a body: worth saying, and worth a smaller increment.
        (None, Err(failure)) => {
            let loose = null_motion(model, &old.displacement, tangent);
            Err(loose.map_or(failure.into(), IncrementFailure::ContactLost))
        }
        (None, Ok(u)) => Ok(u),
    }
}

fn settings(model: &Model) -> newton::Settings {
    newton::Settings {
        tolerance: model.newton.tolerance,
        max_iterations: model.newton.max_iterations,
        old_tangents: model.aids.old_tangents,
        downhill: model.aids.downhill,
    }
}

/// Whether a step begins, or its stabilization has just gone.
fn is_unaided(trial: Trial) -> bool {
    let Trial { old, step, .. } = trial;
    old.last_increment.is_none() || (!step.stabilization.is_empty() && trial.stabilization_left() == 0.0)
}

/// What was seen after a correction: contacts, their flips, the share of stabilization in the forces, and what acted.
type Seen = (ContactCounts, usize, f64, Acted);

fn look(evaluation: &Evaluation, flips: &mut Flips, forces: f64, acted: Acted) -> Seen {
    let share = evaluation.stabilization / forces.max(f64::MIN_POSITIVE);
    (ContactCounts::of(&evaluation.contacts), flips.count(&evaluation.contacts), share, acted)
}

/// The iterations with what was seen after each.
fn records(iterations: Vec<newton::Iteration>, mut seen: Vec<Seen>) -> Vec<IterationRecord> {
    // The last state may not have been evaluated.
    seen.resize(iterations.len(), (ContactCounts::default(), 0, 0.0, Acted::default()));
    let record = |(newton, (contacts, flips, stabilization, acted)): (newton::Iteration, Seen)| IterationRecord {
        newton,
        contacts,
        flips,
        pass: 1,
        stabilization,
        acted: Acted { downhill: usize::from(newton.searched), ..acted },
    };
    iterations.into_iter().zip(seen).map(record).collect()
}
