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
//! in parallel with a Maxwell arm that relaxes. Laws that yield stand in [`plasticity`].
//!
//! A law is a [`BulkLaw`], in a file of its own with its equations on top: F and P have five components each, those in plane and that out
//! of it. So it serves in plane strain, F₃₃ = 1, and in rings; [`BodyLaw`] puts it into a plate, under an initial stress, heats it, and
//! fills its pores with a fluid. [`Material`] is what elements ask of a law, and [`MaterialDescription`] has what damping makes of it.
//!
//! A law may remember some numbers of its own at every quadrature point, by names ([`Slot`]). They are handled like the state of friction:
//! the answer to an increment is a pure function of what was committed, and what it leaves is a second value.

use std::fmt::Debug;
use std::sync::Arc;

use nalgebra::{Matrix2, Matrix5, Vector2, Vector5};
use thiserror::Error;

mod body;
pub(crate) mod components;
mod damping;
mod hencky;
mod isotropic;
mod linear;
mod material;
mod neo_hookean;
mod parameters;
pub mod plasticity;
mod saint_venant_kirchhoff;
mod slots;
mod viscoelastic;

pub use body::{BodyLaw, GIVEN_PRESSURE, INITIAL_STRESS, PORE_PRESSURE, PoreFluid, Surroundings, TEMPERATURE};
pub use hencky::Hencky;
pub use linear::Linear;
pub use material::{Material, MaterialResponse};
pub use neo_hookean::NeoHookean;
pub use parameters::{ElasticConstants, Lame, MaterialParameters};
pub use plasticity::{
    BackStress, CamClay, CamClayParameters, DruckerPrager, DruckerPragerParameters, Elasticity, Elastoplastic,
    LogarithmicBulk, Matching, MohrCoulomb, MohrCoulombParameters, ReturnDescription, ReturnMap, Returned, Softening,
    SysCamClay, SysCamClayParameters, VonMises, VonMisesParameters,
};
pub use saint_venant_kirchhoff::SaintVenantKirchhoff;
pub use slots::Slot;
pub use viscoelastic::{Viscoelastic, ViscoelasticConstants};

/// Response of a law at the end of an increment; it writes its new variables itself. Components are 11, 21, 12, 22, 33.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct BulkResponse {
    /// P: first Piola–Kirchhoff stress [F/L²]
    pub stress: Vector5<f64>,
    /// ∂P/∂F [F/L²]
    pub tangent: Matrix5<f64>,
    /// W: stored energy per reference volume [F/L²]
    pub energy: f64,
    /// Energy dissipated in the increment per reference volume [F/L²]
    pub dissipation: f64,
    /// F₃₃ of a law that finds it itself, as that of a [plate](Sections::Plate) does
    pub free_stretch: Option<f64>,
}

impl BulkResponse {
    /// P, ∂P/∂F and W of a law without dissipation, unless this field is set.
    #[inline(always)]
    pub fn new(stress: Vector5<f64>, tangent: Matrix5<f64>, energy: f64) -> Self {
        Self { stress, tangent, energy, dissipation: 0.0, free_stretch: None }
    }
}

/// Sections of bodies that a law serves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Sections {
    /// Plane strain alone: the law answers to F₃₃ = 1
    PlaneStrain,
    /// Plates alone: the law finds F₃₃ itself, whatever it is asked at
    Plate,
    /// All but plates; it can be that of a ring, or of a body with an initial stress, a temperature or a fluid in its pores
    AnyStretch,
    /// All of them
    All,
}

impl Sections {
    /// Whether the law answers to any F₃₃.
    pub const fn any_stretch(self) -> bool {
        matches!(self, Self::AnyStretch | Self::All)
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
    /// λ + 2G of [damping](Self::viscous_stress) by stiffness, where it is another than the P-wave modulus [F/L²]
    pub viscous_modulus: Option<f64>,
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
    /// c and tan φ of a law that yields where τ = c − σ_n tan φ on some plane, or nearly so; none of others [F/L², -]
    pub strength: Option<[f64; 2]>,
    /// Whether an initial stress is the law's own, which [`BulkLaw::begin`] makes it remember; otherwise it is added to the law ([`BodyLaw`])
    /// otherwise
    pub holds_initial_stress: bool,
    /// Names of what the law shows besides stress, at a point in any state
    pub shown: &'a [&'static str],
    /// Sections that it serves
    pub sections: Sections,
}

