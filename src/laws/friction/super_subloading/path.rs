//! Path of an increment of super/subloading friction.
//!
//! # Sub-steps
//!
//! An increment with linear paths of slip, pressure and time is divided into sub-steps as the tolerance requires.
//!
//! # Short steps
//!
//! An error bound decides whether one step is sufficient without comparison with its halves.
//!
//! # Sensitivity
//!
//! Responses are differentiated with respect to the parameters and the initial state.

use super::increment::{Derivative, Directions, LoadPath, PathState, Shift};
use super::peak::PeakShift;
use super::{EXCESS, SuperSubloading, SuperSubloadingParameters, falls, mu_of};
use crate::laws::friction::sensitivity::{Direction, SensitiveLaw, Variation};
use crate::laws::friction::{FrictionState, LawFailure, Sliding};

impl SuperSubloading {
    /// The path of an increment in which slip may be plastic: from the start, or from where the traction passes 0; its initial
    /// state, and the sign of the traction, by which both are mirrored.
    pub(super) fn lead(
        &self,
        old: &FrictionState,
        trial: f64,
        Sliding { slip, pressure, dt }: Sliding,
        by: &Directions,
    ) -> (LoadPath<'_>, PathState, f64) {
        let reversed = old.traction != 0.0 && trial * old.traction.signum() < 0.0;
        let sign = if reversed || old.traction == 0.0 { trial.signum() } else { old.traction.signum() };
        let mirrored = |derivative: Derivative| derivative.map(|d| sign * d);
        let by = &Directions { slip: mirrored(by.slip), traction: mirrored(by.traction), ..*by };
        let mut path = LoadPath {
            law: self,
            slip: sign * slip,
            dslip: by.slip,
            pressures: [old.pressure, pressure],
            dpressures: [[0.0; 2], by.pressure],
            time: dt,
            dtime: [0.0; 2],
            parameters: by.parameters,
            evaluations: 0,
        };
        let start = if reversed {
            let share = old.traction / (old.traction - trial);
            self.pass_zero(&mut path, mu_of(old), trial, share, by)
        } else {
            path.start(old.traction.abs(), by.traction, mu_of(old), by.mu, old.ratio(mu_of(old)).min(1.0))
        };
        (path, start, sign)
    }

    /// Restricts the path to the part after the traction passes 0, at the fraction `share` of the increment; returns its
    /// initial state.
    fn pass_zero(&self, path: &mut LoadPath, old_mu: f64, trial: f64, share: f64, by: &Directions) -> PathState {
        let (alpha_t, slip, dt) = (self.alpha_t, path.slip, path.time);
        let dstiffness = [0, 1].map(|i| by.parameters.map_or(0.0, |shifts| shifts[i].alpha_t));
        let dshare = [0, 1]
            .map(|i| -share / slip * by.slip[i] - by.traction[i] / (alpha_t * slip) - share * dstiffness[i] / alpha_t);
        let (mu, mu_rate) = self.evolution.rested(old_mu, dt * share);
        let dmu = [0, 1].map(|i| match &by.parameters {
            None => mu_rate * dt * dshare[i],
            Some(shifts) => self.evolution.rested_by(old_mu, dt * share, by.mu[i], dt * dshare[i], &shifts[i].peak),
        });
        let gain = path.pressures[1] - path.pressures[0];
        path.slip = trial.abs() / alpha_t;
        path.dslip = [0, 1].map(|i| {
            let dtrial = by.traction[i] + alpha_t * by.slip[i] + slip * dstiffness[i];
            dtrial / alpha_t - path.slip * dstiffness[i] / alpha_t
        });
        path.dpressures[0] = [0, 1].map(|i| gain * dshare[i] + share * by.pressure[i]);
        path.pressures[0] = path.pressure(share);
        path.time = dt * (1.0 - share);
        path.dtime = dshare.map(|dshare| -dt * dshare);
        path.start(0.0, [0.0; 2], mu, dmu, 0.0)
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
}

impl LoadPath<'_> {
    /// State at the end of the path: one step if that is sufficient.
    ///
    /// # Errors
    /// Returns [`LawFailure::NotConverged`] if sub-steps do not converge.
    pub(super) fn end(&mut self, start: &PathState) -> Result<PathState, LawFailure> {
        let end = self.advance(start, 1.0)?;
        if self.is_right_alone(start, &end) {
            return Ok(end);
        }
        self.refine(start, end, [0.0; 3], MAX_HALVINGS)
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
        coarse: PathState,
        expected: Differences,
        halvings: u32,
    ) -> Result<PathState, LawFailure> {
        let middle = self.advance(from, 0.5 * (from.x + coarse.x))?;
        let fine = self.advance(&middle, coarse.x)?;
        let halves = Halves { from, coarse: &coarse, middle: &middle, fine: &fine };
        let (differences, allowed) = (self.differences(&halves), self.allowed(&halves));
        let overlooked = coarse.overlooked.max(middle.overlooked).max(fine.overlooked);
        let agree = overlooked <= allowed[0]
            && (0..3).all(|i| {
                let left = differences[i].abs() / CAUTION;
                let left = if halves.slide() { left.min((differences[i] - expected[i]).abs()) } else { left };
                left <= allowed[i]
            });
        if agree {
            return Ok(if halves.slide() { self.extrapolated(&halves) } else { fine });
        }
        if self.drive(from, &fine) <= SNAP * self.law.tolerance * self.law.evolution.mu_s * self.pressure(fine.x) {
            return Ok(fine);
        }
        if halvings == 0 || self.evaluations > MAX_EVALUATIONS {
            let trial = from.traction + self.law.alpha_t * self.slip * (fine.x - from.x);
            let rest = differences[0].abs().max(overlooked);
            return Err(LawFailure::NotConverged { evaluations: self.evaluations, rest, trial });
        }
        let expected = differences.map(|difference| difference / 8.0);
        let middle = self.refine(from, middle, expected, halvings - 1)?;
        let coarse = self.advance(&middle, coarse.x)?;
        self.refine(&middle, coarse, expected, halvings - 1)
    }

