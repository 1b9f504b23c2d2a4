//! The bulk-law contract: stress and tangent of a material, and what it remembers.
//!
//! | law | stored energy W per reference volume |
//! |---|---|
//! | [`Linear`] | ½ ε:C:ε, small strains and rotations only |
//! | [`SaintVenantKirchhoff`] | λ/2 (tr E)² + G E:E |
//! | [`NeoHookean`] | G/2 (I₁ − 3 − 2 ln J) + λ/2 (ln J)² |
//! | [`Hencky`] | G ‖ln V‖² + λ/2 (ln J)² |
//!
//! All have the same two constants, λ and G, and the same response to small strains. [`Viscoelastic`] has a neo-Hookean body
//! beside a Maxwell arm that relaxes. Laws that yield stand in [`plasticity`].
//!
//! Laws are written in plane strain, F₃₃ = 1. One that also covers an out-of-plane stretch is [`Spatial`], and can be
//! that of a ring; [`PlaneStress`] is such a law in a plate, [`Imposed`] one in a body with an initial stress or a
//! temperature, and [`Undrained`] one whose pores hold a fluid.
//!
//! A law may remember some numbers of its own at every quadrature point. They are handled like the state of friction: the
//! answer to an increment is a pure function of what was committed, and what it leaves is a second value.
//!
//! Damping of the Kelvin–Voigt kind adds a stress proportional to the rate of strain, τ being a time:
//!
//! ```text
//! P_v = τ F (C:Ė),   Ė = sym(Fᵀ Ḟ),   C:Ė = λ tr(Ė) 1 + 2 G Ė                                  (1)
//! ```
//!
//! It turns with the body and does not resist a rotation. In small strains it is τ times the elastic stress of the rate
//! of strain: the stiffness-proportional part of Rayleigh's damping.

use std::fmt::Debug;
use std::sync::Arc;

use nalgebra::{Matrix2, Matrix4, Vector2};
use thiserror::Error;

mod hencky;
mod imposed;
mod isotropic;
mod linear;
mod neo_hookean;
mod parameters;
pub mod plasticity;
mod saint_venant_kirchhoff;
mod slots;
pub(crate) mod spatial;
mod undrained;
mod viscoelastic;

pub use hencky::Hencky;
pub use imposed::{INITIAL_STRESS, Imposed, TEMPERATURE};
pub use linear::Linear;
pub use neo_hookean::NeoHookean;
pub use parameters::{ElasticConstants, Lame, MaterialParameters};
pub use plasticity::{
    BackStress, CamClay, CamClayParameters, DruckerPrager, DruckerPragerParameters, Elasticity, Elastoplastic,
    LogarithmicBulk, Matching, MohrCoulomb, MohrCoulombParameters, ReturnDescription, ReturnMap, Returned, Softening,
    SysCamClay, SysCamClayParameters, VonMises, VonMisesParameters,
};
pub use saint_venant_kirchhoff::SaintVenantKirchhoff;
pub use slots::Slot;
pub use spatial::{PlaneStress, Spatial, Stretched};
pub use undrained::{PORE_PRESSURE, Undrained};
pub use viscoelastic::{Viscoelastic, ViscoelasticConstants};

/// Response of a law at the end of an increment; it writes its new variables itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct MaterialResponse {
    /// P: first Piola–Kirchhoff stress, in plane part [F/L²]
    pub stress: Matrix2<f64>,
    /// ∂P_iJ/∂F_kL at row i + 2J, column k + 2L (column-major order of the 2×2 matrices) [F/L²]
    pub tangent: Matrix4<f64>,
    /// W: stored energy per reference volume [F/L²]
    pub energy: f64,
    /// σ_zz: out-of-plane Cauchy stress [F/L²]
    pub stress_zz: f64,
    /// Energy dissipated in the increment per reference volume [F/L²]
    pub dissipation: f64,
}

impl MaterialResponse {
    /// P, ∂P/∂F and W of a law that has neither out-of-plane stress nor dissipation, unless these fields are set.
    pub fn new(stress: Matrix2<f64>, tangent: Matrix4<f64>, energy: f64) -> Self {
        Self { stress, tangent, energy, stress_zz: 0.0, dissipation: 0.0 }
    }
}

