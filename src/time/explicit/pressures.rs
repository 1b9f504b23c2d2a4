//! Pressures of water that flows through bodies, in explicit increments.
//!
//! Central differences know the displacements u₁ at the end of an increment before any force. There the balances (4) of `equations/pore_flow.rs` are
//! equations of the pressures alone, linear but for what switches:
//!
//! ```text
//! r(u₁, p₁) = 0,   −∂r/∂p = s (S + P + Δt/β (H + outlets + what passes between bodies)) s        symmetric, positive definite             (1)
//! ```
//! They are solved for p₁, with which the forces are evaluated then. The volumes that elements give off count in full, so that the stiffness against a
//! motion is never more than that of bodies whose water is trapped, element by element:
//!
//! ```text
//! K_e + B_eᵀ (S_e + P_e)⁻¹ B_e,   B_e = ∫ b N ∂J/∂u dV                                                                                (2)
//! ```
//! By it the stable increment is bounded; the flow, however fast, does not shorten it. (2) holds as ½ bᵀ S⁻¹ b = max over p of (pᵀ b − ½ pᵀ S p), and the largest sum is no more than the
//! sum of the largest of each element.

use std::sync::Arc;

use super::Explicit;
use crate::equations::{Assembler, Trial};
use crate::linear::system::Request;
use crate::linear::{LinearSolver, Multifrontal, Pattern, SparseMatrix, norm};
use crate::model::pore_flow::{DrainKind, PoreFlow};
use crate::model::{Model, State, Step};
use crate::solve::failure::IncrementFailure;
use crate::solve::newton::NewtonFailure;

/// What is left of the balances, over the volumes that cancel in them [-]
const BALANCED: f64 = 1e-12;

/// Change of pressures that is round-off, over the largest pressure [-]
const ROUND_OFF: f64 = 1e-14;

/// Most corrections of the pressures of an increment: they converge at once, but where outlets switch.
const MOST_CORRECTIONS: usize = 30;

/// Equal increments differ by round-off; bits of a length by which factors are those of another increment.
const SIGNIFICANT: u32 = 20;

/// The factors of (1). A clone has none: it makes its own, to the same bits.
#[derive(Default)]
pub(super) struct PressureSolver {
    solver: Multifrontal,
    block: Option<PressureBlock>,
    /// Δt/β of the factors, if the matrix depends on nothing else
    span: Option<f64>,
}

impl Clone for PressureSolver {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// The rows and columns of the pressures in a matrix of all nodes.
struct PressureBlock {
    all: Arc<Pattern>,
    /// Place of each value in that of all nodes
    places: Vec<usize>,
    matrix: SparseMatrix,
}

impl PressureBlock {
    fn of(all: &Arc<Pattern>, flow: &PoreFlow) -> Self {
        let (first, count) = (flow.first, flow.count());
        let neighbours = |node: usize| all.neighbours(first + node).iter().filter(|other| **other >= first);
        let pairs: Vec<[usize; 2]> =
            (0..count).flat_map(|node| neighbours(node).map(move |other| [node, other - first])).collect();
        let pattern = Pattern::new(count, pairs.iter().map(|pair| &pair[..]))
            .symmetric_but(vec![false; count])
            .with_pressures(0..count);
        let mut places = vec![0; pattern.values()];
        for [row, column] in pairs.into_iter().flat_map(|[a, b]| [[a, b], [b, a]]) {
            let (own, whole) = (pattern.coupled(row, column), all.coupled(first + row, first + column));
            for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                places[own.value(i, j)] = whole.value(i, j);
            }
        }
        Self { all: all.clone(), places, matrix: SparseMatrix::zero(Arc::new(pattern)) }
    }

    fn take(&mut self, all: &SparseMatrix) {
        self.matrix.values.iter_mut().zip(&self.places).for_each(|(own, place)| *own = all.values[*place]);
    }
}

impl PressureSolver {
    /// Factorizes the block of the pressures.
    fn factorize(&mut self, all: &SparseMatrix, flow: &PoreFlow) -> Result<(), IncrementFailure> {
        let block = self.block.take().filter(|block| Arc::ptr_eq(&block.all, &all.pattern));
        let mut block = block.unwrap_or_else(|| PressureBlock::of(&all.pattern, flow));
        block.take(all);
        let done = self.solver.factorize(&block.matrix);
        self.block = Some(block);
        done.map_err(|failure| IncrementFailure::Newton(NewtonFailure::Linear(failure)))
    }
}

/// Number of nodes that move: those behind stand for pressures.
pub(super) fn moving(model: &Model) -> usize {
    model.flow.as_ref().map_or(model.mesh.nodes.len(), |flow| flow.first)
}

/// Whether (1) depends on more than Δt: on deformed bodies, on pressures, or on what has come into contact.
fn varies(model: &Model, flow: &PoreFlow, step: &Step) -> bool {
    let bodies = flow.elements.iter().any(|wet| !wet.is_linear || wet.void_ratio.is_some() || wet.suction.is_some());
    let seeps = step.drains.iter().any(|drain| matches!(drain.kind, DrainKind::Seeps(_)));
    bodies || seeps || model.contacts.iter().any(|pair| pair.seam.is_some())
}

