//! State: all data of increment n needed by increment n + 1. A new state replaces the old one when it is accepted; roll-back is
//! to drop it.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::bars::BarState;
use crate::contact::conduit::ConduitState;
use crate::contact::force::ContactState;

/// The accepted state at the end of an increment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct State {
    /// t [T]
    pub time: f64,
    /// accepted increments so far
    pub increment: usize,
    /// length of the last increment of this step, 0 at its start [T]
    pub dt: f64,
    /// u: displacement of every dof [L]
    pub displacement: Vec<f64>,
    /// v [L/T]
    pub velocity: Vec<f64>,
    /// a [L/T²]
    pub acceleration: Vec<f64>,
    /// F: internal + contact − external forces [F]
    #[doc(hidden)]
    pub force: Vec<f64>,
    /// Forces on the nodes from outside: loads, and reactions at prescribed dofs [F]
    #[doc(hidden)]
    pub external: Vec<f64>,
    /// Forces of dashpots on the nodes [F]
    #[doc(hidden)]
    pub damping: Vec<f64>,
    /// Reactions of the supports on the nodes [F]
    pub reaction: Vec<f64>,
    /// One list per contact pair, one entry per slave point
    #[doc(hidden)]
    pub contacts: Vec<Vec<ContactState>>,
    /// Water that flows along each contact pair; empty where none does
    #[doc(hidden)]
    pub conduits: Vec<ConduitState>,
    /// Internal variables of the materials, element by element ([`crate::model::Memories`])
    #[doc(hidden)]
    pub memory: Vec<f64>,
    /// One per bar
    #[doc(hidden)]
    pub bars: Vec<BarState>,
    /// Water that flows through pores
    #[doc(hidden)]
    pub water: Water,
    /// Displacement increment of the last increment of this step; `None` at its start, and after explicit increments
    #[doc(hidden)]
    pub last_increment: Option<LastIncrement>,
    /// Values at the start of the current step, the same for all its states
    #[doc(hidden)]
    pub step_start: Arc<StepStart>,
    /// Energies
    pub energy: Energy,
}

/// Difference of two lengths of explicit increments that is round-off, over either [-]
const EQUAL: f64 = 1e-8;

#[doc(hidden)]
impl State {
    /// Begins a step, which refers to the present state, with the bodies that are absent in it.
    pub fn begin_step(&mut self, absent: &[bool]) {
        let (displacement, reaction) = (self.displacement.clone(), self.reaction.clone());
        let (fading, absent, activations) = (Vec::new(), absent.to_vec(), self.step_start.activations.clone());
        let last_dt = self.last_dt();
        self.step_start = Arc::new(StepStart { displacement, reaction, fading, absent, activations, last_dt });
        (self.dt, self.last_increment) = (0.0, None);
    }

    /// Δt of the last increment, which may be one of the step before; 0 before the first one [T]
    pub fn last_dt(&self) -> f64 {
        if self.dt > 0.0 { self.dt } else { self.step_start.last_dt }
    }

    /// Another state in the memory of this one.
    pub(crate) fn become_like(self, other: &Self) -> Self {
        let mut vectors = [
            (self.displacement, &other.displacement),
            (self.velocity, &other.velocity),
            (self.acceleration, &other.acceleration),
            (self.force, &other.force),
            (self.external, &other.external),
            (self.damping, &other.damping),
            (self.reaction, &other.reaction),
            (self.memory, &other.memory),
        ];
        vectors.iter_mut().for_each(|(own, other)| own.clone_from(other));
        let [displacement, velocity, acceleration, force, external, damping, reaction, memory] =
            vectors.map(|(own, _)| own);
        let mut contacts = self.contacts;
        contacts.clone_from(&other.contacts);
        let mut conduits = self.conduits;
        conduits.clone_from(&other.conduits);
        let mut bars = self.bars;
        bars.clone_from(&other.bars);
        let mut water = self.water;
        water.clone_from(&other.water);
        let (last_increment, step_start) = (other.last_increment.clone(), other.step_start.clone());
        let Self { time, increment, dt, energy, .. } = *other;
        Self {
            time,
            increment,
            dt,
            displacement,
            velocity,
            acceleration,
            force,
            external,
            damping,
            reaction,
            contacts,
            conduits,
            memory,
            bars,
            water,
            last_increment,
            step_start,
            energy,
        }
    }

