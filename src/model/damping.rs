//! Damping of bodies.

/// Rayleigh's damping of a body: C = η M + τ K, K being that of [`crate::laws::bulk`]'s viscous stress. A vibration ω of a
/// body that only this damps has the damping ratio ½ (η/ω + τ ω).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damping {
    /// η: share of the masses [1/T]
    pub mass: f64,
    /// τ: share of the stiffness, Kelvin–Voigt's time of retardation [T]
    pub retardation: f64,
}
