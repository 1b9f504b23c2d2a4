//! What is imposed on bodies, as it is written.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

use super::profile::ProfileInput;
use crate::case::choice::Choice;

/// Stress of a body before anything has moved. Displacements and strains count from there, stresses are whole. The run tells how far
/// it is out of balance with what acts at the start of the first step; loads that are there from the start are expressions,
/// such as "-9.81" for a gravity, for a number grows from zero over the step
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum InitialStressInput {
    /// Ground at rest under its weight along -y
    Geostatic(GeostaticInput),
    /// Components of the stress, tension positive
    Components(StressInput),
}

/// Ground at rest: σ_yy = −weight (surface − y), and σ_xx = σ_zz = K0 σ_yy; σ_zz = 0 in a plate.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GeostaticInput {
    /// Level y at which the vertical stress is zero: the top of the body, or above it if it lies deeper [L]
    pub surface: f64,
    /// γ: weight per volume, the density times gravity, above 0 [F/L³]
    pub weight: f64,
    /// K₀: horizontal over vertical stress, zero or positive; 1 − sin φ of loose ground, ν/(1 − ν) of an elastic body that cannot
    /// widen [-]
    #[serde(rename = "K0")]
    pub k0: f64,
}

/// Components of a stress.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StressInput {
    /// σ_xx [F/L²]
    pub xx: ProfileInput,
    /// σ_yy [F/L²]
    pub yy: ProfileInput,
    /// σ_xy; 0 unless given [F/L²]
    #[serde(default)]
    pub xy: ProfileInput,
    /// σ_zz: across the plane, of rings along the hoops. Needed but in plane stress, where it is 0 [F/L²]
    pub zz: Option<ProfileInput>,
}

/// Thermal expansion of a body, whose `temperature` the steps give. With F = (1 + α (T − T₀)) F_e the material sees F_e; a `linear`
/// one sees the strain less α (T − T₀).
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThermalInput {
    /// α: strain per temperature, against the undeformed body [1/Θ]
    pub expansion: f64,
    /// T₀: temperature of the undeformed body, which it has until a step gives another [Θ]
    #[serde(default)]
    pub reference: f64,
}

/// How warm a body is.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum TemperatureInput {
    /// Temperature at the end of the step, reached linearly from the one at its start
    Constant(f64),
    /// Expression in the reference position x, y and the run time t
    Expression(String),
    /// Variation in time, or by a coordinate
    Varying(TemperatureVariation),
}

impl<'de> Deserialize<'de> for TemperatureInput {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "a number, an expression in x, y, t such as \"20 + 5*x*t\", {\"rate\": v}, {\"table\": [[t, v], …]}, or \
                         {\"x\": [[x, v], …]}";
        Choice { expecting, number: Some(Self::Constant), text: Self::Expression, object: Self::Varying }
            .read(deserializer)
    }
}

/// A temperature that varies. A table by x or y, of the reference position, is reached at the end of the step, linearly from the
/// temperature at its start: linear between, constant outside, the same coordinate twice is a jump.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TemperatureVariation {
    /// Value at the start of the step plus rate × time since [1/T]
    Rate(f64),
    /// Pairs of run time and value, times ascending; linear between, constant outside
    Table(Vec<[f64; 2]>),
    /// Pairs of x and value, x ascending
    X(Vec<[f64; 2]>),
    /// Pairs of y and value, y ascending
    Y(Vec<[f64; 2]>),
}
