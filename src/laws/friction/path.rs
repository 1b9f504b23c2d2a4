//! One increment along linear paths of slip, pressure and time, in sub-steps where the tolerance asks for them.

use super::peak::Evolution;
use super::slip_equation::{Point, ROUND_OFF, Reach, SlidingCurve, SlipEquation};
use super::{LEAST_SLOPE, LawFailure, STEEPEST};

/// Sub-steps are halved at most so often: until slip, pressure and time no longer change in floating point.
const MAX_HALVINGS: u32 = 48;

/// Evaluations of the slip equation after which the increment is given up: it is far too long.
const MAX_EVALUATIONS: usize = 20_000;

/// A sub-step in which q and μ p change by this share of the tolerance, but for a snap, is short enough to hold a snap.
const SNAP: f64 = 1e-3;

/// Errors below this, relative to the tractions they come from, are round-off.
const NOISE: f64 = 2e-13;

/// The difference of two stations over the error of the value extrapolated from them, where it converges slowly.
const CAUTION: f64 = 4.0;

/// What an answer depends on: [by Δu, by the pressure p at the end]
type Derivative = [f64; 2];

/// The part of an increment in which slip may be plastic, mirrored so that the traction does not become negative.
///
/// Along it slip, pressure and time are linear in x, 0 ≤ x ≤ 1.
pub(super) struct LoadPath<'a> {
    pub curve: &'a SlidingCurve,
    pub evolution: &'a Evolution,
    /// α_t [F/L³]
    pub alpha_t: f64,
    /// Greatest error of the traction, relative to the static strength μ_s p [-]
    pub tolerance: f64,
    /// Slip from x = 0 to 1 [L]; its derivative by Δu is 1.
    pub slip: f64,
    /// Pressures at x = 0 and 1 [F/L²]
    pub pressures: [f64; 2],
    /// Derivatives of the pressure at x = 0
    pub dstart_pressure: Derivative,
    /// Time from x = 0 to 1 [T]
    pub time: f64,
    /// Derivatives of the time
    pub dtime: Derivative,
    /// Evaluations of the slip equation so far
    pub evaluations: usize,
}

/// A point of the path.
#[derive(Clone, Copy)]
pub(super) struct Station {
    pub x: f64,
    /// q ≥ 0 [F/L²]
    pub traction: f64,
    /// Derivatives of q
    pub dtraction: Derivative,
    /// μ [-]
    pub mu: f64,
    /// Derivatives of μ
    pub dmu: Derivative,
    /// R and where it is on its curve
    reach: Reach,
    /// Plastic slip since the start of the path [L]
    pub plastic_slip: f64,
    /// Work dissipated since the start of the path [F/L]
    pub work: f64,
    /// Bound of the traction lost by plastic slip that an elastic sub-step has overlooked [F/L²]
    overlooked: f64,
}

/// In q, in μ p and in the work done
type Differences = [f64; 3];

/// A sub-step, and the same in two halves.
#[derive(Clone, Copy)]
struct Halves<'a> {
    from: &'a Station,
    coarse: &'a Station,
    middle: &'a Station,
    fine: &'a Station,
}

impl Halves<'_> {
    /// Whether there is plastic slip in the whole and in both halves.
    fn slide(&self) -> bool {
        let slips = |from: &Station, to: &Station| to.plastic_slip > from.plastic_slip;
        slips(self.from, self.coarse) && slips(self.from, self.middle) && slips(self.middle, self.fine)
    }
}

