//! Path of an increment of super/subloading friction.
//!
//! An increment with linear paths of slip, pressure and time is divided into sub-steps as the tolerance requires.
//!
//! An error bound decides whether one step is sufficient without comparison with its halves.
//!
//! Responses are differentiated with respect to the parameters and the initial state.

use super::increment::{Balance, LoadPath, PathState, STEADY, Varied, unsteadiness};
use super::{EXCESS, SuperSubloading, SuperSubloadingParameters};
use crate::laws::dual::{Dual, Number};
use crate::laws::friction::sensitivity::{Direction, Inputs, SensitiveLaw, Variation, Variations, variations};
use crate::laws::friction::{FrictionState, LawFailure, Sliding};

impl SuperSubloading {
    /// The path of an increment in which slip may be plastic: from the start, or from where the traction passes 0; its initial
    /// state, and the sign of the traction, by which both are mirrored.
    pub(super) fn begin_path(&self, inputs: &Inputs, old_pressure: f64) -> (LoadPath<'_>, PathState, f64) {
        let Inputs { traction: old, variable: mu, slip, pressure, dt, .. } = *inputs;
        let varied = self.along(inputs);
        let trial = old + varied.alpha_t * slip;
        let reversed = old.value != 0.0 && trial.value * old.value.signum() < 0.0;
        let sign = if reversed || old.value == 0.0 { trial.value.signum() } else { old.value.signum() };
        let (parameters_vary, slip, old, time) = (inputs.vary_parameters(), slip * sign, old * sign, dt.into());
        let pressures = [old_pressure.into(), pressure];
        let mut path =
            LoadPath { law: self, varied, parameters_vary, weighs: false, slip, pressures, time, evaluations: 0 };
        let start = if reversed {
            self.pass_zero(&mut path, [old, mu], trial * sign)
        } else {
            let strength = mu.value * old_pressure;
            let ratio = if strength > 0.0 { old.value / strength } else { 0.0 };
            match self.direct {
                Some(_) if strength > 0.0 => {
                    let ratio = (old / (mu * old_pressure)).min(inputs.second);
                    path.start(old, mu, ratio.min(1.0.into()))
                }
                _ => path.start(old, mu, ratio.min(1.0).into()),
            }
        };
        (path, start, sign)
    }

    /// Restricts the path to the part after the traction passes 0; returns its initial state.
    fn pass_zero(&self, path: &mut LoadPath, [old, mu]: [Dual; 2], trial: Dual) -> PathState {
        let share = old / (old - trial);
        let mu = path.varied.evolution.rested(mu, path.time * share);
        path.slip = trial / path.varied.alpha_t;
        path.pressures[0] = path.pressure(share);
        path.time = path.time * (Dual::from(1.0) - share);
        path.start(0.0.into(), mu, 0.0.into())
    }

    /// The parameters with their derivatives.
    fn along(&self, inputs: &Inputs) -> Varied {
        Varied {
            alpha_t: inputs.parameter("alpha_t", self.alpha_t),
            r: inputs.parameter("r", self.curve.r),
            elastic_core: inputs.parameter("elastic_core", self.curve.elastic_core),
            evolution: self.evolution.along(inputs),
            direct: self.direct.map(|direct| direct.along(inputs)),
        }
    }
}

/// Maximum number of halvings: until slip, pressure and time no longer change in floating point.
const MAX_HALVINGS: u32 = 48;

/// Number of evaluations of the slip equation after which the increment is rejected as far too long.
const MAX_EVALUATIONS: usize = 20_000;

/// Fraction of the tolerance in q and μ p below which a sub-step is short enough to contain a jump.
const SNAP: f64 = 1e-3;

/// Relative round-off of tractions; errors below are ignored.
const NOISE: f64 = 2e-13;

/// Ratio of the difference of two results to the error of the value extrapolated from them, where convergence is slow.
const CAUTION: f64 = 4.0;

/// Errors in q, in μ p and in the work
type Differences = [f64; 3];

/// A sub-step, and the same interval in two halves.
#[derive(Clone, Copy)]
struct Halves<'a> {
    from: &'a PathState,
    coarse: &'a PathState,
    middle: &'a PathState,
    fine: &'a PathState,
}

impl Halves<'_> {
    /// Whether plastic slip occurs in the whole and in both halves.
    fn slide(&self) -> bool {
        let slips = |from: &PathState, to: &PathState| to.plastic_slip > from.plastic_slip;
        slips(self.from, self.coarse) && slips(self.from, self.middle) && slips(self.middle, self.fine)
    }

    /// Uncertainty of the work, which the difference of whole and halves shows only if one rule was taken in all three.
    fn spread(&self) -> f64 {
        let spreads = [self.coarse, self.middle, self.fine].map(|state| state.spread);
        if spreads.iter().all(|spread| *spread > 0.0) { 0.0 } else { spreads.into_iter().fold(0.0, f64::max) }
    }
}

