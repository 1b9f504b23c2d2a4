//! Direct effect of the slip rate.
//!
//! With a direct effect R is a variable of its own, since the traction also depends on the rate of plastic slip. At any time
//!
//! ```text
//! λ = V₀ (exp((|q|/(R μ p) − 1)/a) − 1)    where |q| > R μ p, with Ṙ = U(R) λ
//! λ = 0,   R = |q|/(μ p)                   where |q| does not exceed R μ p: R follows it down
//! ```
//! A step of first order takes λ = Δλ/Δt; steps are extrapolated (`with_rate.rs`).

use crate::laws::dual::{Dual, Number};
use crate::laws::friction::sensitivity::Inputs;

/// Factor of the strength R μ p by the rate of plastic slip, 1 + a ln(1 + λ/V₀).
#[derive(Clone, Copy, Debug)]
pub(super) struct DirectEffect<N = f64> {
    /// a > 0 [-]
    pub a: N,
    /// V₀ > 0 [L/T]
    pub reference_rate: N,
}

/// The factor in a step of plastic slip, and its derivatives by the slip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factor {
    /// f = 1 + a ln(1 + Δλ/(V₀ Δt)) [-]
    pub value: f64,
    /// df/dΔλ [1/L]
    pub slope: f64,
    /// d²f/dΔλ² [1/L²]
    pub bend: f64,
}

/// R μ, the strength per pressure along plastic slip, and its derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strength {
    /// R μ [-]
    pub value: f64,
    /// d(R μ)/dΔλ [1/L]
    pub slope: f64,
    /// d²(R μ)/dΔλ² times the stretch of the curve [1/L]
    pub bend: f64,
}

impl Strength {
    /// The strength times the factor of its rate.
    pub(super) fn raised(self, factor: &Factor, stretch: f64) -> Self {
        let Self { value, slope, bend } = self;
        Self {
            value: value * factor.value,
            slope: slope * factor.value + value * factor.slope,
            bend: bend * factor.value + stretch * (2.0 * slope * factor.slope + value * factor.bend),
        }
    }
}

impl DirectEffect {
    /// The factor after the plastic slip `slip` in the time `dt`.
    pub(super) fn factor(&self, slip: f64, dt: f64) -> Factor {
        let own = self.own_slip(dt);
        let slope = self.a / (own + slip);
        Factor { value: 1.0 + self.a * (slip / own).ln_1p(), slope, bend: -slope / (own + slip) }
    }

    /// V₀ Δt, not below what can divide [L]
    pub(super) fn own_slip(&self, dt: f64) -> f64 {
        (self.reference_rate * dt).max(f64::MIN_POSITIVE / f64::EPSILON)
    }

    /// λ under a traction of so many times R μ p [L/T]
    pub(super) fn rate(&self, excess: f64) -> f64 {
        self.reference_rate * ((excess - 1.0).max(0.0) / self.a).exp_m1()
    }

    /// The effect with the derivatives of its parameters.
    pub(super) fn along(&self, inputs: &Inputs) -> DirectEffect<Dual> {
        DirectEffect { a: inputs.parameter("a", self.a), reference_rate: inputs.parameter("V_0", self.reference_rate) }
    }
}

impl DirectEffect<Dual> {
    /// The factor with its derivatives by time and parameters at constant slip; `value` is the factor itself.
    pub(super) fn varied(&self, slip: f64, dt: Dual, value: f64) -> Dual {
        let logarithm = (value - 1.0) / self.a.value;
        let own = self.reference_rate * dt;
        let by_own = -slip / (own.value * (own.value + slip)).max(f64::MIN_POSITIVE);
        Dual::from(1.0) + self.a * own.map(logarithm, by_own)
    }
}
