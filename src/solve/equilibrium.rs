//! Equilibrium at the time of a trial, starting from a start value.
//!
//! # Start value
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
//!
//! # Softer penalties first
//!
//! With a stiff penalty the closed points of slender bodies are hard to find: bending is so much softer than the contact
//! that every linear solve closes and opens other points after closure, however short the increment. With a soft penalty few
//! iterations suffice, and their result is a good initial guess for a stiffer one. A static increment without equilibrium is
//! restarted, provided that friction does not weaken, with
//!
//! ```text
//! α_n × 1e-8, 1e-6, 1e-4, 1e-2, 1                     each equilibrium is the start value of the next
//! ```
//!
//! where the solutions with softer penalties are found to a hundredth of the forces only. Switch `softening`; `aid_softening`
//! is 1 in their iterations.
//!
//! Source: path following in the penalty, Hintermüller & Kunisch (2006), Path-following methods for a class of constrained
//! minimization problems in function space, SIAM J. Optim. 17, 159.
//!
//! # Augmented Lagrangian
//!
//! The augmented Lagrangian: multipliers that leave no more penetration than allowed, nor more elastic slip.

use super::condensed_newton::{CondensedNewton, Round, Rung};
use super::contact_iteration::{Acted, Flips};
use super::failure::IncrementFailure;
use super::floating::null_motion;
use super::newton::{self, NewtonFailure};
use super::{IterationRecord, Pass, Solved, Workspace};
use crate::contact::force::ContactState;
use crate::equations::sums::TrialFailure;
use crate::equations::supports;
use crate::equations::{Assembler, Trial};
use crate::linear::system::Request;
use crate::linear::{LinearFailure, SparseMatrix};
use crate::model::Model;
use crate::model::scheme::Scheme;
use crate::model::state::{LastIncrement, State};

/// Finds the equilibrium at the time required by the scheme, from the start value of a new increment unless another is
/// given.
pub fn equilibrium(model: &Model, trial: Trial, start: Option<Vec<f64>>, work: &mut Workspace) -> Solved {
    let begins = start.is_none();
    let spent = work.assembler.seconds.assembly + work.assembler.seconds.contact;
    let clock = std::time::Instant::now();
    let (start, extrapolated) = start.map_or_else(|| start_value(model, trial), |start| (start, false));
    let mut watch = Watch::new(begins, extrapolated);
    if begins && !model.aids.start {
        watch.foresee(model, trial, work);
    }
    let condensed = on_contacts(model, trial, &start, &mut watch, work);
    let result = condensed.unwrap_or_else(|| on_all(model, trial, start, &mut watch, work));
    let assembled = work.assembler.seconds.assembly + work.assembler.seconds.contact - spent;
    work.linear_seconds += clock.elapsed().as_secs_f64() - assembled;
    let displacement = explained(model, trial, watch.floating.take(), result, &work.system.tangent);
    Solved { iterations: watch.records, displacement, foreseen: watch.foreseen, passes: Vec::new() }
}

/// Solves by Newton's method on all equations.
fn on_all(
    model: &Model,
    trial: Trial,
    start: Vec<f64>,
    watch: &mut Watch,
    work: &mut Workspace,
) -> Result<Vec<f64>, NewtonFailure<TrialFailure>> {
    let Workspace { assembler, iteration, solver, system, .. } = work;
    if watch.begins {
        iteration.start_increment();
    }
    let (iterations, result) = newton::solve(
        start,
        settings(model, trial),
        &mut **solver,
        system,
        |u, request, system| {
            iteration.evaluate_all(assembler, trial, u, request, system)?;
            if request == Request::Tangent && watch.begins && watch.tangents == 0 && is_unaided(trial) {
                watch.floating = null_motion(model, trial.step, u, &system.tangent);
            }
            watch.note(request, assembler, system.forces, in_trial(trial, iteration.acted));
            Ok(())
        },
        |u, residual, way| supports::work(model, trial.step, u, residual, way),
    );
    watch.record(iterations);
    result
}

