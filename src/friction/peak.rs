//! How the peak coefficient μ weakens with slip and recovers with time.

use super::root::bracketed_newton;

/// Weakening and recovery of the peak coefficient μ between μ_k and μ_s.
///
/// ```text
/// μ̇ = −κ (μ/μ_k − 1)^m λ + ξ (1 − μ/μ_s)^n
/// ```
/// One increment is a backward-Euler step, with and without plastic slip: sticking (Δλ = 0) is then the limit of
/// slipping, and steady sliding is met exactly at any increment length. Its equation has one root in [μ_k, μ_s].
#[derive(Clone, Copy, Debug)]
pub(super) struct Evolution {
    mu_s: f64,
    pub(super) mu_k: f64,
    kappa: f64,
    xi: f64,
    m: f64,
    n: f64,
    /// 1/μ_s and 1/μ_k: divisions are what an evaluation would spend most of its time on.
    per_mu_s: f64,
    per_mu_k: f64,
}

/// μ at the end of an increment with plastic slip Δλ, and what its change with Δλ is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peak {
    /// μ [-]
    pub mu: f64,
    /// κ (μ/μ_k − 1)^m: weakening per plastic slip [1/L]
    loss: f64,
    /// ∂loss/∂μ [1/L]
    loss_slope: f64,
    /// −Δt ∂(recovery)/∂μ [-]
    gain_slope: f64,
    /// Δλ: plastic slip [L]
    slip: f64,
}

impl Evolution {
    /// μ_s, μ_k [-], κ [1/L], ξ [1/T], m and n [-]
    pub(super) fn new(mu_s: f64, mu_k: f64, kappa: f64, xi: f64, m: f64, n: f64) -> Self {
        Self { mu_s, mu_k, kappa, xi, m, n, per_mu_s: 1.0 / mu_s, per_mu_k: 1.0 / mu_k }
    }

    /// μ as it may be: between μ_k and μ_s.
    pub(super) fn clamp(&self, mu: f64) -> f64 {
        mu.clamp(self.mu_k, self.mu_s)
    }

    /// μ after plastic slip `slip` and time `dt`, from `old`.
    ///
    /// ```text
    /// μ = μ₀ − κ Δλ (μ/μ_k − 1)^m + ξ Δt (1 − μ/μ_s)^n
    /// ```
    pub(super) fn after(&self, old: f64, slip: f64, dt: f64) -> Peak {
        let (weakening, recovery) = (self.kappa * slip, self.xi * dt);
        let mu = self.clamp(if self.m == 1.0 && self.n == 1.0 {
            (old + weakening + recovery) / (1.0 + weakening * self.per_mu_k + recovery * self.per_mu_s)
        } else {
            self.solve(old, weakening, recovery)
        });
        let ((loss, loss_slope), (_, gain_slope)) = (self.loss(mu), self.gain(mu));
        let stiffening = scaled(loss_slope, self.kappa);
        Peak { mu, loss: self.kappa * loss, loss_slope: stiffening, gain_slope: scaled(gain_slope, recovery), slip }
    }

    /// (μ/μ_k − 1)^m and its derivative.
    fn loss(&self, mu: f64) -> (f64, f64) {
        let (value, slope) = power((mu - self.mu_k) * self.per_mu_k, self.m);
        (value, slope * self.per_mu_k)
    }

    /// (1 − μ/μ_s)^n and minus its derivative.
    fn gain(&self, mu: f64) -> (f64, f64) {
        let (value, slope) = power((self.mu_s - mu) * self.per_mu_s, self.n);
        (value, slope * self.per_mu_s)
    }

    /// Root of the backward-Euler equation for exponents other than 1.
    fn solve(&self, old: f64, weakening: f64, recovery: f64) -> f64 {
        let mut mu = old;
        bracketed_newton((self.mu_k, self.mu_s), old, f64::EPSILON * self.mu_k, |trial| {
            mu = trial;
            let ((loss, loss_slope), (gain, gain_slope)) = (self.loss(mu), self.gain(mu));
            let value = old - mu - weakening * loss + recovery * gain;
            (value, -1.0 - scaled(loss_slope, weakening) - scaled(gain_slope, recovery))
        });
        mu
    }
}

impl Peak {
    /// ∂μ/∂Δλ ≤ 0 [1/L]
    pub(super) fn slope(&self) -> f64 {
        -self.loss / (1.0 + self.loss_stiffness(self.loss_slope) + self.gain_slope)
    }

    /// Largest |∂μ/∂Δλ| that any further plastic slip can have [1/L]
    pub(super) fn steepest(&self) -> f64 {
        self.loss
    }

    /// Least and greatest |∂μ/∂Δλ| between this point and one with more plastic slip [1/L]
    pub(super) fn steepness_until(&self, later: &Self) -> (f64, f64) {
        let flattest =
            1.0 + later.loss_stiffness(self.loss_slope.max(later.loss_slope)) + self.gain_slope.max(later.gain_slope);
        let steepest =
            1.0 + self.loss_stiffness(self.loss_slope.min(later.loss_slope)) + self.gain_slope.min(later.gain_slope);
        (later.loss / flattest, self.loss / steepest)
    }

    fn loss_stiffness(&self, loss_slope: f64) -> f64 {
        scaled(loss_slope, self.slip)
    }
}

/// x^k and its derivative, which is infinite at x = 0 for k < 1.
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

/// A slope times a factor; a term without a factor counts for nothing even where its slope is infinite.
fn scaled(slope: f64, factor: f64) -> f64 {
    if factor > 0.0 { slope * factor } else { 0.0 }
}
