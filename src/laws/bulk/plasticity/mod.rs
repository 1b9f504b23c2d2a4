//! Bodies that yield: multiplicative plasticity by logarithmic strains.
//!
//! | law | yields where |
//! |---|---|
//! | [`VonMises`] | √(3/2) ‖s − α‖ = Y(ε̄): metals; clay that is sheared undrained |
//! | [`DruckerPrager`] | √J₂ + η p = ξ c: a smooth cone |
//! | [`MohrCoulomb`] | τ = c − σ_n tan φ on some plane: soil, rock |
//! | [`CamClay`] | q²/M² + p (p − p_c) = 0: clay, whose stiffness and strength grow with pressure |
//! | [`SysCamClay`] | that, of soil with structure, overconsolidation and anisotropy, which it loses as it yields |
//!
//! A law is a [`ReturnMap`] of small strains; [`Elastoplastic`] makes it one of large deformations, in every section.

mod axes;
mod cam_clay;
mod drucker_prager;
mod elasticity;
mod mohr_coulomb;
mod series;
mod skeleton;
mod sys_cam_clay;
mod von_mises;

use std::borrow::Cow;
use std::fmt::Debug;
use std::sync::Arc;

use nalgebra::{Matrix4, Matrix5, Vector2, Vector3, Vector4};

use super::components::positive_stretch;
use super::{
    Answer, BulkLaw, BulkResponse, CauchyStress, Flow, InadmissibleStress, Lame, Material, MaterialDescription,
    MaterialFailure, Sections, Slot, Straining, positive_jacobian,
};
use crate::laws::parameter::{InvalidParameter, require_not_negative};
use crate::laws::text::number;
use axes::Axes;
pub use cam_clay::{CamClay, CamClayParameters};
pub use drucker_prager::{DruckerPrager, DruckerPragerParameters, Matching};
pub use elasticity::{Elasticity, LogarithmicBulk};
pub use mohr_coulomb::{MohrCoulomb, MohrCoulombParameters, Softening};
pub use sys_cam_clay::{SysCamClay, SysCamClayParameters};
pub use von_mises::{BackStress, VonMises, VonMisesParameters};

/// Response of a law in the principal axes of its trial strains. Components are 11, 22, 33, 12: 1 and 2 in plane, 3 across it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct Returned {
    /// τ: Kirchhoff stress [F/L²]
    pub stress: Vector4<f64>,
    /// D = ∂τ/∂ε of the trial strains, of ε₁₂ being the tensor's component [F/L²]
    pub tangent: Matrix4<f64>,
    /// Δε_p: plastic strain of the increment [-]
    pub plastic: Vector4<f64>,
}

impl Returned {
    /// No yielding: τ = C:ε.
    #[inline(always)]
    pub fn elastic(elastic: Lame, trial: &Vector3<f64>) -> Self {
        Self { stress: elastic.kirchhoff(&in_axes(trial)), tangent: elastic.stiffness(), plastic: Vector4::zeros() }
    }
}

/// Principal values as components.
#[inline(always)]
fn in_axes(principal: &Vector3<f64>) -> Vector4<f64> {
    Vector4::new(principal.x, principal.y, principal.z, 0.0)
}

/// a:b of two symmetric tensors by their components.
#[inline(always)]
pub(super) fn double_dot(a: &Vector4<f64>, b: &Vector4<f64>) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * a[3] * b[3]
}

/// The deviator of a tensor, and its trace.
#[inline(always)]
fn deviator(tensor: &Vector4<f64>) -> (Vector4<f64>, f64) {
    let trace = tensor[0] + tensor[1] + tensor[2];
    (tensor - THIRD * trace * ONE, trace)
}

/// The first share of a way at which a law that leaves its yield surface inwards is elastic.
const INWARDS: f64 = 1e-3;

/// Most iterations for where a way leaves the elastic domain.
const ITERATIONS: usize = 60;

/// Share of the f at the end of a way that may be left there.
const LEFT: f64 = 1e-12;

