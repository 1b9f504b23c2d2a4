//! What the plane stands for in space.
//!
//! ```text
//! ∫ f dV = ∫ f w(X) dA,   ∫ f ds = ∫ f w(x) dl,   F = [F_plane, F₃₃]
//! ```
//! Integrals over reference bodies and edges (stress, masses, dead loads, absorbing sides) take w at the reference position,
//! those over current surfaces (follower pressure, contact) at the current one, which varies: δw = ∂w/∂x·δx. Whoever
//! integrates asks here; no element, load or contact has a thickness of its own. Point masses, springs, dashpots and the
//! areas of contact points are given as a whole.

use nalgebra::Vector2;

/// The section of a model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Section {
    /// Plane strain: a slice of depth 1 of bodies that go on without end; w = 1, F₃₃ = 1
    #[default]
    PlaneStrain,
    /// A depth w = `depth` + `slope`·x, F₃₃ = 1. No body has it: it is there for verification, since an integral that forgets
    /// w or ∂w/∂x shows against it
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
            Self::Graded { depth, slope } => depth + slope[0] * at.x + slope[1] * at.y,
        }
    }

    /// ∂w/∂x at a place; `None` where w is the same everywhere [1/L].
    pub fn slope(&self, _at: Vector2<f64>) -> Option<Vector2<f64>> {
        match self {
            Self::PlaneStrain => None,
            Self::Graded { slope, .. } => Some(Vector2::from(*slope)),
        }
    }

    /// F₃₃: stretch across the plane [-].
    pub fn stretch(&self) -> f64 {
        match self {
            Self::PlaneStrain | Self::Graded { .. } => 1.0,
        }
    }
}
