//! Weakening of the peak coefficient μ with slip and its recovery with time.
//!
//! The onset of fast slip after stationary contact is characterized by its peak friction, its residual, and the slip and time
//! of half weakening and healing.

use std::f64::consts::LN_2;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::laws::approach::{CurvePoint, SlidingCurve};
use crate::laws::dual::{Dual, Number};
use crate::laws::friction::root::{Argument, bracketed_root};
use crate::laws::friction::sensitivity::Inputs;

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
pub(super) struct PeakEvolution<N = f64> {
    pub(super) mu_s: N,
    pub(super) mu_k: N,
    pub(super) kappa: N,
    pub(super) xi: N,
    m: N,
    n: N,
    /// 1/μ_s and 1/μ_k, stored because divisions would dominate the cost of an evaluation.
    per_mu_s: N,
    per_mu_k: N,
    integration: Integration,
}

/// μ at the end of a step of plastic slip Δλ and time Δt from μ₀, and its derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peak<N = f64> {
    /// μ [-]
    pub mu: N,
    /// ∂μ/∂Δλ ≤ 0 [1/L]
    pub slope: f64,
    /// ∂²μ/∂Δλ², for m = n = 1 only, else 0 [1/L²]
    pub curvature: f64,
    /// ∂μ/∂μ₀ [-]
    pub by_old: f64,
    /// ∂μ/∂Δt [1/T]
    pub by_time: f64,
}

impl Peak {
    /// μ with derivatives by μ₀ and Δt alone.
    #[inline]
    pub(super) fn along(&self, old: Dual, dt: Dual) -> Dual {
        old.map(self.mu, self.by_old) + dt.map(0.0, self.by_time)
    }
}

/// Largest a and b of [`PeakEvolution::at_uniform_rate`]: μ is stationary beyond, and squares must not overflow.
const LARGEST: f64 = 1e100;

/// Stands for an infinite slope in derivatives: it keeps μ at μ_k or μ_s.
const STEEP: f64 = 1e12;

impl PeakEvolution {
    /// The evolution with the derivatives of its parameters.
    pub(super) fn along(&self, inputs: &Inputs) -> PeakEvolution<Dual> {
        let of = |name: &str, value: f64| inputs.parameter(name, value);
        let (mu_s, mu_k, kappa) = (of("mu_s", self.mu_s), of("mu_k", self.mu_k), of("kappa", self.kappa));
        let (xi, m, n) = (of("xi", self.xi), of("m", self.m), of("n", self.n));
        PeakEvolution::new(mu_s, mu_k, kappa, xi, m, n, self.integration)
    }

    /// a b (μ_s − μ_k), where a = κ Δλ/μ_k and b = ξ Δt/μ_s: effect, for m = n = 1, of the order of weakening and recovery
    /// on μ.
    pub(super) fn commutator(&self, slip: f64, dt: f64) -> f64 {
        self.sharpness() * slip * self.xi * dt * self.per_mu_s * (self.mu_s - self.mu_k)
    }
}

impl<N: Number> PeakEvolution<N> {
    /// The evolution with the parameters of a law.
    pub(super) fn new(mu_s: N, mu_k: N, kappa: N, xi: N, m: N, n: N, integration: Integration) -> Self {
        let one = N::from(1.0);
        Self { mu_s, mu_k, kappa, xi, m, n, per_mu_s: one / mu_s, per_mu_k: one / mu_k, integration }
    }

    /// κ/μ_k: bound of the curvature of μ with plastic slip [1/L]
    #[inline]
    pub(super) fn sharpness(&self) -> N {
        self.kappa * self.per_mu_k
    }

    /// κ (μ/μ_k − 1)^m: weakening per plastic slip [1/L]
    #[inline]
    pub(super) fn weakening(&self, mu: N) -> N {
        self.kappa * self.loss(mu).0
    }

    /// ξ (1 − μ/μ_s)^n: recovery per time [1/T]
    #[inline]
    pub(super) fn recovery(&self, mu: N) -> N {
        self.xi * self.gain(mu).0
    }

    /// 1/R* − 1 = μ/μ_k − 1: structure beyond the residual [-]
    #[inline]
    pub(super) fn excess(&self, mu: N) -> N {
        (mu - self.mu_k) * self.per_mu_k
    }

    /// Mean of μ over a step from `mu[0]` to `mu[1]`: of uniform rates for m = n = 1, as in [`Self::at_uniform_rate`], and of second
    /// order for other exponents.
    ///
    /// ```text
    /// mean of μ = μ₀ + (a (μ_k − μ₀) + b (μ_s − μ₀)) (1 − φ(Z))/Z,   φ = (1 − e^(−Z))/Z
    /// ```
    pub(super) fn mean(&self, [old, new]: [N; 2], slip: N, dt: N) -> N {
        if !self.is_linear() {
            return (old + new) * 0.5;
        }
        let (a, b) = (self.kappa * slip * self.per_mu_k, self.xi * dt * self.per_mu_s);
        let z = a + b;
        let (mean, slope) = decay(z.value()).of_mean(z.value());
        self.clamp(old + (a * (self.mu_k - old) + b * (self.mu_s - old)) * z.map(mean, slope))
    }

