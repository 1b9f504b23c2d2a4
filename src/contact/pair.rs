//! A slave surface, its master, and the laws between them, evaluated point by point.

use std::ops::Range;

use rayon::prelude::*;

use super::force::{ContactState, Increment, Presume, respond};
use super::kinematics::kinematics;
use super::search::Index;
use super::surface::{Master, SlavePoint};
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
    /// α_n: normal penalty stiffness [F/L³]
    pub alpha_n: f64,
    /// The friction law
    pub law: Box<dyn FrictionLaw>,
}

/// Points that are answered sooner than other threads wake up.
const FEW: usize = 16;

/// Trial states and contributions of all points of a pair, in their order.
pub type PairResponse = Vec<(ContactState, Option<Contribution>)>;

impl ContactPair {
    /// States at the start of a run: each point projected in the configuration `x`, friction at rest.
    pub fn initial_states(&self, x: &Configuration) -> Vec<ContactState> {
        let index = Index::new(&self.master, x);
        let at_rest = |slave| {
            let projection = index.project(slave, None, x);
            ContactState {
                friction: self.law.initial_state(),
                foot: projection.map(|p| p.foot),
                gap: projection.map_or(0.0, |p| p.gap),
            }
        };
        self.points.iter().map(at_rest).collect()
    }

    /// Every point's trial state and contribution in the configuration `x`, each with its own presumption and, if it is
    /// held on one, its segment; pure, and the same for any number of threads.
    ///
    /// # Errors
    /// The number of the first point whose friction law fails, and why.
    pub fn respond(
        &self,
        old: &[ContactState],
        dt: f64,
        presumed: impl Fn(usize) -> (Presume, Option<usize>) + Sync,
        x: &Configuration,
    ) -> Result<PairResponse, (usize, LawFailure)> {
        let index = Index::new(&self.master, x);
        let one = |(k, (slave, old)): (usize, (&SlavePoint, &ContactState))| {
            let (presume, held) = presumed(k);
            respond(self, slave, index.project(slave, held, x), old, Increment { dt, presume }, x)
                .map_err(|failure| (k, failure))
        };
        if self.points.len() < FEW {
            return self.points.iter().zip(old).enumerate().map(one).collect();
        }
        // The first failure by number, whatever thread met it.
        let all: Vec<_> = self.points.par_iter().zip(old).enumerate().map(one).collect();
        all.into_iter().collect()
    }
}

impl ContactPair {
    /// Rate at which each point slips along +s under nodal velocities, the variation of Δu_t; 0 where nothing faces it
    /// [L/T].
    pub fn slip_rates(&self, states: &[ContactState], x: &Configuration, velocity: &[f64]) -> Vec<f64> {
        let index = Index::new(&self.master, x);
        let rate = |(slave, state): (&SlavePoint, &ContactState)| {
            let segment = state.foot.map(|foot| foot.segment);
            let Some(projection) = index.project(slave, segment, x) else { return 0.0 };
            let k = kinematics(slave, &self.master, &projection, state.foot, x);
            let dofs = k.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]);
            dofs.zip(&k.dslip).map(|(dof, dslip)| velocity[dof] * dslip).sum()
        };
        self.points.iter().zip(states).map(rate).collect()
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
