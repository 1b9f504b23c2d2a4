//! When one step is right without its halves: a bound of its error.

use super::sub_step::{LoadPath, Station};

/// Share of the tolerance that q and μ p of a step taken alone may be off by: where halves begin, Newton's method meets a
/// jump, and this is far below what it has to resolve.
const SHARE: f64 = 0.01;

/// Most that the rate of plastic slip changes by within a step taken alone, relative: bounds from its ends need it steady.
const STEADY: f64 = 0.25;

/// What makes the rate of plastic slip at one end of a step.
struct Ends {
    /// p U μ, what R's approach adds to D = α_t + p (U μ − R κ (μ/μ_k − 1)) [F/L³]
    approach: f64,
    /// p R κ (μ/μ_k − 1), what weakening takes from it [F/L³]
    weakening: f64,
    /// R p ξ (1 − μ/μ_s) and R μ dp/dx: what recovery and pressure take from α_t du/dx, per x [F/L²]
    recovery: f64,
    pressing: f64,
    /// D [F/L³]
    stiffness: f64,
    /// α_t du/dx − recovery − pressing: D dλ/dx [F/L²]
    drive: f64,
    /// R [-]
    ratio: f64,
}

impl LoadPath<'_> {
    /// Whether one step over the whole path, with plastic slip, is right to the tolerance by itself.
    ///
    /// Where m = n = 1 its q and μ follow exactly from the plastic slip and the time, if these pass in step with one another:
    /// with λ/Δλ never further than w from x (a quarter of what its rate varies by), μ is right to a b (μ_s − μ_k) w, where a = κ Δλ/μ_k, b = ξ Δt/μ_s (the
    /// commutator of weakening and recovery), and q to α_t R p/D times this. The rate D dλ/dx = α_t du/dx − R (ξ (1 − μ/μ_s) p
    /// dt/dx + μ dp/dx) is made of terms that are monotone in the step, so that its ends bound w; it must be positive
    /// throughout. The mean of q is a trapezoidal rule, whose error the slopes at its ends bound.
    pub(super) fn is_right_alone(&self, from: &Station, to: &Station) -> bool {
        let slip = to.plastic_slip - from.plastic_slip;
        if !(self.evolution.is_linear() && slip > 0.0) {
            return false;
        }
        let (start, end) = (self.ends(from), self.ends(to));
        let (stiffness, drive) = (start.stiffness.min(end.stiffness), start.drive.min(end.drive));
        if !(stiffness > 0.0 && drive > 0.0) {
            return false;
        }
        let change = |part: fn(&Ends) -> f64| (part(&end) - part(&start)).abs();
        let unsteady = (change(|e| e.approach) + change(|e| e.weakening)) / stiffness
            + (change(|e| e.recovery) + change(|e| e.pressing)) / drive;
        if unsteady > STEADY {
            return false;
        }
        let pressure = self.pressures[1];
        let strength = self.tolerance * self.evolution.mu_s * pressure;
        let mu_error = 0.25 * unsteady * self.evolution.commutator(slip, self.time);
        let q_error = mu_error * pressure * (self.alpha_t / stiffness).max(1.0);
        q_error <= SHARE * strength && self.mean_error(from, to, &start, &end) <= strength
    }

    /// What makes the rate of plastic slip at a station.
    fn ends(&self, at: &Station) -> Ends {
        let (pressure, ratio) = (self.pressure(at.x), at.reach.ratio);
        let approach = pressure * at.reach.rate * at.mu;
        let weakening = pressure * ratio * self.evolution.weakening(at.mu);
        let recovery = ratio * pressure * self.evolution.recovery(at.mu) * self.time;
        let pressing = ratio * at.mu * (self.pressures[1] - self.pressures[0]);
        Ends {
            approach,
            weakening,
            recovery,
            pressing,
            stiffness: self.alpha_t + approach - weakening,
            drive: self.alpha_t * self.slip - recovery - pressing,
            ratio,
        }
    }

    /// Bound of the error of the mean of q, by which plastic slip is multiplied in the dissipation: a trapezoidal rule of f
    /// over the length L is off by at most L |f′(end) − f′(start)|/8 where f′ is monotone, taken part by part. The rule is for
    /// q over λ where q falls, else for μ p over ∫ R dλ (`mean_traction`).
    fn mean_error(&self, from: &Station, to: &Station, start: &Ends, end: &Ends) -> f64 {
        let slip = to.plastic_slip - from.plastic_slip;
        // R d(μ p)/dλ by weakening, recovery and pressure, and μ p dR/dλ
        let parts = |e: &Ends| {
            let per_rate = e.stiffness / e.drive;
            [e.weakening, e.recovery * per_rate, e.pressing * per_rate, e.approach]
        };
        let (start_parts, end_parts) = (parts(start), parts(end));
        let falls = to.traction < from.traction;
        let change = |i: usize, per: [f64; 2]| (end_parts[i] / per[1] - start_parts[i] / per[0]).abs();
        let bend: f64 = if falls {
            (0..4).map(|i| change(i, [1.0, 1.0])).sum()
        } else {
            let squares = [start.ratio * start.ratio, end.ratio * end.ratio];
            end.ratio * end.ratio * (0..3).map(|i| change(i, squares)).sum::<f64>()
        };
        0.125 * slip * bend
    }
}
