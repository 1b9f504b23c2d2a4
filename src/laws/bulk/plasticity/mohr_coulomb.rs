use std::borrow::Cow;

use nalgebra::{Matrix3, Matrix4, Vector3, Vector4};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::drucker_prager::{FLOOR, check_strength};
use super::{Elasticity, Elastoplastic, ROUND_OFF, ReturnDescription, ReturnMap, Returned, VOLUME, in_axes, within};
use crate::laws::bulk::{Answer, CauchyStress, ElasticConstants, Flow, InadmissibleStress, Lame, MaterialFailure};
use crate::laws::parameter::{InvalidParameter, require, require_not_negative, require_positive};
use crate::laws::text::{at_least, number};

/// Constants of [`MohrCoulomb`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct MohrCoulombParameters {
    /// E: Young's modulus, E > 0 [F/L²]
    #[serde(rename = "E")]
    pub young: f64,
    /// ν: Poisson's ratio, −1 < ν < 0.5 [-]
    #[serde(rename = "nu")]
    pub poisson: f64,
    /// ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
    #[serde(default)]
    pub density: f64,
    /// c: cohesion, c ≥ 0, above 0 where phi is 0 (Tresca, c = s_u) [F/L²]
    pub c: f64,
    /// φ: angle of friction, 0 ≤ φ < 90 [degrees]
    pub phi: f64,
    /// ψ: angle of dilation, 0 ≤ ψ ≤ φ [degrees]
    pub psi: f64,
    /// Largest principal stress, tension positive; that of the tip, c cot φ, unless given [F/L²]
    pub tension: Option<f64>,
    /// How it softens; c, phi and psi stay as they are unless given
    pub softening: Option<Softening>,
    /// τ_v: relaxation time of the viscosity by Duvaut and Lions, τ_v ≥ 0; 0 for none [T]
    #[serde(default)]
    pub viscosity: f64,
}

/// Softening: c, φ and ψ fall linearly with the plastic shear strain to what is left of them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Softening {
    /// c that is left, 0 to c [F/L²]
    pub c: f64,
    /// φ that is left, 0 to phi [degrees]
    pub phi: f64,
    /// ψ that is left, 0 to the smaller of psi and the phi that is left [degrees]
    pub psi: f64,
    /// Plastic shear strain γ_p = ∫ Σ |dε_p,i| at which nothing else is left, above 0 [-]
    pub strain: f64,
}

impl MohrCoulombParameters {
    /// Creates the law with constant c, φ and ψ, of a body without mass.
    pub fn new(young: f64, poisson: f64, [c, phi, psi]: [f64; 3]) -> Self {
        Self { young, poisson, density: 0.0, c, phi, psi, tension: None, softening: None, viscosity: 0.0 }
    }
}

/// Mohr and Coulomb's law: soil and rock. Tresca's where φ = 0.
///
/// ```text
/// f_ij = ½ ((1 + sin φ) τ_i − (1 − sin φ) τ_j) − c cos φ ≤ 0      (i, j) = (1,3), (2,3), (1,2), τ₁ ≥ τ₂ ≥ τ₃     (1)
/// τ_i ≤ f_t                                                       tension cut-off                                  (2)
/// dε_p = Σ dγ_ij ½ ((1 + sin ψ) e_i − (1 − sin ψ) e_j) + Σ dγ_i e_i                                               (3)
/// c, φ, ψ fall linearly with γ_p = ∫ Σ |dε_p,i|                   softening                                        (4)
/// ```
/// Planes and linear elasticity make the return a projection onto those that are active, exact in one step:
/// ```text
/// Δγ = (A C B)⁻¹ (A τ_tr − k) ≥ 0,   τ = τ_tr − C B Δγ,   D = C − C B (A C B)⁻¹ A C                               (5)
/// ```
/// A are the planes' normals, B their directions of flow. The sets of one, two and three planes are tried in this order; the first one
/// whose stress is on or within all planes, in its order, and whose multipliers are not negative is the answer. If there is none, it is the
/// tip, τ = min(c cot φ, f_t) 1, with a ten-millionth of the elastic stiffness in the tangent. γ_p is the
/// plastic shear strain where planes of shear are active, and tension softens as well; with it there is one scalar equation more, for γ_p
/// at the end.
///
/// # Errors
/// [`MaterialFailure::NotConverged`] when there is no such set and no tip, or γ_p is not found: it softens faster than it unloads.
///
/// Source: de Souza Neto, Perić & Owen (2008), Computational Methods for Plasticity, §8.2; Koiter (1953), Q. Appl. Math. 11, 350 (corners).
#[derive(Clone, Debug, PartialEq)]
pub struct MohrCoulomb {
    elastic: Lame,
    virgin: Strength,
    /// The sets of planes of a constant strength, `None` where they do not meet; empty if it softens
    ready: Vec<Option<Planes>>,
    /// Residual strength, and γ_p at which it is reached
    residual: Option<(Strength, f64)>,
    tension: Option<f64>,
}

