//! Rate-and-state friction along a prescribed path by explicit steps, where it follows the path slowly enough: rows of a record are then a
//! step each.
//!
//! ```text
//! q̇ = α_t (v − V),   ẋ = ẋ(V, x),   V = 2 V₀ e^(−ψ/a) sinh(q/(a p)),   p linear in time,   x = ln(V₀ θ/D_c)
//! ```

use super::LARGE;
use super::path::{PathState, RESOLVED, Ramp, TOLERANCE};
use super::relaxation::{Effect, StateEvolution};
use crate::laws::dual::{Dual, Number};
use crate::laws::friction::FrictionState;
use crate::laws::friction::extrapolation::largest_share;
use crate::laws::tableau::{A, C, E, STAGES};

/// q, ln(V₀ θ/D_c) of the states, and the work ∫ q du.
type Point = [Dual; 4];

/// The larger of α_t V Δt/(a p) and V Δt/D_c, by how many factors of e spring and states may change within an increment, above which implicit steps are cheaper ...
const STIFF: f64 = 4.0;

/// ... and the same of a step, up to which not only its values but also their derivatives are right.
const SLACK: f64 = 0.75;

/// Tolerance as a share of that of extrapolated steps.
const TIGHTER: f64 = 0.25;

/// Steps tried before implicit ones take over.
const MOST_ATTEMPTS: usize = 40;

/// Safety factor on the length that the error allows, and the smallest and largest ratio of successive lengths.
const SAFETY: f64 = 0.9;
const SHARES: [f64; 2] = [0.1, 5.0];