    /// Whether both rates are linear in μ: m = n = 1, and do not vary.
    #[inline]
    pub(super) fn is_linear(&self) -> bool {
        self.m == N::from(1.0) && self.n == N::from(1.0)
    }

    /// Limits μ to the range from μ_k to μ_s.
    #[inline]
    pub(super) fn clamp(&self, mu: N) -> N {
        if mu.value() < self.mu_k.value() {
            self.mu_k
        } else if mu.value() > self.mu_s.value() {
            self.mu_s
        } else {
            mu
        }
    }

    /// μ after plastic slip `slip` and time `dt` from `old`, by one step of the integration.
    #[inline(always)]
    pub(super) fn after(&self, old: N, slip: f64, dt: N) -> Peak<N> {
        match self.integration {
            Integration::Controlled => self.at_uniform_rate(old, slip, dt),
            Integration::BackwardEuler => self.backward_euler(old, slip, dt),
        }
    }

    /// μ after the time `dt` without plastic slip, exact except for backward Euler.
    ///
    /// ```text
    /// d = 1 − μ/μ_s,   b = ξ Δt/μ_s:   d^(1−n) = d₀^(1−n) + (n − 1) b,   d = d₀ e^(−b) for n = 1
    /// δd = (d/d₀)ⁿ δd₀ − dⁿ δb + ∂d/∂n δn,   ∂d/∂n = dⁿ (d^(1−n) ln d − d₀^(1−n) ln d₀ + b)/(1 − n)
    /// ```
    pub(super) fn rested(&self, old: N, dt: N) -> N {
        if self.n == N::from(1.0) || self.integration == Integration::BackwardEuler {
            return self.after(old, 0.0, dt).mu;
        }
        let [mu_s, xi, n, per_mu_s] = [self.mu_s, self.xi, self.n, self.per_mu_s].map(N::value);
        let (deficit, b) = ((self.mu_s - old) * self.per_mu_s, self.xi * dt * self.per_mu_s);
        let start = deficit.value();
        let share = if n == 1.0 {
            (-b.value()).exp()
        } else {
            let growth = scaled(start.powf(n - 1.0), (n - 1.0) * xi * dt.value() * per_mu_s);
            if growth > -1.0 { (-growth.ln_1p() / (n - 1.0)).exp() } else { 0.0 }
        };
        let left = start * share;
        let by_exponent = if left <= 0.0 {
            0.0
        } else if n == 1.0 {
            0.5 * left * (left.ln().powi(2) - start.ln().powi(2))
        } else {
            let bend = left.powf(1.0 - n) * left.ln() - start.powf(1.0 - n) * start.ln() + b.value();
            left.powf(n) * bend / (1.0 - n)
        };
        let left = deficit.map(left, share.powf(n)) - b.map(0.0, left.max(0.0).powf(n)) + self.n.map(0.0, by_exponent);
        let mu = old.value() + (mu_s - old.value()) * (1.0 - share);
        self.clamp((self.mu_s - self.mu_s * left).map(mu, 1.0))
    }

