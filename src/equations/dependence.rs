//! What the tangent of a term depends on.

/// What a tangent depends on while a step lasts; each includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Dependence {
    /// Nothing: it is the same matrix throughout
    Nothing,
    /// Δt
    StepSize,
    /// t, Δt
    Time,
    /// u, t, Δt and the state that the increment begins with
    Displacement,
}
