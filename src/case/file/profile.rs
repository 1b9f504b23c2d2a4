//! Profiles along a surface as they are written.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

use crate::case::choice::Choice;

/// How a quantity varies along a surface.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum ProfileInput {
    /// The same everywhere
    Constant(f64),
    /// Expression in the reference position x, y
    Expression(String),
    /// Table by a coordinate
    Table(ProfileTable),
}

impl Default for ProfileInput {
    fn default() -> Self {
        Self::Constant(0.0)
    }
}

impl<'de> Deserialize<'de> for ProfileInput {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "a number, an expression in x, y such as \"1 + 0.1*x\", or {\"x\": [[x, v], …]}";
        Choice { expecting, number: Some(Self::Constant), text: Self::Expression, object: Self::Table }
            .read(deserializer)
    }
}

/// Values by a coordinate of the reference position: linear between, constant outside. The same coordinate twice is a
/// jump.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProfileTable {
    /// Pairs of x and value, x ascending
    X(Vec<[f64; 2]>),
    /// Pairs of y and value, y ascending
    Y(Vec<[f64; 2]>),
}
