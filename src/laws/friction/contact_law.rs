//! Friction at the points of a contact: a friction law, and the motion of the surfaces along the normal by dilatancy and wear
//! due to plastic slip.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bond::{Bond, BondParameters, BondSurfaces};
use super::{Answer, Description, FrictionLaw, FrictionResponse, FrictionState, Sliding, observables};
use crate::laws::parameter::{InvalidParameter, require_positive};

/// Dilatancy of a contact: asperities override each other as the surfaces slip, until the interface has its largest
/// opening, or as long as the friction law has structure to lose. Either `rate` or `structure` is given.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Dilatancy {
    /// tan ψ: initial opening per plastic slip, in either direction of slip, with any law; below its lowest friction
    /// coefficient (mu, mu_k, mu_d), because friction supplies the work of dilatancy [-]
    pub rate: Option<f64>,
    /// d of tan ψ = d (1/R* − 1) = d (μ/μ_k − 1), of super_subloading: the surfaces dilate with the structure that is left,
    /// keep their opening at residual friction, and dilate again once they have healed. At the full structure tan ψ must
    /// be below mu_s: d < mu_s mu_k/(mu_s − mu_k) [-]
    pub structure: Option<f64>,
    /// d_max: opening after long slip, dδ = tan ψ (1 − δ/d_max) × plastic slip; unlimited by default. The opening δ is
    /// `dilation` in tables and frames [L]
    pub limit: Option<f64>,
}

impl Dilatancy {
    /// Creates dilatancy of a constant tan ψ, without a limit.
    pub const fn new(rate: f64) -> Self {
        Self { rate: Some(rate), structure: None, limit: None }
    }

    /// Creates dilatancy of tan ψ = d (1/R* − 1), without a limit.
    pub const fn of_structure(d: f64) -> Self {
        Self { rate: None, structure: Some(d), limit: None }
    }

    /// Dilation δ₁ after ∫ tan ψ dλ, and its derivative by that.
    fn after(self, dilation: f64, unlimited: f64) -> [f64; 2] {
        let Some(limit) = self.limit else { return [dilation + unlimited, 1.0] };
        let exponent = -unlimited / limit;
        let left = limit - dilation;
        [dilation - left * exponent.exp_m1(), left / limit * exponent.exp()]
    }

    /// Refuses parameters out of range.
    fn check(self) -> Result<(), InvalidParameter> {
        self.limit.map_or(Ok(()), |limit| require_positive("dilatancy.limit", limit))?;
        let refused =
            |name, value, allowed: &'static str| Err(InvalidParameter { name, value, allowed: allowed.into() });
        match (self.rate, self.structure) {
            (Some(rate), None) => require_positive(Self::RATE, rate),
            (None, Some(d)) => require_positive(Self::STRUCTURE, d),
            (Some(_), Some(d)) => refused(Self::STRUCTURE, d, "`rate` is given as well: leave one of them out"),
            (None, None) => refused(Self::RATE, 0.0, "it must be given, or `structure` in its place"),
        }
    }

    const RATE: &str = "dilatancy.rate";
    const STRUCTURE: &str = "dilatancy.structure";
}

setters! { const dilatancy: Dilatancy;
    /// Sets the largest opening [L].
    limit(limit: f64) { dilatancy.limit = Some(limit); }
}

/// Dilatancy that does more work than friction: its key, tan ψ, and the friction coefficient that is not above it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct Beyond {
    /// `dilatancy.rate` or `dilatancy.structure`
    pub key: &'static str,
    /// tan ψ [-]
    pub rate: f64,
    /// lowest coefficient of the law, or that of its full structure [-]
    pub least: f64,
}

