//! Weakening of the peak coefficient μ with slip and its recovery with time.
//!
//! # Sensitivity
//!
//! The peak coefficient μ is differentiated with respect to the parameters of its evolution, in the controlled integration.
//!
//! # Onset
//!
//! The onset of fast slip after stationary contact is characterized by its peak friction, its residual, and the slip and time
//! of half weakening and healing.

use std::f64::consts::LN_2;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::approach::{CurvePoint, SlidingCurve};
use crate::laws::friction::root::{Argument, bracketed_root};

/// Integration of the evolution over an increment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub enum Integration {
    /// Sub-steps of second order, as many as the tolerance requires
    #[default]
    Controlled,
    /// One backward-Euler step, of first order
    BackwardEuler,
}

/// Weakening and recovery of the peak coefficient μ between μ_k and μ_s.
///
/// ```text
/// μ̇ = −κ (μ/μ_k − 1)^m λ + ξ (1 − μ/μ_s)^n
/// ```
#[derive(Clone, Copy, Debug)]
pub(super) struct PeakEvolution {
    pub(super) mu_s: f64,
    pub(super) mu_k: f64,
    pub(super) kappa: f64,
    pub(super) xi: f64,
    m: f64,
    n: f64,
    /// 1/μ_s and 1/μ_k, stored because divisions would dominate the cost of an evaluation.
    per_mu_s: f64,
    per_mu_k: f64,
    integration: Integration,
}

/// μ at the end of a step of plastic slip Δλ and time Δt from μ₀, and its derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peak {
    /// μ [-]
    pub mu: f64,
    /// ∂μ/∂Δλ ≤ 0 [1/L]
    pub slope: f64,
    /// ∂²μ/∂Δλ², for m = n = 1 only, else 0 [1/L²]
    pub curvature: f64,
    /// ∂μ/∂μ₀ [-]
    pub by_old: f64,
    /// ∂μ/∂Δt [1/T]
    pub by_time: f64,
}

/// Largest a and b of [`Evolution::at_uniform_rate`]: μ is stationary beyond, and squares must not overflow.
const LARGEST: f64 = 1e100;

impl PeakEvolution {
    /// The evolution with the parameters of a law.
    pub(super) fn new(mu_s: f64, mu_k: f64, kappa: f64, xi: f64, m: f64, n: f64, integration: Integration) -> Self {
        Self { mu_s, mu_k, kappa, xi, m, n, per_mu_s: 1.0 / mu_s, per_mu_k: 1.0 / mu_k, integration }
    }

    /// Whether both rates are linear in μ: m = n = 1.
    #[inline]
    pub(super) fn is_linear(&self) -> bool {
        self.m == 1.0 && self.n == 1.0
    }

    /// κ/μ_k: bound of the curvature of μ with plastic slip [1/L]
    #[inline]
    pub(super) fn sharpness(&self) -> f64 {
        self.kappa * self.per_mu_k
    }

    /// Limits μ to the range from μ_k to μ_s.
    #[inline]
    pub(super) fn clamp(&self, mu: f64) -> f64 {
        mu.clamp(self.mu_k, self.mu_s)
    }

    /// κ (μ/μ_k − 1)^m: weakening per plastic slip [1/L]
    #[inline]
    pub(super) fn weakening(&self, mu: f64) -> f64 {
        self.kappa * self.loss(mu).0
    }

    /// ξ (1 − μ/μ_s)^n: recovery per time [1/T]
    #[inline]
    pub(super) fn recovery(&self, mu: f64) -> f64 {
        self.xi * self.gain(mu).0
    }

    /// a b (μ_s − μ_k), where a = κ Δλ/μ_k and b = ξ Δt/μ_s: effect, for m = n = 1, of the order of weakening and recovery
    /// on μ.
    pub(super) fn commutator(&self, slip: f64, dt: f64) -> f64 {
        self.sharpness() * slip * self.xi * dt * self.per_mu_s * (self.mu_s - self.mu_k)
    }

    /// μ after plastic slip `slip` and time `dt` from `old`, by one step of the integration.
    #[inline(always)]
    pub(super) fn after(&self, old: f64, slip: f64, dt: f64) -> Peak {
        match self.integration {
            Integration::Controlled => self.at_uniform_rate(old, slip, dt),
            Integration::BackwardEuler => self.backward_euler(old, slip, dt),
        }
    }