impl LoadPath<'_> {
    /// The beginning of the path.
    pub(super) fn start(&self, traction: f64, ratio: f64, mu: f64, dmu: Derivative) -> Station {
        let reach = self.curve.start(ratio);
        let (plastic_slip, work, overlooked) = (0.0, 0.0, 0.0);
        Station { x: 0.0, traction, dtraction: [0.0; 2], mu, dmu, reach, plastic_slip, work, overlooked }
    }

    /// The end of the path.
    ///
    /// # Errors
    /// [`LawFailure::NotConverged`] when sub-steps do not come to agree.
    pub(super) fn end(&mut self, start: &Station) -> Result<Station, LawFailure> {
        let end = self.advance(start, 1.0)?;
        self.refine(start, end, [0.0; 3], MAX_HALVINGS)
    }

    /// The station at the x of `coarse`, which one sub-step from `from` has reached, to within the tolerance.
    ///
    /// Two halves of the sub-step are compared with the whole and, where they differ too much, refined in their turn.
    /// As errors are proportional to the third power of the sub-step, the difference should then be an eighth: what it
    /// is `expected` to be. What it differs from that is an error that extrapolation cannot remove.
    ///
    /// Where the traction snaps the halves never agree: a sub-step that is so short that nothing else can happen in it is
    /// a snap, whose place is known as well as the tolerance asks.
    fn refine(
        &mut self,
        from: &Station,
        coarse: Station,
        expected: Differences,
        halvings: u32,
    ) -> Result<Station, LawFailure> {
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
        if self.drive(from, &fine) <= SNAP * self.tolerance * self.evolution.mu_s * self.pressure(fine.x) {
            return Ok(fine);
        }
        if halvings == 0 || self.evaluations > MAX_EVALUATIONS {
            let trial = from.traction + self.alpha_t * self.slip * (fine.x - from.x);
            let rest = differences[0].abs().max(overlooked);
            return Err(LawFailure::NotConverged { evaluations: self.evaluations, rest, trial });
        }
        let expected = differences.map(|difference| difference / 8.0);
        let middle = self.refine(from, middle, expected, halvings - 1)?;
        let coarse = self.advance(&middle, coarse.x)?;
        self.refine(&middle, coarse, expected, halvings - 1)
    }

    /// Most that slip, pressure and time change the traction or the strength by over a sub-step without a snap.
    fn drive(&self, from: &Station, to: &Station) -> f64 {
        let share = to.x - from.x;
        let recovery =
            self.evolution.recovery(from.mu.min(to.mu)) * self.time * self.pressure(from.x).max(self.pressure(to.x));
        share
            * (self.alpha_t * self.slip.abs()
                + self.evolution.mu_s * (self.pressures[1] - self.pressures[0]).abs()
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

    /// Differences that are allowed to a sub-step: more than its share of the tolerance in q and μ p, as R and μ forget
    /// errors in the course of slip; its share in the work, for the mean of q is to be right to the tolerance.
    fn allowed(&self, halves: &Halves) -> Differences {
        let Halves { from, fine, .. } = *halves;
        let share = fine.x - from.x;
        let (start_pressure, pressure) = (self.pressure(from.x), self.pressure(fine.x));
        let slip = self.slip.abs() * share;
        let noise = NOISE * (fine.traction + from.traction + self.alpha_t * slip);
        let tolerance = self.tolerance * self.evolution.mu_s;
        let strength = tolerance * pressure * (share * share.sqrt()).sqrt() + noise;
        let work = (tolerance * pressure.max(start_pressure) + noise) * (slip + fine.plastic_slip - from.plastic_slip);
        [strength, strength, work + NOISE * self.energy(fine)]
    }

    /// The finer of two stations after plastic slip, extrapolated to vanishing sub-steps.
    fn extrapolated(&self, halves: &Halves) -> Station {
        let Halves { from, coarse, fine, .. } = *halves;
        let beyond = |fine: f64, coarse: f64| fine + (fine - coarse) / 3.0;
        let beyond_each = |fine: Derivative, coarse: Derivative| [0, 1].map(|i| beyond(fine[i], coarse[i]));
        let pressure = self.pressure(fine.x);
        let (mut mu, mut dmu) = (beyond(fine.mu, coarse.mu), beyond_each(fine.dmu, coarse.dmu));
        if mu != self.evolution.clamp(mu) {
            (mu, dmu) = (self.evolution.clamp(mu), [0.0; 2]);
        }
        let mut traction = beyond(fine.traction, coarse.traction).max(0.0);
        let mut dtraction = beyond_each(fine.dtraction, coarse.dtraction);
        if traction > mu * pressure {
            let dpressure = self.dpressure(fine.x);
            (traction, dtraction) = (mu * pressure, [0, 1].map(|i| pressure * dmu[i] + mu * dpressure[i]));
        }
        let energy = beyond(self.energy(fine), self.energy(coarse));
        Station {
            x: fine.x,
            traction,
            dtraction,
            mu,
            dmu,
            reach: self.curve.start(traction / (mu * pressure)),
            plastic_slip: beyond(fine.plastic_slip, coarse.plastic_slip).max(from.plastic_slip),
            work: (energy - 0.5 * traction * traction / self.alpha_t).max(from.work),
            overlooked: 0.0,
        }
    }

    /// Work done by the traction: dissipated, and stored in the contact spring.
    fn energy(&self, station: &Station) -> f64 {
        station.work + 0.5 * station.traction * station.traction / self.alpha_t
    }

    /// One sub-step.
    #[inline]
    fn advance(&mut self, from: &Station, x: f64) -> Result<Station, LawFailure> {
        let share = x - from.x;
        let equation = SlipEquation {
            curve: self.curve,
            evolution: self.evolution,
            alpha_t: self.alpha_t,
            start: from.reach,
            trial: from.traction + self.alpha_t * self.slip * share,
            pressure: self.pressure(x),
            old_mu: from.mu,
            dt: self.time * share,
        };
        let (sticks, start) = equation.start();
        if sticks {
            return Ok(self.stick(from, x, equation.trial));
        }
        let (end, evaluations) = equation.solve(start)?;
        self.evaluations += evaluations;
        Ok(self.slide(from, x, &end))
    }

    /// A sub-step without plastic slip.
    #[inline]
    fn stick(&self, from: &Station, x: f64, trial: f64) -> Station {
        let share = x - from.x;
        let pressure = self.pressure(x);
        // Only weakening that has taken the traction from under an unloading can leave it to reverse: it waits at 0.
        let traction = trial.max(0.0);
        let (mu, by_time) = self.evolution.rested(from.mu, self.time * share);
        let old_rate = self.evolution.recovery(from.mu);
        let by_old = if old_rate > 0.0 { by_time / old_rate } else { 1.0 };
        let reach = self.curve.start(traction / (mu * pressure));
        let rate = self.rate(traction, mu, pressure, &reach);
        Station {
            x,
            traction,
            dtraction: if trial > 0.0 {
                [from.dtraction[0] + self.alpha_t * share, from.dtraction[1]]
            } else {
                [0.0; 2]
            },
            mu,
            dmu: [0, 1].map(|i| by_old * from.dmu[i] + by_time * share * self.dtime[i]),
            reach,
            overlooked: self.alpha_t * rate * share,
            ..*from
        }
    }

    /// A sub-step with plastic slip.
    #[inline]
    fn slide(&self, from: &Station, x: f64, point: &Point) -> Station {
        let share = x - from.x;
        let (start_pressure, pressure) = (self.pressure(from.x), self.pressure(x));
        let (reach, peak, slip) = (point.reach, point.peak, point.slip);
        let traction = reach.ratio * peak.mu * pressure;
        let per_slope = 1.0 / point.slope.max(LEAST_SLOPE * self.alpha_t);

        // dR = U dλ + U/U₀ dR₀ along the curve of R
        let begins = from.x == 0.0 || self.curve.begins_at(&from.reach) || from.reach.rate == 0.0;
        let inherited = if begins { 0.0 } else { reach.rate / from.reach.rate / (from.mu * start_pressure) };
        let derivatives = |i: usize| {
            let dstart_pressure = self.dpressure(from.x)[i];
            let dratio =
                from.dtraction[i] - from.reach.ratio * (start_pressure * from.dmu[i] + from.mu * dstart_pressure);
            let dtrial = from.dtraction[i] + if i == 0 { self.alpha_t * share } else { 0.0 };
            let dmu = peak.by_old * from.dmu[i] + peak.by_time * share * self.dtime[i];
            let dstrength = pressure * (peak.mu * inherited * dratio + reach.ratio * dmu)
                + reach.ratio * peak.mu * self.dpressure(x)[i];
            let dslip = (dtrial - dstrength) * per_slope;
            let limit = if i == 0 { STEEPEST * self.alpha_t } else { STEEPEST };
            let dtraction = (dtrial - self.alpha_t * dslip).clamp(-limit, limit);
            (dtraction, (dmu + peak.slope * dslip).clamp(-limit / pressure, limit / pressure))
        };
        let (dq_dslip, dmu_dslip) = derivatives(0);
        let (dq_dpressure, dmu_dpressure) = derivatives(1);

        let strengths = [from.mu * start_pressure, peak.mu * pressure];
        let work = mean_traction(self.curve, [&from.reach, &reach], strengths, [from.traction, traction]) * slip;
        Station {
            x,
            traction,
            dtraction: [dq_dslip, dq_dpressure],
            mu: peak.mu,
            dmu: [dmu_dslip, dmu_dpressure],
            reach,
            plastic_slip: from.plastic_slip + slip,
            work: from.work + work,
            overlooked: 0.0,
        }
    }

    /// dλ/dx of the rate equations, 0 where R falls by itself or the answer is not unique.
    #[inline]
    fn rate(&self, traction: f64, mu: f64, pressure: f64, reach: &Reach) -> f64 {
        if traction < reach.ratio * mu * pressure * (1.0 - ROUND_OFF) {
            return 0.0; // inside the elastic core
        }
        let (weakening, recovery) = (self.evolution.weakening(mu), self.evolution.recovery(mu));
        let drive = self.alpha_t * self.slip
            - reach.ratio * (recovery * self.time * pressure + mu * (self.pressures[1] - self.pressures[0]));
        let stiffness = self.alpha_t + pressure * (reach.rate * mu - reach.ratio * weakening);
        if drive > 0.0 && stiffness > 0.0 { drive / stiffness } else { 0.0 }
    }

    /// p [F/L²]
    pub(super) fn pressure(&self, x: f64) -> f64 {
        (1.0 - x) * self.pressures[0] + x * self.pressures[1]
    }

    /// Derivatives of p
    fn dpressure(&self, x: f64) -> Derivative {
        [(1.0 - x) * self.dstart_pressure[0], (1.0 - x) * self.dstart_pressure[1] + x]
    }
}

/// Mean of q over the plastic slip of a step: μ p is taken as linear in ∫ R dλ. Where the traction falls, it is itself taken
/// as linear in λ, which it is where it snaps: the contact springs back, and what the strength does not take is lost too.
pub(super) fn mean_traction(
    curve: &SlidingCurve,
    reaches: [&Reach; 2],
    strengths: [f64; 2],
    tractions: [f64; 2],
) -> f64 {
    let mean = |[start, end]: [f64; 2]| 0.5 * (start + end);
    if tractions[1] < tractions[0] {
        mean(tractions)
    } else {
        curve.mean_ratio(reaches[0], reaches[1]) * mean(strengths)
    }
}