/// Dilatancy and wear of the surfaces of a contact, independent of its friction law; none by default.
///
/// ```text
/// λ = |Δu^p|                                         plastic slip of the increment, whichever way it goes
/// dδ = tan ψ (1 − δ/d_max) dλ                        dilation: δ₁ = d_max − (d_max − δ₀) exp(−∫ tan ψ dλ/d_max)         (1)
/// tan ψ = d (1/R* − 1)                               with structure: ∫ tan ψ dλ = d S, [`FrictionLaw::structured_slip`]
/// dw = k p dλ                                        wear:     w₁ = w₀ + k ½(p₀ + p₁) λ                               (2)
/// d = δ − w                                          opening
/// dW = q dλ − p dd                                   dissipation: dilation lifts the load out of the work of friction   (3)
/// δλ = sgn Δu^p (δΔu_t − δq/α_t)                     tangent; without α_t all slip is plastic
/// ```
/// (1) does not distinguish forward and backward slip: asperities are overridden permanently, and the surfaces do not close
/// again when slip reverses. (Interlocked ones would.) The opening persists while the surfaces are separated. (2) is Archard's
/// law with k = K/H, the wear coefficient divided by the hardness; p varies linearly over the increment, as in (3).
///
/// With structure, 1/R* = μ/μ_k, the interface dilates most at the peak, shears at constant volume at the residual, μ = μ_k, and
/// dilates again after healing. Sliding takes work if tan ψ < μ for every μ from μ_k to μ_s, which the greatest decides:
/// d (μ_s/μ_k − 1) < μ_s. Before that, while R is small, plastic slip may lift the load by more than friction dissipates, as with a
/// constant tan ψ.
///
/// (3) is the work of friction and pressure on flat surfaces. The contact applies q to both sides across the gap g without a
/// couple, so that where the surfaces rotate by dθ under the slip the work q g dθ is missing, the fraction g/R of the
/// frictional work on a radius R: the opening must be small compared with R. Without an opening, g is as small as the
/// penetration.
///
/// Sources: J. F. Archard, J. Appl. Phys. 24 (1953) 981; (1) P. Segall, J. R. Rice, J. Geophys. Res. 100 (1995) 22155, whose
/// porosity approaches its state-dependent value over a slip distance in the same way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[doc(hidden)]
pub struct Offsets {
    /// Dilatancy
    pub dilatancy: Option<Dilatancy>,
    /// k: depth of wear per pressure and plastic slip [L²/F]
    pub wear: Option<f64>,
}

impl Offsets {
    /// Checks the parameters.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] named by its key, such as `dilatancy.rate` or `wear`, if one is out of range.
    fn check(&self) -> Result<(), InvalidParameter> {
        self.dilatancy.map_or(Ok(()), Dilatancy::check)?;
        self.wear.map_or(Ok(()), |wear| require_positive("wear", wear))
    }

    /// Dilatancy that is not below the friction of a law: sliding would lift the load with more work than it dissipates.
    pub fn beyond(&self, law: &Description) -> Option<Beyond> {
        let least = law.least_coefficient.unwrap_or_else(|| law.starting_limit(1.0));
        let Dilatancy { rate, structure, .. } = self.dilatancy?;
        let beyond = match (rate, structure, law.full_structure) {
            (_, Some(d), Some(full)) => {
                Beyond { key: Dilatancy::STRUCTURE, rate: d * (full - 1.0), least: full * least }
            }
            (rate, ..) => Beyond { key: Dilatancy::RATE, rate: rate?, least },
        };
        (beyond.rate >= beyond.least).then_some(beyond)
    }

    /// Names of the parts of the opening that vary.
    fn names(&self) -> &'static [&'static str] {
        match (self.dilatancy, self.wear) {
            (Some(_), Some(_)) => &["dilation", "wear"],
            (Some(_), None) => &["dilation"],
            (None, Some(_)) => &["wear"],
            (None, None) => &[],
        }
    }

    /// Response of a law with stiffness α_t, completed by the change of the opening.
    fn moved(
        &self,
        law: &dyn FrictionLaw,
        old: &FrictionState,
        sliding: Sliding,
        mut response: FrictionResponse,
        stiffness: f64,
    ) -> Answer {
        let pressure = sliding.pressure;
        let (slip, sign) = (response.state.plastic_increment.abs(), response.state.plastic_increment.signum());
        if pressure <= 0.0 || slip == 0.0 {
            return Ok(response);
        }
        let elastic = |dtraction: f64| if stiffness > 0.0 { dtraction / stiffness } else { 0.0 };
        let dslip = sign * (1.0 - elastic(response.dtraction_dslip));
        let dslip_dpressure = -sign * elastic(response.dtraction_dpressure);
        let dilation = old.opening + old.wear;
        let unlimited = match self.dilatancy {
            Some(Dilatancy { structure: Some(d), .. }) => {
                law.structured_slip(old, sliding).transpose()?.unwrap_or_default().map(|slip| d * slip)
            }
            Some(Dilatancy { rate, .. }) => [slip, dslip, dslip_dpressure].map(|slip| rate.unwrap_or_default() * slip),
            None => [0.0; 3],
        };
        let [dilated, rate] = self.dilatancy.map_or([dilation, 0.0], |own| own.after(dilation, unlimited[0]));
        let (mean, wear) = (0.5 * (old.pressure + pressure), self.wear.unwrap_or(0.0));
        let state = &mut response.state;
        state.wear = old.wear + wear * mean * slip;
        state.opening = dilated - state.wear;
        state.dissipation -= mean * (state.opening - old.opening);
        response.dopening_dslip += rate * unlimited[1] - wear * mean * dslip;
        response.dopening_dpressure += rate * unlimited[2] - wear * (mean * dslip_dpressure + 0.5 * slip);
        response.finite()
    }
}

