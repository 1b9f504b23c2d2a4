//! Points of the bodies at which motion, strain and stress are asked for, as a gauge there would read them.

/// A point that moves with a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// its name in results
    pub name: String,
    /// the element it lies in
    pub element: usize,
    /// its coordinates (ξ, η) in it
    pub at: [f64; 2],
}
