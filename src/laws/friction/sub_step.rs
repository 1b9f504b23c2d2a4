//! One sub-step of an increment along linear paths of slip, pressure and time.

use super::peak::PeakEvolution;
use super::peak_sensitivity::Shift;
use super::sliding_curve::{Reach, SlidingCurve};
use super::slip_equation::{Point, ROUND_OFF, SlipEquation};
use super::{LEAST_SLOPE, LawFailure, STEEPEST};

/// Derivatives along two directions of what an answer depends on.
pub(super) type Derivative = [f64; 2];

/// How what an answer depends on varies along the two directions.
#[derive(Clone, Copy)]
pub(super) struct Directions {
    /// of Δu
    pub slip: Derivative,
    /// of p at the end
    pub pressure: Derivative,
    /// of q at the start
    pub traction: Derivative,
    /// of μ at the start
    pub mu: Derivative,
    /// of the parameters, if they vary
    pub parameters: Option<[Shift; 2]>,
}

impl Directions {
    /// Δu and p: those of the consistent tangent.
    pub(super) const TANGENT: Self =
        Self { slip: [1.0, 0.0], pressure: [0.0, 1.0], traction: [0.0; 2], mu: [0.0; 2], parameters: None };
}

/// The part of an increment in which slip may be plastic, mirrored so that the traction does not become negative.
///
/// Along it slip, pressure and time are linear in x, 0 ≤ x ≤ 1.
pub(super) struct LoadPath<'a> {
    pub curve: &'a SlidingCurve,
    pub evolution: &'a PeakEvolution,
    /// α_t [F/L³]
    pub alpha_t: f64,
    /// Greatest error of the traction, relative to the static strength μ_s p [-]
    pub tolerance: f64,
    /// Slip from x = 0 to 1 [L]
    pub slip: f64,
    /// Derivatives of the slip
    pub dslip: Derivative,
    /// Pressures at x = 0 and 1 [F/L²]
    pub pressures: [f64; 2],
    /// Derivatives of the pressures
    pub dpressures: [Derivative; 2],
    /// Time from x = 0 to 1 [T]
    pub time: f64,
    /// Derivatives of the time
    pub dtime: Derivative,
    /// How the parameters vary, if they do
    pub parameters: Option<[Shift; 2]>,
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
    pub reach: Reach,
    /// Plastic slip since the start of the path [L]
    pub plastic_slip: f64,
    /// Work dissipated since the start of the path [F/L]
    pub work: f64,
    /// Bound of the traction lost by plastic slip that an elastic sub-step has overlooked [F/L²]
    pub overlooked: f64,
}

impl LoadPath<'_> {
    /// The beginning of the path.
    pub(super) fn start(
        &self,
        (traction, dtraction): (f64, Derivative),
        (mu, dmu): (f64, Derivative),
        ratio: f64,
    ) -> Station {
        let reach = self.curve.start(ratio);
        let (plastic_slip, work, overlooked) = (0.0, 0.0, 0.0);
        Station { x: 0.0, traction, dtraction, mu, dmu, reach, plastic_slip, work, overlooked }
    }

    /// One sub-step.
    #[inline]
    pub(super) fn advance(&mut self, from: &Station, x: f64) -> Result<Station, LawFailure> {
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
        // The tangent leaves out what the last step of the search changes in it, which adds up over many increments.
        let end = if self.parameters.is_some() { equation.settled(end) } else { end };
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
            dtraction: if trial > 0.0 { [0, 1].map(|i| self.dtrial(from, share, i)) } else { [0.0; 2] },
            mu,
            dmu: [0, 1].map(|i| match &self.parameters {
                None => by_old * from.dmu[i] + by_time * share * self.dtime[i],
                Some(shifts) => {
                    let by = [from.dmu[i], share * self.dtime[i]];
                    self.evolution.rested_by(from.mu, self.time * share, by, &shifts[i].peak)
                }
            }),
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
        let given = from.x == 0.0 && self.parameters.is_none();
        let begins = given || self.curve.begins_at(&from.reach) || from.reach.rate == 0.0;
        let inherited = if begins { 0.0 } else { reach.rate / from.reach.rate / (from.mu * start_pressure) };
        let derivatives = |i: usize| {
            let dstart_pressure = self.dpressure(from.x)[i];
            let dratio =
                from.dtraction[i] - from.reach.ratio * (start_pressure * from.dmu[i] + from.mu * dstart_pressure);
            let own = self.parameters.map_or([0.0; 3], |shifts| self.own(from, x, point, &shifts[i]));
            let dtrial = self.dtrial(from, share, i) - own[0];
            let dmu = peak.by_old * from.dmu[i] + peak.by_time * share * self.dtime[i] + own[1];
            let dstrength = pressure * (peak.mu * inherited * dratio + peak.mu * own[2] + reach.ratio * dmu)
                + reach.ratio * peak.mu * self.dpressure(x)[i];
            let dslip = (dtrial - dstrength) * per_slope;
            let limit = match self.parameters {
                Some(_) => f64::INFINITY,
                None if i == 0 => STEEPEST * self.alpha_t,
                None => STEEPEST,
            };
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

    /// Derivatives of the trial traction.
    #[inline]
    fn dtrial(&self, from: &Station, share: f64, i: usize) -> f64 {
        let by_stiffness = self.parameters.map_or(0.0, |shifts| shifts[i].alpha_t * self.slip * share);
        from.dtraction[i] + self.alpha_t * self.dslip[i] * share + by_stiffness
    }

    /// What parameters that vary add to α_t Δλ, μ and R after a given plastic slip from a given start.
    fn own(&self, from: &Station, x: f64, point: &Point, by: &Shift) -> [f64; 3] {
        let time = self.time * (x - from.x);
        [
            by.alpha_t * point.slip,
            self.evolution.after_by(from.mu, point.slip, time, &by.peak),
            self.curve.shifted(&from.reach, &point.reach, by),
        ]
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
    pub(super) fn dpressure(&self, x: f64) -> Derivative {
        [0, 1].map(|i| (1.0 - x) * self.dpressures[0][i] + x * self.dpressures[1][i])
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
