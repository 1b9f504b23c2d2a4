//! Solving the equations of one increment: Newton's method, the contact iteration, the augmented Lagrangian, and what
//! holds bodies that float.

pub mod condensed_newton;
pub mod contact_iteration;
pub mod equilibrium;
pub mod failure;
pub mod floating;
pub mod newton;

use std::sync::Arc;

use crate::contact::force::ContactState;
use crate::equations::condensed::is_linear;
use crate::equations::{Assembler, ContactCounts};
use crate::linear::LinearSolver;
use crate::linear::system::System;
use crate::model::{Model, Step};
use condensed_newton::CondensedNewton;
use contact_iteration::{Acted, ContactIteration};
use newton::Iteration;

/// Data kept from one increment to the next to save work; they do not change any result.
pub struct Workspace {
    /// assembles the equations
    pub assembler: Assembler,
    /// what its linear solves hand down to each other
    iteration: ContactIteration,
    /// solves them
    pub solver: Box<dyn LinearSolver>,
    pub(crate) system: System,
    /// Linear bodies condensed on the nodes at contacts, where that is worth it
    interface: Option<CondensedNewton>,
    /// Contact states to which the motion before the last attempt would have led, had it gone on
    pub foreseen: Vec<Vec<ContactState>>,
    /// Seconds spent in linear solves
    pub linear_seconds: f64,
}

impl Workspace {
    /// A workspace for a model.
    pub fn new(model: &Arc<Model>, solver: Box<dyn LinearSolver>) -> Self {
        let assembler = Assembler::new(model);
        let system = assembler.system();
        Self {
            assembler,
            iteration: ContactIteration::default(),
            solver,
            system,
            interface: CondensedNewton::new(model),
            foreseen: Vec::new(),
            linear_seconds: 0.0,
        }
    }

    /// Whether linear bodies are condensed on the nodes at contacts in a step.
    pub fn condenses(&self, step: &Step) -> bool {
        self.interface.is_some() && is_linear(self.assembler.model(), step)
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
    /// points that the correction brought back to the status which the one before it had changed
    pub flips: usize,
    /// number of the pass of the augmented Lagrangian; 1 for the plain penalty
    pub pass: usize,
    /// ‖forces that stabilize‖/‖forces at work‖ after the correction [-]
    pub stabilization: f64,
    /// what the aids did in its tangent
    #[doc(hidden)]
    pub acted: Acted,
}
