use nalgebra::{Matrix4, Vector3, Vector4};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::elasticity::isotropic;
use super::{
    Elasticity, Elastoplastic, LogarithmicBulk, ONE, ROUND_OFF, ReturnDescription, ReturnMap, Returned, VOLUME,
    deviator, double_dot, in_axes, within,
};
use crate::laws::bulk::{Answer, CauchyStress, Flow, InadmissibleStress, MaterialFailure, Slot};
use crate::laws::parameter::{InvalidParameter, require, require_not_negative, require_positive};
use crate::laws::text::{at_least, number};

/// Constants of [`CamClay`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct CamClayParameters {
    /// λ: slope of the line of normal compression, ln v over ln p, or e over ln p where a void ratio e is given, λ > κ [-]
    pub lambda: f64,
    /// κ: slope of the lines of swelling, as λ, κ > 0 [-]
    pub kappa: f64,
    /// e: void ratio in the middle of the path, which makes slopes of ln v of slopes of e: λ/(1 + e), the specific volume v being 1 + e;
    /// default: λ and κ are slopes of ln v [-]
    #[serde(default)]
    pub e: Option<f64>,
    /// M: q/p at critical state; M or phi, M > 0 [-]
    #[serde(rename = "M", default)]
    pub critical: Option<f64>,
    /// φ: angle of friction at critical state in triaxial compression, M = 6 sin φ/(3 − sin φ), in degrees; M or phi
    #[serde(default)]
    pub phi: Option<f64>,
    /// G: shear modulus, constant; G or nu, G > 0 [F/L²]
    #[serde(rename = "G", default)]
    pub shear: Option<f64>,
    /// ν: Poisson's ratio under the initial stress, which gives every point its constant G there; G or nu, −1 < ν < 0.5 [-]
    #[serde(rename = "nu", default)]
    pub poisson: Option<f64>,
    /// p_c at the start: pressure of isotropic compression at which it yields; p_c or OCR, p_c ≥ p_min [F/L²]
    #[serde(default)]
    pub p_c: Option<f64>,
    /// Overconsolidation ratio at the start: p_c over p + q²/(M² p), that of a yield surface through the initial stress; p_c or OCR,
    /// OCR ≥ 1 [-]
    #[serde(rename = "OCR", default)]
    pub ratio: Option<f64>,
    /// p_min: pressure below which the stiffness does not fall any more, p_min > 0: far below the pressures of interest [F/L²]
    pub p_min: f64,
    /// ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
    #[serde(default)]
    pub density: f64,
    /// τ_v: relaxation time of the viscosity by Duvaut and Lions, τ_v ≥ 0; 0 for none [T]
    #[serde(default)]
    pub viscosity: f64,
}

impl CamClayParameters {
    /// Creates the parameters of a body without mass, λ and κ being slopes of ln v; G or ν and p_c or OCR are still to be given.
    pub fn new([lambda, kappa]: [f64; 2], critical: f64, p_min: f64) -> Self {
        Self { lambda, kappa, critical: Some(critical), p_min, ..Self::default() }
    }

    /// λ̂ and κ̂: slopes of ln J over ln p of the Kirchhoff stress, as [`CamClay`] takes them [-]
    pub fn slopes(&self) -> [f64; 2] {
        [self.lambda, self.kappa].map(|slope| {
            let slope = slope / (1.0 + self.e.unwrap_or(0.0));
            slope / (1.0 - slope)
        })
    }
}

setters! { const law: CamClayParameters;
    /// Sets the shear modulus [F/L²].
    shear(shear: f64) { law.shear = Some(shear); }

    /// Sets the initial p_c [F/L²].
    p_c(p_c: f64) { law.p_c = Some(p_c); }
}

