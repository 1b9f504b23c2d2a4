//! The response of a contact pair, point by point.

use rayon::prelude::*;

use super::closed::PairResponse;
use super::force::{PointResponse, closes, open, press, respond};
use super::kinematics::Meeting;
use super::master::Master;
use super::pair::ContactPair;
use super::presumption::{ContactIncrement, Increment, Presumption};
use super::search::Index;
use super::state::ContactState;
use super::surface::SlavePoint;
use crate::laws::friction::LawFailure;
use crate::mesh::configuration::Configuration;

/// Fewer points than this are not worth waking other threads for.
const FEW: usize = 64;

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
        let index = Index::within(&self.master, before, x);
        if let (Some(mortar), Master::Mesh(surface)) = (&self.mortar, &self.master) {
            let was = mortar.overlaps(surface, &Index::new(&self.master, before), before);
            let is = mortar.overlaps(surface, &index, x);
            return self.each(old, |k, slave, old| {
                let increment = Increment { during, presumption: presumed(k) };
                let weights = mortar.weights(k, surface, &was, before);
                let Some(mut meeting) = mortar.kinematics(k, surface, &is, weights.as_ref(), x) else {
                    return open(self, slave, None, old, increment);
                };
                if weights.is_none() {
                    meeting.kinematics.count_from(before, x);
                }
                answer(self, slave, meeting, old, increment, x)
            });
        }
        if let (Some(mortar), Master::Rigid(body)) = (&self.mortar, &self.master) {
            return self.each(old, |k, slave, old| {
                let increment = Increment { during, presumption: presumed(k) };
                match mortar.on_rigid(k, body, before, x) {
                    Some(meeting) => answer(self, slave, meeting, old, increment, x),
                    None => open(self, slave, None, old, increment),
                }
            });
        }
        self.each(old, |k, slave, old| {
            let increment = Increment { during, presumption: presumed(k) };
            let valley = increment.presumption.astride.and_then(|segments| index.in_valley(slave, segments, x));
            let projection = valley.or_else(|| index.project(slave, old.foot, x));
            respond(self, slave, projection, old, increment, [before, x])
        })
    }

    /// One answer a point; the first failure by number, whatever thread met it.
    fn each(
        &self,
        old: &[ContactState],
        answer: impl Fn(usize, &SlavePoint, &ContactState) -> PointResponse + Sync,
    ) -> Result<PairResponse, (usize, LawFailure)> {
        let one = |(k, (slave, old)): (usize, (&SlavePoint, &ContactState))| {
            answer(k, slave, old).map_err(|failure| (k, failure))
        };
        if self.points.len() < FEW {
            return self.points.iter().zip(old).enumerate().map(one).collect();
        }
        let all: Vec<_> = self.points.par_iter().zip(old).enumerate().map(one).collect();
        all.into_iter().collect()
    }
}

/// The answer of a point whose average is known; its gap is still that of the surfaces.
fn answer(
    pair: &ContactPair,
    slave: &SlavePoint,
    mut meeting: Meeting,
    old: &ContactState,
    increment: Increment,
    x: &Configuration,
) -> PointResponse {
    meeting.gap = slave.gap(meeting.gap, increment.during.fading);
    match closes(pair, slave, meeting.gap, old, increment, x) {
        true => press(pair, slave, meeting, old, increment),
        false => open(pair, slave, Some((meeting.gap, meeting.foot)), old, increment),
    }
}
