//! Increments of linear bodies: Newton's method on the nodes at contacts alone.
//!
//! The bodies are condensed on these nodes ([`crate::equations::condensed`]), once for every length of increments, and follow
//! when a solution is found there. Whether it is one is for the residual of all equations to say, as everywhere: what is
//! accepted does not depend on how it was found. If it says no, another round starts from there, and after a few the increment
//! is left to Newton's method on all equations. Switch `condense`; `aid_condense` is 1 in iterations on the contacts.
//!
//! That way is taken where it costs less: where a dense LU of the nodes at contacts takes no more than
//! three times the operations of a factorization of the bodies: they are that much faster; and where most nodes are not
//! at contacts. It follows from the model and the step, never from what is kept. Condensed matrices are kept
//! for all lengths as long as they take no more than [`MOST_MEMORY`] and half of what is free; those that were used last stay.

use std::sync::Arc;

use crate::equations::condensed::{CondensedEquations, ContactNodes, is_linear};
use crate::equations::failure::TrialFailure;
use crate::equations::{Assembler, Coupling, Trial};
use crate::linear::memory::available_memory;
use crate::linear::system::{Request, System};
use crate::linear::{Condensation, Condensed, DenseLu};
use crate::model::boundary::{Absorber, Dashpot, Spring};
use crate::model::scheme::Scheme;
use crate::model::{Model, Step};

/// Most bytes that condensed matrices of all lengths of increments take.
pub const MOST_MEMORY: usize = 2 << 30;

/// How much faster the operations of a dense LU are than those of an elimination front by front.
const DENSE: f64 = 3.0;

/// The bodies of a model condensed on the nodes at its contacts.
pub struct Interface {
    /// the nodes
    pub nodes: ContactNodes,
    /// The equations without contact, all contact nodes coupled
    bodies: Assembler,
    system: System,
    condensation: Condensation,
    /// What the condensed matrices follow from but for the length of increments
    constants: Option<Constants>,
    /// Condensed matrices by the bits of Δt, the last used last; none where a pivot vanished
    rungs: Vec<(u64, Option<Arc<Condensed>>)>,
    /// solves the condensed equations
    pub solver: DenseLu,
    /// these equations
    pub condensed: System,
}

/// Everything that a step says of the constant part of its equations.
#[derive(PartialEq)]
struct Constants {
    scheme: Scheme,
    supports: Vec<usize>,
    /// Stiffnesses of springs, and coefficients of dashpots
    at_dofs: [Vec<(usize, f64)>; 2],
    absorbers: Vec<(usize, [f64; 4])>,
}

impl Constants {
    fn of(step: &Step) -> Self {
        let springs = step.loads.springs.iter().map(|&Spring { dof, stiffness, .. }| (dof, stiffness)).collect();
        let dashpots = step.loads.dashpots.iter().map(|&Dashpot { dof, coefficient, .. }| (dof, coefficient)).collect();
        let absorber = |Absorber { node, coefficients: c }: &Absorber| (*node, [c[0], c[1], c[2], c[3]]);
        Self {
            scheme: step.scheme,
            supports: step.supports.iter().map(|support| support.dof).collect(),
            at_dofs: [springs, dashpots],
            absorbers: step.loads.absorbers.iter().map(absorber).collect(),
        }
    }
}

impl Interface {
    /// The interface of a model whose increments are worth condensing.
    pub fn new(model: &Arc<Model>) -> Option<Self> {
        if model.contacts.is_empty() || !model.steps.iter().any(|step| is_linear(model, step)) {
            return None;
        }
        let nodes = ContactNodes::new(model);
        let mut bodies = Assembler::new(model);
        let size = 2.0 * nodes.nodes.len() as f64;
        let elimination = Condensation::new(bodies.system().tangent.pattern, &[]).ok()?.work();
        let most = 2 * nodes.nodes.len() > model.mesh.nodes.len();
        if most || 2.0 / 3.0 * size.powi(3) > DENSE * elimination {
            return None;
        }
        bodies.couple(&Arc::new(Coupling::of(nodes.nodes.clone())));
        let system = bodies.system();
        let condensation = Condensation::new(system.tangent.pattern.clone(), &nodes.nodes).ok()?;
        let condensed = nodes.system();
        let (constants, rungs, solver) = (None, Vec::new(), DenseLu::default());
        Some(Self { nodes, bodies, system, condensation, constants, rungs, solver, condensed })
    }

    /// The bodies condensed for an increment; none if the step is not linear but for contact, or a pivot vanished: nothing but
    /// contact may hold a body by its eliminated nodes.
    ///
    /// # Errors
    /// [`TrialFailure`] when a load has no value.
    pub fn bodies(&mut self, model: &Model, trial: Trial) -> Result<Option<Arc<Condensed>>, TrialFailure> {
        if !is_linear(model, trial.step) {
            return Ok(None);
        }
        let constants = Constants::of(trial.step);
        if self.constants.as_ref() != Some(&constants) {
            self.constants = Some(constants);
            self.rungs.clear();
        }
        let dt = if trial.step.scheme.is_dynamic() { without_jitter(trial.dt) } else { trial.dt };
        let length = if trial.step.scheme.is_dynamic() { dt.to_bits() } else { 0 };
        let rung = match self.rungs.iter().position(|(own, _)| *own == length) {
            Some(k) => self.rungs.remove(k).1,
            None => self.condense(Trial { dt, ..trial })?,
        };
        self.rungs.push((length, rung.clone()));
        Ok(rung)
    }

    /// Condense the bodies, in place of those lengths of increments that were used longest ago if memory asks for it.
    fn condense(&mut self, trial: Trial) -> Result<Option<Arc<Condensed>>, TrialFailure> {
        let one = self.condensation.memory();
        let free = available_memory().map_or(MOST_MEMORY, |free| (free / 2).min(MOST_MEMORY));
        let held = self.rungs.len() * one;
        // What is held counts as used already.
        let most = (held + free).min(MOST_MEMORY) / one.max(1);
        self.rungs.drain(..(self.rungs.len() + 1).saturating_sub(most.max(1)));
        let Self { bodies, system, condensation, .. } = self;
        bodies.assemble(trial, &trial.old.displacement, &[], Request::Tangent, system)?;
        Ok(condensation.condense(&system.tangent).map(Arc::new))
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
    forwarded: crate::linear::Forwarded,
}

impl<'a> Round<'a> {
    /// Begin at `u`.
    ///
    /// # Errors
    /// [`TrialFailure`] when a load has no value.
    pub fn begin(
        (nodes, bodies): (&'a ContactNodes, &'a Condensed),
        trial: Trial,
        u: &[f64],
        assembler: &mut Assembler,
        system: &mut System,
    ) -> Result<Self, TrialFailure> {
        assembler.assemble(trial, u, &[], Request::Residual, system)?;
        let forwarded = bodies.forward(&system.residual);
        let constant = forwarded.right.clone();
        let equations = CondensedEquations::new((nodes, bodies), trial, u, constant, (assembler, system));
        Ok(Self { equations, bodies, forwarded })
    }

    /// All displacements that go with those of the nodes at contacts: A (u − u₀) = −r but for these.
    pub fn follow(&self, nodes: &ContactNodes, u: &mut [f64], x: &[f64]) {
        let way: Vec<f64> = nodes.gather(u).iter().zip(x).map(|(start, x)| start - x).collect();
        let all = self.bodies.backward(&self.forwarded, &way);
        u.iter_mut().zip(all).for_each(|(u, way)| *u -= way);
        nodes.scatter(x, u);
    }
}
