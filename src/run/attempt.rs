//! One attempt: the next implicit increment, or explicit ones up to the next output.
//!
//! Preparation of an attempt (start of a step, explicit or quasi-dynamic increments, return to implicit ones) and the phase
//! that follows from it.

use std::sync::Arc;
use std::time::Instant;

use super::control::{Candidate, Midway, Outcome, Outputs, Phase, RESULTS, WatchedSlip, negative_after};
use super::error::Error;
use super::observer::Verdict;
use super::simulation::Simulation;
use crate::equations::condensed::is_linear;
use crate::model::step::{Until, UntilStatus};
use crate::model::{Scheme, State, Step};
use crate::solve::IterationRecord;
use crate::solve::failure::{IncrementFailure, suspicion};
use crate::solve::limit::limit;
use crate::time::beginning::{after_change, begin, go_on};
use crate::time::explicit::Explicit;
use crate::time::increment::{Advanced, advance};
use crate::time::quasi_dynamic::{Gone, QuasiDynamic};
use crate::time::step_size::{Judgement, bounded, fastest_slip, judge, on_ladder};
use crate::time::touching::Touching;

/// Number of times that an increment is halved to keep to stable equilibria.
const HALVINGS: usize = 8;

impl Simulation {
    /// Tries an implicit or static increment.
    pub(super) fn implicit(&mut self, dt: f64, number: usize, mut touching: Touching) -> Candidate {
        let Self { model, step, state: old, work, control, .. } = self;
        let wanted = bounded(step, old.time, dt, None);
        let output = model.requests.next_time(old.time);
        let stop =
            model.next_corner(step, old.time).map_or(output, |corner| Some(output.unwrap_or(corner).min(corner)));
        let dt = bounded(step, old.time, dt, stop);
        let Advanced { iterations, state: solved, foreseen, passes, coupling } = advance(model, step, old, dt, work);
        let (mut local_error, mut uncertainty, mut accepted) = (None, None, None);
        let again = |dt: f64, touching| Phase::Implicit { dt, attempt: number + 1, touching };
        let half = step.shorter(dt, 1);
        // Linear bodies lose their stability by their contacts only, and may be condensed on them, where nothing is counted.
        let loses_stability =
            !is_linear(model, step) && negative_after(step, &iterations, control.negative) > control.negative;
        let outcome = match solved {
            Ok(mut new) => {
                let mut judgement = judge(model, step, [old, &new], hardest_pass(&iterations), number > 1);
                let why = if judgement.accepted { Verdict::Touch } else { Verdict::Error };
                if judgement.accepted && !step.scheme.is_dynamic() {
                    let judged = touching.judge(model, step, old, &mut new, foreseen.as_deref(), judgement);
                    (judgement, uncertainty) = (judged.0, Some(judged.1));
                } else {
                    touching.give_up();
                }
                local_error = judgement.error;
                judgement = judgement.after_output(number, dt, wanted);
                judgement.next = on_ladder(step, judgement.next);
                let ruptures = step.rupture.as_ref().is_some_and(|r| fastest_slip(model, old, &new) > r.slip_rate);
                match judgement {
                    _ if ruptures => {
                        let phase = half.map_or_else(|| self.rupture(), |dt| again(dt, Touching::default()));
                        Outcome::Rejected(Verdict::Rupture, phase)
                    }
                    // A long increment can pass from stable equilibria to an unstable branch near them; a short one rather
                    // follows the stable branch. A branch that becomes unstable itself does so however short increments are.
                    Judgement { accepted: true, .. } if loses_stability && number <= HALVINGS && half.is_some() => {
                        let dt = half.unwrap_or(dt);
                        Outcome::Rejected(Verdict::Unstable, again(dt, Touching::default()))
                    }
                    Judgement { accepted: true, next, .. } => match until(step, [old, &new]) {
                        Some(UntilStatus::Passed(dt)) => {
                            let dt = Until::shorter(dt, new.dt, number);
                            Outcome::Rejected(Verdict::Passed, again(dt, Touching::default()))
                        }
                        until => {
                            let phase = after(step, &new, until, next, touching);
                            accepted = Some(Arc::new(new));
                            Outcome::Accepted(phase)
                        }
                    },
                    Judgement { next, .. } => Outcome::Rejected(why, again(next, touching)),
                }
            }
            Err(cause) => self.unsolved(cause, dt, number, touching),
        };
        let increments = usize::from(accepted.is_some());
        let candidate = self.without_iterations(number, dt, accepted, increments, outcome);
        Candidate { iterations, local_error, uncertainty, passes, coupling, ..candidate }
    }

