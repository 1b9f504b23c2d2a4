use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::sensitivity::{Direction, Inputs, SensitiveLaw, Variations, variations};
use super::{Answer, Description, FrictionLaw, FrictionResponse, FrictionState, Sliding, traction_at_yield};
use crate::laws::parameter::{InvalidParameter, require_positive};

/// Parameters of [`Coulomb`] as in the case file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct CoulombParameters {
    /// μ: friction coefficient, μ > 0 [-]
    pub mu: f64,
    /// α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies [F/L³]
    #[serde(default)]
    pub alpha_t: Option<f64>,
}

numbers!(CoulombParameters: "mu" mu; "alpha_t" alpha_t);

impl CoulombParameters {
    /// Creates the parameters with the default tangential stiffness of the contact.
    pub const fn new(mu: f64) -> Self {
        Self { mu, alpha_t: None }
    }
}

setters! { const law: CoulombParameters;
    /// Sets the tangential stiffness α_t [F/L³].
    alpha_t(alpha_t: f64) { law.alpha_t = Some(alpha_t); }
}

/// Coulomb friction on an elastic contact: sticks below μ p, slides at μ p.
///
/// ```text
/// q̇ = α_t (v − λ sgn q)                      slip = elastic + plastic
/// |q| ≤ μ p,   λ ≥ 0,   λ (|q| − μ p) = 0     sticking or sliding
/// ```
/// An increment is elastic if the trial q₀ + α_t Δu is not above μ p, otherwise q = μ p along the trial. For slip and pressure
/// linear in the increment this is exact: the traction is elastic up to q_y, where it reaches μ p, and slides at
/// μ p from there to the end, which dissipates
/// ```text
/// ΔW = ½ (q_y + |q|) Δλ,   Δλ = (|q_tr| − |q|)/α_t
/// ```
///
/// # Errors
/// Returns [`LawFailure`](super::LawFailure) if the increment or the response is not finite, or Δt is negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb {
    mu: f64,
    alpha_t: f64,
}

impl Coulomb {
    /// Creates the law from checked parameters; `default_alpha_t` is used if they do not specify `alpha_t`.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] if a parameter is out of range.
    pub fn new(parameters: &CoulombParameters, default_alpha_t: f64) -> Result<Self, InvalidParameter> {
        let law = Self { mu: parameters.mu, alpha_t: parameters.alpha_t.unwrap_or(default_alpha_t) };
        require_positive("mu", law.mu)?;
        require_positive("alpha_t", law.alpha_t)?;
        Ok(law)
    }
}

impl FrictionLaw for Coulomb {
    fn description(&self) -> Description {
        Description {
            stiffness: self.alpha_t,
            stiffness_is_penalty: true,
            observables: Some(&["R", "mu"]),
            starting_coefficient: Some(self.mu),
            least_coefficient: Some(self.mu),
            ..Description::default()
        }
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let Self { mu, alpha_t } = *self;
        let Sliding { slip, pressure, .. } = sliding.checked()?;
        let trial = old.traction + alpha_t * slip;
        let (state, dtraction_dslip, dtraction_dpressure) = if pressure <= 0.0 {
            (old.parted(alpha_t), 0.0, 0.0)
        } else if trial.abs() <= mu * pressure {
            (old.stuck(trial, pressure), alpha_t, 0.0)
        } else {
            let (sign, strength) = (trial.signum(), mu * pressure);
            let at_yield = traction_at_yield([sign * old.traction, trial.abs()], [mu * old.pressure, strength]);
            let mean = 0.5 * (at_yield + strength);
            (old.slid(trial, sign * strength, mean, pressure, alpha_t), 0.0, sign * mu)
        };
        FrictionResponse { state, dtraction_dslip, dtraction_dpressure, ..Default::default() }.checked(alpha_t)
    }

    fn observe(&self, name: &str, state: &FrictionState) -> Option<f64> {
        match name {
            "R" => Some(state.ratio(self.mu)),
            "mu" => Some(self.mu),
            _ => None,
        }
    }

    fn sensitivities(&self) -> Option<&dyn SensitiveLaw> {
        Some(self)
    }
}

impl SensitiveLaw for Coulomb {
    fn parameters(&self) -> &'static [&'static str] {
        CoulombParameters::NUMBERS
    }

    fn vary(&self, old: &FrictionState, sliding: Sliding, directions: [Direction; 2]) -> Variations {
        let inputs = Inputs::new(old, sliding, directions)?;
        let alpha_t = inputs.parameter("alpha_t", self.alpha_t);
        let strength = inputs.parameter("mu", self.mu) * inputs.pressure;
        Ok(variations(inputs.elastic_up_to(strength, alpha_t), 0.0.into()))
    }
}