/// Modified Cam-clay, with an elasticity that has a potential.
///
/// ```text
/// f = q²/M² + p (p − p_c) ≤ 0,   p = −tr τ/3,   q = √(3/2) ‖dev τ‖                                               (1)
/// p = p_m e^(ε_v/κ̂ − 1),   q = 3G ε_s                             elastic strains, see LogarithmicBulk           (2)
/// dε_v^p = dγ (2p − p_c),   dε_s^p = dγ 2q/M²                      associated                                     (3)
/// dp_c/p_c = dε_v^p/(λ̂ − κ̂)                                                                                    (4)
/// dissipation = p dε_v^p + q dε_s^p = dγ p p_c                                                                    (5)
/// ```
/// Volumes ε_v are positive in compression, ε_s = √(2/3) ‖dev ε‖. Strains being logarithmic, compression lines are straight in
/// ln v over ln p. Stress is that of Kirchhoff, τ = J σ: a line of slope λ* in σ has λ̂ = λ*/(1 − λ*) in τ, exactly in isotropic
/// compression; λ* = λ/(1 + e) of a slope λ of e.
///
/// The return finds Δγ, with ε_v inside of it, both by Newton's method within brackets:
/// ```text
/// ε_v + Δγ (2p − p_c) = ε_v,tr,   p_c = p_c,n e^((ε_v,tr − ε_v)/(λ̂ − κ̂))        rises with ε_v: one root        (6)
/// q = 3G ε_s,tr/(1 + 6G Δγ/M²),   F(Δγ) = q²/M² + p (p − p_c) = 0                  F > 0 at 0, < 0 far away       (7)
/// ```
/// The tangent is that of (6) and (7), which is not symmetric: p_c is that of the end of the increment.
///
/// # Errors
/// [`MaterialFailure::NotConverged`] when (7) has not been solved.
///
/// Source: Roscoe & Burland (1968), On the generalised stress-strain behaviour of wet clay; Borja & Tamagnini (1998), Comput. Methods
/// Appl. Mech. Eng. 155, 73 (finite strains); Butterfield (1979), Géotechnique 29, 469 (ln v over ln p).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamClay {
    /// λ̂ − κ̂
    pub(super) plastic: f64,
    /// κ̂
    kappa: f64,
    /// M
    pub(super) critical: f64,
    /// p_min
    floor: f64,
    shear: Shear,
    pub(super) start: Start,
}

/// Shear stiffness as given.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shear {
    Modulus(f64),
    /// G/K under the initial stress
    Ratio(f64),
}

/// Initial size of the yield surface as given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Start {
    Pressure(f64),
    Ratio(f64),
}

impl Start {
    /// Soil dilates to critical state where p is less than half of p_c/R*, and contracts to it above.
    pub(super) fn flow(self, structure: f64) -> Flow {
        match self {
            Self::Pressure(p_c) => Flow::DilatingBelow(0.5 * p_c / structure),
            Self::Ratio(ratio) if ratio > 2.0 => Flow::Dilating,
            Self::Ratio(_) => Flow::Contracting,
        }
    }
}

/// History of the law itself.
const OWN: [&str; 2] = ["p_c", "shear_modulus"];

pub(super) const P_C: Slot<1> = Slot::after(VOLUME);
pub(super) const SHEAR: Slot<1> = Slot::after(P_C);

/// Names of the quantities that the law shows.
const SHOWN: [&str; 3] = ["effective_pressure", "deviator_stress", "p_c"];

/// Most iterations for (6) and for (7).
const ITERATIONS: usize = 200;

/// Tolerance of (7), as a share of the squares in it.
const LEFT: f64 = 1e-15;

/// Tolerance where no number is nearer to the root.
const ALMOST: f64 = 1e-12;

/// Share of p_m by which pressures are round-off.
const ROUNDED: f64 = 1e-14;