/// c, φ and ψ.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Strength {
    c: f64,
    phi: Angle,
    psi: Angle,
}

/// An angle, its sine and its cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Angle {
    /// [rad]
    value: f64,
    sin: f64,
    cos: f64,
}

/// Rates of c, φ and ψ with γ_p.
#[derive(Clone, Copy, Debug, Default)]
struct Rates {
    c: f64,
    phi: f64,
    psi: f64,
}

impl Angle {
    fn new(value: f64) -> Self {
        let (sin, cos) = value.sin_cos();
        Self { value, sin, cos }
    }
}

impl Strength {
    fn new(c: f64, phi: f64, psi: f64) -> Self {
        Self { c, phi: Angle::new(phi.to_radians()), psi: Angle::new(psi.to_radians()) }
    }

    /// Returns the strength at a share of the way to another one, and its rates along it.
    fn towards(&self, other: &Self, share: f64) -> (Self, Rates) {
        let [phi, psi] = [other.phi.value - self.phi.value, other.psi.value - self.psi.value];
        let rates = Rates { c: other.c - self.c, phi, psi };
        let at = Self {
            c: self.c + share * rates.c,
            phi: Angle::new(self.phi.value + share * phi),
            psi: Angle::new(self.psi.value + share * psi),
        };
        (at, rates)
    }

    /// c cot φ
    fn tip(&self) -> f64 {
        if self.phi.value > 0.0 { self.c * self.phi.cos / self.phi.sin } else { f64::INFINITY }
    }

    /// Normal and flow of a plane.
    fn plane(&self, number: usize) -> [Vector3<f64>; 2] {
        match PAIRS.get(number) {
            Some(&(i, j)) => [self.phi.sin, self.psi.sin].map(|s| sheared(i, j, s)),
            None => [Vector3::ith(number - PAIRS.len(), 1.0); 2],
        }
    }
}

/// ½ ((1 + s) e_i − (1 − s) e_j)
fn sheared(i: usize, j: usize, s: f64) -> Vector3<f64> {
    let mut plane = Vector3::zeros();
    (plane[i], plane[j]) = (0.5 * (1.0 + s), -0.5 * (1.0 - s));
    plane
}

/// The planes of shear by their largest and smallest principal stress; the three of tension follow.
const PAIRS: [(usize, usize); 3] = [(0, 2), (1, 2), (0, 1)];

/// Sets of planes that may be active, those of shear alone before those with tension.
const SETS: [&[usize]; 20] = [
    &[0],
    &[0, 1],
    &[0, 2],
    &[3],
    &[0, 3],
    &[1, 3],
    &[2, 3],
    &[3, 4],
    &[0, 4],
    &[1, 4],
    &[0, 1, 3],
    &[0, 2, 3],
    &[1, 2, 3],
    &[0, 3, 4],
    &[1, 3, 4],
    &[0, 1, 4],
    &[0, 2, 4],
    &[1, 2, 4],
    &[2, 3, 4],
    &[3, 4, 5],
];

/// Number of sets of shear alone.
const SHEAR: usize = 3;

/// Share of the trial stress that round-off may leave.
const ROUNDED: f64 = 1e-12;

/// Most iterations for γ_p.
const ITERATIONS: usize = 80;

/// γ_p is known to so much.
const KNOWN: f64 = 1e-14;

/// A return to some planes, of sorted principal stresses.
#[derive(Clone, Copy, Debug)]
struct OnPlanes {
    stress: Vector3<f64>,
    /// Number of the set; without one it is a return to the tip
    set: Option<usize>,
    /// Δγ of each plane
    multipliers: Vector3<f64>,
}

