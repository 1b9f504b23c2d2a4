//! Contact iteration: data passed from one linear solve of an increment to the next to improve convergence.
//!
//! A contact opens, closes, sticks and slips from one iterate to the next, and the tangent of each status contains no
//! information about the others. A convergence aid makes a prediction about a point when a *tangent* is evaluated; the
//! residual that decides on acceptance contains none, so every accepted state solves the same equations. Which increments are made
//! follows from the motion under error control; otherwise from the number of tangents, too, and from what could not be solved.
//!
//! | aid | prediction |
//! |---|---|
//! | `prediction` | the geometric tangent uses the tractions predicted by the last linear solve |
//! | `active_set` | points with a positive predicted pressure are closed |
//! | `predicted_pressure` | friction of a point that has just closed uses the pressure that remains after the bodies deform |
//! | `touch` | a point with zero gap at the start of an increment is closed and sticks, in the first iterate |
//! | `stick` | a point that slips in alternating directions sticks, and one that stuck sticks on |
//! | `valley` | a projection that alternates between two segments is the node between them |
//!
//! Aids unrelated to contact are in [`super::equilibrium`], [`super::passes`] and [`super::newton`]. Each has a switch in
//! [`crate::model::aids::Aids`] and a column `aid_…` in `newton.csv`; `docs/aids.md` tabulates what each saves.
//!
//! # Prediction, limit
//!
//! A stiff penalty turns every error of a displacement into a pressure far too high, and this into a geometric stiffness p δn ℓ
//! that misleads the next iterate. The linearized prediction of the last linear solve, p + δp, has an error of second order in
//! its correction only ([`Closed::prediction`]), and replaces p and q in the geometric part of the tangent. Switch `prediction`;
//! `aid_prediction` counts the closed points where the prediction differs from their own tractions.
//!
//! The first linear solve of an increment uses the start value instead. Points extrapolated past the edge of a contact
//! penetrate far too deep, so the predicted pressure is limited to twice the committed one (switch `limit`; `aid_limit` counts
//! the points limited).
//!
//! Source: the neglected term of p + δp is the second one of the expansion of the traction in the correction; its
//! second order is tested (`tests/contact/contact.rs`). The limit is heuristic.
//!
//! # The active set
//!
//! Where a correction lifts a point slightly off its stiff penalty, the point would open, carry no pressure in the
//! next linear solve, and close again. It stays in the active set of that solve as long as the predicted pressure is positive; its
//! spring then pulls it back. Switch `active_set`; `aid_active_set` counts the points closed for this reason.
//!
//! The first linear solve of an increment uses the committed state: a closed point stays closed unless the start value
//! separates it by more than the bodies would rebound without its pressure plus the range of the penalty,
//!
//! ```text
//! g ≤ max(p₀ (c + 10/α_n), h/100)                     c: compliance of the bodies, h: shortest edge of the slave
//! ```
//!
//! The start value extrapolates linearly, so slender bodies that rotate while in contact are separated slightly by it, at
//! very low pressures: without h/100 all their points would open at once, and the bodies would pass through each other.
//!
//! Switch `active_set_at_start`, which requires `active_set`, for points that are open in the start value; `aid_active_set_at_start` counts them.
//!
//! Source: the choice of the active set from p + δp rather than from the gap as in primal–dual active set methods
//! (Hintermüller, Ito & Kunisch 2002, doi:10.1137/S1052623401383558), where it is Newton's method for the kink of ⟨p⟩. The
//! range is the displacement over which p₀ falls to zero; its factor 10 and the hundredth are heuristic.
//!
//! # The pressure of friction
//!
//! A stiff penalty gives a far too high pressure to a point that penetrates too deep in one iterate, which would then stick
//! where it is to slip. Friction uses the pressure that remains after the bodies have taken their part of the
//! penetration, p/(1 + α_n c), and is extrapolated linearly from there. Switch `predicted_pressure`; `aid_predicted_pressure` counts the points.
//!
//! Source: body and penalty are springs in series, 1/c and α_n, which share the penetration of an iterate. (The compliance d/p
//! by which slip counts after closure, [`crate::contact::force`], is no aid but part of the law: it is the same in every
//! iterate, and results depend on it.)
//!
//! # Touch
//!
//! At p = 0 a point is both open and closed, and the tangent of each status leads to the other indefinitely; a
//! frictional one would slip at once, since friction has no stiffness there. A point with zero gap at the start of an
//! increment is closed and sticks, q = q₀ + α_t Δu_t, in the first linear solve. Switch `touch`; `aid_touch` counts the points.
//!
//! Source: sticking is the response of the law to a pressure that grows with the slip as long as |q| < μ p, and the only
//! branch with a regular tangent at p = 0.
//!
//! # Stick, stick again
//!
//! A point that slips in one direction and then in the other has passed the narrow and stiff range of sticking in
//! between. The tangents on both sides are soft, and Newton's method would alternate indefinitely; predicted to stick, the point
//! finds the range. Switch `stick`; `aid_stick` counts the points.
//!
//! With a stiff α_t a start value takes what stuck past that range before anything else is known: of a disk that rolls, no point
//! would stick in the first tangent, and the correction would throw the disk off. Points that stuck in the last increment stick in the first
//! linear solve, where α_t is a penalty above 20 (λ + 2G)/h. Below that it gains nothing.
//!
//! A point that was predicted to stick but slips may have missed the range because of errors of its neighbours only. It is
//! predicted to stick once more if the tractions predicted by that linear solve would not have exceeded its strength. Switch `stick_again`, which
//! requires `stick`; `aid_stick_again` counts the points.
//!
//! Source: sticking is linear, so one solve shows whether the point ends in that range: the predictor of return
//! mapping (Simo & Hughes 1998, Computational Inelasticity, ch. 3), applied between iterates instead of within one.
//!
//! # Valley
//!
//! Between two segments at a concave corner, a projection may alternate indefinitely, each tangent leading to the
//! other segment. It is predicted to be the node between them. Switch `valley`; `aid_valley` counts the points.
//!
//! Source: in a concave corner the gap is the lesser of two, with a kink where they are the same. From the node the normal goes
//! to the point, which lies between the normals of both sides, and Newton's method ends at the kink instead of crossing it. The force
//! towards the node is that of a spring α_n in both directions, linear in the displacements with the tractions that the point has: predicted
//! ones would hold it far too softly along the surface.
//!
//! # The record
//!
//! The actions of the aids in one iteration ([`Acted`]), and contact states that return every other iterate ([`Flips`]).

