//! Supports: prescribed direction of a node's displacement, and its motion.

use nalgebra::Vector2;

use super::boundary::{Amplitude, Drive, Moment, Span};
use crate::mesh::rigid::turned;

/// A supported direction of a node: a coordinate, or an inclined one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// the dof, 2 × node + component; for an inclined direction that of its larger component, whose equation is replaced by
    /// that of the support
    pub dof: usize,
    /// unit vector d of an inclined direction
    pub inclined: Option<Vector2<f64>>,
}

impl From<usize> for Direction {
    /// Direction along the coordinate of a dof.
    fn from(dof: usize) -> Self {
        Self { dof, inclined: None }
    }
}

impl Direction {
    /// Direction along a unit vector at a node.
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

    /// Direction perpendicular to an inclined one; its equation is that of the other dof.
    pub fn across(&self) -> Option<Self> {
        self.inclined.map(|d| Self { dof: self.dof ^ 1, inclined: Some(Vector2::new(-d.y, d.x)) })
    }

    /// d·v of the node's vector in a nodal array.
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

    /// Sets the node's vector to an amount along d; for a coordinate the other component is kept.
    pub fn put(&self, amount: f64, values: &mut [f64]) {
        match self.inclined {
            None => values[self.dof] = amount,
            Some(d) => (0..2).for_each(|i| values[(self.dof & !1) + i] = amount * d[i]),
        }
    }

    /// Sets d·v to a value; the perpendicular component is kept.
    pub fn set(&self, value: f64, values: &mut [f64]) {
        match self.inclined {
            None => values[self.dof] = value,
            Some(_) => self.add(value - self.of(values), values),
        }
    }
}

/// A prescribed displacement of a node along one direction. A node with two prescribed directions has one for each dof.
#[derive(Clone, Debug)]
pub struct Prescribed {
    /// direction
    pub at: Direction,
    /// motion
    pub motion: Motion,
}

/// Motion along a prescribed direction.
#[derive(Clone, Debug)]
pub enum Motion {
    /// Displacement of the dof, relative to that at the start of the step if the drive requires it [L]
    Displacement(Drive, Span),
    /// Sum of the constraints of inclined supports [L]
    Inclined(Vec<Inclined>),
    /// Rigid rotation about a fixed point of the configuration at the start of the step, θ counter-clockwise [rad]:
    /// u = u₀ + (Q(θ − θ₀) − I)(X + u₀ − x_c)
    Rotation {
        /// x_c
        about: Vector2<f64>,
        /// θ
        angle: Amplitude,
    },
}

/// Constraint of one support along d: share × ū(t), relative to d·u₀ at the start of the step if the drive requires it.
#[derive(Clone, Debug)]
pub struct Inclined {
    /// factor of ū: 1 for the displacement along d itself
    pub share: f64,
    /// d
    pub direction: Vector2<f64>,
    /// ū [L]
    pub drive: Drive,
    /// the step
    pub span: Span,
}

impl Motion {
    /// What it goes by.
    pub fn drives(&self) -> impl Iterator<Item = &Drive> {
        let (one, parts) = match self {
            Self::Displacement(drive, _) => (Some(drive), &[][..]),
            Self::Inclined(parts) => (None, &parts[..]),
            Self::Rotation { angle, .. } => (Some(&angle.drive), &[][..]),
        };
        one.into_iter().chain(parts.iter().map(|part| &part.drive))
    }
}

impl Prescribed {
    /// Creates a prescribed displacement of a dof.
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

    /// ū at the start, thirds and end of an increment, from a time to a moment. Motion linear in time is interpolated between
    /// its ends: kinks of a table are jumps of the velocity, not accelerations. Beyond an increment the motion continues as the
    /// cubic through its start, thirds and end, independent of what follows [L].
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

/// Start, thirds and end as fractions.
const THIRDS: [f64; 4] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];

/// Evaluates the cubic through four positions at the start, thirds and end, at a fraction of the whole (Lagrange).
fn cubic(places: [f64; 4], share: f64) -> f64 {
    let factor = |k: usize| {
        let others = THIRDS.into_iter().enumerate().filter(|(j, _)| *j != k);
        others.map(|(_, third)| (share - third) / (THIRDS[k] - third)).product::<f64>()
    };
    (0..4).map(|k| places[k] * factor(k)).sum()
}