impl MohrCoulomb {
    /// The law at large deformations.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a constant is out of its range.
    pub fn new(given: &MohrCoulombParameters) -> Result<Elastoplastic<Self>, InvalidParameter> {
        let MohrCoulombParameters { young, poisson, density, c, phi, psi, tension, softening, viscosity } = *given;
        let elastic = ElasticConstants { young, poisson, density }.lame()?;
        check_strength(c, phi, psi)?;
        if let Some(tension) = tension {
            require_not_negative("tension", tension)?;
        }
        if let Some(left) = softening {
            require_positive("softening.strain", left.strain)?;
            require("softening.c", left.c, (0.0..=c).contains(&left.c), "it must be between 0 and c")?;
            require("softening.phi", left.phi, (0.0..=phi).contains(&left.phi), "it must be between 0 and phi")?;
            let most = psi.min(left.phi);
            let allowed = "it must be between 0 and the smaller of psi and softening.phi";
            require("softening.psi", left.psi, (0.0..=most).contains(&left.psi), allowed)?;
            let some = "it must be positive where softening.phi is 0: some strength is left";
            require("softening.c", left.c, left.c > 0.0 || left.phi > 0.0, some)?;
            let slowest = (c - left.c) / elastic.shear;
            let snap = format!(
                "it must be greater than (c - softening.c)/G = {slowest:.3e}: the material would snap back by itself"
            );
            require("softening.strain", left.strain, left.strain > slowest, snap)?;
        }
        let residual = softening.map(|left| (Strength::new(left.c, left.phi, left.psi), left.strain));
        let mut law = Self { elastic, virgin: Strength::new(c, phi, psi), ready: Vec::new(), residual, tension };
        if law.residual.is_none() {
            law.ready = SETS.iter().map(|numbers| Planes::of(&law, &law.virgin, numbers)).collect();
        }
        Elastoplastic::new(law, density, viscosity)
    }

    /// c, φ and ψ at a plastic shear strain, and how they change with it.
    #[inline(always)]
    fn strength(&self, slip: f64) -> (Strength, Rates) {
        match &self.residual {
            None => (self.virgin, Rates::default()),
            Some((residual, strain)) if slip >= *strain => (*residual, Rates::default()),
            Some((residual, strain)) => {
                let (at, rate) = self.virgin.towards(residual, slip / strain);
                (at, Rates { c: rate.c / strain, phi: rate.phi / strain, psi: rate.psi / strain })
            }
        }
    }

    /// Largest principal stress.
    fn highest(&self, strength: &Strength) -> f64 {
        strength.tip().min(self.tension.unwrap_or(f64::INFINITY))
    }

    /// The tension cut-off, if it cuts something off.
    #[inline(always)]
    fn cut_off(&self, strength: &Strength) -> Option<f64> {
        self.tension.filter(|tension| *tension < strength.tip())
    }

    /// f of sorted principal stresses: the largest of all planes.
    #[inline(always)]
    fn excess(&self, strength: &Strength, sorted: &Vector3<f64>) -> f64 {
        let Angle { sin, cos, .. } = strength.phi;
        let shear = 0.5 * ((1.0 + sin) * sorted[0] - (1.0 - sin) * sorted[2]) - strength.c * cos;
        self.cut_off(strength).map_or(shear, |tension| shear.max(sorted[0] - tension))
    }

    /// Strength of a plane.
    fn limit(&self, strength: &Strength, plane: usize) -> f64 {
        match plane < PAIRS.len() {
            true => strength.c * strength.phi.cos,
            false => self.tension.unwrap_or(f64::INFINITY),
        }
    }

    /// The return (5) at a strength.
    #[inline(always)]
    fn at_strength(&self, strength: &Strength, trial: &Vector3<f64>) -> Option<OnPlanes> {
        let rounded = ROUNDED * (trial.amax() + strength.c);
        let within = |stress: &Vector3<f64>| {
            stress[0] >= stress[1] - rounded
                && stress[1] >= stress[2] - rounded
                && self.excess(strength, stress) <= rounded
        };
        let sets = if self.cut_off(strength).is_some() { SETS.len() } else { SHEAR };
        for set in 0..sets {
            let Some(found) = self.projected(strength, trial, set) else { continue };
            if found.multipliers.min() >= -rounded / self.elastic.shear && within(&found.stress) {
                return Some(found);
            }
        }
        let highest = self.highest(strength);
        let tip = OnPlanes { stress: Vector3::repeat(highest), set: None, multipliers: Vector3::zeros() };
        highest.is_finite().then_some(tip)
    }