/// Maximum number of rounds on the contact nodes before an increment is solved on all equations.
const MOST_ROUNDS: usize = 3;

/// Solves by Newton's method condensed on the contact nodes, if that pays and the bodies allow it.
fn on_contacts(
    model: &Model,
    trial: Trial,
    start: &[f64],
    watch: &mut Watch,
    work: &mut Workspace,
) -> Option<Result<Vec<f64>, NewtonFailure<TrialFailure>>> {
    let rung = work.interface.as_mut()?.bodies(model, trial).ok()??;
    let mut u = start.to_vec();
    if watch.begins && is_unaided(trial) {
        assemble_all(trial, &u, work)?;
        watch.floating = null_motion(model, trial.step, &u, &work.system.tangent);
    }
    if watch.begins {
        work.iteration.start_increment();
    }
    for _ in 0..MOST_ROUNDS {
        if let Err(failure) = round(model, trial, &rung, &mut u, watch, work)? {
            return Some(Err(failure));
        }
        let Workspace { assembler, system, .. } = work;
        assembler.residual(trial, &u, system).ok()?;
        if let Some(last) = watch.records.last_mut() {
            last.newton.residual = system.imbalance;
        }
        if system.imbalance <= tolerance(model, trial) {
            return Some(Ok(u));
        }
    }
    None
}

/// Solves the condensed equations from the displacement `u`, and updates the bodies; `None` if they cannot be set up.
fn round(
    model: &Model,
    trial: Trial,
    rung: &Rung,
    u: &mut [f64],
    watch: &mut Watch,
    work: &mut Workspace,
) -> Option<Result<(), NewtonFailure<TrialFailure>>> {
    let Workspace { assembler, iteration, system, interface, .. } = work;
    let CondensedNewton { nodes, solver, condensed, .. } = interface.as_mut()?;
    let mut round = Round::begin(nodes, &rung.bodies, trial, u, assembler, system).ok()?;
    let mut all = u.to_vec();
    let (iterations, result) = newton::solve(
        nodes.gather(u),
        settings(model, trial),
        &mut solver.with(rung.eliminated.as_ref(), rung.parts.as_deref()),
        condensed,
        |x, request, system| {
            nodes.scatter(x, &mut all);
            iteration.evaluate(assembler, trial, &all, request, |assembler, responses| {
                round.equations.assemble(assembler, trial, x, responses, request, system);
                Ok(())
            })?;
            let acted = Acted { condense: 1, ..in_trial(trial, iteration.acted) };
            watch.note(request, assembler, system.forces, acted);
            Ok::<(), TrialFailure>(())
        },
        |_, residual, way| supports::dot(residual, way),
    );
    watch.record(iterations);
    match result {
        Ok(x) => round.follow(nodes, u, &x),
        Err(NewtonFailure::Linear(LinearFailure::Varies)) => return None,
        Err(failure) => {
            // Unconstrained rigid-body modes are detected from the full tangent.
            assemble_all(trial, &all, work)?;
            return Some(Err(failure));
        }
    }
    Some(Ok(()))
}

/// Assembles the tangent of all equations at the first linear solve of an increment.
fn assemble_all(trial: Trial, u: &[f64], work: &mut Workspace) -> Option<()> {
    let Workspace { assembler, iteration, system, .. } = work;
    iteration.start_increment();
    assembler.residual(trial, u, system).ok()?;
    iteration.evaluate_all(assembler, trial, u, Request::Tangent, system).ok()
}

/// Monitor of the solution of an increment.
struct Watch {
    /// Whether it is a new increment, and whether its start value extrapolates the last one
    begins: bool,
    extrapolated: bool,
    tangents: usize,
    /// Record after each correction of the present solution, without the correction itself
    seen: Vec<IterationRecord>,
    flips: Flips,
    floating: Option<String>,
    /// Contact states if the motion before the increment had gone on
    foreseen: Option<Vec<Vec<ContactState>>>,
    /// Aids that acted in the tangent since the last correction
    acted: Acted,
    records: Vec<IterationRecord>,
}

