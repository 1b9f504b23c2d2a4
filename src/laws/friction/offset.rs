//! How plastic slip moves the surfaces against each other along the normal: dilatancy and wear, beside any friction law.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Answer, FrictionLaw, FrictionResponse, FrictionState, Onset, Sliding};
use crate::laws::parameter::{InvalidParameter, require_positive};

/// Dilatancy of a contact, with any friction law: asperities ride up on each other as the surfaces slip, until the interface has its
/// largest opening.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Dilatancy {
    /// tan ψ: opening per plastic slip at the start, whichever way it goes; below the least coefficient that friction can come to
    /// (mu, mu_k, mu_d), for the work that lifts the load is friction's [-]
    pub rate: f64,
    /// d_max: opening that much slip leads to, dδ = tan ψ (1 − δ/d_max) × plastic slip; no limit unless given. The opening δ stands
    /// in tables and frames as `dilation` [L]
    pub limit: Option<f64>,
}

/// A friction law whose surfaces move apart, or wear, with plastic slip.
///
/// ```text
/// λ = |Δu^p|                                         plastic slip of the increment, whichever way it goes
/// dδ = tan ψ (1 − δ/d_max) dλ                        dilation: δ₁ = d_max − (d_max − δ₀) exp(−λ tan ψ/d_max)            (1)
/// dw = k p dλ                                        wear:     w₁ = w₀ + k ½(p₀ + p₁) λ                               (2)
/// d = δ − w                                          opening
/// dW = q dλ − p dd                                   dissipation: dilation lifts the load out of the work of friction   (3)
/// δλ = sgn Δu^p (δΔu_t − δq/α_t)                     tangent; without α_t all slip is plastic
/// ```
/// (1) makes no difference between slip one way and back: asperities are overridden for good, and the surfaces do not come down
/// again when slip reverses. (Interlocked ones would.) The opening stays while the surfaces are apart. (2) is Archard's law with k = K/H, the
/// wear coefficient over the hardness; p goes evenly over the increment, as it does in (3).
///
/// (3) is what friction and pressure do on flat surfaces. The contact puts q on both sides across the gap g without a couple, so that
/// where the surfaces turn by dθ under the slip the work q g dθ is missing, the share g/R of friction's on a radius R: the opening
/// must be small against that. Without an opening g is as small as the penetration.
///
/// Sources: J. F. Archard, J. Appl. Phys. 24 (1953) 981; (1) P. Segall, J. R. Rice, J. Geophys. Res. 100 (1995) 22155, whose
/// porosity goes to that of its state over a distance of slip in the same way.
#[derive(Debug)]
pub struct Offset {
    law: Box<dyn FrictionLaw>,
    dilatancy: Option<Dilatancy>,
    /// k; 0 for none [L²/F]
    wear: f64,
}

/// How the surfaces of a contact move apart with slip, whatever their law: not at all unless given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Offsets {
    /// Dilatancy
    pub dilatancy: Option<Dilatancy>,
    /// k: depth of wear per pressure and plastic slip [L²/F]
    pub wear: Option<f64>,
}

impl Offsets {
    /// tan ψ and the least coefficient of friction that a law can come to, where the first is not below the second: sliding
    /// would lift the load with more work than it takes.
    pub fn beyond(&self, law: &dyn FrictionLaw) -> Option<[f64; 2]> {
        let rate = self.dilatancy?.rate;
        let least = law.least_coefficient().unwrap_or_else(|| law.starting_limit(1.0));
        (rate >= least).then_some([rate, least])
    }
}

/// What a friction law says of itself where its surfaces dilate.
const DILATES: &[&str] = &["dilation"];
const WEARS: &[&str] = &["wear"];
const BOTH: &[&str] = &["dilation", "wear"];

impl Dilatancy {
    /// δ₁ and ∂δ₁/∂λ.
    fn after(self, dilation: f64, slip: f64) -> [f64; 2] {
        let Some(limit) = self.limit else { return [dilation + self.rate * slip, self.rate] };
        let exponent = -slip * self.rate / limit;
        let left = limit - dilation;
        [dilation - left * exponent.exp_m1(), left * self.rate / limit * exponent.exp()]
    }
}

