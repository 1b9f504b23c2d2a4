use nalgebra::{Matrix3, Matrix4, Vector3, Vector4};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::drucker_prager::{FLOOR, check_strength};
use super::{Elastoplastic, ROUND_OFF, ReturnMap, Returned, in_axes};
use crate::laws::bulk::{CauchyStress, ElasticConstants, Flow, Lame, MaterialFailure};
use crate::laws::parameter::{InvalidParameter, require, require_not_negative, require_positive};

/// Constants of [`MohrCoulomb`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MohrCoulomb {
    elastic: Lame,
    virgin: Strength,
    /// Residual strength, and γ_p at which it is reached
    residual: Option<(Strength, f64)>,
    tension: Option<f64>,
}

/// c, φ and ψ.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Strength {
    c: f64,
    /// [rad]
    phi: f64,
    /// [rad]
    psi: f64,
}

impl Strength {
    fn new(c: f64, phi: f64, psi: f64) -> Self {
        Self { c, phi: phi.to_radians(), psi: psi.to_radians() }
    }

    /// Returns the strength at a share of the way to another one, and its rate along it.
    fn towards(self, other: Self, share: f64) -> (Self, Self) {
        let rate = Self { c: other.c - self.c, phi: other.phi - self.phi, psi: other.psi - self.psi };
        let at =
            Self { c: self.c + share * rate.c, phi: self.phi + share * rate.phi, psi: self.psi + share * rate.psi };
        (at, rate)
    }

    /// c cot φ
    fn tip(&self) -> f64 {
        if self.phi > 0.0 { self.c / self.phi.tan() } else { f64::INFINITY }
    }

