//! How the answers of rate-and-state friction vary with its parameters.

use super::relaxation::{Coefficients, Relaxation, Relaxed, StateEvolution, arsinh_of_exp};
use super::{Ramp, RateAndState};
use crate::laws::friction::sensitivity::{Direction, SensitiveLaw, Variation};
use crate::laws::friction::{FrictionResponse, FrictionState, LEAST_SLOPE, LawFailure, Sliding};

/// As [`RateAndStateParameters`](crate::laws::friction::RateAndStateParameters) names them.
const PARAMETERS: [&str; 7] = ["f_0", "V_0", "a", "b", "D_c", "alpha_t", "theta"];

impl SensitiveLaw for RateAndState {
    fn parameters(&self) -> &'static [&'static str] {
        &PARAMETERS
    }

    fn start(&self, parameter: usize) -> Variation {
        let Coefficients { reference_rate, critical_slip, .. } = self.coefficients;
        let dtheta = match (PARAMETERS[parameter], self.has_theta) {
            ("theta", true) => 1.0,
            ("D_c", false) => 1.0 / reference_rate,
            ("V_0", false) => -critical_slip / (reference_rate * reference_rate),
            _ => 0.0,
        };
        Variation::new(0.0, dtheta)
    }

    fn vary(
        &self,
        old: &FrictionState,
        sliding: Sliding,
        directions: [Direction; 2],
    ) -> Result<[Variation; 2], LawFailure> {
        if self.is_controlled && sliding.checked()?.dt > 0.0 {
            return Ramp::new(self, old, sliding, directions, [0.0; 2]).variations();
        }
        Ok(self.increment(old, sliding, directions, [0.0; 2])?.1)
    }
}

impl RateAndState {
    /// One increment of first order, and how the state at its end varies along two directions, and with the pressure at the
    /// end.
    ///
    /// # Errors
    /// As of the answer itself.
    pub(super) fn increment(
        &self,
        old: &FrictionState,
        sliding: Sliding,
        directions: [Direction; 2],
        dpressure: [f64; 2],
    ) -> Result<(FrictionResponse, [Variation; 2]), LawFailure> {
        let law = &self.coefficients;
        let (response, found) = self.relax(old, sliding)?;
        let Sliding { slip, pressure, dt } = sliding;
        let trial = old.traction + law.alpha_t * slip;
        let dtrial = |by: &Direction| by.state.traction + law.alpha_t * by.slip + by.of(5) * slip;
        let Some(found) = found else {
            let left = if pressure <= 0.0 { 0.0 } else { response.dtraction_dslip / law.alpha_t };
            return Ok((response, directions.map(|by| Variation::new(left * dtrial(&by), by.variable()))));
        };
        let log_state = law.log_state(old.variables[0]);
        let relaxation = Relaxation { law, trial: trial.abs(), pressure, dt, log_state };
        let sign = trial.signum();
        let varied = |k: usize| {
            let (by, dpressure) = (&directions[k], dpressure[k]);
            relaxation.vary(&found, by, (sign * dtrial(by), dpressure)).along(sign)
        };
        Ok((response, [varied(0), varied(1)]))
    }
}

impl Relaxation<'_> {
    /// Derivatives of (2) to (5) of the law and of G where it is solved, `dtrial` being that of |q_tr| and `dpressure` of p:
    ///
    /// ```text
    /// d ln θ₁ = e⁻ˣ dθ₀/θ − x S dD_c + S dλ,   S = ∂ ln θ₁/∂λ         θ: θ₁ of the ageing law, θ₀ of the slip law
    /// dψ = df₀ + db ln(V₀ θ₁/D_c) + b (dV₀/V₀ − dD_c/D_c + d ln θ₁)
    /// d|q| = p (arsinh(eʷ) da + arsinh'(eʷ) (dψ − ψ da/a + a (dλ/λ − dV₀/V₀))) + |q| dp/p
    /// D dλ = d|q_tr| − λ dα_t − ∂|q|
    /// ```
    fn vary(&self, found: &Relaxed, by: &Direction, (dtrial, dpressure): (f64, f64)) -> Variation {
        let Coefficients { reference_rate, a, b, critical_slip, alpha_t, evolution, .. } = *self.law;
        let [df_0, drate, da, db, dcritical, dstiffness] = std::array::from_fn(|place| by.of(place));
        let (log_state, log_by_slip) = self.log_state_after(found.slip);
        let (theta, psi) = (self.law.theta(log_state), self.law.psi(log_state));
        let x = found.slip / critical_slip;
        let from = match evolution {
            StateEvolution::Ageing => theta,
            StateEvolution::Slip => self.law.theta(self.log_state),
        };
        let dlog = (-x).exp() * by.variable() / from - x * log_by_slip * dcritical;
        let dpsi = df_0 + db * log_state + b * (drate / reference_rate - dcritical / critical_slip + dlog);
        let (arsinh, rate) = arsinh_of_exp(found.log_sinh);
        let dstrength = self.pressure * (da * arsinh + rate * (dpsi - psi * da / a - a * drate / reference_rate))
            + a * arsinh * dpressure;
        let slope = found.slope.max(LEAST_SLOPE * alpha_t);
        let dslip = (dtrial - dstiffness * found.slip - dstrength) / slope;
        Variation::new(dstrength + (slope - alpha_t) * dslip, theta * (dlog + log_by_slip * dslip))
    }
}

impl Variation {
    /// With the traction counted along the sign.
    fn along(self, sign: f64) -> Self {
        Self { traction: sign * self.traction, ..self }
    }
}
