//! How a prescribed quantity varies, as it is written.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

use crate::case::choice::Choice;

/// How a quantity varies.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum DriveInput {
    /// Value at the end of the step, reached linearly
    Constant(f64),
    /// Expression in the reference position x, y and the run time t, with + - * / ^, brackets, pi, tau, e, and functions: abs, acos,
    /// acosh, asin, asinh, atan, atanh, atan2(y, x), cbrt, ceil, cos, cosh, exp, floor, fract, ln, log (= ln), log10, log2,
    /// max(a, b), min(a, b), round, signum, sin, sinh, sqrt, tan, tanh, trunc. -x^2 is -(x^2)
    Expression(String),
    /// Variation in time
    InTime(TimeInput),
}

impl<'de> Deserialize<'de> for DriveInput {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting =
            "a number, an expression in x, y, t such as \"0.01*y*t\", {\"rate\": v}, or {\"table\": [[t, v], …]}";
        Choice { expecting, number: Some(Self::Constant), text: Self::Expression, object: Self::InTime }
            .read(deserializer)
    }
}

/// A variation in time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TimeInput {
    /// Value at the start of the step plus rate × time since [1/T]
    Rate(f64),
    /// Pairs of run time and value, times ascending; linear between, constant outside
    Table(Vec<[f64; 2]>),
}

/// Components of a vector; zero unless given.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Components {
    /// x component
    pub x: Option<DriveInput>,
    /// y component
    pub y: Option<DriveInput>,
}