    /// What (5) needs of a set of planes; none where they do not meet in a point, a line or a plane.
    #[inline(always)]
    fn planes(&self, strength: &Strength, set: usize) -> Option<Cow<'_, Planes>> {
        match self.ready.get(set) {
            Some(ready) => ready.as_ref().map(Cow::Borrowed),
            None => Planes::of(self, strength, SETS[set]).map(Cow::Owned),
        }
    }

    /// C⁻¹ v of principal values.
    #[inline(always)]
    fn strain(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let Lame { lambda, shear } = self.elastic;
        v.add_scalar(-lambda / (3.0 * lambda + 2.0 * shear) * v.sum()) / (2.0 * shear)
    }

    /// (5) on a set of planes, if they meet.
    #[inline(always)]
    fn projected(&self, strength: &Strength, trial: &Vector3<f64>, set: usize) -> Option<OnPlanes> {
        let planes = self.planes(strength, set)?;
        let multipliers = planes.inverse * (planes.normals.tr_mul(trial) - planes.limits);
        Some(OnPlanes { stress: trial - planes.stiff_flows * multipliers, set: Some(set), multipliers })
    }

    /// C of principal values.
    fn stiffness(&self) -> Matrix3<f64> {
        Matrix3::repeat(self.elastic.lambda) + Matrix3::from_diagonal_element(2.0 * self.elastic.shear)
    }

    /// D of (5), of a return at constant strength.
    #[inline(always)]
    fn tangent(&self, strength: &Strength, found: &OnPlanes) -> Matrix3<f64> {
        let planes = found.set.and_then(|set| self.planes(strength, set));
        planes.map_or_else(|| FLOOR * self.stiffness(), |planes| planes.moduli)
    }

    /// ∂τ/∂γ_p of a return at constant trial stress, by the rates of c, φ and ψ.
    fn softened(&self, strength: &Strength, rate: &Rates, found: &OnPlanes) -> Vector3<f64> {
        let Angle { sin, cos, .. } = strength.phi;
        let Some(planes) = found.set.and_then(|set| self.planes(strength, set)) else {
            let is_tip = self.cut_off(strength).is_none() && sin > 0.0;
            let tip = if is_tip { rate.c * cos / sin - strength.c * rate.phi / (sin * sin) } else { 0.0 };
            return Vector3::repeat(tip);
        };
        let (mut turned, mut over) = (Vector3::zeros(), Vector3::zeros());
        for (k, &plane) in planes.numbers.iter().enumerate().filter(|(_, plane)| **plane < PAIRS.len()) {
            let (i, j) = PAIRS[plane];
            for axis in [i, j] {
                turned[axis] += 0.5 * strength.psi.cos * rate.psi * found.multipliers[k];
            }
            let mean = 0.5 * (found.stress[i] + found.stress[j]);
            over[k] = cos * rate.phi * mean - rate.c * cos + strength.c * sin * rate.phi;
        }
        let stiffened = self.stiffness() * turned;
        over -= planes.normals.tr_mul(&stiffened);
        -stiffened - planes.stiff_flows * (planes.inverse * over)
    }

    /// The return with γ_p at the end of the increment, its tangent, and γ_p.
    #[inline(always)]
    fn sorted(&self, trial: &Vector3<f64>, before: f64) -> Answer<(Vector3<f64>, Matrix3<f64>, f64)> {
        if self.residual.is_some_and(|(_, strain)| before < strain) {
            return self.softening(trial, before);
        }
        let (strength, _) = self.strength(before);
        let found = self.at_strength(&strength, trial).ok_or_else(|| self.none(trial, before))?;
        Ok((found.stress, self.tangent(&strength, &found), before + self.slip(trial, &found)))
    }

    /// Σ |Δε_p,i| of a return.
    #[inline(always)]
    fn slip(&self, trial: &Vector3<f64>, found: &OnPlanes) -> f64 {
        self.strain(&(trial - found.stress)).abs().sum()
    }

    /// There is no return.
    #[cold]
    fn none(&self, trial: &Vector3<f64>, before: f64) -> MaterialFailure {
        let residual = self.excess(&self.strength(before).0, trial) / trial.amax();
        MaterialFailure::NotConverged { law: NAME, residual }
    }

    /// That of a strength that falls with γ_p: γ_p,n + Σ |Δε_p,i(γ_p)| − γ_p has its root between γ_p,n, where it is positive, and where
    /// it is not.
    fn softening(&self, trial: &Vector3<f64>, before: f64) -> Answer<(Vector3<f64>, Matrix3<f64>, f64)> {
        let at = |slip: f64| {
            let found = self.at_strength(&self.strength(slip).0, trial).ok_or_else(|| self.none(trial, before))?;
            Ok((found, before + self.slip(trial, &found) - slip))
        };
        let [mut low, mut high] = [before, before + self.strain(trial).abs().sum()];
        while at(high)?.1 > 0.0 {
            (low, high) = (high, 2.0 * high);
        }
        let mut now = low;
        for _ in 0..ITERATIONS {
            let (found, rest) = at(now)?;
            let (strength, rate) = self.strength(now);
            let by_slip = self.softened(&strength, &rate, &found);
            let signs = self.strain(&(trial - found.stress)).map(f64::signum);
            let slope = -signs.dot(&self.strain(&by_slip)) - 1.0;
            if rest.abs() <= KNOWN {
                let mut tangent = self.tangent(&strength, &found);
                let of_strain = signs - tangent.transpose() * self.strain(&signs);
                tangent -= by_slip * of_strain.transpose() / slope;
                return Ok((found.stress, tangent, now));
            }
            if rest > 0.0 {
                low = now
            } else {
                high = now
            }
            let next = now - rest / slope;
            now = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        Err(self.none(trial, before))
    }
}