/// Description of a law in plain values.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct MaterialDescription<'a> {
    /// ρ₀: mass per reference volume [M/L³]
    pub density: f64,
    /// λ + 2G: P-wave modulus of the undeformed material at once, the scale of its stiffness: of waves, penalties and steps [F/L²]
    pub p_wave_modulus: f64,
    /// G: shear modulus of the undeformed material [F/L²]
    pub shear_modulus: f64,
    /// Whether ∂P/∂F is the same at every F
    pub is_linear: bool,
    /// Whether ∂P/∂F is symmetric, as it is where P has a potential: half of the tangent is the mirror image of the other
    pub is_symmetric: bool,
    /// Names of what the law remembers at every quadrature point; none for elastic laws
    pub variables: &'a [&'static str],
    /// Whether an increment changes what the law remembers
    pub evolves: bool,
    /// How it flows if it yields; none if it does not. What a law that yields dissipates is plastic work, and damping that of others
    pub flow: Option<Flow>,
    /// Why results depend on the mesh, of a law of which they do
    pub concern: Option<&'a str>,
    /// Whether an initial stress is the law's own, which [`Material::initial_state`] makes it remember; it stands beside the law
    /// ([`Imposed`]) otherwise
    pub holds_initial_stress: bool,
    /// Names of what the law shows besides stress, at a point in any state
    pub shown: &'a [&'static str],
}

impl<'a> MaterialDescription<'a> {
    /// An elastic law of the density ρ₀, λ + 2G and G.
    pub const fn new(density: f64, p_wave_modulus: f64, shear_modulus: f64) -> Self {
        Self {
            density,
            p_wave_modulus,
            shear_modulus,
            is_linear: false,
            is_symmetric: true,
            variables: &[],
            evolves: false,
            flow: None,
            concern: None,
            holds_initial_stress: false,
            shown: &[],
        }
    }

    /// A law whose increments change these variables.
    pub const fn remembering(self, variables: &'a [&'static str]) -> Self {
        Self { variables, evolves: true, ..self }
    }

    /// λ
    pub(crate) fn lambda(&self) -> f64 {
        self.p_wave_modulus - 2.0 * self.shear_modulus
    }
}

/// Input of a law at one quadrature point: deformation at the end of the increment, and internal variables at its
/// start.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Straining<'a> {
    /// F at the end, in plane [-]
    pub deformation: Matrix2<f64>,
    /// F₃₃ at the end: stretch out of plane, 1 in plane strain [-]
    pub stretch: f64,
    /// Δt: length of the increment [T]
    pub dt: f64,
    /// The committed [`variables`](MaterialDescription::variables)
    pub old: &'a [f64],
    /// Whether the tangent is wanted; otherwise a law may leave it 0
    pub tangent: bool,
}

impl<'a> Straining<'a> {
    /// Creates a straining in plane strain, without duration.
    pub fn new(deformation: Matrix2<f64>, old: &'a [f64]) -> Self {
        Self { deformation, stretch: 1.0, dt: 0.0, old, tangent: true }
    }
}

/// σ: Cauchy stress, tension positive [F/L²]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CauchyStress {
    /// σ_xx
    pub xx: f64,
    /// σ_yy
    pub yy: f64,
    /// σ_zz, out of plane
    pub zz: f64,
    /// σ_xy
    pub xy: f64,
}

/// Principal values of a symmetric tensor with the components xx, yy, zz, xy, the largest first.
///
/// ```text
/// ½ (xx + yy) ± √(¼ (xx − yy)² + xy²),  zz
/// ```
pub fn principal_values([xx, yy, zz, xy]: [f64; 4]) -> [f64; 3] {
    let (middle, radius) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    let mut values = [middle + radius, middle - radius, zz];
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// ln V at F: logarithmic strain along the axes of now, xx, yy, zz, xy. zz is ln F₃₃.
///
/// ```text
/// ln V = ½ ln b = ½ ln(det F) 1 + atanh(x)/(2 x m) (b − m 1),   b = F Fᵀ in plane, with eigenvalues m (1 ± x)
/// ```
pub fn log_strain(deformation: &Matrix2<f64>, stretch: f64) -> [f64; 4] {
    let b = deformation * deformation.transpose();
    let (middle, apart) = (0.5 * (b.m11 + b.m22), 0.5 * (b.m11 - b.m22));
    let radius = apart.hypot(b.m12);
    let (area, share) = (deformation.determinant(), radius / middle);
    // ½ ln(β₁/β₂)/(2 r), whose limit at r = 0 is 1/(2 m)
    let shear = match share {
        share if share < 1e-3 => 0.5 / middle * (1.0 + share * share * (1.0 / 3.0 + share * share / 5.0)),
        share if share < 0.5 => 0.5 / middle * share.atanh() / share,
        _ => 0.5 * ((middle + radius) / area).ln() / radius,
    };
    let mean = 0.5 * spatial::ln_stretch(area);
    [mean + shear * apart, mean - shear * apart, spatial::ln_stretch(stretch), shear * b.m12]
}

impl CauchyStress {
    /// Returns the components xx, yy, zz, xy.
    pub fn components(&self) -> [f64; 4] {
        [self.xx, self.yy, self.zz, self.xy]
    }

    /// p = −tr σ / 3, positive in compression [F/L²]
    pub fn pressure(&self) -> f64 {
        -(self.xx + self.yy + self.zz) / 3.0
    }

    /// σ_v = √(3/2 dev σ : dev σ) [F/L²]
    pub fn von_mises(&self) -> f64 {
        let differences = (self.xx - self.yy).powi(2) + (self.yy - self.zz).powi(2) + (self.zz - self.xx).powi(2);
        (0.5 * differences + 3.0 * self.xy.powi(2)).sqrt()
    }
}

/// Why a law could not answer; the increment is tried again with a smaller step.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MaterialFailure {
    /// The deformation has no volume left: J = det F ≤ 0, or not a number.
    #[error("the material is inverted (det F = {jacobian:.3e})")]
    Inverted {
        /// J = det F [-]
        jacobian: f64,
    },
    /// The equations of the law were not solved, such as those of a return to its yield surface.
    #[error("`{law}` did not converge: {residual:.3e} of the stress is left out of balance")]
    NotConverged {
        /// the law
        law: &'static str,
        /// what is left out of balance, as a share of the stress [-]
        residual: f64,
    },
    /// The increment strains the material further than the law is accurate.
    #[error("`{law}`: a plastic strain of {strain:.3e} in one increment is too much")]
    OutOfRange {
        /// the law
        law: &'static str,
        /// its largest component [-]
        strain: f64,
    },
}

