//! The run: step after step, increment after increment, with cut-back, and observers that see every attempt.

use std::time::Instant;

use crate::boundary::Span;
use crate::error::Error;
use crate::explicit::Explicit;
use crate::increments::{Judgement, bounded, judge};
use crate::linear::Multifrontal;
use crate::model::{Model, Step};
use crate::output::summary::RunReport;
use crate::output::{Attempt, Observer};
use crate::state::State;
use crate::step::{Workspace, advance, begin};
use crate::time::Scheme;

/// Cut of the increment after one that could not be solved.
const CUT: f64 = 0.5;

/// Run all steps of a model. The report comes back from a stopped run as well.
///
/// # Errors
/// [`Error`] when an increment cannot be made small enough, or an observer cannot write.
pub fn run(model: &Model, observers: &mut [&mut dyn Observer]) -> (RunReport, Result<State, Error>) {
    let clock = Instant::now();
    let mut report = RunReport::default();
    let mut work = Workspace::new(model, Box::<Multifrontal>::default());
    let mut state = model.initial_state();
    let mut result = Ok(());
    for step in &model.steps {
        result = match step.scheme {
            Scheme::Explicit { .. } => run_explicit(model, step, &mut state, &mut work, observers, &mut report),
            _ => run_step(model, step, &mut state, &mut work, observers, &mut report),
        };
        if result.is_err() {
            break;
        }
    }
    report.stabilization_work = state.energy.stabilization;
    let waiting = Instant::now();
    for observer in observers.iter_mut() {
        result = result.and(observer.finish());
    }
    report.wall_s.output += waiting.elapsed().as_secs_f64();
    report.wall_s.assembly = work.assembler.seconds.assembly;
    report.wall_s.contact = work.assembler.seconds.contact;
    report.wall_s.linear = work.linear_seconds;
    report.wall_s.total = clock.elapsed().as_secs_f64();
    (report, result.map(|()| state))
}

/// Results of an explicit step if the case does not say how many.
const RESULTS: f64 = 100.0;

/// A step of explicit increments. Observers see the state at the times of output.
fn run_explicit(
    model: &Model,
    step: &Step,
    state: &mut State,
    work: &mut Workspace,
    observers: &mut [&mut dyn Observer],
    report: &mut RunReport,
) -> Result<(), Error> {
    let Span { start, end } = step.span;
    let interval = model.interval.unwrap_or((end - start) / RESULTS);
    let unsolvable = |time: f64, cause| Error::Unsolvable { step: step.name.clone(), time, cause };
    let begun = Explicit::begin(model, step, state, &mut work.assembler);
    let mut explicit = begun.map_err(|cause| unsolvable(state.time, cause))?;
    for k in 1.. {
        let old = state.clone();
        let next = start + f64::from(k) * interval;
        let time = if next > end - 1e-6 * interval { end } else { next };
        let count = explicit.go_to(time, state, &mut work.assembler);
        report.increments += count.map_err(|cause| unsolvable(state.time, cause))?;
        let told = Attempt {
            step,
            number: 1,
            old: &old,
            dt: time - old.time,
            iterations: &[],
            accepted: Some(state),
            local_error: None,
        };
        let clock = Instant::now();
        for observer in observers.iter_mut() {
            observer.record(model, &told)?;
        }
        report.wall_s.output += clock.elapsed().as_secs_f64();
        if time == end {
            break;
        }
    }
    Ok(())
}

fn run_step(
    model: &Model,
    step: &Step,
    state: &mut State,
    work: &mut Workspace,
    observers: &mut [&mut dyn Observer],
    report: &mut RunReport,
) -> Result<(), Error> {
    let name = || step.name.clone();
    *state =
        begin(model, step, state, work).map_err(|cause| Error::Unsolvable { step: name(), time: state.time, cause })?;
    let mut dt = step.increments.initial;
    let mut attempt = 1;
    while state.time < step.span.end {
        dt = bounded(step, state.time, dt);
        let (iterations, outcome) = advance(model, step, state, dt, work);
        report.newton_iterations += iterations.len();
        report.factorizations += iterations.iter().filter(|iteration| iteration.newton.factorized).count();
        let solved = outcome.map(|new| {
            let judgement = judge(model, step, [state, &new], iterations.len(), attempt > 1);
            (new, judgement)
        });
        let accepted = solved.as_ref().ok().filter(|(_, judgement)| judgement.accepted);
        let told = Attempt {
            step,
            number: attempt,
            old: state,
            dt,
            iterations: &iterations,
            accepted: accepted.map(|(new, _)| new),
            local_error: solved.as_ref().ok().and_then(|(_, judgement)| judgement.error),
        };
        let clock = Instant::now();
        for observer in observers.iter_mut() {
            observer.record(model, &told)?;
        }
        report.wall_s.output += clock.elapsed().as_secs_f64();
        match solved {
            Ok((new, Judgement { accepted: true, next, .. })) => {
                *state = new;
                report.increments += 1;
                attempt = 1;
                dt = next;
            }
            Ok((_, Judgement { next, .. })) => {
                report.rejected += 1;
                attempt += 1;
                dt = next;
            }
            Err(cause) if !cause.is_retryable() => {
                return Err(Error::Unsolvable { step: name(), time: state.time, cause });
            }
            Err(cause) if CUT * dt < step.increments.min => {
                return Err(Error::StepTooSmall {
                    step: name(),
                    time: state.time,
                    dt,
                    min: step.increments.min,
                    cause,
                });
            }
            Err(_) => {
                report.cutbacks += 1;
                attempt += 1;
                dt *= CUT;
            }
        }
    }
    Ok(())
}
