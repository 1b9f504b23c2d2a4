//! Variation of prescribed quantities in time and space, and loads. Supports are in `support.rs`. Moments in time and
//! step spans are also defined here.

use std::fmt::{Display, Formatter};

use nalgebra::{Matrix2, Vector2};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use super::expression::{Expression, InvalidExpression};
pub use super::random::{InvalidField, Marginal, RandomField, Spectrum};
use super::text::{count, number};
use super::written::written;

/// Prescribed quantity as a function of time and position.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case")]
#[schemars(!remote)]
#[non_exhaustive]
pub enum Drive {
    /// Value at the start of the step plus rate × time since [1/T]
    Rate(f64),
    /// Pairs of run time and value, times ascending; linear between, constant outside
    Table(Vec<[f64; 2]>),
    /// For a temperature: (coordinate, value) pairs along x (0) or y (1) of the reference position, linear between, constant
    /// outside, reached linearly at the end of the step from the value at its start
    #[serde(skip)]
    ByPlace(usize, Vec<[f64; 2]>),
    /// Value at the end of the step, reached linearly
    #[serde(skip)]
    #[schemars(!skip, untagged)]
    Constant(f64),
    /// Expression in the reference position x, y and the run time t, with + - * / ^, brackets, pi, tau, e, and functions: abs, acos,
    /// acosh, asin, asinh, atan, atanh, atan2(y, x), cbrt, ceil, cos, cosh, erf, erfc, exp, floor, fract, ln, log (= ln), log10,
    /// log2, max(a, b), min(a, b), round, signum, sin, sinh, sqrt, tan, tanh, trunc. -x^2 is -(x^2)
    #[serde(skip)]
    #[schemars(!skip, untagged)]
    Expression(Expression),
}

written!(
    Drive,
    "a number, an expression in x, y, t such as \"0.01*y*t\", {\"rate\": v}, or {\"table\": [[t, v], …]}",
    number: Constant,
    text: Expression
);

/// Temperature of a body. A table by x or y, of the reference position, is reached at the end of the step, linearly
/// from the temperature at its start: linear between, constant outside, the same coordinate twice is a jump.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case")]
#[schemars(rename = "Temperature")]
#[non_exhaustive]
pub enum BodyTemperature {
    /// Value at the start of the step plus rate × time since [1/T]
    Rate(f64),
    /// Pairs of run time and value, times ascending; linear between, constant outside
    Table(Vec<[f64; 2]>),
    /// Pairs of x and value, x ascending
    X(Vec<[f64; 2]>),
    /// Pairs of y and value, y ascending
    Y(Vec<[f64; 2]>),
    /// Temperature at the end of the step, reached linearly from the one at its start
    #[serde(skip)]
    #[schemars(!skip, untagged)]
    Constant(f64),
    /// Expression in the reference position x, y and the run time t
    #[serde(skip)]
    #[schemars(!skip, untagged)]
    Expression(Expression),
}

written!(
    BodyTemperature,
    "a number, an expression in x, y, t such as \"20 + 5*x*t\", {\"rate\": v}, {\"table\": [[t, v], …]}, or {\"x\": [[x, v], …]}",
    number: Constant,
    text: Expression
);

conversions! {
    f64 => BodyTemperature: |value| Self::Constant(value);
    f64 => Profile: |value| Self::Constant(value);
    RandomField => Profile: |field| Self::Random(Box::new(field));
    f64 => Drive: |value| Self::Constant(value);
    f64 => Moment: |time| Self { time, beyond: None };
}

impl From<&BodyTemperature> for Drive {
    fn from(temperature: &BodyTemperature) -> Self {
        match temperature.clone() {
            BodyTemperature::Constant(value) => Self::Constant(value),
            BodyTemperature::Expression(expression) => Self::Expression(expression),
            BodyTemperature::Rate(rate) => Self::Rate(rate),
            BodyTemperature::Table(table) => Self::Table(table),
            BodyTemperature::X(table) => Self::ByPlace(0, table),
            BodyTemperature::Y(table) => Self::ByPlace(1, table),
        }
    }
}

