use super::{Answer, Description, FrictionLaw, FrictionResponse, FrictionState, Regime, Sliding};

/// Surfaces that are tied: elastic whatever the pressure, q̇ = α_t v, with α_t as a penalty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tie {
    /// α_t [F/L³]
    pub alpha_t: f64,
}

impl FrictionLaw for Tie {
    fn description(&self) -> Description {
        Description { stiffness: self.alpha_t, stiffness_is_penalty: true, ..Description::default() }
    }

    fn initial_state(&self, pressure: f64, traction: f64) -> FrictionState {
        FrictionState { regime: Regime::Tied, pressure, traction, ..FrictionState::default() }
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let Sliding { slip, pressure, .. } = sliding.checked()?;
        let traction = old.traction + self.alpha_t * slip;
        let state = FrictionState { pressure, traction, regime: Regime::Tied, ..old.clone() };
        FrictionResponse { state, dtraction_dslip: self.alpha_t, ..FrictionResponse::default() }.checked(self.alpha_t)
    }
}
