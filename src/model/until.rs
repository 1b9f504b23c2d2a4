//! What ends a step before its time: a reaction that reaches a value.
//!
//! ```text
//! |F − F̄| ≤ tolerance max(|F̄|, |F₀|)                    F₀: at the start of the step
//! ```
//!
//! An increment in which F passes F̄ on the straight way from old to new is repeated up to there, and one that comes near it is
//! followed by one as long as it takes at the same rate. Where F jumps past F̄ in the shortest increment that the
//! clock can tell, the step ends behind the jump.

use nalgebra::Vector2;

use super::boundary::Span;
use super::state::State;

/// Attempts at an increment after which it is halved: where the reaction jumps, its rate leads nowhere.
const PATIENCE: usize = 6;

/// Share of the step below which an increment in which the reaction passes its value is not cut again.
const SHORTEST: f64 = 1e-9;

/// A reaction that ends a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Until {
    /// name of the group, for messages
    pub on: String,
    /// nodes whose reactions along x and y are its own
    pub held: [Vec<usize>; 2],
    /// which part of the sum of their reactions
    pub part: Part,
    /// F̄ [F]
    pub value: f64,
    /// Share of F̄ within which it is met [-]
    pub tolerance: f64,
}

/// Part of a force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// along x
    X,
    /// along y
    Y,
    /// its size
    Size,
}

impl Part {
    /// Its name in a case.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "fx",
            Self::Y => "fy",
            Self::Size => "force",
        }
    }
}

/// How an increment lies to the end of its step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Course {
    /// The reaction has its value: the step ends
    Met,
    /// It has passed it, and would meet it in an increment so long [T]
    Passed(f64),
    /// It has not come to it; at the same rate it will in an increment so long, if ever [T]
    Before(Option<f64>),
}

impl Until {
    /// F of the reactions of a state [F].
    pub fn force(&self, reaction: &[f64]) -> f64 {
        let force = self.vector(reaction);
        match self.part {
            Part::X => force.x,
            Part::Y => force.y,
            Part::Size => force.norm(),
        }
    }

    fn vector(&self, reaction: &[f64]) -> Vector2<f64> {
        let sum = |i: usize| self.held[i].iter().map(|node| reaction[2 * node + i]).sum();
        Vector2::new(sum(0), sum(1))
    }

    /// Share of an increment at which a force that goes straight on first has the value; a size has it again where the force turns
    /// round.
    fn share(&self, [old, new]: [&State; 2]) -> Option<f64> {
        let [before, after] = [old, new].map(|state| self.vector(&state.reaction));
        let way = after - before;
        let straight = |before: f64, way: f64| [(self.value - before) / way; 2];
        let shares = match self.part {
            Part::X => straight(before.x, way.x),
            Part::Y => straight(before.y, way.y),
            Part::Size => {
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

    /// How an increment of a step lies to the end.
    pub fn course(&self, span: Span, [old, new]: [&State; 2]) -> Course {
        let clock = SHORTEST * (span.end - span.start) + 64.0 * f64::EPSILON * new.time.abs();
        let share = self.share([old, new]);
        let passed = share.is_some_and(|share| share < 1.0);
        if self.is_met(new) || passed && new.dt <= clock {
            return Course::Met;
        }
        match share {
            Some(share) if passed => Course::Passed(share * new.dt),
            share => Course::Before(share.map(|share| (share - 1.0) * new.dt)),
        }
    }

    /// Whether a state has the force within its tolerance.
    pub fn is_met(&self, state: &State) -> bool {
        let scale = self.value.abs().max(self.force(&state.step_start.reaction).abs());
        (self.force(&state.reaction) - self.value).abs() <= self.tolerance * scale
    }

    /// Length of the next attempt at an increment in which the value was passed [T].
    pub fn shorter(passed: f64, dt: f64, attempt: usize) -> f64 {
        if attempt < PATIENCE { passed } else { passed.min(0.5 * dt) }
    }
}