use crate::contact::force::{Closed, ContactState, PredictedStatus, Tractions, touches};
use crate::contact::pair::ContactPair;
use crate::contact::point::{Prediction, SlavePoint};
use crate::contact::response::PairResponse;
use crate::equations::{Assembler, Trial, TrialFailure};
use crate::laws::friction::{Description, Regime};
use crate::linear::system::Request;
use crate::model::aids::Aids;
use crate::model::{Model, State};

/// Data of one contact point from the linear solves of the increment so far.
#[derive(Clone, Debug, Default)]
struct Point {
    /// Nothing is predicted of what cannot open or slide
    tied: bool,
    slipping: Slipping,
    master_points: MasterPoints,
    predicted: PredictedStatus,
    predicted_tractions: Tractions,
    /// Whether it was limited at the start of the increment
    limited: bool,
    /// Whether it is closed in the committed state
    active_at_start: bool,
    /// Pressure used by friction at a point that has just closed
    predicted_pressure: Option<f64>,
}

impl Point {
    fn prediction(&self, aids: Aids) -> Prediction {
        if self.tied {
            return Prediction::default();
        }
        Prediction {
            predicted: self.predicted,
            predicted_tractions: aids.prediction.then_some(self.predicted_tractions),
            active_pressure: if aids.active_set { self.predicted_tractions.pressure } else { 0.0 },
            predicted_pressure: self.predicted_pressure.filter(|_| aids.predicted_pressure),
            alternating: self.master_points.alternating.filter(|_| aids.valley),
        }
    }

    /// Counts the aids that act on the point in a linear solve.
    fn count(
        &self,
        aids: Aids,
        pair: &ContactPair,
        state: &ContactState,
        closed: &Closed,
        old: &ContactState,
        acted: &mut Acted,
    ) {
        if self.tied {
            return;
        }
        let prediction = self.prediction(aids);
        let sticks = self.predicted == PredictedStatus::Stick;
        acted.prediction += usize::from(prediction_acts(&prediction, closed));
        acted.limit += usize::from(self.limited);
        acted.active_set += usize::from(closes_the_point(&prediction, closed));
        acted.active_set_at_start += usize::from(self.active_at_start && closes_the_point(&prediction, closed));
        acted.predicted_pressure += usize::from(prediction.predicted_pressure.is_some());
        acted.touch += usize::from(touch_acts(pair, &prediction, state, old));
        acted.stick += usize::from(sticks && !self.slipping.stuck);
        acted.stick_again += usize::from(sticks && self.slipping.stuck);
        acted.valley += usize::from(valley_acts(&prediction, state));
    }
}