    /// Whether a body is there.
    pub fn has(&self, body: usize) -> bool {
        !self.step_start.absent.get(body).copied().unwrap_or(false)
    }

    /// Whether it was reached by an explicit increment, with accelerations of lumped masses.
    pub fn is_of_explicit(&self) -> bool {
        self.last_increment.is_none() && self.dt > 0.0
    }

    /// Δt over the last increment, explicit or not, which water goes on from; `None` where that says nothing of this one.
    pub fn ratio(&self, dt: f64) -> Option<f64> {
        match &self.last_increment {
            Some(last) => last.ratio(dt),
            // Equal explicit increments differ by round-off.
            None if self.is_of_explicit() => {
                LastIncrement::ratio_to(self.dt, dt).map(|ratio| if (ratio - 1.0).abs() < EQUAL { 1.0 } else { ratio })
            }
            None => None,
        }
    }

    /// Removes the motion from a state for statics; its energy counts as damping dissipation.
    pub fn stop(&mut self) {
        self.energy.damping_dissipation += std::mem::take(&mut self.energy.kinetic);
        self.velocity.fill(0.0);
        self.acceleration.fill(0.0);
    }
}

/// Water that flows through pores, as far as the next increment needs it, or the balance of water.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[doc(hidden)]
pub struct Water {
    /// What came to every pressure's share of the pores in the last increment, by volume [L³]
    pub change: Vec<f64>,
    /// Flow through each outlet of the model
    pub outlets: Vec<Outflow>,
    /// Flow out of each contact along which water flows beside that of bodies, in order: through wells and sources, and by a leak
    pub channels: Vec<[Outflow; 2]>,
    /// Largest mean pressure so far that each body has in excess of the one at the start [F/L²]
    pub peaks: Vec<f64>,
    /// The mean pressure itself in excess of that at the start [F/L²]
    pub excess: Vec<f64>,
    /// What each body has taken up while it was there [L³]
    pub taken: Vec<f64>,
    /// What each body has brought with it of the water that it is found to hold, less what it took along when it left [L³]
    pub brought: Vec<f64>,
    /// Water that has come between the surfaces of contacts since the start [L³]
    pub between: f64,
}

#[doc(hidden)]
impl Water {
    /// Degree of consolidation of a body in which water flows, 1 less its mean excess pressure over the largest one [-].
    pub fn consolidation(&self, number: usize) -> f64 {
        let peak = self.peaks[number];
        if peak == 0.0 { 0.0 } else { 1.0 - self.excess[number] / peak }
    }
}

#[doc(hidden)]
impl Outflow {
    /// Goes on to an increment, with the share of the last one that the formula of the balance carries over.
    pub fn go_on(&mut self, memory: f64) {
        (self.rate, self.change) = (0.0, memory * self.change);
        self.volume += self.change;
    }

    /// Lets a flow out over the span of the formula.
    pub fn let_out(&mut self, flow: f64, span: f64) {
        self.rate += flow;
        self.change += span * flow;
        self.volume += span * flow;
    }
}

/// Flow out of the bodies through an outlet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[doc(hidden)]
pub struct Outflow {
    /// at the end of the last increment [L³/T]
    pub rate: f64,
    /// volume in the last increment [L³]
    pub change: f64,
    /// volume since the start [L³]
    pub volume: f64,
}

