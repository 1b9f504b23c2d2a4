//! One sub-step of an increment along linear paths of slip, pressure and time.
//!
//! The sub-step is governed by a scalar equation of plastic slip, of which the smallest root is required.

use super::SuperSubloading;
use super::direct::{DirectEffect, Strength};
use super::peak::{Peak, PeakEvolution};
use crate::laws::approach::{CurvePoint, SlidingCurve};
use crate::laws::dual::{Dual, Number};
use crate::laws::friction::root::{Argument, Piece, bracketed_root, first_root_bracket};
use crate::laws::friction::{LEAST_SLOPE, LawFailure, STEEPEST};

/// The parameters of the law with their derivatives.
pub(super) struct Varied {
    pub alpha_t: Dual,
    pub r: Dual,
    pub elastic_core: Dual,
    pub evolution: PeakEvolution<Dual>,
    /// Direct effect of the rate, if there is one
    pub direct: Option<DirectEffect<Dual>>,
}

/// The part of an increment in which slip may be plastic, with signs such that the traction is not negative.
///
/// Along it slip, pressure and time are linear in x, 0 ≤ x ≤ 1.
pub(super) struct LoadPath<'a> {
    pub law: &'a SuperSubloading,
    pub varied: Varied,
    /// Whether parameters vary; if not, the derivatives are those of a tangent, which is bounded
    pub parameters_vary: bool,
    /// Whether plastic slip is weighed by the structure
    pub weighs: bool,
    /// Slip from x = 0 to 1 [L]
    pub slip: Dual,
    /// Pressures at x = 0 and 1 [F/L²]
    pub pressures: [Dual; 2],
    /// Time from x = 0 to 1 [T]
    pub time: Dual,
    /// Number of evaluations of the slip equation so far
    pub evaluations: usize,
}

/// A point of the path.
#[derive(Clone, Copy)]
pub(super) struct PathState {
    pub x: f64,
    /// q ≥ 0 [F/L²]
    pub traction: Dual,
    /// μ [-]
    pub mu: Dual,
    /// R, and its point on the curve; below R_e the point is that of R_e
    pub curve_point: CurvePoint,
    /// R of a law with a direct effect of the rate; without one it follows from the others
    pub ratio: Dual,
    /// Plastic slip since the start of the path [L]
    pub plastic_slip: f64,
    /// ∫ (μ/μ_k − 1) dλ since the start of the path, if it is asked for [L]
    pub weighed_slip: Dual,
    /// Work dissipated since the start of the path [F/L]
    pub work: f64,
    /// Traction lost by plastic slip that was neglected in an elastic sub-step, or by elastic slip at the start of a plastic one
    /// [F/L²]
    pub overlooked: f64,
    /// Difference between the rules of the mean of q in the work of the last sub-step, if not that of steady slip was taken [F/L]
    pub spread: f64,
}