/// Iterates of an increment, point by point.
#[derive(Clone, Debug, Default)]
pub struct ContactIteration {
    /// One list per contact pair, empty before the first linear solve of an increment
    points: Vec<Vec<Point>>,
    /// Contact points as linearized in the last solve
    linearized: Vec<PairResponse>,
    /// Contact points as linearized in the next solve
    next: Vec<PairResponse>,
    /// Contact points as they are, stored to reuse their memory
    plain: Vec<PairResponse>,
    /// u of the last linear solve [L]
    linearized_at: Vec<f64>,
    /// Number of points on which each convergence aid acted in the last linear solve
    pub acted: Acted,
}

impl ContactIteration {
    /// Clears the iterates of the previous increment.
    pub fn start_increment(&mut self) {
        self.points.clear();
    }

    /// Evaluates the contact points at the displacement `u`: for a residual without predictions; for a tangent with all of them, of
    /// which [`ContactIteration::note`] records what was used.
    ///
    /// # Errors
    /// Returns [`TrialFailure`] if a friction law fails.
    pub fn respond(
        &mut self,
        assembler: &mut Assembler,
        trial: Trial,
        u: &[f64],
        request: Request,
    ) -> Result<&[PairResponse], TrialFailure> {
        if request != Request::Tangent {
            assembler.interfaces(trial, u, |_, _| Prediction::default(), request, &mut self.plain)?;
            return Ok(&self.plain);
        }
        let aids = assembler.model().aids;
        self.predicted(assembler.model(), &assembler.evaluation.contacts, trial.old, trial.stiffening, u);
        let mut sticking = aids.stick;
        loop {
            let points = &self.points;
            // Before the first residual nothing is known about any point.
            let prediction_of = |pair: usize, point: usize| {
                points[pair].get(point).map_or_else(Prediction::default, |point| point.prediction(aids))
            };
            assembler.interfaces(trial, u, prediction_of, request, &mut self.next)?;
            if !std::mem::take(&mut sticking) || !self.predict_sticking(assembler.model()) {
                return Ok(&self.next);
            }
        }
    }

    /// Sets the predictions of the next linear solve about each point, from its last two iterates, except for sticking.
    /// `states` are those of the residual at `u`.
    fn predicted(&mut self, model: &Model, states: &[Vec<ContactState>], old: &State, stiffening: f64, u: &[f64]) {
        let (first, aids) = (self.points.is_empty(), model.aids);
        self.points.resize_with(model.contacts.len(), Vec::new);
        let at = &self.linearized_at;
        let pairs = model.contacts.iter().zip(states).zip(&old.contacts);
        for (number, (points, ((pair, states), old))) in self.points.iter_mut().zip(pairs).enumerate() {
            points.resize_with(states.len(), Point::default);
            for (k, ((point, state), old)) in points.iter_mut().zip(states).zip(old).enumerate() {
                let last = if first { None } else { self.linearized[number].closed(k) };
                let was_closed = if first { old.friction.pressure > 0.0 } else { last.is_some() };
                point.predicted_pressure = friction_pressure(pair, was_closed, state, stiffening);
                point.predicted_tractions = match last {
                    Some(closed) => closed.prediction(|dof| u[dof] - at[dof]),
                    None if first && state.friction.pressure > 0.0 => predicted_at_start(state, old, aids.limit),
                    None if first && aids.active_set_at_start => active_at_start(pair, state, old),
                    None => Tractions::default(),
                };
                point.tied = pair.tied;
                let closed = state.friction.pressure > 0.0;
                point.limited = first && closed && point.predicted_tractions.pressure < state.contact_pressure();
                point.active_at_start = first && !closed && point.predicted_tractions.pressure > 0.0;
                point.master_points.note(state);
                point.slipping.stuck = aids.stick_again && point.predicted == PredictedStatus::Stick;
                point.predicted = match first {
                    true if aids.stick && sticks_on(pair, &pair.points[k], old) => PredictedStatus::Stick,
                    true if aids.touch => PredictedStatus::Touch,
                    _ => PredictedStatus::Nothing,
                };
            }
        }
    }

