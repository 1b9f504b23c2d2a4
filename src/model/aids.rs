//! Switches of what makes iterations converge.

/// Aids of the iterations of an increment, all on unless an experiment asks what one is good for. Where they lead does not
/// depend on them, only how soon: a residual that is accepted knows none of them.
///
/// The failure that an aid prevents, and its source, are described in its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Aids {
    /// An increment starts as the last one went on: [`crate::solve::equilibrium`]
    pub start: bool,
    /// Promised tractions turn and stretch with the surface: [`crate::solve::contact_iteration`]
    pub promise: bool,
    /// At the start of an increment they are limited: [`crate::solve::contact_iteration`]
    pub limit: bool,
    /// Points with a promised pressure are closed: [`crate::solve::contact_iteration`]
    pub keep: bool,
    /// At the start of an increment, points that were closed are: [`crate::solve::contact_iteration`]
    pub pull: bool,
    /// Friction answers to a carried pressure: [`crate::solve::contact_iteration`]
    pub carried: bool,
    /// A point that touches is closed and sticks: [`crate::solve::contact_iteration`]
    pub touch: bool,
    /// A point that slips to and fro sticks: [`crate::solve::contact_iteration`]
    pub stick: bool,
    /// It does so again if it slips for its own error: [`crate::solve::contact_iteration`]
    pub stick_again: bool,
    /// A foot that goes to and fro between two segments lies between them: [`crate::solve::contact_iteration`]
    pub valley: bool,
    /// Increments of linear bodies are solved on the nodes at contacts: [`crate::solve::interface`]
    pub condense: bool,
    /// Corrections with the factors of an earlier tangent: [`crate::solve::newton`]
    pub old_tangents: bool,
    /// Corrections go only downhill where the residual stalls: [`crate::solve::newton`]
    pub downhill: bool,
    /// The augmented Lagrangian stiffens where it is slow: [`crate::solve::equilibrium`]
    pub stiffening: bool,
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
        }
    }
}