/// Strength without pressure at the points of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub enum Cohesion {
    /// That of the friction law itself: where the surfaces are open it goes on, and fades
    Own(Bond),
    /// A bond in parallel with friction, with a traction of its own
    Parallel(Bond),
}

impl Cohesion {
    /// The bond, of either kind.
    pub fn bond(&self) -> &Bond {
        match self {
            Self::Own(bond) | Self::Parallel(bond) => bond,
        }
    }
}

/// Friction of contact points: response of the law, followed by the change of the opening by its slip.
#[derive(Debug)]
#[doc(hidden)]
pub struct ContactLaw {
    /// The law
    pub law: Box<dyn FrictionLaw>,
    /// Description of the law, with the parts of the opening varied by the offsets, and a bond in parallel with it
    pub description: Description,
    /// α_t of the law alone [F/L³]
    pub stiffness: f64,
    /// Strength without pressure
    pub cohesion: Option<Cohesion>,
    offsets: Offsets,
}

impl<L: FrictionLaw + 'static> From<L> for ContactLaw {
    fn from(law: L) -> Self {
        Box::<dyn FrictionLaw>::from(Box::new(law)).into()
    }
}

impl From<Box<dyn FrictionLaw>> for ContactLaw {
    fn from(law: Box<dyn FrictionLaw>) -> Self {
        let description = law.description();
        Self { stiffness: description.stiffness, description, law, cohesion: None, offsets: Offsets::default() }
    }
}

impl ContactLaw {
    /// Combines a law with the offsets of its surfaces, and checks their parameters.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] named by its key, such as `dilatancy.rate` or `wear`, if one is out of range, if a law without
    /// structure is to dilate with it, or if dilatancy would supply more work than friction dissipates: tan ψ must be below the
    /// lowest coefficient of the law, if it has one ([`Description::least_coefficient`]), at the full structure below that.
    pub fn with_offsets(law: Box<dyn FrictionLaw>, offsets: Offsets) -> Result<Self, InvalidParameter> {
        offsets.check()?;
        let law = Self::from(law);
        let of_structure = offsets.dilatancy.and_then(|dilatancy| dilatancy.structure);
        if let (Some(value), None) = (of_structure, law.description.full_structure) {
            let allowed = "the friction law has no structure: take super_subloading, or give \"rate\" in its place";
            return Err(InvalidParameter { name: Dilatancy::STRUCTURE, value, allowed: allowed.into() });
        }
        if let Some(Beyond { key, rate, least }) = offsets.beyond(&law.description) {
            let (value, what) = match of_structure {
                Some(d) => {
                    (d, format!("it makes tan ψ = {rate} at the full structure, which must be below {least}, mu_s"))
                }
                None => (rate, format!("it must be below {least}, the lowest friction coefficient of the law")),
            };
            let allowed = format!("{what}, or sliding would produce energy: lower it, or raise the friction");
            return Err(InvalidParameter { name: key, value, allowed: allowed.into() });
        }
        if offsets == Offsets::default() {
            return Ok(law);
        }
        Ok(Self { description: Description { opening: offsets.names(), ..law.description }, offsets, ..law })
    }

