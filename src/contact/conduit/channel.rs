//! Water that flows along a contact.
//!
//! ```text
//! S ∂p/∂t + ∂w/∂t = ∂/∂s(T/η ∂p/∂s) + Q − c (p − p̄)                  along the undeformed slave                      (1)
//! T = T₀ + k₁ |slip|  or  (w_h + w)³/12,  × exp(−p′/σ)                                                            (2)
//! w = d + ⟨g − d⟩                                   d: opening of the law, g: gap, p′: effective pressure of the contact (3)
//! ```
//! Volumes belong to nodes, each with half of the edges adjacent to it, and flows to what joins two nodes (finite volumes): no pressure
//! over- or undershoots, and what leaves one node enters the next. Ends of the contact are impervious; a well holds the pressure of a
//! node, or gives a rate to the place between two nodes. What is divided by a periodic side is joined.
//!
//! Between nodes the pressure is linear, and the surfaces at a node are the mean of the points about it with the same weights: what opens is the
//! volume that the pressure works on.
//!
//! The penetration of a penalty is no change of volume: w counts what is open and what the law has lifted.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::line::Line;
use crate::contact::fluid::Fluid;
use crate::contact::point::{ContactState, WaterPoint, Weights};

/// What the water feels of the surfaces at a node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Wall {
    /// w [L]
    pub opening: f64,
    /// |slip| [L]
    pub slip: f64,
    /// p′ [F/L²]
    pub pressure: f64,
}

impl Wall {
    /// At a contact point.
    pub fn of(state: &ContactState) -> Self {
        let lifted = state.friction.opening;
        let separation = if state.master_point.is_some() { (state.gap - lifted).max(0.0) } else { 0.0 };
        let pressure = (state.friction.pressure - state.tension()).max(0.0);
        Self { opening: lifted + separation, slip: state.friction.plastic_slip, pressure }
    }

    /// Sum of both, each with a factor.
    #[must_use]
    pub fn combined(self, factor: f64, other: Self, of_other: f64) -> Self {
        let sum = |own: f64, other: f64| factor * own + of_other * other;
        Self {
            opening: sum(self.opening, other.opening),
            slip: sum(self.slip, other.slip),
            pressure: sum(self.pressure, other.pressure),
        }
    }
}

/// Water of a contact between increments.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ConduitState {
    /// p_w of every node [F/L²]
    pub pressure: Vec<f64>,
    /// The surfaces at every node
    pub walls: Vec<Wall>,
    /// Mean rates of the surfaces in the last increment
    pub rates: Vec<Wall>,
    /// Volumes so far
    pub amounts: Amounts,
    /// What the volume in the contact has changed by, less what has come in [L³]
    pub mass_error: f64,
    /// Estimated error of the pressure in the last increment by what the surfaces did within it, over the allowed one [-]
    pub uncertainty: f64,
}

/// A pressure below zero that is the error of the steps, over the largest change of the pressure since the start of the run [-]
const BELOW_ZERO: f64 = 1e-3;

/// T of a contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Transmissivity {
    /// T₀ of every node [L³]
    pub at_rest: Vec<f64>,
    /// k₁ [L²]
    pub per_slip: f64,
    /// w_h in place of T₀: by the cubic law [L]
    pub aperture: Option<f64>,
    /// σ [F/L²]
    pub closing: Option<f64>,
}

impl Transmissivity {
    /// T at a node.
    pub fn at(&self, node: usize, wall: Wall) -> f64 {
        let whole = match self.aperture {
            Some(aperture) => (aperture + wall.opening).max(0.0).powi(3) / 12.0,
            None => self.at_rest[node] + self.per_slip * wall.slip.abs(),
        };
        self.closing.map_or(whole, |closing| whole * (-wall.pressure.max(0.0) / closing).exp())
    }

    /// Whether it changes with the surfaces.
    pub fn varies(&self) -> bool {
        self.per_slip > 0.0 || self.aperture.is_some() || self.closing.is_some()
    }
}

/// A function of time.
pub type InTime = Box<dyn Fn(f64) -> f64 + Send + Sync>;

/// What a well does.
pub enum Gives {
    /// Holds the pressure of a node [F/L²]
    Pressure(InTime),
    /// Lets a volume flow in [L³/T]
    Rate(InTime),
}