    /// Outcome of an increment that could not be solved.
    fn unsolved(&self, cause: IncrementFailure, dt: f64, number: usize, mut touching: Touching) -> Outcome {
        let Step { name, increments, rupture, .. } = &*self.step;
        if !cause.is_retryable() {
            return Outcome::Stopped(self.unsolvable(cause));
        }
        if let Some(dt) = self.step.shorter(dt, number) {
            touching.cut();
            return Outcome::Cut(cause, Phase::Implicit { dt, attempt: number + 1, touching });
        }
        if rupture.is_some() {
            return Outcome::Cut(cause, self.rupture());
        }
        let (step, time, min) = (name.clone(), self.state.time, increments.min);
        let limit = limit(&self.model, &self.step, &self.state, &cause);
        let (suspicion, cause) = (suspicion(&self.model, &self.step, &self.work, &self.state, &cause), Box::new(cause));
        Outcome::Stopped(Error::IncrementTooSmall { step, time, dt, min, limit, cause, suspicion })
    }

    /// Phase of the explicit increments within an implicit step.
    fn rupture(&self) -> Phase {
        let calm = self.step.rupture.as_ref().map_or(f64::INFINITY, |rupture| rupture.calm);
        let interval = self.model.requests.interval.unwrap_or(f64::INFINITY).min(calm / RESULTS);
        Phase::Rupture { outputs: Outputs::new(self.state.time, interval), before: self.state.clone(), pace: 0.0 }
    }

    /// Tries explicit increments to the next output. In a rupture, slip is monitored.
    pub(super) fn explicit(&mut self, outputs: Outputs, watched: Option<WatchedSlip>) -> Candidate {
        let (time, following) = outputs.next(self.step.span, self.model.requests.next_time(self.state.time));
        let (from, before_pause) =
            self.midway.as_ref().map_or((&self.state, 0), |midway| (&midway.state, midway.increments));
        let mut state = match self.spare.take() {
            Some(spare) => spare.become_like(from),
            None => State::clone(from),
        };
        let mut explicit = self.explicit.as_mut().map(Explicit::branch);
        let (assembler, pause) = (&mut self.work.assembler, &*self.pause);
        let gone = explicit.as_mut().map_or(Ok(0), |one| one.go_to(time, &mut state, assembler, pause));
        let state = Arc::new(state);
        let increments = before_pause + *gone.as_ref().unwrap_or(&0);
        let arrived = state.time >= time;
        let accepted = (gone.is_ok() && arrived).then(|| state.clone());
        let outcome = match gone {
            Ok(_) if !arrived => Outcome::Paused(Midway { state, increments }),
            Ok(_) => Outcome::Accepted(self.after_output(following, watched, &state)),
            Err(cause) if cause.is_collapse() => Outcome::Collapsed(state, cause),
            Err(cause) => Outcome::Stopped(self.unsolvable(cause)),
        };
        let dt = time - self.state.time;
        Candidate { explicit, ..self.without_iterations(outputs.attempt, dt, accepted, increments, outcome) }
    }

    /// Tries quasi-dynamic steps to the next result.
    pub(super) fn quasi_dynamic(&mut self, dt: f64) -> Candidate {
        let mut state = State::clone(&self.state);
        let clock = Instant::now();
        let gone = self.quasi_dynamic.as_mut().map_or(Ok(Gone { steps: 0, next: dt }), |one| one.go(dt, &mut state));
        self.work.assembler.seconds.contact += clock.elapsed().as_secs_f64();
        let (length, increments) = (state.time - self.state.time, gone.as_ref().map_or(0, |gone| gone.steps));
        let (accepted, outcome) = match gone {
            Ok(Gone { next, .. }) => (Some(Arc::new(state)), Outcome::Accepted(Phase::QuasiDynamic { dt: next })),
            // The cause itself reports the shortest step and whether it is the reason.
            Err(cause) => (None, Outcome::Stopped(self.unsolvable(cause))),
        };
        self.without_iterations(1, length, accepted, increments, outcome)
    }

