//! The contact iteration: what one linear solve of an increment hands down to the next, so that they converge.
//!
//! A contact opens, closes, sticks and slips from one iterate to the next, and the tangent of each of these states knows
//! nothing of the others. Every aid here presumes something about a point when a *tangent* is taken; the residual that may
//! be accepted knows none of them, so no answer depends on them.
//!
//! | aid | presumes |
//! |---|---|
//! | `promise` | the tractions that the last linear solve promised turn and stretch with the surface |
//! | `keep` | points to which it promised a pressure are closed |
//! | `carried` | friction of a point that has just closed answers to what the bodies leave of its pressure |
//! | `touch` | a point whose gap is zero at the start of an increment is closed and sticks, in the first iterate |
//! | `stick` | a point that slips to and fro sticks |
//! | `valley` | a foot that goes to and fro between two segments is the node between them |
//!
//! Aids that know no contact are elsewhere: [`super::equilibrium`], [`super::newton`]. Each has a switch in
//! [`crate::model::aids::Aids`] and a column `aid_…` in `newton.csv`; what each saves is a table in `docs/aids.md`.
//!
//! # Promise, limit
//!
//! A stiff penalty turns every error of a displacement into a pressure far too high, and that into a
//! geometric stiffness p δn ℓ that leads the next iterate astray. What the last linear solve promised, p + δp, is off by the
//! square of its correction only ([`Closed::promise`]), and takes the place of p and q in the geometric part of the tangent.
//! Switch `promise`; `aid_promise` counts the closed points whose own tractions are others.
//!
//! The first linear solve of an increment has none before it and goes by the start value. Extrapolated past the edge of
//! a contact, points penetrate far too deep, so that no pressure is taken for promised which is more than twice the
//! committed one (switch `limit`; `aid_limit` counts the points to which this happens).
//!
//! Source: what p + δp leaves out is the second term of the expansion of the traction in the correction; that it is of
//! second order is tested (`tests/contact/contact.rs`). The limit is a rule of thumb.
//!
//! # Keep, pull
//!
//! Where a correction lifts a point off its stiff penalty by a hair, the point would open, carry nothing in the
//! next linear solve, and fall back in. It is closed in that solve as long as the last one promised it a pressure; its
//! spring then pulls it back. Switch `keep`; `aid_keep` counts the points that are closed for it.
//!
//! The first linear solve of an increment goes by the committed state: a point that was closed still is, unless the start
//! value takes it farther away than the bodies would follow if its pressure went, and the penalty would reach,
//!
//! ```text
//! g ≤ max(p₀ (c + 10/α_n), h/100)                     c: compliance of the bodies, h: shortest edge of the slave
//! ```
//!
//! The start value goes on in a straight line, so that slender bodies which turn where they touch are a little apart by it,
//! under pressures next to nothing: without h/100 all their points would open at once, and the bodies spring through each other.
//!
//! Switch `pull`, for those points that are open by the start value, and needs `keep`; `aid_pull` counts them.
//!
//! Source: as the choice of the active set from p + δp rather than from the gap in primal–dual active set methods (Hintermüller,
//! Ito & Kunisch 2002, doi:10.1137/S1052623401383558), where it is Newton's method for the kink of ⟨p⟩. The reach is the
//! displacement over which p₀ goes to zero; its factor 10 and the hundredth are rules of thumb.
//!
//! # Carried
//!
//! A point that goes too deep in one iterate would be pressed far too hard by a stiff penalty, and stick
//! where it is to slip. Friction answers to what is left of the pressure once the bodies have taken their share of the
//! penetration, p/(1 + α_n c), and goes on in a straight line from there. Switch `carried`; `aid_carried` counts the points.
//!
//! Source: body and penalty are springs in series, 1/c and α_n, and the penetration of an iterate is what both will
//! share. (The compliance d/p by which slip counts from touch, [`crate::contact::force`], is no aid but a law: it is the same
//! in every iterate, and answers depend on it.)
//!
//! # Touch
//!
//! At p = 0 a point may as well be open as closed, and a tangent of one or the other leads to the other, for ever; and
//! a frictional one would slip at once, for the law of friction has no stiffness there. A point whose gap is zero at the
//! start of an increment is closed and sticks, q = q₀ + α_t Δu_t, in the first linear solve. Switch `touch`; `aid_touch` counts the points.
//!
//! Source: sticking is what the law answers to a pressure that comes up with the slip as long as |q| < μ p, and the only one of
//! its branches whose tangent is not singular at p = 0.
//!
//! # Stick, stick again
//!
//! A point that slips one way and then the other has passed the narrow and stiff range of sticking that lies
//! between. The tangents on both sides are soft, and Newton's method would jump to and fro for ever; presumed to stick, it
//! finds the range. Switch `stick`; `aid_stick` counts the points.
//!
//! A point that was presumed to stick and slips all the same may have missed the range for the error of its neighbours only.
//! It sticks once more if the tractions that its linear solve promised would have held it. Switch `stick_again`, and needs
//! `stick`; `aid_stick_again` counts them.
//!
//! Source: sticking is linear, so that one solve of it tells whether the range is where the point ends: the predictor of
//! return mapping (Simo & Hughes 1998, Computational Inelasticity, ch. 3), taken between iterates instead of within one.
//!
//! # Valley
//!
//! Between two segments that form one, a foot may go to and fro for ever, each of the two tangents leading to the
//! other segment. It is presumed to be the node between them. Switch `valley`; `aid_valley` counts the points.
//!
//! Source: in a concave corner the gap is the lesser of two, with a kink where they are the same. From the node the normal goes
//! to the point, which lies between the normals of both sides, and Newton's method ends at the kink instead of crossing it. The force
//! towards the node is that of a spring α_n in both directions, linear in the displacements with the tractions that the point has: promised
//! ones would hold it far too softly along the surface.
//!
//! # The record
//!
//! What the aids did in one iteration ([`Acted`]), and contact states that come back every other iterate ([`Flips`]).