/// Some planes, at most three, and what (5) needs of them.
#[derive(Clone, Debug, Default, PartialEq)]
struct Planes {
    numbers: &'static [usize],
    /// Aᵀ: a column a plane, 0 beyond them
    normals: Matrix3<f64>,
    /// k
    limits: Vector3<f64>,
    /// C B, 0 beyond the planes
    stiff_flows: Matrix3<f64>,
    /// (A C B)⁻¹, 1 beyond the planes
    inverse: Matrix3<f64>,
    /// D
    moduli: Matrix3<f64>,
}

impl Planes {
    fn of(law: &MohrCoulomb, strength: &Strength, numbers: &'static [usize]) -> Option<Self> {
        let (stiffness, count) = (law.stiffness(), numbers.len());
        let mut planes = Self { numbers, ..Self::default() };
        for (k, &number) in numbers.iter().enumerate() {
            let [normal, flow] = strength.plane(number);
            planes.normals.set_column(k, &normal);
            planes.stiff_flows.set_column(k, &(stiffness * flow));
            planes.limits[k] = law.limit(strength, number);
        }
        let mut products = planes.normals.tr_mul(&planes.stiff_flows);
        (count..3).for_each(|k| products[(k, k)] = 1.0);
        let scale: f64 = products.column_iter().map(|column| column.norm()).product();
        if products.determinant().abs() <= ROUNDED * scale {
            return None;
        }
        planes.inverse = products.try_inverse()?;
        planes.moduli = stiffness - planes.stiff_flows * planes.inverse * planes.normals.transpose() * stiffness;
        Some(planes)
    }
}

