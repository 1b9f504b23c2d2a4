//! A bond between two surfaces, in parallel with friction: strength that needs no pressure.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::traction_at_yield;
use crate::laws::dual::{Dual, Number};
use crate::laws::parameter::{InvalidParameter, require, require_not_negative, require_positive};

/// Bond of a contact, in parallel with its friction: strength without pressure, in shear and in tension.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct BondParameters {
    /// c: shear strength at zero pressure, in addition to that of friction, c > 0. Required, but with `adhesion` and with the `cohesion` of
    /// slip_weakening, which have it already [F/L²]
    pub strength: Option<f64>,
    /// c_r: what is left of it after the slip `slip`, or after an opening, once the surfaces meet again, 0 ≤ c_r ≤ c; default c,
    /// and 0 where `slip` is given [F/L²]
    pub residual: Option<f64>,
    /// D: slip over which the strength falls from c to c_r, and the tension to 0; default: without end [L]
    pub slip: Option<f64>,
    /// t: tensile strength, 0 ≤ t ≤ c/μ, with the coefficient μ that friction starts with; the surfaces open by t/α_n before it is
    /// reached; default 0 [F/L²]
    #[serde(default)]
    pub tension: f64,
    /// δ: opening at which nothing is carried any more, neither shear nor tension, δ > 2 t/α_n; a length of the interface. Default
    /// 4 c h/E of the softer side, with the longest edge h of the slave in the mesh as read [L]
    pub opening: Option<f64>,
    /// τ_max: limit of the shear traction of friction and bond together, τ_max ≥ c; default: none [F/L²]
    pub limit: Option<f64>,
    /// Whether surfaces that do not touch at the start are bonded as well, within the opening and without stress over the gap that they
    /// have; otherwise they have c_r alone once they meet
    #[serde(default)]
    pub bonded: bool,
    /// α_c: stiffness of the bond against slip. Default: α_t of the friction where it is a penalty everywhere on the contact, otherwise the
    /// α_t that a penalty has by default [F/L³]
    pub alpha_t: Option<f64>,
}

impl BondParameters {
    /// Creates a bond of a shear strength c that slip does not end, without tension [F/L²].
    pub fn new(strength: f64) -> Self {
        Self { strength: Some(strength), ..Self::default() }
    }
}

setters! { const law: BondParameters;
    /// Sets c_r [F/L²].
    residual(residual: f64) { law.residual = Some(residual); }

    /// Sets D [L].
    slip(slip: f64) { law.slip = Some(slip); }

    /// Sets t [F/L²].
    tension(tension: f64) { law.tension = tension; }

    /// Sets δ [L].
    opening(opening: f64) { law.opening = Some(opening); }

    /// Sets τ_max [F/L²].
    limit(limit: f64) { law.limit = Some(limit); }

    /// Sets α_c [F/L³].
    alpha_t(alpha_t: f64) { law.alpha_t = Some(alpha_t); }
}

/// What a bond takes from its contact.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct BondSurfaces {
    /// α_n of the contact [F/L³]
    pub alpha_n: f64,
    /// α_c: stiffness of the bond against slip if none is given [F/L³]
    pub alpha_c: f64,
    /// μ that friction starts with [-]
    pub mu: f64,
    /// δ if none is given [L]
    pub opening: f64,
}

impl BondSurfaces {
    /// Surfaces with these stiffnesses and this coefficient of friction, where the opening δ is given.
    pub const fn new(alpha_n: f64, alpha_c: f64, mu: f64) -> Self {
        Self { alpha_n, alpha_c, mu, opening: f64::INFINITY }
    }
}

