//! What elements ask of a law: its answers at several points, compiled for each law, so that an element calls it once and what it does
//! not want costs nothing.

use nalgebra::{Matrix2, Matrix4, Vector4};
use pulp::{Arch, NullaryFnOnce};

use super::components::{components, moduli, plane, plane_moduli};
use super::{Answer, BulkLaw, BulkResponse, CauchyStress, Sections, Straining};

/// The part of a response in plane, of a body without out-of-plane strain or without out-of-plane stress.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct MaterialResponse {
    /// P: first Piola–Kirchhoff stress, in plane [F/L²]
    pub stress: Matrix2<f64>,
    /// ∂P_iJ/∂F_kL at row i + 2J, column k + 2L (column-major order of the 2×2 matrices) [F/L²]
    pub tangent: Matrix4<f64>,
    /// W: stored energy per reference volume [F/L²]
    pub energy: f64,
    /// Energy dissipated in the increment per reference volume [F/L²]
    pub dissipation: f64,
}

impl MaterialResponse {
    /// P, ∂P/∂F and W of a law without dissipation, unless this field is set.
    pub fn new(stress: Matrix2<f64>, tangent: Matrix4<f64>, energy: f64) -> Self {
        Self { stress, tangent, energy, dissipation: 0.0 }
    }
}

impl From<BulkResponse> for MaterialResponse {
    #[inline(always)]
    fn from(BulkResponse { stress, tangent, energy, dissipation, .. }: BulkResponse) -> Self {
        Self { stress: plane(&stress), tangent: plane_moduli(&tangent), energy, dissipation }
    }
}

/// Without the out-of-plane parts, which do no work in plane strain.
impl From<MaterialResponse> for BulkResponse {
    fn from(MaterialResponse { stress, tangent, energy, dissipation }: MaterialResponse) -> Self {
        let none = Vector4::zeros();
        Self { dissipation, ..Self::new(components(&stress, 0.0), moduli(&tangent, &none, &none, 0.0), energy) }
    }
}

/// A bulk law as bodies have it: every [`BulkLaw`] is one, and none is written otherwise.
pub trait Material: BulkLaw {
    /// The answers to an increment with F₃₃ = 1 at several points, whose variables stand one behind the other.
    ///
    /// # Errors
    /// As [`BulkLaw::respond`].
    fn in_plane(&self, strainings: &[Straining], new: &mut [f64], responses: &mut [MaterialResponse]) -> Answer<()> {
        match strainings.iter().any(|straining| straining.tangent) {
            true => Arch::new().dispatch(InPlane::<_, true> { law: self, strainings, new, responses }),
            false => Arch::new().dispatch(InPlane::<_, false> { law: self, strainings, new, responses }),
        }
    }

    /// The answer to an increment at any F₃₃.
    ///
    /// # Errors
    /// As [`BulkLaw::respond`].
    fn in_space(&self, straining: &Straining, new: &mut [f64]) -> Answer {
        match straining.tangent {
            true => Arch::new().dispatch(InSpace::<_, true> { law: self, straining, new }),
            false => Arch::new().dispatch(InSpace::<_, false> { law: self, straining, new }),
        }
    }

    /// The answer in plane at once, of a body that has not been strained before.
    ///
    /// # Errors
    /// As [`BulkLaw::respond`].
    fn at_once(&self, deformation: &Matrix2<f64>) -> Answer<MaterialResponse> {
        let old = vec![0.0; self.description().variables.len()];
        self.respond(&Straining::new(*deformation, &old), &mut old.clone()).map(MaterialResponse::from)
    }

    /// P at once times the volume at several points, written over `stresses`; returns ∫ W dV.
    ///
    /// # Errors
    /// As [`BulkLaw::respond`].
    fn stresses(&self, deformations: &[Matrix2<f64>], volumes: &[f64], stresses: &mut [Matrix2<f64>]) -> Answer<f64> {
        let old = vec![0.0; self.description().variables.len()];
        let (mut new, mut energy) = (old.clone(), 0.0);
        for ((deformation, &volume), stress) in deformations.iter().zip(volumes).zip(stresses) {
            let straining = Straining { tangent: false, ..Straining::new(*deformation, &old) };
            let answer = self.respond(&straining, &mut new)?;
            *stress = volume * plane(&answer.stress);
            energy += volume * answer.energy;
        }
        Ok(energy)
    }

    /// F₃₃ where the law remembers `straining.old`: that of the thickness in a plate.
    ///
    /// # Errors
    /// As [`BulkLaw::respond`].
    fn stretch_across(&self, straining: &Straining) -> Answer<f64> {
        if self.description().sections != Sections::Plate {
            return Ok(straining.stretch);
        }
        let answer = self.respond(straining, &mut straining.old.to_vec())?;
        Ok(answer.free_stretch.unwrap_or(straining.stretch))
    }

    /// σ = P Fᵀ / J where the law remembers `straining.old`; of a linear law P.
    ///
    /// # Errors
    /// As [`BulkLaw::respond`].
    fn cauchy_stress(&self, straining: &Straining) -> Answer<CauchyStress> {
        let BulkResponse { stress, free_stretch, .. } = self.respond(straining, &mut straining.old.to_vec())?;
        if self.description().is_linear {
            return Ok(CauchyStress { xx: stress[0], yy: stress[3], zz: stress[4], xy: stress[1] });
        }
        let (f, h) = (&straining.deformation, free_stretch.unwrap_or(straining.stretch));
        let sigma = plane(&stress) * f.transpose() / (f.determinant() * h);
        Ok(CauchyStress { xx: sigma.m11, yy: sigma.m22, zz: stress[4] / f.determinant(), xy: sigma.m12 })
    }
}

impl<L: BulkLaw> Material for L {}

impl<L: BulkLaw + 'static> From<L> for Box<dyn Material> {
    fn from(law: L) -> Self {
        Box::new(law)
    }
}

/// An increment at some points in plane strain. It is compiled for vectors as long as the processor has them, and with tangents and
/// without, so that those that are not wanted cost nothing.
struct InPlane<'a, L: ?Sized, const TANGENT: bool> {
    law: &'a L,
    strainings: &'a [Straining<'a>],
    new: &'a mut [f64],
    responses: &'a mut [MaterialResponse],
}

impl<L: BulkLaw + ?Sized, const TANGENT: bool> NullaryFnOnce for InPlane<'_, L, TANGENT> {
    type Output = Answer<()>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { law, strainings, new, responses } = self;
        let count = new.len() / strainings.len();
        for (k, (straining, response)) in strainings.iter().zip(responses).enumerate() {
            // 1 is written out, so that products with it are known as such.
            let straining = Straining { stretch: 1.0, tangent: TANGENT, ..*straining };
            let answer = law.respond(&straining, &mut new[k * count..(k + 1) * count])?;
            response.stress = plane(&answer.stress);
            (response.energy, response.dissipation) = (answer.energy, answer.dissipation);
            if TANGENT {
                response.tangent = plane_moduli(&answer.tangent);
            }
        }
        Ok(())
    }
}

/// An increment at a point with an out-of-plane stretch, compiled alike.
struct InSpace<'a, L: ?Sized, const TANGENT: bool> {
    law: &'a L,
    straining: &'a Straining<'a>,
    new: &'a mut [f64],
}

impl<L: BulkLaw + ?Sized, const TANGENT: bool> NullaryFnOnce for InSpace<'_, L, TANGENT> {
    type Output = Answer;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { law, straining, new } = self;
        law.respond(&Straining { tangent: TANGENT, ..*straining }, new)
    }
}
