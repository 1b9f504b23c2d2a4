//! A slave surface, its master, and the laws between them, evaluated point by point.

use std::collections::BTreeSet;
use std::ops::Range;

use nalgebra::Vector2;
use rayon::prelude::*;

use super::force::{
    Closed, ContactState, Increment, Meeting, PointResponse, Presume, Tractions, closes, nodal_forces, open, press,
    respond,
};
use super::kinematics::{Kinematics, kinematics};
use super::mortar::Mortar;
use super::search::Index;
use super::surface::{Master, SlavePoint};
use crate::laws::friction::{FrictionLaw, FrictionState, LawFailure, Sliding};
use crate::mesh::configuration::Configuration;

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
    /// c: how far a pressure pushes the bodies in, about the depth of an element over λ + 2G; 0 for points without elements
    /// [L³/F]
    pub compliance: f64,
    /// Largest penetration left by the augmented Lagrangian; plain penalty if not given [L]
    pub penetration: Option<f64>,
    /// The friction laws, each with the parameters of some of the points
    pub laws: Vec<Box<dyn FrictionLaw>>,
    /// Tractions of every point at the start of a contact that starts closed
    pub initial: Option<Vec<InitialTraction>>,
    /// The two sides the other way round, to see what the slave's points do not: how deep master nodes lie in the slave
    pub reverse: Option<Reverse>,
}

/// The nodes of a mesh master as points, and the slave as their master.
#[derive(Clone, Debug)]
pub struct Reverse {
    /// Master nodes
    pub nodes: Vec<SlavePoint>,
    /// Slave surface
    pub slave: Master,
}

/// Tractions that act at a point of a contact when the run starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialTraction {
    /// p [F/L²]
    pub pressure: f64,
    /// q [F/L²]
    pub traction: f64,
}

/// Touch of a point within an increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// When it was foreseen, as a share of the increment; 0 if it was not
    pub at: f64,
    /// Friction that is in doubt because the slip before touch is not known [F]
    pub doubt: f64,
}

/// When a pair is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactIncrement {
    /// Δt [T]
    pub dt: f64,
    /// Share of an initial overlap that does not count yet
    pub fading: f64,
    /// α_n under the augmented Lagrangian is this many times the one given
    pub stiffening: f64,
    /// Whether the bodies give way under the pressures that come up within the increment
    pub settles: bool,
}

/// What one linear solve takes over for a point from those before; an accepted state presumes nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Presumption {
    /// Presumption about its state
    pub presume: Presume,
    /// Tractions that the tangent turns and stretches with the surface; those of the trial state unless given
    pub promised: Option<Tractions>,
    /// Pressure of a point that is closed whatever its gap, and under which friction answers unless its own is positive;
    /// none if it is 0
    pub kept: f64,
    /// Pressure under which friction answers, and from where its answer goes on in a straight line, at a point that has just
    /// closed: a stiff penalty presses a point far too hard that goes too deep in one iterate, and would make it stick
    /// where it is to slip.
    pub carried: Option<f64>,
    /// Two segments between which its foot goes to and fro
    pub astride: Option<[usize; 2]>,
}

/// Fewer points than this are not worth waking other threads for.
const FEW: usize = 64;

/// Trial states and contributions of all points of a pair, in their order.
pub type PairResponse = Vec<(ContactState, Option<Closed>)>;

impl ContactPair {
    /// The friction law of a slave point.
    pub fn law(&self, slave: &SlavePoint) -> &dyn FrictionLaw {
        &*self.laws[slave.law]
    }

    /// Start closed: from now on every point's gap is counted so that its given pressure acts in the configuration `x`.
    ///
    /// ```text
    /// p = p_init + α_n (g_x − g)        g_x: gap between the surfaces in the configuration x
    /// ```
    /// Under the augmented Lagrangian p_init is the first multiplier instead.
    ///
    /// # Errors
    /// The number of the first point that no part of the master faces.
    pub fn start_closed(&mut self, initial: Vec<InitialTraction>, x: &Configuration) -> Result<(), usize> {
        let met = self.meetings(x);
        for (k, (slave, met)) in self.points.iter_mut().zip(met).enumerate() {
            let give = if self.penetration.is_some() { 0.0 } else { initial[k].pressure / self.alpha_n };
            slave.touch = met.ok_or(k)?.gap + give;
        }
        self.initial = Some(initial);
        Ok(())
    }

    /// Begin a shrink fit: what the surfaces overlap in the configuration `x` counts bit by bit.
    ///
    /// ```text
    /// g(t) = g_surfaces + overlap × (1 − share of the first step that has passed)
    /// ```
    pub fn start_fitting(&mut self, x: &Configuration) {
        let met = self.meetings(x);
        for (slave, met) in self.points.iter_mut().zip(met) {
            slave.overlap = met.map_or(0.0, |met| (slave.touch - met.gap).max(0.0));
        }
    }