impl ReturnMap for MohrCoulomb {
    #[inline(always)]
    fn description(&self) -> ReturnDescription<'_> {
        let softens = self.residual.is_some();
        let is_associated = self.virgin.phi == self.virgin.psi;
        ReturnDescription {
            history: if softens { &SOFTENING[..] } else { &[] },
            flow: if self.virgin.psi.value > 0.0 { Flow::Dilating } else { Flow::Isochoric },
            is_associated: is_associated && !softens,
            localizes: match (softens, is_associated) {
                (true, _) => Some("softens"),
                (false, false) => Some("flows otherwise than it yields (psi < phi)"),
                (false, true) => None,
            },
            strength: Some([self.virgin.c, self.virgin.phi.sin / self.virgin.phi.cos]),
            ..ReturnDescription::new(NAME)
        }
    }

    #[inline(always)]
    fn elasticity(&self, _: &[f64]) -> Elasticity {
        Elasticity::Linear(self.elastic)
    }

    fn begin(&self, stress: &CauchyStress, history: &mut [f64]) -> Result<(), InadmissibleStress> {
        within(self, stress, history, || {
            let sorted = principal(&Vector4::from(stress.components()));
            let ([high, low], Angle { sin, value, .. }) = ([sorted[0], sorted[2]].map(number), self.virgin.phi);
            let (phi, ratio) = ((value.to_degrees() * 1e9).round() / 1e9, at_least((1.0 - sin) / (1.0 + sin)));
            format!(
                "its principal stresses reach from {low} to {high}; with phi = {phi} degrees and c = {} a ratio of pressures such \
                 as K0 is at least (1 - sin phi)/(1 + sin phi) = {ratio}, somewhat less for the cohesion; raise K0, c or phi",
                self.virgin.c
            )
        })
    }

    #[inline(always)]
    fn returned(&self, trial: &Vector3<f64>, _: &Vector4<f64>, history: &mut [f64]) -> Answer<Returned> {
        let mut answer = Returned::elastic(self.elastic, trial);
        let rank = rank_across(trial);
        let sorted = Vector3::from(sorted(rank, [answer.stress[0], answer.stress[1], answer.stress[2]]));
        let before = slipped(history);
        if self.excess(&self.strength(before).0, &sorted) <= ROUND_OFF * self.elastic.shear {
            return Ok(answer);
        }
        let (stress, moduli, slip) = self.sorted(&sorted, before)?;
        let [x, y, z] = unsorted(rank, stress.into());
        answer.stress = Vector4::new(x, y, z, 0.0);
        let columns = unsorted(rank, [0, 1, 2].map(|column| unsorted(rank, moduli.column(column).into_owned().into())));
        let mut tangent = Matrix4::zeros();
        tangent.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::from(columns));
        // The axes of τ are those of the strains.
        let difference = trial.x - trial.y;
        tangent[(3, 3)] = match difference.abs() <= EQUAL {
            true => 0.5 * (tangent[(0, 0)] - tangent[(1, 0)] + tangent[(1, 1)] - tangent[(0, 1)]),
            false => (answer.stress[0] - answer.stress[1]) / difference,
        };
        answer.tangent = tangent;
        answer.plastic = in_axes(trial) - self.elastic.strain(&answer.stress);
        VOLUME.behind_mut(history).fill(slip);
        Ok(answer)
    }

    #[inline(always)]
    fn yield_indicator(&self, stress: &Vector4<f64>, history: &[f64]) -> f64 {
        let (strength, _) = self.strength(slipped(history));
        self.excess(&strength, &principal(stress))
    }
}

/// Name of γ_p, which a law that softens alone has in its history.
const SOFTENING: [&str; 1] = ["plastic_shear_strain"];

/// γ_p of a history.
#[inline(always)]
fn slipped(history: &[f64]) -> f64 {
    VOLUME.behind(history).first().copied().unwrap_or(0.0)
}

/// Name of the law in a case.
const NAME: &str = "mohr_coulomb";

/// Difference of two strains below which their axes are any.
const EQUAL: f64 = 1e-10;

/// Principal values of a tensor, sorted.
#[inline(always)]
fn principal(stress: &Vector4<f64>) -> Vector3<f64> {
    let [xx, yy, zz, xy]: [f64; 4] = (*stress).into();
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let radius = (half * half + xy * xy).sqrt();
    let values = Vector3::new(mean + radius, mean - radius, zz);
    Vector3::from(sorted(rank_across(&values), values.into()))
}

/// Place of the principal value across the plane among all, the largest first; those in plane are in order.
#[inline(always)]
fn rank_across(values: &Vector3<f64>) -> usize {
    usize::from(values[2] <= values[0]) + usize::from(values[2] <= values[1])
}

/// What belongs to the axes, the largest first.
#[inline(always)]
fn sorted<T: Copy>(rank: usize, [x, y, z]: [T; 3]) -> [T; 3] {
    match rank {
        0 => [z, x, y],
        1 => [x, z, y],
        _ => [x, y, z],
    }
}

/// What belongs to the axes, from the largest first.
#[inline(always)]
fn unsorted<T: Copy>(rank: usize, [a, b, c]: [T; 3]) -> [T; 3] {
    match rank {
        0 => [b, c, a],
        1 => [a, c, b],
        _ => [a, b, c],
    }
}
