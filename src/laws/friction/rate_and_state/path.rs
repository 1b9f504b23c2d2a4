//! Rate-and-state friction along a prescribed path: error-controlled increments of slip and pressure linear in time.

use super::RateAndState;
use super::relaxation::{Coefficients, Effect, Relaxation};
use crate::laws::dual::{Dual, Number};
use crate::laws::friction::extrapolation::{FirstOrder, WHOLE, changes, largest_share, share};
use crate::laws::friction::sensitivity::Inputs;
use crate::laws::friction::{
    Answer, FrictionResponse, FrictionState, LawFailure, PointLoad, RateLaw, Regime, Sliding, States,
};

/// Tolerance of a sub-step in |q| and in the mean of q over the slip, relative to f₀ p, and in (a + b) ln θ of every state, relative to f₀:
/// the errors of several, and of their initial values, sum to at most 1e-6.
pub(super) const TOLERANCE: f64 = 2e-7;

/// Relative round-off; errors below are ignored.
const NOISE: f64 = 2e-13;

/// Decrease of |q|/(a p) that the rows or stages of a sub-step resolve.
pub(super) const RESOLVED: f64 = 2.0;

/// State at an integration point along the path, with the derivatives of its traction and θ.
#[derive(Clone)]
pub(super) struct PathState {
    pub state: FrictionState,
    pub traction: Dual,
    pub theta: States<Dual>,
}

/// An increment whose slip and pressure are linear in time.
pub(super) struct Ramp<'a> {
    pub law: &'a RateAndState,
    pub coefficients: Coefficients<Dual>,
    pub start: PathState,
    pub inputs: Inputs,
    /// Number of evaluations of the law's equation so far
    pub evaluations: usize,
}

impl<'a> Ramp<'a> {
    pub(super) fn new(law: &'a RateAndState, old: &FrictionState, inputs: Inputs) -> Self {
        let start =
            PathState { state: old.clone(), traction: inputs.traction, theta: [inputs.variable, inputs.second] };
        Self { law, coefficients: law.coefficients.along(&inputs), start, inputs, evaluations: 0 }
    }

    /// Response at the end of the increment; the derivatives are those of the consistent tangent.
    pub(super) fn answer(mut self) -> Answer {
        let old = self.start.state.clone();
        let PathState { state, traction, .. } = self.end_of_path()?;
        let regime = match state.pressure > 0.0 {
            true => RateLaw::regime(self.law, self.law.evolving(&state), self.rate(&state)),
            false => Regime::Open,
        };
        FrictionResponse {
            state: FrictionState { plastic_increment: state.plastic_slip - old.plastic_slip, regime, ..state },
            dtraction_dslip: traction.by[0],
            dtraction_dpressure: traction.by[1],
            evaluations: self.evaluations,
            ..Default::default()
        }
        .checked(self.law.coefficients.alpha_t)
    }

    /// State after one increment of first order.
    ///
    /// # Errors
    /// The same as for the response.
    pub(super) fn single(&mut self) -> Result<PathState, LawFailure> {
        let start = self.start.clone();
        self.increments(&start, 0, WHOLE, 1)
    }

    /// State at the end of the increment, with its error controlled.
    ///
    /// # Errors
    /// The same as for the response.
    pub(super) fn end_of_path(&mut self) -> Result<PathState, LawFailure> {
        if let Some(end) = self.explicit_end() {
            return Ok(end);
        }
        let start = self.start.clone();
        self.end(&start)
    }

    fn rate(&self, state: &FrictionState) -> f64 {
        let loading = PointLoad { traction: state.traction, pressure: state.pressure, damping: 0.0 };
        self.law.slip_rate(self.law.evolving(state), loading)
    }
}

