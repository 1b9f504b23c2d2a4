//! A load step of the model.
//!
//! A step can end early when a reaction reaches a value, or a degree of consolidation.
//!
//! ```text
//! |F − F̄| ≤ tolerance max(|F̄|, |F₀|)                    F₀: at the start of the step
//! ```
//!
//! An increment in which F passes F̄ on the straight line from old to new is repeated up to that point; after an increment that
//! ends close to it, the next length follows from the same rate. Where F jumps past F̄ within the shortest increment resolvable
//! in time, the step ends after the jump.

use nalgebra::Vector2;

use super::bars::BarsInStep;
use super::body::Damping;
use super::boundary::{Amplitude, Drive, Loads, Span};
use super::imposed::Temperature;
use super::pore_flow::Drain;
use super::scheme::Scheme;
use super::state::{State, Water};
use super::support::{Direction, Motion, Prescribed};
use crate::contact::pair::ContactPair;

/// Shortest increment relative to the run time at its end, below which round-off would dominate.
pub const SHORTEST_INCREMENT: f64 = 16.0 * f64::EPSILON;

/// Size and error control of increments.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Increments {
    /// first Δt [T]
    pub initial: f64,
    /// minimum; a failed increment of this length stops the run [T]
    pub min: f64,
    /// maximum [T]
    pub max: f64,
    /// allowed local error per increment of a displacement or, in a static step, of the slip of a contact point [L]
    pub error: Option<f64>,
    /// allowed error per increment of the slip of friction that is integrated to first order in time, as a fraction of its
    /// D_c [-]
    pub slip: Option<f64>,
    /// allowed error per increment of the pressure of water that flows through pores [F/L²]
    pub pore_pressure: Option<f64>,
}

impl Increments {
    /// Returns these settings with increments no longer than `longest`: a stabilized step needs a last increment after its
    /// dashpots have vanished.
    #[doc(hidden)]
    pub fn at_most(self, longest: f64) -> Self {
        let Self { initial, min, max, .. } = self;
        Self { initial: initial.min(longest), min: min.min(longest), max: max.min(longest), ..self }
    }

    /// Whether an error decides how long they are.
    #[doc(hidden)]
    pub fn are_controlled(&self) -> bool {
        self.error.is_some() || self.slip.is_some() || self.pore_pressure.is_some()
    }
}

/// A step: a time span with its supports, loads, scheme and increments.
#[derive(Clone, Debug, Default)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Step {
    /// name, for messages and output
    pub name: String,
    /// time span
    pub span: Span,
    /// scheme
    pub scheme: Scheme,
    /// increments
    pub increments: Increments,
    /// criteria of the automatic switch to explicit integration, if any
    #[doc(hidden)]
    pub rupture: Option<Box<Rupture>>,
    /// prescribed directions, ascending by dof
    #[doc(hidden)]
    pub supports: Vec<Prescribed>,
    /// directions that were prescribed in the previous step and are free in this static one: their reaction decreases to zero
    #[doc(hidden)]
    pub released: Vec<Direction>,
    /// velocities assigned to nodes at the start of the step [L/T]
    #[doc(hidden)]
    pub launch: Vec<(usize, [f64; 2])>,
    /// loads, springs and dashpots
    pub loads: Loads,
    /// outlets of water that flows through pores
    #[doc(hidden)]
    pub drains: Vec<Drain>,
    /// supports and loads as the input gave them: those that the step ends, then those in force in it
    #[doc(hidden)]
    pub entries: Vec<Entry>,
    /// prescribed temperatures of bodies
    #[doc(hidden)]
    pub temperatures: Vec<Temperature>,
    /// damping of every body
    #[doc(hidden)]
    pub damping: Vec<Damping>,
    /// whether each body is absent; empty if all are there
    #[doc(hidden)]
    pub absent: Vec<bool>,
    /// bodies that this step adds or removes
    #[doc(hidden)]
    pub changed: Vec<usize>,
    /// whether the laws are weaker than those of the step before: the forces that they no longer bear decrease to zero over the step
    #[doc(hidden)]
    pub relaxes: bool,
    /// bars: which are there, and which are stressed
    #[doc(hidden)]
    pub bars: BarsInStep,
    /// reaction that ends the step early
    #[doc(hidden)]
    pub until: Option<Until>,
    /// c₀ of every dof: stabilizing dashpots with the factor 1 − elapsed fraction of the step [F T/L]
    #[doc(hidden)]
    pub stabilization: Vec<f64>,
}

