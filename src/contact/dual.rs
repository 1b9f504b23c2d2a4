//! Automatic differentiation with dual numbers.

/// Numbers for averages: plain values, or values with their variations.
pub trait Number: Clone + Default {
    /// Creates a constant.
    fn constant(value: f64) -> Self;

    /// Creates unknown number `k` of `n`.
    fn unknown(value: f64, k: usize, n: usize) -> Self;

    /// The value without its variations.
    fn value(&self) -> f64;

    /// The derivatives with respect to the current unknowns; empty for a constant.
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

    fn unknown(value: f64, _: usize, _: usize) -> Self {
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

/// Number of derivatives stored without heap allocation: those of eight nodes.
const FEW: usize = 16;

/// A value and its derivatives with respect to the current unknowns.
#[derive(Clone, Debug, Default)]
pub struct Dual {
    value: f64,
    count: usize,
    few: [f64; FEW],
    /// All derivatives if there are more
    many: Vec<f64>,
}

impl Dual {
    /// Creates a value with `count` zero derivatives.
    fn with(value: f64, count: usize) -> Self {
        let many = if count > FEW { vec![0.0; count] } else { Vec::new() };
        Self { value, count, few: [0.0; FEW], many }
    }

    fn rates(&mut self) -> &mut [f64] {
        if self.count > FEW { &mut self.many } else { &mut self.few[..self.count] }
    }
}

impl Number for Dual {
    fn constant(value: f64) -> Self {
        Self::with(value, 0)
    }

    fn unknown(value: f64, k: usize, n: usize) -> Self {
        let mut unknown = Self::with(value, n);
        unknown.rates()[k] = 1.0;
        unknown
    }

    fn value(&self) -> f64 {
        self.value
    }

    fn gradient(&self) -> &[f64] {
        if self.count > FEW { &self.many } else { &self.few[..self.count] }
    }

    fn map(&self, value: f64, derivative: f64) -> Self {
        let mut mapped = Self::with(value, self.count);
        mapped.rates().iter_mut().zip(self.gradient()).for_each(|(rate, own)| *rate = derivative * own);
        mapped
    }

    fn join(value: f64, [a, b]: [&Self; 2], [da, db]: [f64; 2]) -> Self {
        if b.count == 0 {
            return a.map(value, da);
        }
        let mut joined = b.map(value, db);
        joined.rates().iter_mut().zip(a.gradient()).for_each(|(rate, own)| *rate += da * own);
        joined
    }

    fn accumulate(&mut self, factor: f64, other: &Self) {
        if self.count == 0 {
            *self = Self { value: self.value, ..other.map(0.0, factor) };
        } else {
            self.rates().iter_mut().zip(other.gradient()).for_each(|(rate, own)| *rate += factor * own);
        }
        self.value += factor * other.value;
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