    /// States at the start of a run: each point projected in the configuration `x`, friction at rest or, in a contact
    /// that starts closed, under its initial tractions.
    pub fn initial_states(&self, x: &Configuration) -> Vec<ContactState> {
        let state = |(k, (slave, met)): (usize, (&SlavePoint, Option<Meeting>))| {
            let mut friction = self.law(slave).initial_state();
            if let Some(InitialTraction { pressure, traction }) = self.initial.as_ref().map(|initial| initial[k]) {
                friction = FrictionState { pressure, traction, ..friction };
            }
            let length = met.as_ref().map_or_else(|| slave.current_length(x), |met| met.kinematics.length);
            let (gap, foot) = met.map(|met| (slave.gap(met.gap, 1.0), met.foot)).unzip();
            let multiplier = if self.penetration.is_some() { friction.pressure } else { 0.0 };
            ContactState { friction, foot, length, gap: gap.unwrap_or(0.0), slip: 0.0, multiplier }
        };
        self.points.iter().zip(self.meetings(x)).enumerate().map(state).collect()
    }

    /// What the initial tractions put on the nodes in the configuration `x` [F].
    pub fn initial_forces(&self, x: &Configuration) -> Vec<(usize, Vector2<f64>)> {
        let met = self.meetings(x).into_iter().zip(self.initial.iter().flatten());
        let forces = |(met, initial): (Option<Meeting>, &InitialTraction)| {
            let InitialTraction { pressure, traction } = *initial;
            met.map_or_else(Vec::new, |met| nodal_forces(&met.kinematics, pressure, traction))
        };
        met.flat_map(forces).collect()
    }

    /// Where every point meets the master, if that faces it, the gap being that of the surfaces.
    fn meetings(&self, x: &Configuration) -> Vec<Option<Meeting>> {
        let index = Index::new(&self.master, x);
        match (&self.mortar, &self.master) {
            (Some(mortar), Master::Mesh(surface)) => {
                let overlaps = mortar.overlaps(surface, &index, x);
                (0..self.points.len()).map(|k| mortar.kinematics(k, surface, &overlaps, None, x)).collect()
            }
            (Some(mortar), Master::Rigid(body)) => {
                (0..self.points.len()).map(|k| mortar.on_rigid(k, body, x, x)).collect()
            }
            _ => {
                let meet = |slave: &SlavePoint| {
                    let projection = index.project(slave, None, x)?;
                    let kinematics = kinematics(slave, &self.master, &projection, None, x);
                    Some(Meeting { kinematics, gap: projection.gap, foot: projection.foot })
                };
                self.points.iter().map(meet).collect()
            }
        }
    }

