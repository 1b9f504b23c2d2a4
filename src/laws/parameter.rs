//! Errors of parameters out of range, with the allowed range.

use std::borrow::Cow;

use thiserror::Error;

/// A parameter out of range.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("\"{name}\" is {value}, but {allowed}")]
#[non_exhaustive]
pub struct InvalidParameter {
    /// key in the case file
    pub name: &'static str,
    /// value in the case file
    pub value: f64,
    /// allowed range
    pub allowed: Cow<'static, str>,
}

/// Refuses a value unless it is finite and `fits`. The text of `allowed` is made only if it is refused: laws with
/// time-dependent parameters are checked at every increment.
///
/// # Errors
/// Returns [`InvalidParameter`] with what is `allowed`.
pub fn require(name: &'static str, value: f64, fits: bool, allowed: impl ToString) -> Result<(), InvalidParameter> {
    match fits && value.is_finite() {
        true => Ok(()),
        false => Err(InvalidParameter { name, value, allowed: allowed.to_string().into() }),
    }
}

/// Refuses a value that is not positive and finite.
///
/// # Errors
/// Returns [`InvalidParameter`] for such a value.
pub fn require_positive(name: &'static str, value: f64) -> Result<(), InvalidParameter> {
    require(name, value, value > 0.0, "it must be positive and finite")
}

/// Refuses a value that is negative or not finite.
///
/// # Errors
/// Returns [`InvalidParameter`] for such a value.
pub fn require_not_negative(name: &'static str, value: f64) -> Result<(), InvalidParameter> {
    require(name, value, value >= 0.0, "it must be zero or positive, and finite")
}

/// Default N/D of a key of a case.
pub(crate) const fn ratio<const N: u32, const D: u32>() -> f64 {
    N as f64 / D as f64
}

/// Error: no parameter of a law has this name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{name}` is not a parameter of this law; known are `{}`", known.join("`, `"))]
#[non_exhaustive]
pub struct UnknownParameter {
    /// requested name
    pub name: String,
    /// existing names
    pub known: Vec<String>,
}

/// Numerical parameters of a law, by their names in cases.
pub trait Numbers {
    /// Names of the parameters.
    fn names(&self) -> Vec<String>;

    /// The parameter of a name, if there is one.
    fn number(&mut self, name: &str) -> Option<&mut f64>;
}

/// Implements [`Numbers`] for a type by names and fields; those in the second list are optional in a case.
macro_rules! numbers {
    ($parameters:ty: $($name:literal $field:ident),*; $($optional:literal $option:ident),*) => {
        impl $parameters {
            /// Names of the numerical parameters.
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

/// Methods that change one thing of an input and return it, for chains: `setters! { contact: Contact; area(area: f64) { … } }`.
macro_rules! setters {
    (const $self:ident: $type:ty; $($(#[$doc:meta])* $name:ident($($argument:ident: $of:ty),*) { $($change:tt)* })*) => {
        impl $type {
            $($(#[$doc])*
            #[must_use]
            pub const fn $name(self, $($argument: $of),*) -> Self {
                let mut $self = self;
                $($change)*
                $self
            })*
        }
    };
    ($self:ident: $type:ty; $($(#[$doc:meta])* $name:ident($($argument:ident: $of:ty),*) { $($change:tt)* })*) => {
        impl $type {
            $($(#[$doc])*
            #[must_use]
            pub fn $name(self, $($argument: $of),*) -> Self {
                let mut $self = self;
                $($change)*
                $self
            })*
        }
    };
}

/// Conversions into a type: `conversions! { f64 => Drive: |value| Self::Constant(value); }`.
macro_rules! conversions {
    ($($(#[$doc:meta])* $of:ty => $to:ty: |$value:pat_param| $made:expr;)*) => {
        $($(#[$doc])*
        impl From<$of> for $to {
            fn from($value: $of) -> Self {
                $made
            }
        })*
    };
}