    /// Predicts sticking where points slip in alternating directions between the linear solves; returns whether there are any.
    fn predict_sticking(&mut self, model: &Model) -> bool {
        let mut any = false;
        for (points, (pair, response)) in self.points.iter_mut().zip(model.contacts.iter().zip(&self.next)) {
            let rough = pair.points.iter().map(|slave| pair.law(slave).description.stiffness > 0.0);
            let answers = points.iter_mut().zip(&response.states);
            for ((point, state), _) in answers.zip(rough).filter(|(_, rough)| *rough) {
                if !point.tied && point.slipping.sticks(state, point.predicted_tractions) {
                    point.predicted = PredictedStatus::Stick;
                    any = true;
                }
            }
        }
        any
    }

    /// Stores the points as linearized in the tangent that was assembled at `u`, and counts those on which an aid acts.
    pub fn note(&mut self, model: &Model, u: &[f64], old: &State) {
        let aids = model.aids;
        std::mem::swap(&mut self.linearized, &mut self.next);
        self.linearized_at.clear();
        self.linearized_at.extend_from_slice(u);
        self.acted = Acted::default();
        let responses = self.linearized.iter().zip(&old.contacts);
        for ((points, pair), (response, old)) in self.points.iter().zip(&model.contacts).zip(responses) {
            for (k, (point, (state, old))) in points.iter().zip(response.states.iter().zip(old)).enumerate() {
                if let Some(closed) = response.closed(k) {
                    point.count(aids, pair, state, &closed, old, &mut self.acted);
                }
            }
        }
    }
}

/// Largest accepted ratio of the pressure of the start value to the committed one.
const MOST_GROWTH: f64 = 2.0;

/// Predicted traction of a point that is closed in the start value.
fn predicted_at_start(state: &ContactState, old: &ContactState, limit: bool) -> Tractions {
    let tractions = Tractions::of(state);
    if limit { tractions.limited(MOST_GROWTH * old.contact_pressure()) } else { tractions }
}

/// Whether the tangent of a point uses tractions other than its own.
fn prediction_acts(prediction: &Prediction, closed: &Closed) -> bool {
    prediction.predicted_tractions.is_some_and(|predicted_tractions| predicted_tractions != closed.tractions)
}

/// Range within which the penalty may draw back a point that was closed, in multiples of p/α_n.
const MOST_PULL: f64 = 10.0;

/// Separation by the start value within which it may do so, in multiples of the touch gap, 1e-9 of the slave's shortest edge.
const MOST_LIFT: f64 = 1e7;

/// Predicted traction, from the committed state, of a point that is open in the start value.
fn active_at_start(pair: &ContactPair, state: &ContactState, old: &ContactState) -> Tractions {
    let reach = old.contact_pressure() * (pair.compliance + MOST_PULL / pair.alpha_n);
    let closed = old.friction.pressure > 0.0;
    if closed && state.clearance() <= reach.max(MOST_LIFT * pair.touch) {
        Tractions::of(old)
    } else {
        Tractions::default()
    }
}

/// Whether a point is closed only because of a predicted pressure.
fn closes_the_point(prediction: &Prediction, closed: &Closed) -> bool {
    prediction.active_pressure > 0.0 && closed.tractions.pressure <= 0.0
}

/// Pressure used by friction at a point that has just closed; `None` at any other.
fn friction_pressure(pair: &ContactPair, was_closed: bool, state: &ContactState, stiffening: f64) -> Option<f64> {
    let closes = !was_closed && state.friction.pressure > 0.0;
    closes.then(|| pair.shared(state.contact_pressure(), stiffening))
}

/// Whether a closed point sticks because of the aid `touch`.
fn touch_acts(pair: &ContactPair, prediction: &Prediction, state: &ContactState, old: &ContactState) -> bool {
    touches(pair, state.clearance(), old, prediction.predicted)
}

/// Ratio to the slip at the last solve below which the slip of a point counts as abating.
const ABATES: f64 = 0.5;

/// α_t c above which the start value is more than the range of sticking off, with the compliance c of the bodies [-]
const STIFF: f64 = 20.0;

/// Returns whether a point that stuck in the last increment is predicted to stick in the first linear solve of the next.
fn sticks_on(pair: &ContactPair, slave: &SlavePoint, old: &ContactState) -> bool {
    let Description { stiffness, stiffness_is_penalty, .. } = pair.law(slave).description;
    let stiff = stiffness_is_penalty && stiffness * pair.compliance > STIFF;
    stiff && old.friction.pressure > 0.0 && old.friction.regime == Regime::Stick
}

/// Fraction of the frictional strength of a slipping point below which tractions would hold it.
const FAR_LOWER: f64 = 0.9;