/// The last accepted increment, from which the next start value is extrapolated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[doc(hidden)]
pub struct LastIncrement {
    /// Δt [T]
    pub dt: f64,
    /// Δu [L]
    pub displacement: Vec<f64>,
    /// Whether it ends at contact closure; it is then not extrapolated
    pub ends_in_touch: bool,
}

#[doc(hidden)]
impl LastIncrement {
    /// What follows an increment shorter than this by much, as a load that has jumped in it, knows nothing of its rate: the formula of second order of
    /// the water is stable up to this ratio of two lengths, 1 + √2. R. D. Grigorieff (1983), Numer. Math. 42, 359.
    const LONGEST_BY_IT: f64 = 1.0 + std::f64::consts::SQRT_2;

    /// Δt over that of this increment; `None` where the rate of this one says nothing of it.
    pub fn ratio(&self, dt: f64) -> Option<f64> {
        Self::ratio_to(self.dt, dt)
    }

    fn ratio_to(last: f64, dt: f64) -> Option<f64> {
        Some(dt / last).filter(|ratio| *ratio <= Self::LONGEST_BY_IT)
    }

    /// The fraction of its motion by which an increment of Δt is expected to go on, in a model whose water flows or not.
    pub fn goes_on(&self, dt: f64, flows: bool) -> Option<f64> {
        if flows { self.ratio(dt) } else { Some(dt / self.dt) }
    }
}

/// Displacements of the nodes of elements when they came, by element [L].
pub type Activations = BTreeMap<usize, Vec<[f64; 2]>>;

/// State of supported dofs and of bodies at the start of the step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[doc(hidden)]
pub struct StepStart {
    /// u at the start of the step [L]
    pub displacement: Vec<f64>,
    /// reactions at the start of the step [F]
    pub reaction: Vec<f64>,
    /// What balances the change of the forces by bodies that the step adds or removes; it fades over the step. Empty without
    /// such [F]
    pub fading: Vec<f64>,
    /// whether each body is absent; empty if all are there
    pub absent: Vec<bool>,
    /// displacements of the nodes of each element that came into a deformed model [L]
    pub activations: Arc<Activations>,
    /// Δt of the increment before the step; 0 at the start of the run [T]
    pub last_dt: f64,
}

/// Energies [F·L]; the dissipations and the external work are totals since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Energy {
    /// ½ vᵀ M v
    pub kinetic: f64,
    /// ∫ W dV
    pub strain: f64,
    /// ∫ (α_n g²/2 + q²/(2 α_t)) ds of the closed contact points
    pub contact_elastic: f64,
    /// ∫ q v^p ds dt
    pub friction_dissipation: f64,
    /// ∫ c (v_driver − v)² dt of the dashpots, and what viscous bodies turned into heat
    pub damping_dissipation: f64,
    /// plastic work of the bodies that yield, less what back stresses store
    pub plastic_dissipation: f64,
    /// ∫ η v² ds dt: radiated by slip in contacts with radiation damping
    pub radiated: f64,
    /// ∫ c v² dt of stabilizing dashpots, a part of the damping dissipation
    pub stabilization: f64,
    /// work on the model of loads, springs, supports, drivers of dashpots, overlaps of shrink fits and temperature changes
    pub external_work: f64,
    /// kinetic + strain + contact energy at the start of the run
    pub initial: f64,
}

impl Energy {
    /// Energy supplied: initial energy and external work, or what an initial stress sets free, from which the strain energy counts.
    pub fn supplied(&self) -> f64 {
        self.initial.abs().max((self.initial + self.external_work).abs()).max(-self.strain)
    }

    /// external work + initial − (kinetic + strain + contact) − dissipation − radiated: 0 for an exact integration.
    pub fn error(&self) -> f64 {
        self.external_work + self.initial
            - (self.kinetic + self.strain + self.contact_elastic)
            - (self.friction_dissipation + self.damping_dissipation + self.plastic_dissipation + self.radiated)
    }
}
