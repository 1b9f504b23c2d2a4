//! The material as the case file writes it, and the checks of its constants.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    CamClay, CamClayParameters, DruckerPrager, DruckerPragerParameters, Hencky, Linear, Material, MaterialDescription,
    MohrCoulomb, MohrCoulombParameters, NeoHookean, SaintVenantKirchhoff, SysCamClay, SysCamClayParameters,
    Viscoelastic, ViscoelasticConstants, VonMises, VonMisesParameters,
};
use crate::laws::parameter::{InvalidParameter, require, require_not_negative, require_positive};

/// A bulk material: its law and its constants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "model", rename_all = "snake_case")]
#[non_exhaustive]
pub enum MaterialParameters {
    /// Linear elasticity: small strains and rotations only
    Linear(ElasticConstants),
    /// Saint Venant–Kirchhoff: linear in the Green strain; large rotations, moderate strains
    SaintVenantKirchhoff(ElasticConstants),
    /// Compressible neo-Hookean: large strains
    NeoHookean(ElasticConstants),
    /// Hencky: linear in the logarithmic strain; large rotations, moderate strains
    Hencky(ElasticConstants),
    /// Neo-Hookean in parallel with a Maxwell arm: relaxes from E + E_1 to E within some tau
    Viscoelastic(ViscoelasticConstants),
    /// Von Mises: metals, and clay that is sheared undrained; isotropic and kinematic hardening, large strains
    VonMises(VonMisesParameters),
    /// Drucker–Prager: a cone that stands for friction and cohesion of soil, perfectly plastic, large strains
    DruckerPrager(DruckerPragerParameters),
    /// Mohr–Coulomb: friction, cohesion, dilation and tension cut-off of soil and rock, which may soften; large strains
    MohrCoulomb(MohrCoulombParameters),
    /// Modified Cam-clay: clay, whose stiffness and strength grow with its pressure, and which hardens and softens with its volume; needs an
    /// initial_stress, large strains
    CamClay(CamClayParameters),
    /// SYS Cam-clay, experimental: modified Cam-clay of soil with structure, overconsolidation and anisotropy, which it loses as it yields; needs an
    /// initial_stress, large strains
    SysCamClay(SysCamClayParameters),
}

/// Constants of an isotropic elastic material.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct ElasticConstants {
    /// E: Young's modulus, E > 0 [F/L²]
    #[serde(rename = "E")]
    pub young: f64,
    /// ν: Poisson's ratio, −1 < ν < 0.5 [-]
    #[serde(rename = "nu")]
    pub poisson: f64,
    /// ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
    #[serde(default)]
    pub density: f64,
}

/// λ and G: the constants in which the laws are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lame {
    /// λ = E ν / ((1 + ν)(1 − 2ν)) [F/L²]
    pub lambda: f64,
    /// G = E / (2 (1 + ν)): shear modulus [F/L²]
    pub shear: f64,
}

impl MaterialParameters {
    /// The law with its constants checked.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a constant is out of its range.
    pub fn build(&self) -> Result<Box<dyn Material>, InvalidParameter> {
        Ok(match self {
            Self::Linear(constants) => Box::new(Linear::new(constants)?),
            Self::SaintVenantKirchhoff(constants) => Box::new(SaintVenantKirchhoff::new(constants)?),
            Self::NeoHookean(constants) => Box::new(NeoHookean::new(constants)?),
            Self::Hencky(constants) => Box::new(Hencky::new(constants)?),
            Self::Viscoelastic(constants) => Box::new(Viscoelastic::new(constants)?),
            Self::VonMises(parameters) => Box::new(VonMises::new(parameters)?),
            Self::DruckerPrager(parameters) => Box::new(DruckerPrager::new(parameters)?),
            Self::MohrCoulomb(parameters) => Box::new(MohrCoulomb::new(parameters)?),
            Self::CamClay(parameters) => Box::new(CamClay::new(parameters)?),
            Self::SysCamClay(parameters) => Box::new(SysCamClay::new(parameters)?),
        })
    }
}

impl ElasticConstants {
    /// Creates the constants of a body without mass.
    pub const fn new(young: f64, poisson: f64) -> Self {
        Self { young, poisson, density: 0.0 }
    }

    /// λ and G, once all constants are found to be allowed.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a constant is out of its range.
    pub fn lame(&self) -> Result<Lame, InvalidParameter> {
        let Self { young, poisson, density } = *self;
        require_positive("E", young)?;
        let incompressible = "it must be less than 0.5: an incompressible material is not possible in this formulation; \
                              use 0.49 with \"element\": \"f_bar\"";
        require("nu", poisson, poisson < 0.5, incompressible)?;
        require("nu", poisson, poisson > -1.0, "it must be greater than -1 and less than 0.5")?;
        require_not_negative("density", density)?;
        Ok(Lame {
            lambda: young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
            shear: young / (2.0 * (1.0 + poisson)),
        })
    }
}

setters! { const constants: ElasticConstants;
    /// Sets the density [M/L³].
    density(density: f64) { constants.density = density; }
}

impl Lame {
    /// λ + 2G: constrained modulus, stress per uniaxial strain [F/L²]
    pub fn constrained_modulus(&self) -> f64 {
        self.lambda + 2.0 * self.shear
    }

    /// Describes an elastic law with these constants and a density [M/L³].
    pub(crate) fn description(&self, density: f64) -> MaterialDescription<'static> {
        MaterialDescription::new(density, self.constrained_modulus(), self.shear)
    }
}
