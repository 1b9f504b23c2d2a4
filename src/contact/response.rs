//! The response of a contact pair, point by point.

use rayon::prelude::*;

use super::closed::PairResponse;
use super::force::{Loading, PointPlace, closes, place};
use super::kinematics::Meeting;
use super::master::Master;
use super::pair::ContactPair;
use super::presumption::{ContactIncrement, PointIncrement, Presumption};
use super::search::Index;
use super::state::ContactState;
use super::surface::SlavePoint;
use crate::laws::friction::{Answer, FrictionResponse, FrictionState, LawFailure, Sliding};
use crate::mesh::configuration::Configuration;

/// Fewer points than this are not worth waking other threads for.
const FEW: usize = 64;

/// Points whose laws are asked in one go.
const TOGETHER: usize = 16;

impl ContactPair {
    /// Every point's trial state and contribution in the configuration `x`, each with its own presumption; `before`
    /// is the committed configuration. Pure, and the same for any number of threads.
    ///
    /// # Errors
    /// The number of the first point whose friction law fails, and why.
    pub fn respond(
        &self,
        old: &[ContactState],
        before: &Configuration,
        during: ContactIncrement,
        presumed: impl Fn(usize) -> Presumption + Sync,
        x: &Configuration,
    ) -> Result<PairResponse, (usize, LawFailure)> {
        let increment = |k| PointIncrement { during, presumption: presumed(k) };
        if let Some(small) = &self.small {
            return self.each(old, increment, |k, slave, old, increment| {
                let meeting = small.points[k].as_ref().map(|point| point.meeting(before, x));
                averaged(self, slave, meeting, old, increment, x)
            });
        }
        let index = Index::within(&self.master, before, x);
        if let (Some(mortar), Master::Mesh(surface)) = (&self.mortar, &self.master) {
            let was = mortar.overlaps(surface, &Index::new(&self.master, before), before);
            let is = mortar.overlaps(surface, &index, x);
            return self.each(old, increment, |k, slave, old, increment| {
                let weights = mortar.weights(k, surface, &was, before);
                let mut meeting = mortar.kinematics(k, surface, &is, weights.as_ref(), x);
                if let (Some(meeting), None) = (&mut meeting, &weights) {
                    meeting.kinematics.count_from(before, x);
                }
                averaged(self, slave, meeting, old, increment, x)
            });
        }
        if let (Some(mortar), Master::Rigid(body)) = (&self.mortar, &self.master) {
            return self.each(old, increment, |k, slave, old, increment| {
                averaged(self, slave, mortar.on_rigid(k, body, before, x), old, increment, x)
            });
        }
        self.each(old, increment, |_, slave, old, increment| {
            let valley = increment.presumption.astride.and_then(|segments| index.in_valley(slave, segments, x));
            let projection = valley.or_else(|| index.project(slave, old.foot, x));
            place(self, slave, projection, old, increment, [before, x])
        })
    }

    /// One answer a point, some points at a time: where they are, what their laws say, what follows. The first failure by
    /// number, whatever thread met it.
    fn each(
        &self,
        old: &[ContactState],
        increment: impl Fn(usize) -> PointIncrement + Sync,
        place: impl Fn(usize, &SlavePoint, &ContactState, PointIncrement) -> PointPlace + Sync,
    ) -> Result<PairResponse, (usize, LawFailure)> {
        let some = |(chunk, (points, old)): (usize, (&[SlavePoint], &[ContactState]))| -> Result<PairResponse, _> {
            let numbers = chunk * TOGETHER..;
            let loadings: Vec<Loading> = numbers
                .clone()
                .zip(points.iter().zip(old))
                .map(|(k, (slave, old))| {
                    let increment = increment(k);
                    Loading::new(self, slave, old, increment, place(k, slave, old, increment))
                })
                .collect();
            let answers = self.answers(points, old, &loadings);
            let finished = loadings.into_iter().zip(answers).zip(numbers);
            finished.map(|((loading, answer), k)| loading.finish(answer).map_err(|failure| (k, failure))).collect()
        };
        let parts: Result<Vec<PairResponse>, _> = match self.points.len() < FEW {
            true => self.points.chunks(TOGETHER).zip(old.chunks(TOGETHER)).enumerate().map(some).collect(),
            false => {
                let chunks = self.points.par_chunks(TOGETHER).zip(old.par_chunks(TOGETHER)).enumerate();
                let all: Vec<_> = chunks.map(some).collect();
                all.into_iter().collect()
            }
        };
        Ok(parts?.into_iter().flatten().collect())
    }

    /// What the laws of consecutive points say.
    fn answers(&self, points: &[SlavePoint], old: &[ContactState], loadings: &[Loading]) -> Vec<Answer> {
        let committed: Vec<FrictionState> = old.iter().map(|old| old.friction).collect();
        let sliding: Vec<Sliding> = loadings.iter().map(|loading| loading.sliding).collect();
        let mut answers = vec![Ok(FrictionResponse::default()); points.len()];
        let mut start = 0;
        for alike in points.chunk_by(|a, b| a.law == b.law) {
            let range = start..start + alike.len();
            start = range.end;
            self.law(&alike[0]).respond_many(&committed[range.clone()], &sliding[range.clone()], &mut answers[range]);
        }
        answers
    }
}

/// Where a point is that meets the master so, its gap still being that of the surfaces.
fn averaged(
    pair: &ContactPair,
    slave: &SlavePoint,
    meeting: Option<Meeting>,
    old: &ContactState,
    increment: PointIncrement,
    x: &Configuration,
) -> PointPlace {
    let Some(Meeting { kinematics, gap, foot }) = meeting else { return PointPlace::default() };
    let gap = slave.gap(gap, increment.during.fading);
    let kinematics = closes(pair, slave, gap, old, increment, x).then_some(kinematics);
    PointPlace { gap, foot: Some(foot), kinematics }
}
