use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    Answer, Description, FrictionLaw, FrictionResponse, FrictionState, PointLoad, RateLaw, Regime, Sliding, States,
};
use crate::laws::parameter::{InvalidParameter, require, require_positive};

/// Parameters of [`PrescribedSlip`] as in the case file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct PrescribedSlipParameters {
    /// V: slip rate of the slave along +s, of either sign [L/T]
    pub slip_rate: f64,
    /// α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies [F/L³]
    #[serde(default)]
    pub alpha_t: Option<f64>,
}

impl PrescribedSlipParameters {
    /// Creates the parameters with the default tangential stiffness of the contact.
    pub const fn new(slip_rate: f64) -> Self {
        Self { slip_rate, alpha_t: None }
    }
}

setters! { const law: PrescribedSlipParameters;
    /// Sets the tangential stiffness α_t [F/L³].
    alpha_t(alpha_t: f64) { law.alpha_t = Some(alpha_t); }
}

numbers!(PrescribedSlipParameters: "slip_rate" slip_rate; "alpha_t" alpha_t);

/// Slip at a prescribed rate, whatever the traction: for the creeping parts of a fault.
///
/// ```text
/// q̇ = α_t (v − V)                            slip = elastic + plastic; V: given
/// ΔW = ½ (q₀ + q) V Δt                       negative where the interface is driven against its traction
/// ```
/// A time-dependent rate is averaged over the increment.
///
/// # Errors
/// Returns [`LawFailure`](super::LawFailure) if the increment or the response is not finite, or Δt is negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrescribedSlip {
    slip_rate: f64,
    alpha_t: f64,
}

impl PrescribedSlip {
    /// Creates the law from checked parameters; `default_alpha_t` is used if they do not specify `alpha_t`.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] if a parameter is out of range.
    pub fn new(parameters: &PrescribedSlipParameters, default_alpha_t: f64) -> Result<Self, InvalidParameter> {
        let PrescribedSlipParameters { slip_rate, alpha_t } = *parameters;
        let alpha_t = alpha_t.unwrap_or(default_alpha_t);
        require("slip_rate", slip_rate, slip_rate.is_finite(), "it must be finite")?;
        require_positive("alpha_t", alpha_t)?;
        Ok(Self { slip_rate, alpha_t })
    }
}

/// Slip, or stick if the rate is zero.
fn regime(slip_rate: f64) -> Regime {
    if slip_rate == 0.0 { Regime::Stick } else { Regime::Slip }
}

impl FrictionLaw for PrescribedSlip {
    fn description(&self) -> Description {
        Description { stiffness: self.alpha_t, takes_means: true, ..Description::default() }
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let Self { slip_rate, alpha_t } = *self;
        let Sliding { slip, pressure, dt } = sliding.checked()?;
        if pressure <= 0.0 {
            return FrictionResponse::elastic(old.parted(alpha_t), 0.0).checked(alpha_t);
        }
        let plastic = slip_rate * dt;
        let traction = old.traction + alpha_t * (slip - plastic);
        let state = FrictionState {
            plastic_slip: old.plastic_slip + plastic,
            plastic_increment: plastic,
            dissipation: old.dissipation + 0.5 * (old.traction + traction) * plastic,
            regime: regime(plastic),
            ..old.stuck(traction, pressure)
        };
        FrictionResponse::elastic(state, alpha_t).checked(alpha_t)
    }

    fn rates(&self) -> Option<&dyn RateLaw> {
        Some(self)
    }
}

impl RateLaw for PrescribedSlip {
    fn slip_rate(&self, _: States, _: PointLoad) -> f64 {
        self.slip_rate
    }

    fn regime(&self, _: States, slip_rate: f64) -> Regime {
        regime(slip_rate)
    }
}