impl LoadPath<'_> {
    /// State at the end of the path: one step if that is sufficient.
    ///
    /// # Errors
    /// Returns [`LawFailure::NotConverged`] if sub-steps do not converge.
    pub(super) fn end(&mut self, start: &PathState) -> Result<PathState, LawFailure> {
        if self.law.direct.is_some() {
            return self.end_with_rate(start);
        }
        let end = self.advance(start, 1.0)?;
        if self.is_right_alone(start, &end) {
            return Ok(end);
        }
        self.refine(start, &end, [0.0; 3], MAX_HALVINGS)
    }

    /// State at the x of `coarse`, the result of one sub-step from `from`, to within the tolerance.
    ///
    /// Two halves of the sub-step are compared with the whole and, if they differ too much, refined recursively.
    /// As errors are proportional to the third power of the sub-step, the difference should then be an eighth, as
    /// `expected`. A deviation from that is an error that extrapolation cannot remove.
    ///
    /// Where the traction jumps the halves never agree: a sub-step so short that nothing else can happen in it is
    /// a jump, located with the required accuracy.
    fn refine(
        &mut self,
        from: &PathState,
        coarse: &PathState,
        expected: Differences,
        halvings: u32,
    ) -> Result<PathState, LawFailure> {
        let middle = self.advance(from, 0.5 * (from.x + coarse.x))?;
        let fine = self.advance(&middle, coarse.x)?;
        let halves = Halves { from, coarse, middle: &middle, fine: &fine };
        let expected = [expected[0], expected[1], self.expected_work(from, coarse).unwrap_or(expected[2])];
        let (differences, allowed) = (self.differences(&halves), self.allowed(&halves));
        let overlooked = coarse.overlooked.max(middle.overlooked).max(fine.overlooked);
        let agree = overlooked <= allowed[0]
            && halves.spread() <= allowed[2]
            && (0..3).all(|i| {
                let left = differences[i].abs() / CAUTION;
                let left = if halves.slide() { left.min((differences[i] - expected[i]).abs()) } else { left };
                left <= allowed[i]
            });
        if agree {
            return Ok(if halves.slide() { self.extrapolated(&halves) } else { fine });
        }
        if self.drive(from, &fine) <= SNAP * self.law.tolerance * self.law.evolution.mu_s * self.pressure_at(&fine) {
            return Ok(fine);
        }
        if halvings == 0 || self.evaluations > MAX_EVALUATIONS {
            let trial = from.traction.value + self.law.alpha_t * self.slip.value * (fine.x - from.x);
            let rest = differences[0].abs().max(overlooked);
            return Err(LawFailure::NotConverged { evaluations: self.evaluations, rest, trial });
        }
        let expected = differences.map(|difference| difference / 8.0);
        let middle = self.refine(from, &middle, expected, halvings - 1)?;
        let coarse = self.advance(&middle, coarse.x)?;
        self.refine(&middle, &coarse, expected, halvings - 1)
    }

    /// Maximum change of the traction or the strength by slip, pressure and time over a sub-step without a jump.
    fn drive(&self, from: &PathState, to: &PathState) -> f64 {
        let share = to.x - from.x;
        let recovery = self.law.evolution.recovery(from.mu.value.min(to.mu.value))
            * self.time.value
            * self.pressure_at(from).max(self.pressure_at(to));
        share
            * (self.law.alpha_t * self.slip.value.abs()
                + self.law.evolution.mu_s * self.pressure_change().abs()
                + recovery)
    }

    /// Differences between a sub-step and its halves.
    fn differences(&self, halves: &Halves) -> Differences {
        let Halves { coarse, fine, .. } = *halves;
        [
            fine.traction.value - coarse.traction.value,
            (fine.mu.value - coarse.mu.value) * self.pressure_at(fine),
            self.energy(fine) - self.energy(coarse),
        ]
    }

    /// Allowed differences of a sub-step: more than its fraction of the tolerance in q and μ p, as errors of R and μ decay with
    /// slip; its fraction in the work, since the mean of q must be accurate to the tolerance.
    fn allowed(&self, halves: &Halves) -> Differences {
        let Halves { from, fine, .. } = *halves;
        let share = fine.x - from.x;
        let pressure = self.pressure_at(fine);
        let slip = self.slip.value.abs() * share;
        let noise = NOISE * (fine.traction.value + from.traction.value + self.law.alpha_t * slip);
        let tolerance = self.law.tolerance * self.law.evolution.mu_s;
        let strength = tolerance * pressure * (share * share.sqrt()).sqrt() + noise;
        let most = self.pressures[0].value.max(self.pressures[1].value);
        let work = (tolerance * most + noise) * (slip + fine.plastic_slip - from.plastic_slip);
        [strength, strength, work + NOISE * self.energy(fine)]
    }

    /// The finer of two results after plastic slip, extrapolated to vanishing sub-steps.
    fn extrapolated(&self, halves: &Halves) -> PathState {
        let Halves { from, coarse, fine, .. } = *halves;
        let beyond = |fine: f64, coarse: f64| fine + (fine - coarse) / 3.0;
        let pressure = self.pressure(fine.x.into());
        let mu = self.varied.evolution.clamp(fine.mu + (fine.mu - coarse.mu) / 3.0);
        let strength = mu * pressure;
        let traction = (fine.traction + (fine.traction - coarse.traction) / 3.0).max(0.0.into()).min(strength);
        let energy = beyond(self.energy(fine), self.energy(coarse));
        PathState {
            x: fine.x,
            traction,
            mu,
            curve_point: self.law.curve.start(traction.value / strength.value),
            ratio: fine.ratio,
            plastic_slip: beyond(fine.plastic_slip, coarse.plastic_slip).max(from.plastic_slip),
            weighed_slip: fine.weighed_slip + (fine.weighed_slip - coarse.weighed_slip) / 3.0,
            work: (energy - 0.5 * traction.value * traction.value / self.law.alpha_t).max(from.work),
            overlooked: 0.0,
            spread: 0.0,
        }
    }

    /// Work of the traction: dissipated, and stored in the contact spring.
    pub(super) fn energy(&self, path_state: &PathState) -> f64 {
        path_state.work + 0.5 * path_state.traction.value * path_state.traction.value / self.law.alpha_t
    }
}

