//! Bodies that are stressed before anything moves them, and bodies that expand when they are heated.

use std::sync::Arc;

use nalgebra::{Matrix2, Matrix4, Vector2};

use super::spatial::{OutOfPlane, plane};
use super::{
    CauchyStress, InadmissibleStress, Material, MaterialDescription, MaterialFailure, MaterialResponse, PlaneStress,
    Spatial, Straining, Stretched,
};

/// Names of the initial stress among the variables of a law.
pub const INITIAL_STRESS: [&str; 4] = ["initial_xx", "initial_yy", "initial_xy", "initial_zz"];

/// Names of T − T₀ and of −∂W/∂ϑ among the variables of a law, the last ones.
pub const TEMPERATURE: [&str; 2] = ["temperature_rise", "expansion_stress"];

/// A law under what is imposed on it: an initial stress σ₀, and a temperature T.
///
/// ```text
/// F = ϑ F_e,   ϑ = 1 + α (T − T₀)                                                                            (1)
/// W = ϑ³ (W_l(F_e) + σ₀:E_e),   E_e = ½ (F_eᵀF_e − 1)                                                        (2)
/// P = ϑ² (P_l(F_e) + F_e σ₀),   ∂P_iJ/∂F_kL = ϑ (∂P_l,iJ/∂F_kL + δ_ik σ₀,JL)                                 (3)
/// −∂W/∂ϑ = (P:F − 3W)/ϑ                                          expansion stress, tr σ at small strains      (4)
/// ```
/// F, P and W are those of the unheated, undeformed body, whose stress is σ₀ as it is given. It turns with the body: σ₀ is a
/// constant second Piola–Kirchhoff stress beside that of the law, and δ_ik σ₀ its geometric stiffness. All tensors are those in
/// space, F₃₃ = 1 in plane strain. A [linear](MaterialDescription::is_linear) law adds small strains, and no rotation matters:
///
/// ```text
/// ε_e = ε − α (T − T₀) 1,   W = W_l(ε_e) + σ₀:ε_e,   σ = σ_l(ε_e) + σ₀,   −∂W/∂ϑ = tr σ                       (5)
/// ```
/// The initial stress stands among the variables from the start. [`Material::respond`] finds T − T₀ at the end of the increment
/// in the new variables, which the caller writes there.
///
/// # Errors
/// [`MaterialFailure::Inverted`] of the law at F_e, and when ϑ is not positive.
///
/// Source: Lu & Pister (1975), Int. J. Solids Struct. 11, 927, doi:10.1016/0020-7683(75)90015-3 (the split of F).
#[derive(Clone, Debug)]
pub struct Imposed {
    law: Arc<dyn Material>,
    /// A linear law in plane stress, whose out-of-plane stretch is not evaluated
    flat: bool,
    stressed: bool,
    /// α [1/Θ]
    expansion: Option<f64>,
    names: Vec<&'static str>,
}

impl Imposed {
    /// A law in a body with an initial stress, or with an expansion α when it is heated, or both; `None` if it does not
    /// know an out-of-plane stretch.
    pub fn new(law: impl Into<Arc<dyn Material>>, stressed: bool, expansion: Option<f64>) -> Option<Self> {
        let law = law.into();
        law.spatial()?;
        Some(Self::of(law, false, stressed, expansion))
    }

    fn of(law: Arc<dyn Material>, flat: bool, stressed: bool, expansion: Option<f64>) -> Self {
        let mut names = law.description().variables.to_vec();
        names.extend(INITIAL_STRESS.iter().filter(|_| stressed));
        names.extend(TEMPERATURE.iter().filter(|_| expansion.is_some()));
        Self { law, flat, stressed, expansion, names }
    }

    /// α (T − T₀) of some variables.
    fn thermal_strain(&self, variables: &[f64]) -> f64 {
        self.expansion.map_or(0.0, |alpha| alpha * variables[variables.len() - TEMPERATURE.len()])
    }

