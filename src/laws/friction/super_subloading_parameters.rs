//! What a case may say of super/subloading friction.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Approach;
use super::peak::Integration;

/// Parameters of [`SuperSubloading`](super::SuperSubloading) as the case file writes them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SuperSubloadingParameters {
    /// μ_s: static friction coefficient, μ_s ≥ μ_k [-]
    pub mu_s: f64,
    /// μ_k: kinetic friction coefficient, μ_k > 0 [-]
    pub mu_k: f64,
    /// α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies [F/L³]
    #[serde(default)]
    pub alpha_t: Option<f64>,
    /// r: rate at which R approaches 1 with plastic slip, r > 0 [1/L]
    pub r: f64,
    /// κ: loss of structure with plastic slip, κ ≥ 0 [1/L]
    #[serde(default)]
    pub kappa: f64,
    /// ξ: recovery of structure with time, ξ ≥ 0 [1/T]
    #[serde(default)]
    pub xi: f64,
    /// m: exponent of the loss, m > 0 [-]
    #[serde(default = "one")]
    pub m: f64,
    /// n: exponent of the recovery, n > 0 [-]
    #[serde(default = "one")]
    pub n: f64,
    /// 1/R*₀: structure at first touch, from 1 (μ = μ_k) to μ_s/μ_k (μ = μ_s, the default) [-]
    #[serde(default)]
    pub structure: Option<f64>,
    /// U(R): how R approaches 1
    #[serde(default)]
    pub approach: Approach,
    /// R_e: elastic core, no plastic slip for R ≤ R_e, 0 ≤ R_e < 1 [-]
    #[serde(default)]
    pub elastic_core: f64,
    /// How an increment is integrated
    #[serde(default)]
    pub integration: Integration,
    /// Error allowed to the controlled integration, as a share of μ_s p, from 1e-12 to 0.1; 1e-6 by default [-]
    #[serde(default)]
    pub tolerance: Option<f64>,
}

impl SuperSubloadingParameters {
    /// Neither weakening nor recovery, the tangential stiffness left to the contact, all else as in a case that says no more.
    pub fn new(mu_s: f64, mu_k: f64, r: f64) -> Self {
        Self {
            mu_s,
            mu_k,
            alpha_t: None,
            r,
            kappa: 0.0,
            xi: 0.0,
            m: one(),
            n: one(),
            structure: None,
            approach: Approach::default(),
            elastic_core: 0.0,
            integration: Integration::default(),
            tolerance: None,
        }
    }
}

fn one() -> f64 {
    1.0
}
