//! The friction law as the case file writes it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    Coulomb, CoulombParameters, FrictionLaw, Frictionless, PrescribedSlip, PrescribedSlipParameters, RateAndState,
    RateAndStateParameters, RegisteredParameters, SlipWeakening, SlipWeakeningParameters, SuperSubloading,
    SuperSubloadingParameters,
};
use crate::laws::parameter::InvalidParameter;

/// A friction law and its parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "law", rename_all = "snake_case", deny_unknown_fields)]
pub enum FrictionParameters {
    /// No friction
    // Not a unit variant: serde would let any other key pass.
    Frictionless {},
    /// Elastic until |q| = μ p, then sliding at constant μ
    Coulomb(CoulombParameters),
    /// Time-dependent super/subloading-surface friction: slip weakens the interface, rest heals it
    SuperSubloading(SuperSubloadingParameters),
    /// Friction that falls linearly with slip from static to dynamic, and does not heal
    SlipWeakening(SlipWeakeningParameters),
    /// Regularized rate-and-state friction: depends on the slip rate and on a state that ages or slips
    RateAndState(RateAndStateParameters),
    /// Slip at a given rate, whatever traction that takes
    Prescribed(PrescribedSlipParameters),
    /// A law that the program has not itself: one that calls the library has registered it, such as a law written in Python
    Registered(RegisteredParameters),
}

impl FrictionParameters {
    /// The law with its parameters checked; `default_alpha_t` serves where the case gives no `alpha_t`.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a parameter is out of its range.
    pub fn build(&self, default_alpha_t: f64) -> Result<Box<dyn FrictionLaw>, InvalidParameter> {
        Ok(match self {
            Self::Frictionless {} => Box::new(Frictionless),
            Self::Coulomb(parameters) => Box::new(Coulomb::new(parameters, default_alpha_t)?),
            Self::SuperSubloading(parameters) => Box::new(SuperSubloading::new(parameters, default_alpha_t)?),
            Self::SlipWeakening(parameters) => Box::new(SlipWeakening::new(parameters, default_alpha_t)?),
            Self::RateAndState(parameters) => Box::new(RateAndState::new(parameters, default_alpha_t)?),
            Self::Prescribed(parameters) => Box::new(PrescribedSlip::new(parameters, default_alpha_t)?),
            Self::Registered(parameters) => parameters.build(default_alpha_t)?,
        })
    }

    /// What is wrong where it is a law that nobody has registered.
    pub fn unknown(&self) -> Option<String> {
        match self {
            Self::Registered(parameters) => parameters.unknown(),
            _ => None,
        }
    }

    /// Whether the law has a structure that may be given for the start.
    pub fn has_structure(&self) -> bool {
        matches!(self, Self::SuperSubloading(_))
    }

    /// Names and values of the coefficients that bound |q|/p, as far as there are any.
    pub fn bounds(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Coulomb(law) => vec![("μ", law.mu)],
            Self::SuperSubloading(law) => vec![("μ_s", law.mu_s), ("μ_k", law.mu_k)],
            Self::SlipWeakening(law) if law.cohesion == 0.0 => vec![("μ_s", law.mu_s), ("μ_d", law.mu_d)],
            Self::Frictionless {}
            | Self::SlipWeakening(_)
            | Self::RateAndState(_)
            | Self::Prescribed(_)
            | Self::Registered(_) => Vec::new(),
        }
    }
}

impl From<CoulombParameters> for FrictionParameters {
    fn from(parameters: CoulombParameters) -> Self {
        Self::Coulomb(parameters)
    }
}

impl From<SuperSubloadingParameters> for FrictionParameters {
    fn from(parameters: SuperSubloadingParameters) -> Self {
        Self::SuperSubloading(parameters)
    }
}

impl From<SlipWeakeningParameters> for FrictionParameters {
    fn from(parameters: SlipWeakeningParameters) -> Self {
        Self::SlipWeakening(parameters)
    }
}

impl From<RateAndStateParameters> for FrictionParameters {
    fn from(parameters: RateAndStateParameters) -> Self {
        Self::RateAndState(parameters)
    }
}

impl From<PrescribedSlipParameters> for FrictionParameters {
    fn from(parameters: PrescribedSlipParameters) -> Self {
        Self::Prescribed(parameters)
    }
}