/// Quantity that varies along a surface, by reference position. A table is linear between its pairs, constant outside;
/// the same coordinate twice is a jump, and the second value holds there and beyond.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case")]
#[schemars(!remote)]
#[non_exhaustive]
pub enum Profile {
    /// Pairs of x and value, x ascending
    X(Vec<[f64; 2]>),
    /// Pairs of y and value, y ascending
    Y(Vec<[f64; 2]>),
    /// Pairs of run time and value, times ascending, where the run time is permitted; linear between, constant outside
    Table(Vec<[f64; 2]>),
    /// A random field
    Random(Box<RandomField>),
    /// Uniform value
    #[serde(skip)]
    #[schemars(!skip, untagged)]
    Constant(f64),
    /// Expression in the reference position x, y and, where permitted, the run time t
    #[serde(skip)]
    #[schemars(!skip, untagged)]
    Expression(Expression),
}

written!(
    Profile,
    "a number, an expression in x, y such as \"1 + 0.1*x\", {\"x\": [[x, v], …]}, {\"table\": [[t, v], …]}, or {\"random\": {…}}",
    number: Constant,
    text: Expression
);

impl Default for Profile {
    fn default() -> Self {
        Self::Constant(0.0)
    }
}

impl Profile {
    /// Value at a reference position at the start of the run; NaN where an expression is not defined.
    pub fn value(&self, position: Vector2<f64>) -> f64 {
        self.value_at(position, 0.0)
    }

    /// Value at a reference position and run time; NaN where an expression is not defined.
    pub fn value_at(&self, position: Vector2<f64>, time: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Expression(expression) => expression.value(position, time),
            Self::X(table) => interpolate(table, position.x),
            Self::Y(table) => interpolate(table, position.y),
            Self::Table(table) => interpolate(table, time),
            Self::Random(field) => field.value(position),
        }
    }

    /// Whether it varies in time.
    pub fn depends_on_time(&self) -> bool {
        match self {
            Self::Expression(expression) => expression.depends_on_time(),
            _ => matches!(self, Self::Table(_)),
        }
    }

    /// Times of a table.
    pub fn corners(&self) -> impl Iterator<Item = f64> + '_ {
        let table = if let Self::Table(table) = self { &table[..] } else { &[] };
        table.iter().map(|row| row[0])
    }
}

impl Display for Drive {
    fn fmt(&self, f: &mut Formatter) -> std::fmt::Result {
        match self {
            Self::Constant(value) => f.write_str(&number(*value)),
            Self::Expression(expression) => write!(f, "\"{}\"", expression.as_ref()),
            Self::Rate(rate) => write!(f, "at the rate {}", number(*rate)),
            Self::Table(table) => write!(f, "by a table of {}", count(table.len(), "time")),
            Self::ByPlace(_, table) => write!(f, "by a table of {}", count(table.len(), "place")),
        }
    }
}

impl Drive {
    /// Checks that its numbers are finite and the coordinates of its table ascend.
    ///
    /// # Errors
    /// Returns [`InvalidValues`] if they do not.
    pub fn check(&self) -> Result<(), InvalidValues> {
        let (numbers, table) = match self {
            Self::Constant(value) | Self::Rate(value) => (&[*value][..], None),
            Self::Table(table) => (table.as_flattened(), Some((table, "time"))),
            Self::ByPlace(_, table) => (table.as_flattened(), Some((table, "coordinate"))),
            Self::Expression(_) => (&[][..], None),
        };
        if let Some(value) = numbers.iter().find(|value| !value.is_finite()) {
            return Err(InvalidValues::NotFinite(*value));
        }
        table.map_or(Ok(()), |(table, argument)| check_table(table, argument))
    }

