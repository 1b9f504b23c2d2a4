//! Neighbours of a run: models that differ from its own by a small change of one parameter, and follow it increment by increment.
//!
//! ```text
//! dQ/dθ = (Q(θ + ε) − Q(θ − ε))/(2ε) + O(ε²)        by a neighbour on either side
//! ```
//!
//! A neighbour makes the increments that the run has accepted, as they were, and as many passes of the augmented Lagrangian with the
//! same penalties: the derivative is that of the discrete run. Everything else is its own, by the ordinary equations and
//! laws: the states of bodies and contact points, starts of steps, accelerations, energies. It is solved with the tangent of the run
//! ([`crate::solve::neighbour`]), from the solution of the run and its distance from that so far, continued at its pace.
//!
//! Water that flows along contacts does so in the steps of the run's, by the numbers of the neighbour; equilibrium and flow take turns until they
//! agree as they do in the run ([`crate::solve::conduits`]).

use std::sync::Arc;

use rayon::prelude::*;

use super::beginning::begin;
use super::increment::arrive;
use crate::equations::Trial;
use crate::linear::Multifrontal;
use crate::model::{Model, State, Step};
use crate::solve::conduits::{Arrived, NeighbourWater, RunWater};
use crate::solve::equilibrium::Found;
use crate::solve::neighbour::{NeighbourProblem, Tangent, solve_neighbours};
use crate::solve::passes::multiply;
use crate::solve::{IncrementFailure, Pass, Workspace};

/// An accepted increment of the run.
#[derive(Clone, Copy)]
pub struct BaseIncrement<'a> {
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

impl BaseIncrement<'_> {
    /// The increment of a state and step under the penalties of a pass, at the time at which the scheme requires equilibrium.
    fn trial<'a>(&self, old: &'a State, step: &'a Step, pass: &Pass) -> Trial<'a> {
        Trial { stiffening: pass.stiffening, ..self.whole(old, step).ahead() }
    }

    fn whole<'a>(&self, old: &'a State, step: &'a Step) -> Trial<'a> {
        Trial::new(old, step, self.new.time, self.new.time - old.time)
    }

    /// Its water along contacts.
    fn water(&self) -> RunWater<'_> {
        let histories = self.passes.last().map_or(&[][..], |pass| &pass.water);
        RunWater { histories, states: [self.old, self.new] }
    }
}

/// A model that follows a run.
pub struct Neighbour {
    /// its model
    pub model: Arc<Model>,
    /// Whether its parameter acts on no body, and no water in their pores
    spares_bodies: bool,
    /// k of its parameter θ + k ε
    offset: f64,
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

/// A neighbour within an increment.
struct InProgress {
    /// The state at the start of the increment with the water and multipliers of the pass
    old: Option<State>,
    /// u at the last pass, or as expected, and that of the run [L]
    u: Vec<f64>,
    of_run: Vec<f64>,
    water: NeighbourWater,
    /// Water along contacts at the end of the increment, once it agrees with the equilibrium
    arrived: Option<Arrived>,
}

/// Whether neighbours have not arrived yet.
fn are_in_progress(ways: &Result<Vec<InProgress>, IncrementFailure>) -> bool {
    ways.as_ref().is_ok_and(|ways| ways.iter().any(|way| way.arrived.is_none()))
}

impl Neighbour {
    /// Creates a neighbour in the initial state of its model with θ + k ε, where θ may act on no body.
    pub fn new(model: Arc<Model>, offset: f64, spares_bodies: bool) -> Self {
        let state = model.initial_state();
        let work = Workspace::new(&model, Box::<Multifrontal>::default());
        let spares_bodies = spares_bodies && model.flow.is_none();
        Self { old: state.clone(), state, begun: None, step: None, work, model, spares_bodies, offset }
    }

    /// Goes on from a saved state, in the step with this number.
    pub fn go_on(&mut self, state: State, begun: Option<usize>) {
        (self.state, self.begun, self.step) = (state, begun, None);
    }

    /// Whether its bodies are those of the run, with the same stress-free places of those that came into the deformed model.
    fn has_same_bodies(&self, base: &BaseIncrement) -> bool {
        self.spares_bodies && self.state.step_start.activations == base.old.step_start.activations
    }

    /// Begins the increment, and its step if that is a new one.
    fn set_out(&mut self, base: &BaseIncrement) -> Result<InProgress, IncrementFailure> {
        let Self { model, state, begun, step, work, .. } = self;
        let new = *begun != Some(base.number);
        if new || step.is_none() {
            *step = Some(model.steps[base.number].clone().after(base.ended));
            *begun = Some(base.number);
        }
        if let (true, Some(step)) = (new, step) {
            *state = begin(model, step, state, work)?;
        }
        let (u, of_run) = (state.displacement.clone(), base.old.displacement.clone());
        let water = NeighbourWater::new(&base.water(), state);
        let mut way = InProgress { u, of_run, old: None, water, arrived: None };
        if let (Some(own), Some(run)) = (&state.last_increment, &base.old.last_increment) {
            let share = own.goes_on(base.new.time - base.old.time, model.flow.is_some()).unwrap_or(0.0);
            let ahead = |u: &mut [f64], way: &[f64]| u.iter_mut().zip(way).for_each(|(u, way)| *u += share * way);
            ahead(&mut way.u, &own.displacement);
            ahead(&mut way.of_run, &run.displacement);
        }
        Ok(way)
    }

