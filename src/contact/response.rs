//! Response of a contact pair, point by point.

use std::borrow::Cow;
use std::sync::Arc;

use rayon::prelude::*;

use super::force::{PointEvaluation, PointPlace, closes, place};
use super::kinematics::{Kinematics, Meeting};
use super::master::{Master, Rigid};
use super::mortar::{Committed, Facing, Mortar, Overlaps, Room};
use super::nodal_forces::{Closed, ClosedPoints};
use super::pair::ContactPair;
use super::point::{ContactIncrement, ContactState, MasterPoint, PointIncrement, Prediction, Weights};
use super::seam::Seam;
use super::search::{Index, KeptSearch};
use super::small_sliding::SmallPoint;
use super::surface::SlavePoint;
use crate::laws::friction::{Answer, ContactLaw, FrictionResponse, FrictionState, LawFailure, Sliding};
use crate::linear::system::Request;
use crate::mesh::configuration::Configuration;

/// Number of points that one thread evaluates at a time; fewer points are evaluated by one thread.
const PART: usize = 64;

/// Number of points whose laws are evaluated together.
const TOGETHER: usize = 16;

/// Trial states of all points of a pair, in order, and the contributions of closed ones to the equations. Passed from one
/// evaluation of the pair to the next to reuse its lists.
#[derive(Clone, Debug, Default)]
pub struct PairResponse {
    /// Trial states
    pub states: Vec<ContactState>,
    /// Answers of the laws; they may come from another evaluation of the pair
    pub answered: LastAnswers,
    parts: Vec<Chunk>,
    kept: Kept,
}

/// Answers of the laws of a pair at its last evaluation. They are pure: asked the same again, as for the tangent of what a residual
/// was found for, they need not be asked.
#[derive(Clone, Debug, Default)]
pub struct LastAnswers(Vec<Together>);

/// Questions to the laws of some points in a row, and their answers.
#[derive(Clone, Debug)]
struct Together {
    laws: Vec<Arc<ContactLaw>>,
    old: [FrictionState; TOGETHER],
    sliding: [Sliding; TOGETHER],
    answers: [Answer; TOGETHER],
}

/// Search data that are reused while they stay valid.
#[derive(Clone, Debug, Default)]
struct Kept {
    /// Search on the master
    search: KeptSearch,
    /// Mortar weights in the committed configuration, and mortar segments in the trial configuration
    committed: Committed,
    overlaps: Overlaps,
}

/// Points evaluated by one thread.
#[derive(Clone, Debug, Default)]
struct Chunk {
    closed: ClosedPoints,
    /// Kinematics of the current points
    kinematics: Vec<Kinematics>,
    /// Buffer for averages
    room: Room,
    failure: Option<(usize, LawFailure)>,
}

impl PairResponse {
    /// Takes the states over without a contribution, as the pair does not act.
    pub fn rest(&mut self, old: &[ContactState]) {
        self.states.clear();
        self.states.extend_from_slice(old);
        self.parts.clear();
    }

    /// Contribution of a point to the equations, if it is closed.
    pub fn closed(&self, point: usize) -> Option<Closed<'_>> {
        self.acting(point).filter(|closed| !closed.is_open)
    }

    /// Contribution of a point to the equations, if it is closed or in a fluid.
    pub fn acting(&self, point: usize) -> Option<Closed<'_>> {
        self.parts.get(point / PART)?.closed.get(point % PART)
    }

    /// Points that are closed or under fluid pressure.
    pub fn all_acting(&self) -> impl Iterator<Item = (&ContactState, Closed<'_>)> {
        self.numbered().map(|(_, acting)| acting)
    }

    /// The same with their numbers.
    pub fn numbered(&self) -> impl Iterator<Item = (usize, (&ContactState, Closed<'_>))> {
        self.states.iter().enumerate().filter_map(|(k, state)| Some((k, (state, self.acting(k)?))))
    }
}

/// Points that one thread evaluates, what their laws answered, and their states.
type Part<'a> = ((&'a mut Chunk, &'a mut [Together]), &'a mut [ContactState]);

