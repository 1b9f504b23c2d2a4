//! Damping as it is written.

use schemars::JsonSchema;
use serde::Deserialize;

/// Rayleigh damping. A vibration of angular frequency w decays with the damping ratio (mass/w + stiffness w)/2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DampingInput {
    /// Force per momentum: damps slow motions most, free flight included [1/T]
    pub mass: f64,
    /// Kelvin-Voigt: viscous stress, this time times the elastic stress of the rate of strain; damps fast vibrations most,
    /// and makes explicit increments shorter [T]
    pub stiffness: f64,
}
