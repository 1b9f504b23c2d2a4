//! Switches of the convergence aids.

/// Convergence aids of the iterations of an increment, all on by default; experiments switch one off to measure its
/// effect. They change the number of iterations, not the equations solved: no accepted residual contains them. Increments without
/// error control grow where few tangents were needed, and are cut where there was no solution: their lengths depend on aids.
///
/// The failure that an aid prevents, and its source, are described in its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Aids {
    /// The start value extrapolates the last increment: [`crate::solve::equilibrium`]
    pub start: bool,
    /// Tractions predicted by the linear solve rotate and stretch with the surface: [`crate::solve::contact_iteration`]
    pub prediction: bool,
    /// At the start of an increment the predicted tractions are limited: [`crate::solve::contact_iteration`]
    pub limit: bool,
    /// Points with a predicted pressure are closed: [`crate::solve::contact_iteration`]
    pub active_set: bool,
    /// At the start of an increment, points that were closed are closed: [`crate::solve::contact_iteration`]
    pub active_set_at_start: bool,
    /// Friction responds to a predicted pressure: [`crate::solve::contact_iteration`]
    pub predicted_pressure: bool,
    /// A zero gap at the start of an increment is taken as closed and sticking: [`crate::solve::contact_iteration`]
    pub touch: bool,
    /// A point whose slip alternates in direction sticks: [`crate::solve::contact_iteration`]
    pub stick: bool,
    /// It is predicted to stick once more if the predicted tractions would have held it: [`crate::solve::contact_iteration`]
    pub stick_again: bool,
    /// A projection that alternates between two segments is placed at their node: [`crate::solve::contact_iteration`]
    pub valley: bool,
    /// Increments of linear bodies are solved on the contact nodes: [`crate::solve::condensed_newton`]
    pub condense: bool,
    /// Factors of an earlier tangent are reused for corrections: [`crate::solve::newton`]
    pub old_tangents: bool,
    /// Line searches limit corrections where the residual stalls: [`crate::solve::newton`]
    pub downhill: bool,
    /// The augmented Lagrangian method raises the penalty where it converges slowly: [`crate::solve::passes`]
    pub stiffening: bool,
    /// A static increment without equilibrium is restarted with softer penalties: [`crate::solve::passes`]
    pub softening: bool,
}

impl Default for Aids {
    fn default() -> Self {
        Self {
            start: true,
            prediction: true,
            limit: true,
            active_set: true,
            active_set_at_start: true,
            predicted_pressure: true,
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
