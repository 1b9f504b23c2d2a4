//! Switches of the convergence aids.

/// Convergence aids of the iterations of an increment, all on by default; experiments switch one off to measure its
/// effect. They change the number of iterations, not the solution: no accepted residual contains them.
///
/// The failure that an aid prevents, and its source, are described in its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Aids {
    /// The start value extrapolates the last increment: [`crate::solve::equilibrium`]
    pub start: bool,
    /// Tractions predicted by the linear solve rotate and stretch with the surface: [`crate::solve::contact_iteration`]
    pub promise: bool,
    /// At the start of an increment the predicted tractions are limited: [`crate::solve::contact_iteration`]
    pub limit: bool,
    /// Points with a predicted pressure are closed: [`crate::solve::contact_iteration`]
    pub keep: bool,
    /// At the start of an increment, points that were closed are closed: [`crate::solve::contact_iteration`]
    pub pull: bool,
    /// Friction responds to a carried pressure: [`crate::solve::contact_iteration`]
    pub carried: bool,
    /// A point that just closes is taken as closed and sticking: [`crate::solve::contact_iteration`]
    pub touch: bool,
    /// A point whose slip alternates in direction sticks: [`crate::solve::contact_iteration`]
    pub stick: bool,
    /// It does so again if it slips for its own error: [`crate::solve::contact_iteration`]
    pub stick_again: bool,
    /// A projection that alternates between two segments is put between them: [`crate::solve::contact_iteration`]
    pub valley: bool,
    /// Increments of linear bodies are solved on the nodes at contacts: [`crate::solve::interface`]
    pub condense: bool,
    /// Corrections with the factors of an earlier tangent: [`crate::solve::newton`]
    pub old_tangents: bool,
    /// Corrections go only downhill where the residual stalls: [`crate::solve::newton`]
    pub downhill: bool,
    /// The augmented Lagrangian stiffens where it is slow: [`crate::solve::equilibrium`]
    pub stiffening: bool,
    /// A static increment that is not solved starts anew from softer penalties: [`crate::solve::equilibrium`]
    pub softening: bool,
}

impl Default for Aids {
    fn default() -> Self {
        Self {
            start: true,
            promise: true,
            limit: true,
            keep: true,
            pull: true,
            carried: true,
            touch: true,
            stick: true,
            stick_again: true,
            valley: true,
            condense: true,
            old_tangents: true,
            downhill: true,
            stiffening: true,
            softening: true,
        }
    }
}
