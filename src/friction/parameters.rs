//! The friction law as the case file writes it, and the refusal of its parameters.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{Coulomb, CoulombParameters, FrictionLaw, Frictionless, SuperSubloading, SuperSubloadingParameters};

/// A friction law and its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "law", rename_all = "snake_case")]
pub enum FrictionParameters {
    /// No friction
    Frictionless,
    /// Elastic until |q| = μ p, then sliding at constant μ
    Coulomb(CoulombParameters),
    /// Time-dependent super/subloading-surface friction: slip weakens the interface, rest heals it
    SuperSubloading(SuperSubloadingParameters),
}

/// A friction parameter that is not allowed.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("\"{name}\" is {value}, but {allowed}")]
pub struct InvalidParameter {
    /// key in the case file
    pub name: &'static str,
    /// what the case file says
    pub value: f64,
    /// what may be said
    pub allowed: String,
}

impl FrictionParameters {
    /// The law with its parameters checked; `default_alpha_t` serves where the case gives no `alpha_t`.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a parameter is out of its range.
    pub fn build(&self, default_alpha_t: f64) -> Result<Box<dyn FrictionLaw>, InvalidParameter> {
        Ok(match self {
            Self::Frictionless => Box::new(Frictionless),
            Self::Coulomb(parameters) => Box::new(Coulomb::new(parameters, default_alpha_t)?),
            Self::SuperSubloading(parameters) => Box::new(SuperSubloading::new(parameters, default_alpha_t)?),
        })
    }
}

/// Refuses a value unless it is finite and `fits`.
pub(super) fn require(
    name: &'static str,
    value: f64,
    fits: bool,
    allowed: impl Into<String>,
) -> Result<(), InvalidParameter> {
    if fits && value.is_finite() { Ok(()) } else { Err(InvalidParameter { name, value, allowed: allowed.into() }) }
}

/// Refuses a value that is not positive and finite.
pub(super) fn require_positive(name: &'static str, value: f64) -> Result<(), InvalidParameter> {
    require(name, value, value > 0.0, "it must be positive and finite")
}

/// Refuses a value that is negative or not finite.
pub(super) fn require_not_negative(name: &'static str, value: f64) -> Result<(), InvalidParameter> {
    require(name, value, value >= 0.0, "it must be zero or positive, and finite")
}