    /// Prepares a pass for the tangent of the run.
    fn problem<'a>(
        &'a mut self,
        base: &BaseIncrement,
        pass: &Pass,
        tangent: &Tangent,
        way: &'a InProgress,
    ) -> Option<NeighbourProblem<'a>> {
        let has_same_bodies = self.has_same_bodies(base);
        let Self { model, offset, step, work, .. } = self;
        tangent.couple(work);
        let u = pass.displacement.iter().zip(&way.u).zip(&way.of_run).map(|((run, own), of_run)| run + (own - of_run));
        let u = u.collect();
        Some(NeighbourProblem {
            model,
            trial: base.trial(way.old.as_ref()?, step.as_ref()?, pass),
            work,
            u,
            has_same_bodies,
            offset: *offset,
        })
    }

    /// Lets water flow along contacts under the equilibrium of the last pass.
    fn flow(&self, base: &BaseIncrement, way: &mut InProgress) -> Result<(), IncrementFailure> {
        let step = self.step.as_ref().unwrap_or(base.step);
        let trial = base.whole(&self.state, step).ahead();
        way.arrived = way.water.flow(&self.model, trial, &base.water(), self.work.contacts())?;
        Ok(())
    }

    /// Accepts the solution of the last pass.
    fn accept(&mut self, base: &BaseIncrement, way: InProgress) -> Result<(), IncrementFailure> {
        let Self { model, state, step, work, .. } = self;
        let Some(step) = step else { return Ok(()) };
        let evaluation = std::mem::take(&mut work.assembler.evaluation);
        let found = Found { displacement: way.u, evaluation, water: way.arrived.unwrap_or_default() };
        let new = arrive(model, base.whole(state, step), found, work)?;
        self.old = std::mem::replace(&mut self.state, new);
        Ok(())
    }
}

/// Neighbours whose difference is one derivative: two on either side of the run, or more on one side.
pub type Group<'a> = Vec<&'a mut Neighbour>;

/// Lets neighbours of a run make the increment that it has accepted, all with the same tangents. A group fails as a whole.
pub fn follow(
    base: &BaseIncrement,
    tangent: &mut Tangent,
    mut groups: Vec<Group>,
) -> Vec<Result<(), IncrementFailure>> {
    let set_out = |group: &mut Group| group.iter_mut().map(|neighbour| neighbour.set_out(base)).collect();
    let mut all: Vec<Result<Vec<InProgress>, _>> = groups.par_iter_mut().with_max_len(1).map(set_out).collect();
    let mut is_known = false;
    while all.iter().any(are_in_progress) {
        if let Err(failure) = find(base, tangent, is_known, &mut groups, &mut all) {
            return groups.iter().map(|_| Err(failure.clone())).collect();
        }
        is_known = base.passes.len() == 1;
        let in_progress = groups.par_iter_mut().zip(&mut all).with_max_len(1).filter(|(_, ways)| are_in_progress(ways));
        in_progress.for_each(|(group, all)| {
            let Ok(ways) = all else { return };
            if let Err(failure) = group.iter().zip(ways).try_for_each(|(neighbour, way)| neighbour.flow(base, way)) {
                *all = Err(failure);
            }
        });
    }
    let arrive = |(group, ways): (&mut Group, Result<Vec<InProgress>, _>)| {
        group.iter_mut().zip(ways?).try_for_each(|(neighbour, way)| neighbour.accept(base, way))
    };
    groups.par_iter_mut().zip(all).with_max_len(1).map(arrive).collect()
}

/// Finds equilibrium of the groups under way, in the passes of the run; its tangent may be known.
fn find(
    base: &BaseIncrement,
    tangent: &mut Tangent,
    is_known: bool,
    groups: &mut [Group],
    all: &mut [Result<Vec<InProgress>, IncrementFailure>],
) -> Result<(), IncrementFailure> {
    let mut old = base.water().pressed(tangent.model());
    let linearize = groups.iter().flatten().any(|neighbour| neighbour.has_same_bodies(base));
    for (k, pass) in base.passes.iter().enumerate() {
        if k > 0 {
            tangent.multiply(&mut old);
        }
        for (group, ways) in groups.iter().zip(&mut *all).filter(|(_, ways)| are_in_progress(ways)) {
            for (of, way) in group.iter().zip(ways.iter_mut().flatten()) {
                match &mut way.old {
                    Some(old) if k > 0 => multiply(&of.model, of.work.contacts(), old),
                    old => *old = Some(way.water.pressed(&of.model, &of.state)),
                }
            }
        }
        if !is_known {
            tangent.of(base.trial(&old, base.step, pass), pass, linearize)?;
        }
        solve(base, pass, tangent, groups, all);
    }
    Ok(())
}

/// Solves a pass of all groups under way.
fn solve(
    base: &BaseIncrement,
    pass: &Pass,
    tangent: &mut Tangent,
    groups: &mut [Group],
    all: &mut [Result<Vec<InProgress>, IncrementFailure>],
) {
    let mut problems = Vec::new();
    for (group, ways) in groups.iter_mut().zip(&*all).filter(|(_, ways)| are_in_progress(ways)) {
        if let Ok(ways) = ways {
            let each = group.iter_mut().zip(ways);
            problems.push(each.filter_map(|(neighbour, way)| neighbour.problem(base, pass, tangent, way)).collect());
        }
    }
    let found = solve_neighbours(problems, tangent);
    for (ways, found) in all.iter_mut().filter(|ways| are_in_progress(ways)).zip(found) {
        match (ways.as_mut(), found) {
            (Ok(ways), Ok(found)) => {
                for (way, u) in ways.iter_mut().zip(found) {
                    (way.u, way.of_run) = (u, pass.displacement.clone());
                }
            }
            (_, Err(failure)) => *ways = Err(failure),
            (Err(_), Ok(_)) => {}
        }
    }
}
