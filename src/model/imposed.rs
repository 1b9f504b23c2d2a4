//! What is imposed on bodies: an initial stress, and temperatures.

use nalgebra::Vector2;

use super::boundary::{Amplitude, Profile};

/// Stress of an undeformed body at the start of a run, tension positive, by reference position.
#[derive(Clone, Debug)]
pub enum InitialStress {
    /// Ground at rest under its weight along −y: σ_yy = −γ (y_s − y), and K₀ times that along the other directions
    Geostatic {
        /// y_s: level of the free surface [L]
        surface: f64,
        /// γ: weight per volume [F/L³]
        weight: f64,
        /// K₀: horizontal over vertical stress [-]
        k0: f64,
    },
    /// Any stress
    Components {
        /// σ_xx [F/L²]
        xx: Profile,
        /// σ_yy [F/L²]
        yy: Profile,
        /// σ_xy [F/L²]
        xy: Profile,
        /// σ_zz: across the plane, of rings along the hoops [F/L²]
        zz: Profile,
    },
}

impl InitialStress {
    /// σ_xx, σ_yy, σ_xy, σ_zz at a reference position of a body, which in a plate has none across the plane [F/L²].
    pub fn at(&self, position: Vector2<f64>, in_plate: bool) -> [f64; 4] {
        match self {
            Self::Geostatic { surface, weight, k0 } => {
                let vertical = -weight * (surface - position.y);
                [k0 * vertical, vertical, 0.0, if in_plate { 0.0 } else { k0 * vertical }]
            }
            Self::Components { xx, yy, xy, zz } => [xx, yy, xy, zz].map(|profile| profile.value(position)),
        }
    }
}

/// Thermal expansion of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thermal {
    /// α: strain per temperature [1/Θ]
    pub expansion: f64,
    /// T₀: temperature of the undeformed body without stress [Θ]
    pub reference: f64,
}

/// Temperature of a body over a step.
#[derive(Clone, Debug)]
pub struct Temperature {
    /// number of the body
    pub body: usize,
    /// T [Θ]
    pub amplitude: Amplitude,
}