impl LoadPath<'_> {
    /// Start of the path.
    pub(super) fn start(&self, traction: Dual, mu: Dual, ratio: Dual) -> PathState {
        let curve_point = self.law.curve.start(ratio.value);
        let weighed_slip = 0.0.into();
        PathState {
            x: 0.0,
            traction,
            mu,
            curve_point,
            ratio,
            plastic_slip: 0.0,
            weighed_slip,
            work: 0.0,
            overlooked: 0.0,
            spread: 0.0,
        }
    }

    /// Integrates one sub-step.
    #[inline]
    pub(super) fn advance(&mut self, from: &PathState, x: f64) -> Result<PathState, LawFailure> {
        let (share, pressure) = (x - from.x, self.pressure(x.into()));
        let equation = SlipEquation {
            law: self.law,
            start: from.curve_point,
            trial: from.traction.value + self.law.alpha_t * self.slip.value * share,
            pressure: pressure.value,
            old_mu: from.mu.value,
            dt: self.time.value * share,
        };
        let (sticks, start) = equation.start();
        if sticks {
            return Ok(self.stick(from, x, pressure));
        }
        let (end, evaluations) = equation.solve(start)?;
        self.evaluations += evaluations;
        Ok(self.slide(from, x, pressure, &end))
    }

    /// A sub-step without plastic slip.
    #[inline]
    fn stick(&self, from: &PathState, x: f64, pressure: Dual) -> PathState {
        let share = x - from.x;
        // Only weakening that has reduced the traction during unloading can leave it to reverse: it stays at 0.
        let trial = self.trial(from, share);
        let traction = if trial.value > 0.0 { trial } else { 0.0.into() };
        let mu = self.varied.evolution.rested(from.mu, self.time * share);
        let curve_point = self.law.curve.start(traction.value / (mu.value * pressure.value));
        let ratio = if self.varied.direct.is_some() { traction / (mu * pressure) } else { from.ratio };
        let mut to = PathState { x, traction, mu, curve_point, ratio, overlooked: 0.0, spread: 0.0, ..*from };
        let rates = [from, &to].map(|at| self.balance(at).rate());
        to.overlooked = self.law.alpha_t * share * mean_of_positive(rates);
        to
    }

    /// A sub-step with plastic slip. The derivatives are those of the equation of plastic slip at its root,
    ///
    /// ```text
    /// dΔλ = ∂G/D,   D = α_t + p (U μ + R ∂μ/∂Δλ)                      ∂G at constant Δλ
    /// dq = d(q_tr − α_t Δλ),   dμ = ∂μ + ∂μ/∂Δλ dΔλ
    /// ```
    /// With a direct effect R μ is multiplied by its factor f: D = α_t + p d(R μ f)/dΔλ, dR = ∂R + U dΔλ.
    #[inline]
    fn slide(&self, from: &PathState, x: f64, pressure: Dual, point: &Point) -> PathState {
        let share = x - from.x;
        let Point { curve_point, slip, .. } = *point;
        let Varied { alpha_t, evolution, .. } = &self.varied;
        let time = self.time * share;
        // The tangent neglects the change by the last step of the search, which would accumulate over many increments.
        let (peak, by_slip) = match self.parameters_vary {
            true => {
                let peak = evolution.after(from.mu, slip, time);
                (peak.mu, peak.slope)
            }
            false => (point.peak.along(from.mu, time), point.peak.slope),
        };
        let ratio = self.ratio_after(from, &curve_point);
        let mut strength = curve_point.ratio * point.peak.mu;
        let mut by_rate = curve_point.rate * point.peak.mu + curve_point.ratio * by_slip;
        let mut resistance = ratio * peak;
        if let (Some(direct), Some(varied)) = (&self.law.direct, &self.varied.direct) {
            let factor = direct.factor(slip, time.value);
            by_rate = by_rate * factor.value + strength * factor.slope;
            strength *= factor.value;
            resistance = resistance * varied.varied(slip, time, factor.value);
        }
        let slope = self.law.alpha_t + pressure.value * by_rate;
        let elastic = self.trial(from, share) - *alpha_t * slip;
        let residual = elastic - resistance * pressure;
        let dslip = residual.map(0.0, 1.0 / slope.max(LEAST_SLOPE * self.law.alpha_t));
        let mut traction = (elastic - dslip * self.law.alpha_t).map(strength * pressure.value, 1.0);
        let mut mu = (peak + dslip * by_slip).map(point.peak.mu, 1.0);
        if !self.parameters_vary {
            for (i, limit) in [STEEPEST * self.law.alpha_t, STEEPEST].into_iter().enumerate() {
                traction.by[i] = traction.by[i].clamp(-limit, limit);
                mu.by[i] = mu.by[i].clamp(-limit / pressure.value, limit / pressure.value);
            }
        }
        let mut weighed_slip = from.weighed_slip;
        if self.weighs {
            let slip = dslip + slip;
            weighed_slip = weighed_slip + slip * evolution.excess(evolution.mean([from.mu, mu], slip, time));
        }
        let plastic_slip = from.plastic_slip + slip;
        let (ratio, work) = ((ratio + dslip * curve_point.rate).map(curve_point.ratio, 1.0), from.work);
        let (overlooked, spread) = (0.0, 0.0);
        let mut to =
            PathState { x, traction, mu, curve_point, ratio, plastic_slip, weighed_slip, work, overlooked, spread };
        self.book(from, &mut to, slip);
        to
    }

    /// R after the plastic slip of a sub-step, with its derivatives at constant slip.
    fn ratio_after(&self, from: &PathState, here: &CurvePoint) -> Dual {
        let Varied { r, elastic_core, direct, .. } = &self.varied;
        let start = match direct {
            Some(_) => from.ratio,
            None => from.traction / (from.mu * self.pressure(from.x.into())),
        };
        self.law.curve.ratio_after(start, [&from.curve_point, here], [*r, *elastic_core])
    }

    /// Books the work of a sub-step with plastic slip, and what it may have overlooked.
    #[inline]
    fn book(&self, from: &PathState, to: &mut PathState, slip: f64) {
        let share = to.x - from.x;
        let [start, end] = [from, to].map(|at| self.balance(at));
        if self.law.direct.is_some() {
            to.work += slip * 0.5 * (from.traction.value + to.traction.value);
        } else {
            let strengths = [from.mu.value * self.pressure_at(from), to.mu.value * self.pressure_at(to)];
            let tractions = [from.traction.value, to.traction.value];
            let steady = mean_of_steady_slip(&self.law.curve, [&from.curve_point, &to.curve_point], strengths);
            let mean = mean_traction(steady, tractions);
            if mean == steady || unsteadiness([&start, &end]) <= STEADY {
                to.work += slip * steady;
            } else {
                to.work += slip * mean;
                to.spread = slip * (steady - mean).abs();
            }
        }
        if !start.in_core && !start.exceeds && end.drive > 0.0 {
            to.overlooked = share * mean_of_positive([-start.drive, -end.drive]);
        }
    }

    /// The traction after a share of the slip without plastic slip.
    #[inline]
    fn trial(&self, from: &PathState, share: f64) -> Dual {
        from.traction + self.varied.alpha_t * self.slip * share
    }

    /// The balance of plastic slip in a state.
    #[inline]
    pub(super) fn balance(&self, at: &PathState) -> Balance {
        let (pressure, mu) = (self.pressure(at.x.into()).value, at.mu.value);
        let CurvePoint { ratio, rate, .. } = at.curve_point;
        let approach = pressure * rate * mu;
        let weakening = pressure * ratio * self.law.evolution.weakening(mu);
        let recovery = ratio * pressure * self.law.evolution.recovery(mu) * self.time.value;
        let pressing = ratio * mu * self.pressure_change();
        Balance {
            approach,
            weakening,
            recovery,
            pressing,
            stiffness: self.law.alpha_t + approach - weakening,
            drive: self.law.alpha_t * self.slip.value - recovery - pressing,
            ratio,
            in_core: at.traction.value < ratio * mu * pressure * (1.0 - ROUND_OFF),
            exceeds: self.law.direct.is_some() && at.traction.value > ratio * mu * pressure * (1.0 + ROUND_OFF),
        }
    }

    /// p [F/L²]
    pub(super) fn pressure(&self, x: Dual) -> Dual {
        self.pressures[0] * (Dual::from(1.0) - x) + self.pressures[1] * x
    }

    /// p at a point of the path [F/L²]
    pub(super) fn pressure_at(&self, path_state: &PathState) -> f64 {
        self.pressure(path_state.x.into()).value
    }

    /// Change of the pressure from x = 0 to 1.
    pub(super) fn pressure_change(&self) -> f64 {
        self.pressures[1].value - self.pressures[0].value
    }
}