use crate::contact::force::{Closed, ContactState, Presume, Tractions, touches};
use crate::contact::pair::{ContactPair, Presumption};
use crate::contact::response::PairResponse;
use crate::equations::sums::TrialFailure;
use crate::equations::{Assembler, Trial};
use crate::laws::friction::{FrictionState, Regime};
use crate::linear::system::{Request, System};
use crate::model::Model;
use crate::model::aids::Aids;
use crate::model::state::State;

/// Data of one contact point from the linear solves of an increment so far.
#[derive(Clone, Debug, Default)]
struct Point {
    /// Nothing is presumed of what cannot open or slide
    tied: bool,
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
        if self.tied {
            return Presumption::default();
        }
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
        if self.tied {
            return;
        }
        let presumption = self.presumption(aids);
        let sticks = self.presume == Presume::Stick;
        acted.promise += usize::from(promise_acts(&presumption, closed));
        acted.limit += usize::from(self.limited);
        acted.keep += usize::from(keep_acts(&presumption, closed));
        acted.pull += usize::from(self.pulled && keep_acts(&presumption, closed));
        acted.carried += usize::from(presumption.carried.is_some());
        acted.touch += usize::from(touch_acts(pair, &presumption, state, old));
        acted.stick += usize::from(sticks && !self.slipping.stuck);
        acted.stick_again += usize::from(sticks && self.slipping.stuck);
        acted.valley += usize::from(valley_acts(&presumption, state));
    }
}

/// The iterates of an increment, point by point.
#[derive(Clone, Debug, Default)]
pub struct ContactIteration {
    /// One list a contact pair, empty before the first linear solve of an increment
    points: Vec<Vec<Point>>,
    /// Contact points as linearized in the last solve
    linearized: Vec<PairResponse>,
    /// Contact points as linearized in the next solve
    next: Vec<PairResponse>,
    /// u of the last linear solve [L]
    linearized_at: Vec<f64>,
    /// Number of points on which each convergence aid acted in the last linear solve
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

    /// The points as linearized in the next solve.
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