    /// F and F₃₃ of the underlying law, without the thermal strain.
    fn elastic<'a>(&self, straining: &Straining<'a>, strain: f64) -> Straining<'a> {
        let Straining { deformation, stretch, .. } = *straining;
        let own = self.law.description();
        let old = &straining.old[..own.variables.len()];
        match own.is_linear {
            true => Straining {
                deformation: deformation - Matrix2::from_diagonal_element(strain),
                stretch: stretch - strain,
                old,
                ..*straining
            },
            false => {
                let theta = 1.0 + strain;
                Straining { deformation: deformation / theta, stretch: stretch / theta, old, ..*straining }
            }
        }
    }

    /// The law's own answer.
    fn answer(&self, elastic: &Straining, new: &mut [f64]) -> Result<Stretched, MaterialFailure> {
        match self.law.spatial().filter(|_| !self.flat) {
            Some(law) => law.stretched(elastic, new),
            None => {
                let MaterialResponse { stress, tangent, energy, dissipation, .. } = self.law.respond(elastic, new)?;
                Ok(Stretched { dissipation, ..Stretched::new(stress, tangent, OutOfPlane::default(), energy) })
            }
        }
    }

    /// The initial stress, which stays as it is.
    fn initial(&self, old: &[f64], new: &mut [f64]) -> Option<InitialStress> {
        let own = self.law.description().variables.len();
        let own = own..own + INITIAL_STRESS.len();
        self.stressed.then(|| {
            new[own.clone()].copy_from_slice(&old[own.clone()]);
            let [xx, yy, xy, zz] = [0, 1, 2, 3].map(|k| old[own.start + k]);
            InitialStress { plane: Matrix2::new(xx, xy, xy, yy), across: zz }
        })
    }
}

/// σ₀ [F/L²]
struct InitialStress {
    plane: Matrix2<f64>,
    /// σ₀,zz
    across: f64,
}

/// Adds the stress, tangent and energy of an initial stress.
fn add_initial(answer: &mut Stretched, elastic: &Straining, initial: &InitialStress, linear: bool) {
    let InitialStress { plane, across } = *initial;
    let (f, h) = (elastic.deformation, elastic.stretch);
    let strain = match linear {
        true => 0.5 * (f + f.transpose()) - Matrix2::identity(),
        false => {
            let d = f - Matrix2::identity();
            0.5 * (d + d.transpose() + d.transpose() * d)
        }
    };
    let strain_across = if linear { h - 1.0 } else { 0.5 * (h - 1.0) * (h + 1.0) };
    answer.energy += plane.dot(&strain) + across * strain_across;
    let stress = if linear { plane } else { f * plane };
    for (sum, stress) in answer.stress.iter_mut().zip(stress.iter().chain([&if linear { across } else { h * across }]))
    {
        *sum += stress;
    }
    if linear {
        return;
    }
    let mut geometric = Matrix4::zeros();
    for (j, l, i) in [(0, 0), (0, 1), (1, 0), (1, 1)].into_iter().flat_map(|(j, l)| [(j, l, 0), (j, l, 1)]) {
        geometric[(i + 2 * j, i + 2 * l)] = plane[(j, l)];
    }
    let mut own = answer.tangent.fixed_view_mut::<4, 4>(0, 0);
    own += geometric;
    answer.tangent[(4, 4)] += across;
}

impl Spatial for Imposed {
    /// h = ϑ h_e
    fn ln_free_stretch(&self, straining: &Straining) -> Result<f64, MaterialFailure> {
        let strain = self.thermal_strain(straining.old);
        let elastic = self.elastic(straining, strain);
        let own = self.law.spatial().map_or(Ok(0.0), |law| law.ln_free_stretch(&elastic))?;
        Ok(own + if self.law.description().is_linear { 0.0 } else { strain.ln_1p() })
    }

