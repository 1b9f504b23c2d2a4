//! Approach of R to 1 with plastic slip, integrated exactly; with the exponential integral E₁, accurate to round-off.

use std::f64::consts::{FRAC_PI_2, LN_2, PI};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::laws::dual::{Dual, Number};

/// Sliding curve: R as a function of plastic slip.
///
/// ```text
/// dR/dλ = U(R),   y = (R − R_e)/(1 − R_e),   λ = (1 − R_e)/r T(ζ)
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SlidingCurve {
    pub approach: Approach,
    pub elastic_core: f64,
    pub r: f64,
    /// (1 − R_e)/r: plastic slip per T [L]
    length: f64,
    /// 1/(1 − R_e)
    per_range: f64,
}

/// A point of the curve.
#[derive(Clone, Copy, Debug)]
pub struct CurvePoint {
    /// ζ, or the plastic slip itself if R = 1
    pub coordinate: f64,
    /// Plastic slip up to here, from y = 0 or from where R = 1 was reached [L]
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

/// y below which slip counts as elastic: so small that R = R_e numerically.
const LEAST_Y: f64 = 1e-100;

/// Step of the coordinate below which a series of four terms is exact.
const SHORT: f64 = 1e-3;

impl SlidingCurve {
    pub fn new(approach: Approach, elastic_core: f64, r: f64) -> Self {
        Self { approach, elastic_core, r, length: (1.0 - elastic_core) / r, per_range: 1.0 / (1.0 - elastic_core) }
    }

    /// The point at which plastic slip starts from a ratio R.
    #[inline]
    pub fn start(&self, ratio: f64) -> CurvePoint {
        let y = self.progress(ratio).max(LEAST_Y);
        if y < 1.0 {
            let (zeta, here) = self.approach.locate(y);
            self.curve_point(zeta, &here)
        } else {
            CurvePoint { coordinate: 0.0, slip: 0.0, stretch: 1.0, bend: 0.0, ratio: 1.0, rate: 0.0, full: true }
        }
    }

    /// Whether the point is the beginning of the curve, where U is infinite.
    pub(super) fn begins_at(&self, curve_point: &CurvePoint) -> bool {
        self.progress(curve_point.ratio) <= 2.0 * LEAST_Y
    }

    /// The point at a coordinate of the curve that starts at `start`.
    #[inline(always)]
    pub fn at(&self, coordinate: f64, start: &CurvePoint) -> CurvePoint {
        if start.full {
            CurvePoint { coordinate, slip: coordinate, ..*start }
        } else {
            self.curve_point(coordinate, &self.approach.at(coordinate))
        }
    }

    /// Plastic slip from `start` over a step of the coordinate, without cancellation where it is short; `None` where it is not.
    pub fn short_slip(&self, start: &CurvePoint, step: f64) -> Option<f64> {
        if start.full {
            return Some(step);
        }
        let (w, sharpness) = ((-start.coordinate).exp(), start.bend / start.stretch);
        if step.abs() * (1.0 + w + sharpness.abs()) > SHORT {
            return None;
        }
        let [third, fourth] = self.approach.higher(w);
        let rest = 1.0 + step * (0.5 * sharpness + step * (third / 6.0 + step * fourth / 24.0));
        Some(start.stretch * step * rest)
    }

    #[inline]
    fn curve_point(&self, coordinate: f64, here: &Progress) -> CurvePoint {
        CurvePoint {
            coordinate,
            slip: here.distance * self.length,
            stretch: here.stretch * self.length,
            bend: here.bend * self.length,
            ratio: self.elastic_core + (1.0 - self.elastic_core) * here.y,
            rate: self.r * here.rate,
            full: false,
        }
    }

    /// R after the plastic slip from `start` to `here`, with the derivatives by R at the start, r and R_e.
    #[inline]
    pub(super) fn ratio_after(&self, old: Dual, [start, here]: [&CurvePoint; 2], [r, core]: [Dual; 2]) -> Dual {
        // Far along the curve U underflows: R is 1 there too.
        if start.full || start.rate == 0.0 {
            return here.ratio.into();
        }
        let slip = here.slip - start.slip;
        // R at the start is irrelevant where the curve begins, and no number without pressure.
        let (old, by_old) = match self.begins_at(start) {
            true => (0.0.into(), 0.0),
            false => (old, here.rate / start.rate),
        };
        let by_core = 1.0 - self.progress(here.ratio) - by_old * (1.0 - self.progress(start.ratio))
            + here.rate * slip * self.per_range;
        old.map(here.ratio, by_old) + r.map(0.0, here.rate / self.r * slip) + core.map(0.0, by_core)
    }

