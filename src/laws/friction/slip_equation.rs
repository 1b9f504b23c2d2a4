//! The scalar equation of plastic slip, and its smallest root.

use super::LawFailure;
use super::peak::{Peak, PeakEvolution};
use super::root::{Argument, bracketed_root};
use super::sliding_curve::{Reach, SlidingCurve};

/// One step with plastic slip Δλ, in the direction of the trial traction:
///
/// ```text
/// G(Δλ) = |q_tr| − α_t Δλ − R(Δλ) μ(Δλ) p = 0,   0 < Δλ ≤ |q_tr|/α_t
/// D = −dG/dΔλ = α_t + p (U μ + R ∂μ/∂Δλ)
/// ```
pub(super) struct SlipEquation<'a> {
    pub curve: &'a SlidingCurve,
    pub evolution: &'a PeakEvolution,
    /// α_t [F/L³]
    pub alpha_t: f64,
    /// Where plastic slip starts.
    pub start: Reach,
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
    pub reach: Reach,
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
    /// Whether the step is so small that it is as good as made.
    close: bool,
}

/// Trial tractions above the elastic limit by less than this, relative, are round-off.
pub(super) const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// Residual, relative to |q_tr|, at which the equation is solved.
const TOLERANCE: f64 = 3e-14;

/// Steps below this are made without another evaluation: to second order, or to first where μ is costly (m or n not 1).
const LAST_STEP: f64 = 1e-5;
const LAST_STEP_OF_FIRST_ORDER: f64 = 1e-8;

/// y below which Chebyshev's method from the start is no good guess, as U is too large.
const SMALL_Y: f64 = 0.05;

/// Most pieces of the bracket that are examined for the first root.
const MAX_PIECES: usize = 1000;

/// Pieces of the bracket narrower than this hold roots that cannot be told apart.
const LEAST_PIECE: f64 = 1e-12;