/// The one of two keys that is given.
fn either<T>(
    [name, other]: [&'static str; 2],
    [a, b]: [Option<f64>; 2],
    [of_a, of_b]: [fn(f64) -> T; 2],
) -> Result<T, InvalidParameter> {
    match (a, b) {
        (Some(a), None) => Ok(of_a(a)),
        (None, Some(b)) => Ok(of_b(b)),
        (Some(value), Some(_)) => {
            let allowed = format!("`{other}` is given as well: leave one of them out");
            Err(InvalidParameter { name, value, allowed: allowed.into() })
        }
        (None, None) => {
            let allowed = format!("it must be given, or `{other}` in its place");
            Err(InvalidParameter { name, value: 0.0, allowed: allowed.into() })
        }
    }
}

impl CamClay {
    /// The law at large deformations.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a constant is out of its range.
    pub fn new(given: &CamClayParameters) -> Result<Elastoplastic<Self>, InvalidParameter> {
        Elastoplastic::new(Self::checked(given)?, given.density, given.viscosity)
    }

    /// The law of constants that are allowed.
    pub(super) fn checked(given: &CamClayParameters) -> Result<Self, InvalidParameter> {
        let CamClayParameters { lambda, kappa, e, critical, phi, shear, poisson, p_c, ratio, p_min, .. } = *given;
        require_positive("kappa", kappa)?;
        require("lambda", lambda, lambda > kappa, "it must be greater than kappa")?;
        if let Some(e) = e {
            require_not_negative("e", e)?;
        }
        let volumes = 1.0 + e.unwrap_or(0.0);
        let steep = "it must be less than 1 as a slope of ln v over ln p: is it one of e? then give e";
        require("lambda", lambda, lambda < volumes, steep)?;
        let [lambda, kappa] = given.slopes();
        let of_angle = |phi: f64| 6.0 * phi.to_radians().sin() / (3.0 - phi.to_radians().sin());
        if let Some(phi) = phi {
            require("phi", phi, phi > 0.0 && phi < 90.0, "it must be between 0 and 90 degrees")?;
        }
        let critical = either(["M", "phi"], [critical, phi], [|m| m, of_angle])?;
        require_positive("M", critical)?;
        let of_ratio = |nu: f64| Shear::Ratio(1.5 * (1.0 - 2.0 * nu) / (1.0 + nu));
        if let Some(nu) = poisson {
            require("nu", nu, nu > -1.0 && nu < 0.5, "it must be greater than -1 and less than 0.5")?;
        }
        if let Some(shear) = shear {
            require_positive("G", shear)?;
        }
        let shear = either(["G", "nu"], [shear, poisson], [Shear::Modulus, of_ratio])?;
        require_positive("p_min", p_min)?;
        if let Some(p_c) = p_c {
            require("p_c", p_c, p_c >= p_min, "it must be p_min or more")?;
        }
        if let Some(ratio) = ratio {
            require("OCR", ratio, ratio >= 1.0, "it must be 1 or more")?;
        }
        let start = either(["p_c", "OCR"], [p_c, ratio], [Start::Pressure, Start::Ratio])?;
        Ok(Self { plastic: lambda - kappa, kappa, critical, floor: p_min, shear, start })
    }

    /// Elasticity with a shear modulus.
    pub(super) fn logarithmic(&self, shear: f64) -> LogarithmicBulk {
        LogarithmicBulk { kappa: self.kappa, floor: self.floor, shear }
    }

    /// G at a pressure at the start.
    pub(super) fn initial_shear(&self, pressure: f64) -> f64 {
        match self.shear {
            Shear::Modulus(shear) => shear,
            Shear::Ratio(ratio) => ratio * self.logarithmic(0.0).bulk(pressure),
        }
    }

    /// What makes results depend on the mesh.
    pub(super) fn localizes(&self) -> Option<&'static str> {
        matches!(self.start, Start::Ratio(ratio) if ratio > 2.0).then_some("softens where p < p_c/2 (OCR > 2)")
    }

    /// p_c of a stress whose yield surface has a size P, the yield surface of the soil being 1/R* that of p_c.
    pub(super) fn initial_p_c(&self, size: f64, structure: f64) -> f64 {
        match self.start {
            Start::Pressure(p_c) => p_c,
            Start::Ratio(ratio) if size > 0.0 => (ratio * structure * size).max(self.floor),
            Start::Ratio(_) => self.floor,
        }
    }
}

/// Whether a stress compresses the soil.
///
/// # Errors
/// That it does not, and what to do.
pub(super) fn compressed(stress: &CauchyStress) -> Result<(), InadmissibleStress> {
    let p = stress.pressure() + 0.0;
    match p > 0.0 {
        true => Ok(()),
        false => Err(InadmissibleStress(format!(
            "has a mean pressure of {}, and Cam-clay has its stiffness and strength from pressure: give an initial stress that \
             compresses it, at a free surface by a surcharge",
            number(p)
        ))),
    }
}

/// p and q of a stress.
pub(super) fn invariants(stress: &Vector4<f64>) -> [f64; 2] {
    let (s, trace) = deviator(stress);
    [-trace / 3.0, (1.5 * double_dot(&s, &s)).sqrt()]
}

/// The equations of an increment: trial strains and what was committed.
struct Increment<'a> {
    law: &'a CamClay,
    elastic: LogarithmicBulk,
    /// ε_v,tr and ε_s,tr
    trial: [f64; 2],
    /// p_c,n
    before: f64,
}

/// A state on the way of Δγ.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    /// Δγ [L²/F]
    slip: f64,
    /// ε_v
    compression: f64,
    p: f64,
    q: f64,
    p_c: f64,
    /// K = dp/dε_v
    bulk: f64,
    /// F(Δγ)
    rest: f64,
    /// −dF/dΔγ
    fall: f64,
    /// Rate of (6) with ε_v
    rise: f64,
}