    /// Maximum change of the traction or the strength by slip, pressure and time over a sub-step without a jump.
    fn drive(&self, from: &PathState, to: &PathState) -> f64 {
        let share = to.x - from.x;
        let recovery = self.law.evolution.recovery(from.mu.min(to.mu))
            * self.time
            * self.pressure(from.x).max(self.pressure(to.x));
        share
            * (self.law.alpha_t * self.slip.abs()
                + self.law.evolution.mu_s * (self.pressures[1] - self.pressures[0]).abs()
                + recovery)
    }

    /// Differences between a sub-step and its halves.
    fn differences(&self, halves: &Halves) -> Differences {
        let Halves { coarse, fine, .. } = *halves;
        [
            fine.traction - coarse.traction,
            (fine.mu - coarse.mu) * self.pressure(fine.x),
            self.energy(fine) - self.energy(coarse),
        ]
    }

    /// Allowed differences of a sub-step: more than its fraction of the tolerance in q and μ p, as errors of R and μ decay with
    /// slip; its fraction in the work, since the mean of q must be accurate to the tolerance.
    fn allowed(&self, halves: &Halves) -> Differences {
        let Halves { from, fine, .. } = *halves;
        let share = fine.x - from.x;
        let (start_pressure, pressure) = (self.pressure(from.x), self.pressure(fine.x));
        let slip = self.slip.abs() * share;
        let noise = NOISE * (fine.traction + from.traction + self.law.alpha_t * slip);
        let tolerance = self.law.tolerance * self.law.evolution.mu_s;
        let strength = tolerance * pressure * (share * share.sqrt()).sqrt() + noise;
        let work = (tolerance * pressure.max(start_pressure) + noise) * (slip + fine.plastic_slip - from.plastic_slip);
        [strength, strength, work + NOISE * self.energy(fine)]
    }

    /// The finer of two results after plastic slip, extrapolated to vanishing sub-steps.
    fn extrapolated(&self, halves: &Halves) -> PathState {
        let Halves { from, coarse, fine, .. } = *halves;
        let beyond = |fine: f64, coarse: f64| fine + (fine - coarse) / 3.0;
        let beyond_each = |fine: Derivative, coarse: Derivative| [0, 1].map(|i| beyond(fine[i], coarse[i]));
        let pressure = self.pressure(fine.x);
        let (mut mu, mut dmu) = (beyond(fine.mu, coarse.mu), beyond_each(fine.dmu, coarse.dmu));
        if mu != self.law.evolution.clamp(mu) {
            dmu = [0, 1]
                .map(|i| self.parameters.map_or(0.0, |shifts| self.law.evolution.clamped_by(mu, 0.0, &shifts[i].peak)));
            mu = self.law.evolution.clamp(mu);
        }
        let mut traction = beyond(fine.traction, coarse.traction).max(0.0);
        let mut dtraction = beyond_each(fine.dtraction, coarse.dtraction);
        if traction > mu * pressure {
            let dpressure = self.dpressure(fine.x);
            (traction, dtraction) = (mu * pressure, [0, 1].map(|i| pressure * dmu[i] + mu * dpressure[i]));
        }
        let energy = beyond(self.energy(fine), self.energy(coarse));
        PathState {
            x: fine.x,
            traction,
            dtraction,
            mu,
            dmu,
            curve_point: self.law.curve.start(traction / (mu * pressure)),
            plastic_slip: beyond(fine.plastic_slip, coarse.plastic_slip).max(from.plastic_slip),
            work: (energy - 0.5 * traction * traction / self.law.alpha_t).max(from.work),
            overlooked: 0.0,
        }
    }

    /// Work of the traction: dissipated, and stored in the contact spring.
    fn energy(&self, path_state: &PathState) -> f64 {
        path_state.work + 0.5 * path_state.traction * path_state.traction / self.law.alpha_t
    }
}

/// Allowed error of q and μ p of a single step, as a fraction of the tolerance: at the transition to halves Newton's method
/// meets a jump, which must be far below its resolution.
const SHARE: f64 = 0.01;

