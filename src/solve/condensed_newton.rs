//! Condensed Newton's method: increments of linear bodies, iterated on the nodes at contacts only.
//!
//! The bodies are condensed on these nodes ([`crate::equations::condensed`]), once per increment length, and evaluated
//! when a solution is found there. The residual of all equations decides on its acceptance, as always, so accepted results do
//! not depend on how they were found. If it is too large, another round starts from there, and after a few rounds the increment
//! is solved by Newton's method on all equations. Switch `condense`; `aid_condense` is 1 in iterations on the contacts.
//!
//! The method is used where it costs less: where a dense LU of the nodes at contacts takes no more than three times the
//! operations of a factorization of the bodies (dense operations being that much faster), and where most nodes are not at
//! contacts. If this holds only for the half of the equations on the contacts that varies while nothing opens, an increment in
//! which more of them vary is solved on all equations. The choice follows from the model, the step and the iterates, never from
//! stored data. Condensed matrices are stored for all lengths as long as they take no more than [`MOST_MEMORY`] and half of the
//! free memory; the most recently used are kept.

use std::sync::Arc;

use super::Workspace;
use super::contact_iteration::{Acted, ContactIteration};
use super::floating::null_motion;
use super::newton::{self, Equations, NewtonFailure};
use super::watch::Watch;
use crate::equations::condensed::{CondensedEquations, ContactNodes, depends_on_length, is_linear};
use crate::equations::supports;
use crate::equations::{Assembler, Trial, TrialFailure};
use crate::linear::memory::available_memory;
use crate::linear::system::{Request, System};
use crate::linear::{Condensation, Condensed, Eliminated, HalvedLu, LinearFailure, Pattern};
use crate::model::boundary::{Absorber, Dashpot, Spring};
use crate::model::support::Direction;
use crate::model::{Damping, Model, Scheme, Step};

/// Upper bound of the memory of condensed matrices of all increment lengths [bytes].
pub const MOST_MEMORY: usize = 2 << 30;

/// Speed of the operations of a dense LU relative to those of a multifrontal elimination.
const DENSE: f64 = 3.0;

/// Bodies of a model condensed on the nodes at its contacts.
pub struct CondensedNewton {
    nodes: ContactNodes,
    /// Whether LU of all their equations pays, not only of the half that varies while nothing opens
    whole: bool,
    /// The equations without contact
    bodies: Assembler,
    system: System,
    /// The pattern with all contact nodes coupled
    pattern: Arc<Pattern>,
    condensation: Condensation,
    /// Constant part of the equations, apart from the increment length, from which the condensed matrices follow
    constants: Option<Constants>,
    /// Condensed matrices by the bits of Δt, most recently used last; `None` where a pivot vanished
    by_length: Vec<(u64, Option<Arc<OfLength>>)>,
    /// The condensed equations and their solver
    condensed: System,
    solver: HalvedLu,
}

/// The bodies condensed for one length of increments.
struct OfLength {
    /// Condensed on the contact nodes
    bodies: Condensed,
    /// Condensed further on the equations that vary
    eliminated: Option<Eliminated>,
}

/// All data of a step that affect the constant part of its equations.
#[derive(PartialEq)]
struct Constants {
    scheme: Scheme,
    supports: Vec<Direction>,
    /// Stiffnesses of springs, and coefficients of dashpots
    at_dofs: [Vec<(usize, f64)>; 2],
    absorbers: Vec<Absorber>,
    damping: Vec<Damping>,
}

impl Constants {
    fn of(model: &Model, step: &Step) -> Self {
        let springs = step.loads.springs.iter().map(|&Spring { dof, stiffness, .. }| (dof, stiffness)).collect();
        let dashpots = step.loads.dashpots.iter().map(|&Dashpot { dof, coefficient, .. }| (dof, coefficient)).collect();
        Self {
            scheme: step.scheme,
            supports: step.supports.iter().map(|support| support.at).collect(),
            at_dofs: [springs, dashpots],
            absorbers: step.loads.absorbers.clone(),
            damping: model.dampings(step),
        }
    }
}

