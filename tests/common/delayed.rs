//! A friction law of its own, as a user of the library would write one: one file, two variables, nothing else told.

use fecontact::laws::friction::{Answer, Description, FrictionLaw, FrictionResponse, FrictionState, Sliding};

/// Friction that follows a change of the pressure only as it slips, over two lengths.
///
/// ```text
/// q̇ = α_t (v − λ sgn q),   |q| ≤ μ (ψ₁ + ψ₂)                  slip = elastic + plastic
/// dψ_i/dλ = −(ψ_i − w_i p)/L_i,   w₁ + w₂ = 1                 delayed pressure; ψ_i = w_i p at first touch
/// ```
/// With the pressure of the increment's end, ψ_i is known exactly; Δλ is the one root of |q_tr| − α_t Δλ − μ Σ ψ_i(Δλ).
///
/// Source: Prakash & Clifton (1993), in Experimental Techniques in the Dynamics of Deformable Solids (AMD 165), 33;
/// Prakash (1998), J. Tribol. 120, 97.
#[derive(Debug)]
pub struct DelayedPressure {
    /// μ [-]
    pub mu: f64,
    /// α_t [F/L³]
    pub alpha_t: f64,
    /// w_i [-]
    pub shares: [f64; 2],
    /// L_i [L]
    pub lengths: [f64; 2],
}

impl DelayedPressure {
    /// ψ_i after Δλ under the pressure p: w_i p + (ψ_i − w_i p) exp(−Δλ/L_i).
    fn delayed(&self, psi: [f64; 2], pressure: f64, slip: f64) -> [f64; 2] {
        [0, 1].map(|i| {
            let end = self.shares[i] * pressure;
            end + (psi[i] - end) * (-slip / self.lengths[i]).exp()
        })
    }
}

impl FrictionLaw for DelayedPressure {
    fn description(&self) -> Description {
        Description { stiffness: self.alpha_t, variables: &["psi_1", "psi_2"], ..Description::default() }
    }

    fn initial_state(&self, pressure: f64, traction: f64) -> FrictionState {
        FrictionState::default().loaded(pressure, traction).with_variables(self.shares.map(|share| share * pressure))
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let Self { mu, alpha_t, shares, lengths } = *self;
        let Sliding { slip, pressure, .. } = sliding.checked()?;
        if pressure <= 0.0 {
            return FrictionResponse::elastic(old.parted(alpha_t).with_variables([0.0; 2]), 0.0).checked(alpha_t);
        }
        let touches = old.pressure <= 0.0;
        let [first, second] = [0, 1].map(|k| old.variables[k]);
        let psi = if touches { shares.map(|share| share * pressure) } else { [first, second] };
        let trial = old.traction + alpha_t * slip;
        let excess =
            |slid: f64| trial.abs() - alpha_t * slid - mu * self.delayed(psi, pressure, slid).iter().sum::<f64>();
        if excess(0.0) <= 0.0 {
            return FrictionResponse::elastic(old.stuck(trial, pressure).with_variables(psi), alpha_t).checked(alpha_t);
        }
        // The root by halves, down to neighbouring numbers.
        let (mut low, mut high) = (0.0, trial.abs() / alpha_t);
        while let middle = 0.5 * (low + high)
            && low < middle
            && middle < high
        {
            if excess(middle) > 0.0 { low = middle } else { high = middle }
        }
        let slid = high;
        let after = self.delayed(psi, pressure, slid);
        // ∂ψ_i/∂Δλ and ∂ψ_i/∂p, and ∫ ψ_i dλ
        let rates = [0, 1].map(|i| (shares[i] * pressure - after[i]) / lengths[i]);
        let follow = |i: usize| if touches { 1.0 } else { -(-slid / lengths[i]).exp_m1() };
        let work = [0, 1].map(|i| shares[i] * pressure * slid - lengths[i] * (after[i] - psi[i]));
        let slope = alpha_t + mu * (rates[0] + rates[1]);
        let strength = mu * (after[0] + after[1]);
        let state = old.slid(trial, trial.signum() * strength, mu * (work[0] + work[1]) / slid, pressure, alpha_t);
        FrictionResponse {
            state: state.with_variables(after),
            dtraction_dslip: alpha_t * (1.0 - alpha_t / slope),
            dtraction_dpressure: trial.signum() * alpha_t * mu * (shares[0] * follow(0) + shares[1] * follow(1))
                / slope,
            ..Default::default()
        }
        .checked(alpha_t)
    }
}
