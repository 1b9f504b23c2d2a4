//! Newton's method for r(u) = 0, independent of finite elements.
//!
//! ```text
//! K(u_k) Δu = −r(u_k),   u_{k+1} = u_k + Δu        until every part has ‖r‖ ≤ tolerance × ‖f‖
//! ```
//!
//! The tangent is consistent, so the residual falls quadratically near the solution. The parts of the equations, and residuals
//! caused by round-off, are defined by the caller ([`System::imbalance`]). No start value is accepted without a linear solve:
//! its error within the tolerance would accumulate from increment to increment.
//!
//! Where the equations have kinks, as friction has between sticking and slip in either direction, the corrections by consistent
//! tangents may form a cycle. If the residual stalls, the following corrections are limited to their descending part:
//!
//! ```text
//! u_{k+1} = u_k + α Δu,   s(α) = Δu·r(u_k + α Δu),   |s(α)| ≤ 0.1 |s(0)|
//! ```
//!
//! s is the work of the residual forces, as defined by the caller, who knows which equations are forces. With a potential,
//! r = ∂Π/∂u, it is the slope of Π along Δu, and Π decreases by every correction. Switch `downhill`; `aid_downhill`
//! is 1 where a line search was made.
//! Source: Matthies & Strang (1979), The solution of nonlinear finite element equations, doi:10.1002/nme.1620141104.
//!
//! Where even these corrections come back to the same iterates, no number of them ends, and the increment is given up at once: the last
//! p residuals and corrections are those of the p before, to five digits. Often there is no equilibrium near by, as where friction
//! weakens faster than the bodies unload, and a shorter increment has one. For the same reason a dynamic increment that may
//! be shortened is given up if eight corrections in a row have not halved the smallest residual before them. A static one is not: where many
//! points close one after the other, more corrections than that may come before the last ones.
//!
//! Near the solution the tangent of the previous iterate is nearly as good as a new one, and its factors are available. A
//! correction with them is made if the last reductions predict the solution within three of them; it counts as a linear solve
//! (`factorized` is 0 in `newton.csv`) and saves a tangent and its factors. Switch `old_tangents`. Source: the modified Newton
//! method, chosen by the predicted reduction as in Hairer & Wanner (1996), Solving Ordinary Differential Equations II, IV.8.
//!
//! The line search finds the step length along a correction of Newton's method.

use thiserror::Error;

use crate::linear::system::{Request, System};
use crate::linear::{self, LinearFailure, LinearSolver, Solution, norm};
use crate::model::text::count;

/// Stopping criteria and options of Newton's method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Required ‖r‖/‖f‖ of every part of a solution [-]
    pub tolerance: f64,
    /// Maximum number of linear solves
    pub max_iterations: usize,
    /// Whether factors of an earlier tangent may be used
    pub old_tangents: bool,
    /// Whether a line search is made where the residual stalls
    pub downhill: bool,
    /// Whether iterations that stall for long are given up, as a shorter increment may follow
    pub gives_up: bool,
}

/// Record of one linear solve and its result.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Iteration {
    /// ‖r‖/‖f‖ of the worst part after the correction; NaN if the corrected state could not be evaluated [-]
    pub residual: f64,
    /// Largest entry of the correction: of a displacement, or of r θ of a rigid body [L]
    pub correction: f64,
    /// ‖K Δu + r‖/‖r‖ of the linear solve [-]
    pub linear_residual: f64,
    /// Whether K was factorized anew; otherwise the factors are those of an earlier iterate
    pub factorized: bool,
    /// Number of vanishing pivots of K that were replaced
    pub perturbed_pivots: usize,
    /// Negative eigenvalues of K, where all of it was factorized as symmetric
    pub negative_pivots: Option<usize>,
    /// Least number of negative eigenvalues of K, if anything is known of them ([`linear::LinearSolver::least_negative`]); in the last
    /// iteration of a static increment that of the equilibrium itself, if K has any
    pub least_negative: Option<usize>,
    /// Whether the factors of K were too inaccurate, and another solver was used
    pub fallback: bool,
    /// Whether a line search was made along the correction
    pub searched: bool,
}