    /// Lets the strength of the law at zero pressure fade over an opening; a law without any gets a bond in parallel with it.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] named by its key, such as `bond.tension`, if one is out of range.
    pub fn bonded(mut self, parameters: &BondParameters, surfaces: BondSurfaces) -> Result<Self, InvalidParameter> {
        let own = self.law.cohesion();
        let is_own = parameters.strength.is_none();
        let alpha_c = if is_own || surfaces.alpha_c.is_nan() { self.stiffness } else { surfaces.alpha_c };
        // Points without edges, whose law has no stiffness.
        let alpha_c = if alpha_c > 0.0 { alpha_c } else { 0.5 * surfaces.alpha_n };
        let surfaces = BondSurfaces { alpha_c, ..surfaces };
        if is_own {
            self.cohesion = Some(Cohesion::Own(Bond::of_law(own, parameters, surfaces)?));
            return Ok(self);
        }
        let Description { starting_coefficient, released_above, least_coefficient, .. } = self.description;
        let mu = starting_coefficient.or(released_above.map(|[_, mu]| mu)).or(least_coefficient).unwrap_or(0.0);
        let bond = Bond::new(parameters, BondSurfaces { mu, ..surfaces })?;
        let description = &mut self.description;
        description.stiffness += bond.stiffness();
        description.bond = bond.strength();
        if let Some([cohesion, _]) = &mut description.released_above {
            *cohesion += bond.strength();
        }
        if description.is_frictionless {
            description.is_frictionless = false;
            description.stiffness_is_penalty = true;
            description.starting_coefficient = None;
            description.released_above = Some([bond.strength(), 0.0]);
            description.least_coefficient = Some(0.0);
        }
        self.cohesion = Some(Cohesion::Parallel(bond));
        Ok(self)
    }

    /// Part of an initial traction under a pressure that a bond in parallel with friction has, in proportion to the strengths [F/L²].
    pub fn share_of_bond(&self, pressure: f64, traction: f64) -> f64 {
        let Some(Cohesion::Parallel(bond)) = &self.cohesion else { return 0.0 };
        let Description { starting_coefficient, released_above, .. } = self.law.description();
        let mu = starting_coefficient.or(released_above.map(|[_, mu]| mu)).or(self.description.least_coefficient);
        bond.share(traction, mu.unwrap_or(0.0) * pressure)
    }

    /// Largest initial |q| of a point without previous slip under the pressure p, of friction and a bond together; infinite where an
    /// excess is released by slip, and without a limit [F/L²].
    pub fn starting_limit(&self, pressure: f64) -> f64 {
        let limit = self.cohesion.map_or(f64::INFINITY, |cohesion| cohesion.bond().limit());
        self.description.starting_limit(pressure).min(limit)
    }

    /// Limits the traction of friction and a bond together: what exceeds the limit is slip of friction, which neither renews nor weakens
    /// it. Returns whether it is limited.
    pub fn limit(&self, old: &FrictionState, response: &mut FrictionResponse, bond: f64) -> bool {
        let limit = self.cohesion.map_or(f64::INFINITY, |cohesion| cohesion.bond().limit());
        let state = &mut response.state;
        let (total, was) = (state.traction + bond, state.traction);
        if total.abs() <= limit || total.is_nan() {
            return false;
        }
        let sign = total.signum();
        state.traction = sign * limit - bond;
        let further = if self.stiffness > 0.0 { (was - state.traction) / self.stiffness } else { 0.0 };
        state.plastic_increment += further;
        state.plastic_slip += further;
        let above = (sign * old.traction).min(sign * was).max(sign * state.traction);
        let mean = 0.5 * (above + sign * state.traction);
        state.dissipation = old.dissipation + mean * (sign * state.plastic_increment).max(0.0);
        state.regime = super::Regime::Slip;
        (response.dtraction_dslip, response.dtraction_dpressure) = (0.0, 0.0);
        true
    }

    /// Response to an increment, see [`FrictionLaw::respond`].
    ///
    /// # Errors
    /// Returns the failure of the law.
    pub fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        self.moved(old, sliding, self.law.respond(old, sliding))
    }

    /// Responses at several points, identical to those of single points.
    pub fn respond_many(&self, old: &[FrictionState], sliding: &[Sliding], answers: &mut [Answer]) {
        self.law.respond_many(old, sliding, answers);
        if self.offsets != Offsets::default() {
            let asked = old.iter().zip(sliding).zip(answers);
            asked.for_each(|((old, sliding), answer)| *answer = self.moved(old, *sliding, answer.clone()));
        }
    }

    fn moved(&self, old: &FrictionState, sliding: Sliding, answer: Answer) -> Answer {
        if self.offsets == Offsets::default() {
            return answer;
        }
        self.offsets.moved(&*self.law, old, sliding, answer?, self.stiffness)
    }

    /// Value of an observable in a state, or its default if the law does not define it: NaN for an additional one.
    pub fn observe(&self, name: &str, state: &FrictionState) -> f64 {
        match name {
            "dilation" if self.description.opening.contains(&name) => state.opening + state.wear,
            "wear" if self.description.opening.contains(&name) => state.wear,
            _ => observables::value(&*self.law, name, state),
        }
    }
}