/// Mean of q over the plastic slip of a step in which it is steady: μ p is taken as linear in ∫ R dλ.
pub(super) fn mean_of_steady_slip(curve: &SlidingCurve, [start, end]: [&CurvePoint; 2], strengths: [f64; 2]) -> f64 {
    curve.mean_ratio(start, end) * 0.5 * (strengths[0] + strengths[1])
}

/// Mean of q over the plastic slip of a step, steady or not: where the traction decreases, it is itself taken as linear in λ,
/// which is exact for a jump: the contact springs back, and the energy not taken by the strength is lost too.
pub(super) fn mean_traction(steady: f64, [start, end]: [f64; 2]) -> f64 {
    if end < start { 0.5 * (start + end) } else { steady }
}

/// The rate equation of plastic slip in a state of the path, D dλ/dx = drive.
pub(super) struct Balance {
    /// p U μ, contribution of the approach of R to D [F/L³]
    pub approach: f64,
    /// p R κ (μ/μ_k − 1), reduction of D by weakening [F/L³]
    pub weakening: f64,
    /// R p ξ (1 − μ/μ_s) dt/dx and R μ dp/dx: reductions of the drive by recovery and pressure [F/L²]
    pub recovery: f64,
    pub pressing: f64,
    /// D = α_t + approach − weakening [F/L³]
    pub stiffness: f64,
    /// α_t du/dx − recovery − pressing; negative where R decreases without plastic slip [F/L²]
    pub drive: f64,
    /// R [-]
    pub ratio: f64,
    /// Whether the traction is below R μ p, inside the elastic core.
    pub in_core: bool,
    /// Whether the traction is above R μ p, so that slip goes on by the direct effect of its rate.
    pub exceeds: bool,
}

