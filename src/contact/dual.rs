//! Numbers that carry their derivatives: what is computed with them brings its exact variation along.

use std::ops::{Add, Div, Mul, Sub};

/// A value and its derivatives with respect to the unknowns at hand; an empty gradient is that of a constant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dual {
    /// value
    pub value: f64,
    /// derivatives
    pub gradient: Vec<f64>,
}

impl Dual {
    /// A number that does not vary.
    pub fn constant(value: f64) -> Self {
        Self { value, gradient: Vec::new() }
    }

    /// Unknown number `k` of `n`; for n = 0 a constant.
    pub fn unknown(value: f64, k: usize, n: usize) -> Self {
        let mut gradient = vec![0.0; n];
        if n > 0 {
            gradient[k] = 1.0;
        }
        Self { value, gradient }
    }

    /// f(self) from the value f and the derivative f′ at `self.value`.
    pub fn map(&self, value: f64, derivative: f64) -> Self {
        Self { value, gradient: self.gradient.iter().map(|g| derivative * g).collect() }
    }

    /// factor · self.
    pub fn scaled(&self, factor: f64) -> Self {
        self.map(factor * self.value, factor)
    }

    /// √self.
    pub fn sqrt(&self) -> Self {
        let root = self.value.sqrt();
        self.map(root, 0.5 / root)
    }

    /// Add `factor · other`.
    pub fn accumulate(&mut self, factor: f64, other: &Self) {
        self.value += factor * other.value;
        self.gradient.resize(self.gradient.len().max(other.gradient.len()), 0.0);
        for (own, other) in self.gradient.iter_mut().zip(&other.gradient) {
            *own += factor * other;
        }
    }

    /// A function of two: its value and its partial derivatives.
    fn of(value: f64, (a, da): (&Self, f64), (b, db): (&Self, f64)) -> Self {
        let n = a.gradient.len().max(b.gradient.len());
        let at = |gradient: &[f64], k: usize| gradient.get(k).copied().unwrap_or(0.0);
        Self { value, gradient: (0..n).map(|k| da * at(&a.gradient, k) + db * at(&b.gradient, k)).collect() }
    }
}

impl Add for &Dual {
    type Output = Dual;
    fn add(self, other: Self) -> Dual {
        Dual::of(self.value + other.value, (self, 1.0), (other, 1.0))
    }
}

impl Sub for &Dual {
    type Output = Dual;
    fn sub(self, other: Self) -> Dual {
        Dual::of(self.value - other.value, (self, 1.0), (other, -1.0))
    }
}

impl Mul for &Dual {
    type Output = Dual;
    fn mul(self, other: Self) -> Dual {
        Dual::of(self.value * other.value, (self, other.value), (other, self.value))
    }
}

impl Div for &Dual {
    type Output = Dual;
    fn div(self, other: Self) -> Dual {
        let value = self.value / other.value;
        Dual::of(value, (self, 1.0 / other.value), (other, -value / other.value))
    }
}

/// A vector in the plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DualVector {
    /// x component
    pub x: Dual,
    /// y component
    pub y: Dual,
}

impl DualVector {
    /// Scalar product.
    pub fn dot(&self, other: &Self) -> Dual {
        &(&self.x * &other.x) + &(&self.y * &other.y)
    }

    /// self/‖self‖.
    pub fn normalized(&self) -> Self {
        let norm = self.dot(self).sqrt();
        Self { x: &self.x / &norm, y: &self.y / &norm }
    }

    /// self − other.
    pub fn minus(&self, other: &Self) -> Self {
        Self { x: &self.x - &other.x, y: &self.y - &other.y }
    }

    /// Add `factor · other`.
    pub fn add_scaled(&mut self, factor: &Dual, other: &Self) {
        self.x = &self.x + &(factor * &other.x);
        self.y = &self.y + &(factor * &other.y);
    }

    /// Turned by +90°.
    pub fn turned(&self) -> Self {
        Self { x: self.y.scaled(-1.0), y: self.x.clone() }
    }
}