/// Input of one evaluation, common to all points.
struct Question<'a, P> {
    pair: &'a ContactPair,
    /// Laws of the increment
    laws: Cow<'a, [Arc<ContactLaw>]>,
    /// Increment of a point, and its predictions
    during: ContactIncrement,
    prediction_of: P,
    locating: Locating<'a>,
    before: &'a Configuration<'a>,
    x: &'a Configuration<'a>,
    varied: bool,
}

/// How the points of a pair are located on its master.
enum Locating<'a> {
    /// Where they were in the reference configuration
    Small(&'a [Option<SmallPoint>]),
    /// By averages over the edges that face a mesh surface
    Averaged(Facing<'a>, &'a Committed),
    /// By averages over the edges that face a rigid body
    AveragedOnRigid(&'a Mortar, &'a Rigid),
    /// By their projections
    Projected(Index<'a>),
}

impl<'a> Locating<'a> {
    fn of(pair: &'a ContactPair, [before, x]: [&'a Configuration<'a>; 2], kept: &'a mut Kept) -> Self {
        if let Some(small) = &pair.small {
            return Self::Small(&small.points);
        }
        let Kept { search, committed, overlaps } = kept;
        match (&pair.mortar, &pair.master) {
            (Some(mortar), Master::Rigid(body)) => Self::AveragedOnRigid(mortar, body),
            (Some(mortar), Master::Mesh(surface)) => {
                let index = Index::kept(&pair.master, [before, x], search);
                mortar.commit(&pair.master, surface, before, committed);
                mortar.cut(surface, &index, [before, x], overlaps);
                Self::Averaged(mortar.facing(surface, overlaps, committed.ridges()), committed)
            }
            (None, _) => Self::Projected(Index::kept(&pair.master, [before, x], search)),
        }
    }
}

impl ContactPair {
    /// Evaluates every point's trial state and contribution to the equations in the configuration `x`, each with its own
    /// prediction, and the tangent on request; `before` is the committed configuration. Pure, and the same for any number of
    /// threads: only the memory of `response` is reused.
    ///
    /// # Errors
    /// Returns the number of the first point whose friction law fails, whatever thread met it, and the failure.
    pub fn respond(
        &self,
        old: &[ContactState],
        [before, x]: [&Configuration; 2],
        during: ContactIncrement,
        prediction_of: impl Fn(usize) -> Prediction + Sync,
        request: Request,
        response: &mut PairResponse,
    ) -> Result<(), (usize, LawFailure)> {
        let laws = self.laws_during(during.span())?;
        let PairResponse { states, answered: LastAnswers(answered), parts, kept } = response;
        let locating = Locating::of(self, [before, x], kept);
        let varied = request == Request::Tangent;
        let question = Question { pair: self, laws, during, prediction_of, locating, before, x, varied };
        states.clear();
        states.extend_from_slice(old);
        answered.resize_with(self.points.len().div_ceil(TOGETHER), Together::default);
        parts.resize_with(self.points.len().div_ceil(PART), Chunk::default);
        let one = |(number, ((part, answered), states)): (usize, Part)| {
            let numbers = PART * number..PART * number + states.len();
            part.evaluate(&question, numbers, old, (states, answered));
        };
        const ANSWERED: usize = PART / TOGETHER;
        match parts.len() {
            0 | 1 => {
                let parts = parts.iter_mut().zip(answered.chunks_mut(ANSWERED));
                parts.zip(states.chunks_mut(PART)).enumerate().for_each(one);
            }
            _ => {
                let parts = parts.par_iter_mut().zip(answered.par_chunks_mut(ANSWERED));
                parts.zip(states.par_chunks_mut(PART)).enumerate().for_each(one);
            }
        }
        parts.iter_mut().find_map(|part| part.failure.take()).map_or(Ok(()), Err)
    }
}

impl<P> Question<'_, P> {
    /// Locates a point, and computes its kinematics if it is closed.
    fn place(
        &self,
        k: usize,
        old: &ContactState,
        increment: PointIncrement,
        kinematics: &mut Kinematics,
        room: &mut Room,
    ) -> PointPlace {
        let Self { pair, before, x, .. } = *self;
        let slave = &pair.points[k];
        let meeting = match &self.locating {
            Locating::Small(points) => points[k].as_ref().map(|point| point.meet(before, x, kinematics)),
            Locating::Averaged(facing, committed) => {
                let weights = committed.weights(k);
                let meeting = facing.meet(k, weights, x, kinematics, room);
                if meeting.is_some() && weights.is_none() {
                    kinematics.count_from(None, before, x);
                }
                meeting
            }
            Locating::AveragedOnRigid(mortar, body) => mortar.meet_rigid(k, body, [before, x], kinematics, room),
            Locating::Projected(index) => {
                let valley = increment.prediction.alternating.and_then(|segments| index.in_valley(slave, segments, x));
                let projection = valley.or_else(|| index.project(slave, old.master_point, x));
                return place(pair, slave, projection, old, increment, [before, x], kinematics);
            }
        };
        averaged(pair, slave, meeting, old, increment, x)
    }

    /// Adds the water of the bodies at a located point to its kinematics; returns its pressure.
    fn add_water(&self, seam: &Seam, (k, old): (usize, &ContactState), gap: f64, kinematics: &mut Kinematics) -> f64 {
        let seeps = self.during.seeps * old.length;
        let (mut water, behind) = seam.meet(&self.pair.points[k], &self.weights(k, old), self.x, seeps);
        if let Some(open) = &seam.open {
            water.outside = open.pressure;
            water.drains = open.at(gap - old.friction.opening).map(|conducts| conducts * seeps);
        }
        water.count_from(old.master_point.map(|_| old.gap * old.length), gap, kinematics.length);
        kinematics.dpores.resize(if self.varied { 2 * behind.len() } else { 0 }, 0.0);
        kinematics.behind.extend(behind);
        let pressure = water.pressure();
        kinematics.water = Some(water);
        pressure
    }

    /// Weights of x_s − x_m of a point at the start of the increment; those of x_s alone where it faced nothing, or a rigid body.
    fn weights(&self, k: usize, old: &ContactState) -> Weights {
        let own = &self.pair.points[k].position;
        match (&self.locating, &self.pair.master, old.master_point) {
            (Locating::Small(points), ..) => {
                let weights = |point: &SmallPoint| point.nodes.iter().copied().zip(point.weights.clone()).collect();
                points[k].as_ref().map_or_else(Weights::new, weights)
            }
            (Locating::Averaged(_, committed), ..) => committed.weights(k).unwrap_or(own).clone(),
            (Locating::Projected(_), Master::Mesh(surface), Some(MasterPoint { segment, xi })) => {
                let projected = surface.segments[segment].position(xi);
                own.iter().copied().chain(projected.iter().map(|&(node, w)| (node, -w))).collect()
            }
            _ => own.clone(),
        }
    }
}