/// Reason why no solution was found; `E` is the failure of an evaluation.
#[derive(Clone, Debug, PartialEq, Error)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub enum NewtonFailure<E> {
    /// The equations could not be evaluated at a trial state.
    #[error("{0}")]
    Evaluation(E),
    /// The linear system has no solution.
    #[error("{0}")]
    Linear(#[from] LinearFailure),
    /// Numbers beyond double precision, relative to which any residual would look small.
    #[error("the forces are too large for double precision; check the stiffnesses, loads and units")]
    Overflow,
    /// The residual diverges.
    #[error("Newton's method diverges (relative residual {residual:.1e} after {})", count(*iterations, "iteration"))]
    Diverged {
        /// last relative residual
        residual: f64,
        /// linear solves so far
        iterations: usize,
    },
    /// The iterates repeat themselves.
    #[error("Newton's method goes round in a circle of {period} iterates (relative residual {residual:.1e} after {})", count(*iterations, "iteration"))]
    Circles {
        /// number of iterates after which they are the same again
        period: usize,
        /// last relative residual
        residual: f64,
        /// linear solves so far
        iterations: usize,
    },
    /// Many corrections have not reduced the residual, and a shorter increment may follow.
    #[error("Newton's method stalls: {PATIENCE} corrections have not halved a relative residual of {least:.1e} (now {residual:.1e}, after {})", count(*iterations, "iteration"))]
    Stalled {
        /// smallest relative residual before them
        least: f64,
        /// last relative residual
        residual: f64,
        /// linear solves so far
        iterations: usize,
    },
    /// The maximum number of iterations was reached.
    #[error("no equilibrium within {} (relative residual {residual:.1e})", count(*iterations, "iteration"))]
    TooManyIterations {
        /// last relative residual
        residual: f64,
        /// linear solves so far
        iterations: usize,
    },
}

impl<E> NewtonFailure<E> {
    /// Whether all equations were evaluated and solved, but no iterate was an equilibrium.
    pub fn is_without_end(&self) -> bool {
        use NewtonFailure::{Circles, Diverged, Stalled, TooManyIterations};
        matches!(self, Diverged { .. } | Circles { .. } | Stalled { .. } | TooManyIterations { .. })
    }
}

/// Equations r(u) = 0.
pub trait Equations {
    /// Why they could not be evaluated
    type Failure;

    /// Fills the system at a displacement.
    ///
    /// # Errors
    /// Returns [`Self::Failure`] if they have no value there.
    fn evaluate(&mut self, u: &[f64], request: Request, system: &mut System) -> Result<(), Self::Failure>;

    /// Work of a residual at `u` along a correction.
    fn work(&self, u: &[f64], residual: &[f64], way: &[f64]) -> f64;
}

/// Ratio of the residual to the largest of the first ones that counts as divergence.
const DIVERGENCE: f64 = 1e4;

/// Largest ratio of the remaining residual of an old tangent to the previous one, and smallest reduction for its reuse.
const OLD_TANGENT: f64 = 10.0;

/// Number of corrections with an old tangent up to which they cost less than the factors of a new one. It is the same for every
/// model and machine: results must not depend on the cost of factors.
const OLD_TANGENT_CORRECTIONS: f64 = 3.0;

/// Number of consecutive corrections without a new minimum of the residual before line searches start. A single one often
/// occurs while the contact status adjusts.
const STALLED: usize = 2;

/// Number of consecutive corrections that do not halve the residual after which a shorter increment costs less. Of the dynamic increments of
/// `slip_front`, `stick_slip` and the 4 m fault, 2 of 7880 were solved after so many.
const PATIENCE: usize = 8;

/// ‖r‖/‖f‖ below which round-off may decide: there another correction may meet even a tolerance near that of the numbers.
const ROUND_OFF: f64 = 1e-9;

/// Longest circle of iterates that is looked for.
const LONGEST_CIRCLE: usize = 12;

/// Largest relative difference of residuals and corrections that count as the same: round-off changes them by less, and what converges
/// by so little in an iteration does not converge.
const SAME: f64 = 1e-5;

/// Smallest of the largest ‖r‖/‖f‖ in a circle, in multiples of the tolerance.
const FAR_FROM_SOLVED: f64 = 100.0;

