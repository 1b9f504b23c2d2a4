//! The terms of the equations.

use super::coupling::Unsymmetric;
use super::sums::Dependence;
use super::{bars, contacts, damping, inertia, links, loads, pore_flow, solids, supports};
use crate::model::{Model, Step};

/// A term of the equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// Stress of the bodies
    Solids,
    /// Water that flows through pores
    PoreFlow,
    /// Contact and friction
    Interfaces,
    /// Trusses and beams
    Bars,
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
    pub const ALL: [Self; 9] = [
        Self::Solids,
        Self::PoreFlow,
        Self::Interfaces,
        Self::Bars,
        Self::Loads,
        Self::Dampers,
        Self::Stabilization,
        Self::Damping,
        Self::Inertia,
    ];

    /// Terms that depend on the displacements only, in every scheme.
    pub const OF_PLACE: &[Self] = Self::ALL.split_at(5).0;

    /// Terms that also depend on velocities, which in implicit schemes follow from the displacements.
    pub const OF_PLACE_AND_MOTION: &[Self] = Self::ALL.split_at(8).0;

    /// Dependence of its tangent in a step of a model.
    pub fn dependence(self, model: &Model, step: &Step) -> Dependence {
        match self {
            Self::Solids => solids::dependence(model),
            Self::PoreFlow => pore_flow::dependence(model),
            Self::Interfaces => contacts::dependence(model),
            Self::Bars => bars::dependence(model),
            Self::Loads => loads::dependence(step),
            Self::Dampers => damping::damper_dependence(step),
            Self::Stabilization => damping::stabilization_dependence(step),
            Self::Damping => damping::damping_dependence(model, step),
            Self::Inertia => inertia::dependence(step),
        }
    }
}

/// Returns where the tangent of a step is unsymmetric apart from contacts, by the terms that add to it; inertia, dashpots and dead loads
/// are symmetric.
pub(super) fn unsymmetric_of(model: &Model, step: &Step) -> Unsymmetric {
    let mut nodes = loads::unsymmetric(step);
    nodes.extend(damping::unsymmetric(model, step));
    let mut around = supports::unsymmetric(step);
    around.extend(links::unsymmetric(model));
    Unsymmetric { nodes, around }
}

/// The same in all steps of a model.
pub(super) fn unsymmetric(model: &Model) -> Unsymmetric {
    let mut all = Unsymmetric { nodes: solids::unsymmetric(model), around: Vec::new() };
    for step in &model.steps {
        let Unsymmetric { nodes, around } = unsymmetric_of(model, step);
        all.nodes.extend(nodes);
        all.around.extend(around);
    }
    all
}
