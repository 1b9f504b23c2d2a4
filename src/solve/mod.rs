//! Solution of the equations of one increment: Newton's method, contact iteration, augmented Lagrangian method, and detection
//! of unconstrained rigid-body modes.

pub mod condensed_newton;
pub mod conduits;
pub mod contact_iteration;
pub mod equilibrium;
pub mod failure;
pub mod floating;
pub mod limit;
pub mod neighbour;
pub mod newton;
pub mod passes;
mod watch;

use std::sync::Arc;

use crate::contact::force::ContactState;
use crate::equations::{Assembler, ContactCounts, Coupling};
use crate::linear::LinearSolver;
use crate::linear::system::System;
use crate::model::Model;
use condensed_newton::CondensedNewton;
use conduits::WaterHistory;
use contact_iteration::{Acted, ContactIteration};
pub use failure::IncrementFailure;
use newton::Iteration;

/// Buffers reused from one increment to the next to save work. What an increment has found is in what is returned of it; nothing
/// that decides on a result is read from here.
pub struct Workspace {
    /// assembler of the equations
    pub assembler: Assembler,
    /// contact iteration
    iteration: ContactIteration,
    /// linear solver
    pub solver: Box<dyn LinearSolver>,
    pub(crate) system: System,
    /// Linear bodies condensed on the contact nodes, if that pays
    interface: Option<CondensedNewton>,
    /// Seconds spent in linear solves
    pub linear_seconds: f64,
}

/// Solution of one pass of an increment: the augmented Lagrangian method makes several of them, the penalty method one.
#[derive(Clone, Debug)]
pub struct Pass {
    /// u at the time at which the scheme requires equilibrium [L]
    pub displacement: Vec<f64>,
    /// its factor on α_n ([`crate::equations::Trial::stiffening`])
    pub stiffening: f64,
    /// Coupling of the nodes at it, on which the order of elimination depends
    pub coupling: Arc<Coupling>,
    /// Water of each contact under which it was found; empty where none flows
    pub water: Vec<Option<WaterHistory>>,
}

impl Workspace {
    /// Creates the workspace of a model.
    pub fn new(model: &Arc<Model>, solver: Box<dyn LinearSolver>) -> Self {
        let assembler = Assembler::new(model);
        let system = assembler.system();
        Self {
            assembler,
            iteration: ContactIteration::default(),
            solver,
            system,
            interface: CondensedNewton::new(model),
            linear_seconds: 0.0,
        }
    }

    /// States of the contact points where the equations were evaluated last.
    pub fn contacts(&self) -> &[Vec<ContactState>] {
        &self.assembler.evaluation.contacts
    }
}

/// One row of the convergence record.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct IterationRecord {
    /// residual, correction, linear residual
    pub newton: Iteration,
    /// contact states after the correction
    pub contacts: ContactCounts,
    /// points whose status returned to that before the previous correction
    pub flips: usize,
    /// number of the augmentation; 1 for the plain penalty method
    pub pass: usize,
    /// ‖stabilizing forces‖/‖all forces‖ after the correction [-]
    pub stabilization: f64,
    /// actions of the aids in its tangent
    #[doc(hidden)]
    pub acted: Acted,
}