/// Solves the equations from the start value `u`. The iterations made are added to a list, whether or not they end.
///
/// # Errors
/// Returns the reason why there is no solution.
pub fn solve<E: Equations>(
    equations: &mut E,
    mut u: Vec<f64>,
    settings: Settings,
    solver: &mut dyn LinearSolver,
    system: &mut System,
    iterations: &mut Vec<Iteration>,
) -> Result<Vec<f64>, NewtonFailure<E::Failure>> {
    equations.evaluate(&u, Request::Residual, system).map_err(NewtonFailure::Evaluation)?;
    let mut convergence = Convergence::new(settings);
    while let Some(plan) = convergence.judge(iterations, system)? {
        let here = if plan.searched { system.residual.clone() } else { Vec::new() };
        if plan.factorized {
            equations.evaluate(&u, Request::Tangent, system).map_err(NewtonFailure::Evaluation)?;
        }
        let mut solution = correction(plan.factorized, solver, system)?;
        if plan.searched {
            let start = equations.work(&u, &here, &solution.x);
            let share = downhill(start, |share| {
                let there: Vec<f64> = u.iter().zip(&solution.x).map(|(u, x)| u + share * x).collect();
                let evaluated = equations.evaluate(&there, Request::Between, system);
                evaluated.map_or(f64::NAN, |()| equations.work(&u, &system.residual, &solution.x))
            });
            solution.x.iter_mut().for_each(|x| *x *= share);
        }
        u.iter_mut().zip(&solution.x).for_each(|(u, x)| *u += x);
        iterations.push(plan.iteration(&solution));
        match equations.evaluate(&u, Request::Residual, system) {
            Ok(()) => {}
            Err(failure) if plan.factorized => return Err(NewtonFailure::Evaluation(failure)),
            Err(_) => {
                // The old tangent failed: the next correction starts from the same iterate.
                convergence.old_tangent_serves = false;
                u.iter_mut().zip(&solution.x).for_each(|(u, x)| *u -= x);
                equations.evaluate(&u, Request::Residual, system).map_err(NewtonFailure::Evaluation)?;
            }
        }
    }
    Ok(u)
}

/// Plan of the next correction.
#[derive(Clone, Copy)]
struct Plan {
    /// Whether a new tangent is factorized, instead of using earlier factors
    factorized: bool,
    /// Whether a line search is made
    searched: bool,
}

impl Plan {
    /// Record of the correction; its residual is not known yet.
    fn iteration(self, solution: &Solution) -> Iteration {
        Iteration {
            residual: f64::NAN,
            correction: solution.x.iter().fold(0.0f64, |m, x| m.max(x.abs())),
            linear_residual: solution.residual,
            factorized: self.factorized,
            perturbed_pivots: solution.perturbed_pivots,
            negative_pivots: solution.negative_pivots,
            least_negative: solution.least_negative,
            fallback: solution.fallback,
            searched: self.searched,
        }
    }
}

/// History of the iterations so far.
struct Convergence {
    settings: Settings,
    /// Largest ‖r‖ of the first iterates
    largest_start: f64,
    /// ‖r‖ and ‖r‖/‖f‖ before the last correction
    before: [f64; 2],
    /// False near a kink of the equations, where an old tangent repeatedly converges more slowly than predicted
    old_tangent_serves: bool,
    /// Smallest ‖r‖ so far, and number of consecutive corrections above it
    least: f64,
    stalled: usize,
    /// Number of corrections after which it had stalled: from there on line searches are made
    stalled_at: Option<usize>,
    /// ‖r‖/‖f‖ that is to be halved, and number of consecutive corrections that have not
    mark: f64,
    unhalved: usize,
}

impl Convergence {
    fn new(settings: Settings) -> Self {
        Self {
            settings,
            largest_start: 0.0,
            before: [f64::INFINITY; 2],
            old_tangent_serves: true,
            least: f64::INFINITY,
            stalled: 0,
            stalled_at: None,
            mark: f64::INFINITY,
            unhalved: 0,
        }
    }

    /// Judges the iterate of the given system: returns the next plan, `None` if it is the solution, or a failure.
    fn judge<E>(&mut self, iterations: &mut [Iteration], system: &System) -> Result<Option<Plan>, NewtonFailure<E>> {
        let (size, residual) = (norm(&system.residual), system.imbalance);
        let done = iterations.len();
        if !system.forces.is_finite() {
            return Err(NewtonFailure::Overflow);
        }
        if let Some(last) = iterations.last_mut() {
            last.residual = residual;
            let prediction_met = last.factorized || gain(size, residual, self.before) <= 1.0 / OLD_TANGENT;
            self.old_tangent_serves &= prediction_met && !last.fallback;
        }
        if done > 0 && residual <= self.settings.tolerance {
            return Ok(None);
        }
        if done <= 2 {
            self.largest_start = self.largest_start.max(size);
        }
        if !size.is_finite() || size > DIVERGENCE * self.largest_start {
            return Err(NewtonFailure::Diverged { residual, iterations: done });
        }
        let since = |stalled: usize| circle(&iterations[stalled.min(done)..], self.settings.tolerance);
        if let Some(period) = self.stalled_at.and_then(since) {
            return Err(NewtonFailure::Circles { period, residual, iterations: done });
        }
        self.unhalved = if residual <= 0.5 * self.mark { 0 } else { self.unhalved + 1 };
        if self.unhalved == 0 {
            self.mark = residual;
        }
        if self.settings.gives_up && self.unhalved >= PATIENCE && self.mark > ROUND_OFF {
            return Err(NewtonFailure::Stalled { least: self.mark, residual, iterations: done });
        }
        if done == self.settings.max_iterations {
            return Err(NewtonFailure::TooManyIterations { residual, iterations: done });
        }
        Ok(Some(self.plan(iterations, size, residual)))
    }