/// A support or load of the input, in words.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct Entry {
    /// whether it is a load, and not a support
    pub is_load: bool,
    /// place
    pub on: String,
    /// kind, such as `ux` or `dead pressure`
    pub kind: String,
    /// value as last given; `None` if it was ended
    pub value: Option<String>,
    /// whether this was in an earlier step
    pub kept: bool,
    /// whether it decreases to zero over the step that ends it, and does not end at once
    pub fades: bool,
}

impl Entry {
    /// Returns the entries of a step in the order of [`Step::entries`]: supports before loads, each by place and kind.
    pub fn of_step<'e>(all: impl Iterator<Item = &'e Self>) -> Vec<Self> {
        let mut entries: Vec<Self> = all.filter(|entry| entry.value.is_some() || !entry.kept).cloned().collect();
        let order =
            |Self { value, is_load, on, kind, .. }: &Self| (value.is_some(), *is_load, on.clone(), kind.clone());
        entries.sort_by_cached_key(order);
        entries
    }
}

#[doc(hidden)]
impl Step {
    /// Δt of the next attempt after the given one at an increment, of length `dt`, could not be solved: half of it, as long as that is no
    /// less than the minimum. In dynamic steps a quarter follows the second attempt, and eighths the later ones: before fast slip increments
    /// must become thousands of times shorter, and a failed attempt takes more solves than the increments by which a length grows again.
    #[doc(hidden)]
    pub fn shorter(&self, dt: f64, attempt: usize) -> Option<f64> {
        let share = match attempt {
            2 if self.scheme.is_dynamic() => 0.25,
            3.. if self.scheme.is_dynamic() => 0.125,
            _ => 0.5,
        };
        let min = self.increments.min;
        (0.5 * dt >= min).then(|| (share * dt).max(min))
    }

    /// Whether a body is there.
    pub fn has(&self, body: usize) -> bool {
        !self.absent.get(body).copied().unwrap_or(false)
    }

    /// Whether a contact acts: the bodies of both sides are there.
    pub fn joins(&self, pair: &ContactPair) -> bool {
        self.absent.is_empty() || pair.bodies.iter().flatten().all(|&body| self.has(body))
    }

    /// Whether it adds or removes a body or a bar, or has weaker laws.
    pub fn changes_anything(&self) -> bool {
        self.relaxes || !(self.changed.is_empty() && self.bars.changed.is_empty())
    }

    /// Whether it adds or removes a side of a contact.
    pub fn changes(&self, pair: &ContactPair) -> bool {
        pair.bodies.iter().flatten().any(|body| self.changed.contains(body))
    }

    /// Whether some of its increments are explicit, or may be.
    pub fn may_be_explicit(&self) -> bool {
        self.rupture.is_some() || self.scheme.is_explicit()
    }

    /// The step shifted in time, including everything that begins with it or later.
    #[must_use]
    pub fn moved(mut self, to: &impl Fn(Span) -> Span) -> Self {
        fn amplitude(of: &mut Amplitude, to: &impl Fn(Span) -> Span) {
            of.span = to(of.span);
            of.before.iter_mut().for_each(|before| amplitude(before, to));
        }
        self.span = to(self.span);
        for support in &mut self.supports {
            match &mut support.motion {
                Motion::Displacement(_, span) => *span = to(*span),
                Motion::Inclined(parts) => parts.iter_mut().for_each(|part| part.span = to(part.span)),
                Motion::Rotation { angle, .. } => amplitude(angle, to),
            }
        }
        self.loads.amplitudes_mut().for_each(|of| amplitude(of, to));
        self.temperatures.iter_mut().for_each(|of| amplitude(&mut of.amplitude, to));
        if let Some(rupture) = &mut self.rupture {
            rupture.explicit = std::mem::take(&mut rupture.explicit).moved(to);
        }
        self
    }

