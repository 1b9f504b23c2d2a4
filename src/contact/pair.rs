//! Contact pair: a slave surface, its master, and the laws between them.
//!
//! # Fluid
//!
//! A fluid between the surfaces of a contact pushes them apart.
//!
//! ```text
//! p_total = p + p_w        p: contact pressure of the surfaces (penalty or multiplier), used by friction
//! f_a = −w_a p_w n ℓ       in addition to that of p and q, wherever the point has a projection, closed or open
//! ```
//!
//! p_w is prescribed as a function of the reference position of a slave point and time, or that of water which flows along the contact
//! (`conduit`): then every point remembers the pressure of the increment that is solved. Friction
//! depends on the effective pressure p only, by the principle of effective stress (K. Terzaghi, Theoretical Soil Mechanics,
//! 1943, §6). Where p_w exceeds the contact pressure, the surfaces open and the fluid pressure continues to act, so that the
//! traction is continuous there. Its work is that of a load.
//!
//! Fields of a contact are available by name, one value per point, for output and callers.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::Vector2;
use rayon::prelude::*;

use super::conduit::Conduit;
pub use super::fluid::{BadPressure, Fluid};
use super::kinematics::Kinematics;
use super::master::Master;
use super::mortar::Mortar;
use super::point::ContactState;
pub use super::point::{ContactIncrement, Prediction};
use super::pores::Pores;
use super::seam::Seam;
use super::small_sliding::SmallSliding;
use super::surface::SlavePoint;
use crate::laws::friction::{Cohesion, ContactLaw, LawFailure, Regime, Sliding, observables};
use crate::mesh::configuration::Configuration;
use crate::mesh::rigid::RigidBody;

/// Number of laws that one thread resolves at a time.
const PART: usize = 64;

/// Two surfaces that may come into contact.
#[derive(Debug)]
pub struct ContactPair {
    /// Name in the case file
    pub name: String,
    /// Whether the surfaces are tied whatever the pressure
    pub tied: bool,
    /// Points of the slave surface, in order along it
    pub points: Vec<SlavePoint>,
    /// The master
    pub master: Master,
    /// Slave edges for mortar averages; `None` for pointwise evaluation
    pub mortar: Option<Mortar>,
    /// α_n: normal penalty stiffness [F/L³]
    pub alpha_n: f64,
    /// c: compliance of the bodies under contact pressure, about the depth of an element divided by λ + 2G; 0 for points
    /// without elements [L³/F]
    pub compliance: f64,
    /// Gap above which an open point counts as separated from the master, far above the round-off of positions and far below an
    /// edge length [L]
    pub touch: f64,
    /// Largest penetration left by the augmented Lagrangian method; `None` for the plain penalty method [L]
    pub penetration: Option<f64>,
    /// Largest elastic slip left where the law knows none; plain penalty if not given [L]
    pub stick: Option<f64>,
    /// η: radiation damping in static steps, 0 if not used [F T/L³]
    pub radiation: f64,
    /// Fluid that acts on the surfaces in addition to the contact pressure
    pub fluid: Option<Fluid>,
    /// What gives the pressure of the fluid if it flows along the contact: that of `fluid` is then the one at the start
    pub conduit: Option<Conduit>,
    /// Pores behind every point, where friction goes by the effective stress of the slave's bodies
    pub pores: Option<Vec<Pores>>,
    /// Water that flows through its bodies
    pub seam: Option<Seam>,
    /// Friction laws, each with the parameters of some of the points at the start of the run. They also define the
    /// time-independent properties: α_t, the names of internal variables and observables, and whether they have friction and
    /// dilatancy
    pub laws: Vec<Arc<ContactLaw>>,
    /// Laws of an increment, where parameters vary in time
    pub in_time: Option<LawsInTime>,
    /// Number of points at which a random parameter is truncated to the range of the law, by its name within the contact
    pub truncated: BTreeMap<String, usize>,
    /// Initial tractions of every point of a contact that starts closed
    pub initial: Option<Vec<InitialTraction>>,
    /// Whether it comes in a later step, under the stress that is in force between its bodies by then
    pub comes_stressed: bool,
    /// Both surfaces whole, for what lies between the points of the slave; `None` for self-contact and slaves without edges
    pub both: Option<BothSurfaces>,
    /// Surface nodes of the slave's bodies that belong to no contact point, if the master is rigid
    pub unseen: Vec<SlavePoint>,
    /// G*: G/(1 − ν) of both sides, the stiffness against slip that varies along the interface; 0 without bodies [F/L²]
    pub modulus: f64,
    /// What the opening is measured by over which strength without pressure fades, if there is any
    pub fades: Option<Fades>,
    /// Body of the slave's edges at its first point; for a point group, the only body there, if there is one
    pub body: Option<usize>,
    /// Bodies of the slave and of the master
    pub bodies: [Vec<usize>; 2],
    /// Constant operators of the points in small sliding
    pub small: Option<SmallSliding>,
}