impl Balance {
    /// dλ/dx, negative where R decreases without plastic slip; 0 in the elastic core and where the solution is not unique.
    #[inline]
    fn rate(&self) -> f64 {
        if self.in_core || self.stiffness <= 0.0 { 0.0 } else { self.drive / self.stiffness }
    }
}

/// Largest relative change of the rate of plastic slip within a step in which slip counts as steady.
pub(super) const STEADY: f64 = 0.25;

/// Relative change of the rate of plastic slip within a step; infinite where it is not positive.
#[inline]
pub(super) fn unsteadiness([start, end]: [&Balance; 2]) -> f64 {
    let (stiffness, drive) = (start.stiffness.min(end.stiffness), start.drive.min(end.drive));
    if !(stiffness > 0.0 && drive > 0.0) {
        return f64::INFINITY;
    }
    let change = |part: fn(&Balance) -> f64| (part(end) - part(start)).abs();
    (change(|e| e.approach) + change(|e| e.weakening)) / stiffness
        + (change(|e| e.recovery) + change(|e| e.pressing)) / drive
}

/// Mean of the positive part of a quantity that is linear in a sub-step, from its ends.
#[inline]
fn mean_of_positive([start, end]: [f64; 2]) -> f64 {
    let (most, least) = (start.max(end), start.min(end));
    if most <= 0.0 {
        0.0
    } else if least >= 0.0 {
        0.5 * (most + least)
    } else {
        0.5 * most * most / (most - least)
    }
}

/// One step with plastic slip Δλ, in the direction of the trial traction:
///
/// ```text
/// G(Δλ) = |q_tr| − α_t Δλ − R(Δλ) μ(Δλ) p = 0,   0 < Δλ ≤ |q_tr|/α_t
/// D = −dG/dΔλ = α_t + p (U μ + R ∂μ/∂Δλ)
/// ```
/// With a direct effect of the rate R μ is multiplied by 1 + a ln(1 + Δλ/(V₀ Δt)), which only increases with Δλ.
pub(super) struct SlipEquation<'a> {
    pub law: &'a SuperSubloading,
    /// Point of the sliding curve at which plastic slip starts.
    pub start: CurvePoint,
    /// |q_tr| [F/L²]
    pub trial: f64,
    /// p at the end [F/L²]
    pub pressure: f64,
    /// μ at the beginning [-]
    pub old_mu: f64,
    /// Δt [T]
    pub dt: f64,
}

/// The equation at one point of the curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub curve_point: CurvePoint,
    /// What is searched: the coordinate, or its offset from the start where slip must be known relative to its own size
    place: f64,
    /// Δλ [L]
    pub slip: f64,
    /// μ and its derivatives
    pub peak: Peak,
    /// G [F/L²]
    residual: f64,
    /// D [F/L³]
    pub slope: f64,
    /// Step to the root along the coordinate, by Chebyshev's method
    step: f64,
    /// Whether the step is negligible.
    close: bool,
}

/// Relative excess of a trial traction over the elastic limit that counts as round-off.
pub(super) const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// Residual, relative to |q_tr|, at which the equation counts as solved.
const TOLERANCE: f64 = 3e-14;

/// Step below which no further evaluation is made: to second order, or to first where μ is costly (m or n not 1).
const LAST_STEP: f64 = 1e-5;
const LAST_STEP_OF_FIRST_ORDER: f64 = 1e-8;

/// y below which Chebyshev's method from the start is a poor guess, as U is too large.
const SMALL_Y: f64 = 0.05;

/// Places beyond that of a guess, times itself, at which a search relative to the size of the root ends.
const BEYOND: f64 = 4.0;

/// Width of a piece of the bracket below which two roots cannot be distinguished.
const LEAST_PIECE: f64 = 1e-12;