    /// Candidate of an attempt without Newton iterations.
    fn without_iterations(
        &self,
        number: usize,
        dt: f64,
        accepted: Option<Arc<State>>,
        increments: usize,
        outcome: Outcome,
    ) -> Candidate {
        let (iterations, coupling) = (Vec::new(), self.work.assembler.coupling());
        let (local_error, uncertainty, passes, explicit) = (None, None, Vec::new(), None);
        Candidate {
            number,
            dt,
            iterations,
            accepted,
            local_error,
            uncertainty,
            passes,
            increments,
            outcome,
            coupling,
            explicit,
        }
    }

    /// Phase after an output; a rupture ends when no point has slipped fast during the calm time.
    fn after_output(&self, outputs: Outputs, watched: Option<WatchedSlip>, state: &Arc<State>) -> Phase {
        let (Some(WatchedSlip { before, pace }), Some(rupture)) = (watched, &self.step.rupture) else {
            return Phase::Explicit(outputs);
        };
        if state.time - before.time < rupture.calm {
            return Phase::Rupture { outputs, before, pace };
        }
        let fastest = fastest_slip(&self.model, &before, state);
        match fastest <= rupture.slip_rate {
            true => Phase::Resume { gains: (fastest > pace).then_some(fastest) },
            false => Phase::Rupture { outputs, before: state.clone(), pace: fastest },
        }
    }
}

/// Status of an increment with respect to the reaction that ends the step, if one does.
fn until(step: &Step, states: [&State; 2]) -> Option<UntilStatus> {
    step.until.as_ref().map(|until| until.status(step.span, states))
}

/// Next phase after an accepted increment.
fn after(step: &Step, new: &State, until: Option<UntilStatus>, next: f64, touching: Touching) -> Phase {
    let dt = match until {
        Some(UntilStatus::Met) => return Phase::Met,
        Some(_) if new.time >= step.span.end => return Phase::Missed,
        Some(UntilStatus::Before(Some(left))) => next.min(left),
        _ => next,
    };
    Phase::Implicit { dt, attempt: 1, touching }
}

/// Number of tangents of the augmentation that took most; the augmented Lagrangian method solves an increment several times.
fn hardest_pass(iterations: &[IterationRecord]) -> usize {
    let tangents = |pass: &[IterationRecord]| pass.iter().filter(|iteration| iteration.newton.factorized).count();
    iterations.chunk_by(|a, b| a.pass == b.pass).map(tangents).max().unwrap_or(0)
}

impl Simulation {
    /// Prepares the next attempt: starts a step or explicit increments, or returns to implicit ones.
    pub(super) fn begin(&mut self) -> Result<(), Error> {
        if let Phase::Missed = self.control.phase {
            return Err(self.not_reached());
        }
        let is_explicit = matches!(self.step.scheme, Scheme::Explicit { .. });
        let is_quasi_dynamic = matches!(self.step.scheme, Scheme::QuasiDynamic { .. });
        let begun = match self.control.phase {
            Phase::Begin if is_explicit => self.begin_explicit(true),
            Phase::Begin if is_quasi_dynamic => self.begin_quasi_dynamic(true),
            Phase::QuasiDynamic { .. } if self.quasi_dynamic.is_none() => self.begin_quasi_dynamic(false),
            Phase::Explicit(_) | Phase::Rupture { .. } if self.explicit.is_none() => self.begin_explicit(false),
            Phase::Begin | Phase::Resume { .. } => self.begin_implicit(),
            Phase::Implicit { .. } if self.step_changed => self.take_note(),
            _ => Ok(()),
        };
        begun.map_err(|cause| self.unsolvable(cause))
    }

    /// Continues under the loads that the caller has changed.
    fn take_note(&mut self) -> Result<(), IncrementFailure> {
        let state = after_change(&self.model, &self.step, &self.state, &mut self.work)?;
        self.state = state.map_or_else(|| self.state.clone(), Arc::new);
        Ok(())
    }

    /// Error of a step that ended before its reaction reached the target value.
    fn not_reached(&self) -> Error {
        let (step, state) = (&*self.step, &*self.state);
        let Some(until) = &step.until else { return Error::Ended("the step ended".into()) };
        Error::NotReached {
            step: step.name.clone(),
            time: state.time,
            part: until.name(),
            on: until.on.clone(),
            value: until.value,
            reached: until.value_in(state),
        }
    }

