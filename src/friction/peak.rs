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
    /// μ_s: static coefficient [-]
    pub mu_s: f64,
    /// μ_k: kinetic coefficient [-]
    pub mu_k: f64,
    /// κ: weakening with plastic slip [1/L]
    pub kappa: f64,
    /// m: exponent of weakening [-]
    pub m: f64,
    /// ξ: recovery with time [1/T]
    pub xi: f64,
    /// n: exponent of recovery [-]
    pub n: f64,
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
    /// μ after plastic slip `slip` and time `dt`, from `old`.
    ///
    /// ```text
    /// μ = μ₀ − κ Δλ (μ/μ_k − 1)^m + ξ Δt (1 − μ/μ_s)^n
    /// ```
    pub(super) fn after(&self, old: f64, slip: f64, dt: f64) -> Peak {
        let Self { mu_s, mu_k, kappa, m, xi, n } = *self;
        let (weakening, recovery) = (kappa * slip, xi * dt);
        let mu = if m == 1.0 && n == 1.0 {
            (old + weakening + recovery) / (1.0 + weakening / mu_k + recovery / mu_s)
        } else {
            self.solve(old, weakening, recovery)
        };
        let mu = mu.clamp(mu_k, mu_s);
        let (loss, loss_slope) = power(mu / mu_k - 1.0, m);
        let (_, gain_slope) = power(1.0 - mu / mu_s, n);
        Peak {
            mu,
            loss: kappa * loss,
            loss_slope: scaled(loss_slope, kappa / mu_k),
            gain_slope: scaled(gain_slope, recovery / mu_s),
            slip,
        }
    }

    /// Root of the backward-Euler equation for exponents other than 1.
    fn solve(&self, old: f64, weakening: f64, recovery: f64) -> f64 {
        let Self { mu_s, mu_k, m, n, .. } = *self;
        let mut mu = old;
        bracketed_newton((mu_k, mu_s), old, f64::EPSILON * mu_k, |trial| {
            mu = trial;
            let (loss, loss_slope) = power(mu / mu_k - 1.0, m);
            let (gain, gain_slope) = power(1.0 - mu / mu_s, n);
            let value = old - mu - weakening * loss + recovery * gain;
            let slope = -1.0 - scaled(loss_slope, weakening / mu_k) - scaled(gain_slope, recovery / mu_s);
            (value, slope)
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