    /// Plans the next correction, from the reduction by the corrections so far.
    fn plan(&mut self, iterations: &[Iteration], size: f64, residual: f64) -> Plan {
        let Settings { tolerance, old_tangents, downhill, .. } = self.settings;
        let last = iterations.last();
        self.stalled = if size < self.least { 0 } else { self.stalled + 1 };
        self.least = self.least.min(size);
        if self.stalled >= STALLED {
            self.stalled_at.get_or_insert(iterations.len());
        }
        let slower = if last.is_some_and(|last| last.factorized) { OLD_TANGENT } else { 1.0 };
        let corrections = corrections_left(residual, slower * gain(size, residual, self.before), tolerance);
        let old_tangent = old_tangents && self.old_tangent_serves && corrections <= OLD_TANGENT_CORRECTIONS;
        let factorized = last.is_none() || !old_tangent;
        self.before = [size, residual];
        Plan { factorized, searched: downhill && self.stalled_at.is_some() && factorized }
    }
}

/// Number of iterates of the circle in which the last ones go, if they do. Near the tolerance round-off may go to and fro for a while.
fn circle(iterations: &[Iteration], tolerance: f64) -> Option<usize> {
    let same = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs().max(b.abs());
    let alike = |(a, b): (&Iteration, &Iteration)| same(a.residual, b.residual) && same(a.correction, b.correction);
    let returns = |period: usize| {
        let (last, before) = (iterations.iter().rev(), iterations.iter().rev().skip(period));
        let far = |iteration: &Iteration| iteration.residual > FAR_FROM_SOLVED * tolerance;
        iterations.len() >= 2 * period && last.clone().take(period).any(far) && last.zip(before).take(period).all(alike)
    };
    (2..=LONGEST_CIRCLE).find(|&period| returns(period))
}

/// −K⁻¹ r with the tangent of the system, or with the factors of an earlier one.
fn correction(factorized: bool, solver: &mut dyn LinearSolver, system: &System) -> Result<Solution, LinearFailure> {
    let right: Vec<f64> = system.residual.iter().map(|r| -r).collect();
    if factorized {
        linear::solve(solver, &system.tangent, &right)
    } else {
        Ok(linear::solve_again(solver, &system.tangent, &right))
    }
}

/// Fraction of the residual left by a correction: of the whole, or of the worst part's excess if that is larger.
fn gain(size: f64, residual: f64, before: [f64; 2]) -> f64 {
    (size / before[0]).max(residual / before[1])
}

/// Number of corrections from a residual `size` to `allowed`, if each leaves the fraction `left` of it.
fn corrections_left(size: f64, left: f64, allowed: f64) -> f64 {
    if left < 1.0 { (allowed / size).ln() / left.ln() } else { f64::INFINITY }
}

/// |s(α)|/|s(0)| at which a line search ends.
const LEVEL: f64 = 0.1;

/// Maximum number of evaluations in a line search.
const LONGEST_SEARCH: usize = 12;

/// Line search: step length as a fraction of the correction, up to where `slope` is near 0, or 1 if that is not exceeded.
/// `slope` is NaN where the equations cannot be evaluated. Regula falsi (Illinois), with bisection where that fails: forces
/// that stick in a narrow range make the slope steep there.
fn downhill(start: f64, mut slope: impl FnMut(f64) -> f64) -> f64 {
    let level = |s: f64| s.abs() <= LEVEL * start.abs();
    let end = slope(1.0);
    // Only corrections that start downhill are searched.
    if start >= 0.0 || end <= 0.0 || level(end) {
        return 1.0;
    }
    let (mut low, mut high) = ((0.0, start), (1.0, end));
    let (mut share, mut side) = (1.0, 0.0);
    for _ in 0..LONGEST_SEARCH {
        let falsi = low.0 + (high.0 - low.0) * low.1 / (low.1 - high.1);
        share = if falsi > low.0 && falsi < high.0 { falsi } else { 0.5 * (low.0 + high.0) };
        let s = slope(share);
        if level(s) {
            break;
        }
        // An end that is retained a second time counts half (Illinois rule).
        let stays = if s.signum() == side { 0.5 } else { 1.0 };
        side = s.signum();
        if s < 0.0 {
            (low, high.1) = ((share, s), stays * high.1);
        } else {
            (high, low.1) = ((share, s), stays * low.1);
        }
    }
    share
}
