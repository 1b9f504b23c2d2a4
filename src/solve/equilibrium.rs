//! Equilibrium at the time of a trial, starting from a start value.
//!
//! The iterations of an increment start at
//!
//! ```text
//! u = u₀ + Δt/Δt₀ Δu₀                                 the last increment of the step goes on at its pace
//! u = u₀ + Δt v₀ + ½ Δt² a₀                           in dynamics under error control
//! ```
//!
//! Otherwise every increment would start at u₀, and the points that have to slip, open or close would be found again each time.
//! If the last increment ended at a contact closure, the next one differs from it. In dynamics the second start value differs
//! from any accepted increment under error control by little more than the allowed error; where increments do not resolve the
//! motion it would be far off. Nodes whose mass was moved away have meaningless accelerations: they keep their velocity. Switch
//! `start`; `aid_start` is 1 in an iteration that starts there.
//!
//! Source: the predictor of Newmark (1959) in dynamics; in statics the secant predictor of path following.

use super::conduits::Arrived;
use super::contact_iteration::ContactIteration;
use super::failure::IncrementFailure;
use super::floating::null_motion;
use super::newton::{self, Equations, NewtonFailure};
use super::watch::Watch;
use super::{IterationRecord, Workspace, condensed_newton};
use crate::contact::force::ContactState;
use crate::equations::supports;
use crate::equations::{Assembler, Evaluation, Trial, TrialFailure};
use crate::linear::SparseMatrix;
use crate::linear::system::{Request, System};
use crate::model::Model;
use crate::model::state::{LastIncrement, State};

/// What the search for an equilibrium came to.
pub struct Solved {
    /// Linear solves, of a failed attempt as well
    pub iterations: Vec<IterationRecord>,
    /// The equilibrium
    pub found: Result<Found, IncrementFailure>,
    /// Contact states if the motion before the increment had gone on; `None` if none could be evaluated
    pub foreseen: Option<Vec<Vec<ContactState>>>,
}

/// An equilibrium, and everything that was evaluated there.
pub struct Found {
    /// u at the time at which the scheme requires equilibrium [L]
    pub displacement: Vec<f64>,
    /// forces, contacts, internal variables
    pub evaluation: Evaluation,
    /// water that flows along contacts, none before it agrees with the equilibrium
    pub water: Arrived,
}

/// Finds the equilibrium at the time required by the scheme, from the start value of a new increment unless another is
/// given.
pub fn equilibrium(model: &Model, trial: Trial, start: Option<Vec<f64>>, work: &mut Workspace) -> Solved {
    let begins = start.is_none();
    let spent = work.assembler.seconds.assembly + work.assembler.seconds.contact;
    let clock = std::time::Instant::now();
    let (start, extrapolated) = start.map_or_else(|| start_value(model, trial), |start| (start, false));
    let mut watch = Watch::new(model, trial, begins, extrapolated);
    if begins && !model.aids.start {
        watch.foreseen = foreseen(model, trial, work);
    }
    let result = match condensed_newton::solve(model, trial, &start, &mut watch, work) {
        Some(result) => result,
        None => {
            let Workspace { assembler, iteration, solver, system, .. } = work;
            if begins {
                iteration.start_increment();
            }
            let (mut iterations, settings) = (Vec::new(), watch.settings);
            let mut all = AllEquations { assembler, iteration, trial, watch: &mut watch };
            let result = newton::solve(&mut all, start, settings, &mut **solver, system, &mut iterations);
            watch.record(iterations);
            result
        }
    };
    let assembled = work.assembler.seconds.assembly + work.assembler.seconds.contact - spent;
    work.linear_seconds += clock.elapsed().as_secs_f64() - assembled;
    let displacement = explained(model, trial, watch.floating.take(), result, &work.system.tangent);
    let found = displacement.map(|displacement| Found {
        displacement,
        evaluation: std::mem::take(&mut work.assembler.evaluation),
        water: Arrived::new(),
    });
    Solved { iterations: watch.records, found, foreseen: watch.foreseen }
}

