//! Parameters out of range, named with what is allowed.

use std::borrow::Cow;

use thiserror::Error;

/// A parameter that is not allowed.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("\"{name}\" is {value}, but {allowed}")]
#[non_exhaustive]
pub struct InvalidParameter {
    /// key in the case file
    pub name: &'static str,
    /// what the case file says
    pub value: f64,
    /// what may be said
    pub allowed: Cow<'static, str>,
}

/// Refuse a value unless it is finite and `fits`. What is allowed is written only where it is refused: laws whose parameters vary
/// in time are checked at every increment.
///
/// # Errors
/// [`InvalidParameter`] with what is `allowed`.
pub fn require(name: &'static str, value: f64, fits: bool, allowed: impl ToString) -> Result<(), InvalidParameter> {
    match fits && value.is_finite() {
        true => Ok(()),
        false => Err(InvalidParameter { name, value, allowed: allowed.to_string().into() }),
    }
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

/// A name that no parameter of a law has.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{name}` is not a parameter of this law; known are `{}`", known.join("`, `"))]
#[non_exhaustive]
pub struct UnknownParameter {
    /// the name
    pub name: String,
    /// those that there are
    pub known: Vec<String>,
}

/// Parameters of a law that are numbers, by the names that cases give them.
pub trait Numbers {
    /// Names of the parameters.
    fn names(&self) -> Vec<String>;

    /// The parameter of a name, if it is one of them.
    fn number(&mut self, name: &str) -> Option<&mut f64>;
}

/// [`Numbers`] of a type by names and fields; those in the second list may be left out in a case.
macro_rules! numbers {
    ($parameters:ty: $($name:literal $field:ident),*; $($optional:literal $option:ident),*) => {
        impl $parameters {
            /// Names of the parameters that are numbers.
            pub(crate) const NUMBERS: &'static [&'static str] = &[$($name,)* $($optional),*];
        }

        impl $crate::laws::parameter::Numbers for $parameters {
            fn names(&self) -> Vec<String> {
                Self::NUMBERS.iter().copied().map(String::from).collect()
            }

            fn number(&mut self, name: &str) -> Option<&mut f64> {
                match name {
                    $($name => Some(&mut self.$field),)*
                    $($optional => Some(self.$option.get_or_insert(f64::NAN)),)*
                    _ => None,
                }
            }
        }
    };
}
pub(crate) use numbers;
