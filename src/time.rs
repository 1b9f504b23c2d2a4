//! Time integration: how velocity and acceleration follow from displacement, and where equilibrium is asked for.
//!
//! ```text
//! (1 − α_m) M a₁ + α_m M a₀ + (1 − α_f) F₁ + α_f F₀ = 0          F: internal + contact − external forces
//! a₁ = (u₁ − u₀ − Δt v₀)/(β Δt²) − (1/(2β) − 1) a₀
//! v₁ = v₀ + Δt ((1 − γ) a₀ + γ a₁)
//! ```
//!
//! Newmark: α_m = α_f = 0. HHT-α: α_m = 0, α_f = −α, γ = 1/2 − α, β = (1 − α)²/4.
//! Sources: Newmark (1959), J. Eng. Mech. Div. ASCE 85, 67; Hilber, Hughes & Taylor (1977), Earthquake Eng. Struct.
//! Dyn. 5, 283.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::parameter::{InvalidParameter, require};

/// Time scheme of a step, as the case file names it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Scheme {
    /// Equilibrium without inertia; time only drives loads and the ageing of friction.
    #[default]
    Static,
    /// Newmark; β = 1/4, γ = 1/2 (the trapezoidal rule) unless given.
    Newmark {
        /// β > 0 [-]
        #[serde(default = "quarter")]
        beta: f64,
        /// γ ≥ 1/2 [-]
        #[serde(default = "half")]
        gamma: f64,
    },
    /// Hilber–Hughes–Taylor: second order, damps what the steps do not resolve.
    Hht {
        /// −1/3 ≤ α ≤ 0; the nearer to −1/3, the more damping [-]
        alpha: f64,
    },
}

fn quarter() -> f64 {
    0.25
}

fn half() -> f64 {
    0.5
}

/// The numbers of a dynamic scheme in the equations above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// Weight of the old inertia force
    pub alpha_m: f64,
    /// Weight of the old internal, contact and external forces
    pub alpha_f: f64,
    /// β
    pub beta: f64,
    /// γ
    pub gamma: f64,
}

impl Scheme {
    /// The numbers of the scheme; `None` for statics.
    pub fn coefficients(self) -> Option<Coefficients> {
        match self {
            Self::Static => None,
            Self::Newmark { beta, gamma } => Some(Coefficients { alpha_m: 0.0, alpha_f: 0.0, beta, gamma }),
            Self::Hht { alpha } => Some(Coefficients {
                alpha_m: 0.0,
                alpha_f: -alpha,
                beta: 0.25 * (1.0 - alpha).powi(2),
                gamma: 0.5 - alpha,
            }),
        }
    }

    /// Check the parameters.
    ///
    /// # Errors
    /// [`InvalidParameter`] names the one that is out of range.
    pub fn check(self) -> Result<(), InvalidParameter> {
        match self {
            Self::Static => Ok(()),
            Self::Newmark { beta, gamma } => {
                require("gamma", gamma, gamma >= 0.5, "it must be at least 0.5: less adds energy")?;
                require("beta", beta, beta > 0.0, "it must be positive; 0.25 is the trapezoidal rule")
            }
            Self::Hht { alpha } => {
                let fits = (-1.0 / 3.0..=0.0).contains(&alpha);
                require("alpha", alpha, fits, "it must be between -1/3 and 0; 0 does not damp")
            }
        }
    }
}

impl Coefficients {
    /// ∂a₁/∂u₁ = 1/(β Δt²) [1/T²].
    pub fn dacceleration(&self, dt: f64) -> f64 {
        1.0 / (self.beta * dt * dt)
    }

    /// ∂v₁/∂u₁ = γ/(β Δt) [1/T].
    pub fn dvelocity(&self, dt: f64) -> f64 {
        self.gamma / (self.beta * dt)
    }

    /// (v₁, a₁) of one dof from its displacement increment Δu and (v₀, a₀).
    pub fn rates(&self, increment: f64, (v, a): (f64, f64), dt: f64) -> (f64, f64) {
        let a1 = (increment - dt * v) / (self.beta * dt * dt) - (0.5 / self.beta - 1.0) * a;
        (v + dt * ((1.0 - self.gamma) * a + self.gamma * a1), a1)
    }
}
