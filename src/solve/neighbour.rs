//! Equilibrium of models that differ little from the one of a run, at an increment that the run has solved: the tangent of the run
//! serves all of them.
//!
//! ```text
//! r′(u′) = r(u),   u′ ← u′ − K⁻¹ (r′ − r)              until ‖r′ − r‖ ≤ 1e-12 ‖f‖                               (1)
//! K = ∂r/∂u at the solution u of the run, without predictions, factorized once for all its neighbours
//! ```
//!
//! r is the residual that the tolerance of the run has left, r′ that of a neighbour by its own equations. Its tangent differs from K by
//! O(ε) if its parameters and its state do, so a correction leaves a fraction O(ε) of the error: one or two are enough.
//!
//! Neighbours with the parameters θ + k ε, k = −1, 1 or 1, 2, are corrected together, by the coefficients of the polynomial in k through their
//! residuals and that of the run, k = 0:
//! ```text
//! r_k − r = a₁ k + a₂ k²,   u_k ← u_k − k K⁻¹ a₁ − k² K⁻¹ a₂                                                     (2)
//! ```
//! The first coefficient is the derivative. Their tangents differ from K in proportion to k, so its correction leaves what is proportional to k²,
//! and only a fraction O(ε²) of a₁ itself. The second one is O(ε²) and drops out of the derivative: it is corrected only where it is larger
//! than that, or where a contact point has another status in one of them than in the run.
//!
//! Bodies that θ does not act on, and that have no internal variables, are linear so close to the run: K_b (u′ − u) stands for the change of
//! their forces, with the same tangent for all neighbours. Bodies that came into the deformed model are without stress at another place in
//! each neighbour: where such places differ, bodies are evaluated.
//!
//! If a contact point has another status than in the run, K may not serve. The neighbours are then solved by Newton's method with their
//! own tangents, r′ = 0.
//!
//! Source: the simplified Newton method, Deuflhard (2011), Newton Methods for Nonlinear Problems, 2.1.2.

use std::sync::Arc;

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::equilibrium::equilibrium;
use super::failure::IncrementFailure;
use super::newton::NewtonFailure;
use super::passes::multiply;
use super::{Pass, Workspace};
use crate::equations::{Assembler, LinearizedSolids, SolidForces, Trial, TrialFailure, regimes};
use crate::laws::friction::Regime;
use crate::linear::system::System;
use crate::linear::{LinearSolver, Multifrontal};
use crate::model::{Model, State};

/// Required ‖r‖/‖f‖ of every part of a neighbour's solution [-]
pub const TOLERANCE: f64 = 1e-12;

/// Largest fraction of ‖r‖/‖f‖ left by a correction for another one with the tangent of the run.
const SLOW: f64 = 0.1;

/// Fraction left by a correction above which another one follows, though the residual is small already: so much a derivative may err in an
/// increment.
const SURE: f64 = 3e-8;

/// ‖r‖/‖f‖ below which another correction would change round-off only [-]
const ROUND_OFF: f64 = 0.02 * TOLERANCE;

/// Allowed ‖r‖/‖f‖ of the coefficient that drops out of the derivative, where contact points have the same status as in the run [-]
const CURVATURE: f64 = 1e-10;

/// The tangent of a run at a solution, and its factors.
pub struct Tangent {
    assembler: Assembler,
    system: System,
    solver: Multifrontal,
    /// Forces of the bodies there, if neighbours with the same bodies want them
    solids: Option<LinearizedSolids>,
    /// Forces by which residuals there are measured [F]
    measures: Vec<f64>,
    /// Whether the matrix could be factorized
    serves: bool,
}

impl Tangent {
    /// Creates the tangent of a model; [`Self::of`] evaluates it.
    pub fn new(model: &Arc<Model>) -> Self {
        let assembler = Assembler::new(model);
        let system = assembler.system();
        Self { assembler, system, solver: Multifrontal::default(), solids: None, measures: Vec::new(), serves: false }
    }

    /// Evaluates and factorizes it at the solution of a pass of the run, in the order of elimination of the run: a resumed one has the same
    /// bits. The forces of the bodies are linearized there on request.
    ///
    /// # Errors
    /// Returns [`IncrementFailure`] if the equations cannot be evaluated there.
    pub fn of(&mut self, trial: Trial, pass: &Pass, linearize: bool) -> Result<(), IncrementFailure> {
        let Self { assembler, system, solver, solids, measures, serves } = self;
        assembler.couple(&pass.coupling);
        let u = &pass.displacement;
        let evaluated = assembler.tangent(trial, u, linearize, system);
        *solids = evaluated.map_err(|failure| IncrementFailure::Newton(NewtonFailure::Evaluation(failure)))?;
        *measures = assembler.measures(trial, u, TOLERANCE);
        *serves = solver.factorize(&system.tangent).is_ok();
        Ok(())
    }

