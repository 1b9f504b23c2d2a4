//! Supports: along which direction the displacement of a node is prescribed, and how it moves.

use nalgebra::Vector2;

use super::boundary::{Amplitude, Drive, Moment, Span};
use crate::mesh::rigid::turned;

/// A direction in which a node is held: a coordinate, or an inclined one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// the dof, 2 × node + component; of an inclined direction that of its larger component: the equation of this dof is the
    /// support's
    pub dof: usize,
    /// unit vector d of an inclined direction
    pub inclined: Option<Vector2<f64>>,
}

impl From<usize> for Direction {
    /// Along the coordinate of a dof.
    fn from(dof: usize) -> Self {
        Self { dof, inclined: None }
    }
}

impl Direction {
    /// Along a unit vector at a node.
    pub fn along(node: usize, d: Vector2<f64>) -> Self {
        Self { dof: 2 * node + usize::from(d.x.abs() < d.y.abs()), inclined: Some(d) }
    }

    /// Node of the support.
    pub fn node(&self) -> usize {
        self.dof / 2
    }

    /// Unit vector of the support's direction.
    pub fn vector(&self) -> Vector2<f64> {
        self.inclined.unwrap_or_else(|| Vector2::ith(self.dof % 2, 1.0))
    }

    /// At the node of an inclined direction, that at a right angle to it; the other dof has its equation.
    pub fn across(&self) -> Option<Self> {
        self.inclined.map(|d| Self { dof: self.dof ^ 1, inclined: Some(Vector2::new(-d.y, d.x)) })
    }

    /// d·v of the node's vector among those of all dofs.
    pub fn of(&self, values: &[f64]) -> f64 {
        let first = self.dof & !1;
        self.inclined.map_or_else(|| values[self.dof], |d| d.x * values[first] + d.y * values[first + 1])
    }

    /// v += amount d.
    pub fn add(&self, amount: f64, values: &mut [f64]) {
        match self.inclined {
            None => values[self.dof] += amount,
            Some(d) => (0..2).for_each(|i| values[(self.dof & !1) + i] += amount * d[i]),
        }
    }

    /// Make the node's vector an amount along d; along a coordinate the other component stays.
    pub fn put(&self, amount: f64, values: &mut [f64]) {
        match self.inclined {
            None => values[self.dof] = amount,
            Some(d) => (0..2).for_each(|i| values[(self.dof & !1) + i] = amount * d[i]),
        }
    }

    /// Make d·v a value; what is across stays.
    pub fn set(&self, value: f64, values: &mut [f64]) {
        match self.inclined {
            None => values[self.dof] = value,
            Some(_) => self.add(value - self.of(values), values),
        }
    }
}

/// A prescribed displacement of a node along one direction. A node that is held along two has one of each dof.
#[derive(Clone, Debug)]
pub struct Prescribed {
    /// along which direction
    pub at: Direction,
    /// its motion
    pub motion: Motion,
}

/// Motion along a prescribed direction.
#[derive(Clone, Debug)]
pub enum Motion {
    /// Displacement of the dof, counted from the one at the start of the step where the drive says so [L]
    Displacement(Drive, Span),
    /// Sum of what inclined supports say [L]
    Inclined(Vec<Inclined>),
    /// Rigid rotation about a fixed point of what is there at the start of the step, θ counter-clockwise [rad]:
    /// u = u₀ + (Q(θ − θ₀) − I)(X + u₀ − x_c)
    Rotation {
        /// x_c
        about: Vector2<f64>,
        /// θ
        angle: Amplitude,
    },
}

/// Constraint of one support along d: share × ū(t), counted from d·u₀ at the start of the step where the drive says so.
#[derive(Clone, Debug)]
pub struct Inclined {
    /// share of ū: 1 for the displacement along d itself
    pub share: f64,
    /// d
    pub direction: Vector2<f64>,
    /// ū [L]
    pub drive: Drive,
    /// the step
    pub span: Span,
}

impl Prescribed {
    /// Displacement of a dof.
    pub fn displacement(dof: usize, drive: Drive, span: Span) -> Self {
        Self { at: dof.into(), motion: Motion::Displacement(drive, span) }
    }

    /// ū at a time within `step`, for the node's reference position and its displacement at the start of the step [L].
    pub fn value(&self, position: Vector2<f64>, time: f64, step: Span, start: Vector2<f64>) -> f64 {
        let component = self.at.dof % 2;
        match &self.motion {
            Motion::Displacement(drive, span) => drive.value(position, time, *span, start[component]),
            Motion::Inclined(parts) => {
                let part = |Inclined { share, direction, drive, span }: &Inclined| {
                    share * drive.value(position, time, *span, direction.dot(&start))
                };
                parts.iter().map(part).sum()
            }
            Motion::Rotation { about, angle } => {
                let arm = (position - about) + start;
                let turn = angle.value(position, time) - angle.at_start_of(step, position);
                (start + turned(arm, turn))[component]
            }
        }
    }

    /// ū at the start, thirds and end of an increment, from a time to a moment. What is linear in time is taken straight from end to
    /// end: the kinks of a table are jumps of the velocity and no accelerations. Beyond an increment the motion goes on as the cubic
    /// through its start, thirds and end: what comes after has no say in it [L].
    pub fn thirds(
        &self,
        position: Vector2<f64>,
        start_time: f64,
        end: Moment,
        step: Span,
        start: Vector2<f64>,
    ) -> [f64; 4] {
        let [from, to] = end.beyond.unwrap_or([start_time, end.time]);
        let at = |time: f64| self.value(position, time, step, start);
        let [first, last] = [from, to].map(at);
        let curved = match &self.motion {
            Motion::Displacement(drive, _) => matches!(drive, Drive::Expression(_)),
            Motion::Inclined(parts) => parts.iter().any(|part| matches!(part.drive, Drive::Expression(_))),
            Motion::Rotation { .. } => true,
        };
        let straight = |share: f64| first + share * (last - first);
        let within = |share: f64| if curved { at(from + share * (to - from)) } else { straight(share) };
        let places = [first, within(THIRDS[1]), within(THIRDS[2]), last];
        if end.beyond.is_none() {
            return places;
        }
        let reach = (end.time - from) / (to - from);
        THIRDS.map(|third| if curved { cubic(places, third * reach) } else { straight(third * reach) })
    }
}

/// Start, thirds and end as shares.
const THIRDS: [f64; 4] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];

/// The cubic through four places at the start, thirds and end, at a share of the whole (Lagrange).
fn cubic(places: [f64; 4], share: f64) -> f64 {
    let factor = |k: usize| {
        let others = THIRDS.into_iter().enumerate().filter(|(j, _)| *j != k);
        others.map(|(_, third)| (share - third) / (THIRDS[k] - third)).product::<f64>()
    };
    (0..4).map(|k| places[k] * factor(k)).sum()
}