impl CondensedNewton {
    /// Creates the condensation of a model if it pays.
    pub fn new(model: &Arc<Model>) -> Option<Self> {
        let condenses = |step: &Step| !matches!(step.scheme, Scheme::Explicit { .. }) && is_linear(model, step);
        if model.contacts.is_empty()
            || !model.aids.condense
            || model.changes_bodies()
            || model.flow.is_some()
            || !model.steps.iter().any(condenses)
        {
            return None;
        }
        let nodes = ContactNodes::new(model);
        let bodies = Assembler::new(model);
        let system = bodies.system();
        let elimination = Condensation::new(system.tangent.pattern.clone(), &[]).ok()?.work();
        let most = 2 * nodes.nodes.len() > model.mesh.nodes.len();
        let pays = |equations: usize| 2.0 / 3.0 * (equations as f64).powi(3) <= DENSE * elimination;
        let whole = pays(2 * nodes.nodes.len());
        if most || !(whole || nodes.halves() && pays(nodes.nodes.len())) {
            return None;
        }
        let pattern = nodes.around(&system.tangent.pattern);
        let condensation = Condensation::new(pattern.clone(), &nodes.nodes).ok()?;
        let condensed = nodes.system();
        let (constants, by_length, solver) = (None, Vec::new(), HalvedLu::default());
        Some(Self { nodes, whole, bodies, system, pattern, condensation, constants, by_length, solver, condensed })
    }

    /// Returns the bodies condensed for an increment; `None` if the step has nonlinearities other than contact, or a pivot
    /// vanished because a body is constrained by contact only, at eliminated nodes.
    ///
    /// # Errors
    /// Returns [`TrialFailure`] if a load has no finite value.
    fn bodies(&mut self, model: &Model, trial: Trial) -> Result<Option<Arc<OfLength>>, TrialFailure> {
        if !is_linear(model, trial.step) {
            return Ok(None);
        }
        let constants = Constants::of(model, trial.step);
        if self.constants.as_ref() != Some(&constants) {
            self.constants = Some(constants);
            self.by_length.clear();
        }
        let varies = depends_on_length(model, trial.step);
        let dt = if varies { without_jitter(trial.dt) } else { trial.dt };
        let length = if varies { dt.to_bits() } else { 0 };
        let of_length = match self.by_length.iter().position(|(own, _)| *own == length) {
            Some(k) => self.by_length.remove(k).1,
            None => self.condense(Trial { dt, ..trial })?,
        };
        self.by_length.push((length, of_length.clone()));
        Ok(of_length)
    }

    /// Condenses the bodies, replacing the least recently used lengths if memory requires it.
    fn condense(&mut self, trial: Trial) -> Result<Option<Arc<OfLength>>, TrialFailure> {
        let one = self.condensation.memory() + Eliminated::memory(self.nodes.nodes.len());
        let free = available_memory().map_or(MOST_MEMORY, |free| (free / 2).min(MOST_MEMORY));
        let used = self.by_length.len() * one;
        // Memory already used counts as available.
        let most = (used + free).min(MOST_MEMORY) / one.max(1);
        self.by_length.drain(..(self.by_length.len() + 1).saturating_sub(most.max(1)));
        let Self { nodes, bodies, system, pattern, condensation, .. } = self;
        bodies.assemble(trial, &trial.old.displacement, &[], Request::Tangent, system)?;
        let matrix = nodes.counted(bodies.model(), trial.step, &system.tangent, pattern);
        let of_length = |condensed: Condensed| {
            let eliminated = nodes.eliminated(bodies.model(), trial.step, &condensed);
            Arc::new(OfLength { bodies: condensed, eliminated })
        };
        Ok(condensation.condense(&matrix).map(of_length))
    }
}

/// Δt rounded to eight digits: as a difference of two times it has their round-off, and no two increments are equal.
/// Matrices may be shared, since their solution is checked by the equations of the increment itself.
fn without_jitter(dt: f64) -> f64 {
    const UNIT: u64 = 1 << 25;
    f64::from_bits((dt.to_bits() + UNIT / 2) & !(UNIT - 1))
}

/// Maximum number of rounds on the contact nodes before an increment is solved on all equations.
const MOST_ROUNDS: usize = 3;

