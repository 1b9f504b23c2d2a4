//! How R approaches 1 with plastic slip, integrated exactly.

use std::f64::consts::{FRAC_PI_2, LN_2, PI};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::exponential_integral::{EULER, e1};

/// U(R): how fast the normal-sliding ratio approaches 1 with plastic slip.
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
pub enum Approach {
    /// U = −r ln y
    #[default]
    Logarithmic,
    /// U = r cot(π y/2)
    Cotangent,
}

/// A point on the curve y(T), T = r λ/(1 − R_e) being the plastic slip since y = 0 in units of (1 − R_e)/r.
///
/// The curve is known in closed form along a coordinate ζ that covers 0 < y < 1 evenly from −∞ to ∞:
/// ```text
/// logarithmic:  y = exp(−e^(−ζ)),        T = E₁(e^(−ζ)),             dT/dζ = y
/// cotangent:    y = (2/π) atan(e^ζ),     T = ln(1 + e^(2ζ))/π,       dT/dζ = (2/π)/(1 + e^(−2ζ))
/// ```
/// so that no inverse function is ever needed, and T is nearly linear in ζ where sliding is nearly full.
pub(super) struct Progress {
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
    pub(super) fn at(self, zeta: f64) -> Progress {
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

    /// ζ, T and their derivatives at y, 0 < y < 1.
    #[inline(always)]
    pub(super) fn locate(self, y: f64) -> (f64, Progress) {
        match self {
            Self::Logarithmic => {
                let w = -y.ln();
                let zeta = -w.ln();
                (zeta, Progress { y, distance: e1(w, -zeta, y), stretch: y, bend: y * w, rate: w })
            }
            Self::Cotangent => {
                // Whichever of the two angles is exact in floating point.
                let cotangent = if y < 0.5 { 1.0 / (0.5 * PI * y).tan() } else { (0.5 * PI * (1.0 - y)).tan() };
                let zeta = -cotangent.ln();
                (zeta, Self::Cotangent.at(zeta))
            }
        }
    }

    /// ∫ y dT from y = 0, at a point of the curve.
    ///
    /// ```text
    /// logarithmic:  E₁(2 e^(−ζ))
    /// cotangent:    y T − ∫ T dy,   T = −(2/π) ln sin(π z/2),   z = 1 − y
    ///               ln sin(π z/2) = ln(π z/2) − Σ ζ(2k) (z/2)^(2k)/k
    /// ```
    pub(super) fn area(self, zeta: f64, y: f64, distance: f64) -> f64 {
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

    /// A ζ where T is at least `distance`: T > ζ − γ, or T > 2ζ/π. Close where `distance` is large.
    pub(super) fn beyond(self, distance: f64) -> f64 {
        match self {
            Self::Logarithmic => distance + EULER,
            Self::Cotangent => 0.5 * PI * distance,
        }
    }
}

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

#[cfg(test)]
mod tests {
    use super::Approach;

    /// Simpson's rule between points of the curve, in ζ, where the integrand is smooth.
    #[test]
    fn area_is_the_integral_of_y_over_the_distance() {
        for approach in [Approach::Logarithmic, Approach::Cotangent] {
            for (from, to) in [(-4.0, -3.0), (-3.0, 0.0), (0.0, 5.0), (-2.0, 30.0), (30.0, 60.0)] {
                let area = |zeta: f64| {
                    let here = approach.at(zeta);
                    approach.area(zeta, here.y, here.distance)
                };
                let steps = 4000;
                let h = (to - from) / f64::from(steps);
                let sum: f64 = (0..=steps)
                    .map(|i| {
                        let here = approach.at(from + f64::from(i) * h);
                        let weight = if i == 0 || i == steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
                        weight * here.y * here.stretch * h / 3.0
                    })
                    .sum();
                let error = area(to) - area(from) - sum;
                assert!(error.abs() < 1e-12 * (1.0 + sum), "{approach:?} from {from} to {to}: {error:e} in {sum}");
            }
        }
    }
}