    /// One backward-Euler step. Its equation has one root in [μ_k, μ_s], steady sliding at any step length.
    ///
    /// ```text
    /// μ = μ₀ − κ Δλ (μ/μ_k − 1)^m + ξ Δt (1 − μ/μ_s)^n
    /// ```
    #[inline(always)]
    fn backward_euler(&self, old: N, slip: f64, dt: N) -> Peak<N> {
        let (weakening, recovery) = (self.kappa * slip, self.xi * dt);
        if self.is_linear() {
            let share = N::from(1.0) / (weakening * self.per_mu_k + 1.0 + recovery * self.per_mu_s);
            let mu = self.clamp((old + weakening + recovery) * share);
            let slope = -(self.weakening(mu) * share).value();
            let curvature = -2.0 * self.sharpness().value() * slope * share.value();
            let by_time = (self.recovery(mu) * share).value();
            return Peak { mu, slope, curvature, by_old: share.value(), by_time };
        }
        let at = |mu: f64| {
            let ((loss, loss_slope), (gain, gain_slope)) = (self.loss(mu.into()), self.gain(mu.into()));
            let stiffness = move |most: f64| {
                1.0 + scaled(loss_slope.min(most), weakening.value()) + scaled(gain_slope.min(most), recovery.value())
            };
            (old - mu - weakening * loss + recovery * gain, stiffness, [loss, gain])
        };
        let mut mu = old.value();
        bracketed_root([self.mu_k.value(), self.mu_s.value()], mu, |trial| {
            mu = trial;
            let (value, stiffness, _) = at(mu);
            let done = value.value().abs() <= f64::EPSILON * self.mu_k.value();
            Argument { value: value.value(), step: value.value() / stiffness(f64::INFINITY), done }
        });
        let (residual, stiffness, [loss, gain]) = at(mu);
        let share = 1.0 / stiffness(f64::INFINITY);
        let (slope, by_time) = (-self.kappa.value() * loss.value() * share, self.xi.value() * gain.value() * share);
        Peak { mu: residual.map(mu, 1.0 / stiffness(STEEP)), slope, curvature: 0.0, by_old: share, by_time }
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
    fn at_uniform_rate(&self, old: N, slip: f64, dt: N) -> Peak<N> {
        let (kappa, xi) = (self.kappa * self.per_mu_k, self.xi * self.per_mu_s);
        if self.is_linear() {
            return self.relax(old, kappa, slip, xi, dt).0;
        }
        let half = self.backward_euler(old, 0.5 * slip, dt * 0.5);
        let excess = self.excess(half.mu).max(f64::EPSILON.into());
        let deficit = ((self.mu_s - half.mu) * self.per_mu_s).max(f64::EPSILON.into());
        let (kappa, xi) = (kappa * excess.powf(self.m - 1.0), xi * deficit.powf(self.n - 1.0));
        let (peak, (by_a, by_b)) = self.relax(old, kappa, slip, xi, dt);
        let [m, n, per_mu_k, per_mu_s] = [self.m, self.n, self.per_mu_k, self.per_mu_s].map(N::value);
        let through_a = by_a * kappa.value() * slip * (m - 1.0) * per_mu_k / excess.value();
        let through_b = by_b * xi.value() * dt.value() * (n - 1.0) * per_mu_s / deficit.value();
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
    fn relax(&self, old: N, kappa: N, slip: f64, xi: N, dt: N) -> (Peak<N>, (f64, f64)) {
        let (a, b) = ((kappa * slip).min(LARGEST.into()), (xi * dt).min(LARGEST.into()));
        let (to_kinetic, to_static) = (self.mu_k - old, self.mu_s - old);
        let drive = a * to_kinetic + b * to_static;
        let z = a + b;
        let Decay { left, mean, slope, curvature } = decay(z.value());
        let mu = self.clamp(old + drive * z.map(mean, slope));
        let (kappa, to_kinetic, drive) = (kappa.value(), to_kinetic.value(), drive.value());
        let (by_a, by_b) = (to_kinetic * mean + drive * slope, to_static.value() * mean + drive * slope);
        let curvature = kappa * kappa * (2.0 * to_kinetic * slope + drive * curvature);
        let by_time = xi.value() * by_b;
        (Peak { mu, slope: kappa * by_a, curvature, by_old: left, by_time }, (by_a, by_b))
    }

    /// (μ/μ_k − 1)^m and its derivative.
    #[inline]
    fn loss(&self, mu: N) -> (N, f64) {
        let (value, slope) = power(self.excess(mu), self.m);
        (value, slope * self.per_mu_k.value())
    }

    /// (1 − μ/μ_s)^n and minus its derivative.
    #[inline]
    fn gain(&self, mu: N) -> (N, f64) {
        let (value, slope) = power((self.mu_s - mu) * self.per_mu_s, self.n);
        (value, slope * self.per_mu_s.value())
    }
}

/// Remaining deviation after Z relaxation times.
struct Decay {
    /// e^(−Z)
    left: f64,
    /// φ = (1 − e^(−Z))/Z
    mean: f64,
    /// dφ/dZ
    slope: f64,
    /// d²φ/dZ²
    curvature: f64,
}

impl Decay {
    /// ψ = (1 − φ)/Z and dψ/dZ.
    fn of_mean(&self, z: f64) -> (f64, f64) {
        if z < 1e-3 {
            return (0.5 - z * (1.0 / 6.0 - z / 24.0), -1.0 / 6.0 + z / 12.0);
        }
        let mean = (1.0 - self.mean) / z;
        (mean, -(self.slope + mean) / z)
    }
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
fn power<N: Number>(x: N, k: N) -> (N, f64) {
    if k == N::from(1.0) {
        (x, 1.0)
    } else if x.value() > 0.0 {
        let value = x.powf(k);
        (value, k.value() * value.value() / x.value())
    } else {
        let slope = if k.value() < 1.0 { f64::INFINITY } else { f64::from(u8::from(k.value() == 1.0)) };
        (x.map(0.0, slope.min(STEEP)), slope)
    }
}

/// A slope times a factor; a term with zero factor is zero even if its slope is infinite.
fn scaled(slope: f64, factor: f64) -> f64 {
    if factor == 0.0 { 0.0 } else { slope * factor }
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
