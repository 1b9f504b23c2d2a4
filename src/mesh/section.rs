//! Kind of plane section represented by the model.
//!
//! ```text
//! ∫ f dV = ∫ f w(X) dA,   ∫ f ds = ∫ f w(x) dl,   F = [F_plane, F₃₃]
//! ```
//! | section | w | F₃₃ |
//! |---|---|---|
//! | plane strain | 1 | 1 |
//! | plane stress | t, the undeformed thickness | from σ_zz = 0 |
//! | axisymmetry, x = r, y = z | 2π r | 1 + u_r/R, the hoop stretch |
//!
//! Integrals over reference bodies and edges (stress, masses, dead loads, absorbing sides) use w at the reference position,
//! those over current surfaces (follower pressure, contact) w at the current one, with the variation δw = ∂w/∂x·δx. Forces,
//! masses and energies of axisymmetric bodies therefore refer to the full turn, and pressures are stresses; in plane stress,
//! pressures refer to the undeformed thickness. All integrals obtain w here; no element, load or contact has a thickness of its
//! own. Nodal forces, point masses, springs, dashpots and the areas of contact points are given as totals.

use std::f64::consts::TAU;
use std::fmt::{Display, Formatter, Result};

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Kind of plane section represented by the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Section {
    /// A slice of thickness 1 of bodies that are unbounded out of plane: forces, masses and energies are per unit
    /// thickness
    #[default]
    PlaneStrain,
    /// A plate without out-of-plane stress: forces, masses and energies refer to the whole thickness. Pressures and
    /// tractions, including those of contact, refer to the undeformed thickness
    PlaneStress {
        /// Undeformed thickness, above 0 [L]
        thickness: f64,
    },
    /// Axisymmetric bodies about the axis x = 0: x is the radius and y the axis. Forces, masses and energies are per
    /// full turn, pressures and tractions per area, and zz is the hoop direction. No node may have x < 0, and nodes on
    /// the axis keep ux = 0 automatically. A contact's length is the area of its full turn
    Axisymmetric,
    /// A depth w = `depth` + `slope`·x, F₃₃ = 1, for verification only: it exposes an integral that omits w or ∂w/∂x
    #[serde(skip)]
    Graded {
        /// w at the origin
        depth: f64,
        /// ∂w/∂x [1/L]
        slope: [f64; 2],
    },
}

impl Section {
    /// w at a position: depth of the bodies relative to unit thickness [-].
    pub fn weight(&self, at: Vector2<f64>) -> f64 {
        match self {
            Self::PlaneStrain => 1.0,
            Self::PlaneStress { thickness } => *thickness,
            Self::Axisymmetric => TAU * at.x,
            Self::Graded { depth, slope } => depth + slope[0] * at.x + slope[1] * at.y,
        }
    }

    /// ∂w/∂x at a position; `None` where w is constant [1/L].
    pub fn slope(&self, _at: Vector2<f64>) -> Option<Vector2<f64>> {
        match self {
            Self::PlaneStrain | Self::PlaneStress { .. } => None,
            Self::Axisymmetric => Some(Vector2::new(TAU, 0.0)),
            Self::Graded { slope, .. } => Some(Vector2::from(*slope)),
        }
    }

    /// Whether the bodies are plates, without out-of-plane stress.
    pub fn is_plate(&self) -> bool {
        matches!(self, Self::PlaneStress { .. })
    }

    /// Whether the bodies are axisymmetric, with hoop strain u_x/x.
    pub fn is_axisymmetric(&self) -> bool {
        *self == Self::Axisymmetric
    }
}

/// Describes the section in one line, with the unit thickness or full turn that forces refer to.
impl Display for Section {
    fn fmt(&self, f: &mut Formatter) -> Result {
        match self {
            Self::PlaneStrain => write!(f, "plane strain: forces and energies per unit of thickness"),
            Self::PlaneStress { thickness } => {
                write!(f, "plane stress: forces and energies of the thickness {thickness}")
            }
            Self::Axisymmetric => {
                write!(
                    f,
                    "axisymmetric, x = r and y = z: forces and energies per full turn; zz is the hoop direction; ux = 0 on the axis"
                )
            }
            Self::Graded { .. } => write!(f, "a depth that varies"),
        }
    }
}
