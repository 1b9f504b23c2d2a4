//! What is wrong with a model, and where.

use thiserror::Error;

use crate::laws::parameter::InvalidParameter;

/// Something in a model that cannot be solved as it is given.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{}{message}", if place.is_empty() { String::new() } else { format!("{place}: ") })]
pub struct ModelError {
    /// Path of what is meant, in the words of the case file: `bodies.block.material`, `steps[0].supports[1].ux`
    pub place: String,
    /// What is wrong, and what to do
    pub message: String,
}

/// What is given, once it is found to be good.
pub type Checked<T> = Result<T, ModelError>;

impl ModelError {
    /// An error at a place.
    pub fn new(place: impl Into<String>, message: impl ToString) -> Self {
        Self { place: place.into(), message: message.to_string() }
    }
}

/// A parameter of a law, whose place is added by what has the law.
impl From<InvalidParameter> for ModelError {
    fn from(error: InvalidParameter) -> Self {
        Self::new("", error)
    }
}