    /// Times of a table.
    pub fn corners(&self) -> impl Iterator<Item = f64> + '_ {
        let table = if let Self::Table(table) = self { &table[..] } else { &[] };
        table.iter().map(|row| row[0])
    }

    /// Whether it varies in space.
    pub fn depends_on_position(&self) -> bool {
        match self {
            Self::Expression(expression) => expression.depends_on_position(),
            Self::ByPlace(..) => true,
            _ => false,
        }
    }

    /// The profile with the opposite sign.
    #[must_use]
    pub fn reversed(&self) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(-value),
            Self::Rate(rate) => Self::Rate(-rate),
            Self::Table(table) => Self::Table(table.iter().map(|[time, value]| [*time, -value]).collect()),
            Self::Expression(expression) => Self::Expression(expression.negated()),
            Self::ByPlace(along, table) => {
                Self::ByPlace(*along, table.iter().map(|[place, value]| [*place, -value]).collect())
            }
        }
    }

    /// The profile multiplied by a factor.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        let scaled = |table: &[[f64; 2]]| table.iter().map(|[at, value]| [*at, factor * value]).collect();
        match self {
            Self::Constant(value) => Self::Constant(factor * value),
            Self::Rate(rate) => Self::Rate(factor * rate),
            Self::Table(table) => Self::Table(scaled(table)),
            Self::Expression(expression) => Self::Expression(expression.times(factor)),
            Self::ByPlace(along, table) => Self::ByPlace(*along, scaled(table)),
        }
    }

    /// Value at a reference position and run time, `start` being the value at the start of the step. Beyond an increment it is
    /// extrapolated linearly through the increment's start and end, irrespective of kinks or the end of the step.
    pub fn value(&self, position: Vector2<f64>, at: impl Into<Moment>, span: Span, start: f64) -> f64 {
        let Moment { time, beyond } = at.into();
        // A rate is linear itself.
        if let (Some([from, to]), false) = (beyond, matches!(self, Self::Rate(_))) {
            let [first, last] = [from, to].map(|time| self.value(position, time, span, start));
            return first + (time - from) / (to - from) * (last - first);
        }
        match self {
            Self::Constant(end) => start + (end - start) * span.share(time),
            Self::Rate(rate) => start + rate * (time - span.start),
            Self::Table(table) => interpolate(table, time),
            Self::Expression(expression) => expression.value(position, time),
            Self::ByPlace(along, table) => start + (interpolate(table, position[*along]) - start) * span.share(time),
        }
    }
}

/// Numbers that define no variation.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum InvalidValues {
    /// A number is infinite or none
    #[error("is {0}: must be a finite number")]
    NotFinite(f64),
    /// A table has no pairs; its argument
    #[error("the table is empty: give pairs [{0}, value]")]
    Empty(&'static str),
    /// The arguments of a table do not ascend
    #[error("the {} of the table must increase: {next} follows {before}", if *argument == "time" { "times" } else { "coordinates" })]
    Descending {
        /// its argument
        argument: &'static str,
        /// one of them
        before: f64,
        /// the next one
        next: f64,
    },
}

/// Checks that a table has pairs with ascending arguments; the same coordinate twice is a jump, and there is none in time.
pub fn check_table(table: &[[f64; 2]], argument: &'static str) -> Result<(), InvalidValues> {
    let descends = |pair: &&[[f64; 2]]| pair[1][0] < pair[0][0] || argument == "time" && pair[1][0] == pair[0][0];
    match table.windows(2).find(descends) {
        _ if table.is_empty() => Err(InvalidValues::Empty(argument)),
        Some(pair) => Err(InvalidValues::Descending { argument, before: pair[0][0], next: pair[1][0] }),
        None => Ok(()),
    }
}

/// Interpolates linearly between pairs (argument, value) with non-descending arguments; constant outside.
fn interpolate(table: &[[f64; 2]], at: f64) -> f64 {
    let after = table.partition_point(|[t, _]| *t <= at);
    match (after.checked_sub(1).and_then(|k| table.get(k)), table.get(after)) {
        (Some([t0, v0]), Some([t1, v1])) => v0 + (v1 - v0) * (at - t0) / (t1 - t0),
        (Some([_, v]), None) | (None, Some([_, v])) => *v,
        (None, None) => 0.0,
    }
}