/// Largest relative change of the rate of plastic slip within a single step, required for bounds from its ends.
const STEADY: f64 = 0.25;

/// Quantities that determine the rate of plastic slip at one end of a step.
struct Ends {
    /// p U μ, contribution of the approach of R to D = α_t + p (U μ − R κ (μ/μ_k − 1)) [F/L³]
    approach: f64,
    /// p R κ (μ/μ_k − 1), reduction of D by weakening [F/L³]
    weakening: f64,
    /// R p ξ (1 − μ/μ_s) and R μ dp/dx: reductions of α_t du/dx by recovery and pressure, per x [F/L²]
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
        let strength = self.law.tolerance * self.law.evolution.mu_s * pressure;
        let mu_error = 0.25 * unsteady * self.law.evolution.commutator(slip, self.time);
        let q_error = mu_error * pressure * (self.law.alpha_t / stiffness).max(1.0);
        q_error <= SHARE * strength && self.mean_error(from, to, &start, &end) <= strength
    }

    /// Quantities that determine the rate of plastic slip in a state.
    fn ends(&self, at: &PathState) -> Ends {
        let (pressure, ratio) = (self.pressure(at.x), at.curve_point.ratio);
        let approach = pressure * at.curve_point.rate * at.mu;
        let weakening = pressure * ratio * self.law.evolution.weakening(at.mu);
        let recovery = ratio * pressure * self.law.evolution.recovery(at.mu) * self.time;
        let pressing = ratio * at.mu * (self.pressures[1] - self.pressures[0]);
        Ends {
            approach,
            weakening,
            recovery,
            pressing,
            stiffness: self.law.alpha_t + approach - weakening,
            drive: self.law.alpha_t * self.slip - recovery - pressing,
            ratio,
        }
    }

    /// Bound of the error of the mean of q, by which plastic slip is multiplied in the dissipation: the error of a trapezoidal
    /// rule of f over the length L is at most L |f′(end) − f′(start)|/8 where f′ is monotonic, applied to each part. The rule
    /// is for q over λ where q decreases, else for μ p over ∫ R dλ (`mean_traction`).
    fn mean_error(&self, from: &PathState, to: &PathState, start: &Ends, end: &Ends) -> f64 {
        let slip = to.plastic_slip - from.plastic_slip;
        // R d(μ p)/dλ from weakening, recovery and pressure, and μ p dR/dλ
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

/// Derivative of each parameter along a direction.
fn shift(by: &Direction) -> Shift {
    let [mu_s, mu_k, kappa, xi, m, n] = ["mu_s", "mu_k", "kappa", "xi", "m", "n"].map(|name| by.of(name));
    let peak = PeakShift { mu_s, mu_k, kappa, xi, m, n };
    Shift { alpha_t: by.of("alpha_t"), r: by.of("r"), elastic_core: by.of("elastic_core"), peak }
}

impl SensitiveLaw for SuperSubloading {
    /// All parameters except the last, the tolerance.
    fn parameters(&self) -> &'static [&'static str] {
        SuperSubloadingParameters::NUMBERS.split_last().map_or(&[], |(_, numbers)| numbers)
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

    fn vary(
        &self,
        old: &FrictionState,
        sliding: Sliding,
        directions: [Direction; 2],
    ) -> Result<[Variation; 2], LawFailure> {
        let Sliding { slip, pressure, dt } = sliding.checked()?;
        let shifts = directions.map(|direction| shift(&direction));
        let mut by = Directions {
            slip: directions.map(|direction| direction.slip),
            pressure: [0.0; 2],
            traction: directions.map(|direction| direction.state.traction),
            mu: [0, 1].map(|i| self.evolution.clamped_by(mu_of(old), directions[i].variable(), &shifts[i].peak)),
            parameters: Some(shifts),
        };
        let rested =
            |mu: f64, by: &Directions| [0, 1].map(|i| self.evolution.rested_by(mu, dt, by.mu[i], 0.0, &shifts[i].peak));
        if pressure <= 0.0 {
            return Ok(rested(self.evolution.clamp(mu_of(old)), &by).map(|dmu| Variation::new(0.0, dmu)));
        }
        let within = self.within_strength(old);
        if old.traction.abs() > mu_of(&within) * old.pressure.max(0.0) * (1.0 + EXCESS) {
            by.traction = by.mu.map(|dmu| old.traction.signum() * old.pressure.max(0.0) * dmu);
        }
        let trial = within.traction + self.alpha_t * slip;
        if falls(&within, trial, pressure) {
            let dmu = rested(mu_of(&within), &by);
            let dtraction = [0, 1].map(|i| by.traction[i] + self.alpha_t * by.slip[i] + slip * shifts[i].alpha_t);
            return Ok([0, 1].map(|i| Variation::new(dtraction[i], dmu[i])));
        }
        let (mut path, start, sign) = self.lead(&within, trial, sliding, &by);
        let end = path.end(&start)?;
        Ok([0, 1].map(|i| Variation::new(sign * end.dtraction[i], end.dmu[i])))
    }
}
