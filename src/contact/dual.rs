//! Automatic differentiation with dual numbers (`laws/dual.rs`) by the positions of nodes: there may be any number of these, so that a
//! mean is computed with its derivatives by `COORDINATES` unknowns, then by the next ones.

use crate::laws::dual;

/// Numbers for averages: plain values, or values with their variations.
pub trait Number: Clone + Default {
    /// Creates a constant.
    fn constant(value: f64) -> Self;

    /// Creates unknown number `k` of those by which it is differentiated at once; a constant, if it is none of them.
    fn unknown(value: f64, k: usize) -> Self;

    /// The value without its variations.
    fn value(&self) -> f64;

    /// The derivatives with respect to the current unknowns; none of a plain value.
    fn gradient(&self) -> &[f64];

    /// f(self), given the value f and the derivative f′.
    fn map(&self, value: f64, derivative: f64) -> Self;

    /// A function of two numbers, given its value and partial derivatives.
    fn join(value: f64, of: [&Self; 2], by: [f64; 2]) -> Self;

    /// Adds `factor · other`.
    fn accumulate(&mut self, factor: f64, other: &Self);

    /// factor · self.
    fn scaled(&self, factor: f64) -> Self {
        self.map(factor * self.value(), factor)
    }

    /// √self.
    fn sqrt(&self) -> Self {
        let root = self.value().sqrt();
        self.map(root, 0.5 / root)
    }

    /// self + other.
    fn plus(&self, other: &Self) -> Self {
        Self::join(self.value() + other.value(), [self, other], [1.0, 1.0])
    }

    /// self − other.
    fn minus(&self, other: &Self) -> Self {
        Self::join(self.value() - other.value(), [self, other], [1.0, -1.0])
    }

    /// self · other.
    fn times(&self, other: &Self) -> Self {
        Self::join(self.value() * other.value(), [self, other], [other.value(), self.value()])
    }

    /// self/other.
    fn over(&self, other: &Self) -> Self {
        let value = self.value() / other.value();
        Self::join(value, [self, other], [1.0 / other.value(), -value / other.value()])
    }
}

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }

    fn unknown(value: f64, _: usize) -> Self {
        value
    }

    fn value(&self) -> f64 {
        *self
    }

    fn gradient(&self) -> &[f64] {
        &[]
    }

    fn map(&self, value: f64, _: f64) -> Self {
        value
    }

    fn join(value: f64, _: [&Self; 2], _: [f64; 2]) -> Self {
        value
    }

    fn accumulate(&mut self, factor: f64, other: &Self) {
        *self += factor * other;
    }
}

/// Number of derivatives that are computed at once: those with respect to the positions of eight nodes.
pub(super) const COORDINATES: usize = 16;

/// A value and its derivatives with respect to some of the unknowns.
pub(super) type PositionDual = dual::Dual<COORDINATES>;

impl Default for PositionDual {
    fn default() -> Self {
        Self::from(0.0)
    }
}

impl Number for PositionDual {
    fn constant(value: f64) -> Self {
        Self::from(value)
    }

    fn unknown(value: f64, k: usize) -> Self {
        Self { value, by: std::array::from_fn(|own| f64::from(own == k)) }
    }

    fn value(&self) -> f64 {
        self.value
    }

    fn gradient(&self) -> &[f64] {
        &self.by
    }

    fn map(&self, value: f64, derivative: f64) -> Self {
        dual::Number::map(*self, value, derivative)
    }

    fn join(value: f64, [a, b]: [&Self; 2], by: [f64; 2]) -> Self {
        Self::join(value, [*a, *b], by)
    }

    fn accumulate(&mut self, factor: f64, other: &Self) {
        *self = Self::join(self.value + factor * other.value, [*self, *other], [1.0, factor]);
    }
}

/// A vector in the plane.
#[derive(Clone, Debug, Default)]
pub struct DualVector<N> {
    /// x component
    pub x: N,
    /// y component
    pub y: N,
}

impl<N: Number> DualVector<N> {
    /// Scalar product.
    pub fn dot(&self, other: &Self) -> N {
        self.x.times(&other.x).plus(&self.y.times(&other.y))
    }

    /// self/‖self‖.
    pub fn normalized(&self) -> Self {
        let norm = self.dot(self).sqrt();
        Self { x: self.x.over(&norm), y: self.y.over(&norm) }
    }

    /// self − other.
    pub fn minus(&self, other: &Self) -> Self {
        Self { x: self.x.minus(&other.x), y: self.y.minus(&other.y) }
    }

    /// Adds `factor · other`.
    pub fn add_scaled(&mut self, factor: &N, other: &Self) {
        self.x.accumulate(1.0, &factor.times(&other.x));
        self.y.accumulate(1.0, &factor.times(&other.y));
    }

    /// The vector rotated by +90°.
    pub fn turned(&self) -> Self {
        Self { x: self.y.scaled(-1.0), y: self.x.clone() }
    }
}