impl FirstOrder<5> for Ramp<'_> {
    type State = PathState;

    /// A sub-step by `count` increments.
    fn increments(&mut self, from: &PathState, at: u64, step: u64, count: usize) -> Result<PathState, LawFailure> {
        let Inputs { slip, pressure, dt, .. } = self.inputs;
        let law = self.coefficients;
        let mut path_state = from.clone();
        for i in 1..=count {
            let part = share(step) / count as f64;
            let x = if i == count { share(at + step) } else { share(at) + i as f64 * part };
            let (slip, dt) = (slip * part, dt * part);
            let pressure = pressure * x + (1.0 - x) * self.start.state.pressure;
            let old = path_state;
            let (answer, found) = self.law.relax(&old.state, Sliding::new(slip.value, pressure.value, dt))?;
            self.evaluations += answer.evaluations;
            let trial = old.traction + law.alpha_t * slip;
            let (traction, theta) = match found {
                Some(slip) => {
                    let sign = trial.value.signum();
                    let log_states = law.log_states(old.theta);
                    let relaxation = Relaxation { law: &law, trial: trial * sign, pressure, dt, log_states };
                    let (traction, theta) = relaxation.end(slip);
                    (traction * sign, theta)
                }
                None if pressure.value <= 0.0 => (0.0.into(), old.theta),
                None => (trial * (answer.dtraction_dslip / law.alpha_t.value), old.theta),
            };
            let state = answer.state;
            let traction = traction.map(state.traction, 1.0);
            let theta = std::array::from_fn(|k| theta[k].map(state.variables[k], 1.0));
            path_state = PathState { state, traction, theta };
        }
        Ok(path_state)
    }

    /// q, ln θ of the states, plastic slip, and the work ∫ q du = W + q²/(2 α_t), of which all but the last two have derivatives
    fn entry(&self, PathState { state, traction, theta }: &PathState) -> [Dual; 5] {
        let work = state.dissipation + 0.5 * state.traction * state.traction / self.law.coefficients.alpha_t;
        let [log, second] = self.coefficients.each(|k, _| theta[k].ln());
        [*traction, log, second, state.plastic_slip.into(), work.into()]
    }

    fn state(&self, &[traction, log, second, plastic_slip, work]: &[Dual; 5], fine: PathState) -> PathState {
        let theta = self.coefficients.each(|k, _| [log, second][k].exp());
        let stored = 0.5 * traction.value * traction.value / self.law.coefficients.alpha_t;
        let (plastic_slip, dissipation) = (plastic_slip.value, work.value - stored);
        let state = FrictionState { traction: traction.value, plastic_slip, dissipation, ..fine.state };
        PathState { state: state.with_variables(theta.map(|theta| theta.value)), traction, theta }
    }

    fn error(&self, entries: [&[Dual; 5]; 2], factor: f64, [from, to]: [&PathState; 2], step: u64) -> f64 {
        let law = &self.law.coefficients;
        let [traction, log, second, _, work] = changes(entries, factor);
        let strength = law.f_0 * from.state.pressure.max(to.state.pressure);
        let slip = self.inputs.slip.value.abs() * share(step) + (to.state.plastic_slip - from.state.plastic_slip).abs();
        let loaded = law.alpha_t * self.inputs.slip.value.abs() * share(step);
        let noise = NOISE / TOLERANCE;
        let overlooked = self.overlooked(&from.state, &to.state, step);
        let states = law
            .each(|k, Effect { b, critical_slip }| (law.a + b.abs()) * ([log, second][k] + overlooked / critical_slip));
        let allowed = |of: f64| TOLERANCE * of;
        largest_share([
            [traction + law.alpha_t * overlooked, allowed(strength + noise * loaded)],
            [states[0], allowed(law.f_0)],
            [states[1], allowed(law.f_0)],
            [work, allowed(strength * slip + noise * entries[0][4].value.abs())],
        ])
    }

    fn drive(&self, from: &PathState, step: u64) -> f64 {
        let change = self.law.coefficients.alpha_t * self.inputs.slip.value.abs()
            + self.law.coefficients.f_0 * (self.inputs.pressure.value - self.start.state.pressure).abs();
        let most = self.inputs.pressure.value.max(from.state.pressure);
        share(step) * change / (TOLERANCE * self.law.coefficients.f_0 * most)
    }

    fn failure(&self, from: &PathState, step: u64) -> LawFailure {
        let loaded = self.law.coefficients.alpha_t * self.inputs.slip.value * share(step);
        let trial = (from.state.traction + loaded).abs();
        LawFailure::NotConverged { evaluations: self.evaluations, rest: trial, trial }
    }
}

impl Ramp<'_> {
    /// Slip at the start of a sub-step with unloading that none of its rows resolves: V decays by |q|/(a
    /// p).
    fn overlooked(&self, from: &FrictionState, to: &FrictionState, step: u64) -> f64 {
        if from.pressure <= 0.0 || to.pressure <= 0.0 {
            return 0.0;
        }
        let level = |state: &FrictionState| state.traction / (self.law.coefficients.a * state.pressure);
        let fall = (level(from) - level(to)) * from.traction.signum();
        if fall > RESOLVED { self.rate(from).abs() * self.inputs.dt * share(step) / fall } else { 0.0 }
    }
}
