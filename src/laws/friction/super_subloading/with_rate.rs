//! Increments of a law with a direct effect of the rate: extrapolated from steps of first order, with error control.

use super::SuperSubloading;
use super::direct::DirectEffect;
use super::increment::{LoadPath, PathState};
use crate::laws::dual::{Dual, Number};
use crate::laws::friction::LawFailure;
use crate::laws::friction::extrapolation::{FirstOrder, changes, largest_share, share};

/// Error of a sub-step in tolerances of the law: the errors of several sum to at most one.
const SHARE: f64 = 0.05;

/// Relative round-off; errors below are ignored.
const NOISE: f64 = 1e-12;

/// Decrease of ln(1 + λ/V₀) that the rows of a sub-step resolve.
const RESOLVED: f64 = 2.0;

/// Quantities that are extrapolated: q, μ, R, plastic slip, ∫ q du and the weighed slip
const ENTRIES: usize = 6;

impl LoadPath<'_> {
    /// State at the end of a path along which strength depends on the rate.
    ///
    /// # Errors
    /// Returns [`LawFailure::NotConverged`] if sub-steps do not converge.
    pub(super) fn end_with_rate(&mut self, start: &PathState) -> Result<PathState, LawFailure> {
        FirstOrder::end(self, start)
    }

    /// Plastic slip at the start of a sub-step that none of its rows resolves: unloading or healing lets its rate decay by
    /// |q|/(a R μ p), or ends it before the end of the shortest row, and the traction above R μ p is all that it can release.
    fn decayed(&self, direct: &DirectEffect, [from, to]: [&PathState; 2], step: u64) -> f64 {
        let before = from.mu.value * from.ratio.value * self.pressure_at(from);
        let after = to.mu.value * from.ratio.value * self.pressure_at(to);
        let trial = from.traction.value + self.law.alpha_t * self.slip.value * share(step);
        let level = from.traction.value / before;
        let fall = (level - trial / after) / direct.a;
        let ends = to.plastic_slip == from.plastic_slip;
        // From where R = 0 no traction falls.
        if !(level > 1.0 && (fall > RESOLVED || ends && fall > 0.0)) {
            return 0.0;
        }
        let while_it_lasts = (((level - 1.0) / direct.a).min(1.0) / fall).min(1.0);
        let slip = direct.rate(level) * self.time.value * share(step) * while_it_lasts;
        slip.min((from.traction.value - before) / self.law.alpha_t)
    }

    fn tolerance(&self) -> f64 {
        SHARE * self.law.tolerance
    }
}

impl FirstOrder<ENTRIES> for LoadPath<'_> {
    type State = PathState;

    fn increments(&mut self, from: &PathState, at: u64, step: u64, count: usize) -> Result<PathState, LawFailure> {
        let mut state = *from;
        let mut overlooked = 0.0;
        for i in 1..=count {
            let x = if i == count { share(at + step) } else { share(at) + share(step) * i as f64 / count as f64 };
            state = self.advance(&state, x)?;
            overlooked += state.overlooked;
        }
        Ok(PathState { overlooked, ..state })
    }

    fn entry(&self, state: &PathState) -> [Dual; ENTRIES] {
        let PathState { traction, mu, ratio, plastic_slip, weighed_slip, .. } = *state;
        [traction, mu, ratio, plastic_slip.into(), self.energy(state).into(), weighed_slip]
    }

    fn state(&self, entry: &[Dual; ENTRIES], fine: PathState) -> PathState {
        let [traction, mu, ratio, plastic_slip, energy, weighed_slip] = *entry;
        let (traction, mu) = (traction.max(0.0.into()), self.varied.evolution.clamp(mu));
        let ratio = ratio.max(0.0.into()).min(1.0.into()).min(traction / (mu * self.pressure(fine.x.into())));
        PathState {
            traction,
            mu,
            ratio,
            curve_point: self.law.curve.start(ratio.value),
            plastic_slip: plastic_slip.value,
            weighed_slip,
            work: energy.value - 0.5 * traction.value * traction.value / self.law.alpha_t,
            overlooked: 0.0,
            ..fine
        }
    }

    fn error(&self, entries: [&[Dual; ENTRIES]; 2], factor: f64, ends: [&PathState; 2], step: u64) -> f64 {
        let [from, to] = ends;
        let SuperSubloading { alpha_t, evolution, direct, .. } = self.law;
        let [traction, mu, ratio, _, energy, _] = changes(entries, factor);
        let decayed = direct.map_or(0.0, |direct| self.decayed(&direct, ends, step));
        let tolerance = self.tolerance() * evolution.mu_s;
        let strength = tolerance * self.pressure_at(from).max(self.pressure_at(to));
        let slip = self.slip.value.abs() * share(step) + to.plastic_slip - from.plastic_slip;
        let noise = NOISE * (alpha_t * self.slip.value.abs() * share(step) + from.traction.value);
        largest_share([
            [traction + alpha_t * decayed + to.overlooked, strength + noise],
            [mu + evolution.weakening(to.mu.value) * decayed, tolerance + NOISE * evolution.mu_s],
            [ratio + to.curve_point.rate * decayed, self.tolerance() + NOISE],
            [energy, strength / SHARE * slip + NOISE * entries[0][4].value.abs()],
        ])
    }

    fn drive(&self, from: &PathState, step: u64) -> f64 {
        let SuperSubloading { alpha_t, evolution, .. } = self.law;
        let change = alpha_t * self.slip.value.abs() + evolution.mu_s * self.pressure_change().abs();
        let most = self.pressures[1].value.max(self.pressure_at(from));
        share(step) * change / (self.tolerance() * evolution.mu_s * most)
    }

    fn failure(&self, from: &PathState, step: u64) -> LawFailure {
        let trial = (from.traction.value + self.law.alpha_t * self.slip.value * share(step)).abs();
        LawFailure::NotConverged { evaluations: self.evaluations, rest: trial, trial }
    }
}