/// Slip history of a point over the linear solves of the increment.
#[derive(Clone, Copy, Debug, Default)]
struct Slipping {
    /// Plastic slip of the increment at the last solve [L]
    slip: f64,
    /// Whether it was predicted to stick in the last solve
    stuck: bool,
}

impl Slipping {
    /// Records the slip from which the next linear solve starts; returns whether the point is predicted to stick. It is if it
    /// slips in the opposite direction to the last solve, or was predicted to stick and slips, but would not with the tractions
    /// predicted by that solve: it missed the narrow range of sticking only because of its own error.
    fn sticks(&mut self, state: &ContactState, predicted_tractions: Tractions) -> bool {
        let friction = &state.friction;
        let slip = friction.plastic_increment;
        let slips = friction.regime == Regime::Slip;
        // A point closed only by a prediction has a negative pressure.
        let of_bond = state.bond.map_or(0.0, |bond| bond.traction.abs());
        let strength =
            (friction.traction / friction.pressure).abs() * (predicted_tractions.pressure - state.pores) + of_bond;
        // A point that slips below its strength would also slip with these tractions, unless they are far lower or the slip
        // abates.
        let limit = if slip.abs() < ABATES * self.slip.abs() { strength } else { FAR_LOWER * strength };
        let sticks = match self.stuck {
            true => slips && predicted_tractions.traction.abs() < limit,
            false => self.slip * slip < 0.0,
        };
        self.slip = slip;
        sticks
    }
}

/// Segments of a point's projections in the linear solves of the increment.
#[derive(Clone, Copy, Debug, Default)]
struct MasterPoints {
    /// Projected segments at the last two solves
    last: [Option<usize>; 2],
    /// The two segments between which the projection alternates
    alternating: Option<[usize; 2]>,
}

impl MasterPoints {
    /// Records the segment from which the next linear solve starts.
    fn note(&mut self, state: &ContactState) {
        let segment = state.master_point.map(|master_point| master_point.segment);
        let [last, before] = self.last;
        self.alternating =
            segment.zip(last).filter(|(segment, last)| segment != last && Some(*segment) == before).map(Into::into);
        self.last = [segment, last];
    }
}

/// Whether the projection of a point is predicted to be the node between two segments, and is.
fn valley_acts(prediction: &Prediction, state: &ContactState) -> bool {
    prediction.alternating.is_some() && state.master_point.is_some_and(|master_point| master_point.xi == 1.0)
}

/// Contact status of every point at the last two iterates.
#[derive(Clone, Debug, Default)]
pub struct Flips([Vec<Regime>; 2]);

impl Flips {
    /// Returns the number of points with the same status as before the last iterate and a different one in it.
    pub fn count(&mut self, contacts: &[Vec<ContactState>]) -> usize {
        let now: Vec<Regime> = contacts.iter().flatten().map(ContactState::regime).collect();
        let [last, before] = std::mem::take(&mut self.0);
        let back = now.iter().zip(&last).zip(&before).filter(|((now, last), before)| now == before && now != last);
        let count = back.count();
        self.0 = [now, last];
        count
    }
}

/// Counts by name, and their columns.
macro_rules! counts {
    ($number:literal; $($(#[$meaning:meta])* $name:ident)*) => {
        /// Number of contact points on which each aid acted in the tangent of an iteration; 0 or 1 for aids unrelated to points. All
        /// are 0 where there was no new tangent.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct Acted {
            $($(#[$meaning])* pub $name: usize,)*
        }

        impl Acted {
            /// Columns of `newton.csv`.
            pub const COLUMNS: [&str; $number] = [$(concat!("aid_", stringify!($name))),*];

            /// Returns the counts in the order of the columns.
            pub fn counts(self) -> [usize; $number] {
                [$(self.$name),*]
            }
        }
    };
}

counts! { 14;
    /// the start value extrapolates the last increment
    start
    /// the geometric part of the tangent uses predicted tractions
    prediction
    /// these were limited at the start of the increment
    limit
    /// closed by the prediction alone
    active_set
    /// closed because of the committed state
    active_set_at_start
    /// friction uses a predicted pressure
    predicted_pressure
    /// closed and sticking because of zero gap
    touch
    /// sticks after slip in alternating directions
    stick
    /// sticks once more
    stick_again
    /// its projection is the node between two segments
    valley
    /// the iteration is on the contact nodes only
    condense
    /// the correction was shortened by a line search
    downhill
    /// the augmented Lagrangian is stiffened
    stiffening
    /// penalties are softened for an initial guess
    softening
}
