//! How R approaches 1 with plastic slip.

use super::Approach;
use super::approach::Progress;
use super::peak_sensitivity::Shift;

/// How R follows from plastic slip.
///
/// ```text
/// dR/dλ = U(R),   y = (R − R_e)/(1 − R_e),   λ = (1 − R_e)/r T(ζ)
/// ```
#[derive(Clone, Copy, Debug)]
pub(super) struct SlidingCurve {
    pub approach: Approach,
    elastic_core: f64,
    r: f64,
    /// (1 − R_e)/r: plastic slip per T [L]
    length: f64,
    /// 1/(1 − R_e)
    per_range: f64,
}

/// A point of the curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// ζ, or the plastic slip itself where R = 1
    pub coordinate: f64,
    /// Plastic slip up to here, from y = 0 or from where R = 1 was met [L]
    pub slip: f64,
    /// d(slip)/d(coordinate)
    pub stretch: f64,
    /// d²(slip)/d(coordinate)²
    pub bend: f64,
    /// R [-]
    pub ratio: f64,
    /// U = dR/d(slip), 0 where R = 1 [1/L]
    pub rate: f64,
    /// Whether R = 1.
    pub full: bool,
}

/// y below which slip is taken as elastic: small enough to mean R = R_e.
const LEAST_Y: f64 = 1e-100;

impl SlidingCurve {
    pub(super) fn new(approach: Approach, elastic_core: f64, r: f64) -> Self {
        Self { approach, elastic_core, r, length: (1.0 - elastic_core) / r, per_range: 1.0 / (1.0 - elastic_core) }
    }

    /// The point where plastic slip starts from a ratio R.
    #[inline]
    pub(super) fn start(&self, ratio: f64) -> Reach {
        let y = self.progress(ratio).max(LEAST_Y);
        if y < 1.0 {
            let (zeta, here) = self.approach.locate(y);
            self.reach(zeta, &here)
        } else {
            Reach { coordinate: 0.0, slip: 0.0, stretch: 1.0, bend: 0.0, ratio: 1.0, rate: 0.0, full: true }
        }
    }

    /// Whether the point is the beginning of the curve, where U is infinite.
    pub(super) fn begins_at(&self, reach: &Reach) -> bool {
        self.progress(reach.ratio) <= LEAST_Y
    }

    /// The point at a coordinate of the curve that begins at `start`.
    #[inline(always)]
    pub(super) fn at(&self, coordinate: f64, start: &Reach) -> Reach {
        if start.full {
            Reach { coordinate, slip: coordinate, ..*start }
        } else {
            self.reach(coordinate, &self.approach.at(coordinate))
        }
    }

    #[inline]
    fn reach(&self, coordinate: f64, here: &Progress) -> Reach {
        Reach {
            coordinate,
            slip: here.distance * self.length,
            stretch: here.stretch * self.length,
            bend: here.bend * self.length,
            ratio: self.elastic_core + (1.0 - self.elastic_core) * here.y,
            rate: self.r * here.rate,
            full: false,
        }
    }

    /// How R varies with r and R_e after a given plastic slip, R at the start being given.
    pub(super) fn shifted(&self, start: &Reach, here: &Reach, by: &Shift) -> f64 {
        if start.full {
            return 0.0;
        }
        let slip = here.slip - start.slip;
        let passed =
            if self.begins_at(start) { 0.0 } else { (1.0 - self.progress(start.ratio)) * here.rate / start.rate };
        let by_core = 1.0 - self.progress(here.ratio) - passed + here.rate * slip * self.per_range;
        here.rate / self.r * slip * by.r + by_core * by.elastic_core
    }

    /// Mean of R over the plastic slip between two points.
    pub(super) fn mean_ratio(&self, from: &Reach, to: &Reach) -> f64 {
        let slip = to.slip - from.slip;
        if from.full || slip <= 0.0 {
            return to.ratio;
        }
        let area =
            |reach: &Reach| self.approach.area(reach.coordinate, self.progress(reach.ratio), reach.slip / self.length);
        let mean = (area(to) - area(from)) * self.length / slip;
        (self.elastic_core + (1.0 - self.elastic_core) * mean).clamp(from.ratio, to.ratio.max(from.ratio))
    }

    /// A coordinate that is at least `slip` beyond the start.
    #[inline]
    pub(super) fn beyond(&self, slip: f64, start: &Reach) -> f64 {
        let slip = start.slip + slip;
        if start.full { slip } else { self.approach.beyond(slip / self.length) }
    }

    /// y
    #[inline]
    pub(super) fn progress(&self, ratio: f64) -> f64 {
        (ratio - self.elastic_core) * self.per_range
    }
}
