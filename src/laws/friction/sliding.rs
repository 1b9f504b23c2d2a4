//! What a law is asked: the increment of one point.

use super::LawFailure;

/// Relative motion of the two surfaces during one increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sliding {
    /// Δu_t: slip increment of the slave relative to the master along +s [L]
    pub slip: f64,
    /// p: effective pressure at the end of the increment, ≤ 0 where the point is open [F/L²]
    pub pressure: f64,
    /// Δt: length of the increment [T]
    pub dt: f64,
}

impl Sliding {
    /// Refuses what no law can answer.
    ///
    /// # Errors
    /// [`LawFailure`] when a number is not finite, or time goes backwards.
    pub fn checked(self) -> Result<Self, LawFailure> {
        let Self { slip, pressure, dt } = self;
        if !(slip.is_finite() && pressure.is_finite() && dt.is_finite()) {
            return Err(LawFailure::NotFinite { slip, pressure, dt });
        }
        if dt < 0.0 {
            return Err(LawFailure::NegativeTime { dt });
        }
        Ok(self)
    }
}
