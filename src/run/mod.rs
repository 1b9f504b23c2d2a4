//! The run: step after step, increment after increment, with cut-back, and observers that see every attempt.

pub mod error;
pub mod law;
pub mod law_path;
pub mod law_report;
pub mod observer;
pub mod report;

use std::time::Instant;

use crate::linear::Multifrontal;
use crate::model::boundary::Span;
use crate::model::scheme::Scheme;
use crate::model::state::State;
use crate::model::{Model, Rupture, Step};
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer};
use crate::run::report::RunReport;
use crate::solve::failure::IncrementFailure;
use crate::solve::{IterationRecord, Workspace};
use crate::time::explicit::Explicit;
use crate::time::increment::{advance, begin, go_on};
use crate::time::step_size::{Judgement, Touching, bounded, fastest_slip, judge};

/// Cut of the increment after one that could not be solved.
const CUT: f64 = 0.5;

/// Results of an explicit step if the case does not say how many, and of the time that a shear wave takes across the model
/// where a step is explicit while a contact slips fast.
const RESULTS: f64 = 100.0;

/// Run all steps of a model. The report comes back from a stopped run as well.
///
/// # Errors
/// [`Error`] when an increment cannot be made small enough, or an observer cannot write.
pub fn run(model: &Model, observers: &mut [&mut dyn Observer]) -> (RunReport, Result<State, Error>) {
    let clock = Instant::now();
    let mut run = Run {
        model,
        state: model.initial_state(),
        work: Workspace::new(model, Box::<Multifrontal>::default()),
        report: RunReport::default(),
        observers,
    };
    let mut result = model.steps.iter().try_for_each(|step| run.step(step));
    let Run { state, work, mut report, observers, .. } = run;
    report.stabilization_work = state.energy.stabilization;
    report.energy = state.energy;
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

/// A run under way.
struct Run<'m, 'o, 'p> {
    model: &'m Model,
    state: State,
    work: Workspace<'m>,
    report: RunReport,
    observers: &'o mut [&'p mut dyn Observer],
}

/// How a stretch of implicit increments ends.
enum Stretch {
    /// At the end of the step
    Complete,
    /// Before an increment in which a contact slips too fast for it
    Rupture,
}

impl<'m> Run<'m, '_, '_> {
    fn step(&mut self, step: &'m Step) -> Result<(), Error> {
        if matches!(step.scheme, Scheme::Explicit { .. }) {
            return self.explicit(step);
        }
        let started = begin(self.model, step, &self.state, &mut self.work);
        self.state = started.map_err(|cause| self.unsolvable(step, cause))?;
        while let Stretch::Rupture = self.implicit(step)? {
            let Some(rupture) = &step.rupture else { break };
            self.report.ruptures += 1;
            self.rupture(rupture)?;
            if self.state.time >= step.span.end {
                break;
            }
            let resumed = go_on(self.model, step, &mut self.state, &mut self.work);
            resumed.map_err(|cause| self.unsolvable(step, cause))?;
        }
        Ok(())
    }

    fn unsolvable(&self, step: &Step, cause: IncrementFailure) -> Error {
        Error::Unsolvable { step: step.name.clone(), time: self.state.time, cause }
    }

    /// A step of explicit increments. Observers see the state at the times of output.
    fn explicit(&mut self, step: &'m Step) -> Result<(), Error> {
        let Span { start, end } = step.span;
        let interval = self.model.interval.unwrap_or((end - start) / RESULTS);
        let begun = Explicit::begin(self.model, step, &mut self.state, &mut self.work.assembler);
        let mut explicit = begun.map_err(|cause| self.unsolvable(step, cause))?;
        for k in 1.. {
            self.explicit_to(&mut explicit, step, start + f64::from(k) * interval, interval)?;
            if self.state.time == end {
                break;
            }
        }
        Ok(())
    }

    /// Explicit increments within a step while a contact slips fast.
    fn rupture(&mut self, rupture: &'m Rupture) -> Result<(), Error> {
        let Rupture { slip_rate, calm, explicit: step } = rupture;
        let interval = self.model.interval.unwrap_or(f64::INFINITY).min(calm / RESULTS);
        let begun = Explicit::go_on(self.model, step, &mut self.state, &mut self.work.assembler);
        let mut explicit = begun.map_err(|cause| self.unsolvable(step, cause))?;
        let start = self.state.time;
        let mut before = self.state.clone();
        for k in 1.. {
            self.explicit_to(&mut explicit, step, start + f64::from(k) * interval, interval)?;
            if self.state.time == step.span.end {
                break;
            }
            if self.state.time - before.time >= *calm {
                if fastest_slip(self.model, &before, &self.state) <= *slip_rate {
                    break;
                }
                before = self.state.clone();
            }
        }
        Ok(())
    }

