//! Neighbours of a run: models that differ from its own by a small change of one parameter, and follow it increment by increment.
//!
//! ```text
//! dQ/dθ = (Q(θ + ε) − Q(θ − ε))/(2ε) + O(ε²)        by a neighbour on either side
//! ```
//!
//! A neighbour makes the increments that the run has accepted, as they were, and as many passes of the augmented Lagrangian with the
//! same penalties: the derivative is that of the discrete run. Everything else is its own, by the ordinary equations and
//! laws: the states of bodies and contact points, starts of steps, accelerations, energies. It is solved with the tangent of the run
//! ([`crate::solve::neighbour`]), from a solution beside it and its distance from that so far, continued at its pace. That solution is
//! not the one of the run, which is as inexact as its tolerance allows, but of a neighbour with the same value.

use std::sync::Arc;

use super::beginning::begin;
use super::increment::arrive;
use crate::equations::Trial;
use crate::linear::Multifrontal;
use crate::model::state::State;
use crate::model::{Model, Step};
use crate::solve::equilibrium::multiply;
use crate::solve::failure::IncrementFailure;
use crate::solve::neighbour::{Tangent, beside};
use crate::solve::{Pass, Workspace};

/// An accepted increment of the run.
#[derive(Clone, Copy)]
pub struct Lead<'a> {
    /// its step
    pub step: &'a Step,
    /// number of the step
    pub number: usize,
    /// planned and actual ends of the steps that a reaction has ended [T]
    pub ended: &'a [[f64; 2]],
    /// state at its start
    pub old: &'a State,
    /// state at its end
    pub new: &'a State,
    /// its passes
    pub passes: &'a [Pass],
}

impl Lead<'_> {
    /// The increment of a state and step under the penalties of a pass, at the time at which the scheme requires equilibrium.
    fn trial<'a>(&self, old: &'a State, step: &'a Step, pass: &Pass) -> Trial<'a> {
        Trial { stiffening: pass.stiffening, ..self.whole(old, step).ahead() }
    }

    fn whole<'a>(&self, old: &'a State, step: &'a Step) -> Trial<'a> {
        Trial::new(old, step, self.new.time, self.new.time - old.time)
    }
}

/// A model that follows a run.
pub struct Neighbour {
    /// its model
    pub model: Arc<Model>,
    /// state at the start of the last increment
    pub old: State,
    /// accepted state
    pub state: State,
    /// number of the last step that it began
    pub begun: Option<usize>,
    /// that step, once needed
    step: Option<Step>,
    work: Workspace,
}

/// Solution of a neighbour in a pass.
struct OnItsWay {
    /// The state at the start of the increment, with the multipliers of the pass
    old: State,
    /// u of the neighbour − u of the run at the last pass, or as expected [L]
    distance: Vec<f64>,
    u: Vec<f64>,
}

impl Neighbour {
    /// Creates a neighbour in the initial state of its model.
    pub fn new(model: Arc<Model>) -> Self {
        let state = model.initial_state();
        let work = Workspace::new(&model, Box::<Multifrontal>::default());
        Self { old: state.clone(), state, begun: None, step: None, work, model }
    }

    /// Goes on from a saved state, in the step with this number.
    pub fn go_on(&mut self, state: State, begun: Option<usize>) {
        (self.state, self.begun, self.step) = (state, begun, None);
    }

    /// Begins the step of the increment if it is a new one. It starts beside this state of another neighbour, or beside the run.
    fn set_out(&mut self, lead: &Lead, beside: Option<&State>) -> Result<OnItsWay, IncrementFailure> {
        let Self { model, state, begun, step, work, .. } = self;
        let new = *begun != Some(lead.number);
        if new || step.is_none() {
            *step = Some(model.steps[lead.number].clone().after(lead.ended));
            *begun = Some(lead.number);
        }
        if let (true, Some(step)) = (new, step) {
            *state = begin(model, step, state, work)?;
        }
        let other = beside.unwrap_or(lead.old);
        let mut distance: Vec<f64> =
            state.displacement.iter().zip(&other.displacement).map(|(own, other)| own - other).collect();
        if let (Some(own), Some(other)) = (&state.last_increment, &other.last_increment) {
            let share = (lead.new.time - lead.old.time) / own.dt;
            let ways = own.displacement.iter().zip(&other.displacement);
            distance.iter_mut().zip(ways).for_each(|(distance, (own, other))| *distance += share * (own - other));
        }
        Ok(OnItsWay { old: state.clone(), distance, u: Vec::new() })
    }

    /// Solves a pass, beside the solution `other`.
    fn pass(
        &mut self,
        lead: &Lead,
        pass: &Pass,
        other: &[f64],
        tangent: &mut Tangent,
        mut way: OnItsWay,
    ) -> Result<OnItsWay, IncrementFailure> {
        let Self { model, step, work, .. } = self;
        let Some(step) = step else { return Ok(way) };
        if !way.u.is_empty() {
            multiply(model, &work.assembler.evaluation.contacts, &mut way.old);
        }
        work.assembler.couple(&pass.coupling);
        let start = other.iter().zip(&way.distance).map(|(u, distance)| u + distance).collect();
        way.u = beside(model, lead.trial(&way.old, step, pass), start, tangent, work)?;
        way.distance = way.u.iter().zip(other).map(|(own, other)| own - other).collect();
        Ok(way)
    }

    /// Accepts the solution of the last pass.
    fn accept(&mut self, lead: &Lead, way: OnItsWay) -> Result<(), IncrementFailure> {
        let Self { model, state, step, work, .. } = self;
        let Some(step) = step else { return Ok(()) };
        let new = arrive(model, lead.whole(state, step), way.u, work)?;
        self.old = std::mem::replace(&mut self.state, new);
        Ok(())
    }
}

/// Lets neighbours of a run make the increment that it has accepted, all with the same tangents. One with the value of the run itself goes
/// ahead: it is solved as exactly as they are, and they start beside it. A neighbour that fails stays behind; none can go on if the first
/// does.
pub fn follow(
    lead: &Lead,
    tangent: &mut Tangent,
    middle: &mut Neighbour,
    neighbours: &mut [&mut Neighbour],
) -> Vec<Result<(), IncrementFailure>> {
    match ahead(lead, tangent, middle, neighbours) {
        Ok(followed) => followed,
        Err(failure) => neighbours.iter().map(|_| Err(failure.clone())).collect(),
    }
}

fn ahead(
    lead: &Lead,
    tangent: &mut Tangent,
    middle: &mut Neighbour,
    neighbours: &mut [&mut Neighbour],
) -> Result<Vec<Result<(), IncrementFailure>>, IncrementFailure> {
    let mut first = middle.set_out(lead, None)?;
    let mut ways: Vec<Result<OnItsWay, IncrementFailure>> =
        neighbours.iter_mut().map(|neighbour| neighbour.set_out(lead, Some(&middle.state))).collect();
    let mut old = lead.old.clone();
    for (k, pass) in lead.passes.iter().enumerate() {
        if k > 0 {
            multiply(&middle.model, tangent.contacts(), &mut old);
        }
        tangent.of(lead.trial(&old, lead.step, pass), pass)?;
        first = middle.pass(lead, pass, &pass.displacement, tangent, first)?;
        let each = neighbours.iter_mut().zip(ways);
        ways = each.map(|(neighbour, way)| neighbour.pass(lead, pass, &first.u, tangent, way?)).collect();
    }
    middle.accept(lead, first)?;
    Ok(neighbours.iter_mut().zip(ways).map(|(neighbour, way)| neighbour.accept(lead, way?)).collect())
}
