use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::sensitivity::{Direction, Inputs, SensitiveLaw, Variations, variations};
use super::{Answer, Description, FrictionLaw, FrictionResponse, FrictionState, Sliding};
use crate::laws::parameter::{InvalidParameter, require_positive};

/// Parameters of [`Adhesion`] as in the case file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct AdhesionParameters {
    /// τ_a: strength, α s_u of an undrained clay, τ_a > 0 [F/L²]
    pub strength: f64,
    /// α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies [F/L³]
    #[serde(default)]
    pub alpha_t: Option<f64>,
}

numbers!(AdhesionParameters: "strength" strength; "alpha_t" alpha_t);

impl AdhesionParameters {
    /// Creates the parameters with the default tangential stiffness of the contact [F/L²].
    pub const fn new(strength: f64) -> Self {
        Self { strength, alpha_t: None }
    }
}

setters! { const law: AdhesionParameters;
    /// Sets the tangential stiffness α_t [F/L³].
    alpha_t(alpha_t: f64) { law.alpha_t = Some(alpha_t); }
}

/// Adhesion: surfaces in contact slide at one shear stress, whatever the pressure. Clay that has no time to drain, by total stress.
///
/// ```text
/// q̇ = α_t (v − λ sgn q)                      slip = elastic + plastic
/// |q| ≤ τ_a,   λ ≥ 0,   λ (|q| − τ_a) = 0     while p > 0
/// ΔW = τ_a Δλ,   Δλ = (|q_tr| − τ_a)/α_t
/// ```
/// Exact for any increment. An initial traction above the strength is released by slip in the first increment, at the mean of both.
/// Where the surfaces part there is no traction; they do not hold each other along the normal.
///
/// # Errors
/// Returns [`LawFailure`](super::LawFailure) if the increment or the response is not finite, or Δt is negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adhesion {
    strength: f64,
    alpha_t: f64,
}

impl Adhesion {
    /// Creates the law from checked parameters; `default_alpha_t` is used if they do not specify `alpha_t`.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] if a parameter is out of range.
    pub fn new(parameters: &AdhesionParameters, default_alpha_t: f64) -> Result<Self, InvalidParameter> {
        let law = Self { strength: parameters.strength, alpha_t: parameters.alpha_t.unwrap_or(default_alpha_t) };
        require_positive("strength", law.strength)?;
        require_positive("alpha_t", law.alpha_t)?;
        Ok(law)
    }

    /// Mean of |q| over the plastic slip of an increment that ends at the strength.
    fn mean_traction(&self, old: f64, trial: f64) -> f64 {
        let (excess, slip) = (trial.signum() * old - self.strength, trial.abs() - self.strength);
        if excess <= 0.0 {
            return self.strength;
        }
        self.strength + 0.5 * excess * (excess / slip).min(1.0)
    }
}

impl FrictionLaw for Adhesion {
    /// The lowest coefficient is 0: under a high pressure adhesion is negligible.
    fn description(&self) -> Description {
        Description {
            stiffness: self.alpha_t,
            stiffness_is_penalty: true,
            observables: Some(&["R"]),
            released_above: Some([self.strength, 0.0]),
            least_coefficient: Some(0.0),
            ..Description::default()
        }
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let Self { strength, alpha_t } = *self;
        let Sliding { slip, pressure, .. } = sliding.checked()?;
        let trial = old.traction + alpha_t * slip;
        let (state, dtraction_dslip) = if pressure <= 0.0 {
            (old.parted(alpha_t), 0.0)
        } else if trial.abs() <= strength {
            (old.stuck(trial, pressure), alpha_t)
        } else {
            let (sign, mean) = (trial.signum(), self.mean_traction(old.traction, trial));
            (old.slid(trial, sign * strength, mean, pressure, alpha_t), 0.0)
        };
        FrictionResponse { state, dtraction_dslip, ..Default::default() }.checked(alpha_t)
    }

    fn observe(&self, name: &str, state: &FrictionState) -> Option<f64> {
        (name == "R").then(|| state.traction.abs() / self.strength)
    }

    fn cohesion(&self) -> f64 {
        self.strength
    }

    fn sensitivities(&self) -> Option<&dyn SensitiveLaw> {
        Some(self)
    }
}

impl SensitiveLaw for Adhesion {
    fn parameters(&self) -> &'static [&'static str] {
        AdhesionParameters::NUMBERS
    }

    fn vary(&self, old: &FrictionState, sliding: Sliding, directions: [Direction; 2]) -> Variations {
        let inputs = Inputs::new(old, sliding, directions)?;
        let alpha_t = inputs.parameter("alpha_t", self.alpha_t);
        let strength = inputs.parameter("strength", self.strength);
        Ok(variations(inputs.elastic_up_to(strength, alpha_t), 0.0.into()))
    }
}