    /// μ after the time `dt` without plastic slip, exact except for backward Euler, and ∂μ/∂Δt.
    ///
    /// ```text
    /// d = 1 − μ/μ_s:   d^(1−n) = d₀^(1−n) + (n − 1) ξ Δt/μ_s,   d = d₀ exp(−ξ Δt/μ_s) for n = 1
    /// ```
    pub(super) fn rested(&self, old: f64, dt: f64) -> (f64, f64) {
        if self.n == 1.0 || self.integration == Integration::BackwardEuler {
            let peak = self.after(old, 0.0, dt);
            return (peak.mu, peak.by_time);
        }
        let deficit = (self.mu_s - old) * self.per_mu_s;
        let growth = scaled(deficit.powf(self.n - 1.0), (self.n - 1.0) * self.xi * dt * self.per_mu_s);
        let share = if growth > -1.0 { (-growth.ln_1p() / (self.n - 1.0)).exp() } else { 0.0 };
        let mu = self.clamp(old + (self.mu_s - old) * (1.0 - share));
        (mu, self.recovery(mu))
    }

    /// One backward-Euler step. Its equation has one root in [μ_k, μ_s], steady sliding at any step length.
    ///
    /// ```text
    /// μ = μ₀ − κ Δλ (μ/μ_k − 1)^m + ξ Δt (1 − μ/μ_s)^n
    /// ```
    #[inline(always)]
    fn backward_euler(&self, old: f64, slip: f64, dt: f64) -> Peak {
        let (weakening, recovery) = (self.kappa * slip, self.xi * dt);
        if self.is_linear() {
            let share = 1.0 / (1.0 + weakening * self.per_mu_k + recovery * self.per_mu_s);
            let mu = self.clamp((old + weakening + recovery) * share);
            let slope = -self.weakening(mu) * share;
            let curvature = -2.0 * self.sharpness() * slope * share;
            return Peak { mu, slope, curvature, by_old: share, by_time: self.recovery(mu) * share };
        }
        let mu = self.clamp(self.solve(old, weakening, recovery));
        let ((loss, loss_slope), (gain, gain_slope)) = (self.loss(mu), self.gain(mu));
        let share = 1.0 / (1.0 + scaled(loss_slope, weakening) + scaled(gain_slope, recovery));
        let slope = -self.kappa * loss * share;
        Peak { mu, slope, curvature: 0.0, by_old: share, by_time: self.xi * gain * share }
    }

    /// Root of the backward-Euler equation for exponents other than 1.
    fn solve(&self, old: f64, weakening: f64, recovery: f64) -> f64 {
        let mut mu = old;
        bracketed_root([self.mu_k, self.mu_s], old, |trial| {
            mu = trial;
            let ((loss, loss_slope), (gain, gain_slope)) = (self.loss(mu), self.gain(mu));
            let value = old - mu - weakening * loss + recovery * gain;
            let stiffness = 1.0 + scaled(loss_slope, weakening) + scaled(gain_slope, recovery);
            Argument { value, step: value / stiffness, done: value.abs() <= f64::EPSILON * self.mu_k }
        });
        mu
    }

    /// One step in which plastic slip and time proceed at a uniform rate.
    ///
    /// ```text
    /// a = κ̂ Δλ/μ_k,   b = ξ̂ Δt/μ_s,   Z = a + b
    /// μ = μ₀ + (a (μ_k − μ₀) + b (μ_s − μ₀)) (1 − e^(−Z))/Z
    /// κ̂ = κ (μ/μ_k − 1)^(m−1),   ξ̂ = ξ (1 − μ/μ_s)^(n−1)   at half the step, by backward Euler
    /// ```
    /// For m = n = 1 this is exact at a uniform rate, and without recovery or without weakening also at any other;
    /// for other exponents it is of second order. Steady sliding is reproduced at any step length.
    #[inline(always)]
    fn at_uniform_rate(&self, old: f64, slip: f64, dt: f64) -> Peak {
        let (kappa, xi) = (self.kappa * self.per_mu_k, self.xi * self.per_mu_s);
        if self.is_linear() {
            return self.relax(old, kappa, slip, xi, dt).0;
        }
        let half = self.backward_euler(old, 0.5 * slip, 0.5 * dt);
        let excess = ((half.mu - self.mu_k) * self.per_mu_k).max(f64::EPSILON);
        let deficit = ((self.mu_s - half.mu) * self.per_mu_s).max(f64::EPSILON);
        let (kappa, xi) = (kappa * excess.powf(self.m - 1.0), xi * deficit.powf(self.n - 1.0));
        let (peak, (by_a, by_b)) = self.relax(old, kappa, slip, xi, dt);
        let through_a = by_a * kappa * slip * (self.m - 1.0) * self.per_mu_k / excess;
        let through_b = by_b * xi * dt * (self.n - 1.0) * self.per_mu_s / deficit;
        let by_half = through_a - through_b;
        Peak {
            mu: peak.mu,
            slope: (peak.slope + by_half * 0.5 * half.slope).min(0.0),
            curvature: 0.0,
            by_old: peak.by_old + by_half * half.by_old,
            by_time: peak.by_time + by_half * 0.5 * half.by_time,
        }
    }

