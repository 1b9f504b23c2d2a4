//! Passes of an increment: equilibria that are found one after the other, each from the one before, until nothing asks for another.
//!
//! | asks for another | changes |
//! |---|---|
//! | softer penalties | α_n, where there is no equilibrium from the start value of the increment |
//! | multipliers | those of the augmented Lagrangian, until no more penetration, nor elastic slip, is left than allowed |
//! | water that flows along contacts | its pressures ([`super::conduits`]) |
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
//! Where a contact asks for the augmented Lagrangian, by Uzawa's method. α_n is raised for the increment while passes gain little:
//! without that a soft penalty takes passes by the dozen, each of which leaves nearly all of the penetration (switch `stiffening`;
//! `aid_stiffening` is 1 in iterations of a raised one).
//!
//! Source of the rule and its factors: Bertsekas (1982), Constrained Optimization and Lagrange Multiplier Methods, 2.2.

use super::conduits::Water;
use super::equilibrium::{Found, Solved, start_value};
use super::failure::IncrementFailure;
use super::{IterationRecord, Pass, Workspace};
use crate::contact::force::ContactState;
use crate::equations::Trial;
use crate::model::{Model, Scheme, State};

/// Passes of an increment so far, and what the next one solves.
pub struct Passes<'a> {
    model: &'a Model,
    trial: Trial<'a>,
    softening: Option<Softening>,
    multipliers: Multipliers,
    water: Water<'a>,
    /// Number of equilibria found with the penalties of the increment
    found: usize,
    /// Start value of the next pass; that of a new increment if there is none
    pub start: Option<Vec<f64>>,
    /// Linear solves of all passes, of one that failed as well
    pub iterations: Vec<IterationRecord>,
    /// Contact states if the motion before the increment had gone on
    pub foreseen: Option<Vec<Vec<ContactState>>>,
    /// Solutions under the last pressures of water
    pub solutions: Vec<Pass>,
    /// What they came to
    pub end: Option<Result<Found, IncrementFailure>>,
}

impl<'a> Passes<'a> {
    /// Begins those of an increment.
    pub fn new(model: &'a Model, trial: Trial<'a>) -> Self {
        let (water, end) = match Water::of(model, trial) {
            Ok(water) => (water, None),
            Err(failure) => (Water::default(), Some(Err(failure))),
        };
        Self {
            model,
            trial,
            softening: None,
            multipliers: Multipliers::default(),
            water,
            found: 0,
            start: None,
            iterations: Vec::new(),
            foreseen: None,
            solutions: Vec::new(),
            end,
        }
    }

    /// The increment that the next pass solves.
    pub fn trial(&self) -> Trial<'_> {
        let Multipliers { old, stiffening, .. } = &self.multipliers;
        let old = old.as_ref().or(self.water.old.as_ref()).unwrap_or(self.trial.old);
        let softer = self.softening.as_ref().and_then(|softening| SOFTER.get(softening.number).copied());
        Trial { old, stiffening: softer.unwrap_or(*stiffening), ..self.trial }
    }

    /// Takes the result of a pass: there is another one unless they are at their end.
    pub fn take(&mut self, Solved { iterations, found, foreseen }: Solved, work: &mut Workspace) {
        let pass = self.found + 1;
        self.iterations.extend(iterations.into_iter().map(|iteration| IterationRecord { pass, ..iteration }));
        self.foreseen = self.foreseen.take().or(foreseen);
        self.end = self.judge(found, work).transpose();
    }

    /// The equilibrium of the increment; none before the last pass.
    fn judge(
        &mut self,
        found: Result<Found, IncrementFailure>,
        work: &mut Workspace,
    ) -> Result<Option<Found>, IncrementFailure> {
        let Some(mut found) = self.at_full_penalty(found, work)? else { return Ok(None) };
        let Self { model, trial, multipliers, water, .. } = self;
        self.found += 1;
        let (displacement, coupling) = (found.displacement.clone(), work.assembler.coupling());
        self.solutions.push(Pass { displacement, stiffening: multipliers.stiffening, coupling, water: Vec::new() });
        let old = water.old.as_ref().unwrap_or(trial.old);
        if multipliers.change(model, old, &found.evaluation.contacts)? {
            self.start = Some(found.displacement);
            return Ok(None);
        }
        let last = self.iterations.last().and_then(|last| last.newton.least_negative);
        let counted = count_negative(self.trial(), &found.displacement, last, work);
        if let Some(last) = self.iterations.last_mut() {
            last.newton.least_negative = counted;
        }
        if self.water.flow(self.model, self.trial, &found.evaluation.contacts)? {
            self.multipliers = Multipliers::default();
            self.solutions.clear();
            self.start = Some(found.displacement);
            return Ok(None);
        }
        let histories = self.water.histories(self.model);
        self.solutions.iter_mut().for_each(|pass| pass.water.clone_from(&histories));
        found.water = self.water.arrive(self.model, self.trial)?;
        Ok(Some(found))
    }

    /// The result of a pass with the penalties of the increment. A static increment that has no equilibrium from its own start value is
    /// restarted with softer ones.
    fn at_full_penalty(
        &mut self,
        found: Result<Found, IncrementFailure>,
        work: &mut Workspace,
    ) -> Result<Option<Found>, IncrementFailure> {
        let (model, trial) = (self.model, self.trial);
        match (found, self.softening.take()) {
            (Err(IncrementFailure::Newton(failure)), None)
                if failure.is_without_end()
                    && self.found == 0
                    && model.aids.softening
                    && trial.step.scheme == Scheme::Static
                    && has_one_answer(model) =>
            {
                work.iteration.start_increment();
                self.start = Some(start_value(model, self.trial()).0);
                self.softening = Some(Softening { number: 0, failure: failure.into() });
                Ok(None)
            }
            (Err(_), Some(Softening { number, failure })) if number < SOFTER.len() => Err(failure),
            (Ok(found), Some(Softening { number, failure })) if number < SOFTER.len() => {
                self.start = Some(found.displacement);
                self.softening = Some(Softening { number: number + 1, failure });
                Ok(None)
            }
            (found, _) => found.map(Some),
        }
    }
}