/// What the opening is measured by over which strength without pressure fades.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fades {
    /// h/E: longest edge of the slave over the lower modulus of both sides [L³/F]
    pub flexibility: f64,
    /// Whether it was chosen by that, and not given
    pub is_chosen: bool,
}

/// Nodes of both surfaces as points, and the slave as a master: what may enter the other side between the points of the slave.
#[derive(Clone, Debug)]
pub struct BothSurfaces {
    /// Nodes of a mesh master
    pub nodes: Vec<SlavePoint>,
    /// Slave surface
    pub slave: Master,
    /// Nodes of the slave
    pub own: Vec<SlavePoint>,
    /// Sides of the slave's bodies, with these on their left, where the master is rigid: (start, end[, middle])
    pub sides: Vec<Vec<usize>>,
}

/// Tractions at a contact point at the start of the run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InitialTraction {
    /// p [F/L²]
    pub pressure: f64,
    /// q [F/L²]
    pub traction: f64,
}

/// Contact closure of a point within an increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Predicted time of closure, as a fraction of the increment; 0 without a prediction
    pub at: f64,
    /// Time of closure if the surfaces have approached at a steady rate, first by the gap and then by the compression, alike
    pub came: f64,
    /// Friction force that is uncertain because the slip before closure is not known [F]
    pub uncertainty: f64,
}

impl ContactPair {
    /// Nodes of the slave's points, possibly repeated.
    pub fn slave_nodes(&self) -> impl Iterator<Item = usize> {
        self.points.iter().flat_map(|point| point.position.iter().map(|&(node, _)| node))
    }

    /// Nodes of both sides, and of elements whose pores bear a part of the pressure, possibly repeated.
    pub fn nodes(&self) -> impl Iterator<Item = usize> {
        let behind = self.pores.iter().flatten().flat_map(|pores| pores.nodes.iter().copied());
        let rigid = self.master.rigid_body().into_iter().flat_map(RigidBody::nodes);
        self.slave_nodes()
            .chain(self.master.segments().iter().flat_map(|segment| segment.nodes()))
            .chain(rigid)
            .chain(behind)
    }

    /// Whether the master is the slave itself (self-contact).
    pub fn is_own(&self) -> bool {
        matches!(&self.master, Master::Mesh(surface) if surface.own_depth.is_some())
    }

    /// Whether its tangent is symmetric: without friction, where surfaces neither turn nor stretch. In finite sliding a pressure acts
    /// on the current length, and turns with it, as a load that follows the surface does.
    pub fn is_symmetric(&self) -> bool {
        let smooth = |law: &Arc<ContactLaw>| law.description.is_frictionless && law.description.opening.is_empty();
        let drains = self.seam.as_ref().is_some_and(|seam| seam.open.is_some());
        self.small.is_some() && !drains && self.laws.iter().all(smooth)
    }

    /// Friction law of a slave point at the start of the run.
    pub fn law(&self, slave: &SlavePoint) -> &ContactLaw {
        &self.laws[slave.law]
    }

    /// Evaluates the friction law of a slave point over a time span, or at a time if both ends are equal.
    ///
    /// # Errors
    /// Returns [`LawFailure`] if its parameters are invalid then.
    pub fn ask_law<T>(
        &self,
        slave: &SlavePoint,
        span: [f64; 2],
        ask: impl FnOnce(&ContactLaw) -> T,
    ) -> Result<T, LawFailure> {
        match &self.in_time {
            None => Ok(ask(self.law(slave))),
            Some(laws) => self.law_in_time(laws, slave.law, span).map(|law| ask(&law)),
        }
    }