    /// Mean of R over the plastic slip between two points.
    pub(super) fn mean_ratio(&self, from: &CurvePoint, to: &CurvePoint) -> f64 {
        let slip = to.slip - from.slip;
        if from.full || slip <= 0.0 {
            return to.ratio;
        }
        let area = |curve_point: &CurvePoint| {
            self.approach.area(curve_point.coordinate, self.progress(curve_point.ratio), curve_point.slip / self.length)
        };
        let mean = (area(to) - area(from)) * self.length / slip;
        (self.elastic_core + (1.0 - self.elastic_core) * mean).clamp(from.ratio, to.ratio.max(from.ratio))
    }

    /// A coordinate at least `slip` beyond the start.
    #[inline]
    pub(super) fn beyond(&self, slip: f64, start: &CurvePoint) -> f64 {
        let slip = start.slip + slip;
        if start.full { slip } else { self.approach.beyond(slip / self.length) }
    }

    /// Normalized progress y of R.
    #[inline]
    pub(super) fn progress(&self, ratio: f64) -> f64 {
        (ratio - self.elastic_core) * self.per_range
    }
}

/// U(R): rate of approach of the normal-sliding ratio to 1 with plastic slip.
///
/// ```text
/// dR/dλ = U(R),   y = (R − R_e)/(1 − R_e)
/// U = −r ln y            logarithmic (the authors' choice)
/// U = r cot(π y/2)       cotangent (their earlier subloading-friction models)
/// ```
/// Both are infinite at y = 0 (elastic) and 0 at y = 1 (full sliding).
///
/// Source: Toyoda, Yasuike & Noda (2024), Tribology International 191:109080, eq. 13; Ozaki & Hashiguchi (2010),
/// Tribology International 43:2120.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub enum Approach {
    /// U = −r ln y
    #[default]
    Logarithmic,
    /// U = r cot(π y/2)
    Cotangent,
}

/// A point on the curve y(T), T = r λ/(1 − R_e) being the plastic slip since y = 0 in units of (1 − R_e)/r.
///
/// The curve has a closed form in a coordinate ζ that covers 0 < y < 1 evenly from −∞ to ∞:
/// ```text
/// logarithmic:  y = exp(−e^(−ζ)),        T = E₁(e^(−ζ)),             dT/dζ = y
/// cotangent:    y = (2/π) atan(e^ζ),     T = ln(1 + e^(2ζ))/π,       dT/dζ = (2/π)/(1 + e^(−2ζ))
/// ```
/// so that no inverse function is needed, and T is nearly linear in ζ where sliding is nearly full.
pub struct Progress {
    /// y = (R − R_e)/(1 − R_e) [-]
    pub y: f64,
    /// T [-]
    pub distance: f64,
    /// dT/dζ [-]
    pub stretch: f64,
    /// d²T/dζ² [-]
    pub bend: f64,
    /// dy/dT = U/r = e^(−ζ) [-]
    pub rate: f64,
}

impl Approach {
    /// y, T and their derivatives at ζ.
    #[inline(always)]
    #[doc(hidden)]
    pub fn at(self, zeta: f64) -> Progress {
        match self {
            Self::Logarithmic => {
                let w = (-zeta).exp();
                let y = (-w).exp();
                Progress { y, distance: e1(w, -zeta, y), stretch: y, bend: y * w, rate: w }
            }
            Self::Cotangent => {
                let cotangent = (-zeta).exp();
                let share = 1.0 / (1.0 + cotangent * cotangent);
                Progress {
                    y: (1.0 / cotangent).atan() * (2.0 / PI),
                    distance: (2.0 * zeta.max(0.0) + (-2.0 * zeta.abs()).exp().ln_1p()) / PI,
                    stretch: 2.0 / PI * share,
                    bend: 4.0 / PI * share * (1.0 - share),
                    rate: cotangent,
                }
            }
        }
    }

