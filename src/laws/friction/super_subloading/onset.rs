//! What fast slip after rest does to friction, and rest after slip: the peak that is met, how far it falls and how soon it heals.

use std::f64::consts::LN_2;

use super::approach::{Reach, SlidingCurve};
use super::peak::{PeakEvolution, scaled};

/// What the parameters of a law mean for the coefficient q/p, with slip so fast that nothing heals meanwhile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onset {
    /// from long rest, μ = μ_s
    pub rested: Rise,
    /// from the μ that the interface has when a run begins
    pub fresh: Rise,
    /// what friction falls to, μ_k [-]
    pub residual: f64,
    /// plastic slip over which half of μ_s − μ_k is lost; none without weakening [L]
    pub half_lost: Option<f64>,
    /// time of rest in which half of μ_s − μ_k comes back; none without healing [T]
    pub half_healed: Option<f64>,
}

/// How friction rises in fast slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rise {
    /// largest q/p = R μ [-]
    pub peak: f64,
    /// plastic slip up to it; none where it is neared only [L]
    pub slip: Option<f64>,
}

/// Coordinates of the curve between which R goes from 0 to 1 as far as double precision sees.
const ENDS: [f64; 2] = [-20.0, 40.0];
/// Places at which a peak is looked for, and thirds taken off to meet it.
const PLACES: u32 = 1200;
const THIRDS: usize = 100;

impl Onset {
    /// Of a law's curve of R and evolution of μ, from the μ that an interface begins with.
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
        let at = |place: f64| -> (Reach, f64) {
            let reach = curve.at(place, &start);
            (reach, reach.ratio * evolution.slid(mu, reach.slip))
        };
        let width = (ENDS[1] - ENDS[0]) / f64::from(PLACES);
        let places = (0..=PLACES).map(|k| ENDS[0] + f64::from(k) * width);
        let best = places.fold(ENDS[0], |best, place| if at(place).1 > at(best).1 { place } else { best });
        let (mut low, mut high) = (best - width, best + width);
        for _ in 0..THIRDS {
            let third = (high - low) / 3.0;
            if at(low + third).1 < at(high - third).1 { low += third } else { high -= third }
        }
        let (reach, peak) = at(0.5 * (low + high));
        // Without weakening, or under one that is over long before R is near 1, friction only rises.
        let limit = if evolution.kappa > 0.0 { evolution.mu_k } else { mu };
        match peak > limit * (1.0 + f64::EPSILON) {
            true => Self { peak, slip: Some(reach.slip) },
            false => Self { peak: limit, slip: None },
        }
    }
}

impl PeakEvolution {
    /// μ after the plastic slip `slip` in no time, exact.
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

    /// Plastic slip in no time that takes half of μ_s − μ_k; infinite without weakening [L]
    fn slip_of_half(&self) -> f64 {
        half((self.mu_s - self.mu_k) * self.per_mu_k, self.m) / self.sharpness()
    }

    /// Time of rest that gives half of μ_s − μ_k back; infinite without recovery [T]
    fn rest_of_half(&self) -> f64 {
        half((self.mu_s - self.mu_k) * self.per_mu_s, self.n) / (self.xi * self.per_mu_s)
    }
}

/// How far x goes until a deviation d₀ that falls by dd/dx = −d^k is half of it.
fn half(deviation: f64, k: f64) -> f64 {
    if k == 1.0 { LN_2 } else { ((k - 1.0) * LN_2).exp_m1() / ((k - 1.0) * deviation.powf(k - 1.0)) }
}