    fn stretched(&self, straining: &Straining, new: &mut [f64]) -> Result<Stretched, MaterialFailure> {
        let heat = self.names.len().saturating_sub(TEMPERATURE.len());
        let strain = self.thermal_strain(new);
        let theta = 1.0 + strain;
        if theta.is_nan() || theta <= 0.0 {
            return Err(MaterialFailure::Inverted { jacobian: theta });
        }
        let (elastic, linear) = (self.elastic(straining, strain), self.law.description().is_linear);
        let mut answer = self.answer(&elastic, &mut new[..elastic.old.len()])?;
        if let Some(initial) = self.initial(straining.old, new) {
            add_initial(&mut answer, &elastic, &initial, linear);
        }
        if self.expansion.is_none() {
            return Ok(answer);
        }
        if linear {
            new[heat + 1] = answer.stress[0] + answer.stress[3] + answer.stress[4];
            return Ok(answer);
        }
        answer.stress *= theta * theta;
        answer.tangent *= theta;
        answer.energy *= theta.powi(3);
        let before = 1.0 + self.thermal_strain(straining.old);
        answer.dissipation *= 0.5 * (before.powi(3) + theta.powi(3));
        let work = plane(&answer.stress).dot(&straining.deformation) + answer.stress[4] * straining.stretch;
        new[heat + 1] = (work - 3.0 * answer.energy) / theta;
        Ok(answer)
    }
}

impl Material for Imposed {
    fn description(&self) -> MaterialDescription<'_> {
        let own = self.law.description();
        MaterialDescription { variables: &self.names, evolves: own.evolves || self.expansion.is_some(), ..own }
    }

    fn plane_stress(&self) -> Option<Box<dyn Material>> {
        match self.law.description().is_linear {
            true => Some(Box::new(Self::of(self.law.plane_stress()?.into(), true, self.stressed, self.expansion))),
            false => Some(Box::new(PlaneStress::new(self.clone()))),
        }
    }

    fn stretch_across(&self, deformation: &Matrix2<f64>, old: &[f64]) -> Result<f64, MaterialFailure> {
        if !self.flat {
            return Ok(1.0);
        }
        let heat = self.names.len().saturating_sub(TEMPERATURE.len());
        let strain = self.expansion.map_or(0.0, |alpha| alpha * old[heat]);
        let elastic = self.elastic(&Straining::new(*deformation, old), strain);
        self.law.stretch_across(&elastic.deformation, elastic.old).map(|own| own + strain)
    }

    fn spatial(&self) -> Option<&dyn Spatial> {
        (!self.flat).then_some(self)
    }

    /// The initial stress, and the expansion stress that it is.
    fn initial_state(&self, position: Vector2<f64>, stress: &CauchyStress, variables: &mut [f64]) {
        let own = self.law.description().variables.len();
        self.law.initial_state(position, stress, &mut variables[..own]);
        let CauchyStress { xx, yy, zz, xy } = *stress;
        if self.stressed {
            variables[own..own + INITIAL_STRESS.len()].copy_from_slice(&[xx, yy, xy, zz]);
        }
        if self.expansion.is_some() && (self.stressed || self.law.description().holds_initial_stress) {
            variables[self.names.len() - 1] = xx + yy + zz;
        }
    }

    fn at_pressure(&self, pressure: f64) -> Option<Arc<dyn Material>> {
        Some(Arc::new(Self { law: self.law.at_pressure(pressure)?, ..self.clone() }))
    }

    fn admits(&self, stress: &CauchyStress) -> Result<(), InadmissibleStress> {
        self.law.admits(stress)
    }

    fn show(&self, straining: &Straining, values: &mut [f64]) -> Result<(), MaterialFailure> {
        self.law.show(&self.elastic(straining, self.thermal_strain(straining.old)), values)
    }

    fn respond(&self, straining: &Straining, new: &mut [f64]) -> Result<MaterialResponse, MaterialFailure> {
        self.in_plane_strain(straining, new)
    }

    fn viscous_stress(&self, motion: [&Matrix2<f64>; 2]) -> Matrix2<f64> {
        self.law.viscous_stress(motion)
    }

    fn viscous_variation(&self, motion: [&Matrix2<f64>; 2], varied: [&Matrix2<f64>; 2]) -> Matrix2<f64> {
        self.law.viscous_variation(motion, varied)
    }

    fn cauchy_stress(&self, deformation: &Matrix2<f64>, old: &[f64]) -> Result<CauchyStress, MaterialFailure> {
        self.cauchy(&Straining::new(*deformation, old))
    }
}