impl SlipEquation<'_> {
    /// Whether the trial is the answer: no plastic slip. Gives the equation at Δλ = 0.
    #[inline]
    pub(super) fn start(&self) -> (bool, Point) {
        let start = self.point(self.start);
        (start.residual <= ROUND_OFF * self.trial, start)
    }

    /// The smallest root, and how many evaluations it took.
    ///
    /// # Errors
    /// [`LawFailure::NotConverged`] when it is not singled out.
    #[inline]
    pub(super) fn solve(&self, start: Point) -> Result<(Point, usize), LawFailure> {
        if start.close {
            return Ok((start.moved(self), 1));
        }
        let mut evaluations = 1;
        let end = self.curve.beyond(self.trial / self.alpha_t, &self.start);
        let unique = self.pressure * self.evolution.weakening(start.peak.mu) < self.alpha_t;
        let bracket =
            if unique { (self.start.coordinate, end) } else { self.first_root_bracket(start, end, &mut evaluations)? };
        let mut point = start;
        bracketed_root(bracket, self.guess(&start), |coordinate| {
            evaluations += 1;
            point = self.at(coordinate);
            let done = point.close || point.residual.abs() <= TOLERANCE * self.trial;
            Argument { value: point.residual, step: point.step, done }
        });
        Ok((point.moved(self), evaluations))
    }

    #[inline(always)]
    fn at(&self, coordinate: f64) -> Point {
        self.point(self.curve.at(coordinate, &self.start))
    }

    #[inline(always)]
    fn point(&self, reach: Reach) -> Point {
        let Self { alpha_t, pressure, .. } = *self;
        let Reach { stretch, bend, ratio, rate, .. } = reach;
        let slip = (reach.slip - self.start.slip).max(0.0);
        let peak = self.evolution.after(self.old_mu, slip, self.dt);
        let residual = self.trial - alpha_t * slip - ratio * peak.mu * pressure;
        let slope = self.slope(ratio, rate, &peak);
        // −d²G/d(coordinate)², as dU/dζ = −U
        let curvature = bend * slope
            + pressure * stretch * (stretch * (2.0 * rate * peak.slope + ratio * peak.curvature) - rate * peak.mu);
        let per_gradient = 1.0 / (slope * stretch);
        let newton = residual * per_gradient;
        let bending = 0.5 * newton * curvature * per_gradient;
        let step = if bending.abs() < 0.5 { newton * (1.0 - bending) } else { newton };
        let close = self.is_close(&reach, slope, step);
        Point { reach, slip, peak, residual, slope, step, close }
    }

    #[inline(always)]
    fn slope(&self, ratio: f64, rate: f64, peak: &Peak) -> f64 {
        self.alpha_t + self.pressure * (rate * peak.mu + ratio * peak.slope)
    }

    /// The point with μ and D as they are there, and not as they were before the last step.
    pub(super) fn settled(&self, point: Point) -> Point {
        let peak = self.evolution.after(self.old_mu, point.slip, self.dt);
        Point { peak, slope: self.slope(point.reach.ratio, point.reach.rate, &peak), ..point }
    }

    /// Whether terms of third order of the step are round-off; the fold where D = 0 magnifies them.
    #[inline(always)]
    fn is_close(&self, reach: &Reach, slope: f64, step: f64) -> bool {
        let last = if self.evolution.is_linear() { LAST_STEP } else { LAST_STEP_OF_FIRST_ORDER };
        let relative = reach.stretch + reach.bend + reach.stretch * reach.stretch * self.evolution.sharpness();
        step.abs() * relative * self.alpha_t <= last * reach.stretch * slope.min(self.alpha_t)
    }

    /// A first coordinate: a step from the start or, near R = R_e where U is infinite, the elastic answer if there is
    /// one, else the least plastic slip possible.
    #[inline]
    fn guess(&self, start: &Point) -> f64 {
        let strength = start.peak.mu * self.pressure;
        if self.curve.progress(start.reach.ratio) > SMALL_Y {
            start.reach.coordinate + start.step
        } else if self.trial < 0.9 * strength {
            self.curve.approach.locate(self.curve.progress(self.trial / strength)).0
        } else {
            self.curve.beyond((self.trial - strength).max(0.0) / self.alpha_t, &self.start)
        }
    }

    /// A bracket that holds the smallest root, and no other unless they cannot be told apart.
    ///
    /// Pieces of the bracket are examined from the left with bounds D₋ ≤ D ≤ D₊ of the slope on each: it holds one
    /// root or none if D₋ > 0, none if G stays positive between the lines of slope −D₊ from its left end and −D₋ from
    /// its right, and is halved otherwise.
    fn first_root_bracket(&self, start: Point, end: f64, evaluations: &mut usize) -> Result<(f64, f64), LawFailure> {
        let mut at = |coordinate| {
            *evaluations += 1;
            self.at(coordinate)
        };
        let mut left = start;
        let near = start.reach.coordinate + 2.0 * start.step;
        let mut right = at(if start.reach.coordinate < near && near < end { near } else { end });
        for _ in 0..MAX_PIECES {
            let (low, high) = (left.reach.coordinate, right.reach.coordinate);
            let (least, most) = self.slope_bounds(&left, &right);
            let narrow = high - low <= LEAST_PIECE * (1.0 + low.abs());
            if right.residual <= 0.0 && (least > 0.0 || narrow) {
                return Ok((low, high));
            }
            let crossing_needs = left.residual / most.max(0.0) + right.residual / (-least).max(0.0);
            let rootless = right.residual > 0.0 && (least > 0.0 || crossing_needs > right.slip - left.slip);
            if rootless || narrow {
                if high >= end {
                    return Ok((low, end)); // but for round-off G is not positive there
                }
                left = right;
                right = at(end.min(high + 2.0 * (high - low)));
            } else {
                right = at(low + 0.5 * (high - low));
            }
        }
        Err(LawFailure::NotConverged { evaluations: *evaluations, rest: left.residual, trial: self.trial })
    }

    /// Least and greatest D between two points, from the monotony of U, R, μ and ∂μ/∂Δλ.
    fn slope_bounds(&self, left: &Point, right: &Point) -> (f64, f64) {
        let least = right.reach.rate * right.peak.mu + right.reach.ratio * left.peak.slope;
        let most = left.reach.rate * left.peak.mu + left.reach.ratio * right.peak.slope;
        (self.alpha_t + self.pressure * least, self.alpha_t + self.pressure * most)
    }
}

impl Point {
    /// The point after its last step.
    #[inline(always)]
    fn moved(self, equation: &SlipEquation) -> Self {
        let Self { mut reach, mut slip, peak, step, close, .. } = self;
        if !close {
            return self;
        }
        let advance = step * (reach.stretch + 0.5 * step * reach.bend);
        let rise = reach.rate * step * (reach.stretch + 0.5 * step * (reach.bend - reach.stretch));
        reach.coordinate += step;
        reach.slip += advance;
        reach.stretch += step * reach.bend;
        reach.ratio = (reach.ratio + rise).min(1.0);
        reach.rate *= 1.0 - step * (1.0 - 0.5 * step);
        slip = (slip + advance).max(0.0);
        let evolution = equation.evolution;
        let peak = if evolution.is_linear() {
            evolution.after(equation.old_mu, slip, equation.dt)
        } else {
            Peak { mu: evolution.clamp(peak.mu + advance * peak.slope), ..peak }
        };
        let slope = equation.slope(reach.ratio, reach.rate, &peak);
        Self { reach, slip, peak, slope, ..self }
    }
}