/// A well.
pub struct Well {
    /// Nodes of the conduit, and their shares; one node where a pressure is prescribed
    pub at: Vec<(usize, f64)>,
    /// What it does
    pub gives: Gives,
    /// Start and end; it is shut before and afterwards [T]
    pub span: [f64; 2],
    /// Times at which its rate of change jumps [T]
    pub corners: Vec<f64>,
}

impl Well {
    /// Whether it is open at a time.
    pub fn is_open(&self, time: f64) -> bool {
        self.span[0] <= time && time < self.span[1]
    }
}

/// Flow through the walls, c (p − p̄).
#[derive(Clone, Debug, PartialEq)]
pub struct Leak {
    /// c [L³/(F T)]
    pub coefficient: f64,
    /// p̄ of every node [F/L²]
    pub pressure: Vec<f64>,
}

/// Q by node and time [L/T].
pub type SourceAt = Box<dyn Fn(usize, f64) -> f64 + Send + Sync>;

/// Water that flows along a contact.
pub struct Conduit {
    /// Its nodes along the slave
    pub line: Line,
    /// Nodes of the conduit at every contact point, and their shares
    pub shares: Vec<Weights>,
    /// Volume of a point per opening, undeformed [L]
    pub lengths: Vec<f64>,
    /// The same of every node [L]
    pub holds: Vec<f64>,
    /// S [L³/F]
    pub storage: f64,
    /// T [L³]
    pub transmissivity: Transmissivity,
    /// η [F T/L²]
    pub viscosity: f64,
    /// p_w of every node at the start [F/L²]
    pub initial: Vec<f64>,
    /// Q, if there is any
    pub source: Option<SourceAt>,
    /// Wells
    pub wells: Vec<Well>,
    /// Flow through the walls, if there is any
    pub leak: Option<Leak>,
    /// Error of the pressure by what the surfaces do within an increment that is allowed, over its largest change [-]
    pub error: f64,
    /// Number of the pressure of every node among those of the bodies' water, with which it is solved; empty between dry bodies
    pub pressures: Vec<usize>,
}

impl fmt::Debug for Conduit {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "water that flows along {} nodes", self.line.count())
    }
}

impl Conduit {
    /// Whether it is solved with the water of the bodies.
    pub fn is_wet(&self) -> bool {
        !self.pressures.is_empty()
    }

    /// The surfaces at every node.
    pub fn walls(&self, states: &[ContactState]) -> Vec<Wall> {
        self.averaged(states.iter().map(Wall::of))
    }

    /// The surfaces at every node from those at the contact points.
    pub fn averaged(&self, points: impl Iterator<Item = Wall>) -> Vec<Wall> {
        let mut walls = vec![Wall::default(); self.line.count()];
        for ((own, shares), length) in points.zip(&self.shares).zip(&self.lengths) {
            for &(node, share) in shares {
                walls[node] = walls[node].combined(1.0, own, share * length);
            }
        }
        for (wall, length) in walls.iter_mut().zip(&self.holds).filter(|(_, length)| **length > 0.0) {
            *wall = wall.combined(1.0 / length, Wall::default(), 0.0);
        }
        // A node without points of its own, as that on the axis of rings, is as its neighbour.
        for (a, b) in self.line.pieces() {
            match [a, b].map(|node| self.holds[node] > 0.0) {
                [false, true] => walls[a] = walls[b],
                [true, false] => walls[b] = walls[a],
                _ => {}
            }
        }
        walls
    }