    /// Rates are averaged over the increment; all other parameters take their value at its end.
    fn law_in_time(&self, laws: &LawsInTime, number: usize, [from, to]: [f64; 2]) -> Answered {
        let from = if self.laws[number].description.takes_means { from } else { to };
        laws.during(number, [from, to])
    }

    /// Returns all laws over a time span.
    ///
    /// # Errors
    /// Returns the first point with invalid parameters and the [`LawFailure`].
    pub fn laws_during(&self, span: [f64; 2]) -> Result<Cow<'_, [Arc<ContactLaw>]>, (usize, LawFailure)> {
        let Some(in_time) = &self.in_time else { return Ok(Cow::Borrowed(&self.laws)) };
        let laws =
            (0..self.laws.len()).into_par_iter().with_min_len(PART).map(|law| self.law_in_time(in_time, law, span));
        let laws: Vec<Answered> = laws.collect();
        let first = |law: usize| self.points.iter().position(|slave| slave.law == law).unwrap_or_default();
        let laws = laws.into_iter().enumerate().map(|(k, law)| law.map_err(|failure| (first(k), failure)));
        Ok(Cow::Owned(laws.collect::<Result<_, _>>()?))
    }

    /// Observable of a point's law by name, for a state at a time; NaN where its parameters are invalid then.
    pub fn observed(&self, slave: &SlavePoint, name: &str, state: &ContactState, time: f64) -> f64 {
        let of_law = || self.ask_law(slave, [time, time], |law| law.observe(name, &state.friction));
        self.observed_of_bond(slave, name, state).unwrap_or_else(|| of_law().unwrap_or(f64::NAN))
    }

    /// Open, stick or slip. Without friction nothing sticks: a closed point slips, at rest as well.
    pub fn regime(&self, slave: &SlavePoint, state: &ContactState) -> Regime {
        match state.regime() {
            Regime::Stick if self.law(slave).description.is_frictionless => Regime::Slip,
            regime => regime,
        }
    }

    /// Largest gap and elastic slip of a closed point that the multipliers of a pass leave, over the ones allowed; 0 for the plain
    /// penalty.
    pub fn excess(&self, trial: &[ContactState]) -> [f64; 2] {
        let acting = || trial.iter().filter(|state| state.acts());
        let over = |allowed: Option<f64>, left: &dyn Fn(&ContactState) -> f64| {
            let Some(allowed) = allowed else { return 0.0 };
            acting().map(|state| left(state).abs() / allowed).fold(0.0, f64::max)
        };
        // The opening of an open point is short of its gap by what a multiplier presses.
        let gap = |state: &ContactState| match state.is_closed() {
            true => state.clearance(),
            false => state.multiplier / self.alpha_n,
        };
        let slip = |state: &ContactState| {
            state.bond.map_or(state.elastic_slip, |bond| state.elastic_slip.abs().max(bond.elastic_slip.abs()))
        };
        [over(self.penetration, &gap), over(self.stick, &slip)]
    }

    /// e = e₀ + (q − q₀)/α_t at the end of an increment that starts with the traction q₀; 0 for the plain penalty, and where
    /// elastic slip is a part of the law [L].
    pub fn left_of_stick(&self, law: &ContactLaw, old: &ContactState, traction: f64) -> f64 {
        let (stiffness, is_penalty) = (law.stiffness, law.stiffness > 0.0 && law.description.stiffness_is_penalty);
        match self.stick {
            Some(_) if is_penalty => old.elastic_slip + (traction - old.friction.traction) / stiffness,
            _ => 0.0,
        }
    }

    /// α_n multiplied by the factor of the iteration: above one in the augmented Lagrangian method only, where the solution
    /// does not depend on it; below one during the iterations for an initial guess.
    pub fn normal_stiffness(&self, stiffening: f64) -> f64 {
        let varies = self.penetration.is_some() || stiffening < 1.0 && !self.tied;
        if varies { stiffening * self.alpha_n } else { self.alpha_n }
    }

    /// Whether a fluid bears a part of the pressure, between the surfaces or in the pores of a body.
    pub fn holds_fluid(&self) -> bool {
        self.fluid.is_some() || self.pores.is_some() || self.seam.is_some()
    }

    /// p_w in the pores behind a point; 0 where friction does not go by it [F/L²].
    pub fn pore_pressure(&self, point: usize, x: &Configuration) -> f64 {
        self.pores.as_ref().map_or(0.0, |pores| pores[point].pressure(x))
    }

    /// p_w at a slave point, 0 for the round-off of a negative value; 0 without a fluid [F/L²].
    pub fn fluid_pressure(&self, slave: &SlavePoint, x: &Configuration, time: f64) -> f64 {
        let given = self.given_pressure(slave, x, time);
        if given < 0.0 { 0.0 } else { given }
    }

    /// p_w at a slave point with these kinematics at the start of a contact [F/L²].
    pub(super) fn pressure_at(&self, slave: &SlavePoint, k: &Kinematics, x: &Configuration, time: f64) -> f64 {
        match &self.seam {
            Some(seam) => seam.pressure(slave, k, x),
            None => self.fluid_pressure(slave, x, time),
        }
    }

    /// p_w at a slave point at the end of an increment from the state `old` [F/L²].
    pub fn acting_pressure(&self, slave: &SlavePoint, old: &ContactState, x: &Configuration, time: f64) -> f64 {
        old.water.map_or_else(|| self.fluid_pressure(slave, x, time), |water| water.pressure)
    }

    /// p_w at a slave point as its expression gives it [F/L²].
    fn given_pressure(&self, slave: &SlavePoint, x: &Configuration, time: f64) -> f64 {
        let at = || x.split(&slave.position, Vector2::zeros())[0];
        self.fluid.as_ref().map_or(0.0, |fluid| fluid.pressure(slave, at, time))
    }

    /// First point with a negative or non-finite fluid pressure. A negative value within the round-off of the largest one, or of the
    /// initial pressure of the contact, or of the stiffness of its bodies, is none.
    pub fn bad_fluid_pressure(&self, x: &Configuration, time: f64) -> Option<BadPressure> {
        self.fluid.as_ref()?;
        let pressures = || self.points.iter().map(|slave| (slave, self.given_pressure(slave, x, time)));
        pressures().find(|(_, pressure)| !(pressure.is_finite() && *pressure >= 0.0))?;
        let initial = self.initial.iter().flatten().map(|initial| initial.pressure);
        let largest = pressures().map(|(_, pressure)| pressure.abs()).chain(initial).fold(0.0, f64::max);
        let least = -(ROUND_OFF * largest).max(f64::EPSILON * self.modulus);
        let bad = pressures().find(|(_, pressure)| !(pressure.is_finite() && *pressure >= least));
        bad.map(|(slave, pressure)| BadPressure { at: x.split(&slave.position, Vector2::zeros())[0], pressure })
    }

    /// The larger of α_n and α_t. Dilatant slip, δp = α_n tan ψ δu and δq = μ δp, has the stiffness α_n (1 + μ tan ψ), which is
    /// below 2 α_n for μ < 1. Water that flows presses back by 1/S per opening, or by what the pores beside take up [F/L³].
    pub fn stiffest(&self, slave: &SlavePoint) -> f64 {
        let law = &self.law(slave).description;
        let lifted = if law.opening.is_empty() { 1.0 } else { 2.0 };
        let of_pores = self.seam.as_ref().map_or(0.0, |seam| seam.trapped);
        let water = self.conduit.as_ref().map_or(of_pores, |conduit| 1.0 / conduit.storage);
        (lifted * self.alpha_n).max(law.stiffness) + water
    }

    /// η v for the slip of an increment, and its derivative η/Δt [F/L²], [F/L³].
    pub fn radiated(&self, during: ContactIncrement, slip: f64) -> [f64; 2] {
        let damping = if during.radiates && during.dt > 0.0 { self.radiation / during.dt } else { 0.0 };
        [damping * slip, damping]
    }

    /// d/p: approach of the surfaces per pressure after closure: the deformation c p of the bodies if `settles`, and the
    /// penalty compliance p/α_n [L³/F].
    pub fn compliance_after_touch(&self, settles: bool) -> f64 {
        let bodies = if settles { self.compliance } else { 0.0 };
        if self.penetration.is_some() { bodies } else { bodies + 1.0 / self.alpha_n }
    }

    /// Uncertainty of friction by the slip before closure, for a point that was open at the start of the increment and is
    /// closed `now`, including the omitted dilation after closure. The slip before closure lies between zero and its value had
    /// the previous motion continued until closure; `foreseen` is the state predicted by that motion. The uncertainty is 0 for
    /// a point that slides at the friction limit in all these cases; any other point has no arrival.
    ///
    /// # Errors
    /// Returns [`LawFailure`] if the law has no response to one of the slips.
    pub fn arrival(
        &self,
        slave: &SlavePoint,
        [old, foreseen, now]: [&ContactState; 3],
        time: f64,
        dt: f64,
    ) -> Result<Option<Arrival>, LawFailure> {
        let pressure = now.friction.pressure;
        if pressure <= 0.0 || !old.is_separated(self.touch + self.fading(slave)) {
            return Ok(None);
        }
        let gap = old.clearance();
        let came = gap / (gap + self.compliance_after_touch(true) * now.contact_pressure());
        let met = foreseen.friction.pressure > 0.0 && foreseen.clearance() < 0.0;
        let at = if met { gap / (gap - foreseen.clearance()) } else { 0.0 };
        let free = foreseen.slip * at;
        let respond = |slip: f64| {
            let sliding = Sliding { slip, pressure, dt };
            self.ask_law(slave, [time - dt, time], |law| law.respond(&old.friction, sliding))?
        };
        let mut uncertainty = 0.0f64;
        for slip in [now.slip, now.slip - free] {
            let of_bond = self.bond_off(slave, [old, now], slip);
            uncertainty =
                uncertainty.max((respond(slip)?.state.traction - now.friction.traction + of_bond).abs() * now.length);
        }
        if !self.law(slave).description.opening.is_empty() {
            let way = self.compliance_after_touch(true) * pressure;
            let lift = respond(now.slip * way / (old.clearance() + way))?.state.opening - now.friction.opening;
            uncertainty = uncertainty.hypot(lift / (self.compliance + 1.0 / self.alpha_n) * now.length);
        }
        Ok(Some(Arrival { at, came, uncertainty }))
    }

    /// Pressure that remains at a point that closed within one iterate after the bodies have deformed: p/(1 + α_n c).
    pub fn shared(&self, pressure: f64, stiffening: f64) -> f64 {
        pressure / (1.0 + self.normal_stiffness(stiffening) * self.compliance)
    }

    /// The states that a pass began with, with multipliers from what it has `found` (Uzawa's method): p̄ ← p, and q₀ ← q₀ + α_t e,
    /// the traction that the increment starts with where it sticks without elastic slip.
    pub fn multiplied(&self, old: &[ContactState], found: &[ContactState]) -> Vec<ContactState> {
        let points = self.points.iter().zip(old.iter().zip(found));
        let again = |(slave, (old, new)): (&SlavePoint, (&ContactState, &ContactState))| {
            let mut again = old.clone();
            again.multiplier = if self.penetration.is_some() { new.contact_pressure() } else { 0.0 };
            let law = self.law(slave);
            again.friction.traction += law.stiffness * new.elastic_slip;
            if let (Some(Cohesion::Parallel(law)), Some(again), Some(new)) = (&law.cohesion, &mut again.bond, &new.bond)
            {
                again.traction += law.stiffness() * new.elastic_slip;
            }
            again
        };
        points.map(again).collect()
    }

    /// Elastic part of the slip, q/α_t, or what of it multipliers leave; 0 for a frictionless contact [L].
    pub fn elastic_slip(&self, slave: &SlavePoint, state: &ContactState) -> f64 {
        let ContactLaw { stiffness, description, .. } = self.law(slave);
        let stiffness = *stiffness;
        let is_penalty = description.stiffness_is_penalty;
        match stiffness > 0.0 {
            true if is_penalty && self.stick.is_some() => state.elastic_slip,
            true => state.friction.traction / stiffness,
            false => self.elastic_slip_of_bond(slave, state),
        }
    }

    /// Ranges of consecutive points along a continuous surface.
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