    /// The step shifted in time to its start if earlier ones have ended early: at the second of each of these times instead of the
    /// first [T].
    #[must_use]
    pub fn after(self, ended: &[[f64; 2]]) -> Self {
        if ended.is_empty() {
            return self;
        }
        let moved = |span: Span| {
            let before = ended.iter().rev().find(|[planned, _]| *planned <= span.start);
            let at = |time: f64| before.map_or(time, |[planned, came]| came + (time - planned));
            Span { start: at(span.start), end: at(span.end) }
        };
        self.moved(&moved)
    }

    /// Times of the tables by which supports and loads go.
    pub fn corners(&self) -> impl Iterator<Item = f64> + '_ {
        let motions = self.supports.iter().flat_map(|support| support.motion.drives());
        let outlets = self.drains.iter().flat_map(|drain| drain.value.corners());
        self.loads.amplitudes().map(|amplitude| &amplitude.drive).chain(motions).flat_map(Drive::corners).chain(outlets)
    }

    /// The support that prescribes a dof: its own, or an inclined one of its node.
    pub fn support_at(&self, dof: usize) -> Option<&Prescribed> {
        let find = |dof: usize| self.supports.binary_search_by_key(&dof, |support| support.at.dof).ok();
        let inclined = || find(dof ^ 1).filter(|k| self.supports[*k].at.inclined.is_some());
        find(dof).or_else(inclined).map(|k| &self.supports[k])
    }
}

/// Criteria for switching a static or implicit step to explicit increments and back.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct Rupture {
    /// Slip rate of a contact point above which the step becomes explicit [L/T]
    pub slip_rate: f64,
    /// Averaging time over which no point may slip that fast for a return: travel time of a shear wave across the model [T]
    pub calm: f64,
    /// The step during explicit integration
    pub explicit: Step,
}

/// Number of attempts at an increment after which it is halved: where the reaction jumps, extrapolation by its rate fails.
const PATIENCE: usize = 6;

/// Fraction of the step below which an increment in which the reaction passes its value is not shortened again.
const SHORTEST: f64 = 1e-9;

/// What ends a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Until {
    /// name of the group or body, for messages
    pub on: String,
    /// what it is
    pub goal: Goal,
    /// value at which it does [F], [-]
    pub value: f64,
    /// Tolerance relative to it [-]
    pub tolerance: f64,
}

/// A quantity that ends a step where it has some value.
#[derive(Clone, Debug, PartialEq)]
pub enum Goal {
    /// a component of the sum of the reactions of some nodes, those that belong to it along x and y
    Reaction([Vec<usize>; 2], ForceComponent),
    /// the degree of consolidation of a body, by its number among those in which water flows; the step ends where it has grown to its value
    Consolidation(usize),
}

/// A component of a force, or its magnitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceComponent {
    /// along x
    X,
    /// along y
    Y,
    /// magnitude
    Magnitude,
}

impl ForceComponent {
    /// Name in a case.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "fx",
            Self::Y => "fy",
            Self::Magnitude => "force",
        }
    }
}

/// Status of an increment with respect to what ends its step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UntilStatus {
    /// It has reached its value: the step ends
    Met,
    /// It has passed the value; length of the increment that would end at it [T]
    Passed(f64),
    /// It has not reached the value; length of the increment that would, at the same rate, if any [T]
    Before(Option<f64>),
}