/// A stress that a law cannot begin with: why, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct InadmissibleStress(pub String);

/// Change of volume of a body that yields, which its elements must be able to follow.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Flow {
    /// It stays
    Isochoric,
    /// It shrinks with the shear until it stays
    Contracting,
    /// It grows with the shear
    Dilating,
    /// It grows with the shear where the pressure at the start is less than this [F/L²]; elsewhere the body contracts until its volume stays
    DilatingBelow(f64),
}

/// J = det F, known to be positive and finite.
pub(crate) fn positive_jacobian(deformation: &Matrix2<f64>) -> Result<f64, MaterialFailure> {
    let jacobian = deformation.determinant();
    if jacobian > 0.0 && jacobian.is_finite() { Ok(jacobian) } else { Err(MaterialFailure::Inverted { jacobian }) }
}

/// cof F = J F⁻ᵀ = ∂J/∂F
pub(crate) fn cofactor(deformation: &Matrix2<f64>) -> Matrix2<f64> {
    let f = deformation;
    Matrix2::new(f.m22, -f.m21, -f.m12, f.m11)
}

/// A bulk law, integrated over one increment. Pure: the same committed variables and increment give the same answer.
///
/// ```text
/// (P, ∂P/∂F, variables, W, dissipation)₁ = law(variables₀; F₁, Δt)
/// ```
/// It is asked in plane strain. What it remembers it names in its [description](Self::description); an elastic law has no variables, and
/// answers to F alone. An increment of no length leaves no time to relax.
pub trait Material: Debug + Send + Sync {
    /// Describes the law before anything is strained.
    fn description(&self) -> MaterialDescription<'_>;

    /// The answer to an increment, whose variables at the end are written over `new`.
    ///
    /// # Errors
    /// [`MaterialFailure`] when det F is not positive, or the law's equations are not solved.
    fn respond(&self, straining: &Straining, new: &mut [f64]) -> Result<MaterialResponse, MaterialFailure>;

    /// The answers to an increment at several points, whose variables stand one behind the other. Compiled for each law, so that an
    /// element calls it once.
    ///
    /// # Errors
    /// As [`Material::respond`].
    fn responses(
        &self,
        strainings: &[Straining],
        new: &mut [f64],
        responses: &mut [MaterialResponse],
    ) -> Result<(), MaterialFailure> {
        let count = new.len() / strainings.len();
        for (k, (straining, response)) in strainings.iter().zip(responses).enumerate() {
            *response = self.respond(straining, &mut new[k * count..(k + 1) * count])?;
        }
        Ok(())
    }

    /// The answer at once, of a body that has not been strained before. Compiled for each law, so that memory that a law does not
    /// have costs nothing.
    ///
    /// # Errors
    /// As [`Material::respond`].
    fn at_once(&self, deformation: &Matrix2<f64>) -> Result<MaterialResponse, MaterialFailure> {
        let old = vec![0.0; self.description().variables.len()];
        let straining = Straining::new(*deformation, &old);
        self.respond(&straining, &mut old.clone())
    }

    /// The law in a plate, which has no out-of-plane stress; none unless it is known.
    fn plane_stress(&self) -> Option<Box<dyn Material>> {
        None
    }

