//! Equilibrium of models that differ little from the one of a run, at an increment that the run has solved: the tangent of the run
//! serves all of them.
//!
//! ```text
//! r′(u′) = r(u),   u′ ← u′ − K⁻¹ (r′ − r)              until ‖r′ − r‖ ≤ 1e-12 ‖f‖                               (1)
//! K = ∂r/∂u at the solution u of the run, without presumptions, factorized once for all its neighbours
//! ```
//!
//! r is the residual that the tolerance of the run has left, r′ that of a neighbour by its own equations. Its tangent differs from K by
//! O(ε) if its parameters and its state do, so a correction leaves a fraction O(ε) of the error: one or two are enough.
//!
//! Two neighbours on either side of the run are corrected by what they have apart and what they have in common:
//! ```text
//! u± ← u± ∓ K⁻¹ (r+ − r−)/2 − K⁻¹ ((r+ + r−)/2 − r)                                                            (2)
//! ```
//! The first part is the derivative. Their tangents differ from K by as much in opposite directions, so a correction leaves a fraction O(ε²)
//! of it. The second part is O(ε²) and drops out of the difference: it is corrected only where it is larger than that, or where a contact
//! point has another status in one than in the other.
//!
//! Bodies that θ does not act on, and that have no internal variables, are linear so close to the run: K_b (u′ − u) stands for the change of
//! their forces, with the same tangent for all neighbours.
//!
//! If a contact point has another status than in the run, K may not serve. The neighbours are then solved by Newton's method with their
//! own tangents, r′ = 0.
//!
//! Source: the simplified Newton method, Deuflhard (2011), Newton Methods for Nonlinear Problems, 2.1.2.

use std::sync::Arc;

use rayon::prelude::*;

use super::equilibrium::{equilibrium, multiply};
use super::failure::IncrementFailure;
use super::newton::NewtonFailure;
use super::{Pass, Workspace};
use crate::equations::sums::TrialFailure;
use crate::equations::{Assembler, LinearizedSolids, Trial, regimes};
use crate::linear::system::{Request, System};
use crate::linear::{LinearSolver, Multifrontal};
use crate::model::Model;
use crate::model::state::State;

/// Required ‖r‖/‖f‖ of every part of a neighbour's solution [-]
pub const TOLERANCE: f64 = 1e-12;

/// Largest fraction of ‖r‖/‖f‖ left by a correction for another one with the tangent of the run.
const SLOW: f64 = 0.1;

/// Fraction left by a correction above which another one follows, though the residual is small already: it may be as small as round-off
/// could be, and larger than round-off is.
const SURE: f64 = 2e-5;

/// The same of what two neighbours have in common beyond the residual of the run, of second order, where contact points have the same
/// status in both [-]
const COMMON: f64 = 1e-9;

/// The tangent of a run at a solution, and its factors.
pub struct Tangent {
    assembler: Assembler,
    system: System,
    solver: Multifrontal,
    /// Forces of the bodies there, if neighbours with the same bodies want them
    solids: Option<Arc<LinearizedSolids>>,
    /// Whether the matrix could be factorized
    serves: bool,
}

impl Tangent {
    /// Creates the tangent of a model; [`Self::of`] evaluates it.
    pub fn new(model: &Arc<Model>) -> Self {
        let assembler = Assembler::new(model);
        let system = assembler.system();
        Self { assembler, system, solver: Multifrontal::default(), solids: None, serves: false }
    }

    /// Evaluates and factorizes it at the solution of a pass of the run, in the order of elimination of the run: a resumed one has the same
    /// bits. The forces of the bodies are linearized there on request.
    ///
    /// # Errors
    /// Returns [`IncrementFailure`] if the equations cannot be evaluated there.
    pub fn of(&mut self, trial: Trial, pass: &Pass, linearize: bool) -> Result<(), IncrementFailure> {
        let Self { assembler, system, solver, solids, serves } = self;
        assembler.couple(&pass.coupling);
        let u = &pass.displacement;
        let evaluated = assembler.with_responses(trial, u, Request::Tangent, |assembler, responses| {
            assembler.assemble(trial, u, responses, Request::Tangent, system)
        });
        let linearized = evaluated.and_then(|()| if linearize { assembler.linearized(u) } else { Ok(None) });
        let found = linearized.map_err(|failure| IncrementFailure::Newton(NewtonFailure::Evaluation(failure)))?;
        *solids = found.map(Arc::new);
        *serves = solver.factorize(&system.tangent).is_ok();
        Ok(())
    }

