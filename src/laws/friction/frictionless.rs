use super::{Answer, Description, FrictionLaw, FrictionResponse, FrictionState, Regime, Sliding};

/// Frictionless contact: q = 0 for any slip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frictionless;

impl FrictionLaw for Frictionless {
    fn description(&self) -> Description {
        Description { is_frictionless: true, starting_coefficient: Some(0.0), ..Description::default() }
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let Sliding { slip, pressure, .. } = sliding.checked()?;
        let regime = match pressure > 0.0 {
            false => Regime::Open,
            true if slip == 0.0 => Regime::Stick,
            true => Regime::Slip,
        };
        let (plastic_slip, pressure) = (old.plastic_slip + slip, pressure.max(0.0));
        let state =
            FrictionState { traction: 0.0, pressure, plastic_slip, plastic_increment: slip, regime, ..old.clone() };
        FrictionResponse { state, ..FrictionResponse::default() }.checked(0.0)
    }
}
