use super::{FrictionLaw, FrictionResponse, FrictionState, LawFailure, Sliding};

/// No friction: q = 0 whatever the slip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frictionless;

impl FrictionLaw for Frictionless {
    fn initial_state(&self) -> FrictionState {
        FrictionState::default()
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Result<FrictionResponse, LawFailure> {
        let Sliding { slip, pressure, .. } = sliding.checked()?;
        let state = FrictionState {
            traction: 0.0,
            pressure: pressure.max(0.0),
            mu: 0.0,
            plastic_slip: old.plastic_slip + slip,
            plastic_increment: slip,
            dissipation: old.dissipation,
        };
        FrictionResponse { state, dtraction_dslip: 0.0, dtraction_dpressure: 0.0, evaluations: 0 }.checked(0.0)
    }

    fn stiffness(&self) -> f64 {
        0.0
    }

    fn structure(&self, _mu: f64) -> f64 {
        1.0
    }

    fn starting_limit(&self, _pressure: f64) -> f64 {
        0.0
    }

    fn uniqueness_limit(&self) -> Option<f64> {
        None
    }
}
