//! The contact iteration: what one linear solve of an increment hands down to the next, so that they converge.
//!
//! A contact opens, closes, sticks and slips from one iterate to the next, and the tangent of each of these states knows
//! nothing of the others. Every aid here presumes something about a point when a *tangent* is taken; the residual that may
//! be accepted knows none of them, so no answer depends on them.
//!
//! | aid | presumes |
//! |---|---|
//! | [`promise`] | the tractions that the last linear solve promised turn and stretch with the surface |
//! | [`keep`] | points to which it promised a pressure are closed |
//! | [`carried`] | friction of a point that has just closed answers to what the bodies leave of its pressure |
//! | [`touch`] | a point whose gap is zero at the start of an increment is closed and sticks, in the first iterate |
//! | [`stick`] | a point that slips to and fro sticks |
//! | [`valley`] | a foot that goes to and fro between two segments is the node between them |
//!
//! Aids that know no contact are elsewhere: [`super::start`], [`super::newton`], [`super::augmented`]. Each has a switch in
//! [`crate::model::aids::Aids`] and a column `aid_…` in `newton.csv`; what each saves is a table in `docs/aids.md`.

pub mod carried;
pub mod flips;
pub mod keep;
pub mod promise;
pub mod stick;
pub mod touch;
pub mod valley;

use crate::contact::force::{Closed, ContactState, Presume, Tractions};
use crate::contact::pair::{ContactPair, Presumption};
use crate::contact::response::PairResponse;
use crate::equations::failure::TrialFailure;
use crate::equations::{Assembler, Trial};
use crate::linear::system::{Request, System};
use crate::model::Model;
use crate::model::aids::Aids;
use crate::model::state::State;
use crate::solve::acted::Acted;
use stick::Slipping;
use valley::Feet;

/// What the linear solves of an increment so far say about one contact point.
#[derive(Clone, Debug, Default)]
struct Point {
    slipping: Slipping,
    feet: Feet,
    presume: Presume,
    promised: Tractions,
    /// Whether it was limited at the start of the increment
    limited: bool,
    /// Whether it is that of the committed state
    pulled: bool,
    /// Pressure that friction answers to at a point that has just closed
    carried: Option<f64>,
}

impl Point {
    fn presumption(&self, aids: Aids) -> Presumption {
        Presumption {
            presume: self.presume,
            promised: aids.promise.then_some(self.promised),
            kept: if aids.keep { self.promised.pressure } else { 0.0 },
            carried: self.carried.filter(|_| aids.carried),
            astride: self.feet.astride.filter(|_| aids.valley),
        }
    }

    /// Count the aids that act on the point in a linear solve.
    fn count(
        &self,
        aids: Aids,
        pair: &ContactPair,
        (state, closed): (&ContactState, &Closed),
        old: &ContactState,
        acted: &mut Acted,
    ) {
        let presumption = self.presumption(aids);
        let sticks = self.presume == Presume::Stick;
        acted.promise += usize::from(promise::acts(&presumption, closed));
        acted.limit += usize::from(self.limited);
        acted.keep += usize::from(keep::acts(&presumption, closed));
        acted.pull += usize::from(self.pulled && keep::acts(&presumption, closed));
        acted.carried += usize::from(presumption.carried.is_some());
        acted.touch += usize::from(touch::acts(pair, &presumption, state, old));
        acted.stick += usize::from(sticks && !self.slipping.stuck);
        acted.stick_again += usize::from(sticks && self.slipping.stuck);
        acted.valley += usize::from(valley::acts(&presumption, state));
    }
}

/// The iterates of an increment, point by point.
#[derive(Clone, Debug, Default)]
pub struct ContactIteration {
    /// One list a contact pair, empty before the first linear solve of an increment
    points: Vec<Vec<Point>>,
    /// The points as the last linear solve saw them
    linearized: Vec<PairResponse>,
    /// As the next one does
    next: Vec<PairResponse>,
    /// u of the last linear solve [L]
    linearized_at: Vec<f64>,
    /// On how many points each aid acted in the last linear solve
    pub acted: Acted,
}

impl ContactIteration {
    /// Forget the iterates of the increment before.
    pub fn start_increment(&mut self) {
        self.points.clear();
    }

    /// Residual of all equations at the displacement `u`, on request with their tangent: see [`ContactIteration::evaluate`].
    ///
    /// # Errors
    /// As there.
    pub fn evaluate_all(
        &mut self,
        assembler: &mut Assembler,
        trial: Trial,
        u: &[f64],
        request: Request,
        system: &mut System,
    ) -> Result<(), TrialFailure> {
        self.evaluate(assembler, trial, u, request, |assembler, responses| {
            assembler.assemble(trial, u, responses, request, system)
        })
    }