/// A length without its last bits.
fn rounded(dt: f64) -> f64 {
    f64::from_bits(dt.to_bits() >> SIGNIFICANT << SIGNIFICANT)
}

impl Explicit {
    /// Evaluates the forces at the predicted displacements, with the pressures that balance the water there.
    ///
    /// # Errors
    /// Returns [`IncrementFailure`] if they cannot be evaluated, or the balances are not met.
    pub(super) fn forces_with_pressures(
        &mut self,
        time: f64,
        velocity: Option<&[f64]>,
        state: &State,
        assembler: &mut Assembler,
    ) -> Result<(), IncrementFailure> {
        let (model, step) = (&*self.model.clone(), &*self.step.clone());
        let trial = Trial { settles: false, ..Trial::new(state, step, time, time - state.time) };
        let Some(flow) = &model.flow else {
            return assembler.forces(trial, &self.displacement, velocity).map_err(IncrementFailure::Start);
        };
        let varies = varies(model, flow, step);
        for _ in 0..MOST_CORRECTIONS {
            self.factorize(flow, varies, trial, assembler)?;
            let corrections = self.corrections(assembler);
            self.correct(flow, &corrections);
            // Without what switches the first correction ends it; where round-off is left of large volumes, another one.
            for _ in 0..2 {
                assembler.forces(trial, &self.displacement, velocity).map_err(IncrementFailure::Start)?;
                let [left, sizes] = assembler.balanced();
                let is_balanced = norm(left) <= BALANCED * norm(sizes);
                let corrections = if is_balanced { Vec::new() } else { self.corrections(assembler) };
                if is_balanced || self.is_round_off(flow, &corrections) {
                    assembler.evaluation.force[flow.dof(0)..].fill(0.0);
                    return Ok(());
                }
                self.correct(flow, &corrections);
            }
        }
        Err(IncrementFailure::Newton(NewtonFailure::TooManyIterations { residual: 1.0, iterations: MOST_CORRECTIONS }))
    }

    /// Evaluates the balances, and the factors of (1) unless those of an increment as long as this serve.
    fn factorize(
        &mut self,
        flow: &PoreFlow,
        varies: bool,
        trial: Trial,
        assembler: &mut Assembler,
    ) -> Result<(), IncrementFailure> {
        let at = |trial: Trial, request, explicit: &Self, assembler: &mut Assembler| {
            assembler.balances(trial, &explicit.displacement, request).map_err(IncrementFailure::Start)
        };
        if varies {
            let tangent = at(trial, Request::Tangent, self, assembler)?;
            return tangent.map_or(Ok(()), |tangent| self.pressures.factorize(&tangent, flow));
        }
        let like = Trial { dt: rounded(trial.dt), ..trial };
        let span = Assembler::span_of_water(like);
        if self.pressures.span != Some(span) {
            if let Some(tangent) = at(like, Request::Tangent, self, assembler)? {
                self.pressures.factorize(&tangent, flow)?;
            }
            self.pressures.span = Some(span);
        }
        at(trial, Request::Residual, self, assembler).map(drop)
    }

    /// Corrections of the pressures from the balances as last evaluated.
    fn corrections(&mut self, assembler: &Assembler) -> Vec<f64> {
        let mut corrections = assembler.balanced()[0].to_vec();
        self.pressures.solver.solve(&mut corrections);
        corrections
    }

    fn correct(&mut self, flow: &PoreFlow, corrections: &[f64]) {
        self.displacement[flow.dof(0)..].iter_mut().zip(corrections).for_each(|(p, correction)| *p -= correction);
    }

    /// Whether corrections do not change pressures.
    fn is_round_off(&self, flow: &PoreFlow, corrections: &[f64]) -> bool {
        let changes =
            corrections.iter().step_by(2).zip(&flow.scales).map(|(correction, scale)| (scale * correction).abs());
        let sizes = (0..flow.count()).map(|k| {
            let risen = flow.scales[k] * self.displacement[flow.dof(k)];
            flow.initial[k].abs().max(risen.abs())
        });
        changes.fold(0.0, f64::max) <= ROUND_OFF * sizes.fold(0.0, f64::max)
    }

    /// Writes the rates of the pressures in the last increment, by which the next one foresees them; `old` are the displacements before it.
    pub(super) fn note_rates(&self, old: &[f64], state: &mut State) {
        let first = 2 * moving(&self.model);
        let State { displacement, velocity, acceleration, dt, .. } = state;
        acceleration[first..].fill(0.0);
        let ways = displacement[first..].iter().zip(&old[first..]);
        velocity[first..].iter_mut().zip(ways).for_each(|(rate, (new, old))| *rate = (new - old) / *dt);
    }
}