    /// The model of the run.
    pub fn model(&self) -> &Model {
        self.assembler.model()
    }

    /// Couples the nodes of a neighbour as those of the run.
    pub fn couple(&self, work: &mut Workspace) {
        work.assembler.couple_as(&self.assembler);
    }

    /// Gives the state of the run at the start of the increment the multipliers from what was found where it was evaluated.
    pub fn multiply(&self, old: &mut State) {
        multiply(self.assembler.model(), &self.assembler.evaluation.contacts, old);
    }
}

/// A neighbour whose equilibrium is sought.
pub struct NeighbourProblem<'a> {
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
    /// k of its parameter θ + k ε
    pub offset: f64,
}

/// A coefficient a₁ or a₂ of (2), and what corrections have left of it.
struct Coefficient {
    /// Weights of the residuals in it
    weights: Vec<f64>,
    /// k or k² of every neighbour
    powers: Vec<f64>,
    /// Whether it drops out of the derivative
    drops_out: bool,
    /// ‖r‖/‖f‖ at the last evaluation, and before it
    left: f64,
    before: f64,
    /// Whether the last correction was of this one too
    was_corrected: bool,
}

impl Coefficient {
    /// All coefficients of neighbours with these k.
    fn of(offset: &[f64]) -> Vec<Self> {
        let count = offset.len();
        let powers = DMatrix::from_fn(count, count, |k, j| (0..j).fold(offset[k], |power, _| power * offset[k]));
        let inverse = powers.clone().try_inverse().unwrap_or_else(|| DMatrix::identity(count, count));
        let coefficient = |j: usize| Self {
            weights: inverse.row(j).iter().copied().collect(),
            powers: powers.column(j).iter().copied().collect(),
            drops_out: j > 0,
            left: f64::INFINITY,
            before: f64::INFINITY,
            was_corrected: true,
        };
        (0..count).map(coefficient).collect()
    }

    /// a₁ or a₂
    fn residual(&self, neighbours: &[NeighbourProblem], own: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; own.len()];
        for (weight, neighbour) in self.weights.iter().zip(neighbours) {
            let residuals = neighbour.work.system.residual.iter().zip(own);
            sum.iter_mut().zip(residuals).for_each(|(sum, (residual, own))| *sum += weight * (residual - own));
        }
        sum
    }

    /// Whether nothing is left of it. What has not been corrected yet may be less than its error so far, and grow from increment to
    /// increment; what drops out of the derivative may be left.
    fn is_solved(&self, tolerance: f64) -> bool {
        let is_corrected =
            self.before.is_finite() && (self.left <= (SURE * self.before).max(ROUND_OFF) || self.before <= TOLERANCE);
        self.left == 0.0 || self.left <= tolerance && (is_corrected || tolerance == CURVATURE)
    }

    /// Whether it falls from the largest coefficient that was corrected, of which a correction leaves a fraction in all of them.
    fn falls(&self, tolerance: f64, before: f64) -> bool {
        self.left <= tolerance || self.left <= SLOW * before
    }
}

impl NeighbourProblem<'_> {
    fn evaluate(&mut self, solids: Option<SolidForces>) -> Result<(), TrialFailure> {
        let Workspace { assembler, system, .. } = &mut *self.work;
        assembler.residual_of_neighbour(self.trial, &self.u, solids, system)
    }
}

/// Neighbours whose difference is a derivative.
struct Group<'a> {
    neighbours: Vec<NeighbourProblem<'a>>,
    coefficients: Vec<Coefficient>,
    status: Status,
}

/// Status of the iterations of a group.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Status {
    Iterates,
    Converged,
    /// The tangent of the run does not serve it
    Diverged,
}

/// A correction of the neighbours of a group.
struct Correction {
    /// k or k² of every neighbour
    powers: Vec<f64>,
    /// −a₁ or −a₂, and then K⁻¹ times that
    direction: Vec<f64>,
}

/// The run at a solution.
struct Run<'a> {
    /// r
    residual: &'a [f64],
    solids: Option<&'a LinearizedSolids>,
    measures: &'a [f64],
    assembler: &'a Assembler,
    /// Status of every contact point
    statuses: Vec<Regime>,
}

impl<'a> Group<'a> {
    fn new(neighbours: Vec<NeighbourProblem<'a>>) -> Self {
        let offset: Vec<f64> = neighbours.iter().map(|neighbour| neighbour.offset).collect();
        Self { coefficients: Coefficient::of(&offset), neighbours, status: Status::Iterates }
    }

    fn evaluate(&mut self, solids: Option<&LinearizedSolids>) -> Result<(), TrialFailure> {
        let same =
            self.neighbours.iter().filter(|neighbour| neighbour.has_same_bodies).map(|neighbour| &neighbour.u[..]);
        let mut forces = solids.map_or_else(Vec::new, |solids| solids.at(&same.collect::<Vec<_>>())).into_iter();
        self.neighbours.iter_mut().try_for_each(|neighbour| {
            let solids = if neighbour.has_same_bodies { forces.next() } else { None };
            neighbour.evaluate(solids)
        })
    }