impl<'a> MaterialDescription<'a> {
    /// An elastic law of the density ρ₀, λ + 2G and G, for all sections.
    pub const fn new(density: f64, p_wave_modulus: f64, shear_modulus: f64) -> Self {
        Self {
            density,
            p_wave_modulus,
            shear_modulus,
            viscous_modulus: None,
            is_linear: false,
            is_symmetric: true,
            variables: &[],
            evolves: false,
            flow: None,
            concern: None,
            strength: None,
            holds_initial_stress: false,
            shown: &[],
            sections: Sections::All,
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
    let (middle, difference) = (0.5 * (b.m11 + b.m22), 0.5 * (b.m11 - b.m22));
    let radius = difference.hypot(b.m12);
    let (area, share) = (deformation.determinant(), radius / middle);
    // ½ ln(β₁/β₂)/(2 r), whose limit at r = 0 is 1/(2 m)
    let shear = match share {
        share if share < 1e-3 => 0.5 / middle * (1.0 + share * share * (1.0 / 3.0 + share * share / 5.0)),
        share if share < 0.5 => 0.5 / middle * share.atanh() / share,
        _ => 0.5 * ((middle + radius) / area).ln() / radius,
    };
    let mean = 0.5 * components::ln_stretch(area);
    [mean + shear * difference, mean - shear * difference, components::ln_stretch(stretch), shear * b.m12]
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

/// Answer of a law, or why it has none.
pub type Answer<T = BulkResponse> = Result<T, MaterialFailure>;

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
pub(crate) fn positive_jacobian(deformation: &Matrix2<f64>) -> Answer<f64> {
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
/// What it remembers it names in its [description](Self::description); an elastic law has no variables, and answers to F alone. An
/// increment of no length leaves no time to relax.
///
/// The following example is a law with two constants. It is the material of a body as it is,
/// `Builder::body("block", Blatz { shear: 2.0, density: 0.0 })`:
///
/// ```
/// use fecontact::laws::bulk::{Answer, BulkLaw, BulkResponse, Material, MaterialDescription, MaterialFailure, Straining};
/// use nalgebra::{Matrix2, Matrix5, Vector5};
///
/// /// Foamed rubber (Blatz & Ko), ν = ¼: W = G/2 (F:F + 2/J − 5), P = G (F − F⁻ᵀ/J) with J of all three stretches.
/// #[derive(Debug)]
/// struct Blatz {
///     /// G [F/L²]
///     shear: f64,
///     /// ρ₀ [M/L³]
///     density: f64,
/// }
///
/// impl BulkLaw for Blatz {
///     fn description(&self) -> MaterialDescription<'_> {
///         MaterialDescription::new(self.density, 3.0 * self.shear, self.shear) // λ = G
///     }
///
///     fn respond(&self, straining: &Straining, _: &mut [f64]) -> Answer {
///         let (f, h) = (straining.deformation, straining.stretch);
///         let jacobian = f.determinant() * h;
///         if !(jacobian > 0.0 && h > 0.0) {
///             return Err(MaterialFailure::Inverted { jacobian });
///         }
///         let by = 1.0 / f.determinant();
///         let all = Vector5::new(f.m11, f.m21, f.m12, f.m22, h);
///         let inverse = Vector5::new(f.m22 * by, -f.m12 * by, -f.m21 * by, f.m11 * by, 1.0 / h); // F⁻ᵀ
///         // ∂F⁻ᵀ_iJ/∂F_kL = −F⁻ᵀ_iL F⁻ᵀ_kJ
///         let at = [(0, 0), (1, 0), (0, 1), (1, 1), (2, 2)];
///         let of = |i: usize, j: usize| at.iter().position(|here| *here == (i, j)).map_or(0.0, |k| inverse[k]);
///         let varied = Matrix5::from_fn(|row, column| of(at[row].0, at[column].1) * of(at[column].0, at[row].1));
///         let tangent = Matrix5::identity() + (inverse * inverse.transpose() + varied) / jacobian;
///         let energy = 0.5 * (all.norm_squared() + 2.0 / jacobian - 5.0);
///         Ok(BulkResponse::new(self.shear * (all - inverse / jacobian), self.shear * tangent, self.shear * energy))
///     }
/// }
///
/// let law: Box<dyn Material> = Blatz { shear: 2.0, density: 0.0 }.into();
/// let free = law.at_once(&Matrix2::identity())?;
/// assert_eq!((free.stress, free.tangent[(0, 0)]), (Matrix2::zeros(), 6.0));
/// # Ok::<(), MaterialFailure>(())
/// ```
pub trait BulkLaw: Debug + Send + Sync {
    /// Describes the law before anything is strained.
    fn description(&self) -> MaterialDescription<'_>;

    /// The answer to an increment, whose variables at the end are written over `new`.
    ///
    /// # Errors
    /// [`MaterialFailure`] when det F or F₃₃ is not positive, or the law's equations are not solved.
    fn respond(&self, straining: &Straining, new: &mut [f64]) -> Answer;

    /// Write what the law remembers before the first increment over `variables`, which are zero: at a reference position, in a body
    /// with an initial stress. It is written whether or not the body can begin there.
    ///
    /// # Errors
    /// Why a body of this law cannot have this initial stress, and what to do.
    fn begin(
        &self,
        _position: Vector2<f64>,
        _stress: &CauchyStress,
        _variables: &mut [f64],
    ) -> Result<(), InadmissibleStress> {
        Ok(())
    }

    /// Write what it [shows](MaterialDescription::shown) where it remembers `straining.old`.
    ///
    /// # Errors
    /// As [`BulkLaw::respond`].
    fn show(&self, _straining: &Straining, _values: &mut [f64]) -> Answer<()> {
        Ok(())
    }

    /// ln F₃₃ from which a plate's is searched, F₃₃ in `straining` being of no account: J^(−λ/(λ + 2G)), the solution of Hencky's law.
    ///
    /// # Errors
    /// [`MaterialFailure::Inverted`] when det F is not positive.
    fn ln_free_stretch(&self, straining: &Straining) -> Answer<f64> {
        let own = self.description();
        Ok(-positive_jacobian(&straining.deformation)?.ln() * own.lambda() / own.p_wave_modulus)
    }

    /// The law with the moduli that it has under a mean pressure p at the start, p being positive in compression; none where they do not
    /// depend on it [F/L²]
    fn at_pressure(&self, _pressure: f64) -> Option<Arc<dyn Material>> {
        None
    }
}
