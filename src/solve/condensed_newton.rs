//! Increments of linear bodies: Newton's method on the nodes at contacts alone.
//!
//! The bodies are condensed on these nodes ([`crate::equations::condensed`]), once for every length of increments, and follow
//! when a solution is found there. Whether it is one is for the residual of all equations to say, as everywhere: what is
//! accepted does not depend on how it was found. If it says no, another round starts from there, and after a few the increment
//! is left to Newton's method on all equations. Switch `condense`; `aid_condense` is 1 in iterations on the contacts.
//!
//! That way is taken where it costs less: where a dense LU of the nodes at contacts takes no more than
//! three times the operations of a factorization of the bodies: they are that much faster; and where most nodes are not
//! at contacts. Where only half of the equations on the contacts vary, it may be that LU which takes so little, and an increment
//! in which more of them vary is left to all equations if LU of the whole takes too much.
//! All this follows from the model, the step and the iterates, never from what is kept. Condensed matrices are kept
//! for all lengths as long as they take no more than [`MOST_MEMORY`] and half of what is free; those that were used last stay.

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

/// Most bytes that condensed matrices of all lengths of increments take.
pub const MOST_MEMORY: usize = 2 << 30;

/// Speed of the operations of a dense LU relative to those of a multifrontal elimination.
const DENSE: f64 = 3.0;

/// The bodies of a model condensed on the nodes at its contacts.
pub struct CondensedNewton {
    /// the nodes
    pub nodes: ContactNodes,
    /// Whether LU of all their equations is worth it, not only of the half that varies while nothing opens
    pub whole: bool,
    /// The equations without contact
    bodies: Assembler,
    system: System,
    /// The pattern with all contact nodes coupled
    pattern: Arc<Pattern>,
    condensation: Condensation,
    /// What the condensed matrices follow from but for the length of increments
    constants: Option<Constants>,
    /// Condensed matrices by the bits of Δt, the last used last; none where a pivot vanished
    rungs: Vec<(u64, Option<Arc<Rung>>)>,
    /// solves the condensed equations
    pub solver: HalvedLu,
    /// these equations
    pub condensed: System,
}

/// The bodies condensed for one length of increments.
pub struct Rung {
    /// on the nodes at contacts
    pub bodies: Condensed,
    /// on what varies there
    pub eliminated: Option<Eliminated>,
}

/// Everything that a step says of the constant part of its equations.
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
    /// The interface of a model whose increments are worth condensing.
    pub fn new(model: &Arc<Model>) -> Option<Self> {
        let condenses = |step: &Step| !matches!(step.scheme, Scheme::Explicit { .. }) && is_linear(model, step);
        if model.contacts.is_empty() || !model.aids.condense || !model.steps.iter().any(condenses) {
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

    /// The bodies condensed for an increment; none if the step is not linear but for contact, or a pivot vanished: nothing but
    /// contact may hold a body by its eliminated nodes.
    ///
    /// # Errors
    /// [`TrialFailure`] when a load has no value.
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

    /// Condense the bodies, in place of those lengths of increments that were used longest ago if memory asks for it.
    fn condense(&mut self, trial: Trial) -> Result<Option<Arc<Rung>>, TrialFailure> {
        let one = self.condensation.memory() + Eliminated::memory(self.nodes.nodes.len());
        let free = available_memory().map_or(MOST_MEMORY, |free| (free / 2).min(MOST_MEMORY));
        let held = self.rungs.len() * one;
        // What is held counts as used already.
        let most = (held + free).min(MOST_MEMORY) / one.max(1);
        self.rungs.drain(..(self.rungs.len() + 1).saturating_sub(most.max(1)));
        let Self { nodes, bodies, system, pattern, condensation, .. } = self;
        bodies.assemble(trial, &trial.old.displacement, &[], Request::Tangent, system)?;
        let matrix = nodes.counted(bodies.model(), trial.step, &system.tangent, pattern);
        let rung = |condensed| {
            let eliminated = nodes.eliminated(bodies.model(), trial.step, &condensed);
            Arc::new(Rung { bodies: condensed, eliminated })
        };
        Ok(condensation.condense(&matrix).map(rung))
    }
}

/// Δt to eight digits: the difference of two times, it has the last digits of these, and no two increments are quite alike. The
/// matrices may: their solution is judged by the equations of the increment itself.
fn without_jitter(dt: f64) -> f64 {
    const UNIT: u64 = 1 << 25;
    f64::from_bits((dt.to_bits() + UNIT / 2) & !(UNIT - 1))
}

/// The condensed equations of an increment from the displacement `u` on, and what leads from their solution back to the bodies.
pub struct Round<'a> {
    /// ρ
    pub equations: CondensedEquations<'a>,
    bodies: &'a Condensed,
    forwarded: Forwarded,
}

impl<'a> Round<'a> {
    /// Begin at `u`.
    ///
    /// # Errors
    /// [`TrialFailure`] when a load has no value.
    pub fn begin(
        nodes: &'a ContactNodes,
        bodies: &'a Condensed,
        trial: Trial,
        u: &[f64],
        assembler: &mut Assembler,
        system: &mut System,
    ) -> Result<Self, TrialFailure> {
        assembler.assemble(trial, u, &[], Request::Residual, system)?;
        let forwarded = bodies.forward(&nodes.balanced(assembler.model(), trial.step, &system.residual));
        let constant = forwarded.right.clone();
        let equations = CondensedEquations::new(nodes, bodies, trial, u, constant, assembler, system);
        Ok(Self { equations, bodies, forwarded })
    }

    /// All displacements that go with those of the nodes at contacts: A (u − u₀) = −r but for these.
    pub fn follow(&self, nodes: &ContactNodes, u: &mut [f64], x: &[f64]) {
        let way: Vec<f64> = nodes.gather(u).iter().zip(x).map(|(start, x)| start - x).collect();
        let all = nodes.resolved(self.bodies.backward(&self.forwarded, &way));
        u.iter_mut().zip(all).for_each(|(u, way)| *u -= way);
        nodes.scatter(x, u);
    }
}
