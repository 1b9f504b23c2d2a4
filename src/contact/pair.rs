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
    /// Tractions at the start of a contact that starts closed
    pub initial: Option<InitialTraction>,
}

/// Tractions that act at every point of a contact when the run starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialTraction {
    /// p [F/L²]
    pub pressure: f64,
    /// q [F/L²]
    pub traction: f64,
}

/// Fewer points than this are not worth waking other threads for.
const FEW: usize = 64;

/// Trial states and contributions of all points of a pair, in their order.
pub type PairResponse = Vec<(ContactState, Option<Contribution>)>;

impl ContactPair {
    /// Start closed: from now on every point's gap is counted so that the given pressure acts in the configuration `x`.
    ///
    /// ```text
    /// p = p_init + α_n (g_x − g)        g_x: gap between the surfaces in the configuration x
    /// ```
    ///
    /// # Errors
    /// The number of the first point that no part of the master faces.
    pub fn start_closed(&mut self, initial: InitialTraction, x: &Configuration) -> Result<(), usize> {
        let index = Index::new(&self.master, x);
        for (k, slave) in self.points.iter_mut().enumerate() {
            slave.touch = index.project(slave, None, x).ok_or(k)?.gap + initial.pressure / self.alpha_n;
        }
        self.initial = Some(initial);
        Ok(())
    }

    /// States at the start of a run: each point projected in the configuration `x`, friction at rest or, in a contact
    /// that starts closed, under its initial tractions.
    pub fn initial_states(&self, x: &Configuration) -> Vec<ContactState> {
        let index = Index::new(&self.master, x);
        let mut friction = self.law.initial_state();
        if let Some(InitialTraction { pressure, traction }) = self.initial {
            friction = FrictionState { pressure, traction, ..friction };
        }
        let state = |slave: &SlavePoint| {
            let projection = index.project(slave, None, x);
            ContactState {
                friction,
                foot: projection.map(|p| p.foot),
                gap: projection.map_or(0.0, |p| p.gap - slave.touch),
            }
        };
        self.points.iter().map(state).collect()
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