impl Chunk {
    /// Evaluates several points: location, responses of their laws, resulting states.
    fn evaluate<P: Fn(usize) -> Prediction>(
        &mut self,
        question: &Question<P>,
        numbers: std::ops::Range<usize>,
        old: &[ContactState],
        (states, answered): (&mut [ContactState], &mut [Together]),
    ) {
        let Question { pair, ref laws, during, .. } = *question;
        let Self { closed, kinematics, room, failure } = self;
        closed.clear();
        kinematics.resize_with(TOGETHER.min(numbers.len()), Kinematics::default);
        for ((first, states), answered) in numbers.step_by(TOGETHER).zip(states.chunks_mut(TOGETHER)).zip(answered) {
            let together = first..first + states.len();
            let (points, old) = (&pair.points[together.clone()], &old[together]);
            let mut loadings = [const { None }; TOGETHER];
            let mut sliding = [Sliding { slip: 0.0, pressure: 0.0, dt: 0.0 }; TOGETHER];
            for (i, kinematics) in kinematics.iter_mut().take(points.len()).enumerate() {
                let (slave, old) = (&points[i], &old[i]);
                let increment = PointIncrement { during, prediction: (question.prediction_of)(first + i) };
                kinematics.varied = question.varied;
                kinematics.behind.clear();
                kinematics.dpores.clear();
                kinematics.water = None;
                let mut place = question.place(first + i, old, increment, kinematics, room);
                if let Some(pores) = pair.pores.as_ref().filter(|_| place.closes) {
                    place.pore_pressure = Some(pores[first + i].vary(question.x, kinematics));
                }
                if let Some(seam) = pair.seam.as_ref().filter(|_| place.master_point.is_some()) {
                    place.fluid = question.add_water(seam, (first + i, old), place.gap, kinematics);
                }
                match PointEvaluation::new(pair, slave, &laws[slave.law], old, increment, place, kinematics) {
                    Ok(loading) => {
                        sliding[i] = loading.sliding;
                        loadings[i] = Some(loading);
                    }
                    Err(cause) => {
                        *failure = Some((first + i, cause));
                        return;
                    }
                }
            }
            let answers = answered.answers(laws, points, old, &sliding[..points.len()]);
            for (i, (loading, answer)) in loadings.into_iter().flatten().zip(answers).enumerate() {
                match loading.finish(answer.clone(), closed) {
                    Ok(state) => states[i] = state,
                    Err(cause) => {
                        *failure = Some((first + i, cause));
                        return;
                    }
                }
            }
        }
    }
}