/// Solves by Newton's method on the contact nodes; `None` if that does not pay, the bodies do not allow it, or it does not lead to an
/// equilibrium of all equations.
pub(super) fn solve(
    model: &Model,
    trial: Trial,
    start: &[f64],
    watch: &mut Watch,
    work: &mut Workspace,
) -> Option<Result<Vec<f64>, NewtonFailure<TrialFailure>>> {
    let of_length = work.interface.as_mut()?.bodies(model, trial).ok()??;
    let OfLength { bodies, eliminated } = &*of_length;
    let mut u = start.to_vec();
    if watch.begins {
        if watch.seeks_floating {
            assemble_all(trial, &u, work)?;
            watch.floating = null_motion(model, trial.step, &u, &work.system.tangent);
        }
        work.iteration.start_increment();
    }
    for _ in 0..MOST_ROUNDS {
        let Workspace { assembler, iteration, system, interface, .. } = &mut *work;
        let CondensedNewton { nodes, whole, solver, condensed, .. } = interface.as_mut()?;
        assembler.assemble(trial, &u, &[], Request::Residual, system).ok()?;
        let forwarded = bodies.forward(&nodes.balanced(model, trial.step, &system.residual));
        let equations = CondensedEquations::new(nodes, bodies, trial, &u, forwarded.right.clone(), assembler, system);
        let (from, all) = (nodes.gather(&u), u.clone());
        let (mut iterations, settings) = (Vec::new(), watch.settings);
        let mut on_contacts = OnContacts { equations, nodes, all, assembler, iteration, trial, watch: &mut *watch };
        let result = newton::solve(
            &mut on_contacts,
            from.clone(),
            settings,
            &mut solver.with(eliminated.as_ref(), *whole),
            condensed,
            &mut iterations,
        );
        let all = on_contacts.all;
        watch.record(iterations);
        let x = match result {
            Ok(x) => x,
            Err(NewtonFailure::Linear(LinearFailure::Varies)) => return None,
            Err(failure) => {
                // Unconstrained rigid-body modes are detected from the full tangent.
                assemble_all(trial, &all, work)?;
                return Some(Err(failure));
            }
        };
        // The bodies follow: A (u − u₀) = −r at all other nodes.
        let way: Vec<f64> = from.iter().zip(&x).map(|(from, x)| from - x).collect();
        let ways = nodes.resolved(bodies.backward(&forwarded, &way));
        u.iter_mut().zip(ways).for_each(|(u, way)| *u -= way);
        nodes.scatter(&x, &mut u);
        assembler.residual(trial, &u, system).ok()?;
        if let Some(last) = watch.records.last_mut() {
            last.newton.residual = system.imbalance;
        }
        if system.imbalance <= watch.settings.tolerance {
            return Some(Ok(u));
        }
    }
    None
}

/// The equations of an increment on the contact nodes.
struct OnContacts<'a> {
    equations: CondensedEquations<'a>,
    nodes: &'a ContactNodes,
    /// u of all nodes, at the contact nodes that of the iterate [L]
    all: Vec<f64>,
    assembler: &'a mut Assembler,
    iteration: &'a mut ContactIteration,
    trial: Trial<'a>,
    watch: &'a mut Watch,
}

impl Equations for OnContacts<'_> {
    type Failure = TrialFailure;

    fn evaluate(&mut self, x: &[f64], request: Request, system: &mut System) -> Result<(), TrialFailure> {
        let Self { equations, nodes, all, assembler, iteration, trial, watch } = self;
        nodes.scatter(x, all);
        let responses = iteration.respond(assembler, *trial, all, request)?;
        equations.assemble(assembler, *trial, x, responses, request, system);
        if request == Request::Tangent {
            iteration.note(assembler.model(), all, trial.old);
        }
        let acted = Acted { condense: 1, ..iteration.acted };
        watch.note(request, assembler, system.forces, acted);
        Ok(())
    }

    fn work(&self, _: &[f64], residual: &[f64], way: &[f64]) -> f64 {
        supports::dot(residual, way)
    }
}

/// Assembles the tangent of all equations as at the first linear solve of an increment.
fn assemble_all(trial: Trial, u: &[f64], work: &mut Workspace) -> Option<()> {
    let Workspace { assembler, iteration, system, .. } = work;
    iteration.start_increment();
    assembler.residual(trial, u, system).ok()?;
    let responses = iteration.respond(assembler, trial, u, Request::Tangent).ok()?;
    assembler.assemble(trial, u, responses, Request::Tangent, system).ok()?;
    iteration.note(assembler.model(), u, trial.old);
    Some(())
}