    /// Values at the contact points from those of the nodes.
    fn at_points<'a>(&'a self, values: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.shares.iter().map(|shares| shares.iter().map(|&(node, share)| share * values[node]).sum())
    }

    /// The state at the start of a run.
    pub fn begin(&self, states: &[ContactState]) -> ConduitState {
        let walls = self.walls(states);
        ConduitState {
            pressure: self.initial.clone(),
            rates: vec![Wall::default(); walls.len()],
            walls,
            ..ConduitState::default()
        }
    }

    /// Water at every contact point.
    pub fn points(&self, pressure: &[f64], walls: &[Wall]) -> Vec<WaterPoint> {
        let transmissivity: Vec<f64> =
            walls.iter().enumerate().map(|(node, wall)| self.transmissivity.at(node, *wall)).collect();
        let flows = self.line.flows(pressure, &transmissivity, self.viscosity);
        let hydraulic = self.transmissivity.aperture.unwrap_or(0.0);
        let apertures: Vec<f64> = walls.iter().map(|wall| hydraulic + wall.opening).collect();
        let rest = self.at_points(&flows).zip(self.at_points(&apertures));
        let point = |(pressure, (flow, aperture)): (f64, (f64, f64))| WaterPoint {
            pressure: pressure.max(0.0),
            flow,
            aperture,
        };
        self.at_points(pressure).zip(rest).map(point).collect()
    }

    /// The fluid as it is at the start; `copies` are nodes of the mesh that stand for nodes of the conduit.
    pub fn at_start(&self, copies: impl Fn(usize) -> usize + Send + Sync + 'static) -> Fluid {
        let known: BTreeMap<usize, f64> = self.line.nodes.iter().copied().zip(self.initial.iter().copied()).collect();
        Fluid::flowing(move |node| known.get(&copies(node)).copied().unwrap_or(0.0))
    }

    /// The state after an increment, with what its wells and leaks have moved.
    pub fn after(
        &self,
        old: &ConduitState,
        dt: f64,
        pressure: Vec<f64>,
        walls: Vec<Wall>,
        amounts: Amounts,
    ) -> ConduitState {
        let (volume, rate) = (self.gained([&old.pressure, &pressure], [&old.walls, &walls]), 1.0 / dt);
        ConduitState {
            rates: walls.iter().zip(&old.walls).map(|(new, old)| new.combined(rate, *old, -rate)).collect(),
            amounts: old.amounts.combined(1.0, amounts, 1.0),
            mass_error: old.mass_error + volume - amounts.injected + amounts.leaked,
            uncertainty: 0.0,
            pressure,
            walls,
        }
    }

    /// Change of the volume in the contact, S p + w, integrated [L³].
    fn gained(&self, [p0, p1]: [&[f64]; 2], [from, to]: [&[Wall]; 2]) -> f64 {
        let pressures = p0.iter().zip(p1).map(|(p0, p1)| p1 - p0);
        let openings = from.iter().zip(to).map(|(from, to)| to.opening - from.opening);
        let volumes = pressures.zip(openings).zip(self.line.lengths().iter().zip(&self.holds));
        volumes.map(|((p, opening), (length, holds))| length * self.storage * p + holds * opening).sum()
    }

    /// The lowest pressure with its node, if it is below zero by more than the error of the steps, or the round-off of `floor`.
    pub fn bad(&self, pressure: &[f64], floor: f64) -> Option<(usize, f64)> {
        let changes = pressure.iter().zip(&self.initial).map(|(p, initial)| (p - initial).abs());
        let allowed = (BELOW_ZERO * changes.fold(0.0, f64::max)).max(f64::EPSILON * floor);
        let least = pressure.iter().copied().enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        least.filter(|(_, pressure)| *pressure < -allowed)
    }

    /// Times at which its rates jump [T]
    pub fn corners(&self) -> impl Iterator<Item = f64> + '_ {
        self.wells
            .iter()
            .flat_map(|well| well.corners.iter().chain(&well.span).copied())
            .filter(|time| time.is_finite())
    }
}

/// Volumes, over the thickness of the section [L³]
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Amounts {
    /// What wells and sources have let in
    pub injected: f64,
    /// What has leaked through the walls
    pub leaked: f64,
    /// What has gone through wells, sources and walls in either direction
    pub throughput: f64,
}

impl Amounts {
    /// Sum of both, each with a factor.
    #[must_use]
    pub fn combined(self, factor: f64, other: Self, of_other: f64) -> Self {
        let sum = |own: f64, other: f64| factor * own + of_other * other;
        Self {
            injected: sum(self.injected, other.injected),
            leaked: sum(self.leaked, other.leaked),
            throughput: sum(self.throughput, other.throughput),
        }
    }
}

impl Amounts {
    /// The same with another throughput.
    #[must_use]
    pub fn with_throughput(self, throughput: f64) -> Self {
        Self { throughput, ..self }
    }
}