    /// Largest distance from the prescribed motions.
    fn missed(&self) -> f64 {
        let of = |NeighbourProblem { work, trial, u, .. }: &NeighbourProblem| work.assembler.missed(*trial, u);
        self.neighbours.iter().map(of).fold(0.0, f64::max)
    }

    /// Evaluates the neighbours, and returns what is to be corrected.
    fn corrections(&mut self, run: &Run) -> Vec<Correction> {
        if self.status != Status::Iterates {
            return Vec::new();
        }
        if self.evaluate(run.solids).is_err() {
            self.status = Status::Diverged;
            return Vec::new();
        }
        let missed = self.missed();
        let Self { neighbours, coefficients, status } = self;
        let regimes_of = |neighbour: &NeighbourProblem| regimes(&neighbour.model.contacts, neighbour.work.contacts());
        let are_alike = neighbours.iter().all(|neighbour| regimes_of(neighbour) == run.statuses);
        let (mut corrections, mut fall) = (Vec::new(), true);
        let before = coefficients.iter().filter(|one| one.was_corrected).map(|one| one.left).fold(0.0, f64::max);
        for one in coefficients {
            let mut residual = one.residual(neighbours, run.residual);
            let share = run.assembler.share(neighbours[0].trial.step, &residual, run.measures);
            (one.before, one.left) = (one.left, share.max(missed));
            let tolerance = if one.drops_out && are_alike { CURVATURE } else { TOLERANCE };
            fall &= one.falls(tolerance, before);
            one.was_corrected = !one.is_solved(tolerance);
            if one.was_corrected {
                residual.iter_mut().for_each(|r| *r = -*r);
                corrections.push(Correction { powers: one.powers.clone(), direction: residual });
            }
        }
        if corrections.is_empty() {
            *status = Status::Converged;
        } else if !fall {
            *status = Status::Diverged;
            corrections.clear();
        }
        corrections
    }

    fn correct(&mut self, corrections: Vec<Correction>) {
        for Correction { powers, direction } in corrections {
            for (neighbour, power) in self.neighbours.iter_mut().zip(powers) {
                neighbour.u.iter_mut().zip(&direction).for_each(|(u, direction)| *u += power * direction);
            }
        }
    }

    /// The solution of every neighbour; those that have none yet are solved by themselves.
    fn end(self) -> Result<Vec<Vec<f64>>, IncrementFailure> {
        let Self { neighbours, status, .. } = self;
        match status {
            Status::Converged => Ok(neighbours.into_iter().map(|neighbour| neighbour.u).collect()),
            _ => neighbours.into_iter().map(by_itself).collect(),
        }
    }
}

/// Equilibrium of groups of neighbours, each group for one derivative, by the tangent of the run; or why a group has none near
/// the run. Groups are evaluated in parallel, and corrected together: the factors are read once for all of them.
pub fn solve_neighbours(
    groups: Vec<Vec<NeighbourProblem>>,
    tangent: &mut Tangent,
) -> Vec<Result<Vec<Vec<f64>>, IncrementFailure>> {
    let Tangent { assembler, system, solver, solids, measures, serves } = tangent;
    let statuses = regimes(&assembler.model().contacts, &assembler.evaluation.contacts);
    let run = Run { residual: &system.residual, solids: solids.as_ref(), measures, assembler, statuses };
    let mut groups: Vec<Group> = groups.into_iter().map(Group::new).collect();
    loop {
        let of = |group: &mut Group| if *serves { group.corrections(&run) } else { Vec::new() };
        let mut corrections: Vec<Vec<Correction>> = groups.par_iter_mut().with_max_len(1).map(of).collect();
        let mut columns: Vec<&mut [f64]> = corrections.iter_mut().flatten().map(|one| &mut one.direction[..]).collect();
        if columns.is_empty() {
            break;
        }
        solver.solve_all(&mut columns);
        groups.par_iter_mut().zip(corrections).for_each(|(group, own)| group.correct(own));
    }
    groups.into_par_iter().with_max_len(1).map(Group::end).collect()
}

/// Equilibrium of a neighbour by Newton's method.
fn by_itself(
    NeighbourProblem { model, trial, work, mut u, .. }: NeighbourProblem,
) -> Result<Vec<f64>, IncrementFailure> {
    if !u.iter().all(|u| u.is_finite()) {
        u.clone_from(&trial.old.displacement);
    }
    work.iteration.start_increment();
    let found = equilibrium(model, trial, Some(u), work).found?;
    work.assembler.evaluation = found.evaluation;
    Ok(found.displacement)
}
