//! What an evaluation of the equations leaves for the accepted state.

use crate::contact::force::ContactState;
use crate::contact::pair::ContactPair;
use crate::laws::friction::Regime;

/// What was found at the last evaluated displacement, for the accepted state.
#[derive(Clone, Debug, Default)]
pub struct Evaluation {
    /// F [F]
    pub force: Vec<f64>,
    /// loads [F]
    pub loads: Vec<f64>,
    /// forces of dashpots on the nodes [F]
    pub damping: Vec<f64>,
    /// norm of the forces of those that stabilize [F]
    pub stabilization: f64,
    /// F + M a at every support, in their order: what it puts on the node [F]
    pub reactions: Vec<f64>,
    /// v [L/T]
    pub velocity: Vec<f64>,
    /// a [L/T²]
    pub acceleration: Vec<f64>,
    /// trial states of all contact points
    pub contacts: Vec<Vec<ContactState>>,
    /// What the materials remember at the end of the trial
    pub memory: Vec<f64>,
    /// ∫ W dV [F·L]
    pub strain_energy: f64,
    /// What the materials dissipated in the increment [F·L]
    pub dissipated: f64,
    /// Work of the temperatures that changed in the increment [F·L]
    pub heating: f64,
}

/// Numbers of contact points by status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactCounts {
    /// open
    pub open: usize,
    /// sticking
    pub stick: usize,
    /// slipping
    pub slip: usize,
}

impl ContactCounts {
    /// Count the points of all pairs.
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