/// A resolved law, or the failure of its parameters.
type Answered = Result<Arc<ContactLaw>, LawFailure>;

/// A law by its number, with its parameters at a time or with their mean over a time span.
pub type LawAt = dyn Fn(usize, [f64; 2]) -> Result<ContactLaw, LawFailure> + Send + Sync;

/// Laws of a contact with time-dependent parameters, resolved once per increment; the last result is kept.
pub struct LawsInTime {
    law: Box<LawAt>,
    last: Vec<Mutex<Option<Resolved>>>,
}

/// A law resolved for a time span.
struct Resolved {
    span: [f64; 2],
    law: Arc<ContactLaw>,
}

impl LawsInTime {
    /// Creates `count` laws that vary in time.
    pub fn new(
        count: usize,
        law: impl Fn(usize, [f64; 2]) -> Result<ContactLaw, LawFailure> + Send + Sync + 'static,
    ) -> Self {
        Self { law: Box::new(law), last: (0..count).map(|_| Mutex::new(None)).collect() }
    }

    /// Law of a number for a time span.
    fn during(&self, number: usize, span: [f64; 2]) -> Answered {
        let mut last = self.last[number].lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(Resolved { law, .. }) = last.as_ref().filter(|last| last.span == span) {
            return Ok(law.clone());
        }
        let law = Arc::new((self.law)(number, span)?);
        *last = Some(Resolved { span, law: law.clone() });
        Ok(law)
    }
}

