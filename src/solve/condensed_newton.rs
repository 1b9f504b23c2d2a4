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

use crate::equations::condensed::{CondensedEquations, ContactNodes, depends_on_length, is_linear};
use crate::equations::sums::TrialFailure;
use crate::equations::{Assembler, Trial};
use crate::linear::memory::available_memory;
use crate::linear::system::{Request, System};
use crate::linear::{Condensation, Condensed, Eliminated, Forwarded, HalvedLu, Pattern};
use crate::model::boundary::{Absorber, Dashpot, Spring};
use crate::model::scheme::Scheme;
use crate::model::support::Direction;
use crate::model::{Damping, Model, Step};

/// Upper bound of the memory of condensed matrices of all increment lengths [bytes].
pub const MOST_MEMORY: usize = 2 << 30;

/// Speed of the operations of a dense LU relative to those of a multifrontal elimination.
const DENSE: f64 = 3.0;

/// Bodies of a model condensed on the nodes at its contacts.
pub struct CondensedNewton {
    /// contact nodes
    pub nodes: ContactNodes,
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
    rungs: Vec<(u64, Option<Arc<Rung>>)>,
    /// solver of the condensed equations
    pub solver: HalvedLu,
    /// condensed equations
    pub condensed: System,
}

/// The bodies condensed for one length of increments.
pub struct Rung {
    /// condensed on the contact nodes
    pub bodies: Condensed,
    /// condensed further on the equations that vary
    pub eliminated: Option<Eliminated>,
    /// First unknowns of the parts of S that are not coupled, if LU of all equations pays
    pub parts: Option<Vec<usize>>,
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
        let (constants, rungs, solver) = (None, Vec::new(), HalvedLu::default());
        Some(Self { nodes, whole, bodies, system, pattern, condensation, constants, rungs, solver, condensed })
    }

    /// Returns the bodies condensed for an increment; `None` if the step has nonlinearities other than contact, or a pivot
    /// vanished because a body is constrained by contact only, at eliminated nodes.
    ///
    /// # Errors
    /// Returns [`TrialFailure`] if a load has no finite value.
    pub fn bodies(&mut self, model: &Model, trial: Trial) -> Result<Option<Arc<Rung>>, TrialFailure> {
        if !is_linear(model, trial.step) {
            return Ok(None);
        }
        let constants = Constants::of(model, trial.step);
        if self.constants.as_ref() != Some(&constants) {
            self.constants = Some(constants);
            self.rungs.clear();
        }
        let varies = depends_on_length(model, trial.step);
        let dt = if varies { without_jitter(trial.dt) } else { trial.dt };
        let length = if varies { dt.to_bits() } else { 0 };
        let rung = match self.rungs.iter().position(|(own, _)| *own == length) {
            Some(k) => self.rungs.remove(k).1,
            None => self.condense(Trial { dt, ..trial })?,
        };
        self.rungs.push((length, rung.clone()));
        Ok(rung)
    }

    /// Condenses the bodies, replacing the least recently used lengths if memory requires it.
    fn condense(&mut self, trial: Trial) -> Result<Option<Arc<Rung>>, TrialFailure> {
        let one = self.condensation.memory() + Eliminated::memory(self.nodes.nodes.len());
        let free = available_memory().map_or(MOST_MEMORY, |free| (free / 2).min(MOST_MEMORY));
        let held = self.rungs.len() * one;
        // Memory already used counts as available.
        let most = (held + free).min(MOST_MEMORY) / one.max(1);
        self.rungs.drain(..(self.rungs.len() + 1).saturating_sub(most.max(1)));
        let Self { nodes, whole, bodies, system, pattern, condensation, .. } = self;
        bodies.without_contacts(trial, &trial.old.displacement, Request::Tangent, system)?;
        let matrix = nodes.counted(bodies.model(), trial.step, &system.tangent, pattern);
        let rung = |condensed: Condensed| {
            let eliminated = nodes.eliminated(bodies.model(), trial.step, &condensed);
            let parts = whole.then(|| condensed.parts());
            Arc::new(Rung { bodies: condensed, eliminated, parts })
        };
        Ok(condensation.condense(&matrix).map(rung))
    }
}

/// Δt rounded to eight digits: as a difference of two times it has their round-off, and no two increments are equal.
/// Matrices may be shared, since their solution is checked by the equations of the increment itself.
fn without_jitter(dt: f64) -> f64 {
    const UNIT: u64 = 1 << 25;
    f64::from_bits((dt.to_bits() + UNIT / 2) & !(UNIT - 1))
}

/// Condensed equations of an increment, starting from the displacement `u`, and the data to recover all displacements.
pub struct Round<'a> {
    /// ρ
    pub equations: CondensedEquations<'a>,
    bodies: &'a Condensed,
    forwarded: Forwarded,
}

impl<'a> Round<'a> {
    /// Starts a round at `u`.
    ///
    /// # Errors
    /// Returns [`TrialFailure`] if a load has no finite value.
    pub fn begin(
        nodes: &'a ContactNodes,
        bodies: &'a Condensed,
        trial: Trial,
        u: &[f64],
        assembler: &mut Assembler,
        system: &mut System,
    ) -> Result<Self, TrialFailure> {
        assembler.without_contacts(trial, u, Request::Residual, system)?;
        let forwarded = bodies.forward(&nodes.balanced(assembler.model(), trial.step, &system.residual));
        let constant = forwarded.right.clone();
        let equations = CondensedEquations::new(nodes, bodies, trial, u, constant, assembler, system);
        Ok(Self { equations, bodies, forwarded })
    }

    /// Displacements of all nodes for given ones of the contact nodes: A (u − u₀) = −r at all other nodes.
    pub fn follow(&self, nodes: &ContactNodes, u: &mut [f64], x: &[f64]) {
        let way: Vec<f64> = nodes.gather(u).iter().zip(x).map(|(start, x)| start - x).collect();
        let all = nodes.resolved(self.bodies.backward(&self.forwarded, &way));
        u.iter_mut().zip(all).for_each(|(u, way)| *u -= way);
        nodes.scatter(x, u);
    }
}