    /// Assumptions of the next linear solve about each point, from its last two iterates, except for sticking. `states`
    /// are those of the residual at `u`.
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
                point.carried = carried(pair, was_closed, state, trial.stiffening);
                point.promised = match last {
                    Some(closed) => closed.promise(|dof| u[dof] - at[dof]),
                    None if first && state.friction.pressure > 0.0 => promised_at_start(state, old, aids.limit),
                    None if first && aids.pull => kept_at_start(pair, state, old),
                    None => Tractions::default(),
                };
                point.tied = pair.tied;
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
            let rough = pair.points.iter().map(|slave| pair.law(slave).description.stiffness > 0.0);
            let answers = points.iter_mut().zip(&response.states);
            for ((point, state), _) in answers.zip(rough).filter(|(_, rough)| *rough) {
                if !point.tied && point.slipping.sticks(&state.friction, point.promised) {
                    point.presume = Presume::Stick;
                    any = true;
                }
            }
        }
        any
    }

    /// Keep the points as linearized in the next solve, and count those on which an aid acts.
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

/// Most growth of a pressure from the committed state to the start value that is believed.
const MOST_GROWTH: f64 = 2.0;

/// Predicted traction of a point that the start value closes.
fn promised_at_start(state: &ContactState, old: &ContactState, limit: bool) -> Tractions {
    let tractions = Tractions::of(&state.friction);
    if limit { tractions.limited(MOST_GROWTH * old.friction.pressure) } else { tractions }
}

/// Whether the tangent of a point is made with other tractions than its own.
fn promise_acts(presumption: &Presumption, closed: &Closed) -> bool {
    presumption.promised.is_some_and(|promised| promised != closed.tractions)
}

/// The penalty may have drawn a point that was closed back by this many p/α_n.
const MOST_PULL: f64 = 10.0;

/// The start value may have lifted it by this many gaps of touch, each 1e-9 of the slave's shortest edge.
const MOST_LIFT: f64 = 1e7;

/// Predicted traction, from the committed state, of a point that is open by the start value.
fn kept_at_start(pair: &ContactPair, state: &ContactState, old: &ContactState) -> Tractions {
    let reach = old.friction.pressure * (pair.compliance + MOST_PULL / pair.alpha_n);
    let closed = old.friction.pressure > 0.0;
    if closed && state.clearance() <= reach.max(MOST_LIFT * pair.touch) {
        Tractions::of(&old.friction)
    } else {
        Tractions::default()
    }
}

/// Whether a point is closed for a promise alone.
fn keep_acts(presumption: &Presumption, closed: &Closed) -> bool {
    presumption.kept > 0.0 && closed.tractions.pressure <= 0.0
}

/// The pressure that friction answers to at a point that has just closed; `None` at any other.
fn carried(pair: &ContactPair, was_closed: bool, state: &ContactState, stiffening: f64) -> Option<f64> {
    let closes = !was_closed && state.friction.pressure > 0.0;
    closes.then(|| pair.shared(state.friction.pressure, stiffening))
}

/// Whether a closed point sticks because it touches.
fn touch_acts(pair: &ContactPair, presumption: &Presumption, state: &ContactState, old: &ContactState) -> bool {
    touches(pair, state.clearance(), old, presumption.presume)
}

/// Slip that is below this share of what it was at the last solve comes to rest.
const ABATES: f64 = 0.5;

/// Tractions below this share of the friction that a point slips with would hold it.
const FAR_LOWER: f64 = 0.9;

/// Slip history of a point over the linear solves of the increment.
#[derive(Clone, Copy, Debug, Default)]
struct Slipping {
    /// Plastic slip of the increment at the last solve [L]
    slip: f64,
    /// Whether the last solve presumed it to stick
    stuck: bool,
}

