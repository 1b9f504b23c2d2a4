//! Equilibrium of a model that differs little from the one of a run, at an increment that the run has solved: the tangent of the run
//! serves both.
//!
//! ```text
//! K Δu = −r′(u′_k),   u′_{k+1} = u′_k + Δu        until every part has ‖r′‖ ≤ 1e-12 ‖f‖
//! K = ∂r/∂u at the solution of the run, without presumptions, factorized once for all its neighbours
//! ```
//!
//! r′ are the neighbour's own equations. Its tangent differs from K by O(ε) if its parameters and its state do, so every
//! correction leaves a fraction O(ε) of the error: one or two are enough. If a contact point has another status than in the run they are
//! not, and the neighbour is solved by Newton's method with its own tangents.
//!
//! Source: the simplified Newton method, Deuflhard (2011), Newton Methods for Nonlinear Problems, 2.1.2.

use std::sync::Arc;

use super::equilibrium::equilibrium;
use super::failure::IncrementFailure;
use super::newton::NewtonFailure;
use super::{Pass, Workspace};
use crate::contact::force::ContactState;
use crate::equations::{Assembler, Trial};
use crate::linear::system::{Request, System};
use crate::linear::{LinearSolver, Multifrontal};
use crate::model::Model;

/// Required ‖r‖/‖f‖ of every part of a neighbour's solution [-]
pub const TOLERANCE: f64 = 1e-12;

/// Largest fraction of ‖r‖/‖f‖ left by a correction for another one with the tangent of the run.
const SLOW: f64 = 0.1;

/// Fraction left by a correction above which another one follows, though the residual is small already: it may be as small as round-off
/// could be, and larger than round-off is.
const SURE: f64 = 1e-3;

/// The tangent of a run at a solution, and its factors.
pub struct Tangent {
    assembler: Assembler,
    system: System,
    solver: Box<dyn LinearSolver>,
    /// Whether the matrix could be factorized
    serves: bool,
}

impl Tangent {
    /// Creates the tangent of a model; [`Self::of`] evaluates it.
    pub fn new(model: &Arc<Model>) -> Self {
        let assembler = Assembler::new(model);
        let system = assembler.system();
        Self { assembler, system, solver: Box::<Multifrontal>::default(), serves: false }
    }

    /// Evaluates and factorizes it at the solution of a pass of the run, in the order of elimination of the run: a resumed one has the same
    /// bits.
    ///
    /// # Errors
    /// Returns [`IncrementFailure`] if the equations cannot be evaluated there.
    pub fn of(&mut self, trial: Trial, pass: &Pass) -> Result<(), IncrementFailure> {
        let Self { assembler, system, solver, serves } = self;
        assembler.couple(&pass.coupling);
        let u = &pass.displacement;
        let evaluated = assembler.with_responses(trial, u, Request::Tangent, |assembler, responses| {
            assembler.assemble(trial, u, responses, Request::Tangent, system)
        });
        evaluated.map_err(|failure| IncrementFailure::Newton(NewtonFailure::Evaluation(failure)))?;
        *serves = solver.factorize(&system.tangent).is_ok();
        Ok(())
    }

    /// States of the contacts of the run where it was evaluated.
    pub fn contacts(&self) -> &[Vec<ContactState>] {
        &self.assembler.evaluation.contacts
    }

    /// −K⁻¹ r
    fn correction(&mut self, residual: &[f64]) -> Vec<f64> {
        let mut way: Vec<f64> = residual.iter().map(|r| -r).collect();
        self.solver.solve(&mut way);
        way
    }
}

/// Equilibrium of a neighbour of the run whose tangent is given, from the start value `u`. The equations are evaluated last at the
/// solution.
///
/// # Errors
/// Returns [`IncrementFailure`] if there is none near `u`.
pub fn beside(
    model: &Model,
    trial: Trial,
    mut u: Vec<f64>,
    tangent: &mut Tangent,
    work: &mut Workspace,
) -> Result<Vec<f64>, IncrementFailure> {
    let mut before = f64::INFINITY;
    while tangent.serves {
        let Workspace { assembler, system, .. } = work;
        if assembler.residual(trial, &u, system).is_err() {
            break;
        }
        let begins = before.is_infinite();
        let share = system.imbalance / before;
        if !begins && system.imbalance <= TOLERANCE && (share <= SURE || before <= TOLERANCE) {
            return Ok(u);
        }
        if !(share <= SLOW || system.imbalance <= TOLERANCE) {
            break;
        }
        before = system.imbalance;
        let way = tangent.correction(&system.residual);
        u.iter_mut().zip(way).for_each(|(u, way)| *u += way);
    }
    if !u.iter().all(|u| u.is_finite()) {
        u.clone_from(&trial.old.displacement);
    }
    work.iteration.start_increment();
    equilibrium(model, trial, Some(u), work).1
}
