//! Friction laws in the case file.
//!
//! A program that uses the library can register laws by name for cases.

use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    Adhesion, AdhesionParameters, Coulomb, CoulombParameters, FrictionLaw, Frictionless, PrescribedSlip,
    PrescribedSlipParameters, RateAndState, RateAndStateParameters, SlipWeakening, SlipWeakeningParameters,
    SuperSubloading, SuperSubloadingParameters,
};
use crate::laws::parameter::{InvalidParameter, Numbers, UnknownParameter, require_positive};

/// A friction law and its parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "law", rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum FrictionParameters {
    /// No friction
    // Not a unit variant, for which serde would accept any other key.
    Frictionless {},
    /// Elastic until |q| = μ p, then sliding at constant μ
    Coulomb(CoulombParameters),
    /// Elastic until |q| = τ_a, then sliding at it whatever the pressure: undrained clay by total stress
    Adhesion(AdhesionParameters),
    /// Time-dependent super/subloading-surface friction: slip weakens the interface, stationary contact heals it
    SuperSubloading(SuperSubloadingParameters),
    /// Friction that decreases linearly with slip from static to dynamic, and does not heal
    SlipWeakening(SlipWeakeningParameters),
    /// Regularized rate-and-state friction: depends on the slip rate and on a state that ages or slips
    RateAndState(RateAndStateParameters),
    /// Slip at a prescribed rate, whatever the traction
    Prescribed(PrescribedSlipParameters),
    /// A law that is not part of the program, registered by a program that uses the library, such as a law written in Python
    Registered(RegisteredParameters),
}

impl FrictionParameters {
    /// Friction of a constant coefficient; none where that is 0.
    pub fn constant(mu: f64) -> Self {
        if mu > 0.0 { Self::Coulomb(CoulombParameters::new(mu)) } else { Self::Frictionless {} }
    }

    /// Creates the law from checked parameters; `default_alpha_t` is used if the case does not specify `alpha_t`.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] if a parameter is out of range.
    pub fn build(&self, default_alpha_t: f64) -> Result<Box<dyn FrictionLaw>, InvalidParameter> {
        Ok(match self {
            Self::Frictionless {} => Box::new(Frictionless),
            Self::Coulomb(parameters) => Box::new(Coulomb::new(parameters, default_alpha_t)?),
            Self::Adhesion(parameters) => Box::new(Adhesion::new(parameters, default_alpha_t)?),
            Self::SuperSubloading(parameters) => Box::new(SuperSubloading::new(parameters, default_alpha_t)?),
            Self::SlipWeakening(parameters) => Box::new(SlipWeakening::new(parameters, default_alpha_t)?),
            Self::RateAndState(parameters) => Box::new(RateAndState::new(parameters, default_alpha_t)?),
            Self::Prescribed(parameters) => Box::new(PrescribedSlip::new(parameters, default_alpha_t)?),
            Self::Registered(parameters) => parameters.build(default_alpha_t)?,
        })
    }

    /// Sets one of the numerical parameters, by its name in cases; of a registered law one of those that it was given.
    ///
    /// # Errors
    /// Returns [`UnknownParameter`] for any other name.
    pub fn with(mut self, name: &str, value: f64) -> Result<Self, UnknownParameter> {
        let numbers: &mut dyn Numbers = match &mut self {
            Self::Frictionless {} => return Err(UnknownParameter { name: name.into(), known: Vec::new() }),
            Self::Coulomb(parameters) => parameters,
            Self::Adhesion(parameters) => parameters,
            Self::SuperSubloading(parameters) => parameters,
            Self::SlipWeakening(parameters) => parameters,
            Self::RateAndState(parameters) => parameters,
            Self::Prescribed(parameters) => parameters,
            Self::Registered(parameters) => parameters,
        };
        match numbers.number(name) {
            Some(number) => *number = value,
            None => return Err(UnknownParameter { name: name.into(), known: numbers.names() }),
        }
        Ok(self)
    }

    /// Error message if it is a law that is not registered.
    pub fn unknown(&self) -> Option<String> {
        match self {
            Self::Registered(parameters) => parameters.unknown(),
            _ => None,
        }
    }

    /// Whether the law has a structure variable with an initial value.
    pub fn has_structure(&self) -> bool {
        matches!(self, Self::SuperSubloading(_))
    }

    /// Names and values of the coefficients that bound |q|/p, if there are any.
    pub fn bounds(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Coulomb(law) => vec![("μ", law.mu)],
            Self::SuperSubloading(law) => vec![("μ_s", law.mu_s), ("μ_k", law.mu_k)],
            Self::SlipWeakening(law) if law.cohesion == 0.0 => vec![("μ_s", law.mu_s), ("μ_d", law.mu_d)],
            Self::Frictionless {}
            | Self::Adhesion(_)
            | Self::SlipWeakening(_)
            | Self::RateAndState(_)
            | Self::Prescribed(_)
            | Self::Registered(_) => Vec::new(),
        }
    }
}