    /// d³T/dζ³ and d⁴T/dζ⁴ at w = e^(−ζ), divided by dT/dζ.
    ///
    /// ```text
    /// logarithmic:  w² − w,  w³ − 3 w² + w
    /// cotangent:    4 z (z − s),  8 z (z² − 4 z s + s²)      s = 1/(1 + w²), z = 1 − s
    /// ```
    #[doc(hidden)]
    pub fn higher(self, w: f64) -> [f64; 2] {
        match self {
            Self::Logarithmic => [w * (w - 1.0), w * (w * (w - 3.0) + 1.0)],
            Self::Cotangent => {
                let s = 1.0 / (1.0 + w * w);
                let z = 1.0 - s;
                [4.0 * z * (z - s), 8.0 * z * (z * z - 4.0 * z * s + s * s)]
            }
        }
    }

    /// ζ, T and their derivatives at y, 0 < y < 1.
    #[inline(always)]
    #[doc(hidden)]
    pub fn locate(self, y: f64) -> (f64, Progress) {
        match self {
            Self::Logarithmic => {
                let w = -y.ln();
                let zeta = -w.ln();
                (zeta, Progress { y, distance: e1(w, -zeta, y), stretch: y, bend: y * w, rate: w })
            }
            Self::Cotangent => {
                // The angle that is exact in floating point is used.
                let cotangent = if y < 0.5 { 1.0 / (0.5 * PI * y).tan() } else { (0.5 * PI * (1.0 - y)).tan() };
                let zeta = -cotangent.ln();
                (zeta, Self::Cotangent.at(zeta))
            }
        }
    }

    /// The point at a distance beyond y, 0 < y < 1. T is convex in ζ: Newton's method comes down to the root from a ζ that is too large.
    #[doc(hidden)]
    pub fn after(self, y: f64, distance: f64) -> Progress {
        let (zeta, start) = self.locate(y);
        let target = start.distance + distance;
        let mut zeta = (zeta + distance / start.stretch).min(self.beyond(target));
        let mut here = self.at(zeta);
        for _ in 0..MOST {
            let next = zeta - (here.distance - target) / here.stretch;
            if next.is_nan() || next >= zeta {
                break;
            }
            zeta = next;
            here = self.at(zeta);
        }
        here
    }

    /// ∫ y dT from y = 0, at a point of the curve.
    ///
    /// ```text
    /// logarithmic:  E₁(2 e^(−ζ))
    /// cotangent:    y T − ∫ T dy,   T = −(2/π) ln sin(π z/2),   z = 1 − y
    ///               ln sin(π z/2) = ln(π z/2) − Σ ζ(2k) (z/2)^(2k)/k
    /// ```
    #[doc(hidden)]
    pub fn area(self, zeta: f64, y: f64, distance: f64) -> f64 {
        match self {
            Self::Logarithmic => e1(2.0 * (-zeta).exp(), LN_2 - zeta, y * y),
            Self::Cotangent => {
                let z = 1.0 - y;
                let regular = SINE_SERIES.iter().rev().fold(0.0, |sum, term| sum * z * z + term) * z * z * z;
                let logarithm = if z > 0.0 { z * z.ln() } else { 0.0 };
                let below = y * (1.0 - FRAC_PI_2.ln()) + logarithm + (PI.ln() - 1.0) - regular;
                y * distance - 2.0 / PI * below
            }
        }
    }

    /// A ζ where T is at least `distance`: T > ζ − γ, or T > 2ζ/π; close where `distance` is large.
    pub(super) fn beyond(self, distance: f64) -> f64 {
        match self {
            Self::Logarithmic => distance + EULER,
            Self::Cotangent => 0.5 * PI * distance,
        }
    }
}

/// Most iterations for the point at a distance.
const MOST: usize = 200;

