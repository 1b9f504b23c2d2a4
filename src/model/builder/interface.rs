//! Strength of an interface as engineers give it: a share of that of the adjacent soil, or cohesion and angle.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Strength of an interface, c_i + p tan φ_i: a share of that of the adjacent soil, or by its own numbers. In place of `friction`, and of
/// the `strength` of a bond.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Interface {
    /// R: share of the cohesion and of tan φ of the body adjacent to the interface that yields by mohr_coulomb, drucker_prager or von_mises
    /// (c = σ_y/√3, φ = 0), as it is before any softening, 0 ≤ R ≤ 1. Without `cohesion` and `friction_angle` [-]
    pub reduction: Option<f64>,
    /// Name of that body, where bodies adjacent to the interface differ in strength
    pub of: Option<String>,
    /// c_i, c_i ≥ 0; default 0 where `friction_angle` is given [F/L²]
    pub cohesion: Option<f64>,
    /// φ_i, 0 ≤ φ_i < 90; default 0 where `cohesion` is given [degrees]
    pub friction_angle: Option<f64>,
}

impl Interface {
    /// A share of the strength of the adjacent soil.
    pub fn reduced(reduction: f64) -> Self {
        Self { reduction: Some(reduction), ..Self::default() }
    }

    /// A cohesion [F/L²] and an angle of friction [degrees].
    pub fn new(cohesion: f64, friction_angle: f64) -> Self {
        Self { cohesion: Some(cohesion), friction_angle: Some(friction_angle), ..Self::default() }
    }

    /// Names the body whose strength is reduced.
    pub fn of(self, body: impl Into<String>) -> Self {
        Self { of: Some(body.into()), ..self }
    }
}