impl SlipEquation<'_> {
    /// Whether the trial is the solution, without plastic slip; also returns the equation at Δλ = 0.
    #[inline]
    pub(super) fn start(&self) -> (bool, Point) {
        let start = self.point(self.start, self.start.coordinate - self.origin(), 0.0);
        (start.residual <= ROUND_OFF * self.trial, start)
    }

    /// Smallest root, and the number of evaluations.
    ///
    /// # Errors
    /// Returns [`LawFailure::NotConverged`] if it is not isolated.
    #[inline]
    pub(super) fn solve(&self, start: Point) -> Result<(Point, usize), LawFailure> {
        if start.close {
            return Ok((start.moved(self), 1));
        }
        let mut evaluations = 1;
        let end = self.law.curve.beyond(self.trial / self.law.alpha_t, &self.start) - self.origin();
        let most = self.law.direct.map_or(1.0, |direct| direct.factor(self.trial / self.law.alpha_t, self.dt).value);
        let unique = self.pressure * self.law.evolution.weakening(start.peak.mu) * most < self.law.alpha_t;
        let guess = self.guess(&start) - self.origin();
        let bracket = match unique {
            true if self.law.direct.is_some() => [start.place, self.near_end(guess, end, &mut evaluations)],
            true => [start.place, end],
            false => self.first_root_bracket(start, end, &mut evaluations)?,
        };
        let mut point = start;
        bracketed_root(bracket, guess, |place| {
            evaluations += 1;
            point = self.at(place);
            let done = point.close || point.residual.abs() <= TOLERANCE * self.trial;
            Argument { value: point.residual, step: point.step, done }
        });
        Ok((point.moved(self), evaluations))
    }

    #[inline(always)]
    fn at(&self, place: f64) -> Point {
        let curve_point = self.law.curve.at(self.origin() + place, &self.start);
        let long = || (curve_point.slip - self.start.slip).max(0.0);
        match self.law.direct {
            Some(_) => {
                self.point(curve_point, place, self.law.curve.short_slip(&self.start, place).unwrap_or_else(long))
            }
            None => self.point(curve_point, place, long()),
        }
    }

    /// Coordinate from which places are counted.
    #[inline(always)]
    fn origin(&self) -> f64 {
        if self.law.direct.is_some() { self.start.coordinate } else { 0.0 }
    }

    /// A place at or beyond the root, not far beyond, so that the root is resolved relative to its own size.
    fn near_end(&self, guess: f64, end: f64, evaluations: &mut usize) -> f64 {
        let near = BEYOND * guess;
        *evaluations += 1;
        if near > 0.0 && near < end && self.at(near).residual <= 0.0 { near } else { end }
    }

    #[inline(always)]
    fn point(&self, curve_point: CurvePoint, place: f64, slip: f64) -> Point {
        let Self { law: SuperSubloading { alpha_t, .. }, pressure, .. } = *self;
        let CurvePoint { stretch, bend, .. } = curve_point;
        let peak = self.law.evolution.after(self.old_mu, slip, self.dt);
        let strength = self.strength(&curve_point, &peak, slip);
        let residual = self.trial - alpha_t * slip - strength.value * pressure;
        let slope = alpha_t + pressure * strength.slope;
        // −d²G/d(coordinate)²
        let curvature = bend * slope + pressure * stretch * strength.bend;
        let per_gradient = 1.0 / (slope * stretch);
        let newton = residual * per_gradient;
        let bending = 0.5 * newton * curvature * per_gradient;
        let step = if bending.abs() < 0.5 {
            newton * (1.0 - bending)
        } else if let Some(direct) = &self.law.direct {
            // By ln(1 + λ/V₀), in which the strength is linear
            let scale = direct.own_slip(self.dt) + slip;
            scale * (newton * stretch / scale).exp_m1() / stretch
        } else {
            newton
        };
        let close = self.is_close(&curve_point, slip, slope, step);
        Point { curve_point, place, slip, peak, residual, slope, step, close }
    }

    /// The strength per pressure after plastic slip; dU/dζ = −U.
    #[inline(always)]
    fn strength(&self, curve_point: &CurvePoint, peak: &Peak, slip: f64) -> Strength {
        let CurvePoint { stretch, ratio, rate, .. } = *curve_point;
        let strength = Strength {
            value: ratio * peak.mu,
            slope: rate * peak.mu + ratio * peak.slope,
            bend: stretch * (2.0 * rate * peak.slope + ratio * peak.curvature) - rate * peak.mu,
        };
        match &self.law.direct {
            Some(direct) => strength.raised(&direct.factor(slip, self.dt), stretch),
            None => strength,
        }
    }

    /// Whether third-order terms of the step are round-off, which is magnified near the fold D = 0.
    #[inline(always)]
    fn is_close(&self, curve_point: &CurvePoint, slip: f64, slope: f64, step: f64) -> bool {
        let last = if self.law.evolution.is_linear() { LAST_STEP } else { LAST_STEP_OF_FIRST_ORDER };
        let mut relative = curve_point.stretch
            + curve_point.bend
            + curve_point.stretch * curve_point.stretch * self.law.evolution.sharpness();
        if let Some(direct) = &self.law.direct {
            relative += curve_point.stretch * curve_point.stretch / (direct.own_slip(self.dt) + slip);
        }
        step.abs() * relative * self.law.alpha_t <= last * curve_point.stretch * slope.min(self.law.alpha_t)
    }

    /// Initial coordinate: a step from the start or, near R = R_e where U is infinite, the elastic solution if there is
    /// one, else the smallest possible plastic slip.
    #[inline]
    fn guess(&self, start: &Point) -> f64 {
        let strength = start.peak.mu * self.pressure;
        if let Some(direct) = &self.law.direct {
            let own = start.curve_point.ratio * strength;
            // What the contact or the direct effect alone would let slip
            let slip = (start.residual / self.law.alpha_t)
                .min(direct.own_slip(self.dt) * (start.residual / (direct.a * own)).exp_m1());
            if self.law.curve.progress(start.curve_point.ratio) > SMALL_Y || slip < start.curve_point.slip {
                return (start.curve_point.coordinate + slip / start.curve_point.stretch)
                    .min(self.law.curve.beyond(slip, &self.start));
            }
        }
        if self.law.curve.progress(start.curve_point.ratio) > SMALL_Y {
            start.curve_point.coordinate + start.step
        } else if self.trial < 0.9 * strength {
            self.law.curve.approach.locate(self.law.curve.progress(self.trial / strength)).0
        } else {
            self.law.curve.beyond((self.trial - strength).max(0.0) / self.law.alpha_t, &self.start)
        }
    }

    /// A bracket that holds the smallest root, found by plastic slip.
    fn first_root_bracket(&self, start: Point, end: f64, evaluations: &mut usize) -> Result<[f64; 2], LawFailure> {
        let mut at = |place| {
            *evaluations += 1;
            self.at(place)
        };
        let near = start.place + 2.0 * start.step;
        let right = at(if start.place < near && near < end { near } else { end });
        let piece = |left: &Point, right: &Point| Piece {
            ends: [left.place, right.place],
            values: [left.residual, right.residual],
            fall: self.slope_bounds(left, right),
            way: right.slip - left.slip,
        };
        first_root_bracket(start, right, end, LEAST_PIECE, at, piece).map_err(|left| LawFailure::NotConverged {
            evaluations: *evaluations,
            rest: left.residual,
            trial: self.trial,
        })
    }

    /// Smallest and largest D between two points, from the monotonicity of U, R, μ and ∂μ/∂Δλ.
    fn slope_bounds(&self, left: &Point, right: &Point) -> [f64; 2] {
        let mut parts = [
            [right.curve_point.rate * right.peak.mu, right.curve_point.ratio * left.peak.slope],
            [left.curve_point.rate * left.peak.mu, left.curve_point.ratio * right.peak.slope],
        ];
        let mut by_rate = [0.0; 2];
        if let Some(direct) = &self.law.direct {
            let [before, after] = [left, right].map(|point| direct.factor(point.slip, self.dt));
            parts[0] = [parts[0][0] * before.value, parts[0][1] * after.value];
            parts[1] = [parts[1][0] * after.value, parts[1][1] * before.value];
            by_rate = [
                left.curve_point.ratio * right.peak.mu * after.slope,
                right.curve_point.ratio * left.peak.mu * before.slope,
            ];
        }
        [0, 1].map(|k| self.law.alpha_t + self.pressure * (parts[k][0] + parts[k][1] + by_rate[k]))
    }
}

impl Point {
    /// The point after its last step.
    #[inline(always)]
    fn moved(self, equation: &SlipEquation) -> Self {
        let Self { mut curve_point, mut slip, peak, step, close, .. } = self;
        if !close {
            return self;
        }
        let advance = step * (curve_point.stretch + 0.5 * step * curve_point.bend);
        let rise =
            curve_point.rate * step * (curve_point.stretch + 0.5 * step * (curve_point.bend - curve_point.stretch));
        curve_point.coordinate += step;
        curve_point.slip += advance;
        curve_point.stretch += step * curve_point.bend;
        curve_point.ratio = (curve_point.ratio + rise).min(1.0);
        curve_point.rate *= 1.0 - step * (1.0 - 0.5 * step);
        slip = (slip + advance).max(0.0);
        let evolution = equation.law.evolution;
        let peak = if evolution.is_linear() {
            evolution.after(equation.old_mu, slip, equation.dt)
        } else {
            Peak { mu: evolution.clamp(peak.mu + advance * peak.slope), ..peak }
        };
        let slope = equation.law.alpha_t + equation.pressure * equation.strength(&curve_point, &peak, slip).slope;
        Self { curve_point, slip, peak, slope, ..self }
    }
}