    /// F₃₃ at F in plane, with the variables that the law remembers there: 1 in plane strain, the stretch of the thickness in a plate.
    ///
    /// # Errors
    /// As [`Material::respond`].
    fn stretch_across(&self, _deformation: &Matrix2<f64>, _old: &[f64]) -> Result<f64, MaterialFailure> {
        Ok(1.0)
    }

    /// The law with an out-of-plane stretch, as rings have it; none unless it is known.
    fn spatial(&self) -> Option<&dyn Spatial> {
        None
    }

    /// Write what the law remembers before the first increment over `variables`, which are zero: at a reference position, in a body
    /// with an initial stress.
    fn initial_state(&self, _position: Vector2<f64>, _stress: &CauchyStress, _variables: &mut [f64]) {}

    /// The law with the moduli that it has under a mean pressure p at the start, p being positive in compression; none where they do not
    /// depend on it [F/L²]
    fn at_pressure(&self, _pressure: f64) -> Option<Arc<dyn Material>> {
        None
    }

    /// Whether a body of this law can have an initial stress.
    ///
    /// # Errors
    /// Why it cannot, and what to do.
    fn admits(&self, _stress: &CauchyStress) -> Result<(), InadmissibleStress> {
        Ok(())
    }

    /// Write what it [shows](MaterialDescription::shown) where it remembers `straining.old`.
    ///
    /// # Errors
    /// As [`Material::respond`].
    fn show(&self, _straining: &Straining, _values: &mut [f64]) -> Result<(), MaterialFailure> {
        Ok(())
    }

    /// P and W alone. Compiled for each law, so that the tangent that is not asked for costs nothing.
    ///
    /// # Errors
    /// As [`Material::respond`].
    fn stress(&self, deformation: &Matrix2<f64>) -> Result<(Matrix2<f64>, f64), MaterialFailure> {
        self.at_once(deformation).map(|response| (response.stress, response.energy))
    }

    /// P times the volume at several points, written over `stresses`; returns ∫ W dV. Compiled for each law, so that an
    /// element calls it once.
    ///
    /// # Errors
    /// As [`Material::respond`].
    fn stresses(
        &self,
        deformations: &[Matrix2<f64>],
        volumes: &[f64],
        stresses: &mut [Matrix2<f64>],
    ) -> Result<f64, MaterialFailure> {
        let mut energy = 0.0;
        for ((deformation, &volume), stress) in deformations.iter().zip(volumes).zip(stresses) {
            let (p, stored) = self.stress(deformation)?;
            *stress = volume * p;
            energy += volume * stored;
        }
        Ok(energy)
    }

    /// P_v/τ of (1) at F and Ḟ [F/(L² T)]
    fn viscous_stress(&self, [deformation, rate]: [&Matrix2<f64>; 2]) -> Matrix2<f64> {
        deformation * self.hooke(&(deformation.transpose() * rate))
    }

    /// Variation of P_v/τ with δF and δḞ.
    fn viscous_variation(
        &self,
        [deformation, rate]: [&Matrix2<f64>; 2],
        [varied, varied_rate]: [&Matrix2<f64>; 2],
    ) -> Matrix2<f64> {
        let strain = varied.transpose() * rate + deformation.transpose() * varied_rate;
        varied * self.hooke(&(deformation.transpose() * rate)) + deformation * self.hooke(&strain)
    }

    /// C:sym(e) = λ tr(e) 1 + G (e + eᵀ)
    fn hooke(&self, strain: &Matrix2<f64>) -> Matrix2<f64> {
        let own = self.description();
        Matrix2::from_diagonal_element(own.lambda() * strain.trace())
            + own.shear_modulus * (strain + strain.transpose())
    }

    /// σ = P Fᵀ / J at F in plane strain, with the variables that the law remembers there.
    ///
    /// # Errors
    /// As [`Material::respond`].
    fn cauchy_stress(&self, deformation: &Matrix2<f64>, old: &[f64]) -> Result<CauchyStress, MaterialFailure> {
        let now = Straining::new(*deformation, old);
        // Compiled for each law: the tangent that is not asked for costs nothing.
        let response = match old {
            [] => self.respond(&now, &mut [])?,
            old => self.respond(&now, &mut old.to_vec())?,
        };
        let sigma = response.stress * deformation.transpose() / deformation.determinant();
        Ok(CauchyStress { xx: sigma.m11, yy: sigma.m22, zz: response.stress_zz, xy: sigma.m12 })
    }
}

impl<M: Material + 'static> From<M> for Box<dyn Material> {
    fn from(material: M) -> Self {
        Box::new(material)
    }
}