/// The share of a way up to where it leaves the elastic domain for good, f being convex along it and f > 0 at its end: also one that begins on
/// one side of the yield surface and leads through the inside to another. By regula falsi (Illinois).
fn share_within(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut below) = (INWARDS, f(INWARDS));
    if below >= 0.0 {
        let start = f(0.0);
        return if start < 0.0 { INWARDS * start / (start - below) } else { 0.0 };
    }
    let (mut high, mut above) = (1.0, f(1.0));
    if above <= 0.0 {
        return 1.0;
    }
    let (least, mut was_inside) = (LEFT * above, None);
    for _ in 0..ITERATIONS {
        let share = low + (high - low) * below / (below - above);
        let value = f(share);
        if value.abs() <= least {
            return share;
        }
        let is_inside = value < 0.0;
        let again = was_inside.replace(is_inside) == Some(is_inside);
        if is_inside {
            (low, below) = (share, value);
            above *= if again { 0.5 } else { 1.0 };
        } else {
            (high, above) = (share, value);
            below *= if again { 0.5 } else { 1.0 };
        }
    }
    low
}

/// 1/3: a product takes a fifth of the time of a quotient.
const THIRD: f64 = 1.0 / 3.0;

/// The unit tensor.
const ONE: Vector4<f64> = Vector4::new(1.0, 1.0, 1.0, 0.0);

/// What a law that yields says of itself in plain values.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct ReturnDescription<'a> {
    /// Name of the law in a case
    pub name: &'static str,
    /// Names of its own history, that of its tensors last: four each, xx, yy, zz, xy
    pub history: &'a [&'static str],
    /// Number of tensors in the history, which turn with the body
    pub tensors: usize,
    /// Names of what it shows besides what every law shows
    pub shown: &'a [&'static str],
    /// Whether it dilates as it yields
    pub flow: Flow,
    /// Whether D is symmetric, as it is where the flow is associated, and ∂P/∂F with it
    pub is_associated: bool,
    /// What makes results depend on the size of elements: "softens", or another word; none if nothing does
    pub localizes: Option<&'static str>,
    /// Whether the law makes sense in a plate
    pub in_plates: bool,
    /// c and tan φ of a law that yields by them, or nearly so [F/L², -]
    pub strength: Option<[f64; 2]>,
}

impl ReturnDescription<'_> {
    /// An associated law without a history of its own, which keeps its volume, for bodies that are no plates.
    pub const fn new(name: &'static str) -> Self {
        Self {
            name,
            history: &[],
            tensors: 0,
            shown: &[],
            flow: Flow::Isochoric,
            is_associated: true,
            localizes: None,
            in_plates: false,
            strength: None,
        }
    }
}

/// Equivalent plastic strain ε̄_p in the history of every law that yields, its first number.
pub const EQUIVALENT: Slot<1> = Slot::FIRST;

/// Plastic volume strain behind it. What a law has of its own follows.
pub const VOLUME: Slot<1> = Slot::after(EQUIVALENT);