    /// Every point's trial state and contribution in the configuration `x`, each with its own presumption; `before`
    /// is the committed configuration. Pure, and the same for any number of threads.
    ///
    /// # Errors
    /// The number of the first point whose friction law fails, and why.
    pub fn respond(
        &self,
        old: &[ContactState],
        before: &Configuration,
        moment: ContactIncrement,
        presumed: impl Fn(usize) -> Presumption + Sync,
        x: &Configuration,
    ) -> Result<PairResponse, (usize, LawFailure)> {
        let index = Index::within(&self.master, before, x);
        if let (Some(mortar), Master::Mesh(surface)) = (&self.mortar, &self.master) {
            let was = mortar.overlaps(surface, &Index::new(&self.master, before), before);
            let is = mortar.overlaps(surface, &index, x);
            return self.each(old, |k, slave, old| {
                let increment = Increment { moment, presumption: presumed(k) };
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
                let increment = Increment { moment, presumption: presumed(k) };
                match mortar.on_rigid(k, body, before, x) {
                    Some(meeting) => answer(self, slave, meeting, old, increment, x),
                    None => open(self, slave, None, old, increment),
                }
            });
        }
        self.each(old, |k, slave, old| {
            let increment = Increment { moment, presumption: presumed(k) };
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
    meeting.gap = slave.gap(meeting.gap, increment.moment.fading);
    match closes(pair, slave, meeting.gap, old, increment, x) {
        true => press(pair, slave, meeting, old, increment),
        false => open(pair, slave, Some((meeting.gap, meeting.foot)), old, increment),
    }
}

impl ContactPair {
    /// Largest gap of a closed point that the multipliers of a pass leave, over the one allowed; 0 for the plain penalty.
    pub fn excess(&self, trial: &[ContactState]) -> f64 {
        let Some(tolerance) = self.penetration else { return 0.0 };
        let closed = trial.iter().filter(|state| state.friction.pressure > 0.0);
        closed.map(|state| state.gap.abs() / tolerance).fold(0.0, f64::max)
    }

    /// The master node that lies deepest in slave edges with closed points: place, depth [L], and depth over the length of
    /// that edge [-].
    pub fn deepest_master_node(&self, states: &[ContactState], x: &Configuration) -> Option<(Vector2<f64>, f64, f64)> {
        let Some(Reverse { nodes, slave: Master::Mesh(slave) }) = &self.reverse else { return None };
        let closed = self.points.iter().zip(states).filter(|(_, state)| state.friction.pressure > 0.0);
        let closed =
            closed.flat_map(|(point, _)| &point.length).flat_map(|share| share.tangent.iter().map(|(node, _)| *node));
        let closed: BTreeSet<usize> = closed.collect();
        if closed.is_empty() {
            return None;
        }
        let index = Index::new(&self.reverse.as_ref()?.slave, x);
        let depth = |point: &SlavePoint| {
            let met = index.project(point, None, x).filter(|met| met.gap < 0.0)?;
            let [a, b] = slave.segments[met.foot.segment].ends;
            let share = -met.gap / x.between(a, b).norm();
            // What is farther in than an edge is long lies behind another part of the body.
            (share < 1.0 && closed.contains(&a) && closed.contains(&b)).then(|| (point.at(x), -met.gap, share))
        };
        nodes.iter().filter_map(depth).max_by(|a, b| a.2.total_cmp(&b.2))
    }

    /// α_n, under the augmented Lagrangian this many times the one given.
    pub fn normal_stiffness(&self, stiffening: f64) -> f64 {
        if self.penetration.is_some() { stiffening * self.alpha_n } else { self.alpha_n }
    }

    /// d/p: how far a pressure brings the surfaces after touch. It pushes the bodies in by c p where they settle, and the plain
    /// penalty gives way by p/α_n [L³/F].
    pub fn compliance_after_touch(&self, settles: bool) -> f64 {
        let bodies = if settles { self.compliance } else { 0.0 };
        if self.penetration.is_some() { bodies } else { bodies + 1.0 / self.alpha_n }
    }

    /// What friction may have to do with the slip before touch, at a point that was apart when the increment began and is
    /// closed `now`: that slip lies between none and what it would have been, had the motion gone on as before until touch. `foreseen` is
    /// the state that such a motion would have led to. 0 for any other point, and for one that slides at the limit of
    /// friction in all these cases.
    ///
    /// # Errors
    /// [`LawFailure`] when the law has no answer to one of the slips.
    pub fn arrival(
        &self,
        slave: &SlavePoint,
        [old, foreseen, now]: [&ContactState; 3],
        dt: f64,
    ) -> Result<Option<Arrival>, LawFailure> {
        let pressure = now.friction.pressure;
        if pressure <= 0.0 || !old.apart(now.length) {
            return Ok(None);
        }
        let met = foreseen.friction.pressure > 0.0 && foreseen.gap < 0.0;
        let at = if met { old.gap / (old.gap - foreseen.gap) } else { 0.0 };
        let free = foreseen.slip * at;
        let mut doubt = 0.0f64;
        for slip in [now.slip, now.slip - free] {
            let other = self.law(slave).respond(&old.friction, Sliding { slip, pressure, dt })?;
            doubt = doubt.max((other.state.traction - now.friction.traction).abs() * now.length);
        }
        Ok((doubt > 0.0).then_some(Arrival { at, doubt }))
    }

    /// What is left of the pressure of a point that closed within one iterate once the bodies have taken their share of its
    /// penetration: p/(1 + α_n c).
    pub fn shared(&self, pressure: f64, stiffening: f64) -> f64 {
        pressure / (1.0 + self.normal_stiffness(stiffening) * self.compliance)
    }

    /// The committed states with the pressures of a pass as multipliers, p̄ ← p (Uzawa's method).
    pub fn multiplied(&self, old: &[ContactState], trial: &[ContactState]) -> Vec<ContactState> {
        let multiplier = |new: &ContactState| if self.penetration.is_some() { new.friction.pressure } else { 0.0 };
        old.iter().zip(trial).map(|(old, new)| ContactState { multiplier: multiplier(new), ..*old }).collect()
    }

    /// Rate at which each point slips along +s under nodal velocities, the variation of Δu_t; 0 where nothing faces it
    /// [L/T].
    pub fn slip_rates(&self, states: &[ContactState], x: &Configuration, velocity: &[f64]) -> Vec<f64> {
        let index = Index::new(&self.master, x);
        let rate = |k: Kinematics| {
            let dofs = k.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]);
            dofs.zip(&k.dslip).map(|(dof, dslip)| velocity[dof] * dslip).sum()
        };
        if let (Some(mortar), Master::Mesh(surface)) = (&self.mortar, &self.master) {
            let overlaps = mortar.overlaps(surface, &index, x);
            let met =
                |k| mortar.kinematics(k, surface, &overlaps, mortar.weights(k, surface, &overlaps, x).as_ref(), x);
            return (0..self.points.len()).map(|k| met(k).map_or(0.0, |met| rate(met.kinematics))).collect();
        }
        if let (Some(mortar), Master::Rigid(body)) = (&self.mortar, &self.master) {
            let met = |k| mortar.on_rigid(k, body, x, x);
            return (0..self.points.len()).map(|k| met(k).map_or(0.0, |met| rate(met.kinematics))).collect();
        }
        let slips = |(slave, state): (&SlavePoint, &ContactState)| {
            let projection = index.project(slave, state.foot, x);
            projection.map_or(0.0, |projection| rate(kinematics(slave, &self.master, &projection, state.foot, x)))
        };
        self.points.iter().zip(states).map(slips).collect()
    }

    /// Elastic part of the slip, q/α_t; 0 for a frictionless contact [L].
    pub fn elastic_slip(&self, slave: &SlavePoint, friction: &FrictionState) -> f64 {
        let stiffness = self.law(slave).stiffness();
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