impl Offset {
    /// Of a law, with its parameters checked; `wear` is k.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a parameter is out of its range, named `dilatancy.rate`, `dilatancy.limit` or `wear`; also a
    /// dilatancy that would give more work than friction takes: tan ψ must be below the least coefficient that the law can come
    /// to, if it has one ([`FrictionLaw::least_coefficient`]).
    pub fn new(
        law: Box<dyn FrictionLaw>,
        dilatancy: Option<Dilatancy>,
        wear: Option<f64>,
    ) -> Result<Self, InvalidParameter> {
        if let Some(Dilatancy { rate, limit }) = dilatancy {
            require_positive("dilatancy.rate", rate)?;
            limit.map_or(Ok(()), |limit| require_positive("dilatancy.limit", limit))?;
            if let Some([_, least]) = (Offsets { dilatancy, wear }).beyond(&*law) {
                let allowed = format!(
                    "it must be below {least}, the least friction coefficient that the law can come to, or sliding would yield work \
                     instead of taking it: lower it, or raise the friction"
                );
                return Err(InvalidParameter { name: "dilatancy.rate", value: rate, allowed: allowed.into() });
            }
        }
        wear.map_or(Ok(()), |wear| require_positive("wear", wear))?;
        Ok(Self { law, dilatancy, wear: wear.unwrap_or(0.0) })
    }

    /// A law with the offsets of its surfaces; as it is where there are none.
    ///
    /// # Errors
    /// As of [`Offset::new`].
    pub fn over(law: Box<dyn FrictionLaw>, offsets: Offsets) -> Result<Box<dyn FrictionLaw>, InvalidParameter> {
        match offsets {
            Offsets { dilatancy: None, wear: None } => Ok(law),
            Offsets { dilatancy, wear } => Ok(Box::new(Self::new(law, dilatancy, wear)?)),
        }
    }

    /// The answer of the law with what it means for the opening.
    fn moved(&self, old: &FrictionState, pressure: f64, mut response: FrictionResponse) -> Answer {
        let stiffness = self.law.stiffness();
        let (slip, sign) = (response.state.plastic_increment.abs(), response.state.plastic_increment.signum());
        if pressure <= 0.0 || slip == 0.0 {
            return Ok(response);
        }
        let elastic = |dtraction: f64| if stiffness > 0.0 { dtraction / stiffness } else { 0.0 };
        let dslip = sign * (1.0 - elastic(response.dtraction_dslip));
        let dslip_dpressure = -sign * elastic(response.dtraction_dpressure);
        let dilation = old.opening + old.wear;
        let [dilated, by_slip] = self.dilatancy.map_or([dilation, 0.0], |dilatancy| dilatancy.after(dilation, slip));
        let mean = 0.5 * (old.pressure + pressure);
        let state = &mut response.state;
        state.wear = old.wear + self.wear * mean * slip;
        state.opening = dilated - state.wear;
        state.dissipation -= mean * (state.opening - old.opening);
        let rate = by_slip - self.wear * mean;
        response.dopening_dslip += rate * dslip;
        response.dopening_dpressure += rate * dslip_dpressure - 0.5 * self.wear * slip;
        response.checked(stiffness)
    }
}

impl FrictionLaw for Offset {
    fn initial_state(&self) -> FrictionState {
        self.law.initial_state()
    }

    fn starting_state(&self, pressure: f64, traction: f64) -> FrictionState {
        self.law.starting_state(pressure, traction)
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        self.moved(old, sliding.pressure, self.law.respond(old, sliding)?)
    }

    fn respond_many(&self, old: &[FrictionState], sliding: &[Sliding], answers: &mut [Answer]) {
        self.law.respond_many(old, sliding, answers);
        for ((old, sliding), answer) in old.iter().zip(sliding).zip(answers) {
            if let Ok(response) = *answer {
                *answer = self.moved(old, sliding.pressure, response);
            }
        }
    }

    fn variables(&self) -> &'static [&'static str] {
        self.law.variables()
    }

    fn observables(&self) -> &'static [&'static str] {
        self.law.observables()
    }

    fn offsets(&self) -> &'static [&'static str] {
        match (self.dilatancy, self.wear > 0.0) {
            (Some(_), true) => BOTH,
            (Some(_), false) => DILATES,
            (None, _) => WEARS,
        }
    }

    fn observe(&self, name: &str, state: &FrictionState) -> Option<f64> {
        match name {
            "dilation" => Some(state.opening + state.wear),
            "wear" => Some(state.wear),
            _ => self.law.observe(name, state),
        }
    }

    fn stiffness(&self) -> f64 {
        self.law.stiffness()
    }

    fn is_frictionless(&self) -> bool {
        self.law.is_frictionless()
    }

    fn starting_limit(&self, pressure: f64) -> f64 {
        self.law.starting_limit(pressure)
    }

    fn least_coefficient(&self) -> Option<f64> {
        self.law.least_coefficient()
    }

    fn weakening(&self) -> f64 {
        self.law.weakening()
    }

    fn onset(&self) -> Option<Onset> {
        self.law.onset()
    }
}