/// A law that yields, at small strains: a pure function of trial strains and history.
///
/// ```text
/// (τ, D, Δε_p, history₁) = law(ε_trial; history₀)
/// ```
/// The trial strains are principal ones, so the law is isotropic. Its history begins with [`EQUIVALENT`] and [`VOLUME`], which
/// [`Elastoplastic`] adds up, then come the numbers that it [names](ReturnDescription::history), tensors in the axes of the trial strains.
pub trait ReturnMap: Clone + Debug + Send + Sync + 'static {
    /// Describes the law before anything is strained.
    fn description(&self) -> ReturnDescription<'_>;

    /// Returns the elasticity, which derives from a potential.
    fn elasticity(&self, history: &[f64]) -> Elasticity;

    /// Write its own history at the start, under an initial stress, whether or not it can begin there. It stays zero unless the law says
    /// otherwise.
    ///
    /// # Errors
    /// Why it cannot begin, and what to do: the stress is not [`within`] the yield surface.
    fn begin(&self, stress: &CauchyStress, history: &mut [f64]) -> Result<(), InadmissibleStress> {
        within(self, stress, history, || "lower it, or raise the strength".into())
    }

    /// The answer to trial strains, after the committed stress `before` in their axes. The committed history stands in `history`, and what
    /// it is at the end of the increment is written over it. A law that asks for the stress before has tensors.
    ///
    /// # Errors
    /// [`MaterialFailure::NotConverged`] when there is no return to the yield surface.
    fn returned(&self, trial: &Vector3<f64>, before: &Vector4<f64>, history: &mut [f64]) -> Answer<Returned>;

    /// f of a stress: 0 where it yields, less where it does not [F/L²]
    fn yield_indicator(&self, stress: &Vector4<f64>, history: &[f64]) -> f64;

    /// The share of the way from the committed stress to the trial stress after which it yields: where the way leaves the elastic domain.
    #[inline(always)]
    fn onset(&self, [before, trial]: [&Vector4<f64>; 2], history: &[f64]) -> f64 {
        share_within(|share| self.yield_indicator(&(before + share * (trial - before)), history))
    }

    /// Energy that a history stores per volume besides the elastic strains, as back stresses do [F/L²]
    fn stored(&self, _history: &[f64]) -> f64 {
        0.0
    }

    /// Write what it [shows](ReturnDescription::shown), of a stress and its history.
    fn show(&self, _stress: &Vector4<f64>, _history: &[f64], _values: &mut [f64]) {}
}

/// Whether a stress is within the yield surface of a law, but for the digits that numbers are written without.
///
/// # Errors
/// That it is not, and what to do.
pub fn within(
    law: &impl ReturnMap,
    stress: &CauchyStress,
    history: &[f64],
    remedy: impl FnOnce() -> String,
) -> Result<(), InadmissibleStress> {
    let tensor = Vector4::from(stress.components());
    // f is a function of stresses in any axes.
    let f = law.yield_indicator(&tensor, history);
    match f <= WRITTEN * tensor.amax() {
        true => Ok(()),
        false => Err(InadmissibleStress(format!("is beyond the yield surface, f = {} > 0: {}", number(f), remedy()))),
    }
}

/// A [`ReturnMap`] at large deformations, F = F_e F_p.
///
/// ```text
/// b = F C_p⁻¹ Fᵀ = Σ b_i m_i⊗m_i,   ε_i = ½ ln b_i                      trial, i = 1, 2 in plane, 3 across it       (1)
/// τ, D, Δε_p = law(ε_i; history),   ε_e = ε − Δε_p                                                                  (2)
/// C_p⁻¹ ← F⁻¹ exp(2 ε_e) F⁻ᵀ,   P = τ F⁻ᵀ                               the exponential map                         (3)
/// W = W_e(ε_e) + what the history stores, less that at the start                                                     (4)
/// dissipation = ½ (τ_y + τ₁):Δε_p − Δ(what the history stores)                                                      (5)
/// ```
/// τ_y is where the way from the committed stress to the trial stress leaves the elastic domain, so (5) is of second order in the increment,
/// as the audit of energies is, with F_p of C_p⁻¹ = F_p⁻¹ F_p⁻ᵀ, so that F at the end of the increment alone is needed. Plastic volume is exact: tr Δε_p = 0 keeps
/// det C_p. The tangent is that of (1) to (3), l = dF F⁻¹ in the axes m:
///
/// ```text
/// dε_ii = l_ii,   dε₁₂ = (ε₁ − ε₂)/(b₁ − b₂) (b₂ l₁₂ + b₁ l₂₁),   dτ = D:dε,   dP = (dτ − τ lᵀ) F⁻ᵀ                  (6)
/// ```
/// Tensors of the history do not share the axes of b. They are kept unrotated, α = R α̂ Rᵀ with F = R U, which is objective and does
/// not oscillate in large shear; dτ then follows the spin of R, dτ − [Ω, τ] = D:(dε − [Ω, ε]), Ω = dR Rᵀ.
///
/// An initial stress is that of the law from the start: C_p⁻¹ = exp(2 ε(σ₀)), so that it counts for yielding. With a relaxation time τ_v
/// the answer lags behind (Duvaut & Lions), x₁ = (x_trial + r x_law)/(1 + r) of stress and history alike, r = Δt/τ_v; bands of
/// localized strain then have a width of their own.
///
/// # Errors
/// [`MaterialFailure::Inverted`] when det F is not positive, [`MaterialFailure::OutOfRange`] when an increment of plastic strain is above
/// 0.2, and what the law says.
///
/// Source: Simo (1992), Comput. Methods Appl. Mech. Eng. 99, 61, doi:10.1016/0045-7825(92)90123-2; de Souza Neto, Perić & Owen (2008),
/// Computational Methods for Plasticity, ch. 14.
#[derive(Clone, Debug, PartialEq)]
pub struct Elastoplastic<L> {
    law: L,
    density: f64,
    /// λ and G under the mean pressure that is typical, 0 unless it is told
    moduli: Lame,
    /// τ_v [T]
    viscosity: f64,
    names: Vec<&'static str>,
    shown: Vec<&'static str>,
    concern: Option<String>,
}