conversions! {
    AdhesionParameters => FrictionParameters: |law| Self::Adhesion(law);
    CoulombParameters => FrictionParameters: |law| Self::Coulomb(law);
    SuperSubloadingParameters => FrictionParameters: |law| Self::SuperSubloading(law);
    SlipWeakeningParameters => FrictionParameters: |law| Self::SlipWeakening(law);
    RateAndStateParameters => FrictionParameters: |law| Self::RateAndState(law);
    PrescribedSlipParameters => FrictionParameters: |law| Self::Prescribed(law);
}

impl Numbers for RegisteredParameters {
    fn names(&self) -> Vec<String> {
        self.parameters.keys().cloned().chain(["alpha_t".into()]).collect()
    }

    fn number(&mut self, name: &str) -> Option<&mut f64> {
        match name {
            "alpha_t" => Some(self.alpha_t.get_or_insert(f64::NAN)),
            _ => self.parameters.get_mut(name),
        }
    }
}

/// Function that makes a law from its parameters and α_t.
pub type Maker = dyn Fn(&BTreeMap<String, f64>, f64) -> Result<Box<dyn FrictionLaw>, InvalidParameter> + Send + Sync;

static REGISTER: RwLock<BTreeMap<String, Arc<Maker>>> = RwLock::new(BTreeMap::new());

/// Registers a law by name for cases built in this process from now on; replaces a law of the same name.
///
/// ```
/// use fecontact::laws::friction::{Coulomb, CoulombParameters, FrictionParameters, register};
///
/// register("half", |parameters, alpha_t| {
///     Ok(Box::new(Coulomb::new(&CoulombParameters::new(0.5 * parameters["mu"]), alpha_t)?))
/// });
/// let friction: FrictionParameters =
///     serde_json::from_str(r#"{"law": "registered", "name": "half", "parameters": {"mu": 0.6}}"#)?;
/// assert_eq!(friction.build(1e3)?.description().starting_limit(10.0), 3.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn register(
    name: impl Into<String>,
    maker: impl Fn(&BTreeMap<String, f64>, f64) -> Result<Box<dyn FrictionLaw>, InvalidParameter> + Send + Sync + 'static,
) {
    REGISTER.write().unwrap_or_else(PoisonError::into_inner).insert(name.into(), Arc::new(maker));
}

/// A registered law in the case file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct RegisteredParameters {
    /// Name under which the calling program has registered it
    pub name: String,
    /// Parameters by name
    #[serde(default)]
    pub parameters: BTreeMap<String, f64>,
    /// α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies [F/L³]
    #[serde(default)]
    pub alpha_t: Option<f64>,
}

impl RegisteredParameters {
    /// Creates a registered law by its name, without parameters.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), parameters: BTreeMap::new(), alpha_t: None }
    }

    /// Creates the law; `default_alpha_t` is used if the case does not specify `alpha_t`.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] if a parameter is out of range or the law is not registered.
    pub fn build(&self, default_alpha_t: f64) -> Result<Box<dyn FrictionLaw>, InvalidParameter> {
        let alpha_t = self.alpha_t.unwrap_or(default_alpha_t);
        require_positive("alpha_t", alpha_t)?;
        if let Some(&value) = self.parameters.get("alpha_t") {
            let allowed = "the stiffness is given outside the parameters, as \"alpha_t\" of the law".into();
            return Err(InvalidParameter { name: "parameters.alpha_t", value, allowed });
        }
        let maker = REGISTER.read().unwrap_or_else(PoisonError::into_inner).get(&self.name).cloned();
        let allowed = "it must be the name of a law that is registered".into();
        let maker = maker.ok_or(InvalidParameter { name: "name", value: f64::NAN, allowed })?;
        maker(&self.parameters, alpha_t)
    }

    /// Error message if the law is not registered.
    pub fn unknown(&self) -> Option<String> {
        let register = REGISTER.read().unwrap_or_else(PoisonError::into_inner);
        let known: Vec<&str> = register.keys().map(String::as_str).collect();
        let known = if known.is_empty() { "none is".into() } else { format!("there are `{}`", known.join("`, `")) };
        (!register.contains_key(&self.name))
            .then(|| format!("no law `{}` is registered in this program; {known}", self.name))
    }
}

setters! { law: RegisteredParameters;
    /// Adds a parameter.
    parameter(name: impl Into<String>, value: f64) { law.parameters.insert(name.into(), value); }

    /// Sets the tangential stiffness α_t [F/L³].
    alpha_t(alpha_t: f64) { law.alpha_t = Some(alpha_t); }
}
