//! Parameters out of range, named with what is allowed.

use std::borrow::Cow;

use thiserror::Error;

/// A parameter that is not allowed.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("\"{name}\" is {value}, but {allowed}")]
pub struct InvalidParameter {
    /// key in the case file
    pub name: &'static str,
    /// what the case file says
    pub value: f64,
    /// what may be said
    pub allowed: Cow<'static, str>,
}

/// Refuse a value unless it is finite and `fits`.
///
/// # Errors
/// [`InvalidParameter`] with what is `allowed`.
pub fn require(
    name: &'static str,
    value: f64,
    fits: bool,
    allowed: impl Into<Cow<'static, str>>,
) -> Result<(), InvalidParameter> {
    if fits && value.is_finite() { Ok(()) } else { Err(InvalidParameter { name, value, allowed: allowed.into() }) }
}

/// Refuse a value that is not positive and finite.
///
/// # Errors
/// [`InvalidParameter`].
pub fn require_positive(name: &'static str, value: f64) -> Result<(), InvalidParameter> {
    require(name, value, value > 0.0, "it must be positive and finite")
}

/// Refuse a value that is negative or not finite.
///
/// # Errors
/// [`InvalidParameter`].
pub fn require_not_negative(name: &'static str, value: f64) -> Result<(), InvalidParameter> {
    require(name, value, value >= 0.0, "it must be zero or positive, and finite")
}