/// Names of C_p⁻¹ − 1, of what was stored at the start, of the unrotated stress, and of what every law has in its history.
const STATE: [&str; 11] = [
    "plastic_xx",
    "plastic_yy",
    "plastic_xy",
    "plastic_zz",
    "energy_at_start",
    "tau_xx",
    "tau_yy",
    "tau_zz",
    "tau_xy",
    "equivalent_plastic_strain",
    "plastic_volume_strain",
];

const PLASTIC: Slot<4> = Slot::FIRST;
const AT_START: Slot<1> = Slot::after(PLASTIC);
/// The history of the law stands behind the stress.
const STRESS: Slot<4> = Slot::after(AT_START);

/// Quantities that every law shows.
const SHOWN: [&str; 3] = ["equivalent_plastic_strain", "plastic_volume_strain", "yield_indicator"];

/// Largest component of an increment of plastic strain.
const LARGEST: f64 = 0.2;

/// Share of the stiffness by which a stress may be beyond the yield surface by round-off.
const ROUND_OFF: f64 = 1e-14;

/// Share of the stress by which an initial stress may be beyond the yield surface: numbers are written with a few digits.
const WRITTEN: f64 = 1e-6;

/// Elasticity of a law that begins under a mean pressure.
fn elasticity_at(law: &impl ReturnMap, pressure: f64) -> Elasticity {
    let mut history = vec![0.0; VOLUME.end() + law.description().history.len()];
    let _ = law.begin(&CauchyStress { xx: -pressure, yy: -pressure, zz: -pressure, xy: 0.0 }, &mut history);
    law.elasticity(&history)
}

impl<L: ReturnMap> Elastoplastic<L> {
    /// A law at large deformations, with a density [M/L³] and the relaxation time of its viscosity, 0 for none [T].
    ///
    /// # Errors
    /// [`InvalidParameter`] when one of them is out of its range.
    pub fn new(law: L, density: f64, viscosity: f64) -> Result<Self, InvalidParameter> {
        require_not_negative("density", density)?;
        require_not_negative("viscosity", viscosity)?;
        let own = law.description();
        let names = STATE.iter().chain(own.history).copied().collect();
        let shown = SHOWN.iter().chain(own.shown).copied().collect();
        let concern = own.localizes.filter(|_| viscosity == 0.0).map(|why| {
            format!(
                "`{}` {why}: bands of localized strain are as wide as an element, and what follows a peak load depends on the \
                 mesh; compare two meshes, or give the law a `viscosity`",
                own.name
            )
        });
        let moduli = elasticity_at(&law, 0.0).moduli(0.0);
        Ok(Self { law, density, moduli, viscosity, names, shown, concern })
    }

