//! Laws with an out-of-plane stretch, which plane stress and axisymmetry need.
//!
//! Bodies are not sheared out of plane, so F and P have five components each, (11, 21, 12, 22, 33).
//!
//! # Plane stress
//!
//! Plates: no out-of-plane stress.

use nalgebra::{Matrix2, Matrix3, Matrix4, Matrix5, Vector2, Vector4, Vector5};

use super::{
    CauchyStress, InadmissibleStress, Material, MaterialDescription, MaterialFailure, MaterialResponse, Straining,
};

/// Response of a law at F with an out-of-plane stretch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stretched {
    /// P [F/L²]
    pub stress: Vector5<f64>,
    /// ∂P/∂F [F/L²]
    pub tangent: Matrix5<f64>,
    /// W: stored energy per reference volume [F/L²]
    pub energy: f64,
    /// Energy dissipated in the increment per reference volume [F/L²]
    pub dissipation: f64,
}

/// The part of a response out of plane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OutOfPlane {
    /// P₃₃ [F/L²]
    pub stress: f64,
    /// ∂P/∂F₃₃ = (∂P₃₃/∂F)ᵀ [F/L²]
    pub coupling: Vector4<f64>,
    /// ∂P₃₃/∂F₃₃ [F/L²]
    pub stiffness: f64,
}

impl Stretched {
    /// Creates the response from its parts in plane, P and ∂P/∂F, and out of it.
    pub(super) fn new(stress: Matrix2<f64>, tangent: Matrix4<f64>, across: OutOfPlane, energy: f64) -> Self {
        let OutOfPlane { stress: stress_33, coupling, stiffness } = across;
        let mut whole = Matrix5::zeros();
        whole.fixed_view_mut::<4, 4>(0, 0).copy_from(&tangent);
        whole.fixed_view_mut::<4, 1>(0, 4).copy_from(&coupling);
        whole.fixed_view_mut::<1, 4>(4, 0).copy_from(&coupling.transpose());
        whole[(4, 4)] = stiffness;
        Self { stress: components(&stress, stress_33), tangent: whole, energy, dissipation: 0.0 }
    }
}

/// Takes a response in plane strain, without the out-of-plane parts, which do no work.
impl From<MaterialResponse> for Stretched {
    fn from(MaterialResponse { stress, tangent, energy, dissipation, .. }: MaterialResponse) -> Self {
        Self { dissipation, ..Self::new(stress, tangent, OutOfPlane::default(), energy) }
    }
}

/// A law with an out-of-plane stretch.
pub trait Spatial: Material {
    /// The answer to an increment, as [`Material::respond`], at any F₃₃.
    ///
    /// # Errors
    /// [`MaterialFailure::Inverted`] when det F or F₃₃ is not positive.
    fn stretched(&self, straining: &Straining, new: &mut [f64]) -> Result<Stretched, MaterialFailure>;

    /// ln F₃₃ from which a plate's is searched, F₃₃ in `straining` being of no account: J^(−λ/(λ + 2G)), the solution of Hencky's law.
    ///
    /// # Errors
    /// [`MaterialFailure::Inverted`] when det F is not positive.
    fn ln_free_stretch(&self, straining: &Straining) -> Result<f64, MaterialFailure> {
        let own = self.description();
        Ok(-super::positive_jacobian(&straining.deformation)?.ln() * own.lambda() / own.p_wave_modulus)
    }

    /// σ = P Fᵀ/J where the law remembers `straining.old`.
    ///
    /// # Errors
    /// As [`Spatial::stretched`].
    fn cauchy(&self, straining: &Straining) -> Result<CauchyStress, MaterialFailure> {
        let stress = self.stretched(straining, &mut straining.old.to_vec())?.stress;
        let (f, h) = (&straining.deformation, straining.stretch);
        if self.description().is_linear {
            return Ok(CauchyStress { xx: stress[0], yy: stress[3], zz: stress[4], xy: stress[1] });
        }
        let sigma = plane(&stress) * f.transpose() / (f.determinant() * h);
        Ok(CauchyStress { xx: sigma.m11, yy: sigma.m22, zz: stress[4] / f.determinant(), xy: sigma.m12 })
    }