/// Allowed error of q and μ p of a single step, as a fraction of the tolerance: at the transition to halves Newton's method
/// meets a jump, which must be far below its resolution.
const SHARE: f64 = 0.01;

impl LoadPath<'_> {
    /// Whether a single step over the whole path, with plastic slip, is accurate to the tolerance.
    ///
    /// For m = n = 1 its q and μ follow exactly from the plastic slip and the time, if these are proportional to each other:
    /// with λ/Δλ deviating from x by at most w (a quarter of the variation of its rate), the error of μ is a b (μ_s − μ_k) w,
    /// where a = κ Δλ/μ_k, b = ξ Δt/μ_s (the commutator of weakening and recovery), and that of q is α_t R p/D times this. The
    /// rate D dλ/dx = α_t du/dx − R (ξ (1 − μ/μ_s) p dt/dx + μ dp/dx) consists of terms that are monotonic in the step, so that
    /// its ends bound w; it must be positive throughout. The mean of q is a trapezoidal rule, whose error is bounded by the
    /// slopes at its ends.
    fn is_right_alone(&self, from: &PathState, to: &PathState) -> bool {
        let slip = to.plastic_slip - from.plastic_slip;
        if !(self.law.evolution.is_linear() && slip > 0.0) {
            return false;
        }
        let [start, end] = [from, to].map(|at| self.balance(at));
        let unsteady = unsteadiness([&start, &end]);
        if unsteady > STEADY {
            return false;
        }
        let stiffness = start.stiffness.min(end.stiffness);
        let pressure = self.pressures[1].value;
        let strength = self.law.tolerance * self.law.evolution.mu_s * pressure;
        let mu_error = 0.25 * unsteady * self.law.evolution.commutator(slip, self.time.value);
        let q_error = mu_error * pressure * (self.law.alpha_t / stiffness).max(1.0);
        q_error <= SHARE * strength && mean_error(slip, &start, &end) <= strength
    }

    /// Difference of the work of two halves of a step and that of the whole, where slip is steady and plastic from the start: the
    /// trapezoidal rule of the mean of q (`mean_of_steady_slip`) errs by
    ///
    /// ```text
    /// A (f₀ + f₁)/2 − ∫ f dA ≈ A² (f₁′ − f₀′)/12,   A = ∫ R dλ,   f = μ p,   f′ = d(μ p)/dλ/R
    /// ```
    /// (Euler–Maclaurin), and its halves by a quarter of that.
    fn expected_work(&self, from: &PathState, to: &PathState) -> Option<f64> {
        let [start, end] = [from, to].map(|at| self.balance(at));
        let far = (end.ratio - start.ratio).abs() > STEADY * start.ratio;
        if start.in_core || far || unsteadiness([&start, &end]) > STEADY {
            return None;
        }
        let slope = |e: &Balance| {
            let by_time = (e.recovery + e.pressing) * e.stiffness / e.drive;
            (by_time - e.weakening) / (e.ratio * e.ratio)
        };
        let ratio = self.law.curve.mean_ratio(&from.curve_point, &to.curve_point);
        let area = ratio * (to.plastic_slip - from.plastic_slip);
        Some(-0.75 / 12.0 * area * area * (slope(&end) - slope(&start)))
    }
}