    /// The axes of b, the law's answer there at the end of the increment, W and what was dissipated.
    #[inline(always)]
    fn answer(&self, straining: &Straining, new: &mut [f64]) -> Answer<(Axes, Returned, [f64; 2])> {
        let Straining { deformation, stretch, dt, old, .. } = *straining;
        positive_stretch(straining)?;
        positive_jacobian(&deformation)?;
        let axes = Axes::of(&deformation, stretch, PLASTIC.of(old))?;
        new.copy_from_slice(old);
        let (committed, history) = (STRESS.behind(old), STRESS.behind_mut(new));
        self.turn(history, |tensor| axes.entered(tensor));
        let before = axes.entered(&(*STRESS.of(old)).into());
        let mut found = self.law.returned(&axes.strains, &before, history)?;
        let largest = found.plastic.amax();
        if largest.is_nan() || largest > LARGEST {
            return Err(MaterialFailure::OutOfRange { law: self.law.description().name, strain: largest });
        }
        self.turn(history, |tensor| axes.left(tensor));
        if self.viscosity > 0.0 {
            self.lag(dt, &axes, committed, history, &mut found);
        }
        let (deviator, volume) = deviator(&found.plastic);
        let length = (2.0 / 3.0 * double_dot(&deviator, &deviator)).sqrt();
        EQUIVALENT.set(history, EQUIVALENT.value(committed) + length);
        VOLUME.set(history, VOLUME.value(committed) + volume);
        let dissipated = self.dissipated(&axes, [&before, &found.stress], &found.plastic, [committed, history]);
        *STRESS.of_mut(new) = axes.left(&found.stress).into();
        axes.flow(&found.plastic, stretch, PLASTIC.of_mut(new));
        let strain = in_axes(&axes.strains) - found.plastic;
        let energy = self.stored(&strain, STRESS.behind(new)) - AT_START.value(old);
        Ok((axes, found, [energy, dissipated]))
    }

    /// Turn the tensors of a history.
    #[inline(always)]
    fn turn(&self, history: &mut [f64], turned: impl Fn(&Vector4<f64>) -> Vector4<f64>) {
        let first = history.len() - 4 * self.law.description().tensors;
        for tensor in history[first..].chunks_exact_mut(4) {
            tensor.copy_from_slice(turned(&Vector4::from_column_slice(tensor)).as_slice());
        }
    }

    /// A committed history in the axes.
    #[inline(always)]
    fn history_in<'a>(&self, axes: &Axes, committed: &'a [f64]) -> Cow<'a, [f64]> {
        let mut history = Cow::from(committed);
        if self.spins() {
            self.turn(history.to_mut(), |tensor| axes.entered(tensor));
        }
        history
    }

    /// (5), of the stress in the axes and the history at both ends of the increment.
    #[inline(always)]
    fn dissipated(
        &self,
        axes: &Axes,
        [before, after]: [&Vector4<f64>; 2],
        plastic: &Vector4<f64>,
        [old, new]: [&[f64]; 2],
    ) -> f64 {
        if *plastic == Vector4::zeros() {
            return 0.0;
        }
        let committed = self.history_in(axes, old);
        let trial = self.law.elasticity(&committed).kirchhoff(&in_axes(&axes.strains));
        let met = before + self.law.onset([before, &trial], &committed) * (trial - before);
        let stored = self.law.stored(new) - self.law.stored(old);
        0.5 * double_dot(&(met + after), plastic) - stored
    }

    /// Let an answer lag behind, by the law of Duvaut and Lions.
    fn lag(&self, dt: f64, axes: &Axes, old: &[f64], history: &mut [f64], found: &mut Returned) {
        let share = dt / (self.viscosity + dt);
        let elastic = self.law.elasticity(old);
        for (new, old) in history.iter_mut().zip(old) {
            *new = old + share * (*new - old);
        }
        let trial = in_axes(&axes.strains);
        let at_return = elastic.bulk(&(trial - found.plastic));
        found.plastic *= share;
        let lagging = trial - found.plastic;
        found.stress = elastic.kirchhoff(&lagging);
        // The law's part passes through Δε_p: its pressure counts by the bulk modulus here over that where the law returned to.
        let pressure = ONE * (ONE.transpose() * found.tangent) / 3.0;
        found.tangent += (elastic.bulk(&lagging) / at_return - 1.0) * pressure;
        found.tangent = (1.0 - share) * elastic.stiffness(&lagging) + share * found.tangent;
    }

    /// Elastic energy and that of the history.
    #[inline(always)]
    fn stored(&self, elastic_strain: &Vector4<f64>, history: &[f64]) -> f64 {
        self.law.elasticity(history).stored(elastic_strain) + self.law.stored(history)
    }

    /// Whether the axes of the history turn otherwise than those of the stress.
    #[inline(always)]
    fn spins(&self) -> bool {
        self.law.description().tensors > 0
    }

    /// Stress and history in the axes where the law remembers `straining.old`.
    fn committed<'a>(&self, straining: &Straining<'a>) -> Answer<(Vector4<f64>, Cow<'a, [f64]>)> {
        let axes = Axes::of(&straining.deformation, straining.stretch, PLASTIC.of(straining.old))?;
        let history = self.history_in(&axes, STRESS.behind(straining.old));
        Ok((self.law.elasticity(&history).kirchhoff(&in_axes(&axes.strains)), history))
    }
}