    /// Normal, flow and strength of a plane.
    fn plane(&self, number: usize) -> (Vector3<f64>, Vector3<f64>) {
        match PAIRS.get(number) {
            Some(&(i, j)) => (sheared(i, j, self.phi.sin()), sheared(i, j, self.psi.sin())),
            None => (Vector3::ith(number - PAIRS.len(), 1.0), Vector3::ith(number - PAIRS.len(), 1.0)),
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
const SHEAR: [&[usize]; 3] = [&[0], &[0, 1], &[0, 2]];
const TENSION: [&[usize]; 17] = [
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
    tangent: Matrix3<f64>,
    planes: &'static [usize],
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
        let law = Self { elastic, virgin: Strength::new(c, phi, psi), residual, tension };
        Elastoplastic::new(law, density, viscosity)
    }

    /// c, φ and ψ at a plastic shear strain, and how they change with it.
    fn strength(&self, slip: f64) -> (Strength, Strength) {
        let still = Strength { c: 0.0, phi: 0.0, psi: 0.0 };
        match self.residual {
            None => (self.virgin, still),
            Some((residual, strain)) if slip >= strain => (residual, still),
            Some((residual, strain)) => {
                let (at, rate) = self.virgin.towards(residual, slip / strain);
                (at, Strength { c: rate.c / strain, phi: rate.phi / strain, psi: rate.psi / strain })
            }
        }
    }

    /// Largest principal stress.
    fn highest(&self, strength: &Strength) -> f64 {
        strength.tip().min(self.tension.unwrap_or(f64::INFINITY))
    }

    /// The tension cut-off, if it cuts something off.
    fn cut_off(&self, strength: &Strength) -> Option<f64> {
        self.tension.filter(|tension| *tension < strength.tip())
    }

    /// f of sorted principal stresses: the largest of all planes.
    fn excess(&self, strength: &Strength, sorted: &Vector3<f64>) -> f64 {
        let shear = sheared(0, 2, strength.phi.sin()).dot(sorted) - strength.c * strength.phi.cos();
        self.cut_off(strength).map_or(shear, |tension| shear.max(sorted[0] - tension))
    }

    /// Strength of a plane.
    fn limit(&self, strength: &Strength, plane: usize) -> f64 {
        match plane < PAIRS.len() {
            true => strength.c * strength.phi.cos(),
            false => self.tension.unwrap_or(f64::INFINITY),
        }
    }

    /// The return (5) at a strength.
    fn at_strength(&self, strength: &Strength, trial: &Vector3<f64>) -> Option<OnPlanes> {
        let stiffness = self.stiffness();
        let rounded = ROUNDED * (trial.amax() + strength.c);
        let within = |stress: &Vector3<f64>| {
            stress[0] >= stress[1] - rounded
                && stress[1] >= stress[2] - rounded
                && self.excess(strength, stress) <= rounded
        };
        let tension: &[&'static [usize]] = if self.cut_off(strength).is_some() { &TENSION } else { &[] };
        for &planes in SHEAR.iter().chain(tension) {
            let Some(found) = self.projected(strength, trial, planes, &stiffness) else { continue };
            if found.multipliers.min() >= -rounded / self.elastic.shear && within(&found.stress) {
                return Some(found);
            }
        }
        let highest = self.highest(strength);
        highest.is_finite().then(|| OnPlanes {
            stress: Vector3::repeat(highest),
            tangent: FLOOR * stiffness,
            planes: &[],
            multipliers: Vector3::zeros(),
        })
    }

    /// C of principal stresses.
    fn stiffness(&self) -> Matrix3<f64> {
        Matrix3::repeat(self.elastic.lambda) + Matrix3::from_diagonal_element(2.0 * self.elastic.shear)
    }

    /// (5) on some planes; none where they do not meet in a point, a line or a plane.
    fn projected(
        &self,
        strength: &Strength,
        trial: &Vector3<f64>,
        planes: &'static [usize],
        stiffness: &Matrix3<f64>,
    ) -> Option<OnPlanes> {
        let system = System::of(strength, planes, stiffness);
        let inverse = system.inverse()?;
        let mut over = Vector3::zeros();
        for (k, &plane) in planes.iter().enumerate() {
            over[k] = system.normals.column(k).dot(trial) - self.limit(strength, plane);
        }
        let multipliers = inverse * over;
        let stress = trial - stiffness * system.flows * multipliers;
        let tangent = stiffness - stiffness * system.flows * inverse * system.normals.transpose() * stiffness;
        Some(OnPlanes { stress, tangent, planes, multipliers })
    }

    /// ∂τ/∂γ_p of a return at constant trial stress, by the rates of c, φ and ψ.
    fn softened(&self, (strength, rate): (&Strength, &Strength), found: &OnPlanes) -> Vector3<f64> {
        let (sin, cos) = strength.phi.sin_cos();
        if found.planes.is_empty() {
            let is_tip = self.cut_off(strength).is_none() && sin > 0.0;
            let tip = if is_tip { rate.c * cos / sin - strength.c * rate.phi / (sin * sin) } else { 0.0 };
            return Vector3::repeat(tip);
        }
        let stiffness = self.stiffness();
        let system = System::of(strength, found.planes, &stiffness);
        let Some(inverse) = system.inverse() else { return Vector3::zeros() };
        let (mut varied, mut over) = (Matrix3::zeros(), Vector3::zeros());
        for (k, &plane) in found.planes.iter().enumerate().filter(|(_, plane)| **plane < PAIRS.len()) {
            let (i, j) = PAIRS[plane];
            let by = |rate: f64| {
                let mut by = Vector3::zeros();
                (by[i], by[j]) = (0.5 * rate, 0.5 * rate);
                by
            };
            varied.set_column(k, &by(strength.psi.cos() * rate.psi));
            over[k] = by(cos * rate.phi).dot(&found.stress) - rate.c * cos + strength.c * sin * rate.phi;
        }
        let turned = varied * found.multipliers;
        let multipliers = inverse * (over - system.normals.transpose() * stiffness * turned);
        -stiffness * (turned + system.flows * multipliers)
    }

    /// The return with γ_p at the end of the increment, and that.
    fn sorted(&self, trial: &Vector3<f64>, before: f64) -> Result<(OnPlanes, f64), MaterialFailure> {
        let none = || MaterialFailure::NotConverged {
            law: self.name(),
            residual: self.excess(&self.strength(before).0, trial) / trial.amax(),
        };
        let compliance = self.stiffness().try_inverse().ok_or_else(none)?;
        let at = |slip: f64| {
            let found = self.at_strength(&self.strength(slip).0, trial).ok_or_else(none)?;
            let plastic = compliance * (trial - found.stress);
            Ok((found, plastic, before + plastic.abs().sum() - slip))
        };
        if self.residual.is_none_or(|(_, strain)| before >= strain) {
            let (found, _, slip) = at(before)?;
            return Ok((found, before + slip));
        }
        // γ_p,n + Σ |Δε_p,i(γ_p)| − γ_p has its root between γ_p,n, where it is positive, and where it is not
        let [mut low, mut high] = [before, before + (compliance * trial).abs().sum()];
        while at(high)?.2 > 0.0 {
            (low, high) = (high, 2.0 * high);
        }
        let mut now = low;
        for _ in 0..ITERATIONS {
            let (mut found, plastic, rest) = at(now)?;
            let (strength, rate) = self.strength(now);
            let by_slip = self.softened((&strength, &rate), &found);
            let signs = plastic.map(f64::signum);
            let slope = -signs.dot(&(compliance * by_slip)) - 1.0;
            if rest.abs() <= KNOWN {
                let of_strain = signs - found.tangent.transpose() * compliance * signs;
                found.tangent -= by_slip * of_strain.transpose() / slope;
                return Ok((found, now));
            }
            if rest > 0.0 {
                low = now
            } else {
                high = now
            }
            let next = now - rest / slope;
            now = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        Err(none())
    }
}

/// A, B and A C B of some planes, filled up to three.
struct System {
    /// Normals in columns
    normals: Matrix3<f64>,
    /// Flows in columns
    flows: Matrix3<f64>,
    product: Matrix3<f64>,
}

impl System {
    fn of(strength: &Strength, planes: &[usize], stiffness: &Matrix3<f64>) -> Self {
        let (mut normals, mut flows) = (Matrix3::zeros(), Matrix3::zeros());
        for (k, &plane) in planes.iter().enumerate() {
            let (normal, flow) = strength.plane(plane);
            normals.set_column(k, &normal);
            flows.set_column(k, &flow);
        }
        let mut product = normals.transpose() * stiffness * flows;
        for k in planes.len()..3 {
            product[(k, k)] = 1.0;
        }
        Self { normals, flows, product }
    }

    fn inverse(&self) -> Option<Matrix3<f64>> {
        let scale: f64 = self.product.column_iter().map(|column| column.norm()).product();
        if self.product.determinant().abs() <= ROUNDED * scale { None } else { self.product.try_inverse() }
    }
}

impl ReturnMap for MohrCoulomb {
    fn name(&self) -> &'static str {
        "mohr_coulomb"
    }

    fn elastic(&self) -> Lame {
        self.elastic
    }

    fn history(&self) -> &[&'static str] {
        if self.residual.is_some() { &["plastic_shear_strain"] } else { &[] }
    }

    fn returned(&self, trial: &Vector3<f64>, history: &mut [f64]) -> Result<Returned, MaterialFailure> {
        let mut answer = Returned::elastic(self.elastic, trial);
        if self.yield_indicator(&answer.stress, history) <= ROUND_OFF * self.elastic.shear {
            return Ok(answer);
        }
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| trial[j].total_cmp(&trial[i]));
        let sorted = Vector3::from(order.map(|i| answer.stress[i]));
        let (found, slip) = self.sorted(&sorted, history.get(OWN).copied().unwrap_or(0.0))?;
        let mut tangent = Matrix4::zeros();
        for (a, &i) in order.iter().enumerate() {
            answer.stress[i] = found.stress[a];
            for (b, &j) in order.iter().enumerate() {
                tangent[(i, j)] = found.tangent[(a, b)];
            }
        }
        // The axes of τ are those of the strains.
        let difference = trial.x - trial.y;
        tangent[(3, 3)] = match difference.abs() <= EQUAL {
            true => 0.5 * (tangent[(0, 0)] - tangent[(1, 0)] + tangent[(1, 1)] - tangent[(0, 1)]),
            false => (answer.stress[0] - answer.stress[1]) / difference,
        };
        answer.tangent = tangent;
        answer.plastic = in_axes(trial) - self.elastic.strain(&answer.stress);
        if let Some(own) = history.get_mut(OWN) {
            *own = slip;
        }
        Ok(answer)
    }

    fn yield_indicator(&self, stress: &Vector4<f64>, history: &[f64]) -> f64 {
        let (strength, _) = self.strength(history.get(OWN).copied().unwrap_or(0.0));
        self.excess(&strength, &principal(stress))
    }

    fn flow(&self) -> Flow {
        if self.virgin.psi > 0.0 { Flow::Dilating } else { Flow::Isochoric }
    }

    fn is_associated(&self) -> bool {
        self.virgin.phi == self.virgin.psi && self.residual.is_none()
    }

    fn localizes(&self) -> Option<&'static str> {
        match (self.residual, self.virgin.phi == self.virgin.psi) {
            (Some(_), _) => Some("softens"),
            (None, false) => Some("flows otherwise than it yields (psi < phi)"),
            (None, true) => None,
        }
    }

    fn beyond(&self, stress: &CauchyStress) -> String {
        let CauchyStress { xx, yy, zz, xy } = *stress;
        let sorted = principal(&Vector4::new(xx, yy, zz, xy));
        let sin = self.virgin.phi.sin();
        format!(
            "its principal stresses reach from {:.6} to {:.6}; with phi = {} degrees and c = {} a ratio of pressures such as K0 is at \
             least (1 - sin phi)/(1 + sin phi) = {:.4}, somewhat less for the cohesion; raise K0, c or phi",
            sorted[2],
            sorted[0],
            (self.virgin.phi.to_degrees() * 1e9).round() / 1e9,
            self.virgin.c,
            (1.0 - sin) / (1.0 + sin)
        )
    }
}

/// Place of γ_p in the history.
const OWN: usize = 2;

/// Difference of two strains below which their axes are any.
const EQUAL: f64 = 1e-10;

/// Principal values of a tensor, sorted.
fn principal(stress: &Vector4<f64>) -> Vector3<f64> {
    let [xx, yy, zz, xy]: [f64; 4] = (*stress).into();
    let (mean, radius) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    let mut values = [mean + radius, mean - radius, zz];
    values.sort_by(|a, b| b.total_cmp(a));
    values.into()
}