impl fmt::Debug for LawsInTime {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("laws that vary in time")
    }
}

/// Negative fluid pressures that are round-off, relative to the largest.
const ROUND_OFF: f64 = 1e-12;

/// Names of the fields of contacts: the common ones, and the internal variables and observables of their laws.
pub fn field_names(pairs: &[ContactPair]) -> Vec<&'static str> {
    let laws = pairs.iter().flat_map(|pair| &pair.laws).map(|law| &law.description);
    let always = observables::ALWAYS.iter().map(|(name, _)| *name);
    let of_surfaces = ["gap", "pressure", "traction", "slip", "elastic_slip", "slip_rate"].into_iter();
    let further = observables::further(laws);
    let fluid = pairs.iter().any(ContactPair::holds_fluid).then_some("fluid_pressure");
    let flows = pairs.iter().any(|pair| pair.conduit.is_some()).then_some(["water_flow", "aperture"]);
    of_surfaces
        .chain(always)
        .chain(["state", "dissipation"])
        .chain(further)
        .chain(fluid)
        .chain(flows.into_iter().flatten())
        .collect()
}

/// Values of a field at the points of a contact, at a time after an increment of length Δt; the names are listed with the
/// outputs ([`quantities`](crate::output::quantities)). Any other name is an observable of the laws: without a law, `R` and
/// `mu` are 0 and `structure` is 1, and unknown names are NaN.
pub fn field_values(pair: &ContactPair, states: &[ContactState], time: f64, dt: f64, name: &str) -> Vec<f64> {
    let rate = if dt > 0.0 { 1.0 / dt } else { 0.0 };
    let value = |(slave, state): (&SlavePoint, &ContactState)| {
        let friction = &state.friction;
        match name {
            "gap" => state.gap,
            "pressure" => friction.pressure - state.tension(),
            "traction" => state.shear(),
            "slip" => friction.plastic_slip,
            "elastic_slip" => pair.elastic_slip(slave, state),
            "total_slip" => friction.plastic_slip + pair.elastic_slip(slave, state),
            "slip_rate" => friction.plastic_increment * rate,
            "dissipation" => friction.dissipation,
            "fluid_pressure" => state.fluid + state.pores,
            "water_flow" => state.water.map_or(0.0, |water| water.flow),
            "aperture" => state.water.map_or(0.0, |water| water.aperture),
            "state" => match pair.regime(slave, state) {
                Regime::Open => 0.0,
                Regime::Stick | Regime::Tied => 1.0,
                Regime::Slip => 2.0,
            },
            _ => pair.observed(slave, name, state, time),
        }
    };
    pair.points.iter().zip(states).map(value).collect()
}
