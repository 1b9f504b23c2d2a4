//! How R approaches 1 with plastic slip, integrated exactly.

use std::f64::consts::PI;

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
    /// dy/dT = U/r [-]
    pub rate: f64,
}

impl Approach {
    /// y, T and their derivatives at ζ.
    pub(super) fn at(self, zeta: f64) -> Progress {
        match self {
            Self::Logarithmic => {
                let w = (-zeta).exp();
                let y = (-w).exp();
                Progress { y, distance: e1(w, -zeta, y), stretch: y, rate: w }
            }
            Self::Cotangent => {
                let cotangent = (-zeta).exp();
                Progress {
                    y: (1.0 / cotangent).atan() * (2.0 / PI),
                    distance: (2.0 * zeta.max(0.0) + (-2.0 * zeta.abs()).exp().ln_1p()) / PI,
                    stretch: 2.0 / PI / (1.0 + cotangent * cotangent),
                    rate: cotangent,
                }
            }
        }
    }

    /// ζ, T and their derivatives at y, 0 < y < 1.
    pub(super) fn locate(self, y: f64) -> (f64, Progress) {
        match self {
            Self::Logarithmic => {
                let w = -y.ln();
                let zeta = -w.ln();
                (zeta, Progress { y, distance: e1(w, -zeta, y), stretch: y, rate: w })
            }
            Self::Cotangent => {
                // Whichever of the two angles is exact in floating point.
                let cotangent = if y < 0.5 { 1.0 / (0.5 * PI * y).tan() } else { (0.5 * PI * (1.0 - y)).tan() };
                let zeta = -cotangent.ln();
                (zeta, Self::Cotangent.at(zeta))
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