/// ζ(2k)/(k (2k + 1) 4^k), k = 1, 2 …: −∫₀^z ln(sin(π x/2)/(π x/2)) dx in powers z³, z⁵ …
const SINE_SERIES: [f64; 22] = [
    0.137_077_838_904_018_87,
    0.006_764_520_210_694_613,
    0.000_756_951_683_024_143_8,
    0.000_108_949_365_906_895_01,
    1.777_334_117_769_563e-5,
    3.130_778_265_704_214_3e-6,
    5.813_228_051_380_317e-7,
    1.121_986_930_240_640_8e-7,
    2.230_825_630_083_731_3e-8,
    4.541_310_600_834_955e-9,
    9.423_661_500_102_473e-10,
    1.986_821_610_943_852e-10,
    4.245_345_132_734_509e-11,
    9.175_591_902_314_938e-12,
    2.002_844_248_350_204e-12,
    4.409_671_282_349_997e-13,
    9.782_800_154_093_368e-14,
    2.184_972_256_543_334_8e-14,
    4.909_553_046_025_571e-15,
    1.109_139_880_211_896_8e-15,
    2.517_980_901_918_978_3e-16,
    5.741_759_480_890_025e-17,
];

/// Argument below which the entire part of E₁ is used, and above which the scaled tail.
const SPLIT: f64 = 1.5;

/// γ: Euler's constant
const EULER: f64 = 0.577_215_664_901_532_9;

/// E₁(w) for w ≥ 0; callers supply ln w and e^(−w), the two costly parts.
///
/// ```text
/// E₁(w) = ∫_w^∞ e^(−t)/t dt = −γ − ln w + Ein(w)            li(y) = −E₁(−ln y) for 0 < y < 1
/// Ein(w) = ∫_0^w (1 − e^(−t))/t dt
/// ```
/// `Ein(w)/w` on [0, 1.5] and `w e^w E₁(w)` as a function of 1/w ≤ 2/3 are rational interpolants at Chebyshev nodes,
/// with relative errors of 7e-18 and 4e-16.
///
/// Source: Abramowitz & Stegun, section 5.1.
#[inline(always)]
pub fn e1(w: f64, ln_w: f64, exp_of_minus_w: f64) -> f64 {
    if w <= SPLIT { w * rational(w, &ENTIRE) - ln_w - EULER } else { exp_of_minus_w / w * rational(1.0 / w, &TAIL) }
}

/// Σ aᵢ xⁱ / Σ bᵢ xⁱ; even and odd powers are separate, which halves the chain of dependent operations.
#[inline(always)]
fn rational(x: f64, coefficients: &[(f64, f64)]) -> f64 {
    let square = x * x;
    let (mut even, mut odd) = ((0.0, 0.0), (0.0, 0.0));
    for pair in coefficients.chunks_exact(2).rev() {
        even = (even.0 * square + pair[0].0, even.1 * square + pair[0].1);
        odd = (odd.0 * square + pair[1].0, odd.1 * square + pair[1].1);
    }
    (even.0 + x * odd.0) / (even.1 + x * odd.1)
}

/// Ein(w)/w in powers of w
const ENTIRE: [(f64, f64); 6] = [
    (1.0, 1.0),
    (0.173_384_596_893_164_2, 0.423_384_596_893_165_3),
    (0.028_437_328_567_483_17, 0.078_727_922_235_189_61),
    (0.001_540_824_137_546_128_8, 0.008_118_104_869_258_325),
    (7.086_910_172_949_46e-5, 0.000_470_211_410_768_340_4),
    (-2.421_429_653_281_506_3e-8, 1.244_582_798_566_304_6e-5),
];

/// w e^w E₁(w) in powers of 1/w
const TAIL: [(f64, f64); 12] = [
    (0.999_999_999_999_999_5, 1.0),
    (43.402_775_421_935_05, 44.402_775_421_934_18),
    (744.427_874_415_556_5, 786.830_649_837_759_1),
    (6_565.671_696_946_282, 7_269.696_795_903_098),
    (32_509.026_581_771_254, 38_447.478_733_569_64),
    (92_801.832_543_840_85, 120_485.234_802_826_9),
    (151_410.358_470_055_45, 224_343.221_381_779_35),
    (135_693.808_780_352_13, 242_768.134_844_614_7),
    (61_699.493_986_473_38, 145_276.172_769_427_75),
    (12_249.501_994_513_564, 43_907.495_038_502_07),
    (762.532_231_883_804_8, 5_650.468_135_947_691),
    (3.330_039_552_536_742_5, 208.384_415_178_490_45),
];
