//! The kind of plane section that the model represents.
//!
//! ```text
//! ∫ f dV = ∫ f w(X) dA,   ∫ f ds = ∫ f w(x) dl,   F = [F_plane, F₃₃]
//! ```
//! | section | w | F₃₃ |
//! |---|---|---|
//! | plane strain | 1 | 1 |
//! | plane stress | t, the undeformed thickness | what leaves σ_zz = 0 |
//! | axisymmetry, x = r, y = z | 2π r | 1 + u_r/R, the hoop stretch |
//!
//! Integrals over reference bodies and edges (stress, masses, dead loads, absorbing sides) take w at the reference position,
//! those over current surfaces (follower pressure, contact) at the current one, which varies: δw = ∂w/∂x·δx. So forces, masses and
//! energies of rings are those of the full turn, and pressures are stresses; on a plate, pressures count the undeformed
//! thickness. Whoever integrates asks here; no element, load or contact has a thickness of its own. Forces at nodes, point masses,
//! springs, dashpots and the areas of contact points are given as a whole.

use std::f64::consts::TAU;
use std::fmt::{Display, Formatter, Result};

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The kind of plane section that the model represents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Section {
    /// A slice of thickness 1 of bodies that are unbounded out of plane: forces, masses and energies per unit of
    /// thickness
    #[default]
    PlaneStrain,
    /// A plate, free of out-of-plane stress: forces, masses and energies of its whole thickness. Pressures and
    /// tractions, those of contact included, count the undeformed thickness
    PlaneStress {
        /// Undeformed thickness, above 0 [L]
        thickness: f64,
    },
    /// Axisymmetric bodies about the axis x = 0: x is the radius and y the axis. Forces, masses and energies are per
    /// full turn, pressures and tractions per area, and zz is the hoop direction. No node may have x < 0, and nodes on
    /// the axis keep ux = 0 automatically. A contact's length is the area of its full turn
    Axisymmetric,
    /// A depth w = `depth` + `slope`·x, F₃₃ = 1. No body has it: it is there for verification, since an integral that forgets
    /// w or ∂w/∂x shows against it
    #[serde(skip)]
    Graded {
        /// w at the origin
        depth: f64,
        /// ∂w/∂x [1/L]
        slope: [f64; 2],
    },
}

impl Section {
    /// w at a place: depth of the bodies there, in the unit of thickness [-].
    pub fn weight(&self, at: Vector2<f64>) -> f64 {
        match self {
            Self::PlaneStrain => 1.0,
            Self::PlaneStress { thickness } => *thickness,
            Self::Axisymmetric => TAU * at.x,
            Self::Graded { depth, slope } => depth + slope[0] * at.x + slope[1] * at.y,
        }
    }

    /// ∂w/∂x at a place; `None` where w is the same everywhere [1/L].
    pub fn slope(&self, _at: Vector2<f64>) -> Option<Vector2<f64>> {
        match self {
            Self::PlaneStrain | Self::PlaneStress { .. } => None,
            Self::Axisymmetric => Some(Vector2::new(TAU, 0.0)),
            Self::Graded { slope, .. } => Some(Vector2::from(*slope)),
        }
    }

    /// Whether bodies are plates, which have no out-of-plane stress.
    pub fn is_plate(&self) -> bool {
        matches!(self, Self::PlaneStress { .. })
    }

    /// Whether bodies are rings, whose hoops stretch when they move along x.
    pub fn is_axisymmetric(&self) -> bool {
        *self == Self::Axisymmetric
    }
}

/// One line: the section, and the unit thickness or turn that forces refer to.
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