/// A bond in parallel with friction: gap and slip are shared, and tractions are summed.
///
/// ```text
/// p = p_N − T,   q = q_f + q_b                                      p_N, q_f: pressure and friction; the bond has T and q_b
/// w = ⟨gap⟩,   w_e = t/α_n,   φ = ⟨1 − ⟨w − w_e⟩/(δ − w_e)⟩
/// κ = min(1, ⟨w_max − w_e⟩/(δ − w_e) + Λ/D)                        irreversible; Λ: plastic slip of the bond
/// T = t (1 − κ) min(1, ⟨w − w₀⟩/max(w_max − w₀, w_e))              secant unloading; w₀: gap over which it was bonded
/// |q_b| ≤ s = (c − c_r)(1 − κ) + c_r φ − μ T                       c_r φ returns where surfaces meet again, c − c_r does not
/// ```
/// With friction of the coefficient μ, c + μ p is one straight line from pressure into tension. An increment takes the state at its
/// end for w; slip is returned to the strength,
/// ```text
/// q_tr = q_b0 + α_c Δu;   Δλ = (|q_tr| − s₀)/(α_c − S),   S = (c − c_r − μ T/(1 − κ))/D                        while κ < 1
///                         Δλ = (|q_tr| − c_r φ)/α_c                                                           where the bond is used up
/// ```
/// Stored is q_b²/2α_c + T (w − w₀)/2, dissipated the mean of |q_b| over Δλ and what the secant stiffness loses, each of which is never negative.
/// The traction is continuous in w, so that an open point has an equilibrium wherever a closed one has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bond {
    strength: f64,
    residual: f64,
    /// D, infinite without softening by slip [L]
    slip: f64,
    tension: f64,
    opening: f64,
    limit: f64,
    bonded: bool,
    mu: f64,
    /// α_c [F/L³]
    stiffness: f64,
    /// w_e [L]
    elastic: f64,
}

/// Memory of a bond at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct BondState {
    /// q_b [F/L²]
    pub traction: f64,
    /// T [F/L²]
    pub tension: f64,
    /// w at the end of the last increment [L]
    pub opening: f64,
    /// w_max [L]
    pub opened: f64,
    /// w₀: gap over which it was bonded, from which tension counts [L]
    pub rest: f64,
    /// Λ [L]
    pub slip: f64,
    /// What a multiplier of the traction leaves of elastic slip; 0 for the plain penalty [L]
    pub elastic_slip: f64,
}

/// Response of a bond to an increment, with the tangent of exactly that.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct BondResponse {
    /// State at the end
    pub state: BondState,
    /// Plastic slip of the increment, signed along +s [L]
    pub plastic: f64,
    /// Work dissipated in the increment [F/L]
    pub dissipation: f64,
    /// s: strength at the end [F/L²]
    pub strength: f64,
    /// ∂T/∂w and ∂T/∂Δu [F/L³]
    pub dtension: [f64; 2],
    /// ∂q_b/∂w and ∂q_b/∂Δu [F/L³]
    pub dtraction: [f64; 2],
}

/// What is left of a bond, before it slips.
struct Left<N> {
    /// κ
    used: N,
    /// c_r φ
    residual: N,
    /// T/(t (1 − κ))
    share: N,
    tension: N,
    strength: N,
}

impl Bond {
    /// Creates the bond from checked parameters.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] named by its key, such as `bond.strength`, if one is out of range.
    pub fn new(parameters: &BondParameters, surfaces: BondSurfaces) -> Result<Self, InvalidParameter> {
        let BondParameters { tension, bonded, .. } = *parameters;
        let BondSurfaces { alpha_n, alpha_c, mu, .. } = surfaces;
        let (alpha_c, key) = parameters.alpha_t.map_or((alpha_c, "alpha_t"), |given| (given, "bond.alpha_t"));
        let strength = parameters.strength.unwrap_or(f64::NAN);
        require_positive("bond.strength", strength)?;
        let residual = parameters.residual.unwrap_or(if parameters.slip.is_some() { 0.0 } else { strength });
        let allowed = || format!("it must lie between zero and \"strength\", which is {strength}");
        require("bond.residual", residual, (0.0..=strength).contains(&residual), allowed())?;
        let slip = parameters.slip.unwrap_or(f64::INFINITY);
        if parameters.slip.is_some() {
            require_positive("bond.slip", slip)?;
        }
        require_not_negative("bond.tension", tension)?;
        let allowed = format!(
            "friction starts with mu = {mu}, and the line of strength c + mu p ends at the tension c/mu = {}: lower it, or raise \"strength\"",
            strength / mu
        );
        require("bond.tension", tension, mu * tension <= strength, allowed)?;
        require_positive(key, alpha_c)?;
        let least = (strength - residual) / slip;
        let allowed = format!(
            "the strength falls by {least:e} per slip, faster than alpha_t = {alpha_c:e} unloads: make it longer than {:e}, or raise alpha_t",
            (strength - residual) / alpha_c
        );
        require("bond.slip", if slip.is_finite() { slip } else { 0.0 }, alpha_c > least, allowed)?;
        let (opening, elastic) = (parameters.opening.unwrap_or(surfaces.opening), tension / alpha_n);
        if let Some(given) = parameters.opening {
            require_positive("bond.opening", given)?;
        }
        let allowed = format!(
            "the surfaces open by tension/alpha_n = {elastic:e} before the tension is reached: it must exceed twice that"
        );
        require("bond.opening", if opening.is_finite() { opening } else { 0.0 }, opening > 2.0 * elastic, allowed)?;
        let limit = parameters.limit.unwrap_or(f64::INFINITY);
        let allowed = format!("it must not be below \"strength\", which is {strength}");
        require("bond.limit", if limit.is_finite() { limit } else { strength }, limit >= strength, allowed)?;
        Ok(Self { strength, residual, slip, tension, opening, limit, bonded, mu, stiffness: alpha_c, elastic })
    }

