//! A slave surface, its master, and the laws between them, evaluated point by point.

use std::ops::Range;

use rayon::prelude::*;

use super::force::{ContactState, Increment, Meeting, Presume, closes, open, press, respond};
use super::mortar::Mortar;
use super::search::Index;
use super::surface::{Master, MasterPoint, SlavePoint};
use crate::configuration::Configuration;
use crate::friction::{FrictionLaw, FrictionState, LawFailure};
use crate::system::Contribution;

/// Two surfaces that may touch.
#[derive(Debug)]
pub struct ContactPair {
    /// Name in the case file
    pub name: String,
    /// Points of the slave surface, in order along it
    pub points: Vec<SlavePoint>,
    /// The master
    pub master: Master,
    /// The slave's edges if contact is averaged over them; else it is evaluated point by point
    pub mortar: Option<Mortar>,
    /// α_n: normal penalty stiffness [F/L³]
    pub alpha_n: f64,
    /// Largest penetration left by the augmented Lagrangian; plain penalty if not given [L]
    pub penetration: Option<f64>,
    /// The friction law
    pub law: Box<dyn FrictionLaw>,
}

/// Trial states and contributions of all points of a pair, in their order.
pub type PairResponse = Vec<(ContactState, Option<Contribution>)>;

impl ContactPair {
    /// States at the start of a run: each point projected in the configuration `x`, friction at rest.
    pub fn initial_states(&self, x: &Configuration) -> Vec<ContactState> {
        let index = Index::new(&self.master, x);
        let met: Vec<Option<(f64, MasterPoint)>> = match (&self.mortar, &self.master) {
            (Some(mortar), Master::Mesh(surface)) => {
                let overlaps = mortar.overlaps(surface, &index, x);
                let meet = |k| mortar.kinematics(k, surface, &overlaps, None, x);
                (0..self.points.len()).map(|k| meet(k).map(|met| (met.gap, met.foot))).collect()
            }
            _ => self.points.iter().map(|slave| index.project(slave, None, x).map(|p| (p.gap, p.foot))).collect(),
        };
        let at_rest = |met: Option<(f64, MasterPoint)>| {
            let (gap, foot) = met.unzip();
            ContactState { friction: self.law.initial_state(), foot, gap: gap.unwrap_or(0.0), multiplier: 0.0 }
        };
        met.into_iter().map(at_rest).collect()
    }

    /// Every point's trial state and contribution in the configuration `x`, each with its own presumption and, if it is
    /// held on one, its segment; `before` is the committed configuration. Pure, and the same for any number of threads.
    ///
    /// # Errors
    /// The number of the first point whose friction law fails, and why.
    pub fn respond(
        &self,
        old: &[ContactState],
        before: &Configuration,
        dt: f64,
        presumed: impl Fn(usize) -> (Presume, Option<usize>) + Sync,
        x: &Configuration,
    ) -> Result<PairResponse, (usize, LawFailure)> {
        let index = Index::new(&self.master, x);
        // The first failure by number, whatever thread met it.
        let all: Vec<_> = match (&self.mortar, &self.master) {
            (Some(mortar), Master::Mesh(surface)) => {
                let was = mortar.overlaps(surface, &Index::new(&self.master, before), before);
                let is = mortar.overlaps(surface, &index, x);
                let one = |(k, (slave, old)): (usize, (&SlavePoint, &ContactState))| {
                    let increment = Increment { dt, presume: presumed(k).0 };
                    let weights = mortar.weights(k, surface, &was, before);
                    let answer = match mortar.kinematics(k, surface, &is, weights.as_ref(), x) {
                        None => open(self, None, old, increment),
                        Some(Meeting { gap, foot, .. }) if !closes(self, slave, gap, old, increment, x) => {
                            open(self, Some((gap, foot)), old, increment)
                        }
                        Some(meeting) => press(self, meeting, old, increment),
                    };
                    answer.map_err(|failure| (k, failure))
                };
                self.points.par_iter().zip(old).enumerate().map(one).collect()
            }
            _ => {
                let one = |(k, (slave, old)): (usize, (&SlavePoint, &ContactState))| {
                    let (presume, held) = presumed(k);
                    respond(self, slave, index.project(slave, held, x), old, Increment { dt, presume }, x)
                        .map_err(|failure| (k, failure))
                };
                self.points.par_iter().zip(old).enumerate().map(one).collect()
            }
        };
        all.into_iter().collect()
    }
}

impl ContactPair {
    /// Take the pressures over as multipliers, p̄ ← p, if the gap of some point under pressure is too large (Uzawa's
    /// method); otherwise `None`.
    pub fn augmented(&self, old: &[ContactState], trial: &[ContactState]) -> Option<Vec<ContactState>> {
        let tolerance = self.penetration?;
        let too_far = |state: &ContactState| state.friction.pressure > 0.0 && state.gap.abs() > tolerance;
        // A multiplier that no pressure answers to any more must go as well.
        let stale = |(old, new): (&ContactState, &ContactState)| old.multiplier > 0.0 && new.friction.pressure == 0.0;
        let multiplied = |(old, new): (&ContactState, &ContactState)| ContactState { multiplier: new.friction.pressure, ..*old };
        (trial.iter().any(too_far) || old.iter().zip(trial).any(stale))
            .then(|| old.iter().zip(trial).map(multiplied).collect())
    }

    /// Elastic part of the slip, q/α_t; 0 for a frictionless contact [L].
    pub fn elastic_slip(&self, friction: &FrictionState) -> f64 {
        let stiffness = self.law.stiffness();
        if stiffness > 0.0 { friction.traction / stiffness } else { 0.0 }
    }

    /// Ranges of points that follow each other along an unbroken surface.
    pub fn lines(&self) -> Vec<Range<usize>> {
        let nodes = |point: &SlavePoint| -> Vec<usize> {
            point.length.iter().flat_map(|share| share.tangent.iter().map(|&(node, _)| node)).collect()
        };
        let joined = |a: usize, b: usize| {
            let after = nodes(&self.points[b]);
            nodes(&self.points[a]).iter().any(|node| after.contains(node))
        };
        let mut lines: Vec<Range<usize>> = Vec::new();
        for k in 0..self.points.len() {
            match lines.last_mut() {
                Some(line) if joined(k - 1, k) => line.end = k + 1,
                _ => lines.push(k..k + 1),
            }
        }
        lines
    }
}
