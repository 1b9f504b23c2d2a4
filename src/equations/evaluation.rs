//! Results of an evaluation of the equations for the accepted state.
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

use std::ops::Range;

use super::{bars, contacts, damping, links};
use crate::bars::BarState;
use crate::contact::{ContactPair, ContactState};
use crate::laws::friction::Regime;
use crate::model::state::{State, Water};
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
    /// states of the bars at the end of the trial
    pub bars: Vec<BarState>,
    /// water of the pores that flows
    pub water: Water,
    /// ∫ W dV, and what bars store [F·L]
    pub strain_energy: f64,
    /// Viscous dissipation of the materials in the increment [F·L]
    pub dissipated: f64,
    /// Plastic dissipation of the materials in the increment [F·L]
    pub plastic: f64,
    /// Work of changes of temperatures and of pressures in pores, and of jacks on bars, in the increment [F·L]
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
        for regime in regimes(pairs, contacts) {
            match regime {
                Regime::Open => counts.open += 1,
                Regime::Stick | Regime::Tied => counts.stick += 1,
                Regime::Slip => counts.slip += 1,
            }
        }
        counts
    }
}

/// Status of every contact point.
pub fn regimes(pairs: &[ContactPair], contacts: &[Vec<ContactState>]) -> Vec<Regime> {
    let of_pair = |(pair, states): (&ContactPair, &Vec<ContactState>)| {
        pair.points.iter().zip(states).map(|(point, state)| pair.regime(point, state)).collect::<Vec<_>>()
    };
    pairs.iter().zip(contacts).flat_map(of_pair).collect()
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
        let loads = [&old.external, &found.loads].map(|forces| &forces[..]);
        let [loaded, damped] = match model.is_damped(step) {
            true => mean_work([loads, [&old.damping, &found.damping].map(|forces| &forces[..])], ends),
            false => [mean_work([loads], ends)[0], 0.0],
        };
        let fitted = contacts::fitted(model, [&old.contacts, &found.contacts], times);
        Self {
            work: loaded + driven + fitted,
            damping: driven - damped + relaxed(model, step, old, u),
            stabilization: damping::stabilization_dissipated(step, times, way),
            friction: contacts::dissipated(&old.contacts, &found.contacts) + bars::dissipated(&found.bars),
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

/// Σ ½ (f₀ + f₁) (u₁ − u₀): the work of each of some forces known at both ends of an increment [F·L]. Halves are summed up in
/// parallel, always the same ones.
fn mean_work<const N: usize>(forces: [[&[f64]; 2]; N], [u0, u1]: [&[f64]; 2]) -> [f64; N] {
    let count = u0.len();
    let part = |range: Range<usize>| {
        let forces = forces.map(|ends| ends.map(|force| &force[range.clone()]));
        (forces, [&u0[range.clone()], &u1[range]])
    };
    if count > CHUNK {
        let halves = [part(0..count / 2), part(count / 2..count)];
        let [first, second] = halves.map(|(forces, ends)| move || mean_work(forces, ends));
        let (first, second) = rayon::join(first, second);
        return std::array::from_fn(|k| first[k] + second[k]);
    }
    let (forces, [u0, u1]) = part(0..count);
    let mut sums = [0.0; N];
    for dof in 0..count {
        let way = u1[dof] - u0[dof];
        for (sum, [f0, f1]) in sums.iter_mut().zip(&forces) {
            *sum += 0.5 * (f0[dof] + f1[dof]) * way;
        }
    }
    sums
}