    /// The answer in plane strain, of which σ_zz = P₃₃/det F.
    ///
    /// # Errors
    /// As [`Spatial::stretched`].
    fn in_plane_strain(&self, straining: &Straining, new: &mut [f64]) -> Result<MaterialResponse, MaterialFailure> {
        let Stretched { stress, tangent, energy, dissipation } = self.stretched(straining, new)?;
        let volume = if self.description().is_linear { 1.0 } else { straining.deformation.determinant() };
        let tangent = tangent.fixed_view::<4, 4>(0, 0).into();
        Ok(MaterialResponse { stress: plane(&stress), tangent, energy, stress_zz: stress[4] / volume, dissipation })
    }

    /// P_v/τ at F and Ḟ, see [`super`]; of a linear law the elastic stress of the rate [F/(L² T)].
    fn viscous(&self, [f, rate]: [&Vector5<f64>; 2]) -> Vector5<f64> {
        let [f, rate] = [f, rate].map(matrix);
        in_five(&match self.description().is_linear {
            true => hooke(self, &rate),
            false => f * hooke(self, &(f.transpose() * rate)),
        })
    }

    /// Variation of P_v/τ with δF and δḞ.
    fn varied_viscous(&self, [f, rate]: [&Vector5<f64>; 2], [df, drate]: [&Vector5<f64>; 2]) -> Vector5<f64> {
        let [f, rate, df, drate] = [f, rate, df, drate].map(matrix);
        in_five(&match self.description().is_linear {
            true => hooke(self, &drate),
            false => {
                let strain = df.transpose() * rate + f.transpose() * drate;
                df * hooke(self, &(f.transpose() * rate)) + f * hooke(self, &strain)
            }
        })
    }
}

/// λ tr(e) 1 + G (e + eᵀ)
fn hooke(law: &(impl Spatial + ?Sized), strain: &Matrix3<f64>) -> Matrix3<f64> {
    let own = law.description();
    Matrix3::from_diagonal_element(own.lambda() * strain.trace()) + own.shear_modulus * (strain + strain.transpose())
}

/// The five components of a tensor, from its part in plane and 33.
pub(crate) fn components(plane: &Matrix2<f64>, across: f64) -> Vector5<f64> {
    Vector5::new(plane.m11, plane.m21, plane.m12, plane.m22, across)
}

/// The part in plane.
pub(crate) fn plane(tensor: &Vector5<f64>) -> Matrix2<f64> {
    Matrix2::new(tensor[0], tensor[2], tensor[1], tensor[3])
}

fn matrix(t: &Vector5<f64>) -> Matrix3<f64> {
    Matrix3::new(t[0], t[2], 0.0, t[1], t[3], 0.0, 0.0, 0.0, t[4])
}

fn in_five(t: &Matrix3<f64>) -> Vector5<f64> {
    Vector5::new(t.m11, t.m21, t.m12, t.m22, t.m33)
}

/// ln h, without losing digits near 1.
pub(super) fn ln_stretch(h: f64) -> f64 {
    if (h - 1.0).abs() < 0.5 { (h - 1.0).ln_1p() } else { h.ln() }
}

/// F₃₃, known to be positive and finite.
pub(super) fn positive_stretch(straining: &Straining) -> Result<f64, MaterialFailure> {
    let h = straining.stretch;
    let jacobian = h * straining.deformation.determinant();
    if h > 0.0 && h.is_finite() { Ok(h) } else { Err(MaterialFailure::Inverted { jacobian }) }
}

/// A law in plane stress: F₃₃ is what leaves no out-of-plane stress.
///
/// ```text
/// τ₃₃ = h P₃₃(F, h) = 0,   h = F₃₃                                            solved for ln h               (1)
/// A = ∂P/∂F − (∂P/∂h)(∂P/∂h)ᵀ / (∂P₃₃/∂h)                                     consistent tangent            (2)
/// ```
/// (1) is solved by Newton's method from h = J^(−λ/(λ + 2G)), which is its solution for Hencky's law, or what a law that yields
/// [remembers](Spatial::ln_free_stretch). Moduli of small strains
/// are those of a plate: the P-wave modulus is E/(1 − ν²) = 4 G (λ + G)/(λ + 2G), so that waves, absorbing sides and penalties are a
/// plate's. The viscous stress is formed with them, too.
///
/// # Errors
/// [`MaterialFailure::Inverted`] when det F is not positive, [`MaterialFailure::NotConverged`] when no h leaves the plate free of
/// stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneStress<L> {
    law: L,
}