impl Watch {
    fn new(begins: bool, extrapolated: bool) -> Self {
        let (flips, acted) = (Flips::default(), Acted::default());
        let (floating, foreseen, seen, records) = (None, None, Vec::new(), Vec::new());
        Self { begins, extrapolated, tangents: 0, seen, flips, floating, foreseen, acted, records }
    }

    /// Evaluates what is foreseen at the extrapolated motion, from which the iterations do not start.
    fn foresee(&mut self, model: &Model, trial: Trial, work: &mut Workspace) {
        let Some(u) = extrapolated(model, trial) else { return };
        let Workspace { assembler, system, .. } = work;
        self.foreseen = assembler.residual(trial, &u, system).ok().map(|()| assembler.evaluation.contacts.clone());
    }

    /// Records the state of the equations after their evaluation.
    fn note(&mut self, request: Request, assembler: &Assembler, forces: f64, acted: Acted) {
        // The start value extrapolates the last increment; where there is none, the first linear solve predicts the motion.
        let foresight = if self.extrapolated { 0 } else { 1 };
        let predicts = self.begins && self.records.is_empty() && self.tangents == foresight;
        if predicts && request == Request::Residual && self.foreseen.is_none() {
            self.foreseen = Some(assembler.evaluation.contacts.clone());
        }
        if request == Request::Tangent {
            self.acted = acted;
            self.acted.start = usize::from(self.extrapolated && self.records.is_empty() && self.tangents == 0);
            self.tangents += 1;
        } else if self.tangents > 0 && request == Request::Residual {
            let evaluation = &assembler.evaluation;
            self.seen.push(IterationRecord {
                contacts: assembler.contact_counts(),
                flips: self.flips.count(&evaluation.contacts),
                stabilization: evaluation.stabilization / forces.max(f64::MIN_POSITIVE),
                acted: std::mem::take(&mut self.acted),
                ..IterationRecord::default()
            });
        }
    }

