//! A parameter out of range, named with what is allowed.

use thiserror::Error;

/// A parameter out of range.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{name} = {value}: must be {allowed}")]
pub struct InvalidParameter {
    /// Name of the parameter in the case file.
    pub name: &'static str,
    /// The value given.
    pub value: f64,
    /// What is allowed, and why.
    pub allowed: &'static str,
}