impl Increment<'_> {
    /// p, K, p_c at ε_v.
    fn at(&self, compression: f64) -> [f64; 3] {
        let [p, bulk] = self.elastic.pressure(compression);
        [p, bulk, self.before * ((self.trial[0] - compression) / self.law.plastic).exp()]
    }

    /// ε_v of (6), which lies between ε_v,tr and where 2p = p_c.
    fn compression(&self, slip: f64) -> f64 {
        let (trial, kappa, plastic) = (self.trial[0], self.law.kappa, self.law.plastic);
        let [p, _, p_c] = self.at(trial);
        if 2.0 * p == p_c || slip == 0.0 {
            return trial;
        }
        let ln_ratio = (p_c / (2.0 * self.law.floor)).ln();
        let balanced = (ln_ratio + 1.0 + trial / plastic) / (1.0 / kappa + 1.0 / plastic);
        let (mut low, mut high) = if 2.0 * p > p_c { (balanced, trial) } else { (trial, balanced.max(kappa)) };
        let mut found = trial;
        for _ in 0..ITERATIONS {
            let [p, bulk, p_c] = self.at(found);
            let rest = found - trial + slip * (2.0 * p - p_c);
            if rest > 0.0 {
                high = found
            } else {
                low = found
            }
            let next = found - rest / (1.0 + slip * (2.0 * bulk + p_c / plastic));
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if next == found || rest == 0.0 {
                break;
            }
            found = next;
        }
        found
    }

    /// (7) at a Δγ.
    fn state(&self, slip: f64) -> State {
        let CamClay { plastic, critical, .. } = *self.law;
        let (shear, square) = (self.elastic.shear, critical * critical);
        let compression = self.compression(slip);
        let [p, bulk, p_c] = self.at(compression);
        let over = 1.0 + 6.0 * shear * slip / square;
        let q = 3.0 * shear * self.trial[1] / over;
        let normal = 2.0 * p - p_c;
        let rise = 1.0 + slip * (2.0 * bulk + p_c / plastic);
        let fall =
            12.0 * shear * q * q / (square * square * over) + normal * (normal * bulk + p * p_c / plastic) / rise;
        State { slip, compression, p, q, p_c, bulk, rest: q * q / square + p * (p - p_c), fall, rise }
    }

    /// The root of (7) that is met first: a Δγ that is too large is found by doubling.
    fn solved(&self) -> Answer<State> {
        let start = self.state(0.0);
        let share = |state: &State| {
            let State { p, p_c, rest, .. } = *state;
            let q = state.q / self.law.critical;
            let rounded = (rest.abs() - ROUNDED * self.law.floor * (p.abs() + q + p_c)).max(0.0);
            rounded / (q * q + p * p + p_c * p_c).max(f64::MIN_POSITIVE)
        };
        let first = if start.fall > 0.0 { start.rest / start.fall } else { 1e-3 / start.rest.sqrt() };
        let [mut low, mut high] = [0.0, f64::INFINITY];
        let mut state = self.state(first);
        for _ in 0..ITERATIONS {
            if share(&state) <= LEFT && state.fall > 0.0 {
                return Ok(state);
            }
            if !state.rest.is_finite() {
                break;
            }
            if state.rest > 0.0 {
                low = state.slip
            } else {
                high = state.slip
            }
            let newton = state.slip + state.rest / state.fall;
            let next = match (newton > low && newton < high && state.fall > 0.0, high.is_finite()) {
                (true, true) => newton,
                (true, false) => newton.min(2.0 * state.slip),
                (false, true) if low > 0.0 => (low * high).sqrt(),
                (false, true) => 0.5 * high,
                (false, false) => 2.0 * state.slip,
            };
            if next == state.slip {
                break;
            }
            state = self.state(next);
        }
        match share(&state) <= ALMOST && state.fall > 0.0 {
            true => Ok(state),
            false => Err(MaterialFailure::NotConverged { law: NAME, residual: share(&state) }),
        }
    }

    /// D by (6) and (7), n the direction of the deviator.
    ///
    /// ```text
    /// S = (2p − p_c) K + p p_c/(λ̂ − κ̂),   A = 1 + Δγ (2K + p_c/(λ̂ − κ̂)),   B = 1 + Δγ p_c/(λ̂ − κ̂)
    /// dΔγ (−dF/dΔγ) = (2q/M²) q_s dε_s,tr + (S B/A − p p_c/(λ̂ − κ̂)) dε_v,tr,      q_s = q/ε_s,tr
    /// dp = K (B dε_v,tr − (2p − p_c) dΔγ)/A,   dq = q_s dε_s,tr − (2/M²) q_s q dΔγ
    /// ```
    fn tangent(&self, state: &State, normal: &Vector4<f64>) -> Matrix4<f64> {
        let State { slip, p, q, p_c, bulk, fall, rise, .. } = *state;
        let CamClay { plastic, critical, .. } = *self.law;
        let (shear, square) = (self.elastic.shear, critical * critical);
        let by_strain = 3.0 * shear / (1.0 + 6.0 * shear * slip / square);
        let (away, hardening) = (2.0 * p - p_c, p_c / plastic);
        let b = 1.0 + slip * hardening;
        let slip_by_volume = ((away * bulk + p * hardening) * b / rise - p * hardening) / fall;
        let slip_by_shear = 2.0 * q / square * by_strain / fall;
        let p_by_volume = bulk * (b - away * slip_by_volume) / rise;
        let p_by_shear = -bulk * away * slip_by_shear / rise;
        let q_by_slip = -2.0 * by_strain * q / square;
        let (q_by_volume, q_by_shear) = (q_by_slip * slip_by_volume, by_strain + q_by_slip * slip_by_shear);
        // n as it multiplies a strain, whose shear counts twice
        let along = Vector4::new(normal[0], normal[1], normal[2], 2.0 * normal[3]);
        let third = (2.0f64 / 3.0).sqrt();
        isotropic(p_by_volume, by_strain / 3.0)
            - third * p_by_shear * ONE * along.transpose()
            - third * q_by_volume * normal * ONE.transpose()
            + 2.0 / 3.0 * (q_by_shear - by_strain) * normal * along.transpose()
    }
}