/// Most iterations for (1).
const ITERATIONS: usize = 60;

/// Name of the search for the stretch in messages.
const PLATE: &str = "plane_stress";

/// ln h is known to so much; the rest is brought in by the tangent.
const KNOWN: f64 = 1e-13;

impl<L: Spatial> PlaneStress<L> {
    /// A law in plane stress.
    pub fn new(law: L) -> Self {
        Self { law }
    }

    /// h and the answer there.
    fn solved(&self, straining: &Straining, new: &mut [f64]) -> Result<(f64, Stretched), MaterialFailure> {
        let modulus = self.law.description().p_wave_modulus;
        let mut ln_h = self.law.ln_free_stretch(straining)?;
        let mut rest = 0.0;
        for _ in 0..ITERATIONS {
            let h = 1.0 + ln_h.exp_m1();
            let answer = self.law.stretched(&Straining { stretch: h, tangent: true, ..*straining }, new)?;
            let stress = h * answer.stress[4];
            let slope = stress + h * h * answer.tangent[(4, 4)];
            if !(slope > 0.0 && slope.is_finite() && answer.tangent[(4, 4)] > 0.0) {
                return Err(MaterialFailure::NotConverged { law: PLATE, residual: stress / modulus });
            }
            let change = -stress / slope;
            if change.abs() <= KNOWN {
                return Ok((h, answer));
            }
            (ln_h, rest) = (ln_h + change.clamp(-1.0, 1.0), stress);
        }
        Err(MaterialFailure::NotConverged { law: PLATE, residual: rest / modulus })
    }
}

impl<L: Spatial> Material for PlaneStress<L> {
    fn description(&self) -> MaterialDescription<'_> {
        let own = self.law.description();
        let (modulus, shear) = (own.p_wave_modulus, own.shear_modulus);
        MaterialDescription { p_wave_modulus: 4.0 * shear * (modulus - shear) / modulus, is_linear: false, ..own }
    }

    fn initial_state(&self, position: Vector2<f64>, stress: &CauchyStress, variables: &mut [f64]) {
        self.law.initial_state(position, stress, variables);
    }

    fn admits(&self, stress: &CauchyStress) -> Result<(), InadmissibleStress> {
        self.law.admits(stress)
    }

    fn show(&self, straining: &Straining, values: &mut [f64]) -> Result<(), MaterialFailure> {
        let (h, _) = self.solved(straining, &mut straining.old.to_vec())?;
        self.law.show(&Straining { stretch: h, ..*straining }, values)
    }

    fn respond(&self, straining: &Straining, new: &mut [f64]) -> Result<MaterialResponse, MaterialFailure> {
        let (_, Stretched { stress, tangent, energy, dissipation }) = self.solved(straining, new)?;
        let [by_h, of_33]: [Vector4<f64>; 2] =
            [tangent.fixed_view::<4, 1>(0, 4).into(), tangent.fixed_view::<1, 4>(4, 0).transpose()];
        let stiffness = tangent[(4, 4)];
        let rest = by_h * (stress[4] / stiffness);
        Ok(MaterialResponse {
            stress: plane(&stress) - Matrix2::new(rest[0], rest[2], rest[1], rest[3]),
            tangent: tangent.fixed_view::<4, 4>(0, 0) - by_h * of_33.transpose() / stiffness,
            energy,
            stress_zz: 0.0,
            dissipation,
        })
    }

    fn stretch_across(&self, deformation: &Matrix2<f64>, old: &[f64]) -> Result<f64, MaterialFailure> {
        let now = Straining::new(*deformation, old);
        self.solved(&now, &mut old.to_vec()).map(|(h, _)| h)
    }

    fn cauchy_stress(&self, deformation: &Matrix2<f64>, old: &[f64]) -> Result<CauchyStress, MaterialFailure> {
        let now = Straining::new(*deformation, old);
        let (h, answer) = self.solved(&now, &mut old.to_vec())?;
        let sigma = plane(&answer.stress) * deformation.transpose() / (deformation.determinant() * h);
        Ok(CauchyStress { xx: sigma.m11, yy: sigma.m22, zz: 0.0, xy: sigma.m12 })
    }
}
