//! Rate-and-state friction along a prescribed path: error-controlled increments of slip and pressure linear in time.

use super::RateAndState;
use super::relaxation::{Coefficients, Relaxation};
use crate::laws::dual::{Dual, Number};
use crate::laws::friction::sensitivity::Inputs;
use crate::laws::friction::{Answer, FrictionResponse, FrictionState, LawFailure, PointLoad, RateLaw, Regime, Sliding};

/// Tolerance of a sub-step in |q| and in the mean of q over the slip, relative to f₀ p, and in (a + b) ln θ, relative to f₀:
/// the errors of several, and of their initial values, sum to at most 1e-6.
const TOLERANCE: f64 = 2e-7;

/// Number of the shortest sub-steps in an increment.
const WHOLE: u64 = 1 << 40;

/// Length of sub-steps that may contain a jump, if slip and pressure have almost no effect in them ...
const SHORT: u64 = 1 << 10;

/// ... defined by this fraction of the tolerance in the tractions.
const SNAP: f64 = 1e-3;

/// Maximum number of sub-steps tried before an increment is rejected as far too long.
const MOST_ATTEMPTS: usize = 20_000;

/// Maximum number of extrapolation rows: a sub-step is integrated by 1, 2, ... increments of first order.
const MOST_ROWS: usize = 4;

/// Errors of 2, 3 and 4 rows, in tolerances, above which further rows are not sufficient.
const HOPELESS: [f64; MOST_ROWS] = [f64::INFINITY, 1e4, 1e2, 1.0];

/// Error, in tolerances, below which the next sub-step may be twice as long.
const DOUBLED: f64 = 0.1;

/// Relative round-off; errors below are ignored.
const NOISE: f64 = 2e-13;

/// Decrease of |q|/(a p) that the rows of a sub-step resolve.
const RESOLVED: f64 = 2.0;

/// q, ln θ, plastic slip, and the work ∫ q du = W + q²/(2 α_t), of which the first two have derivatives
type Entry = [Dual; 4];

/// State at an integration point along the path, with the derivatives of its traction and θ.
#[derive(Clone)]
pub(super) struct PathState {
    state: FrictionState,
    pub traction: Dual,
    pub theta: Dual,
}

/// An increment whose slip and pressure are linear in time.
pub(super) struct Ramp<'a> {
    law: &'a RateAndState,
    coefficients: Coefficients<Dual>,
    start: PathState,
    inputs: Inputs,
    /// Number of evaluations of the law's equation so far
    evaluations: usize,
}

impl<'a> Ramp<'a> {
    pub(super) fn new(law: &'a RateAndState, old: &FrictionState, inputs: Inputs) -> Self {
        let start = PathState { state: old.clone(), traction: inputs.traction, theta: inputs.variable };
        Self { law, coefficients: law.coefficients.along(&inputs), start, inputs, evaluations: 0 }
    }

