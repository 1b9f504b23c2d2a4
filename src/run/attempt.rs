//! One attempt: the next implicit increment, or explicit ones up to the next output.

use std::sync::Arc;

use super::control::{Candidate, Outcome, Outputs, Phase, RESULTS};
use super::error::Error;
use super::simulation::Simulation;
use crate::model::Step;
use crate::model::state::State;
use crate::solve::IterationRecord;
use crate::solve::failure::IncrementFailure;
use crate::time::increment::advance;
use crate::time::ladder::on_ladder;
use crate::time::step_size::{Judgement, bounded, fastest_slip, judge};
use crate::time::touching::Touching;

/// Cut of the increment after one that could not be solved.
const CUT: f64 = 0.5;

impl Simulation {
    /// An implicit or static increment.
    pub(super) fn implicit(&mut self, dt: f64, number: usize, mut touching: Touching) -> Candidate {
        let Self { model, step, state: old, work, .. } = self;
        let dt = bounded(step, old.time, dt);
        let (iterations, solved) = advance(model, step, old, dt, work);
        let (mut local_error, mut doubt, mut accepted) = (None, None, None);
        let again = |dt: f64, touching| Phase::Implicit { dt, attempt: number + 1, touching };
        let shortest = CUT * dt < step.increments.min;
        let outcome = match solved {
            Ok(mut new) => {
                let mut judgement = judge(model, step, [old, &new], hardest_pass(&iterations), number > 1);
                if judgement.accepted && !step.scheme.is_dynamic() {
                    let judged = touching.judge(model, step, old, &mut new, &work.foreseen, judgement);
                    (judgement, doubt) = (judged.0, Some(judged.1));
                } else {
                    touching.give_up();
                }
                local_error = judgement.error;
                judgement.next = on_ladder(step, judgement.next, work);
                let ruptures = step.rupture.as_ref().is_some_and(|r| fastest_slip(model, old, &new) > r.slip_rate);
                match judgement {
                    _ if ruptures && shortest => Outcome::Rejected(self.rupture()),
                    _ if ruptures => Outcome::Rejected(again(CUT * dt, Touching::default())),
                    Judgement { accepted: true, next, .. } => {
                        accepted = Some(Arc::new(new));
                        Outcome::Accepted(Phase::Implicit { dt: next, attempt: 1, touching })
                    }
                    Judgement { next, .. } => Outcome::Rejected(again(next, touching)),
                }
            }
            Err(cause) => self.unsolved(cause, dt, number, touching),
        };
        let increments = usize::from(accepted.is_some());
        let coupling = self.work.assembler.coupling();
        Candidate {
            number,
            dt,
            iterations,
            accepted,
            local_error,
            doubt,
            increments,
            outcome,
            coupling,
            explicit: None,
        }
    }

    /// What becomes of an increment that could not be solved.
    fn unsolved(&self, cause: IncrementFailure, dt: f64, number: usize, mut touching: Touching) -> Outcome {
        let Step { name, increments, rupture, .. } = &*self.step;
        if !cause.is_retryable() {
            return Outcome::Stopped(self.unsolvable(cause));
        }
        if CUT * dt >= increments.min {
            touching.cut();
            return Outcome::Cut(Phase::Implicit { dt: CUT * dt, attempt: number + 1, touching });
        }
        if rupture.is_some() {
            return Outcome::Cut(self.rupture());
        }
        let (step, time, min) = (name.clone(), self.state.time, increments.min);
        Outcome::Stopped(Error::IncrementTooSmall { step, time, dt, min, cause })
    }

    /// Where explicit increments begin within an implicit step.
    fn rupture(&self) -> Phase {
        let calm = self.step.rupture.as_ref().map_or(f64::INFINITY, |rupture| rupture.calm);
        let interval = self.model.interval.unwrap_or(f64::INFINITY).min(calm / RESULTS);
        Phase::Rupture { outputs: Outputs::new(self.state.time, interval), before: self.state.clone() }
    }

    /// Explicit increments to the next output; `before` is the state since which slip is watched, in a rupture.
    pub(super) fn explicit(&mut self, outputs: Outputs, before: Option<Arc<State>>) -> Candidate {
        let time = outputs.time(self.step.span);
        let (mut state, mut explicit) = (State::clone(&self.state), self.explicit.clone());
        let gone = explicit.as_mut().map_or(Ok(0), |one| one.go_to(time, &mut state, &mut self.work.assembler));
        let state = Arc::new(state);
        let increments = *gone.as_ref().unwrap_or(&0);
        let accepted = gone.is_ok().then(|| state.clone());
        let outcome = match gone {
            Ok(_) => Outcome::Accepted(self.after_output(outputs.following(), before, &state)),
            Err(cause) if cause.is_collapse() => Outcome::Collapsed(state, cause),
            Err(cause) => Outcome::Stopped(self.unsolvable(cause)),
        };
        Candidate {
            number: outputs.attempt,
            dt: time - self.state.time,
            iterations: Vec::new(),
            accepted,
            local_error: None,
            doubt: None,
            increments,
            outcome,
            coupling: self.work.assembler.coupling(),
            explicit,
        }
    }

    /// A rupture is over when no point has slipped fast over the time of calm.
    fn after_output(&self, outputs: Outputs, before: Option<Arc<State>>, state: &Arc<State>) -> Phase {
        let (Some(before), Some(rupture)) = (before, &self.step.rupture) else { return Phase::Explicit(outputs) };
        if state.time - before.time < rupture.calm {
            return Phase::Rupture { outputs, before };
        }
        match fastest_slip(&self.model, &before, state) <= rupture.slip_rate {
            true => Phase::Resume,
            false => Phase::Rupture { outputs, before: state.clone() },
        }
    }
}

/// Tangents of the pass that took most: the augmented Lagrangian solves an increment several times.
fn hardest_pass(iterations: &[IterationRecord]) -> usize {
    let tangents = |pass: &[IterationRecord]| pass.iter().filter(|iteration| iteration.newton.factorized).count();
    iterations.chunk_by(|a, b| a.pass == b.pass).map(tangents).max().unwrap_or(0)
}
