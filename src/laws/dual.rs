//! Numbers with derivatives along a few directions: those of a tangent, Δu_t and p or the components of a strain, or parameters of a
//! law; and positions of nodes, some at a time (`contact/dual.rs`). The equations are written once, for both kinds of numbers.

use std::ops::{Add, Div, Mul, Sub};

/// A number, or a number with its derivatives.
pub(crate) trait Number:
    Copy
    + PartialEq
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// The number without its derivatives.
    fn value(self) -> f64;

    /// f(self), given the value f and the derivative f′. The root x of G(x, self) = 0 is `G.map(x, -1/(∂G/∂x))`, with G evaluated
    /// at the constant x: the implicit function theorem.
    fn map(self, value: f64, derivative: f64) -> Self;

    #[inline]
    fn exp(self) -> Self {
        let value = self.value().exp();
        self.map(value, value)
    }

    #[inline]
    fn ln(self) -> Self {
        self.map(self.value().ln(), 1.0 / self.value())
    }

    /// √self; the derivative at 0 counts as 0.
    #[inline]
    fn sqrt(self) -> Self {
        let value = self.value().sqrt();
        self.map(value, if value > 0.0 { 0.5 / value } else { 0.0 })
    }

    /// self^exponent for self > 0.
    #[inline]
    fn powf(self, exponent: Self) -> Self {
        let (x, k) = (self.value(), exponent.value());
        let value = x.powf(k);
        self.map(value, k * value / x) + exponent.map(0.0, value * x.ln())
    }

    /// The greater of two numbers.
    #[inline]
    fn max(self, other: Self) -> Self {
        if self.value().max(other.value()) == self.value() { self } else { other }
    }

    /// The smaller of two numbers.
    #[inline]
    fn min(self, other: Self) -> Self {
        if self.value().min(other.value()) == self.value() { self } else { other }
    }
}

impl Number for f64 {
    #[inline]
    fn value(self) -> f64 {
        self
    }

    #[inline]
    fn map(self, value: f64, _: f64) -> Self {
        value
    }
}

/// A number with its derivatives along some directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dual<const N: usize = 2> {
    pub value: f64,
    pub by: [f64; N],
}

impl<const N: usize> From<f64> for Dual<N> {
    #[inline]
    fn from(value: f64) -> Self {
        Self { value, by: [0.0; N] }
    }
}

impl<const N: usize> Number for Dual<N> {
    #[inline]
    fn value(self) -> f64 {
        self.value
    }

    #[inline]
    fn map(self, value: f64, derivative: f64) -> Self {
        Self { value, by: self.by.map(|by| derivative * by) }
    }
}

impl<const N: usize> Dual<N> {
    /// A function of two numbers, given its value and partial derivatives.
    #[inline]
    pub fn join(value: f64, [a, b]: [Self; 2], [by_a, by_b]: [f64; 2]) -> Self {
        Self { value, by: std::array::from_fn(|k| by_a * a.by[k] + by_b * b.by[k]) }
    }
}

/// Operators by their value and partial derivatives.
macro_rules! operators {
    ($($operator:ident $name:ident: $a:ident, $b:ident => $value:expr, [$by_a:expr, $by_b:expr];)*) => {$(
        impl<const N: usize> $operator for Dual<N> {
            type Output = Self;

            #[inline]
            fn $name(self, other: Self) -> Self {
                let ($a, $b) = (self.value, other.value);
                Self::join($value, [self, other], [$by_a, $by_b])
            }
        }

        impl<const N: usize> $operator<f64> for Dual<N> {
            type Output = Self;

            #[inline]
            fn $name(self, $b: f64) -> Self {
                let $a = self.value;
                self.map($value, $by_a)
            }
        }
    )*};
}

operators! {
    Add add: a, b => a + b, [1.0, 1.0];
    Sub sub: a, b => a - b, [1.0, -1.0];
    Mul mul: a, b => a * b, [b, a];
    Div div: a, b => a / b, [1.0 / b, -a / (b * b)];
}
