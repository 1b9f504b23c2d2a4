//! Equilibrium at the time of a trial, from the start value on.

use super::acted::Acted;
use super::contact_iteration::flips::Flips;
use super::failure::IncrementFailure;
use super::floating::null_motion;
use super::newton;
use super::start::start_value;
use super::{IterationRecord, Workspace};
use crate::equations::{ContactCounts, Trial};
use crate::linear::system::Request;
use crate::model::Model;

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
    let mut flips = Flips::default();
    let mut floating = None;
    let spent = assembler.seconds.assembly + assembler.seconds.contact;
    let clock = std::time::Instant::now();
    let (start, extrapolated) = start.map_or_else(|| start_value(model, trial), |start| (start, false));
    let settings = newton::Settings {
        tolerance: model.newton.tolerance,
        max_iterations: model.newton.max_iterations,
        old_tangents: model.aids.old_tangents,
        downhill: model.aids.downhill,
    };
    // What acted in the tangent since the last correction
    let mut acted = Acted::default();
    let (iterations, result) = newton::solve(start, settings, &mut **solver, system, |u, request, system| {
        iteration.evaluate(assembler, trial, u, request, system)?;
        // The start value goes on with the last increment; where there is none, the first linear solve tells.
        let foresight = if extrapolated { 0 } else { 1 };
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
            acted = iteration.acted;
            acted.start = usize::from(extrapolated && tangents == 0);
            acted.stiffening = usize::from(trial.stiffening > 1.0);
            tangents += 1;
        } else if tangents > 0 && request == Request::Residual {
            let evaluation = &assembler.evaluation;
            let share = evaluation.stabilization / system.forces.max(f64::MIN_POSITIVE);
            let counts = ContactCounts::of(&evaluation.contacts);
            seen.push((counts, flips.count(&evaluation.contacts), share, std::mem::take(&mut acted)));
        }
        Ok(())
    });
    let assembled = assembler.seconds.assembly + assembler.seconds.contact - spent;
    *linear_seconds += clock.elapsed().as_secs_f64() - assembled;
    // The last state may not have been evaluated.
    seen.resize(iterations.len(), (ContactCounts::default(), 0, 0.0, Acted::default()));
    let record = |(newton, (contacts, flips, stabilization, acted))| IterationRecord {
        newton,
        contacts,
        flips,
        pass: 1,
        stabilization,
        acted: Acted { downhill: usize::from(newton.searched), ..acted },
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
