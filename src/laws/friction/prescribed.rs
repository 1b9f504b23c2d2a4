use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Answer, Description, FrictionLaw, FrictionResponse, FrictionState, PointLoad, RateLaw, Regime, Sliding};
use crate::laws::parameter::{InvalidParameter, numbers, require, require_positive};

/// Parameters of [`PrescribedSlip`] as the case file writes them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct PrescribedSlipParameters {
    /// V: slip rate of the slave along +s, of either sign [L/T]
    pub slip_rate: f64,
    /// α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies [F/L³]
    #[serde(default)]
    pub alpha_t: Option<f64>,
}

impl PrescribedSlipParameters {
    /// With the tangential stiffness left to the contact.
    pub const fn new(slip_rate: f64) -> Self {
        Self { slip_rate, alpha_t: None }
    }

    /// With this tangential stiffness [F/L³].
    pub const fn alpha_t(self, alpha_t: f64) -> Self {
        Self { alpha_t: Some(alpha_t), ..self }
    }
}

numbers!(PrescribedSlipParameters: "slip_rate" slip_rate; "alpha_t" alpha_t);

/// Slip at a given rate, whatever traction that takes: the creeping parts of a fault.
///
/// ```text
/// q̇ = α_t (v − V)                            slip = elastic + plastic; V: given
/// ΔW = ½ (q₀ + q) V Δt                       negative where the interface is driven against its traction
/// ```
/// A rate that varies in time enters by its mean over an increment.
///
/// # Errors
/// [`LawFailure`](super::LawFailure) when the increment or the answer is not finite, or time goes backwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrescribedSlip {
    slip_rate: f64,
    alpha_t: f64,
}

impl PrescribedSlip {
    /// The law with its parameters checked; `default_alpha_t` serves where they give no `alpha_t`.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a parameter is out of its range.
    pub fn new(parameters: &PrescribedSlipParameters, default_alpha_t: f64) -> Result<Self, InvalidParameter> {
        let PrescribedSlipParameters { slip_rate, alpha_t } = *parameters;
        let alpha_t = alpha_t.unwrap_or(default_alpha_t);
        require("slip_rate", slip_rate, slip_rate.is_finite(), "it must be finite")?;
        require_positive("alpha_t", alpha_t)?;
        Ok(Self { slip_rate, alpha_t })
    }
}

/// Slip or stick by a rate.
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
    fn slip_rate(&self, _: f64, _: PointLoad) -> f64 {
        self.slip_rate
    }

    fn regime(&self, _: f64, slip_rate: f64) -> Regime {
        regime(slip_rate)
    }
}