    /// Gives the state of the run at the start of the increment the multipliers from what was found where it was evaluated.
    pub fn multiply(&self, old: &mut State) {
        multiply(self.assembler.model(), &self.assembler.evaluation.contacts, old);
    }
}

/// A neighbour on its way to equilibrium.
pub struct Seeker<'a> {
    /// its model
    pub model: &'a Model,
    /// its increment
    pub trial: Trial<'a>,
    /// its workspace; the equations are evaluated last at the solution
    pub work: &'a mut Workspace,
    /// u [L]
    pub u: Vec<f64>,
    /// whether its bodies are those of the run
    pub has_same_bodies: bool,
}

/// A combination of the residuals of some neighbours, and what corrections have left of it.
struct Part {
    /// Factor of every neighbour
    factors: Vec<f64>,
    /// Whether it is what two neighbours have in common
    is_common: bool,
    /// ‖r‖/‖f‖ at the last evaluation, and before it
    left: f64,
    before: f64,
}

impl Part {
    fn new(factors: Vec<f64>, is_common: bool) -> Self {
        Self { factors, is_common, left: f64::INFINITY, before: f64::INFINITY }
    }

    /// The parts of (2) of two neighbours, or each by itself, (1).
    fn of(count: usize) -> Vec<Self> {
        match count {
            2 => vec![Self::new(vec![1.0, -1.0], false), Self::new(vec![1.0, 1.0], true)],
            _ => {
                let alone = |k: usize| (0..count).map(|other| f64::from(u8::from(other == k))).collect();
                (0..count).map(|k| Self::new(alone(k), false)).collect()
            }
        }
    }

    /// Σ factor (r′ − r)/Σ |factor|
    fn residual(&self, neighbours: &[Seeker], own: &[f64]) -> Vec<f64> {
        let count: f64 = self.factors.iter().map(|factor| factor.abs()).sum();
        let mut sum = vec![0.0; own.len()];
        for (factor, neighbour) in self.factors.iter().zip(neighbours).filter(|(factor, _)| **factor != 0.0) {
            let residuals = neighbour.work.system.residual.iter().zip(own);
            sum.iter_mut().zip(residuals).for_each(|(sum, (residual, own))| *sum += factor / count * (residual - own));
        }
        sum
    }

    /// Whether nothing is left of it. What has not been corrected yet may be less than its error so far, and grow from increment to
    /// increment; what neighbours have in common drops out of their difference.
    fn is_solved(&self, tolerance: f64) -> bool {
        let is_sure = self.before.is_finite() && (self.left <= SURE * self.before || self.before <= TOLERANCE);
        self.left == 0.0 || self.left <= tolerance && (is_sure || tolerance == COMMON)
    }

    fn falls(&self, tolerance: f64) -> bool {
        self.left <= tolerance || self.left <= SLOW * self.before
    }
}

impl Seeker<'_> {
    fn evaluate(&mut self, solids: Option<&Arc<LinearizedSolids>>) -> Result<(), TrialFailure> {
        let Workspace { assembler, system, .. } = &mut *self.work;
        let solids = solids.filter(|_| self.has_same_bodies).cloned();
        assembler.residual_beside(self.trial, &self.u, solids, system)
    }

    /// Largest ‖r‖/‖f‖ of a residual, by the forces of this neighbour.
    fn share_of(&self, residual: &[f64]) -> f64 {
        self.work.assembler.imbalance(self.trial, &self.u, residual)
    }
}

/// Neighbours whose difference is a derivative, on their way.
struct Group<'a> {
    neighbours: Vec<Seeker<'a>>,
    parts: Vec<Part>,
    course: Course,
}

/// How far a group has come.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Course {
    OnItsWay,
    Solved,
    /// The tangent of the run does not serve it
    Apart,
}

/// A correction of the neighbours of a group.
struct Correction {
    /// Factor of every neighbour
    factors: Vec<f64>,
    /// The combination of their residuals, negative, and then K⁻¹ times that
    way: Vec<f64>,
}