impl Default for Together {
    fn default() -> Self {
        Self {
            laws: Vec::new(),
            old: std::array::from_fn(|_| FrictionState::default()),
            sliding: [Sliding { slip: 0.0, pressure: 0.0, dt: 0.0 }; TOGETHER],
            answers: std::array::from_fn(|_| Ok(FrictionResponse::default())),
        }
    }
}

impl Together {
    /// Responses of the laws of consecutive points.
    fn answers(
        &mut self,
        laws: &[Arc<ContactLaw>],
        points: &[SlavePoint],
        old: &[ContactState],
        sliding: &[Sliding],
    ) -> &[Answer] {
        if !self.were_asked(laws, points, old, sliding) {
            self.laws.clear();
            self.laws.extend(points.iter().map(|slave| laws[slave.law].clone()));
            self.old.iter_mut().zip(old).for_each(|(own, old)| own.clone_from(&old.friction));
            self.sliding[..sliding.len()].copy_from_slice(sliding);
            let mut start = 0;
            for alike in points.chunk_by(|a, b| a.law == b.law) {
                let range = start..start + alike.len();
                start = range.end;
                let (old, sliding) = (&self.old[range.clone()], &self.sliding[range.clone()]);
                laws[alike[0].law].respond_many(old, sliding, &mut self.answers[range]);
            }
        }
        &self.answers[..points.len()]
    }

    /// Whether these are the last questions, to the last bit, to the same laws.
    fn were_asked(
        &self,
        laws: &[Arc<ContactLaw>],
        points: &[SlavePoint],
        old: &[ContactState],
        sliding: &[Sliding],
    ) -> bool {
        let same_laws = || self.laws.iter().zip(points).all(|(own, slave)| Arc::ptr_eq(own, &laws[slave.law]));
        let same_sliding = || self.sliding.iter().zip(sliding).all(|(own, sliding)| own.is_same(sliding));
        let same_old = || self.old.iter().zip(old).all(|(own, old)| own.is_same(&old.friction));
        self.laws.len() == points.len() && same_sliding() && same_laws() && same_old()
    }
}

/// Kinematic state of a point with this projection, before its gap is corrected for overlap.
fn averaged(
    pair: &ContactPair,
    slave: &SlavePoint,
    meeting: Option<Meeting>,
    old: &ContactState,
    increment: PointIncrement,
    x: &Configuration,
) -> PointPlace {
    let Some(Meeting { gap, master_point }) = meeting else { return PointPlace::default() };
    let gap = slave.gap(gap - old.came.gap, increment.during.fading);
    let fluid = pair.acting_pressure(slave, old, x, increment.during.time);
    PointPlace {
        gap,
        master_point: Some(master_point),
        closes: closes(pair, slave, gap, old, increment),
        bonded: pair.reaches(slave, gap, old, increment),
        fluid,
        pore_pressure: None,
    }
}