impl Ramp<'_> {
    /// State at the end of the increment; `None` where surfaces part, or implicit steps are better.
    pub(super) fn explicit_end(&mut self) -> Option<PathState> {
        let start = self.start.clone();
        if !(self.least_pressure() > 0.0 && self.inputs.dt > 0.0) {
            return None;
        }
        let [log, second] = self.coefficients.log_states(start.theta);
        let mut y = [start.traction, log, second, 0.0.into()];
        let mut rates = self.rates_at(0.0, &y);
        let slack = self.slack(self.slip_in(&rates).abs().max(self.inputs.slip.value.abs()));
        if slack > STIFF || slack.is_nan() {
            return None;
        }
        let (mut at, mut step) = (0.0, 1.0f64);
        for _ in 0..MOST_ATTEMPTS {
            let whole = at + step >= 1.0;
            let h = if whole { 1.0 - at } else { step };
            let (next, last, error) = self.step(at, h, &y, &rates);
            let slack = h * self.slack(self.slip_in(&rates).abs().max(self.slip_in(&last).abs()));
            if slack > SLACK {
                step = h * (SAFETY * SLACK / slack).max(SHARES[0]);
                continue;
            }
            if error > 1.0 || error.is_nan() {
                step = h * (SAFETY * error.powf(-0.2)).max(SHARES[0]);
                continue;
            }
            (y, rates) = (next, last);
            if whole {
                return Some(self.arrived(y));
            }
            at += h;
            step = h * (SAFETY * error.powf(-0.2).min(SLACK / slack)).clamp(SHARES[0], SHARES[1]);
        }
        None
    }

    /// One step from a fraction of the increment on: where it ends, the rates there, and its error in tolerances.
    fn step(&mut self, at: f64, h: f64, y: &Point, first: &Point) -> (Point, Point, f64) {
        let mut stages = [*first; STAGES];
        let mut end = *y;
        for stage in 1..STAGES {
            end = *y;
            for (a, rates) in A[stage].iter().zip(&stages).filter(|(a, _)| **a != 0.0) {
                (0..4).for_each(|i| end[i] = end[i] + rates[i] * (a * h));
            }
            stages[stage] = self.rates_at(at + C[stage] * h, &end);
        }
        let error = |i: usize| h * E.iter().zip(&stages).map(|(e, rates)| e * rates[i].value).sum::<f64>().abs();
        let (last, law) = (stages[STAGES - 1], &self.law.coefficients);
        let [before, after] = [at, at + h].map(|at| self.pressure(at).value);
        let strength = law.f_0 * before.max(after);
        // Slip that has ended between the stages: V decays by the fall of q/(a p).
        let fall = (y[0].value / before - end[0].value / after) / law.a * y[0].value.signum();
        let hidden = if fall > RESOLVED { (h * self.slip_in(first)).abs() / fall } else { 0.0 };
        let traction = (error(0) + law.alpha_t * hidden) / strength;
        let states = law.each(|k, Effect { b, critical_slip }| {
            (law.a + b.abs()) * (error(1 + k) + hidden / critical_slip) / law.f_0
        });
        let slip = h * (self.inputs.slip.value.abs() + self.slip_in(first).abs().max(self.slip_in(&last).abs()));
        let work = if slip > 0.0 { error(3) / (strength * slip) } else { 0.0 };
        let allowed = TIGHTER * TOLERANCE;
        (end, last, largest_share([traction, states[0], states[1], work].map(|error| [error, allowed])))
    }

    /// The smaller pressure of start and end.
    fn least_pressure(&self) -> f64 {
        self.start.state.pressure.min(self.inputs.pressure.value)
    }

    /// The larger of α_t V Δt/(a p) and V Δt/D_c, of a slip V Δt.
    fn slack(&self, slip: f64) -> f64 {
        let law = &self.law.coefficients;
        let spring = law.alpha_t / (law.a * self.least_pressure());
        slip * law.effects().iter().map(|effect| 1.0 / effect.critical_slip).fold(spring, f64::max)
    }

    /// p at a fraction of the increment.
    fn pressure(&self, at: f64) -> Dual {
        self.inputs.pressure * at + (1.0 - at) * self.start.state.pressure
    }

    /// V Δt of rates.
    fn slip_in(&self, rates: &Point) -> f64 {
        self.inputs.slip.value - rates[0].value / self.law.coefficients.alpha_t
    }

    /// Rates at a fraction of the increment, times its length.
    fn rates_at(&mut self, at: f64, y: &Point) -> Point {
        self.evaluations += 1;
        let (law, dt) = (&self.coefficients, self.inputs.dt);
        let logs = [y[1], y[2]];
        let (level, exponent) = (y[0] / (law.a * self.pressure(at)), law.psi(logs) / law.a);
        let size = level * level.value.signum();
        let rate = match size.value > LARGE {
            true => law.reference_rate * (size - exponent).exp(),
            false => {
                let sinh = size.map(size.value.sinh(), size.value.cosh());
                law.reference_rate * 2.0 * (exponent * -1.0).exp() * sinh
            }
        };
        let states = law.each(|k, &Effect { critical_slip, .. }| match law.evolution {
            StateEvolution::Ageing => (law.reference_rate * (logs[k] * -1.0).exp() - rate) * dt / critical_slip,
            StateEvolution::Slip if rate.value == 0.0 => 0.0.into(),
            StateEvolution::Slip => rate * (logs[k] + (rate / law.reference_rate).ln()) * -dt / critical_slip,
        });
        let slipped = rate * (dt * level.value.signum());
        [law.alpha_t * (self.inputs.slip - slipped), states[0], states[1], y[0] * self.inputs.slip.value]
    }

    /// The state where the path has come to.
    fn arrived(&self, [traction, log, second, work]: Point) -> PathState {
        let (start, alpha_t) = (&self.start.state, self.law.coefficients.alpha_t);
        let theta = self.coefficients.theta([log, second]);
        let stored = |q: f64| q * q / (2.0 * alpha_t);
        let slipped = self.inputs.slip.value - (traction.value - start.traction) / alpha_t;
        let dissipated = work.value - stored(traction.value) + stored(start.traction);
        let state = FrictionState {
            traction: traction.value,
            pressure: self.inputs.pressure.value,
            plastic_slip: start.plastic_slip + slipped,
            dissipation: start.dissipation + dissipated.max(0.0),
            ..start.clone()
        };
        PathState { state: state.with_variables(theta.map(|theta| theta.value)), traction, theta }
    }
}