/// Name of the law in a case.
const NAME: &str = "cam_clay";

impl ReturnMap for CamClay {
    fn description(&self) -> ReturnDescription<'_> {
        ReturnDescription {
            history: &OWN,
            shown: &SHOWN,
            flow: self.start.flow(1.0),
            // Flow is associated, but p_c of the end of the increment makes D unsymmetric.
            is_associated: false,
            localizes: self.localizes(),
            ..ReturnDescription::new(NAME)
        }
    }

    fn elasticity(&self, history: &[f64]) -> Elasticity {
        Elasticity::Logarithmic(self.logarithmic(SHEAR.value(history)))
    }

    fn begin(&self, stress: &CauchyStress, history: &mut [f64]) -> Result<(), InadmissibleStress> {
        let [p, q] = invariants(&Vector4::from(stress.components()));
        SHEAR.set(history, self.initial_shear(p));
        let size = p + q * q / (self.critical * self.critical * p);
        P_C.set(history, self.initial_p_c(if p > 0.0 { size } else { 0.0 }, 1.0));
        compressed(stress)?;
        within(self, stress, history, || {
            let [p, q, needed] = [number(p), number(q), at_least(size)];
            format!(
                "p = {p} and q = {q} need a p_c of {needed} at least; raise p_c, give OCR in its place, or choose K0 nearer to 1"
            )
        })
    }

    fn returned(&self, trial: &Vector3<f64>, _: &Vector4<f64>, history: &mut [f64]) -> Answer<Returned> {
        let elasticity = self.elasticity(history);
        let (elastic, strain) = (self.logarithmic(SHEAR.value(history)), in_axes(trial));
        let stress = elasticity.kirchhoff(&strain);
        if self.yield_indicator(&stress, history) <= ROUND_OFF * elastic.shear {
            let tangent = elasticity.stiffness(&strain);
            return Ok(Returned { stress, tangent, plastic: Vector4::zeros() });
        }
        let (of_shape, trace) = deviator(&strain);
        let size = double_dot(&of_shape, &of_shape).sqrt();
        let normal = if size > 0.0 { of_shape / size } else { of_shape };
        let trial = [-trace, (2.0f64 / 3.0).sqrt() * size];
        let increment = Increment { law: self, elastic, trial, before: P_C.value(history) };
        let state = increment.solved()?;
        P_C.set(history, state.p_c);
        let slipped = 2.0 * state.q * state.slip / (self.critical * self.critical);
        Ok(Returned {
            stress: (2.0f64 / 3.0).sqrt() * state.q * normal - state.p * ONE,
            tangent: increment.tangent(&state, &normal),
            plastic: 1.5f64.sqrt() * slipped * normal - (trial[0] - state.compression) / 3.0 * ONE,
        })
    }

    /// √(q²/M² + (p − p_c/2)²) − p_c/2, which is 0 where (1) is.
    fn yield_indicator(&self, stress: &Vector4<f64>, history: &[f64]) -> f64 {
        let ([p, q], half) = (invariants(stress), 0.5 * P_C.value(history));
        (q / self.critical).hypot(p - half) - half
    }

    fn show(&self, stress: &Vector4<f64>, history: &[f64], values: &mut [f64]) {
        let [p, q] = invariants(stress);
        values.copy_from_slice(&[p, q, P_C.value(history)]);
    }
}