    fn begin_explicit(&mut self, step_begins: bool) -> Result<(), IncrementFailure> {
        let step = Arc::new(self.step_now().clone());
        let mut state = State::clone(&self.state);
        let goes_on = state.is_of_explicit();
        let dt = if goes_on { state.dt } else { 0.0 };
        if step_begins {
            state.begin_step(&step.absent);
            Explicit::launch(&self.model, &step, &mut state);
        }
        (state.dt, state.last_increment) = (dt, None);
        let explicit = Explicit::begin(&self.model, &step, &mut state, &mut self.work.assembler)?;
        if !goes_on {
            explicit.lump(&mut state);
        }
        self.explicit = Some(explicit);
        self.state = Arc::new(state);
        if step_begins {
            let interval = self.model.requests.interval.unwrap_or((step.span.end - step.span.start) / RESULTS);
            self.control.phase = Phase::Explicit(Outputs::new(step.span.start, interval));
        }
        Ok(())
    }

    fn begin_quasi_dynamic(&mut self, step_begins: bool) -> Result<(), IncrementFailure> {
        if step_begins {
            self.state = Arc::new(begin(&self.model, &self.step, &self.state, &mut self.work)?);
        }
        let mut bodies = QuasiDynamic::new(&self.model, &self.step, &self.state)?;
        if step_begins {
            let mut state = State::clone(&self.state);
            bodies.settle(&mut state);
            self.state = Arc::new(state);
            self.control.phase = Phase::QuasiDynamic { dt: self.step.increments.initial };
        }
        self.quasi_dynamic = Some(bodies);
        Ok(())
    }

    fn begin_implicit(&mut self) -> Result<(), IncrementFailure> {
        let state = match self.control.phase {
            Phase::Resume { gains } => {
                let stops = !self.step.scheme.is_dynamic();
                self.control.moving = gains.filter(|_| stops).map(|pace| (self.state.clone(), pace));
                go_on(&self.model, &self.step, &self.state, &mut self.work)?
            }
            _ => begin(&self.model, &self.step, &self.state, &mut self.work)?,
        };
        self.state = Arc::new(state);
        let dt = self.step.increments.initial;
        self.control.phase = Phase::Implicit { dt, attempt: 1, touching: Touching::default() };
        Ok(())
    }

    /// Restarts with shorter explicit increments from the last accepted state after the longer ones collapsed.
    pub(super) fn more_carefully(&mut self, collapsed: Arc<State>, cause: IncrementFailure) -> Result<(), Error> {
        let mut state = State::clone(&self.state);
        let Some(explicit) = &mut self.explicit else { return Err(self.unsolvable(cause)) };
        let again = explicit.more_carefully(&mut state, &mut self.work.assembler);
        if again.map_err(|cause| self.unsolvable(cause))? {
            self.state = Arc::new(state);
            if let Phase::Explicit(outputs) | Phase::Rupture { outputs, .. } = &mut self.control.phase {
                outputs.attempt += 1;
            }
            return Ok(());
        }
        self.state = collapsed;
        Err(self.unsolvable(cause.after_all()))
    }

    /// Starts explicit increments within an implicit step, from its state or with the velocities that its static increments
    /// could not follow. Returns the highest slip rate of that motion.
    fn break_out(&mut self) -> f64 {
        let Some((moving, pace)) = self.control.moving.take() else {
            self.report.ruptures += 1;
            return 0.0;
        };
        self.state = moving;
        pace
    }

    /// Enters the phase that a candidate led to, or the next step.
    pub(super) fn enter(&mut self, mut phase: Phase) {
        let implicit = |phase: &Phase| matches!(phase, Phase::Implicit { .. });
        if let (Phase::Implicit { .. }, Phase::Rupture { before, pace, .. }) = (&self.control.phase, &mut phase) {
            *pace = self.break_out();
            *before = self.state.clone();
        }
        if implicit(&phase) || matches!(phase, Phase::Resume { .. }) {
            self.explicit = None;
        }
        let ends = self.state.time >= self.step.span.end || matches!(phase, Phase::Met);
        if self.state.time < self.step.span.end && ends {
            let planned = self.model.steps[self.control.step].span.end;
            self.control.ended.push([planned, self.state.time]);
        }
        self.control.phase = phase;
        if ends && !matches!(self.control.phase, Phase::Missed) {
            self.explicit = None;
            self.quasi_dynamic = None;
            self.step_changed = false;
            self.control.step += 1;
            self.control.phase = Phase::Complete;
            if let Some(step) = self.control.step_of(&self.model) {
                self.step = Arc::new(step);
                self.control.phase = Phase::Begin;
            }
        }
    }
}
