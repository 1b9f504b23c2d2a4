//! Numbers that may be computed with.

use super::error::{Checked, ModelError};

/// Stiffnesses outside this range cannot be squared in double precision.
const STIFFNESSES: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

/// A stiffness, mass or area must be of a size that can be squared.
pub fn check_size(place: &str, name: &str, value: f64) -> Checked<()> {
    if STIFFNESSES.contains(&value) {
        return Ok(());
    }
    let (low, high) = (STIFFNESSES.start(), STIFFNESSES.end());
    let message = format!("{name} is {value:.6e}: it must lie between {low:e} and {high:e}; choose other units");
    Err(ModelError::new(place, message))
}

/// A number that must be zero or positive.
pub fn check_not_negative(place: &str, value: f64) -> Checked<()> {
    match value >= 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(ModelError::new(place, format!("is {value}: must be zero or positive"))),
    }
}

/// Numbers that must be finite.
pub fn check_finite(place: &str, values: impl IntoIterator<Item = f64>) -> Checked<()> {
    match values.into_iter().find(|value| !value.is_finite()) {
        Some(value) => Err(ModelError::new(place, format!("is {value}: must be a finite number"))),
        None => Ok(()),
    }
}