    /// Creates what goes on, where surfaces open, of a law's own cohesion, which may be zero.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] named by its key, such as `bond.opening`, if one is out of range.
    pub(super) fn of_law(
        cohesion: f64,
        parameters: &BondParameters,
        surfaces: BondSurfaces,
    ) -> Result<Self, InvalidParameter> {
        let some = if cohesion > 0.0 { cohesion } else { f64::MIN_POSITIVE };
        let bond = Self::new(&BondParameters { strength: Some(some), ..*parameters }, surfaces)?;
        Ok(Self { strength: cohesion, residual: cohesion, ..bond })
    }

    /// c [F/L²]
    pub fn strength(&self) -> f64 {
        self.strength
    }

    /// c_r [F/L²]
    pub fn residual(&self) -> f64 {
        self.residual
    }

    /// D; infinite without softening by slip [L]
    pub fn slip(&self) -> f64 {
        self.slip
    }

    /// t [F/L²]
    pub fn tension(&self) -> f64 {
        self.tension
    }

    /// δ [L]
    pub fn opening(&self) -> f64 {
        self.opening
    }

    /// τ_max; infinite without one [F/L²]
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// α_c [F/L³]
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// State at the start of a run, under a part of the initial traction, of surfaces that touch or lie apart by a gap.
    pub fn start(&self, gap: Option<f64>, traction: f64) -> BondState {
        let opened = match gap {
            None => 0.0,
            Some(gap) if self.bonded => gap.clamp(0.0, self.opening),
            Some(_) => self.opening,
        };
        let opened = if opened.is_finite() { opened } else { 0.0 };
        BondState { traction, opened, opening: opened, rest: opened, ..BondState::default() }
    }

    /// Part of an initial traction under a pressure that the bond has, friction having the strength `of_friction`, or what the bond
    /// cannot have.
    pub fn share(&self, traction: f64, of_friction: f64) -> f64 {
        traction * self.strength / (self.strength + of_friction.max(traction.abs() - self.strength).max(0.0))
    }

    /// φ, and its derivative by w
    pub fn fading(&self, opening: f64) -> [f64; 2] {
        let Dual { value, by } = self.left_of(Dual::<1> { value: opening, by: [1.0] });
        [value, by[0]]
    }

    /// 1 − κ: what is left of c − c_r and of the tension, 1 before any damage [-]
    pub fn intact(&self, state: &BondState) -> f64 {
        1.0 - self.left(state, state.opening).used
    }

    /// s in a state [F/L²]
    pub fn strength_left(&self, state: &BondState) -> f64 {
        self.left(state, state.opening).strength
    }

    /// Whether surfaces that are open by w may carry anything.
    pub fn reaches(&self, opening: f64, state: &BondState) -> bool {
        opening < self.opening && (self.residual > 0.0 || self.intact(state) > 0.0)
    }