    /// Explicit increments to a time of output, or to the end of the step if that is near.
    fn explicit_to(&mut self, explicit: &mut Explicit, step: &Step, time: f64, interval: f64) -> Result<(), Error> {
        let end = step.span.end;
        let time = if time > end - 1e-6 * interval { end } else { time };
        let old = self.state.clone();
        let attempt = |number: usize| Attempt {
            step,
            number,
            old: &old,
            dt: time - old.time,
            iterations: &[],
            accepted: None,
            local_error: None,
            doubt: None,
        };
        for number in 1.. {
            let outcome = explicit.go_to(time, &mut self.state, &mut self.work.assembler);
            let cause = match outcome {
                Ok(count) => {
                    self.report.increments += count;
                    let told = Attempt { accepted: Some(&self.state), ..attempt(number) };
                    return tell(self.model, &told, self.observers, &mut self.report);
                }
                Err(cause) if !cause.is_collapse() => return Err(self.unsolvable(step, cause)),
                Err(cause) => cause,
            };
            self.report.cutbacks += 1;
            tell(self.model, &attempt(number), self.observers, &mut self.report)?;
            let collapsed = std::mem::replace(&mut self.state, old.clone());
            let again = explicit.more_carefully(&mut self.state, &mut self.work.assembler);
            if !again.map_err(|cause| self.unsolvable(step, cause))? {
                self.state = collapsed;
                return Err(self.unsolvable(step, cause.after_all()));
            }
        }
        Ok(())
    }

    /// Implicit or static increments until the end of the step, or until a contact slips too fast.
    fn implicit(&mut self, step: &Step) -> Result<Stretch, Error> {
        let mut dt = step.increments.initial;
        let mut attempt = 1;
        let mut touching = Touching::default();
        while self.state.time < step.span.end {
            dt = bounded(step, self.state.time, dt);
            let (iterations, outcome) = advance(self.model, step, &self.state, dt, &mut self.work);
            self.report.newton_iterations += iterations.len();
            self.report.factorizations += iterations.iter().filter(|iteration| iteration.newton.factorized).count();
            let mut doubt = None;
            let solved = outcome.map(|mut new| {
                let iterations = hardest_pass(&iterations);
                let mut judgement = judge(self.model, step, [&self.state, &new], iterations, attempt > 1);
                if judgement.accepted && !step.scheme.is_dynamic() {
                    let judged =
                        touching.judge(self.model, step, &self.state, &mut new, &self.work.foreseen, judgement);
                    (judgement, doubt) = (judged.0, Some(judged.1));
                } else {
                    touching.give_up();
                }
                (new, judgement)
            });
            let fast = |new: &State| {
                step.rupture
                    .as_ref()
                    .is_some_and(|rupture| fastest_slip(self.model, &self.state, new) > rupture.slip_rate)
            };
            let too_fast = solved.as_ref().is_ok_and(|(new, _)| fast(new));
            let accepted = solved.as_ref().ok().filter(|(_, judgement)| judgement.accepted && !too_fast);
            let told = Attempt {
                step,
                number: attempt,
                old: &self.state,
                dt,
                iterations: &iterations,
                accepted: accepted.map(|(new, _)| new),
                local_error: solved.as_ref().ok().and_then(|(_, judgement)| judgement.error),
                doubt,
            };
            tell(self.model, &told, self.observers, &mut self.report)?;
            let shortest = CUT * dt < step.increments.min;
            match solved {
                Ok(_) if too_fast => {
                    touching.give_up();
                    self.report.rejected += 1;
                    if shortest {
                        return Ok(Stretch::Rupture);
                    }
                    attempt += 1;
                    dt *= CUT;
                }
                Ok((new, Judgement { accepted: true, next, .. })) => {
                    self.state = new;
                    self.report.increments += 1;
                    attempt = 1;
                    dt = next;
                }
                Ok((_, Judgement { next, .. })) => {
                    self.report.rejected += 1;
                    attempt += 1;
                    dt = next;
                }
                Err(cause) if !cause.is_retryable() => return Err(self.unsolvable(step, cause)),
                Err(_) if shortest && step.rupture.is_some() => {
                    self.report.cutbacks += 1;
                    return Ok(Stretch::Rupture);
                }
                Err(cause) if shortest => {
                    let (step, time, min) = (step.name.clone(), self.state.time, step.increments.min);
                    return Err(Error::IncrementTooSmall { step, time, dt, min, cause });
                }
                Err(_) => {
                    touching.cut();
                    self.report.cutbacks += 1;
                    attempt += 1;
                    dt *= CUT;
                }
            }
        }
        Ok(Stretch::Complete)
    }
}

/// Tangents of the pass that took most: the augmented Lagrangian solves an increment several times.
fn hardest_pass(iterations: &[IterationRecord]) -> usize {
    let tangents = |pass: &[IterationRecord]| pass.iter().filter(|iteration| iteration.newton.factorized).count();
    iterations.chunk_by(|a, b| a.pass == b.pass).map(tangents).max().unwrap_or(0)
}

/// Tell all observers of an attempt.
fn tell(
    model: &Model,
    attempt: &Attempt,
    observers: &mut [&mut dyn Observer],
    report: &mut RunReport,
) -> Result<(), Error> {
    let clock = Instant::now();
    observers.iter_mut().try_for_each(|observer| observer.record(model, attempt))?;
    report.wall_s.output += clock.elapsed().as_secs_f64();
    Ok(())
}