/// A drive over one step, with the previous one at the step's start.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct Amplitude {
    /// variation
    pub drive: Drive,
    /// the step
    pub span: Span,
    /// amplitude of the previous step; zero if there was none
    pub before: Option<Box<Amplitude>>,
}

impl Amplitude {
    /// Value at a reference position and run time.
    pub fn value(&self, position: Vector2<f64>, at: impl Into<Moment>) -> f64 {
        self.drive.value(position, at, self.span, self.taken_over(position))
    }

    /// Value at the start of a step: that of the previous drive if this one is new in the step, otherwise its own.
    pub(super) fn at_start_of(&self, step: Span, position: Vector2<f64>) -> f64 {
        if step.start > self.span.start { self.value(position, step.start) } else { self.taken_over(position) }
    }

    /// Equivalent amplitude from a time on, with only the previous drives that it needs if it is constant then; otherwise
    /// repeated changes within a step would accumulate. An amplitude that varies in space is unchanged.
    #[must_use]
    pub fn settled(&self, time: f64) -> Self {
        if self.depends_on_position() {
            return self.clone();
        }
        let value = self.value(Vector2::zeros(), time);
        Self { drive: Drive::Table(vec![[time, value]]), span: self.span, before: None }
    }

    /// Whether it varies in space.
    fn depends_on_position(&self) -> bool {
        self.chain().any(|amplitude| amplitude.drive.depends_on_position())
    }

    /// Itself and the previous amplitudes that it refers to.
    pub fn chain(&self) -> impl Iterator<Item = &Self> {
        std::iter::successors(Some(self), |amplitude| amplitude.before.as_deref())
    }

    fn taken_over(&self, position: Vector2<f64>) -> f64 {
        self.before.as_ref().map_or(0.0, |before| before.value(position, self.span.start))
    }
}

/// A load that does not depend on the deformation: traction, gravity or nodal force.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct DeadLoad {
    /// 0 for x, 1 for y
    pub component: usize,
    /// value per unit of `weight`
    pub amplitude: Amplitude,
    /// nodes on which it acts
    pub weights: Vec<NodalWeight>,
    /// body of which it is the weight
    pub body: Option<usize>,
}

impl DeadLoad {
    /// Nodes and the components of the force on them at a run time. The nodes of a Gauss point follow each other: its value is computed
    /// once, as is one that is the same everywhere.
    pub fn forces(&self, at: impl Into<Moment>) -> impl Iterator<Item = (usize, f64)> {
        let (at, is_uniform) = (at.into(), !self.amplitude.depends_on_position());
        let mut last: Option<(Vector2<f64>, f64)> = None;
        self.weights.iter().map(move |&NodalWeight { node, weight, position }| {
            let known = last.filter(|(there, _)| is_uniform || *there == position);
            let value = known.map_or_else(|| self.amplitude.value(position, at), |(_, value)| value);
            last = Some((position, value));
            (node, weight * value)
        })
    }
}

/// Fraction of a load at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct NodalWeight {
    /// node
    pub node: usize,
    /// force per value of the load: a length or an area of edges, a mass, or 1
    pub weight: f64,
    /// reference position at which the load is evaluated
    pub position: Vector2<f64>,
}

/// Follower pressure on edges.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct FollowerPressure {
    /// pressure, positive toward the body [F/L²]
    pub amplitude: Amplitude,
    /// edges, body on the left
    pub edges: Vec<Vec<usize>>,
}

/// A spring from a node to the ground or to a moving driver: force k (u_driver − u).
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct Spring {
    /// dof on which it acts
    pub dof: usize,
    /// k [F/L]
    pub stiffness: f64,
    /// displacement of the far end; `None` for the ground [L]
    pub driver: Option<Amplitude>,
}

/// A dashpot from a node to the ground or to a moving driver: force c (v_driver − v).
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct Dashpot {
    /// dof on which it acts
    pub dof: usize,
    /// c [F T/L]
    pub coefficient: f64,
    /// velocity of the far end; `None` for the ground [L/T]
    pub driver: Option<Amplitude>,
}