    /// Have the equations assembled at the displacement `u` from the responses of the contact points: for a residual nothing is
    /// presumed; for a tangent all is, and a residual that goes with it.
    ///
    /// # Errors
    /// [`TrialFailure`] when an element inverts, a friction law fails, or a load has no value.
    pub fn evaluate(
        &mut self,
        assembler: &mut Assembler,
        trial: Trial,
        u: &[f64],
        request: Request,
        assemble: impl FnOnce(&mut Assembler, &[PairResponse]) -> Result<(), TrialFailure>,
    ) -> Result<(), TrialFailure> {
        if request != Request::Tangent {
            return assembler.with_responses(trial, u, request, assemble);
        }
        let aids = assembler.model().aids;
        self.presume(assembler.model(), &assembler.evaluation.contacts, trial, u);
        self.respond(assembler, trial, u, request)?;
        if aids.stick && self.presume_sticking(assembler.model()) {
            self.respond(assembler, trial, u, request)?;
        }
        assemble(assembler, &self.next)?;
        self.take_over(assembler.model(), u, trial.old, aids);
        Ok(())
    }

    /// The points as the next linear solve sees them.
    fn respond(
        &mut self,
        assembler: &mut Assembler,
        trial: Trial,
        u: &[f64],
        request: Request,
    ) -> Result<(), TrialFailure> {
        let (aids, points) = (assembler.model().aids, &self.points);
        let presumed = |pair: usize, point: usize| points[pair][point].presumption(aids);
        assembler.interfaces(trial, u, presumed, request, &mut self.next)
    }

    /// What the next linear solve presumes about each point, from its last two iterates, but for sticking. `states` are
    /// those of the residual at `u`.
    fn presume(&mut self, model: &Model, states: &[Vec<ContactState>], trial: Trial, u: &[f64]) {
        let (first, aids) = (self.points.is_empty(), model.aids);
        self.points.resize_with(model.contacts.len(), Vec::new);
        let at = &self.linearized_at;
        let pairs = model.contacts.iter().zip(states).zip(&trial.old.contacts);
        for (number, (points, ((pair, states), old))) in self.points.iter_mut().zip(pairs).enumerate() {
            points.resize_with(states.len(), Point::default);
            for (k, ((point, state), old)) in points.iter_mut().zip(states).zip(old).enumerate() {
                let last = if first { None } else { self.linearized[number].closed(k) };
                let was_closed = if first { old.friction.pressure > 0.0 } else { last.is_some() };
                point.carried = carried::carried(pair, was_closed, state, trial.stiffening);
                point.promised = match last {
                    Some(closed) => closed.promise(|dof| u[dof] - at[dof]),
                    None if first && state.friction.pressure > 0.0 => promise::at_start(state, old, aids.limit),
                    None if first && aids.pull => keep::at_start(pair, state, old),
                    None => Tractions::default(),
                };
                let closed = state.friction.pressure > 0.0;
                point.limited = first && closed && point.promised.pressure < state.friction.pressure;
                point.pulled = first && !closed && point.promised.pressure > 0.0;
                point.feet.note(state);
                point.slipping.stuck = aids.stick_again && point.presume == Presume::Stick;
                point.presume = if first && aids.touch { Presume::Touch } else { Presume::Nothing };
            }
        }
    }

    /// Presume sticking where points slip to and fro between the linear solves; whether there are any.
    fn presume_sticking(&mut self, model: &Model) -> bool {
        let mut any = false;
        for (points, (pair, response)) in self.points.iter_mut().zip(model.contacts.iter().zip(&self.next)) {
            let rough = pair.points.iter().map(|slave| pair.law(slave).start().stiffness() > 0.0);
            let answers = points.iter_mut().zip(&response.states);
            for ((point, state), _) in answers.zip(rough).filter(|(_, rough)| *rough) {
                if point.slipping.sticks(&state.friction, point.promised) {
                    point.presume = Presume::Stick;
                    any = true;
                }
            }
        }
        any
    }

    /// Keep the points as the next linear solve sees them, and count those on which an aid acts.
    fn take_over(&mut self, model: &Model, u: &[f64], old: &State, aids: Aids) {
        std::mem::swap(&mut self.linearized, &mut self.next);
        self.linearized_at.clear();
        self.linearized_at.extend_from_slice(u);
        self.acted = Acted::default();
        let responses = self.linearized.iter().zip(&old.contacts);
        for ((points, pair), (response, old)) in self.points.iter().zip(&model.contacts).zip(responses) {
            for (k, (point, (state, old))) in points.iter().zip(response.states.iter().zip(old)).enumerate() {
                if let Some(closed) = response.closed(k) {
                    point.count(aids, pair, (state, &closed), old, &mut self.acted);
                }
            }
        }
    }
}