/// All equations of an increment.
struct AllEquations<'a> {
    assembler: &'a mut Assembler,
    iteration: &'a mut ContactIteration,
    trial: Trial<'a>,
    watch: &'a mut Watch,
}

impl Equations for AllEquations<'_> {
    type Failure = TrialFailure;

    fn evaluate(&mut self, u: &[f64], request: Request, system: &mut System) -> Result<(), TrialFailure> {
        let Self { assembler, iteration, trial, watch } = self;
        let responses = iteration.respond(assembler, *trial, u, request)?;
        assembler.assemble(*trial, u, responses, request, system)?;
        assembler.measure(*trial, u, system);
        if request == Request::Tangent {
            iteration.note(assembler.model(), u, trial.old);
            if watch.seeks_floating && watch.tangents == 0 {
                watch.floating = null_motion(assembler.model(), trial.step, u, &system.tangent);
            }
        }
        watch.note(request, assembler, system.forces, iteration.acted);
        Ok(())
    }

    fn work(&self, u: &[f64], residual: &[f64], way: &[f64]) -> f64 {
        supports::work(self.assembler.model(), self.trial.step, u, residual, way)
    }
}

/// Returns the solution, or the reason why there is none: unconstrained bodies explain more than the equations.
fn explained(
    model: &Model,
    Trial { old, step, .. }: Trial,
    floating: Option<String>,
    result: Result<Vec<f64>, NewtonFailure<TrialFailure>>,
    tangent: &SparseMatrix,
) -> Result<Vec<f64>, IncrementFailure> {
    match (floating, result) {
        (Some(floating), _) if old.last_increment.is_none() => Err(IncrementFailure::Floating(floating)),
        (Some(floating), _) => Err(IncrementFailure::ContactLost(floating)),
        // A trial state may have lost the contact that constrained a body; this is reported, and a smaller increment tried.
        (None, Err(failure)) => {
            let loose = null_motion(model, step, &old.displacement, tangent);
            Err(loose.map_or(failure.into(), IncrementFailure::ContactLost))
        }
        (None, Ok(u)) => Ok(u),
    }
}

/// Contact states at the extrapolated motion, from which the iterations do not start.
fn foreseen(model: &Model, trial: Trial, work: &mut Workspace) -> Option<Vec<Vec<ContactState>>> {
    let u = extrapolated(model, trial)?;
    let Workspace { assembler, system, .. } = work;
    assembler.residual(trial, &u, system).ok().map(|()| assembler.evaluation.contacts.clone())
}

/// Start value of an increment, and whether it differs from the committed displacement.
pub fn start_value(model: &Model, trial: Trial) -> (Vec<f64>, bool) {
    let ahead = if model.aids.start { extrapolated(model, trial) } else { None };
    ahead.map_or_else(|| (trial.old.displacement.clone(), false), |ahead| (ahead, true))
}

/// Displacement if the motion goes on; `None` if there was none, or it has met a contact.
fn extrapolated(model: &Model, trial: Trial) -> Option<Vec<f64>> {
    let Trial { old, step, .. } = trial;
    let (displacement, last) = (&old.displacement, goes_on(old));
    if !(step.scheme.is_dynamic() && step.increments.error.is_some()) {
        let last = last?;
        let share = trial.pace(last, model.flow.is_some())?;
        return Some(displacement.iter().zip(&last.displacement).map(|(u, du)| u + share * du).collect());
    }
    let last = last.and_then(|last| Some((trial.pace(last, false)?, last)));
    let way = |dof: usize| match last {
        _ if !model.massless[dof / 2] => trial.way(dof, true),
        Some((share, last)) => share * last.displacement[dof],
        None => 0.0,
    };
    Some((0..displacement.len()).map(|dof| displacement[dof] + way(dof)).collect())
}

/// Last increment of the step, if the next one is expected to be similar.
fn goes_on(old: &State) -> Option<&LastIncrement> {
    old.last_increment.as_ref().filter(|last| !last.ends_in_touch)
}