    /// μ of [`Self::at_uniform_rate`], `kappa` being κ̂/μ_k and `xi` ξ̂/μ_s, and (∂μ/∂a, ∂μ/∂b).
    #[inline(always)]
    fn relax(&self, old: f64, kappa: f64, slip: f64, xi: f64, dt: f64) -> (Peak, (f64, f64)) {
        let (a, b) = ((kappa * slip).min(LARGEST), (xi * dt).min(LARGEST));
        let (to_kinetic, to_static) = (self.mu_k - old, self.mu_s - old);
        let drive = a * to_kinetic + b * to_static;
        let Decay { left, mean, slope, curvature } = decay(a + b);
        let (by_a, by_b) = (to_kinetic * mean + drive * slope, to_static * mean + drive * slope);
        let peak = Peak {
            mu: self.clamp(old + drive * mean),
            slope: kappa * by_a,
            curvature: kappa * kappa * (2.0 * to_kinetic * slope + drive * curvature),
            by_old: left,
            by_time: xi * by_b,
        };
        (peak, (by_a, by_b))
    }

    /// (μ/μ_k − 1)^m and its derivative.
    #[inline]
    fn loss(&self, mu: f64) -> (f64, f64) {
        let (value, slope) = power((mu - self.mu_k) * self.per_mu_k, self.m);
        (value, slope * self.per_mu_k)
    }

    /// (1 − μ/μ_s)^n and minus its derivative.
    #[inline]
    fn gain(&self, mu: f64) -> (f64, f64) {
        let (value, slope) = power((self.mu_s - mu) * self.per_mu_s, self.n);
        (value, slope * self.per_mu_s)
    }
}

/// Remaining deviation after Z relaxation times.
struct Decay {
    /// e^(−Z)
    left: f64,
    /// φ = (1 − e^(−Z))/Z
    pub mean: f64,
    /// dφ/dZ
    pub slope: f64,
    /// d²φ/dZ²
    curvature: f64,
}

/// e^(−Z) and φ(Z) for Z ≥ 0. The round-off of φ and its derivatives is of the order ε/Z, ε/Z², ε/Z³, and harmless since
/// they are multiplied by Z, Z and Z².
#[inline]
fn decay(z: f64) -> Decay {
    if z < 1e-3 {
        let mean = 1.0 - z * (0.5 - z * (1.0 / 6.0 - z / 24.0));
        let slope = -0.5 + z * (1.0 / 3.0 - z / 8.0);
        return Decay { left: 1.0 - z * mean, mean, slope, curvature: 1.0 / 3.0 - 0.25 * z };
    }
    let (left, per_z) = ((-z).exp(), 1.0 / z);
    let mean = (1.0 - left) * per_z;
    let slope = (left - mean) * per_z;
    Decay { left, mean, slope, curvature: (-left - 2.0 * slope) * per_z }
}

/// x^k and its derivative, which is infinite at x = 0 for k < 1.
#[inline]
fn power(x: f64, k: f64) -> (f64, f64) {
    if k == 1.0 {
        (x, 1.0)
    } else if x > 0.0 {
        let value = x.powf(k);
        (value, k * value / x)
    } else {
        (0.0, if k < 1.0 { f64::INFINITY } else { 0.0 })
    }
}