    /// Response at the end of the increment; the derivatives are those of the consistent tangent.
    pub(super) fn answer(mut self) -> Answer {
        let old = self.start.state.clone();
        let PathState { state, traction, .. } = self.end()?;
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

    fn rate(&self, state: &FrictionState) -> f64 {
        let loading = PointLoad { traction: state.traction, pressure: state.pressure, damping: 0.0 };
        self.law.slip_rate(self.law.evolving(state), loading)
    }

    /// State at the end: sub-steps are halved until their error is below the tolerance, and doubled where possible.
    pub(super) fn end(&mut self) -> Result<PathState, LawFailure> {
        let (mut path_state, mut at, mut step) = (self.start.clone(), 0, WHOLE);
        for _ in 0..MOST_ATTEMPTS {
            let (next, error) = match self.extrapolated(&path_state, at, step) {
                Ok(found) => found,
                Err(_) if step > 1 => {
                    step /= 2;
                    continue;
                }
                Err(failure) => return Err(failure),
            };
            let snaps = step <= SHORT && self.drive(&path_state, step) <= SNAP;
            if error > 1.0 && !snaps || error.is_nan() {
                if step == 1 {
                    break;
                }
                step /= 2;
                continue;
            }
            (path_state, at) = (next, at + step);
            if at == WHOLE {
                return Ok(path_state);
            }
            if (error <= DOUBLED || snaps) && at % (2 * step) == 0 {
                step *= 2;
            }
        }
        let trial =
            (path_state.state.traction + self.law.coefficients.alpha_t * self.inputs.slip.value * share(step)).abs();
        Err(LawFailure::NotConverged { evaluations: self.evaluations, rest: trial, trial })
    }

    /// Maximum change of tractions by slip and pressure over a sub-step without a jump, in tolerances.
    fn drive(&self, from: &PathState, step: u64) -> f64 {
        let change = self.law.coefficients.alpha_t * self.inputs.slip.value.abs()
            + self.law.coefficients.f_0 * (self.inputs.pressure.value - self.start.state.pressure).abs();
        let most = self.inputs.pressure.value.max(from.state.pressure);
        share(step) * change / (TOLERANCE * self.law.coefficients.f_0 * most)
    }

    /// State at the end of a sub-step, and its error in tolerances.
    ///
    /// ```text
    /// T_j1: the sub-step by j increments of first order,   T_j,k+1 = T_jk + (T_jk − T_j−1,k)/(j/(j − k) − 1)
    /// ```
    /// T_jj is of order j, and its difference from T_j,j−1 bounds its error. Across a jump no extrapolation is made: the result
    /// of the finest row is used.
    ///
    /// Source: Deuflhard (1985), SIAM Review 27, 505; Hairer & Wanner, Solving Ordinary Differential Equations II, IV.9.
    fn extrapolated(&mut self, from: &PathState, at: u64, step: u64) -> Result<(PathState, f64), LawFailure> {
        let (mut rows, mut error): (Vec<Entry>, f64) = (Vec::with_capacity(MOST_ROWS), f64::INFINITY);
        let mut fine = from.clone();
        for j in 1..=MOST_ROWS {
            fine = self.increments(from, at, step, j)?;
            let mut entry = self.entry(&fine);
            let mut row = vec![entry];
            for (k, above) in rows.iter().enumerate() {
                let factor = 1.0 / (j as f64 / (j - k - 1) as f64 - 1.0);
                error = self.error(&entry, above, factor, [from, &fine], step);
                entry = [0, 1, 2, 3].map(|i| entry[i] + (entry[i] - above[i]) * factor);
                row.push(entry);
            }
            rows = row;
            if j > 1 && error <= 1.0 {
                return Ok((self.path_state(&entry, fine), error));
            }
            if error > HOPELESS[j - 1] && step > SHORT {
                break;
            }
        }
        Ok((fine, error))
    }

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
                    let log_state = law.log_state(old.theta);
                    let end = Relaxation { law: &law, trial: trial * sign, pressure, dt, log_state }.end(slip);
                    (end[0] * sign, end[1])
                }
                None if pressure.value <= 0.0 => (0.0.into(), old.theta),
                None => (trial * (answer.dtraction_dslip / law.alpha_t.value), old.theta),
            };
            let state = answer.state;
            let (traction, theta) = (traction.map(state.traction, 1.0), theta.map(state.variables[0], 1.0));
            path_state = PathState { state, traction, theta };
        }
        Ok(path_state)
    }

    fn entry(&self, PathState { state, traction, theta }: &PathState) -> Entry {
        let work = state.dissipation + 0.5 * state.traction * state.traction / self.law.coefficients.alpha_t;
        [*traction, theta.ln(), state.plastic_slip.into(), work.into()]
    }

    /// State at the end of a sub-step represented by an entry; `fine` is located there too.
    fn path_state(&self, &[traction, log_theta, plastic_slip, work]: &Entry, fine: PathState) -> PathState {
        let theta = log_theta.exp();
        let stored = 0.5 * traction.value * traction.value / self.law.coefficients.alpha_t;
        let (plastic_slip, dissipation) = (plastic_slip.value, work.value - stored);
        let state = FrictionState { traction: traction.value, plastic_slip, dissipation, ..fine.state };
        PathState { state: state.with_variables([theta.value]), traction, theta }
    }

    /// Change by the next extrapolation, in tolerances.
    fn error(&self, entry: &Entry, above: &Entry, factor: f64, [from, to]: [&PathState; 2], step: u64) -> f64 {
        let law = &self.law.coefficients;
        let [traction, log_theta, _, work] = [0, 1, 2, 3].map(|i| factor * (entry[i].value - above[i].value).abs());
        let strength = law.f_0 * from.state.pressure.max(to.state.pressure);
        let slip = self.inputs.slip.value.abs() * share(step) + (to.state.plastic_slip - from.state.plastic_slip).abs();
        let loaded = law.alpha_t * self.inputs.slip.value.abs() * share(step);
        let noise = NOISE / TOLERANCE;
        let overlooked = self.overlooked(&from.state, &to.state, step);
        let parts = [
            [traction + law.alpha_t * overlooked, strength + noise * loaded],
            [(law.a + law.b.abs()) * (log_theta + overlooked / law.critical_slip), law.f_0],
            [work, strength * slip + noise * entry[3].value.abs()],
        ];
        // An exact 0 has no error, whatever the reference.
        let shares = parts.map(|[part, of]| if part == 0.0 { 0.0 } else { part / (TOLERANCE * of) });
        if shares.iter().any(|share| share.is_nan()) { f64::NAN } else { shares.into_iter().fold(0.0, f64::max) }
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

fn share(of: u64) -> f64 {
    of as f64 / WHOLE as f64
}