impl Dashpot {
    /// v_driver for the node's reference position [L/T].
    pub fn driver_velocity(&self, position: Vector2<f64>, at: impl Into<Moment>) -> f64 {
        self.driver.as_ref().map_or(0.0, |driver| driver.value(position, at))
    }
}

/// Nodal part of an absorbing side: force −C v, C = ∫ N_a ρ (c_p n⊗n + c_s s⊗s) dS with the side's reference normal
/// n and tangent s. Plane waves at normal incidence leave as if the body continued.
///
/// Source: Lysmer & Kuhlemeyer (1969), J. Eng. Mech. Div. ASCE 95, 859.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct Absorber {
    /// node
    pub node: usize,
    /// C [F T/L]
    pub coefficients: Matrix2<f64>,
}

/// Moment on a rigid platen, counter-clockwise: a couple of forces on its master nodes that rotates with it.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct PlateMoment {
    /// A and B
    pub plate: [usize; 2],
    /// moment [F L]
    pub amplitude: Amplitude,
}

/// Loads on the model in one step.
#[derive(Clone, Debug, Default)]
pub struct Loads {
    /// forces of constant direction
    #[doc(hidden)]
    pub dead: Vec<DeadLoad>,
    /// follower pressures
    #[doc(hidden)]
    pub pressures: Vec<FollowerPressure>,
    /// springs
    #[doc(hidden)]
    pub springs: Vec<Spring>,
    /// dashpots
    #[doc(hidden)]
    pub dashpots: Vec<Dashpot>,
    /// absorbing sides
    #[doc(hidden)]
    pub absorbers: Vec<Absorber>,
    /// moments on platens
    #[doc(hidden)]
    pub moments: Vec<PlateMoment>,
}

#[doc(hidden)]
impl Loads {
    /// All time-dependent amplitudes.
    pub fn amplitudes(&self) -> impl Iterator<Item = &Amplitude> {
        let dead = self.dead.iter().map(|load| &load.amplitude);
        let pressures = self.pressures.iter().map(|load| &load.amplitude);
        let springs = self.springs.iter().filter_map(|spring| spring.driver.as_ref());
        let dashpots = self.dashpots.iter().filter_map(|dashpot| dashpot.driver.as_ref());
        let moments = self.moments.iter().map(|moment| &moment.amplitude);
        dead.chain(pressures).chain(springs).chain(dashpots).chain(moments)
    }

    /// The same, to be changed.
    pub fn amplitudes_mut(&mut self) -> impl Iterator<Item = &mut Amplitude> {
        let dead = self.dead.iter_mut().map(|load| &mut load.amplitude);
        let pressures = self.pressures.iter_mut().map(|load| &mut load.amplitude);
        let springs = self.springs.iter_mut().filter_map(|spring| spring.driver.as_mut());
        let dashpots = self.dashpots.iter_mut().filter_map(|dashpot| dashpot.driver.as_mut());
        let moments = self.moments.iter_mut().map(|moment| &mut moment.amplitude);
        dead.chain(pressures).chain(springs).chain(dashpots).chain(moments)
    }
}

/// Moment at which a time-dependent quantity is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct Moment {
    /// t [T]
    pub time: f64,
    /// Start and end of the increment, if the scheme evaluates beyond its end
    pub beyond: Option<[f64; 2]>,
}

/// The time span of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Span {
    /// start [T]
    pub start: f64,
    /// end [T]
    pub end: f64,
}

impl Span {
    /// Evenly spaced times: the start, and `count` more up to the end.
    pub fn times(self, count: u32) -> impl Iterator<Item = f64> {
        let Self { start, end } = self;
        let within = move |k: u32| start + f64::from(k) / f64::from(count) * (end - start);
        (0..count).map(within).chain([end])
    }

    /// Elapsed fraction of the span, 0 to 1.
    pub fn share(&self, time: f64) -> f64 {
        if self.end > self.start { ((time - self.start) / (self.end - self.start)).clamp(0.0, 1.0) } else { 1.0 }
    }
}
