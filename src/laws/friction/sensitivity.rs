//! How answers vary with parameters of a law and with what it remembers: what fits to measurements are made with.

use std::fmt::Debug;

use super::state::MOST_VARIABLES;
use super::{FrictionState, LawFailure, Sliding};

/// Derivatives of a state, per unit of what it is differentiated by.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Variation {
    /// of q [F/L²]
    pub traction: f64,
    /// of the law's variables
    pub variables: [f64; MOST_VARIABLES],
}

/// What an answer is differentiated by: how that which it follows from varies, the pressure and the time being given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Direction {
    /// of the state at the start
    pub state: Variation,
    /// of Δu_t [L]
    pub slip: f64,
    /// The one parameter that varies, by 1: one of [`SensitiveLaw::parameters`]
    pub parameter: Option<&'static str>,
}

/// A law that differentiates its answers by its parameters. The derivatives are those of exactly what it computes, its sub-steps
/// staying as they are.
///
/// ```text
/// (q, variables)₁ = law((q, p, variables)₀; Δu_t, p₁, Δt; parameters)
/// d(q, variables)₁ = ∂law/∂(q, variables)₀ d(q, variables)₀ + ∂law/∂Δu_t dΔu_t + ∂law/∂parameter
/// ```
pub trait SensitiveLaw: Debug + Send + Sync {
    /// The parameters it differentiates by, as cases name them.
    fn parameters(&self) -> &'static [&'static str];

    /// Derivative of the state of a point that has not slipped with respect to a parameter.
    fn start(&self, parameter: &str) -> Variation;

    /// Derivatives of the state at the end of an increment along two directions.
    ///
    /// # Errors
    /// As of the answer itself.
    fn vary(
        &self,
        old: &FrictionState,
        sliding: Sliding,
        directions: [Direction; 2],
    ) -> Result<[Variation; 2], LawFailure>;
}

impl Variation {
    /// Variation of a law with one internal variable.
    pub(super) fn new(traction: f64, variable: f64) -> Self {
        let mut variables = [0.0; MOST_VARIABLES];
        variables[0] = variable;
        Self { traction, variables }
    }
}

impl Direction {
    /// Derivative of a parameter along this direction: 1 or 0.
    pub(super) fn of(&self, parameter: &str) -> f64 {
        f64::from(u8::from(self.parameter == Some(parameter)))
    }

    /// Derivative of the only internal variable of a law.
    pub(super) fn variable(&self) -> f64 {
        self.state.variables[0]
    }
}
