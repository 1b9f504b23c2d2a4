//! Results of an evaluation of the equations for the accepted state.
//!
//! # Audit of energies
//!
//! The energy audit sums the energy flows of an increment and the energy stored at its end, term by term.
//!
//! ```text
//! work       ½ (f₀ + f₁)·Δu of loads and reactions; drivers of dashpots; overlaps of shrink fits
//! damping    −½ (d₀ + d₁)·Δu of the forces of dashpots on the nodes; drivers; kinetic energy removed by statics
//! friction   ∫ q v^p ds dt
//! radiated   ½ (r₀ + r₁) Δu_t of the tractions r = η v of radiation damping
//! ```
//! In every scheme, forces are taken at both ends of the increment.

use super::{contacts, damping, links};
use crate::contact::force::ContactState;
use crate::contact::pair::ContactPair;
use crate::laws::friction::Regime;
use crate::model::state::State;
use crate::model::support::Direction;
use crate::model::{Model, Step};

/// Results at the last evaluated displacement, for the accepted state.
#[derive(Clone, Debug, Default)]
pub struct Evaluation {
    /// F [F]
    pub force: Vec<f64>,
    /// loads [F]
    pub loads: Vec<f64>,
    /// forces of dashpots on the nodes [F]
    pub damping: Vec<f64>,
    /// norm of the stabilizing forces [F]
    pub stabilization: f64,
    /// F + M a at every support, in their order: its reaction on the node [F]
    pub reactions: Vec<f64>,
    /// v [L/T]
    pub velocity: Vec<f64>,
    /// a [L/T²]
    pub acceleration: Vec<f64>,
    /// trial states of all contact points
    pub contacts: Vec<Vec<ContactState>>,
    /// Internal variables of the materials at the end of the trial
    pub memory: Vec<f64>,
    /// ∫ W dV [F·L]
    pub strain_energy: f64,
    /// Energy dissipated by the materials in the increment [F·L]
    pub dissipated: f64,
    /// Work of the temperature change in the increment [F·L]
    pub heating: f64,
}

/// Numbers of contact points by status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ContactCounts {
    /// open
    pub open: usize,
    /// sticking
    pub stick: usize,
    /// slipping
    pub slip: usize,
}

impl ContactCounts {
    /// Counts the points of all pairs.
    #[doc(hidden)]
    pub fn of(pairs: &[ContactPair], contacts: &[Vec<ContactState>]) -> Self {
        let mut counts = Self::default();
        let regimes = |(pair, states): (&ContactPair, &Vec<ContactState>)| {
            pair.points.iter().zip(states).map(|(point, state)| pair.regime(point, state)).collect::<Vec<_>>()
        };
        for regime in pairs.iter().zip(contacts).flat_map(regimes) {
            match regime {
                Regime::Open => counts.open += 1,
                Regime::Stick => counts.stick += 1,
                Regime::Slip => counts.slip += 1,
            }
        }
        counts
    }
}

/// Seconds spent by phase.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seconds {
    /// solids, loads and sums
    pub assembly: f64,
    /// search, friction and contact forces
    pub contact: f64,
}

/// Number of degrees of freedom summed by one thread at a time.
const CHUNK: usize = 8192;

/// Energy flows in an increment [F·L].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flows {
    /// external work
    pub work: f64,
    /// dissipated by dashpots and viscous bodies
    pub damping: f64,
    /// dissipated by stabilizing dashpots, part of `damping`
    pub stabilization: f64,
    /// dissipated by friction
    pub friction: f64,
    /// radiated by slip
    pub radiated: f64,
}

impl Flows {
    /// Energy flows from a state to the evaluation at the displacement `u` at the end of an increment, with the reactions
    /// included in the loads.
    pub fn between(model: &Model, step: &Step, old: &State, time: f64, u: &[f64], found: &Evaluation) -> Self {
        let (times, ends) = ([old.time, time], [&old.displacement, u]);
        let way = |dof: usize| u[dof] - old.displacement[dof];
        let driven = damping::driven(model, step, times, way);
        let damped = if model.is_damped(step) { mean_work([&old.damping, &found.damping], ends) } else { 0.0 };
        let fitted = contacts::fitted(model, [&old.contacts, &found.contacts], times);
        Self {
            work: mean_work([&old.external, &found.loads], ends) + driven + fitted,
            damping: driven - damped + relaxed(model, step, old, u),
            stabilization: damping::stabilization_dissipated(step, times, way),
            friction: contacts::dissipated(&old.contacts, &found.contacts),
            radiated: contacts::radiated(&old.contacts, &found.contacts),
        }
    }
}

/// Work of out-of-balance forces at the start of a static increment, left by earlier motion.
fn relaxed(model: &Model, step: &Step, old: &State, u: &[f64]) -> f64 {
    if step.scheme.is_dynamic() {
        return 0.0;
    }
    let force = links::relieved(model, &old.displacement, &old.force);
    let work = |dof: usize| force[dof] * (u[dof] - old.displacement[dof]);
    let all: f64 = (0..u.len()).map(work).sum();
    let along = |at: Direction| match at.inclined {
        None => work(at.dof),
        Some(_) => at.of(&force) * (at.of(u) - at.of(&old.displacement)),
    };
    let supported: f64 = step.supports.iter().map(|support| along(support.at)).sum();
    -0.5 * (all - supported)
}

/// Σ ½ (f₀ + f₁) (u₁ − u₀): the work of forces known at both ends of an increment [F·L]. The parallel sum has a fixed
/// order.
fn mean_work([f0, f1]: [&[f64]; 2], [u0, u1]: [&[f64]; 2]) -> f64 {
    if u0.len() > CHUNK {
        let half = u0.len() / 2;
        let part = |k: usize| {
            let of = |values: &'_ [f64]| if k == 0 { 0..half } else { half..values.len() };
            mean_work([&f0[of(f0)], &f1[of(f1)]], [&u0[of(u0)], &u1[of(u1)]])
        };
        let (first, second) = rayon::join(|| part(0), || part(1));
        return first + second;
    }
    let forces = f0.iter().zip(f1).map(|(f0, f1)| 0.5 * (f0 + f1));
    forces.zip(u0.iter().zip(u1)).map(|(force, (u0, u1))| force * (u1 - u0)).sum()
}