impl<'a> Group<'a> {
    fn new(neighbours: Vec<Seeker<'a>>) -> Self {
        Self { parts: Part::of(neighbours.len()), neighbours, course: Course::OnItsWay }
    }

    /// Evaluates the neighbours, and returns what is to be corrected, beside the residual of the run.
    fn corrections(&mut self, own: &[f64], solids: Option<&Arc<LinearizedSolids>>) -> Vec<Correction> {
        if self.course != Course::OnItsWay {
            return Vec::new();
        }
        let Self { neighbours, parts, course } = self;
        if !neighbours.iter_mut().all(|neighbour| neighbour.evaluate(solids).is_ok()) {
            *course = Course::Apart;
            return Vec::new();
        }
        let are_alike = have_same_status(neighbours);
        let (mut corrections, mut fall) = (Vec::new(), true);
        for part in parts {
            let mut residual = part.residual(neighbours, own);
            let first = part.factors.iter().position(|factor| *factor != 0.0).unwrap_or_default();
            (part.before, part.left) = (part.left, neighbours[first].share_of(&residual));
            let tolerance = if part.is_common && are_alike { COMMON } else { TOLERANCE };
            fall &= part.falls(tolerance);
            if !part.is_solved(tolerance) {
                residual.iter_mut().for_each(|r| *r = -*r);
                corrections.push(Correction { factors: part.factors.clone(), way: residual });
            }
        }
        if corrections.is_empty() {
            *course = Course::Solved;
        } else if !fall {
            *course = Course::Apart;
            corrections.clear();
        }
        corrections
    }

    fn correct(&mut self, corrections: Vec<Correction>) {
        for Correction { factors, way } in corrections {
            for (neighbour, factor) in self.neighbours.iter_mut().zip(factors).filter(|(_, factor)| *factor != 0.0) {
                neighbour.u.iter_mut().zip(&way).for_each(|(u, way)| *u += factor * way);
            }
        }
    }

    /// The solution of every neighbour; those that have none yet are solved by themselves.
    fn end(self) -> Result<Vec<Vec<f64>>, IncrementFailure> {
        let Self { neighbours, course, .. } = self;
        match course {
            Course::Solved => Ok(neighbours.into_iter().map(|neighbour| neighbour.u).collect()),
            _ => neighbours.into_iter().map(by_itself).collect(),
        }
    }
}

/// Equilibrium of groups of neighbours, each group for one derivative, beside the run whose tangent is given; or why a group has none near
/// the run. Groups are evaluated in parallel, and corrected together: the factors are read once for all of them.
pub fn beside(groups: Vec<Vec<Seeker>>, tangent: &mut Tangent) -> Vec<Result<Vec<Vec<f64>>, IncrementFailure>> {
    let Tangent { system, solver, solids, serves, .. } = tangent;
    let (own, solids) = (&system.residual, solids.as_ref());
    let mut groups: Vec<Group> = groups.into_iter().map(Group::new).collect();
    loop {
        let of = |group: &mut Group| if *serves { group.corrections(own, solids) } else { Vec::new() };
        let mut corrections: Vec<Vec<Correction>> = groups.par_iter_mut().with_max_len(1).map(of).collect();
        let mut columns: Vec<&mut [f64]> = corrections.iter_mut().flatten().map(|one| &mut one.way[..]).collect();
        if columns.is_empty() {
            break;
        }
        solver.solve_all(&mut columns);
        groups.par_iter_mut().zip(corrections).for_each(|(group, own)| group.correct(own));
    }
    groups.into_par_iter().with_max_len(1).map(Group::end).collect()
}

/// Whether every contact point has the same status in all of them.
fn have_same_status(neighbours: &[Seeker]) -> bool {
    let mut all = neighbours.iter().map(|neighbour| regimes(&neighbour.model.contacts, neighbour.work.contacts()));
    let first = all.next();
    all.all(|other| Some(other) == first)
}

/// Equilibrium of a neighbour by Newton's method.
fn by_itself(Seeker { model, trial, work, mut u, .. }: Seeker) -> Result<Vec<f64>, IncrementFailure> {
    if !u.iter().all(|u| u.is_finite()) {
        u.clone_from(&trial.old.displacement);
    }
    work.iteration.start_increment();
    equilibrium(model, trial, Some(u), work).1
}
