//! Sensitivities of a law's response to its parameters and internal variables, for fits to measurements.

use std::fmt::Debug;

use super::state::MOST_VARIABLES;
use super::{FrictionState, LawFailure, Sliding};

/// Derivatives of a state with respect to a quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Variation {
    /// of q [F/L²]
    pub traction: f64,
    /// of the law's variables
    pub variables: [f64; MOST_VARIABLES],
}

/// Variation of the inputs of a response, at constant pressure and time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Direction {
    /// of the state at the start
    pub state: Variation,
    /// of Δu_t [L]
    pub slip: f64,
    /// Parameter that varies, by 1: one of [`SensitiveLaw::parameters`]
    pub parameter: Option<&'static str>,
}

/// A law with derivatives of its responses with respect to its parameters. They are exact derivatives of the computed values at
/// fixed sub-steps.
///
/// ```text
/// (q, variables)₁ = law((q, p, variables)₀; Δu_t, p₁, Δt; parameters)
/// d(q, variables)₁ = ∂law/∂(q, variables)₀ d(q, variables)₀ + ∂law/∂Δu_t dΔu_t + ∂law/∂parameter
/// ```
pub trait SensitiveLaw: Debug + Send + Sync {
    /// Parameters of the derivatives, as named in cases.
    fn parameters(&self) -> &'static [&'static str];

    /// Derivative of the initial state of a point with respect to a parameter.
    fn start(&self, parameter: &str) -> Variation;

    /// Derivatives of the state at the end of an increment along two directions.
    ///
    /// # Errors
    /// The same as for the response.
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