    /// Stores the iterations of a solution with the record after each.
    fn record(&mut self, iterations: Vec<newton::Iteration>) {
        let mut seen = std::mem::take(&mut self.seen);
        self.tangents = 0;
        // The last state may not have been evaluated.
        seen.resize(iterations.len(), IterationRecord::default());
        let record = |(newton, seen): (newton::Iteration, IterationRecord)| {
            let acted = Acted { downhill: usize::from(newton.searched), ..seen.acted };
            IterationRecord { newton, pass: 1, acted, ..seen }
        };
        self.records.extend(iterations.into_iter().zip(seen).map(record));
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

/// Required ‖r‖/‖f‖ of every part of a solution, or of an initial guess [-]
fn tolerance(model: &Model, trial: Trial) -> f64 {
    if trial.stiffening < 1.0 { model.newton.tolerance.max(ROUGHLY) } else { model.newton.tolerance }
}

fn settings(model: &Model, trial: Trial) -> newton::Settings {
    newton::Settings {
        tolerance: tolerance(model, trial),
        max_iterations: model.newton.max_iterations,
        old_tangents: model.aids.old_tangents,
        downhill: model.aids.downhill,
        saddle: model.saddle(),
        gives_up: trial.step.scheme.is_dynamic() && trial.step.shorter(trial.dt, 1).is_some(),
    }
}

/// Whether a step begins, or its stabilization has just ended.
fn is_unaided(trial: Trial) -> bool {
    let Trial { old, step, .. } = trial;
    old.last_increment.is_none() || (!step.stabilization.is_empty() && trial.stabilization_left() == 0.0)
}

/// Aids that acted on contact points, with the modified penalties of the trial.
fn in_trial(trial: Trial, acted: Acted) -> Acted {
    let stiffening = usize::from(trial.stiffening > 1.0);
    Acted { stiffening, softening: usize::from(trial.stiffening < 1.0), ..acted }
}

/// Start value of an increment, and whether it differs from the committed displacement.
pub fn start_value(model: &Model, trial: Trial) -> (Vec<f64>, bool) {
    let ahead = if model.aids.start { extrapolated(model, trial) } else { None };
    ahead.map_or_else(|| (trial.old.displacement.clone(), false), |ahead| (ahead, true))
}

/// Displacement if the motion goes on; `None` if there was none, or it has met a contact.
fn extrapolated(model: &Model, trial: Trial) -> Option<Vec<f64>> {
    let Trial { old, step, dt, .. } = trial;
    let State { displacement, velocity, acceleration, .. } = old;
    let last = goes_on(old);
    if !(step.scheme.is_dynamic() && step.increments.error.is_some()) {
        let last = last?;
        let share = dt / last.dt;
        return Some(displacement.iter().zip(&last.displacement).map(|(u, du)| u + share * du).collect());
    }
    let way = |dof: usize| match last {
        _ if !model.massless[dof / 2] => dt * (velocity[dof] + 0.5 * dt * acceleration[dof]),
        Some(last) => dt / last.dt * last.displacement[dof],
        None => 0.0,
    };
    Some((0..displacement.len()).map(|dof| displacement[dof] + way(dof)).collect())
}

/// Last increment of the step, if the next one is expected to be similar.
fn goes_on(old: &State) -> Option<&LastIncrement> {
    old.last_increment.as_ref().filter(|last| !last.ends_in_touch)
}

/// Factors on α_n for successive initial guesses.
const SOFTER: [f64; 4] = [1e-8, 1e-6, 1e-4, 1e-2];

/// ‖r‖/‖f‖ required of an initial guess [-]
const ROUGHLY: f64 = 1e-2;

/// Whether equilibrium does not depend on the initial guess, as far as the friction laws are concerned: with weakening there
/// may be several, of which the nearest is sought.
fn has_one_answer(model: &Model) -> bool {
    let mut laws = model.contacts.iter().flat_map(|pair| &pair.laws).peekable();
    laws.peek().is_some() && laws.all(|law| law.description.weakening == 0.0)
}

/// Equilibrium of a new increment; a static one that has none from its own start value is restarted with softer penalties.
fn from_start_values(model: &Model, trial: Trial, work: &mut Workspace) -> Solved {
    let mut solved = equilibrium(model, trial, None, work);
    let unsolved = match &solved.displacement {
        Err(IncrementFailure::Newton(failure)) => failure.is_without_end(),
        _ => false,
    };
    if !(model.aids.softening && unsolved && trial.step.scheme == Scheme::Static && has_one_answer(model)) {
        return solved;
    }
    let (mut start, _) = start_value(model, trial);
    work.iteration.start_increment();
    for stiffening in SOFTER {
        let softer = equilibrium(model, Trial { stiffening, ..trial }, Some(start), work);
        solved.iterations.extend(softer.iterations);
        let Ok(found) = softer.displacement else { return solved };
        start = found;
    }
    let last = equilibrium(model, trial, Some(start), work);
    solved.iterations.extend(last.iterations);
    Solved { displacement: last.displacement, ..solved }
}

/// Maximum number of augmentations before an increment of the augmented Lagrangian method is rejected.
const MOST_PASSES: usize = 100;

/// Remaining fraction of the penetration above which an augmentation is slow and the penalty is raised.
const SLOW: f64 = 0.25;

/// Factor by which the penalty is raised.
const STIFFER: f64 = 10.0;

/// Upper bound of the factor on the given α_n.
const STIFFEST: f64 = 1e4;

/// Equilibrium at the time of a trial; where a contact asks for the augmented Lagrangian, with multipliers that leave no
/// more penetration, and no more elastic slip, than allowed: Uzawa's method. α_n is raised for the increment while passes gain little:
/// without that a soft penalty takes passes by the dozen, each of which leaves nearly all of the penetration (switch `stiffening`;
/// `aid_stiffening` is 1 in iterations of a raised one). The iterations begin at the start value of a new increment unless another is given.
///
/// Source of the rule and its factors: Bertsekas (1982), Constrained Optimization and Lagrange Multiplier Methods, 2.2.
pub fn augment(model: &Model, trial: Trial, start: Option<Vec<f64>>, work: &mut Workspace) -> Solved {
    let mut solved = match start {
        None => from_start_values(model, trial, work),
        start => equilibrium(model, trial, start, work),
    };
    let (mut stiffening, mut before) = (1.0, f64::INFINITY);
    let mut begun: Option<State> = None;
    for pass in 1.. {
        let Ok(u) = &solved.displacement else { break };
        let coupling = work.assembler.coupling();
        solved.passes.push(Pass { displacement: u.clone(), stiffening, coupling });
        let found = &work.assembler.evaluation.contacts;
        let excess = model.contacts.iter().zip(found).map(|(pair, found)| pair.excess(found));
        let [penetration, slip] = excess.fold([0.0f64; 2], |[a, b], [c, d]| [a.max(c), b.max(d)]);
        if penetration.max(slip) <= 1.0 {
            break;
        }
        if pass == MOST_PASSES {
            solved.displacement = Err(match penetration > 1.0 {
                true => IncrementFailure::Penetration { passes: pass },
                false => IncrementFailure::ElasticSlip { passes: pass },
            });
            break;
        }
        if model.aids.stiffening && penetration > 1.0 && penetration > SLOW * before {
            stiffening = (STIFFER * stiffening).min(STIFFEST);
        }
        before = penetration;
        let old = begun.get_or_insert_with(|| trial.old.clone());
        multiply(model, found, old);
        let again = equilibrium(model, Trial { old, stiffening, ..trial }, Some(u.clone()), work);
        let more = again.iterations.into_iter().map(|iteration| IterationRecord { pass: pass + 1, ..iteration });
        solved.iterations.extend(more);
        solved.displacement = again.displacement;
    }
    if let (Ok(u), Some(last)) = (&solved.displacement, solved.iterations.last_mut()) {
        let (old, newton) = (begun.as_ref().unwrap_or(trial.old), &mut last.newton);
        newton.least_negative = count_negative(Trial { old, stiffening, ..trial }, u, newton.least_negative, work);
    }
    solved
}

/// Least number of negative eigenvalues of the tangent at a static equilibrium. The last tangent of the iterations, whose number is
/// given, is that of a state before it, and may contain presumptions about contact points. Where it has none, nor is the equilibrium
/// supposed to have any; elsewhere its own tangent is factorized.
fn count_negative(trial: Trial, u: &[f64], last: Option<usize>, work: &mut Workspace) -> Option<usize> {
    if trial.step.scheme.is_dynamic() || last.is_none_or(|negative| negative == 0) {
        return last;
    }
    let Workspace { assembler, solver, system, .. } = work;
    let coupling = assembler.coupling();
    let evaluated = assembler.tangent(trial, u, false, system);
    let factorized = evaluated.is_ok() && solver.factorize(&system.tangent).is_ok();
    let saddle = assembler.model().saddle();
    let (all, least) = (solver.negative_pivots(), solver.least_negative());
    let counted = if factorized { newton::beyond(saddle, all, least) } else { None };
    // What is accepted, and the order of elimination of what follows, are as if nothing had been counted.
    assembler.couple(&coupling);
    assembler.residual(trial, u, system).ok().and(counted)
}

/// Gives the state at the start of an increment the multipliers from what a pass has `found`.
pub fn multiply(model: &Model, found: &[Vec<ContactState>], old: &mut State) {
    let pairs = model.contacts.iter().zip(found);
    pairs.zip(&mut old.contacts).for_each(|((pair, found), old)| *old = pair.multiplied(old, found));
}