/// Bound of the error of the mean of q, by which plastic slip is multiplied in the dissipation: the error of a trapezoidal rule
/// of f over the length L is at most L |f′(end) − f′(start)|/8 where f′ is monotonic, applied to each part; here μ p over
/// ∫ R dλ.
fn mean_error(slip: f64, start: &Balance, end: &Balance) -> f64 {
    // d(μ p)/dλ/R from weakening, recovery and pressure
    let parts = |e: &Balance| {
        let per_rate = e.stiffness / e.drive;
        [e.weakening, e.recovery * per_rate, e.pressing * per_rate].map(|part| part / (e.ratio * e.ratio))
    };
    let (start_parts, end_parts) = (parts(start), parts(end));
    let bend: f64 = (0..3).map(|i| (end_parts[i] - start_parts[i]).abs()).sum();
    0.125 * slip * end.ratio * end.ratio * bend
}

impl SensitiveLaw for SuperSubloading {
    /// All parameters except the tolerance; those of the direct effect if there is one.
    fn parameters(&self) -> &'static [&'static str] {
        let all = SuperSubloadingParameters::VARYING;
        if self.direct.is_some() { all } else { &all[..all.len() - 2] }
    }

    fn start(&self, parameter: &str) -> Variation {
        let dmu = match (parameter, self.structure) {
            ("mu_s", None) => 1.0,
            ("mu_k", Some(structure)) => structure,
            ("structure", Some(_)) => self.evolution.mu_k,
            _ => 0.0,
        };
        Variation::new(0.0, dmu)
    }

    fn vary(&self, old: &FrictionState, sliding: Sliding, directions: [Direction; 2]) -> Variations {
        let mut inputs = Inputs::new(old, sliding, directions)?;
        let Varied { alpha_t, evolution, .. } = self.along(&inputs);
        inputs.variable = evolution.clamp(inputs.variable);
        let rested = evolution.rested(inputs.variable, sliding.dt.into());
        if sliding.pressure <= 0.0 {
            return Ok(self.variations(0.0.into(), rested, 0.0.into()));
        }
        if self.direct.is_some() {
            return self.vary_with_rate(old, &inputs, rested, sliding);
        }
        let strength = inputs.variable * old.pressure.max(0.0);
        if old.traction.abs() > strength.value * (1.0 + EXCESS) {
            inputs.traction = strength * old.traction.signum();
        }
        let trial = inputs.traction + alpha_t * inputs.slip;
        if self.is_elastic(&self.within_strength(old), trial.value, sliding) {
            return Ok(variations(trial, rested));
        }
        let (mut path, start, sign) = self.begin_path(&inputs, old.pressure);
        let end = path.end(&start)?;
        Ok(variations(end.traction * sign, end.mu))
    }
}

impl SuperSubloading {
    /// The same with a direct effect of the rate.
    fn vary_with_rate(&self, old: &FrictionState, inputs: &Inputs, rested: Dual, sliding: Sliding) -> Variations {
        let old = self.within_strength(old);
        let trial = inputs.traction + self.along(inputs).alpha_t * inputs.slip;
        if self.is_elastic(&old, trial.value, sliding) {
            let own = trial * trial.value.signum() / (rested * inputs.pressure);
            // Slip in no time is elastic, and leaves R as it was where it has not passed zero.
            let reversed = trial.value * old.traction < 0.0;
            let before = inputs.traction * inputs.traction.value.signum() / (inputs.variable * old.pressure.max(0.0));
            let kept = if old.pressure > 0.0 && !reversed { before.min(inputs.second) } else { 0.0.into() };
            let ratio = if sliding.dt == 0.0 { own.min(kept) } else { own };
            return Ok(self.variations(trial, rested, ratio));
        }
        let (mut path, start, sign) = self.begin_path(inputs, old.pressure);
        let end = path.end(&start)?;
        Ok(self.variations(end.traction * sign, end.mu, end.ratio))
    }

    /// Derivatives of q, μ and, with a direct effect, R.
    fn variations(&self, traction: Dual, mu: Dual, ratio: Dual) -> [Variation; 2] {
        let mut found = variations(traction, mu);
        if self.direct.is_some() {
            found.iter_mut().zip(ratio.by).for_each(|(found, by)| found.variables[1] = by);
        }
        found
    }
}