impl Until {
    /// Name of the quantity in a case.
    pub fn name(&self) -> &'static str {
        match self.goal {
            Goal::Reaction(_, part) => part.name(),
            Goal::Consolidation(_) => "consolidation",
        }
    }

    /// Its value, of reactions of a state or of the start of its step, or of its water [F], [-].
    fn of(&self, reaction: &[f64], water: &Water) -> f64 {
        match &self.goal {
            Goal::Reaction(constrained, part) => {
                let force = vector(constrained, reaction);
                match part {
                    ForceComponent::X => force.x,
                    ForceComponent::Y => force.y,
                    ForceComponent::Magnitude => force.norm(),
                }
            }
            Goal::Consolidation(body) => water.consolidation(*body),
        }
    }

    /// Its value in a state [F], [-].
    pub fn value_in(&self, state: &State) -> f64 {
        self.of(&state.reaction, &state.water)
    }

    /// Fraction of an increment at which it first has the value if it varies linearly; the magnitude has it again where the
    /// force reverses.
    fn share(&self, [old, new]: [&State; 2]) -> Option<f64> {
        let straight = |before: f64, way: f64| [(self.value - before) / way; 2];
        let Goal::Reaction(constrained, part) = &self.goal else {
            let [before, after] = [old, new].map(|state| self.value_in(state));
            return (after > before).then(|| straight(before, after - before)[0]).filter(|share| *share > 0.0);
        };
        let [before, after] = [old, new].map(|state| vector(constrained, &state.reaction));
        let way = after - before;
        let shares = match part {
            ForceComponent::X => straight(before.x, way.x),
            ForceComponent::Y => straight(before.y, way.y),
            ForceComponent::Magnitude => {
                // |before + s way| = value
                let (square, rate) = (way.norm_squared(), before.dot(&way));
                let short = before.norm_squared() - self.value * self.value;
                let root = (rate * rate - square * short).sqrt();
                let both = -(rate + root.copysign(rate));
                [both / square, short / both]
            }
        };
        shares.into_iter().filter(|share| *share > 0.0 && share.is_finite()).reduce(f64::min)
    }

    /// Status of an increment with respect to the end of the step.
    pub fn status(&self, span: Span, [old, new]: [&State; 2]) -> UntilStatus {
        let clock = SHORTEST * (span.end - span.start) + 64.0 * f64::EPSILON * new.time.abs();
        let share = self.share([old, new]);
        let passed = share.is_some_and(|share| share < 1.0);
        if self.is_close(new) || !passed && self.is_met(new) || passed && new.dt <= clock {
            return UntilStatus::Met;
        }
        match share {
            Some(share) if passed => UntilStatus::Passed(share * new.dt),
            share => UntilStatus::Before(share.map(|share| (share - 1.0) * new.dt)),
        }
    }

    /// Whether a state has it within the tolerance, or a larger degree of consolidation.
    pub fn is_met(&self, state: &State) -> bool {
        self.is_close(state) || matches!(self.goal, Goal::Consolidation(_)) && self.value_in(state) > self.value
    }

    fn is_close(&self, state: &State) -> bool {
        let at_start = self.of(&state.step_start.reaction, &state.water);
        let scale = self.value.abs().max(if let Goal::Reaction(..) = self.goal { at_start.abs() } else { 0.0 });
        (self.value_in(state) - self.value).abs() <= self.tolerance * scale
    }

    /// Length of the next attempt at an increment in which the value was passed [T].
    pub fn shorter(passed: f64, dt: f64, attempt: usize) -> f64 {
        if attempt < PATIENCE { passed } else { passed.min(0.5 * dt) }
    }
}

/// Sum of the reactions of the nodes that belong to it along x and y [F].
fn vector(constrained: &[Vec<usize>; 2], reaction: &[f64]) -> Vector2<f64> {
    let sum = |i: usize| constrained[i].iter().map(|node| reaction[2 * node + i]).sum();
    Vector2::new(sum(0), sum(1))
}