impl<L: ReturnMap> BulkLaw for Elastoplastic<L> {
    fn description(&self) -> MaterialDescription<'_> {
        let own = self.law.description();
        MaterialDescription {
            is_symmetric: own.is_associated && own.tensors == 0,
            flow: Some(own.flow),
            concern: self.concern.as_deref(),
            strength: own.strength,
            holds_initial_stress: true,
            shown: &self.shown,
            sections: if own.in_plates { Sections::All } else { Sections::AnyStretch },
            ..self.moduli.description(self.density).remembering(&self.names)
        }
    }

    #[inline(always)]
    fn respond(&self, straining: &Straining, new: &mut [f64]) -> Answer {
        let (axes, found, [energy, dissipation]) = self.answer(straining, new)?;
        let stress = axes.first_piola_kirchhoff(&found.stress);
        let tangent = if straining.tangent { axes.moduli(&found, self.spins()) } else { Matrix5::zeros() };
        Ok(BulkResponse { dissipation, ..BulkResponse::new(stress, tangent, energy) })
    }

    /// Returns the stretch that leaves a plate without out-of-plane stress if it does not yield in the increment.
    fn ln_free_stretch(&self, straining: &Straining) -> Answer<f64> {
        let jacobian = positive_jacobian(&straining.deformation)?;
        let [xx, yy, xy, zz] = *PLASTIC.of(straining.old);
        let areal = jacobian.ln() + 0.5 * (xx + yy + xx * yy - xy * xy).ln_1p();
        let Lame { lambda, shear } = self.moduli;
        Ok(-lambda / (lambda + 2.0 * shear) * areal - 0.5 * zz.ln_1p())
    }

    fn at_pressure(&self, pressure: f64) -> Option<Arc<dyn Material>> {
        match elasticity_at(&self.law, pressure) {
            Elasticity::Linear(_) => None,
            elasticity => Some(Arc::new(Self { moduli: elasticity.moduli(pressure), ..self.clone() })),
        }
    }

    fn begin(&self, _: Vector2<f64>, stress: &CauchyStress, variables: &mut [f64]) -> Result<(), InadmissibleStress> {
        let (tensor, history) = (Vector4::from(stress.components()), STRESS.behind_mut(variables));
        let begun = self.law.begin(stress, history);
        let strain = self.law.elasticity(history).strain(&tensor);
        let stored = self.stored(&strain, history);
        let [xx, yy, zz, xy] = axes::exponential_less_one(&(2.0 * strain)).into();
        *PLASTIC.of_mut(variables) = [xx, yy, xy, zz];
        AT_START.set(variables, stored);
        *STRESS.of_mut(variables) = tensor.into();
        begun
    }

    fn show(&self, straining: &Straining, values: &mut [f64]) -> Answer<()> {
        let (stress, history) = self.committed(straining)?;
        let (first, own) = values.split_at_mut(SHOWN.len());
        let indicator = self.law.yield_indicator(&stress, &history);
        first.copy_from_slice(&[EQUIVALENT.value(&history), VOLUME.value(&history), indicator]);
        self.law.show(&stress, &history, own);
        Ok(())
    }
}