/// A slope times a factor; a term with zero factor is zero even if its slope is infinite.
fn scaled(slope: f64, factor: f64) -> f64 {
    if factor == 0.0 { 0.0 } else { slope * factor }
}

/// Derivative of each parameter of [`PeakEvolution`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PeakShift {
    pub mu_s: f64,
    pub mu_k: f64,
    pub kappa: f64,
    pub xi: f64,
    pub m: f64,
    pub n: f64,
}

/// κ̂ Δλ/μ_k and ξ̂ Δt/μ_s, a and b of a step at a uniform rate, and their variations.
struct Exponents {
    a: f64,
    b: f64,
    da: f64,
    db: f64,
}

impl PeakEvolution {
    /// Derivative of μ where [`clamp`](Self::clamp) has limited it.
    pub(super) fn clamped_by(&self, mu: f64, dmu: f64, by: &PeakShift) -> f64 {
        if mu > self.mu_s {
            by.mu_s
        } else if mu < self.mu_k {
            by.mu_k
        } else {
            dmu
        }
    }

    /// ∂μ of one step at a uniform rate for given plastic slip `slip`, time `dt` and initial μ.
    ///
    /// ```text
    /// dμ = ∂μ/∂a da + ∂μ/∂b db + (a dμ_k + b dμ_s) (1 − e^(−Z))/Z
    /// ```
    pub(super) fn after_by(&self, old: f64, slip: f64, dt: f64, by: &PeakShift) -> f64 {
        let Exponents { a, b, da, db } = self.exponents_by(old, slip, dt, by);
        let (to_kinetic, to_static) = (self.mu_k - old, self.mu_s - old);
        let drive = a * to_kinetic + b * to_static;
        let decay = decay(a + b);
        let (by_a, by_b) =
            (to_kinetic * decay.mean + drive * decay.slope, to_static * decay.mean + drive * decay.slope);
        by_a * da + by_b * db + decay.mean * (a * by.mu_k + b * by.mu_s)
    }

    fn exponents_by(&self, old: f64, slip: f64, dt: f64, by: &PeakShift) -> Exponents {
        let (kappa, xi) = (self.kappa * self.per_mu_k, self.xi * self.per_mu_s);
        let (dkappa, dxi) = (
            by.kappa * self.per_mu_k - kappa * self.per_mu_k * by.mu_k,
            by.xi * self.per_mu_s - xi * self.per_mu_s * by.mu_s,
        );
        if self.is_linear() && by.m == 0.0 && by.n == 0.0 {
            return Exponents { a: kappa * slip, b: xi * dt, da: dkappa * slip, db: dxi * dt };
        }
        let half = self.backward_euler(old, 0.5 * slip, 0.5 * dt);
        let dhalf = self.backward_euler_by(half.mu, 0.5 * slip, 0.5 * dt, by);
        let (dexcess, ddeficit) = (
            (dhalf - half.mu * self.per_mu_k * by.mu_k) * self.per_mu_k,
            (half.mu * self.per_mu_s * by.mu_s - dhalf) * self.per_mu_s,
        );
        // Values limited by round-off do not vary.
        let held = |share: f64, dshare: f64| {
            if share > f64::EPSILON { (share, dshare) } else { (f64::EPSILON, 0.0) }
        };
        let (excess, dexcess) = held((half.mu - self.mu_k) * self.per_mu_k, dexcess);
        let (deficit, ddeficit) = held((self.mu_s - half.mu) * self.per_mu_s, ddeficit);
        let (loss, gain) = (excess.powf(self.m - 1.0), deficit.powf(self.n - 1.0));
        let dloss = loss * (by.m * excess.ln() + (self.m - 1.0) * dexcess / excess);
        let dgain = gain * (by.n * deficit.ln() + (self.n - 1.0) * ddeficit / deficit);
        Exponents {
            a: kappa * loss * slip,
            b: xi * gain * dt,
            da: (dkappa * loss + kappa * dloss) * slip,
            db: (dxi * gain + xi * dgain) * dt,
        }
    }

