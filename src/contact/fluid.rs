//! A fluid between the surfaces of a contact, which pushes them apart.
//!
//! ```text
//! p_total = p + p_w        p: what the surfaces themselves carry (penalty or multiplier), under which friction answers
//! f_a = −w_a p_w n ℓ       beside that of p and q, wherever the master faces the point, closed or open
//! ```
//!
//! p_w is given, by the reference position of a slave point and the time: the fluid does not flow. That friction knows the
//! effective pressure p alone is the principle of effective stress (K. Terzaghi, Theoretical Soil Mechanics, 1943, §6).
//! Where p_w exceeds what the bodies press with, the surfaces open and the fluid goes on pushing, which makes nothing jump
//! there. Its work is that of a load.

use std::fmt;

use nalgebra::Vector2;

/// p_w by reference position and time [F/L²].
pub type PressureAt = dyn Fn(Vector2<f64>, f64) -> f64 + Send + Sync;

/// Pressure of the fluid in a contact.
pub struct Fluid(Box<PressureAt>);

impl Fluid {
    /// Of a pressure p_w ≥ 0 by reference position and time.
    pub fn new(pressure: impl Fn(Vector2<f64>, f64) -> f64 + Send + Sync + 'static) -> Self {
        Self(Box::new(pressure))
    }

    /// p_w at a reference position [F/L²]
    pub fn pressure(&self, at: Vector2<f64>, time: f64) -> f64 {
        (self.0)(at, time)
    }
}

impl fmt::Debug for Fluid {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a fluid")
    }
}

/// Where a fluid has no pressure that it could have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BadPressure {
    /// Reference position of the slave point
    pub at: Vector2<f64>,
    /// p_w there, negative or not finite [F/L²]
    pub pressure: f64,
}