    /// φ
    fn left_of<N: Number>(&self, opening: N) -> N {
        let zero = N::from(0.0);
        let faded = (opening - self.elastic).max(zero) / (self.opening - self.elastic);
        (N::from(1.0) - faded).max(zero)
    }

    fn left<N: Number>(&self, old: &BondState, opening: N) -> Left<N> {
        let (zero, one) = (N::from(0.0), N::from(1.0));
        let most = opening.max(old.opened.into());
        let opened = (most - self.elastic).max(zero) / (self.opening - self.elastic);
        let used = (opened + old.slip / self.slip).min(one);
        let (stretch, reference) = ((opening - old.rest).max(zero), (most - old.rest).max(self.elastic.into()));
        let share = if self.tension > 0.0 && reference.value() > 0.0 { stretch / reference } else { zero };
        let tension = (one - used) * share * self.tension;
        let residual = self.left_of(opening) * self.residual;
        let strength = (one - used) * (self.strength - self.residual) + residual - tension * self.mu;
        Left { used, residual, share, tension, strength: strength.max(zero) }
    }

    /// Response to an increment of slip that ends at the opening w: 0 where the surfaces are closed, with no derivative by it.
    /// `sticks` predicts that it sticks.
    #[must_use]
    pub fn respond(&self, old: &BondState, opening: f64, slip: f64, sticks: bool) -> BondResponse {
        let Self { slip: softening, stiffness, .. } = *self;
        let w = Dual { value: opening, by: [f64::from(u8::from(opening > 0.0)), 0.0] };
        let left = self.left(old, w);
        let trial = Dual { value: old.traction + stiffness * slip, by: [0.0, stiffness] };
        let sign = trial.value.signum();
        let size = trial * sign;
        if sticks || size.value <= left.strength.value {
            return self.ended(old, opening, [left.tension, trial], left.strength.value, 0.0);
        }
        // S, by which the strength falls per slip
        let falls = left.used.value < 1.0 && softening.is_finite();
        let drop = (Dual::from(self.strength - self.residual) - left.share * (self.mu * self.tension)) / softening;
        let net = if falls { Dual::from(stiffness) - drop } else { stiffness.into() };
        let slid = (size - left.strength) / net;
        let (slid, strength, tension) = if falls && left.used.value + slid.value / softening >= 1.0 {
            ((size - left.residual) / stiffness, left.residual, Dual::from(0.0))
        } else {
            let tension =
                if falls { left.tension - left.share * slid * (self.tension / softening) } else { left.tension };
            let strength = if falls { size - slid * stiffness } else { left.strength };
            (slid, strength, tension)
        };
        let before = self.left(old, old.opening).strength;
        let at_yield = traction_at_yield([sign * old.traction, size.value], [before, left.strength.value]);
        let mean = 0.5 * (at_yield + strength.value);
        let mut response = self.ended(old, opening, [tension, strength * sign], strength.value, slid.value);
        response.plastic = sign * slid.value;
        response.dissipation += mean * slid.value;
        response
    }

    /// Response with these tractions after the plastic slip Δλ, with what the secant stiffness has lost.
    fn ended(
        &self,
        old: &BondState,
        opening: f64,
        [tension, traction]: [Dual; 2],
        strength: f64,
        slid: f64,
    ) -> BondResponse {
        // Up to the largest opening so far nothing is lost but by slip; beyond, the tension falls linearly.
        let most = old.opened.max(old.rest + self.elastic);
        let [from, then] = match opening > most {
            true => [most, self.left(old, most).tension],
            false => [old.opening, old.tension],
        };
        let stretch = |opening: f64| (opening - old.rest).max(0.0);
        let lost = 0.5 * (then * stretch(opening) - tension.value * stretch(from));
        let state = BondState {
            traction: traction.value,
            tension: tension.value,
            opening,
            opened: opening.max(old.opened),
            rest: old.rest,
            slip: old.slip + slid,
            elastic_slip: old.elastic_slip,
        };
        BondResponse {
            state,
            plastic: 0.0,
            dissipation: lost.max(0.0),
            strength,
            dtension: tension.by,
            dtraction: traction.by,
        }
    }
}