    /// ∂μ of one backward-Euler step that ends with `mu`, for given initial μ.
    ///
    /// ```text
    /// dμ (1 + A + B) = A μ/μ_k dμ_k + B μ/μ_s dμ_s + Δt (gain dξ + ξ ∂gain/∂n dn) − Δλ (loss dκ + κ ∂loss/∂m dm)
    /// A = κ Δλ ∂loss/∂μ,   B = ξ Δt ∂(−gain)/∂μ
    /// ```
    /// If m or n is less than 1, a slope is infinite at μ_k or μ_s: evaluated at round-off distance it keeps μ at that end.
    fn backward_euler_by(&self, mu: f64, slip: f64, dt: f64, by: &PeakShift) -> f64 {
        let (x, y) = ((mu - self.mu_k) * self.per_mu_k, (self.mu_s - mu) * self.per_mu_s);
        let slope = |x: f64, k: f64| power(if k < 1.0 { x.max(f64::EPSILON) } else { x }, k).1;
        let to_kinetic = self.kappa * slip * slope(x, self.m) * self.per_mu_k;
        let to_static = self.xi * dt * slope(y, self.n) * self.per_mu_s;
        let ((loss, _), (gain, _)) = (power(x, self.m), power(y, self.n));
        let drawn = mu * (to_kinetic * self.per_mu_k * by.mu_k + to_static * self.per_mu_s * by.mu_s);
        let gained = dt * (by.xi * gain + self.xi * logarithmic(gain, y) * by.n);
        let lost = slip * (by.kappa * loss + self.kappa * logarithmic(loss, x) * by.m);
        (drawn + gained - lost) / (1.0 + to_kinetic + to_static)
    }

    /// dμ after the time `dt` without plastic slip, for variations `dold` of the initial μ, `ddt` of the time and `by` of the parameters.
    ///
    /// ```text
    /// d = 1 − μ/μ_s,   d^(1−n) = d₀^(1−n) + (n − 1) b,   b = ξ Δt/μ_s
    /// δd = (d/d₀)ⁿ δd₀ − dⁿ δb + ∂d/∂n δn,   ∂d/∂n = dⁿ (d^(1−n) ln d − d₀^(1−n) ln d₀ + b)/(1 − n)
    /// ```
    pub(super) fn rested_by(&self, old: f64, dt: f64, dold: f64, ddt: f64, by: &PeakShift) -> f64 {
        let (xi, n) = (self.xi * self.per_mu_s, self.n);
        let b = xi * dt;
        let db = (by.xi * dt + self.xi * ddt) * self.per_mu_s - b * self.per_mu_s * by.mu_s;
        let deficit = (self.mu_s - old) * self.per_mu_s;
        let ddeficit = (old * self.per_mu_s * by.mu_s - dold) * self.per_mu_s;
        // d/d₀
        let share = if n == 1.0 {
            (-b).exp()
        } else {
            let growth = scaled(deficit.powf(n - 1.0), (n - 1.0) * b);
            if growth > -1.0 { (-growth.ln_1p() / (n - 1.0)).exp() } else { 0.0 }
        };
        let left = deficit * share;
        let by_exponent = if by.n == 0.0 || left <= 0.0 {
            0.0
        } else if n == 1.0 {
            0.5 * left * (left.ln().powi(2) - deficit.ln().powi(2))
        } else {
            let bend = left.powf(1.0 - n) * left.ln() - deficit.powf(1.0 - n) * deficit.ln() + b;
            left.powf(n) * bend / (1.0 - n)
        };
        let dleft = share.powf(n) * ddeficit - left.max(0.0).powf(n) * db + by_exponent * by.n;
        by.mu_s * (1.0 - left) - self.mu_s * dleft
    }
}

/// xᵏ ln x, the derivative of xᵏ with respect to k; 0 at x = 0.
fn logarithmic(power: f64, x: f64) -> f64 {
    if x > 0.0 { power * x.ln() } else { 0.0 }
}

/// Peak, residual and characteristic slips of q/p from the parameters of a law, for slip so fast that no healing occurs
/// meanwhile.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Onset {
    /// after a long hold, μ = μ_s
    pub rested: Rise,
    /// with the initial μ of the interface
    pub fresh: Rise,
    /// residual friction, μ_k [-]
    pub residual: f64,
    /// plastic slip over which half of μ_s − μ_k is lost; `None` without weakening [L]
    pub half_lost: Option<f64>,
    /// hold time in which half of μ_s − μ_k is recovered; `None` without healing [T]
    pub half_healed: Option<f64>,
}

