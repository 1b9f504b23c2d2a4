//! The terms of the equations.

use super::sums::Dependence;
use super::{contacts, damping, inertia, loads, solids};
use crate::model::{Model, Step};

/// A term of the equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// Stress of the bodies
    Solids,
    /// Contact and friction
    Interfaces,
    /// Loads, springs, initial stress, released supports
    Loads,
    /// Dashpots and absorbing sides
    Dampers,
    /// Stabilizing dashpots of a static step
    Stabilization,
    /// Damping of the bodies
    Damping,
    /// Masses
    Inertia,
}

impl Term {
    /// All terms, in the order in which they are added.
    pub const ALL: [Self; 7] =
        [Self::Solids, Self::Interfaces, Self::Loads, Self::Dampers, Self::Stabilization, Self::Damping, Self::Inertia];

    /// Dependence of its tangent in a step of a model.
    pub fn dependence(self, model: &Model, step: &Step) -> Dependence {
        match self {
            Self::Solids => solids::dependence(model),
            Self::Interfaces => contacts::dependence(model),
            Self::Loads => loads::dependence(step),
            Self::Dampers => damping::damper_dependence(step),
            Self::Stabilization => damping::stabilization_dependence(step),
            Self::Damping => damping::damping_dependence(model, step),
            Self::Inertia => inertia::dependence(step),
        }
    }
}