impl Slipping {
    /// Watch the slip that the next linear solve starts from. A point sticks where it slips the other way than at the last
    /// solve, or was presumed to stick and slips, but would not with the tractions that this promised: it missed the narrow
    /// range of sticking only for its own error.
    fn sticks(&mut self, friction: &FrictionState, promised: Tractions) -> bool {
        let slip = friction.plastic_increment;
        let slips = friction.regime == Regime::Slip;
        // A point that only a promise keeps closed has a negative pressure.
        let strength = (friction.traction / friction.pressure).abs() * promised.pressure;
        // A point that slips below its strength does so with these tractions as well, unless they are far lower or the slip
        // abates.
        let held = if slip.abs() < ABATES * self.slip.abs() { strength } else { FAR_LOWER * strength };
        let sticks = match self.stuck {
            true => slips && promised.traction.abs() < held,
            false => self.slip * slip < 0.0,
        };
        self.slip = slip;
        sticks
    }
}

/// Segments of a point's feet at the linear solves of the increment.
#[derive(Clone, Copy, Debug, Default)]
struct Feet {
    /// Projected segments at the last two solves
    last: [Option<usize>; 2],
    /// The two segments between which the projection alternates
    astride: Option<[usize; 2]>,
}

impl Feet {
    /// Record the segment on which the next linear solve starts.
    fn note(&mut self, state: &ContactState) {
        let segment = state.foot.map(|foot| foot.segment);
        let [last, before] = self.last;
        self.astride =
            segment.zip(last).filter(|(segment, last)| segment != last && Some(*segment) == before).map(Into::into);
        self.last = [segment, last];
    }
}

/// Whether the foot of a point is presumed to be the node between two segments, and is.
fn valley_acts(presumption: &Presumption, state: &ContactState) -> bool {
    presumption.astride.is_some() && state.foot.is_some_and(|foot| foot.xi == 1.0)
}

/// Regime of every point at the last two iterates.
#[derive(Clone, Debug, Default)]
pub struct Flips([Vec<Regime>; 2]);

impl Flips {
    /// Number of points that are as they were before the last iterate, and were not in it.
    pub fn count(&mut self, contacts: &[Vec<ContactState>]) -> usize {
        let now: Vec<Regime> = contacts.iter().flatten().map(ContactState::regime).collect();
        let [last, before] = std::mem::take(&mut self.0);
        let back = now.iter().zip(&last).zip(&before).filter(|((now, last), before)| now == before && now != last);
        let count = back.count();
        self.0 = [now, last];
        count
    }
}

/// Number of contact points on which each aid acted in the tangent of an iteration; 0 or 1 for those that know no points. All
/// are 0 where there was no new tangent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Acted {
    /// the increment starts as the last one went on
    pub start: usize,
    /// the geometric part of the tangent has promised tractions
    pub promise: usize,
    /// these were limited at the start of the increment
    pub limit: usize,
    /// closed for the promise alone
    pub keep: usize,
    /// closed because the committed state is
    pub pull: usize,
    /// friction answers to a carried pressure
    pub carried: usize,
    /// closed, and sticks, because it touches
    pub touch: usize,
    /// sticks because it slipped to and fro
    pub stick: usize,
    /// sticks once more
    pub stick_again: usize,
    /// its foot is the node between two segments
    pub valley: usize,
    /// it is one on the nodes at contacts alone
    pub condense: usize,
    /// the correction was shortened by a line search
    pub downhill: usize,
    /// the augmented Lagrangian is stiffened
    pub stiffening: usize,
    /// penalties are softer than given, on the way to a start value
    pub softening: usize,
}

impl Acted {
    /// Columns of `newton.csv`.
    pub const COLUMNS: [&str; 14] = [
        "aid_start",
        "aid_promise",
        "aid_limit",
        "aid_keep",
        "aid_pull",
        "aid_carried",
        "aid_touch",
        "aid_stick",
        "aid_stick_again",
        "aid_valley",
        "aid_condense",
        "aid_downhill",
        "aid_stiffening",
        "aid_softening",
    ];

    /// The counts, in the order of the columns.
    pub fn counts(self) -> [usize; Self::COLUMNS.len()] {
        let Self { start, promise, limit, keep, pull, carried, touch, .. } = self;
        let Self { stick, stick_again, valley, condense, downhill, stiffening, softening, .. } = self;
        [
            start,
            promise,
            limit,
            keep,
            pull,
            carried,
            touch,
            stick,
            stick_again,
            valley,
            condense,
            downhill,
            stiffening,
            softening,
        ]
    }
}