/// Rise of friction to its peak in rapid slip.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rise {
    /// largest q/p = R μ [-]
    pub peak: f64,
    /// plastic slip up to the peak; `None` if it is only approached asymptotically [L]
    pub slip: Option<f64>,
}

/// Coordinates of the curve between which R goes from 0 to 1 in double precision.
const ENDS: [f64; 2] = [-20.0, 40.0];
/// Number of points at which a peak is searched, and of section steps to locate it.
const PLACES: u32 = 1200;
const THIRDS: usize = 100;

impl Onset {
    /// Peak for a law's sliding curve and evolution of μ, from the initial μ of an interface.
    pub(super) fn of(curve: &SlidingCurve, evolution: &PeakEvolution, initial_mu: f64) -> Self {
        let half = |x: f64| (evolution.mu_s > evolution.mu_k && x.is_finite()).then_some(x);
        Self {
            rested: Rise::of(curve, evolution, evolution.mu_s),
            fresh: Rise::of(curve, evolution, initial_mu),
            residual: evolution.mu_k,
            half_lost: half(evolution.slip_of_half()),
            half_healed: half(evolution.rest_of_half()),
        }
    }
}

impl Rise {
    /// max R(λ) μ(λ), with R along its curve from R_e and μ falling from `mu`.
    fn of(curve: &SlidingCurve, evolution: &PeakEvolution, mu: f64) -> Self {
        let start = curve.start(0.0);
        let at = |place: f64| -> (CurvePoint, f64) {
            let curve_point = curve.at(place, &start);
            (curve_point, curve_point.ratio * evolution.slid(mu, curve_point.slip))
        };
        let width = (ENDS[1] - ENDS[0]) / f64::from(PLACES);
        let places = (0..=PLACES).map(|k| ENDS[0] + f64::from(k) * width);
        let best = places.fold(ENDS[0], |best, place| if at(place).1 > at(best).1 { place } else { best });
        let (mut low, mut high) = (best - width, best + width);
        for _ in 0..THIRDS {
            let third = (high - low) / 3.0;
            if at(low + third).1 < at(high - third).1 { low += third } else { high -= third }
        }
        let (curve_point, peak) = at(0.5 * (low + high));
        // Without weakening, or with weakening completed long before R is near 1, friction only increases.
        let limit = if evolution.kappa > 0.0 { evolution.mu_k } else { mu };
        match peak > limit * (1.0 + f64::EPSILON) {
            true => Self { peak, slip: Some(curve_point.slip) },
            false => Self { peak: limit, slip: None },
        }
    }
}

impl PeakEvolution {
    /// μ after instantaneous plastic slip `slip`, exact.
    ///
    /// ```text
    /// e = μ/μ_k − 1:   e^(1−m) = e₀^(1−m) + (m − 1) κ Δλ/μ_k,   e = e₀ exp(−κ Δλ/μ_k) for m = 1
    /// ```
    fn slid(&self, old: f64, slip: f64) -> f64 {
        let passed = self.sharpness() * slip;
        let excess = (old - self.mu_k) * self.per_mu_k;
        let growth = scaled(excess.powf(self.m - 1.0), (self.m - 1.0) * passed);
        let share = match self.m == 1.0 {
            true => (-passed).exp(),
            false if growth > -1.0 => (-growth.ln_1p() / (self.m - 1.0)).exp(),
            false => 0.0,
        };
        self.clamp(self.mu_k + (old - self.mu_k) * share)
    }

    /// Instantaneous plastic slip that halves μ − μ_k, starting from μ_s; infinite without weakening [L]
    fn slip_of_half(&self) -> f64 {
        half((self.mu_s - self.mu_k) * self.per_mu_k, self.m) / self.sharpness()
    }

    /// Hold time that recovers half of μ_s − μ_k; infinite without recovery [T]
    fn rest_of_half(&self) -> f64 {
        half((self.mu_s - self.mu_k) * self.per_mu_s, self.n) / (self.xi * self.per_mu_s)
    }
}

/// Distance in x over which a deviation d₀ that decays by dd/dx = −d^k is halved.
fn half(deviation: f64, k: f64) -> f64 {
    if k == 1.0 { LN_2 } else { ((k - 1.0) * LN_2).exp_m1() / ((k - 1.0) * deviation.powf(k - 1.0)) }
}
