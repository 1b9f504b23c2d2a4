//! Sensitivities of a law's response to its parameters and internal variables, for fits to measurements.

use std::fmt::Debug;

use super::state::Variables;
use super::{FrictionState, LawFailure, Sliding};
use crate::laws::dual::Dual;

/// Derivatives of a state with respect to a quantity.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Variation {
    /// of q [F/L²]
    pub traction: f64,
    /// of the law's variables
    pub variables: Variables,
}

/// Variation of the inputs of a response, at constant time.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Direction {
    /// of the state at the start
    pub state: Variation,
    /// of Δu_t [L]
    pub slip: f64,
    /// of p at the end [F/L²]
    pub pressure: f64,
    /// Parameter that varies, by 1: one of [`SensitiveLaw::parameters`]
    pub parameter: Option<&'static str>,
}

/// Derivatives of a state along two directions.
pub type Variations = Result<[Variation; 2], LawFailure>;

/// A law with derivatives of its responses with respect to its parameters. They are exact derivatives of the computed values at
/// fixed sub-steps.
///
/// ```text
/// (q, variables)₁ = law((q, p, variables)₀; Δu_t, p₁, Δt; parameters)
/// d(q, variables)₁ = ∂law/∂(q, variables)₀ d(q, variables)₀ + ∂law/∂Δu_t dΔu_t + ∂law/∂p₁ dp₁ + ∂law/∂parameter
/// ```
pub trait SensitiveLaw: Debug + Send + Sync {
    /// Parameters of the derivatives, as named in cases.
    fn parameters(&self) -> &'static [&'static str];

    /// Derivative of the initial state of a point with respect to a parameter; by default none.
    fn start(&self, _parameter: &str) -> Variation {
        Variation::default()
    }

    /// Derivatives of the state at the end of an increment along two directions.
    ///
    /// # Errors
    /// The same as for the response.
    fn vary(&self, old: &FrictionState, sliding: Sliding, directions: [Direction; 2]) -> Variations;
}

/// Inputs of a response with their derivatives along two directions, of a law with one internal variable.
#[derive(Clone)]
pub(super) struct Inputs {
    /// q at the start [F/L²]
    pub traction: Dual,
    /// The internal variable at the start
    pub variable: Dual,
    /// A second internal variable of some laws
    pub second: Dual,
    /// Δu_t [L]
    pub slip: Dual,
    /// p at the end [F/L²]
    pub pressure: Dual,
    /// Δt [T]
    pub dt: f64,
    directions: [Direction; 2],
}

impl Inputs {
    /// The inputs along two directions.
    ///
    /// # Errors
    /// Returns [`LawFailure`] for invalid increments.
    pub(super) fn new(old: &FrictionState, sliding: Sliding, directions: [Direction; 2]) -> Result<Self, LawFailure> {
        let Sliding { slip, pressure, dt } = sliding.checked()?;
        let along =
            |value: f64, of: fn(&Direction) -> f64| Dual { value, by: [of(&directions[0]), of(&directions[1])] };
        Ok(Self {
            traction: along(old.traction, |by| by.state.traction),
            variable: along(old.variables[0], |by| by.state.variables[0]),
            second: along(old.variables[1], |by| by.state.variables[1]),
            slip: along(slip, |by| by.slip),
            pressure: along(pressure, |by| by.pressure),
            dt,
            directions,
        })
    }

    /// A parameter of the law with its derivatives: 1 along its own direction.
    pub(super) fn parameter(&self, name: &str, value: f64) -> Dual {
        Dual { value, by: self.directions.each_ref().map(|by| f64::from(u8::from(by.parameter == Some(name)))) }
    }

    /// q at the end if it is elastic up to a strength.
    pub(super) fn elastic_up_to(&self, strength: Dual, alpha_t: Dual) -> Dual {
        let trial = self.traction + alpha_t * self.slip;
        if self.pressure.value <= 0.0 {
            0.0.into()
        } else if trial.value.abs() <= strength.value {
            trial
        } else {
            strength * trial.value.signum()
        }
    }

    /// Whether parameters vary; if not, the derivatives are those of a tangent.
    pub(super) fn vary_parameters(&self) -> bool {
        self.directions.iter().any(|by| by.parameter.is_some())
    }
}

/// Derivatives of the state of a law with one internal variable.
pub(super) fn variations(traction: Dual, variable: Dual) -> [Variation; 2] {
    [0, 1].map(|k| Variation::new(traction.by[k], variable.by[k]))
}

impl Variation {
    /// Variation of a law with one internal variable.
    pub(super) fn new(traction: f64, variable: f64) -> Self {
        Self { traction, variables: [variable].into_iter().collect() }
    }
}

impl Direction {
    /// Directions of the consistent tangent: Δu_t and p.
    pub(super) const TANGENT: [Self; 2] = [Self::of_inputs(1.0, 0.0), Self::of_inputs(0.0, 1.0)];

    const fn of_inputs(slip: f64, pressure: f64) -> Self {
        let state = Variation { traction: 0.0, variables: Variables::ZERO };
        Self { state, slip, pressure, parameter: None }
    }
}
