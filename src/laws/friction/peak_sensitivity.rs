//! How the peak coefficient μ varies with the parameters of its evolution, by the controlled integration.

use super::peak::{PeakEvolution, decay, power, scaled};

/// How much each parameter of [`PeakEvolution`] varies.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PeakShift {
    pub mu_s: f64,
    pub mu_k: f64,
    pub kappa: f64,
    pub xi: f64,
    pub m: f64,
    pub n: f64,
}

/// How much each parameter of the law varies.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shift {
    pub alpha_t: f64,
    pub r: f64,
    pub elastic_core: f64,
    pub peak: PeakShift,
}

/// κ̂ Δλ and ξ̂ Δt over μ_k and μ_s, a and b of a step at a uniform rate, and how they vary.
struct Exponents {
    a: f64,
    b: f64,
    da: f64,
    db: f64,
}

impl PeakEvolution {
    /// How μ varies where [`clamp`](Self::clamp) has put it.
    pub(super) fn clamped_by(&self, mu: f64, dmu: f64, by: &PeakShift) -> f64 {
        if mu > self.mu_s {
            by.mu_s
        } else if mu < self.mu_k {
            by.mu_k
        } else {
            dmu
        }
    }

    /// ∂μ of one step at a uniform rate, the plastic slip `slip`, the time `dt` and μ at the start being given.
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
        let dhalf = self.backward_euler_by(half.mu, half.by_old, 0.5 * slip, 0.5 * dt, by);
        let excess = ((half.mu - self.mu_k) * self.per_mu_k).max(f64::EPSILON);
        let deficit = ((self.mu_s - half.mu) * self.per_mu_s).max(f64::EPSILON);
        let dexcess = (dhalf - half.mu * self.per_mu_k * by.mu_k) * self.per_mu_k;
        let ddeficit = (half.mu * self.per_mu_s * by.mu_s - dhalf) * self.per_mu_s;
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

    /// ∂μ of one backward-Euler step that ends with `mu`, `share` being ∂μ/∂μ₀.
    fn backward_euler_by(&self, mu: f64, share: f64, slip: f64, dt: f64, by: &PeakShift) -> f64 {
        let (x, y) = ((mu - self.mu_k) * self.per_mu_k, (self.mu_s - mu) * self.per_mu_s);
        let ((loss, loss_slope), (gain, gain_slope)) = (power(x, self.m), power(y, self.n));
        let dloss = scaled(loss_slope, -mu * self.per_mu_k * self.per_mu_k * by.mu_k) + logarithmic(loss, x) * by.m;
        let dgain = scaled(gain_slope, mu * self.per_mu_s * self.per_mu_s * by.mu_s) + logarithmic(gain, y) * by.n;
        share * (dt * (by.xi * gain + self.xi * dgain) - slip * (by.kappa * loss + self.kappa * dloss))
    }

    /// dμ after the time `dt` without plastic slip, where μ at the start varies by `dold` and the time by `ddt`.
    ///
    /// ```text
    /// d = 1 − μ/μ_s,   d^(1−n) = d₀^(1−n) + (n − 1) b,   b = ξ Δt/μ_s
    /// δd = (d/d₀)ⁿ δd₀ − dⁿ δb + ∂d/∂n δn,   ∂d/∂n = dⁿ (d^(1−n) ln d − d₀^(1−n) ln d₀ + b)/(1 − n)
    /// ```
    pub(super) fn rested_by(&self, old: f64, dt: f64, [dold, ddt]: [f64; 2], by: &PeakShift) -> f64 {
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

/// xᵏ ln x, the derivative of xᵏ by k; 0 at x = 0.
fn logarithmic(power: f64, x: f64) -> f64 {
    if x > 0.0 { power * x.ln() } else { 0.0 }
}