/// Factors on α_n for successive initial guesses.
const SOFTER: [f64; 4] = [1e-8, 1e-6, 1e-4, 1e-2];

/// Passes with softer penalties, after which that of the increment comes.
struct Softening {
    number: usize,
    /// Why there is no equilibrium from the start value
    failure: IncrementFailure,
}

/// Whether equilibrium does not depend on the initial guess, as far as the friction laws are concerned: with weakening there
/// may be several, of which the nearest is sought.
fn has_one_answer(model: &Model) -> bool {
    let mut laws = model.contacts.iter().flat_map(|pair| &pair.laws).peekable();
    laws.peek().is_some() && laws.all(|law| law.description.weakening == 0.0)
}

/// Maximum number of augmentations before an increment of the augmented Lagrangian method is rejected.
const MOST_AUGMENTATIONS: usize = 100;

/// Remaining fraction of the penetration above which an augmentation is slow and the penalty is raised.
const SLOW: f64 = 0.25;

/// Factor by which the penalty is raised.
const STIFFER: f64 = 10.0;

/// Upper bound of the factor on the given α_n.
const STIFFEST: f64 = 1e4;

/// Multipliers of an increment.
struct Multipliers {
    /// The state at its start with those of the last pass
    old: Option<State>,
    /// Factor on α_n
    stiffening: f64,
    passes: usize,
    /// Penetration that the last pass has left, over what is allowed [-]
    left: f64,
}

impl Default for Multipliers {
    fn default() -> Self {
        Self { old: None, stiffening: 1.0, passes: 0, left: f64::INFINITY }
    }
}

impl Multipliers {
    /// Changes those of the state at the start, if more penetration or elastic slip is found than allowed; says whether.
    fn change(&mut self, model: &Model, old: &State, found: &[Vec<ContactState>]) -> Result<bool, IncrementFailure> {
        self.passes += 1;
        let excess = model.contacts.iter().zip(found).map(|(pair, found)| pair.excess(found));
        let [penetration, slip] = excess.fold([0.0f64; 2], |[a, b], [c, d]| [a.max(c), b.max(d)]);
        if penetration.max(slip) <= 1.0 {
            return Ok(false);
        }
        if self.passes == MOST_AUGMENTATIONS {
            return Err(match penetration > 1.0 {
                true => IncrementFailure::Penetration { passes: self.passes },
                false => IncrementFailure::ElasticSlip { passes: self.passes },
            });
        }
        if model.aids.stiffening && penetration > 1.0 && penetration > SLOW * self.left {
            self.stiffening = (STIFFER * self.stiffening).min(STIFFEST);
        }
        self.left = penetration;
        multiply(model, found, self.old.get_or_insert_with(|| old.clone()));
        Ok(true)
    }
}

/// Least number of negative eigenvalues of the tangent at a static equilibrium. The last tangent of the iterations, whose number is
/// given, is that of a state before it, and may contain predictions about contact points. Where it has none, nor is the equilibrium
/// supposed to have any; elsewhere its own tangent is factorized.
fn count_negative(trial: Trial, u: &[f64], last: Option<usize>, work: &mut Workspace) -> Option<usize> {
    if trial.step.scheme.is_dynamic() || last.is_none_or(|negative| negative == 0) {
        return last;
    }
    let Workspace { assembler, solver, system, .. } = work;
    let coupling = assembler.coupling();
    let evaluated = assembler.tangent(trial, u, false, system);
    let factorized = evaluated.is_ok() && solver.factorize(&system.tangent).is_ok();
    let counted = if factorized { solver.least_negative() } else { None };
    // The order of elimination of what follows is as if nothing had been counted.
    assembler.couple(&coupling);
    counted
}

/// Gives the state at the start of an increment the multipliers from what a pass has `found`.
pub fn multiply(model: &Model, found: &[Vec<ContactState>], old: &mut State) {
    let pairs = model.contacts.iter().zip(found);
    pairs.zip(&mut old.contacts).for_each(|((pair, found), old)| *old = pair.multiplied(old, found));
}
