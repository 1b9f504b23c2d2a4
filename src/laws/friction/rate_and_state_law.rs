//! What rate and state answers as a law: increments of first order or, along given paths, with their error controlled.

use super::rate_and_state::RateAndState;
use super::rate_and_state_path::Ramp;
use super::rate_law::RateLaw;
use super::sensitivity::{Direction, SensitiveLaw};
use super::{Answer, FrictionLaw, FrictionState, Sliding};

impl FrictionLaw for RateAndState {
    fn initial_state(&self) -> FrictionState {
        FrictionState::default().with_variables([self.initial_theta])
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        if !self.is_controlled || sliding.checked()?.dt == 0.0 {
            return Ok(self.relax(old, sliding)?.0);
        }
        let by = |slip| Direction { slip, ..Direction::default() };
        Ramp::new(self, old, sliding, [by(1.0), by(0.0)], [0.0, 1.0]).answer()
    }

    fn controlled(&self) -> Option<Box<dyn FrictionLaw>> {
        Some(Box::new(Self { is_controlled: true, ..*self }))
    }

    fn stiffness(&self) -> f64 {
        self.coefficients.alpha_t
    }

    fn weakening(&self) -> f64 {
        self.coefficients.b / self.coefficients.critical_slip
    }

    fn rates(&self) -> Option<&dyn RateLaw> {
        Some(self)
    }

    fn sensitivities(&self) -> Option<&dyn SensitiveLaw> {
        Some(self)
    }

    fn variables(&self) -> &'static [&'static str] {
        &["theta"]
    }

    fn observables(&self) -> &'static [&'static str] {
        &["R", "mu", "theta"]
    }

    fn observe(&self, name: &str, state: &FrictionState) -> Option<f64> {
        let psi = || self.coefficients.psi(self.coefficients.log_state(state.variables[0]));
        match name {
            "R" => Some(state.ratio(psi())),
            "mu" => Some(psi()),
            "theta" => Some(state.variables[0]),
            _ => None,
        }
    }
}
