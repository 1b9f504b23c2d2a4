//! The contact iteration: what one linear solve of an increment hands down to the next, so that they converge.
//!
//! A contact opens, closes, sticks and slips from one iterate to the next, and the tangent of each of these states knows
//! nothing of the others. Every aid here presumes something about a point when a *tangent* is taken; the residual that may
//! be accepted knows none of them, so no answer depends on them.
//!
//! | aid | presumes |
//! |---|---|
//! | [`promise`] | the tractions that the last linear solve promised, or at first those of the committed state |
//! | [`carried`] | friction of a point that has just closed answers to what the bodies leave of its pressure |
//! | touch | a point whose gap is zero at the start of an increment is closed and sticks, in the first iterate |
//! | [`stick`] | a point that slips to and fro sticks |
//! | [`valley`] | a foot that goes to and fro between two segments lies between them |
//! | [`cycle`] | half of a correction ends between the two states of a cycle |

pub mod carried;
pub mod cycle;
pub mod promise;
pub mod stick;
pub mod valley;

use crate::contact::force::{Closed, ContactState, Presume, Tractions};
use crate::contact::pair::{PairResponse, Presumption};
use crate::equations::failure::TrialFailure;
use crate::equations::{Assembler, Trial};
use crate::linear::system::{Request, System};
use crate::model::Model;
use stick::Slipping;
use valley::Feet;

/// What the linear solves of an increment so far say about one contact point.
#[derive(Clone, Debug, Default)]
struct Point {
    slipping: Slipping,
    feet: Feet,
    presume: Presume,
    /// The point as the last linear solve saw it, if it was closed
    closed: Option<Closed>,
    promised: Tractions,
    /// Pressure that friction answers to at a point that has just closed
    carried: Option<f64>,
}

impl Point {
    fn presumption(&self) -> Presumption {
        let &Self { presume, promised, carried, .. } = self;
        Presumption { presume, promised: Some(promised), carried, astride: self.feet.astride }
    }
}

/// The iterates of an increment, point by point.
#[derive(Clone, Debug, Default)]
pub struct ContactIteration {
    /// One list a contact pair, empty before the first linear solve of an increment
    points: Vec<Vec<Point>>,
    /// u of the last linear solve [L]
    linearized_at: Vec<f64>,
}

impl ContactIteration {
    /// Forget the iterates of the increment before.
    pub fn start_increment(&mut self) {
        self.points.clear();
    }

    /// Residual at the displacement `u`, where nothing is presumed; on request the tangent as well, with all that is
    /// presumed, and a residual that goes with it.
    ///
    /// # Errors
    /// [`TrialFailure`] when an element inverts, a friction law fails, or a load has no value.
    pub fn evaluate(
        &mut self,
        assembler: &mut Assembler,
        trial: Trial,
        u: &[f64],
        request: Request,
        system: &mut System,
    ) -> Result<(), TrialFailure> {
        if request == Request::Residual {
            return assembler.residual(trial, u, system);
        }
        self.presume(assembler.model(), &assembler.evaluation.contacts, trial, u);
        let mut responses = assembler.interfaces(trial, u, |pair, point| self.points[pair][point].presumption())?;
        if self.presume_sticking(assembler.model(), &responses) {
            responses = assembler.interfaces(trial, u, |pair, point| self.points[pair][point].presumption())?;
        }
        assembler.assemble(trial, u, &responses, request, system)?;
        self.linearized(u, responses);
        Ok(())
    }

    /// What the next linear solve presumes about each point, from its last two iterates, but for sticking. `states` are
    /// those of the residual at `u`.
    fn presume(&mut self, model: &Model, states: &[Vec<ContactState>], trial: Trial, u: &[f64]) {
        let first = self.points.is_empty();
        self.points.resize_with(model.contacts.len(), Vec::new);
        let at = &self.linearized_at;
        let pairs = model.contacts.iter().zip(states).zip(&trial.old.contacts);
        for (points, ((pair, states), old)) in self.points.iter_mut().zip(pairs) {
            points.resize_with(states.len(), Point::default);
            for ((point, state), old) in points.iter_mut().zip(states).zip(old) {
                let was_closed = if first { old.friction.pressure > 0.0 } else { point.closed.is_some() };
                point.carried = carried::carried(pair, was_closed, state, trial.stiffening);
                point.promised = match &point.closed {
                    Some(closed) => closed.promise(|dof| u[dof] - at[dof]),
                    None if first => promise::at_start(pair, state, old),
                    None => Tractions::default(),
                };
                point.feet.note(state);
                point.slipping.stuck = point.presume == Presume::Stick;
                point.presume = if first { Presume::Touch } else { Presume::Nothing };
            }
        }
    }

    /// Presume sticking where points slip to and fro between the linear solves; whether there are any.
    fn presume_sticking(&mut self, model: &Model, responses: &[PairResponse]) -> bool {
        let mut any = false;
        for (points, (pair, responses)) in self.points.iter_mut().zip(model.contacts.iter().zip(responses)) {
            let rough = pair.points.iter().map(|slave| pair.law(slave).stiffness() > 0.0);
            for ((point, (state, _)), _) in points.iter_mut().zip(responses).zip(rough).filter(|(_, rough)| *rough) {
                if point.slipping.sticks(&state.friction, point.promised) {
                    point.presume = Presume::Stick;
                    any = true;
                }
            }
        }
        any
    }

    /// Keep the points as the next linear solve sees them.
    fn linearized(&mut self, u: &[f64], responses: Vec<PairResponse>) {
        self.linearized_at.clear();
        self.linearized_at.extend_from_slice(u);
        for (points, responses) in self.points.iter_mut().zip(responses) {
            for (point, (_, closed)) in points.iter_mut().zip(responses) {
                point.closed = closed;
            }
        }
    }
}
